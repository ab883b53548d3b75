"""A response curve from a request to its folder: points, their tables, branches, figures.

After every point the folder holds all points and the motion that is carried on, so an interrupted response curve
continues where it was, to the same bytes.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Unpack

import numpy as np

from fem.case.case import Case, to_toml
from fem.model.container import Container, discretise
from fem.response.answer import fates_of, response_answer
from fem.response.branches import coexistences, drop_outs, jumps
from fem.response.curve import PORTRAYED, case_at, plan_of, sweep_points
from fem.response.figures import response_figures
from fem.response.model import SAMPLES_PER_PERIOD, DrivenModel, driven_model
from fem.response.records import (
    ARRAYS,
    PointRecord,
    PointRow,
    csv_of_portraits,
    csv_of_rows,
    csv_of_sections,
    record_of,
)
from fem.response.request import ResponseRequest
from fem.response.result import ResponseResult
from fem.results.disk import table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import RESPONSE
from fem.results.outcome import MODES
from fem.run.checkpoint import changing, require_same
from fem.run.expected import of_a_second, say_expected
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
    study = Study(
        kind=RESPONSE,
        request=request.hash,
        result=ResponseResult,
        begun=begun,
        compute=partial(_compute, request, begun),
        texts={"case.toml": to_toml(request.case)},
        size=required_disk(request),
        subject="the response curve",
        way_out="take fewer frequencies",
        progress=lambda results: "its frequencies so far",
    )
    return run_study(study, folder, **options)


def required_disk(request: ResponseRequest) -> float:
    """Size of the folder of a response curve [bytes]: sections, portraits, the state twice."""
    portrait = min(request.observe, PORTRAYED) * SAMPLES_PER_PERIOD * OF_A_SAMPLE
    return table_bytes(2 * request.count, request.observe * OF_A_PERIOD + portrait + OF_A_POINT)


def _compute(
    request: ResponseRequest, begun: ResponseResult, results: ResultFolder, runner: Runner
) -> ResponseResult:
    """Add the points that are missing, and write their tables and figures."""
    records, saved = read_state(results)
    say_expected(runner.reporter, f"{2 * request.count} points", _expected_s(request))
    status = _sweep(request, results, records, saved, runner)
    results.write_text("response.csv", csv_of_rows(records))
    results.write_text("sections.csv", csv_of_sections(records))
    results.write_text("portraits.csv", csv_of_portraits(records))
    for name, svg in response_figures(request, records).items():
        results.write_text(f"figures/{name}.svg", svg)
    result = replace(
        begun,
        status=status,
        points=tuple(record.row for record in records),
        coexisting=tuple(coexistences(records)),
        jumps=tuple(jumps(records)),
        drop_outs=tuple(drop_outs(records)),
        stable_everywhere=all(record.row.stable for record in records) if records else None,
    )
    if status == INTERRUPTED:
        return replace(result, missing=f"{len(records)} of {2 * request.count} points are computed")
    result = replace(result, overturned_share=fates_of(result).overturned_share)
    return replace(result, answer=response_answer(result))


def _expected_s(request: ResponseRequest) -> float:
    """Time of all points, each of which is driven for as many periods [s]."""
    periods = request.settle + request.observe
    simulated = 2 * request.count * periods / (0.5 * (request.first_Hz + request.last_Hz))
    return simulated * of_a_second(request.case)


def read_state(results: ResultFolder) -> tuple[list[PointRecord], dict[str, np.ndarray]]:
    """Points already there and the state after the last of them; nothing where there is none.

    Raises:
        FolderError: the state is damaged.
    """
    arrays = results.read_arrays(STATE)
    if arrays is None:
        return [], {}
    rows = json.loads(str(arrays.pop("rows")))
    records = [
        PointRecord(row=PointRow(**row), **{name: arrays.pop(f"{name}_{k}") for name in ARRAYS})
        for k, row in enumerate(rows)
    ]
    return records, arrays


def state_of(records: Sequence[PointRecord], driven: DrivenModel | None) -> dict[str, np.ndarray]:
    """What a resumed curve starts from: its points, and the motion carried on (None after a fall)."""
    arrays = {"rows": np.array(json.dumps([asdict(record.row) for record in records]))}
    for k, record in enumerate(records):
        arrays |= {f"{name}_{k}": getattr(record, name) for name in ARRAYS}
    return arrays if driven is None else arrays | changing(driven.model)


def driven_from(case: Case, container: Container, arrays: dict[str, np.ndarray], path: Path) -> DrivenModel:
    """The motion that `state_of` kept in a file.

    Raises:
        CheckpointError: it does not fit the model.
    """
    driven = driven_model(case, container)
    parts = changing(driven.model)
    require_same(path, arrays, parts)
    for name, part in parts.items():
        part[...] = arrays[name]
    return driven


def _sweep(
    request: ResponseRequest,
    results: ResultFolder,
    records: list[PointRecord],
    saved: dict[str, np.ndarray],
    runner: Runner,
) -> str:
    """Add the points that are missing; returns the status of the curve."""
    plan, reporter = plan_of(request), runner.reporter
    length = request.settle + request.observe
    spans = [length / float(request.frequencies[number]) for _, number in plan]
    done, angle = sum(spans[: len(records)]), 1.0
    container, before = discretise(request.case), None
    if "clock" in saved:
        last = case_at(request, plan[len(records) - 1][1])
        before = driven_from(last, container, saved, results.path / STATE)
    reporter.start(sum(spans))

    def progress(time: float, rotation: float, mode: int) -> None:
        reporter.update(done + time, abs(rotation) / angle, MODES[mode])

    points = sweep_points(request, container, skip=len(records), before=before, progress=progress)
    if runner.stop():
        return INTERRUPTED
    for point, after in points:
        records.append(record_of(point))
        results.write_arrays(STATE, state_of(records, after))
        done, angle = sum(spans[: len(records)]), point.slenderness_angle
        if runner.stop() and len(records) < len(plan):
            reporter.finish()
            return INTERRUPTED
    reporter.finish()
    return FAILED if any(record.row.status == "failed" for record in records) else COMPLETED
