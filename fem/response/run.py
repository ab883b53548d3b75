"""A response curve from a request to its folder: points, their tables, branches, figures.

After every point the folder holds all points and the motion that is carried on, so an interrupted response curve
continues where it was, to the same bytes.
"""

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from fem.case.case import Case, to_toml
from fem.model.container import Container, discretise
from fem.response.answer import found_at, response_answer
from fem.response.branches import branches_of
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
from fem.results.folder import ResultFolder, open_result_folder, program_of_results
from fem.results.kinds import RESPONSE
from fem.results.outcome import MODES
from fem.run.checkpoint import changing, require_same
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import interruptible

STATE = "state.npz"
#: room on the disk [bytes]: a period in sections.csv and twice in the state, a sample in portraits.csv and twice in
#: the state, a point in response.csv and response.json, all else
BYTES_OF_A_PERIOD, BYTES_OF_A_SAMPLE, BYTES_OF_A_POINT, BYTES_BESIDE = 220 + 160, 50 + 32, 2000, 1_000_000


def run_response(
    request: ResponseRequest,
    *,
    folder: Path,
    force: bool = False,
    resume: bool = False,
    reporter: Reporter | None = None,
) -> dict[str, Any]:
    """Compute a response curve into a folder; a finished one of the same request is not computed again.

    Returns:
        The content of `response.json`.

    Raises:
        CaseError, MeshError, FolderError: bad input, or an unfinished curve (without `resume` or `force`).
        OutputError: the disk is full, the folder was removed; what was written is kept.
    """
    reporter = reporter or SilentReporter()
    with (
        open_result_folder(folder, RESPONSE, request.hash, force=force, resume=resume) as place,
        interruptible(reporter) as stop,
    ):
        if place.finished and place.found:
            reporter.message(f"{folder} holds this response curve already; --force computes it again")
            return place.found
        place.refuse_unfinished("its frequencies so far")
        if place.resuming:
            place.require_same_program()
        place.require_room(required_disk(request), "the response curve", "take fewer frequencies")
        mark = {"status": "running", "asked": request.hash} | program_of_results()
        place.begin(mark, {"case.toml": to_toml(request.case)})
        records, saved = read_state(place)
        status = _sweep(request, place, records, saved, reporter=reporter, stop=stop)
        result = result_of(request, records, status)
        place.write_text("response.csv", csv_of_rows(records))
        place.write_text("sections.csv", csv_of_sections(records))
        place.write_text("portraits.csv", csv_of_portraits(records))
        for name, svg in response_figures(request, records).items():
            place.write_text(f"figures/{name}.svg", svg)
        place.write_result(result)
        if status == "completed":
            place.remove(STATE)
    return result


def required_disk(request: ResponseRequest) -> float:
    """Size of the folder of a response curve [bytes]: sections, portraits, the state twice, figures."""
    periods = request.observe * BYTES_OF_A_PERIOD
    portrait = min(request.observe, PORTRAYED) * SAMPLES_PER_PERIOD * BYTES_OF_A_SAMPLE
    return 2 * request.count * (periods + portrait + BYTES_OF_A_POINT) + BYTES_BESIDE


def result_of(request: ResponseRequest, records: Sequence[PointRecord], status: str) -> dict[str, Any]:
    """The content of `response.json`."""
    result = {
        "status": status,
        "asked": request.hash,
        "case": request.case.name,
        "title": request.case.title,
        "request": request.to_dict(),
        "points": [asdict(record.row) for record in records],
        **branches_of(records),
        "stable_everywhere": all(record.row.stable for record in records) if records else None,
    }
    return result | {"answer": response_answer(result)} | program_of_results()


def page_of(request: ResponseRequest, result: Mapping[str, Any], folder: Path) -> str:
    """The result of a response curve as text."""
    points = result["points"]
    lines = [
        f"{result['case']}: {result['title']}" if result["title"] else str(result["case"]),
        f"  drive       {request.held_in_words}, {request.count} frequencies from {request.first_Hz:g} to "
        f"{request.last_Hz:g} Hz, {request.order}",
        f"  judged by   {request.observe} periods each, after {request.settle}",
    ]
    for direction in ("up", "down"):
        swept = [point for point in points if point["direction"] == direction]
        counted = Counter(PointRow(**point).words for point in swept)
        words = ", ".join(f"{count} x {word}" for word, count in counted.items())
        lines.append(f"  {direction:<11} {words or 'not reached'}")
    for found in result["coexisting"]:
        difference = found["largest_difference"]
        by = f", rotation ratios up to {difference:.3f} apart" if difference is not None else ""
        lines.append(
            f"  coexist     {found_at(found)}: {' or '.join(found['up'])} going up, "
            f"{' or '.join(found['down'])} going down{by}"
        )
    for found in result["jumps"]:
        before, after = found["rotation_ratio"]
        lines.append(
            f"  jump        {found['direction']}, {found_at(found)}: {found['what']}, "
            f"rotation ratio {before:.3f} to {after:.3f}"
        )
    for found in result["drop_outs"]:
        how = "carried there" if found["carried"] else "from its start"
        lines.append(f"  overturns   {found['direction']}, {found_at(found)}, {how}")
    judged = [point for point in points if point["stable"] is not None]
    stable = sum(point["stable"] for point in judged)
    lines.append(
        f"  stable      {stable} of {len(judged)} points: amplitudes do not diverge, and without drive the motion "
        "dies out"
    )
    failed = [point for point in points if point["status"] == "failed"]
    lines += [
        f"  failed      {point['direction']}, {point['frequency_Hz']:.4g} Hz: {point['reason']}"
        for point in failed
    ]
    lines.append(f"  files       {folder}")
    return "\n".join([*lines, *filter(None, [response_answer(result)])])


def read_state(place: ResultFolder) -> tuple[list[PointRecord], dict[str, np.ndarray]]:
    """Points already there and the state after the last of them; nothing where there is none.

    Raises:
        FolderError: the state is damaged.
    """
    arrays = place.read_arrays(STATE)
    if arrays is None:
        return [], {}
    rows = json.loads(str(arrays.pop("rows")))
    records = [
        PointRecord(row=PointRow(**row), **{name: arrays.pop(f"{name}_{k}") for name in ARRAYS})
        for k, row in enumerate(rows)
    ]
    return records, arrays


def state_of(records: Sequence[PointRecord], driven: DrivenModel | None) -> dict[str, np.ndarray]:
    """All that is needed to continue: the points, and the motion that is carried on; None after a fall."""
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
    place: ResultFolder,
    records: list[PointRecord],
    saved: dict[str, np.ndarray],
    *,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> str:
    """Add the points that are missing; returns the status of the curve."""
    plan = plan_of(request)
    length = request.settle + request.observe
    spans = [length / float(request.frequencies[number]) for _, number in plan]
    done, angle = sum(spans[: len(records)]), 1.0
    container, before = discretise(request.case), None
    if "clock" in saved:
        last = case_at(request, plan[len(records) - 1][1])
        before = driven_from(last, container, saved, place.path / STATE)
    reporter.start(sum(spans))

    def progress(time: float, rotation: float, mode: int) -> None:
        reporter.update(done + time, abs(rotation) / angle, MODES[mode])

    points = sweep_points(request, container, skip=len(records), before=before, progress=progress)
    if stop():
        return "interrupted"
    for point, after in points:
        records.append(record_of(point))
        place.write_arrays(STATE, state_of(records, after))
        done, angle = sum(spans[: len(records)]), point.slenderness_angle
        if stop() and len(records) < len(plan):
            reporter.finish()
            return "interrupted"
    reporter.finish()
    return "failed" if any(record.row.status == "failed" for record in records) else "completed"
