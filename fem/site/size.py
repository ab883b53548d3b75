"""Which values of one key fulfil the rule: `assess` at one value after another, each until it is decided.

The key and its range, a scan, the changes located, the answer in words. Rows are logged as they are ready, so that an
interrupted computation continues where it was.
"""

import importlib
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, pairwise
from pathlib import Path
from typing import Any, Literal, Unpack

import numpy as np

from fem.case.tables.quantities import Quantity
from fem.case.validation import CaseError, did_you_mean, known_keys, quantity_of, told_as
from fem.html.page import text_of
from fem.results.folder import ResultFolder
from fem.results.kinds import SIZE
from fem.results.run_result import MotionResult
from fem.run.described import doubts
from fem.run.expected import expected_words
from fem.run.sureness import least_width, rounds_left, values_to_try
from fem.runtime.identity import command_line
from fem.runtime.own_files import remove_tree
from fem.seismic.ground_motion import GroundMotion
from fem.site.preview import forecast
from fem.site.request import TABLES, SiteRequest
from fem.site.result import OF_ANSWER, SiteAnswer, SizeResult
from fem.site.run import RUNS, answered, copy_files, set_of, site_hash, texts_of, write_floors
from fem.site.runs import COLUMNS, bodies_of
from fem.site.stages import Stages
from fem.study.axes import field_of
from fem.study.derived import value_in
from fem.study.driver import COMPLETED, Study, StudyOptions, hash_of, run_study
from fem.study.runner import Runner
from fem.study.table import table_text
from mesh.errors import MeshError

RESOLUTION = 0.01  #: largest width of a bracket over the value
INNER = 3  #: values tried within a bracket at a time
#: which values a user looks for: the least, the largest, or all
Wanted = Literal["least", "largest", "window"]
FIGURE = "figures/size.svg"
WORKING = ".motions"  #: of the sets, as long as they are computed
BYTES_OF_SETS = 50_000_000  #: of motions, as long as they are computed
MOVING = ("site", "building", "floor_spectrum", "motions")  #: tables whose values have motions of their own
COUNT = 13  #: values of the scan
MOST_COUNT = 200
WIDER = 3.0  #: the scan reaches from the value in the file over this to this times it
SIDES = ("container.width_m", "container.depth_m")
BOXES, FRICTION, FLOOR = "container.boxes", "contact.mu_static", "building.z_over_h"
NEAR = 1e-3  #: of a step, within which an end of the range is a value: 0.666667 is the second floor of three
#: key -> what is looked for, and words for it; other keys: the window of their values
KNOWN: dict[str, tuple[Wanted, str]] = {
    "container.width_m": ("least", "width"),
    "container.depth_m": ("least", "depth"),
    BOXES: ("largest", "number of boxes"),
    FRICTION: ("window", "static friction"),
    "site.reference_acceleration_m_s2": ("largest", "reference acceleration"),
    "site.importance_factor": ("largest", "importance factor"),
    "site.element_importance_factor": ("largest", "importance factor of the element"),
    "site.soil_factor": ("largest", "soil factor"),
    "site.vertical_ratio": ("largest", "vertical ratio"),
    FLOOR: ("largest", "height in the building"),
}
#: ends of the scan where the value in the file says little
RANGES = {FRICTION: (0.05, 1.0), BOXES: (1.0, 12.0), FLOOR: (0.0, 1.0)}
#: what is beyond a limit, by its key
BEYOND = {
    "rotation_ratio": "rotation",
    "single_rotation_ratio": "the rotation of one motion",
    "slip_m": "slip",
}


@dataclass(frozen=True, kw_only=True)
class SizeAxis:
    """The key that is varied, and the values of the scan."""

    key: str
    words: str  #: such as "width"
    unit: str
    wanted: Wanted
    values: tuple[float, ...]  #: rising
    whole: bool = False  #: all values are tried, and there are none between them: boxes, floors of a building

    def __post_init__(self) -> None:
        if len(self.values) < 2 or any(b <= a for a, b in pairwise(self.values)):
            raise ValueError(f"{self.key}: at least two rising values are needed, got {self.values}")


def size_axis(
    request: SiteRequest,
    key: str,
    *,
    low: float | None = None,
    high: float | None = None,
    count: int | None = None,
) -> SizeAxis:
    """The axis of a key of the site file or of its container.

    Args:
        request: what is asked, with the value that the range starts from.
        key: dotted, such as `container.width_m`.
        low, high: ends of the scan; None: as suits the key, the upper one no further than a container can be built.
        count: values of the scan; None: 13. Every number of boxes, and every floor of a building of storeys, is tried.

    Raises:
        CaseError: no such key, one without a number, a range that does not rise or that the key cannot have, or at an
            end of which the containers cannot be built.
    """
    quantity, value = _quantity(key), _given(request, key)
    steps = 1 if key == BOXES else None  # values from 0 to 1, where there are no others between
    if key == FLOOR and request.building is not None:
        steps = request.building.storeys
    last_is_usual = high is None
    if low is None or high is None:
        if key not in RANGES and not (value and value > 0.0):
            raise CaseError(f"--over {key}: the files give no value to start from; give --from and --to")
        least, most = quantity.least or 0.0, math.inf if quantity.most is None else quantity.most
        around = max((value or 0.0) / WIDER, least), min((value or 0.0) * WIDER, most)
        begin, end = RANGES.get(key, around)
        low, high = begin if low is None else low, end if high is None else high
    if not low < high:
        raise CaseError(f"--from {low:g} --to {high:g}: the range of {key} must rise")
    if key.startswith("site.") and request.on_given_floor:
        raise CaseError(
            f"--over {key}: the horizontal motion of the floor is given, which [site] does not change"
        )
    for name, bound in (("--from", low), ("--to", high)):
        with told_as(f"{name}: {key} "):
            quantity.check(bound)
    if count is not None and not 2 <= count <= MOST_COUNT:
        raise CaseError(f"--count must be 2 to {MOST_COUNT}, got {count}")
    values = spaced(low, high, count or COUNT)
    if steps is not None:
        first, last = math.ceil(low * steps - NEAR), math.floor(high * steps + NEAR)
        values = tuple(number / steps for number in range(first, last + 1))
        if len(values) < 2:
            raise CaseError(f"--from {low:g} --to {high:g}: {key} has fewer than two values there")
    wanted, words = KNOWN.get(key, ("window", key))
    axis = SizeAxis(
        key=key, words=words, unit=quantity.unit, wanted=wanted, values=values, whole=steps is not None
    )
    while last_is_usual and len(values) > 2:
        try:
            _build(request, axis, values[-1])
            break
        except CaseError:
            values = values[:-1]
    for bound in (values[0], values[-1]):
        _build(request, axis, bound)  # refused before anything is computed
    return replace(axis, values=values)


def at(request: SiteRequest, axis: SizeAxis, value: float) -> SiteRequest:
    """The request at a value of the axis, CaseError if it cannot be; of a square container the other side follows."""
    changed = request.with_value(axis.key, round(value) if axis.key == BOXES else value)
    for key in followers(request, axis.key):
        changed = changed.with_value(key, value)
    return changed


def _build(request: SiteRequest, axis: SizeAxis, value: float) -> None:
    """Build the containers at a value, to see that it can be done; CaseError where it cannot."""
    try:
        bodies_of(at(request, axis, value))
    except (CaseError, MeshError) as error:
        raise CaseError(f"--over {axis.key}: at {value:.4g} {axis.unit}".rstrip() + f" {error}") from None


def followers(request: SiteRequest, key: str) -> tuple[str, ...]:
    """Keys that take the same value: the other side of a container that is as deep as wide."""
    box = request.container.container
    square = key in SIDES and box.width_m == box.depth_m
    return tuple(side for side in SIDES if square and side != key)


def _quantity(key: str) -> Quantity:
    """The quantity of a key; only numbers can vary."""
    table, _, name = key.partition(".")
    if table in TABLES:
        fields = known_keys(TABLES[table])
        if name not in fields:
            raise CaseError(f"--over {key}: no such key of a site file{did_you_mean(name, fields)}")
        field = fields[name]
    else:
        with told_as(f"--over {key}: "):
            field = field_of(key)
    quantity = quantity_of(field.annotation, field.metadata)
    if quantity is None or "list" in str(field.annotation):
        raise CaseError(f"--over {key}: it holds no single number; try one of {', '.join(KNOWN)}")
    return quantity


def _given(request: SiteRequest, key: str) -> float | None:
    """The value in the files; None where there is none."""
    table, _, name = key.partition(".")
    if table not in TABLES:
        return value_in(request.container, key, {})
    content = getattr(request, table)
    if content is None:
        raise CaseError(f"--over {key}: the site file has no [{table}]")
    given = getattr(content, name)
    return None if given is None else float(given)


def next_values(axis: SizeAxis, answers: Mapping[float, SiteAnswer]) -> list[float]:
    """Values to be tried next: those of the scan, then values within every bracket wider than 1 % of the value.

    Args:
        answers: so far, by value. None is asked for again; empty: all is found.
    """
    missing = [value for value in axis.values if value not in answers]
    if missing or axis.whole:
        return missing
    least = least_width(axis.values, RESOLUTION)
    return values_to_try(_fulfilled(answers), resolution=RESOLUTION, inner=INNER, least=least)


def _fulfilled(answers: Mapping[float, SiteAnswer]) -> dict[float, str]:
    return {value: str(bool(answer.fulfilled)) for value, answer in answers.items()}


def stretches(said: Mapping[float, str]) -> list[tuple[str, float, float]]:
    """What is said of neighbouring values, with the first and the last of which it is, by rising value."""
    alike = [(what, list(values)) for what, values in groupby(sorted(said), said.__getitem__)]
    return [(what, values[0], values[-1]) for what, values in alike]


def so_far(axis: SizeAxis, answers: Mapping[float, SiteAnswer], value: float) -> str:
    """What is decided, and what comes next: "number of boxes: 1 to 5 fulfilled, 6 being tried"."""
    said = {tried: answer.answer or "without an answer" for tried, answer in answers.items()}
    decided = [
        f"{' to '.join(dict.fromkeys(f'{end:.4g}' for end in ends))} {what}"
        for what, *ends in stretches(said)
    ]
    unit = f" [{axis.unit}]" if axis.unit else ""
    return f"{axis.words}{unit}: {', '.join([*decided, f'{value:.4g} being tried'])}"


def size_result(axis: SizeAxis, answers: Mapping[float, SiteAnswer], begun: SizeResult) -> SizeResult:
    """Which values fulfil the rule, from the answers by value; `begun`: what was known before any was tried.

    A sentence says what fails next to the value wanted, and which stretches elsewhere fulfil the rule.
    """
    points: tuple[dict[str, Any], ...] = tuple(
        {"value": value, "fails": _reason(answer)} | {name: answer[name] for name in OF_ANSWER}
        for value, answer in sorted(answers.items())
    )
    said = {point["value"]: "fulfilled" if point["fulfilled"] else "" for point in points}
    intervals = [(low, high) for what, low, high in stretches(said) if what]
    wanted = None  # the end of the stretch that reaches the good end of the range; an island elsewhere does not count
    if axis.wanted == "least" and intervals and intervals[-1][1] == axis.values[-1]:
        wanted = intervals[-1][0]
    elif axis.wanted == "largest" and intervals and intervals[0][0] == axis.values[0]:
        wanted = intervals[0][1]
    words = text_of(
        "size_answer.txt.j2",
        axis=axis,
        points=points,
        intervals=intervals,
        wanted=wanted,
        value=partial(_value, axis=axis),
        stretches=partial(_stretches, axis=axis),
    )
    return replace(
        begun,
        status=COMPLETED,
        answer=words,
        value=wanted,
        intervals=tuple(intervals),
        sentence=words,
        points=points,
    )


def _stretches(intervals: Sequence[tuple[float, float]], axis: SizeAxis) -> str:
    """Stretches in words, each with enough figures for its ends to differ."""
    words = []
    for low, high in intervals:
        figures = next((n for n in (3, 4, 5) if _inward(low, n, up=True) <= _inward(high, n, up=False)), 6)
        ends = _value(low, axis, figures, up=True), _value(high, axis, figures, up=False)
        words.append(f"of {_value(low, axis)}" if low == high else f"from {ends[0]} to {ends[1]}")
    return " and ".join(words)


def _value(value: float, axis: SizeAxis, figures: int = 3, *, up: bool | None = None) -> str:
    """A value with its unit, rounded toward what fulfils the rule."""
    if not axis.whole and up is not None:
        value = _inward(value, figures, up=up)
    return f"{value:.{figures}g} {axis.unit}".strip()


def _inward(value: float, figures: int, *, up: bool) -> float:
    """A value rounded up or down to a number of figures."""
    if value == 0.0:
        return value
    step = 10.0 ** (math.floor(math.log10(abs(value))) - figures + 1)
    steps = value / step
    return (math.ceil(steps - 1e-9) if up else math.floor(steps + 1e-9)) * step


def _reason(answer: SiteAnswer) -> str:
    if answer.fulfilled:
        return ""
    if answer.answer is None:
        return "there is no answer"
    if answer.fulfilled is None:
        return "it is not sure"
    if answer.overturned:
        return "it overturns"
    if answer.invalid:
        return "a corner is destroyed"
    names = [BEYOND[key] for key in answer.exceeded]
    if not names:
        return "the wind moves it"
    return f"{' and '.join(names)} {'are' if len(names) > 1 else 'is'} beyond the limit"


def spaced(low: float, high: float, count: int) -> tuple[float, ...]:
    """Values of a scan, at equal ratios where the range spans more than a factor of four."""
    even = np.geomspace(low, high, count) if low > 0.0 and high > 4.0 * low else np.linspace(low, high, count)
    return tuple(float(f"{value:.6g}") for value in even)


def run_size(
    request: SiteRequest,
    axis: SizeAxis,
    folder: Path,
    *,
    allow_outside: bool = False,
    **options: Unpack[StudyOptions],
) -> SizeResult:
    """Find which values of a key fulfil the rule, into a folder; raises as `run_site`.

    Args:
        axis: the key and the values of the scan.
        allow_outside: take records from outside the folder of the site file.
    """
    ground = Stages.of(request, folder, allow_outside=allow_outside).ground
    ends = ("--from", f"{axis.values[0]:g}", "--to", f"{axis.values[-1]:g}", "--count", str(len(axis.values)))
    command = command_line("size", request.origin.place, "--over", axis.key, *ends)
    begun = SizeResult(
        command=command,
        key=axis.key,
        followers=followers(request, axis.key),
        unit=axis.unit,
        low=axis.values[0],
        high=axis.values[-1],
        warnings=doubts(MotionResult(), at(request, axis, axis.values[-1]).container),
    )
    study = Study(
        kind=SIZE,
        request=hash_of([site_hash(request, ground), repr(axis)]),
        result=SizeResult,
        begun=begun,
        compute=partial(_compute, request, axis, begun, allow_outside),
        texts=texts_of(request, SIZE),
        size=BYTES_OF_SETS,
    )
    return run_study(study, folder, **options)


def _compute(
    request: SiteRequest,
    axis: SizeAxis,
    begun: SizeResult,
    allow_outside: bool,
    place: ResultFolder,
    runner: Runner,
) -> SizeResult:
    """Verify one value after another, as long as there are any to be tried."""
    began, working = time.perf_counter(), place.path / WORKING
    tried: dict[float, Stages] = {}
    answers: dict[float, SiteAnswer] = {}
    took: list[float] = []  #: each value that is decided [s]
    made: dict[Path, dict[str, GroundMotion]] = {}
    copy_files(request, place.path)
    try:
        while values := next_values(axis, answers):
            tried |= {
                value: stages_at(request, axis, value, working, made, allow_outside=allow_outside)
                for value in values
            }
            each = [(tried[value].load, forecast(tried[value], runner.jobs, scan=False)) for value in values]
            most = sum(one.most for _, one in each)
            what = f"{len(values)} value{'s' * (len(values) > 1)}, up to {most} runs"
            # they change between any two of the scan, as far as is known
            known = _fulfilled(answers) or {value: str(k % 2) for k, value in enumerate(axis.values)}
            rounds = 0.0 if axis.whole else rounds_left(known, resolution=RESOLUTION, inner=INNER)
            count = len(values) * max(rounds, 1.0) if took else len(values) + INNER * rounds
            # as long as those that took longest: the next ones are near the boundary
            long = sorted(took)[-2:] or [load * (one.seconds + one.deciding_seconds) for load, one in each]
            seconds = count * float(np.mean(long))
            what += ", then values between them" * (count > len(values))
            runner.reporter.message(f"{what}: {expected_words(seconds, runner.jobs)}")
            for value in values:
                since = time.perf_counter()
                runner.reporter.message(so_far(axis, answers, value))
                stages = tried[value]
                answer = answered(stages, set_of(stages), runner, place.path / RUNS, value)
                if answer is None:
                    left = f"{len(answers)} values are decided, {len(tried) - len(answers)} are not"
                    return begun.interrupted(left)
                answers[value] = answer
                took.append(time.perf_counter() - since)
    finally:
        remove_tree(working)
    place.check()
    result = size_result(axis, answers, begun)
    # by value, and in the order of each verification, whatever the order in which runs ended
    rows = (
        (value, *stages.rows[key].values())
        for value, stages in sorted(tried.items())
        for key in stages.in_order()
    )
    place.write(RUNS, table_text({"value": float} | COLUMNS, rows))
    page = importlib.import_module("fem.site.page")  # late, for it loads matplotlib
    place.write(FIGURE, page.draw_size(result, request.inputs))
    return replace(result, wall_s=time.perf_counter() - began)


def stages_at(
    request: SiteRequest,
    axis: SizeAxis,
    value: float,
    working: Path,
    made: dict[Path, dict[str, GroundMotion]],
    *,
    allow_outside: bool = False,
) -> Stages:
    """The runs at a value; values that do not change the motions share their folder.

    Args:
        working: holds the folders; made: the motions in each, by stem, to which those of this value are added.
    """
    stages = Stages.of(at(request, axis, value), working, allow_outside=allow_outside)
    moves = axis.key.partition(".")[0] in MOVING
    folder = working / f"{value if moves else stages.longest:.9g}"
    motions = made.setdefault(folder, {})
    motions |= stages.motions
    stages = replace(stages, folder=folder, motions=motions)
    write_floors(stages, ground=True)
    return stages
