"""A response curve from a request to its folder: points, their tables, what lasts, figures.

After every task the folder holds all points and the motion that is carried on, so an interrupted or killed response
curve continues where it was, to the same bytes.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Unpack

import numpy as np

from fem.case.case import to_toml
from fem.model.container import discretise
from fem.model.model import build_model
from fem.response.answer import fell_share, overturned_share, response_answer
from fem.response.curve import Task, computed, plan_of
from fem.response.figures import response_figures
from fem.response.lasting import (
    ResponseResult,
    coexistences,
    drop_outs,
    frequencies_of,
    of_first_model,
    shell_over_rigid,
    shown,
)
from fem.response.model import driven_model
from fem.response.records import (
    PORTRAYED,
    PointRecord,
    csv_of_rows,
    csv_of_sections,
    packed,
    unpacked,
)
from fem.response.request import SAMPLES_PER_PERIOD, ResponseRequest
from fem.results.disk import table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import RESPONSE
from fem.results.outcome import MODES
from fem.run.expected import of_a_second, say_expected
from fem.run.output import changing, require_same
from fem.study.driver import COMPLETED, FAILED, INTERRUPTED, Study, StudyOptions, run_study
from fem.study.runner import Runner

STATE = "state.npz"
#: numbers of a period and of a sample in their tables and twice in the state, of a point in its files
OF_A_PERIOD, OF_A_SAMPLE, OF_A_POINT = 19, 4, 100


def run_response(
    request: ResponseRequest, *, folder: Path, **options: Unpack[StudyOptions]
) -> ResponseResult:
    """Compute a response curve into a folder; raises as `run_study`, and CaseError and MeshError for bad input."""
    begun = ResponseResult(
        asked=request.hash, case=request.case.name, title=request.case.title, request=request.to_dict()
    )
    portrait = min(request.observe, PORTRAYED) * SAMPLES_PER_PERIOD * OF_A_SAMPLE
    points = request.count * (2 + 2 * request.shell + request.starts)
    study = Study(
        kind=RESPONSE,
        request=request.hash,
        result=ResponseResult,
        begun=begun,
        compute=partial(_compute, request, begun),
        texts={"case.toml": to_toml(request.case)},
        size=table_bytes(points, request.observe * OF_A_PERIOD + portrait + OF_A_POINT),
        subject="the response curve",
        way_out="take fewer frequencies or starts",
        progress=lambda results: "its frequencies so far",
    )
    return run_study(study, folder, **options)


def _compute(
    request: ResponseRequest, begun: ResponseResult, results: ResultFolder, runner: Runner
) -> ResponseResult:
    """Add the points that are missing, and write their tables and figures."""
    plan = plan_of(request)
    status, done, records = _follow(request, plan, results, runner)
    own = of_first_model(records)
    swept = [record for record in own if record.row.direction != "start"]
    results.write("response.csv", csv_of_rows(swept))
    if request.starts:
        results.write(
            "starts.csv", csv_of_rows([record for record in own if record.row.direction == "start"])
        )
    if request.shell:
        results.write("shell.csv", csv_of_rows(records[len(own) :]))
    results.write("sections.csv", csv_of_sections(shown(own)))
    for name, svg in response_figures(request, records).items():
        results.write(f"figures/{name}.svg", svg)
    frequencies = tuple(frequencies_of(own))
    result = replace(
        begun,
        status=status,
        points=tuple(record.row for record in swept),
        frequencies=frequencies,
        coexisting=tuple(coexistences(frequencies)),
        drop_outs=tuple(drop_outs(own)),
        overturned_share=overturned_share([record.row for record in swept])
        if status != INTERRUPTED
        else None,
        starts_fell_share=fell_share(frequencies),
        shell_over_rigid=shell_over_rigid(records),
    )
    if status == INTERRUPTED:
        return replace(result, missing=f"{done} of {len(plan)} steps are computed")
    return replace(result, answer=response_answer(result))


def _follow(
    request: ResponseRequest, plan: Sequence[Task], results: ResultFolder, runner: Runner
) -> tuple[str, int, list[PointRecord]]:
    """The points of all tasks, those already there included; with the status, and the tasks that are done."""
    saved, records, done, reporter = results.read_arrays(STATE), [], 0, runner.reporter
    before, own = None, request.case.solver.model
    containers = {model: discretise(request.case_at(0, model)) for model in {task.model for task in plan}}
    control = build_model(request.case, containers[own]).run.problem.control
    if saved is not None:
        records, done = unpacked(saved), int(saved["done"])
        if "clock" in saved:
            last = plan[done - 1]
            before = driven_model(request.case_at(last.number, last.model), containers[last.model])
            parts = changing(before.model)
            require_same(results.path / STATE, saved, parts)
            for name, part in parts.items():
                part[...] = saved[name]
    periods = request.settle + request.observe
    runs = [request.starts if task.way == "random" else 1 for task in plan]
    spans = [
        n * periods / float(request.frequencies[task.number]) for n, task in zip(runs, plan, strict=True)
    ]
    seconds = sum(
        span * of_a_second(request.case_at(task.number, task.model))
        for span, task in zip(spans[done:], plan[done:], strict=True)
    )
    say_expected(reporter, f"{len(plan)} frequencies and starts", seconds)
    reporter.start(sum(spans))
    for task in plan[done:]:
        if runner.stop():
            reporter.finish()
            return INTERRUPTED, done, records

        def progress(time: float, rotation: float, mode: int, behind: float = sum(spans[:done])) -> None:
            reporter.update(behind + time, abs(rotation) / control.slenderness_angle, MODES[mode])

        found, before = computed(request, containers[task.model], task, records, before, control, progress)
        records, done = records + found, done + 1
        carried = {} if before is None else changing(before.model)
        results.write_arrays(STATE, packed(records) | {"done": np.array(done)} | carried)
    reporter.finish()
    failed = any(record.row.status == "failed" for record in of_first_model(records))
    return FAILED if failed else COMPLETED, done, records
