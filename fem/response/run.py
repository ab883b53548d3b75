"""A response curve from a request to its folder: points, their tables, what they show, figures.

After every point the folder holds what there is, and the state of the motion to go on with: a study that was cut off
goes on where it was, to the same bytes.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.assessment.verdict import MODE_NAMES
from fem.case.case import Case, to_toml
from fem.model.container import Container
from fem.response.branches import branches_of, in_words
from fem.response.curve import PORTRAYED, Standing, plan_of, sweep_points
from fem.response.figures import response_figures
from fem.response.model import SAMPLES_PER_PERIOD, DrivenModel, driven_model
from fem.response.records import (
    ARRAYS,
    Record,
    csv_of_portraits,
    csv_of_rows,
    csv_of_sections,
    record_of,
)
from fem.response.request import ResponseRequest
from fem.results.result_folder import COMPLETED, ResultFolder, opened_result_folder, program_of_results
from fem.results.run_folder import FolderError
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import interruptible

MARK, STATE = "response.json", "state.npz"
OWN = ("response.csv", "sections.csv", "portraits.csv", "case.toml", STATE, "figures/*.svg")
#: room on the disk: a period in sections.csv and twice in the state, a sample in portraits.csv and twice in the state,
#: a point in response.csv and response.json, figures [bytes]
BYTES_OF_A_PERIOD, BYTES_OF_A_SAMPLE, BYTES_OF_A_POINT, BYTES_BESIDE = 220 + 160, 50 + 32, 2000, 1_000_000


@dataclass(frozen=True, kw_only=True, eq=False)
class ResponseResult:
    """What a study came to."""

    status: str  #: completed | failed | interrupted
    result: dict[str, Any]  #: as in response.json
    records: tuple[Record, ...]


def run_response(
    request: ResponseRequest,
    *,
    folder: Path,
    force: bool = False,
    resume: bool = False,
    reporter: Reporter | None = None,
) -> ResponseResult:
    """Compute a response curve into a folder; a finished one of the same request is not computed again.

    Raises:
        CaseError, MeshError, FolderError: bad input.
    """
    reporter = reporter or SilentReporter()
    with (
        opened_result_folder(
            folder,
            mark=MARK,
            kind="response curve",
            asked=request.hash,
            own=OWN,
            wanted=required_disk(request),
            force=force,
            resume=resume,
        ) as place,
        interruptible(reporter) as stop,
    ):
        if place.finished is not None:
            reporter.message(f"{folder} holds this response curve already; --force computes it again")
            return ResponseResult(status=COMPLETED, result=place.finished, records=())
        place.write_text("case.toml", to_toml(request.case))
        records, saved = read_state(place)
        status = _sweep(request, place, records, saved, reporter=reporter, stop=stop)
        result = result_of(request, records, status)
        place.write_text("response.csv", csv_of_rows(records))
        place.write_text("sections.csv", csv_of_sections(records))
        place.write_text("portraits.csv", csv_of_portraits(records))
        for name, svg in response_figures(request, records).items():
            place.write_text(f"figures/{name}.svg", svg)
        place.write_result(result)
        if status == COMPLETED:
            (place.path / STATE).unlink(missing_ok=True)
    return ResponseResult(status=status, result=result, records=tuple(records))


def required_disk(request: ResponseRequest) -> float:
    """What the folder of a response curve comes to hold [bytes]: sections, portraits, the state twice, figures."""
    periods = request.observe * BYTES_OF_A_PERIOD
    portrait = min(request.observe, PORTRAYED) * SAMPLES_PER_PERIOD * BYTES_OF_A_SAMPLE
    return 2 * request.count * (periods + portrait + BYTES_OF_A_POINT) + BYTES_BESIDE


def result_of(request: ResponseRequest, records: Sequence[Record], status: str) -> dict[str, Any]:
    """The content of `response.json`."""
    return {
        "status": status,
        "asked": request.hash,
        "case": request.case.name,
        "title": request.case.title,
        "request": request.to_dict(),
        "points": [dict(record.row) for record in records],
        **branches_of(records),
        "stable_everywhere": all(record.row["stable"] for record in records) if records else None,
    } | program_of_results()


def page_of(request: ResponseRequest, result: Mapping[str, Any], folder: Path) -> str:
    """The end of a study, for people."""
    points = result["points"]
    lines = [
        f"{result['case']}: {result['title']}" if result["title"] else str(result["case"]),
        f"  drive       {held_in_words(request)}, {request.count} frequencies from {request.first_Hz:g} to "
        f"{request.last_Hz:g} Hz, {request.order}",
        f"  judged by   {request.observe} periods each, after {request.settle}",
    ]
    for direction in ("up", "down"):
        swept = [point for point in points if point["direction"] == direction]
        counted: dict[str, int] = {}
        for point in swept:
            counted[in_words(point)] = counted.get(in_words(point), 0) + 1
        words = ", ".join(f"{count} x {word}" for word, count in counted.items())
        lines.append(f"  {direction:<11} {words or 'not reached'}")
    for found in result["coexisting"]:
        difference = found["largest_difference"]
        by = f", rotation ratios up to {difference:.3f} apart" if difference is not None else ""
        lines.append(
            f"  coexist     {_range(found)}: {' or '.join(found['up'])} going up, "
            f"{' or '.join(found['down'])} going down{by}"
        )
    for found in result["jumps"]:
        before, after = found["rotation_ratio"]
        lines.append(
            f"  jump        {found['direction']}, {_range(found)}: {found['what']}, "
            f"rotation ratio {before:.3f} to {after:.3f}"
        )
    for found in result["drop_outs"]:
        how = "carried there" if found["carried"] else "from its start"
        lines.append(f"  overturns   {found['direction']}, {_range(found)}, {how}")
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
    return "\n".join([*lines, f"  files       {folder}"])


def held_in_words(request: ResponseRequest) -> str:
    """What of the drive stays the same."""
    if request.held == "displacement":
        return f"amplitude {1e3 * request.held_value:.4g} mm held"
    return f"peak acceleration {request.held_value:.4g} m/s2 held"


def read_state(place: ResultFolder) -> tuple[list[Record], dict[str, np.ndarray]]:
    """Points already there and the state after the last of them; nothing where there is none.

    Raises:
        FolderError: the state is damaged.
    """
    arrays = place.read_arrays(STATE)
    if arrays is None:
        return [], {}
    rows = json.loads(str(arrays.pop("rows")))
    records = [
        Record(row=row, **{name: arrays.pop(f"{name}_{k}") for name in ARRAYS}) for k, row in enumerate(rows)
    ]
    return records, arrays


def state_of(records: Sequence[Record], standing: Standing) -> dict[str, np.ndarray]:
    """All that is needed to go on: the points there are, and the motion."""
    arrays = {"rows": np.array(json.dumps([dict(record.row) for record in records]))}
    for k, record in enumerate(records):
        arrays |= {f"{name}_{k}": getattr(record, name) for name in ARRAYS}
    if standing.driven is not None:
        run = standing.driven.run
        arrays |= {f"state_{name}": array for name, array in run.old._asdict().items()}
        arrays |= {"clock": np.asarray(run.clock), "track": np.asarray(run.track), "floor": run.floor}
    return arrays


def driven_from(case: Case, container: Container, arrays: Mapping[str, np.ndarray]) -> DrivenModel:
    """The motion that `state_of` wrote down.

    Raises:
        FolderError: it does not fit the model.
    """
    driven = driven_model(case, container)
    run = driven.run
    places = {f"state_{name}": array for name, array in run.old._asdict().items()}
    places |= {"clock": run.clock, "track": run.track, "floor": run.floor}
    for name, array in places.items():
        if name not in arrays or (arrays[name].shape, arrays[name].dtype) != (array.shape, array.dtype):
            raise FolderError(f"{STATE} was written by another version; --force computes everything anew")
        array[...] = arrays[name]
    return driven


def _sweep(
    request: ResponseRequest,
    place: ResultFolder,
    records: list[Record],
    saved: Mapping[str, np.ndarray],
    *,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> str:
    """Add the points that are missing; the status of the study."""
    plan = plan_of(request)
    length = request.settle + request.observe
    spans = [length / float(request.frequencies[number]) for _, number in plan]
    done, angle = sum(spans[: len(records)]), 1.0
    reporter.start(sum(spans))

    def told(time: float, rotation: float, mode: int) -> None:
        reporter.update(done + time, abs(rotation) / angle, MODE_NAMES[mode])

    def standing(case: Case, container: Container) -> DrivenModel:
        return driven_from(case, container, saved)

    points = sweep_points(
        request, skip=len(records), standing=standing if "clock" in saved else None, told=told
    )
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
    return "failed" if any(record.row["status"] == "failed" for record in records) else COMPLETED


def _range(found: Mapping[str, Any]) -> str:
    low, high = found["from_Hz"], found["to_Hz"]
    return f"{low:.4g} Hz" if low == high else f"{low:.4g} to {high:.4g} Hz"
