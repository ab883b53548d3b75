"""The motions of a set: read once, checked against each other, with their measures and spectra.

A set is the values of `motion.file` in a study: recorded motions, alone or with a vertical component each.
"""

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from itertools import repeat
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from contact.motion.table import TableMotion
from fem.case.case import Case, CaseError, case_hash
from fem.case.recorded import MotionKey
from fem.figures.motions import draw_spectra
from fem.figures.style import svg_of
from fem.model.motion import build_motion
from fem.records.intensity import Intensity, intensity
from fem.records.spectrum import evenly_sampled, log_spaced_periods, response_spectrum
from fem.results.figures import types_of
from fem.results.folder import ResultFolder
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import real_path
from fem.study.axes import MOTION_FILE, Axis, set_axis
from fem.study.design import CaseMaker
from fem.study.runner import Runner, motion_left_out
from fem.study.table import Columns, table_of_rows, table_text
from fem.study.workers import FoundT, ItemT

LONGEST_PERIOD_S = 4.0
SPECTRA = "figures/spectra.svg"
#: columns of a component of a motion
MEASURED: Columns = {"file": str, "duration_s": float, "step_s": float, "samples": int}
MEASURED |= types_of(Intensity) | {"sha256": str}
LARGE_SET = 32  #: motions from which several workers read them


@dataclass(frozen=True, kw_only=True, eq=False)
class FloorComponent:
    """A horizontal or vertical motion, as the runs follow it; its samples are read when they are asked for."""

    name: str  #: of its file
    case: Case  #: whose motion it is
    table: MotionKey  #: of the case
    numbers: Mapping[str, Any]  #: length, interval, peaks and duration, by the names of `run.json`

    @property
    def motion(self) -> TableMotion:
        """The samples, read again unless they were read lately."""
        return _table(build_motion(self.case, self.table))

    @property
    def step_s(self) -> float:
        """Mean interval of its samples [s]."""
        return float(self.numbers["step_s"])


@dataclass(frozen=True, kw_only=True, eq=False)
class FloorMotionPair:
    """One motion of a set."""

    case: Case  #: the base case with this motion
    keys: Mapping[str, Any]  #: that set it
    horizontal: FloorComponent
    vertical: FloorComponent | None
    left_out: str | None  #: the part of the motion that a run covers, where it ends before it
    case_hash: str  #: of its case

    @property
    def name(self) -> str:
        """File of the horizontal motion."""
        return self.horizontal.name

    @property
    def components(self) -> tuple[FloorComponent, ...]:
        """The horizontal motion, and the vertical one where there is one."""
        return (self.horizontal,) if self.vertical is None else (self.horizontal, self.vertical)

    def numbers(self) -> dict[str, Any]:
        """Those of the horizontal motion, and of the vertical one as `vertical`; None without one."""
        vertical = None if self.vertical is None else self.vertical.numbers
        return {**self.horizontal.numbers, "vertical": vertical}


class MotionFacts(NamedTuple):
    """What is kept of a motion of a set once it has been read."""

    numbers: tuple[dict[str, Any], ...]  #: of its components
    contents: tuple[str, ...]  #: digests, equal for the same motion whatever its scale and sign
    left_out: str | None
    case_hash: str


def motion_cases(base: Case, axes: Iterable[Axis]) -> list[Case]:
    """The base case with each motion of a set; none without a set."""
    return list(map(CaseMaker(base), _keys_of(axes)))


def read_motion_set(
    base: Case, axes: Iterable[Axis], runner: Runner | None = None
) -> tuple[FloorMotionPair, ...]:
    """Read the motions of a set, as the base case takes them; none without a set.

    Args:
        base: case of the study.
        axes: of which one may hold a set.
        runner: whose workers read a large set; None: this process.

    Raises:
        CaseError: a file that cannot be used, components that were not sampled together, two motions of one file, two
            files that hold the same motion.
    """
    keys = _keys_of(axes)
    make = CaseMaker(base)
    pairs: list[FloorMotionPair] = []
    contents: dict[str, str] = {}
    owners: dict[Path, str] = {}
    for names, facts in zip(keys, _each(runner, "motions read", keys, partial(_read, make)), strict=True):
        case = make(names)
        horizontal, *rest = _components_of(case, facts.numbers)
        pair = FloorMotionPair(
            case=case,
            keys=names,
            horizontal=horizontal,
            vertical=rest[0] if rest else None,
            left_out=facts.left_out,
            case_hash=facts.case_hash,
        )
        for path in {real_path(pair.case.data_files[f"{part.table}.file"]) for part in pair.components}:
            if path in owners:
                raise CaseError(
                    f"{MOTION_FILE!r}: {owners[path]!r} and {pair.name!r} are motions of one file, {path.name}; those "
                    "of a set must be of different ones: leave one out"
                )
            owners[path] = pair.name
        for component, content in zip(pair.components, facts.contents, strict=True):
            if content in contents:
                raise CaseError(
                    f"{MOTION_FILE!r}: {component.name!r} and {contents[content]!r} hold the same motion; those of a "
                    "set must differ: leave one out"
                )
            contents[content] = component.name
        pairs.append(pair)
    return tuple(pairs)


def motions_left_out(base: Case, motions: Sequence[FloorMotionPair]) -> str | None:
    """The part of the motion that the runs cover, where they end before it; of a set, that of the first one cut.

    None where every motion is covered.
    """
    if not motions:
        return motion_left_out(base)
    cut = [(motion.name, motion.left_out) for motion in motions if motion.left_out is not None]
    if not cut:
        return None
    name, words = cut[0]
    return f"{words} ({name}{f', and {len(cut) - 1} more motions are cut' if len(cut) > 1 else ''})"


def write_motions(
    place: ResultFolder,
    motions: Sequence[FloorMotionPair],
    measures: Sequence[Mapping[str, Any]],
    outcomes: Columns,
    runner: Runner | None = None,
) -> list[str]:
    """Write `motions.csv`, `spectra.csv` and the figure of the spectra; returns the names of figures.

    Args:
        measures: of each motion, with its outcomes by these columns.
    """

    def upward(numbers: Mapping[str, Any]) -> dict[str, Any]:
        return {f"vertical_{name}": value for name, value in numbers.items()}

    columns = MEASURED | outcomes
    if any(measure["vertical"] for measure in measures):
        columns |= upward(MEASURED)
    rows = ({**measure, **upward(measure["vertical"] or {})} for measure in measures)
    place.write_text("motions.csv", table_of_rows(columns, rows))
    periods, spectra = spectra_of(motions, runner)
    samples = np.column_stack([periods, *spectra.values()]).tolist()
    place.write_text("spectra.csv", table_text(["period_s", *spectra], samples))
    vertical = [motion.vertical.name for motion in motions if motion.vertical is not None]
    place.write_text(SPECTRA, svg_of(draw_spectra(periods, spectra, vertical=vertical)))
    return [SPECTRA]


def spectra_of(
    motions: Sequence[FloorMotionPair], runner: Runner | None = None
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Periods (k,) [s] that all motions resolve, and pseudo-accelerations (k,) [m/s2] by `file`, 5 % damping."""
    step = max(component.step_s for motion in motions for component in motion.components)
    periods = log_spaced_periods(step, longest_s=max(LONGEST_PERIOD_S, 10.0 * step))
    work = partial(_spectra, CaseMaker(motions[0].case), periods)
    by_motion = _each(runner, "spectra", [motion.keys for motion in motions], work)
    return periods, {
        component.name: values
        for motion, spectra in zip(motions, by_motion, strict=True)
        for component, values in zip(motion.components, spectra, strict=True)
    }


def _keys_of(axes: Iterable[Axis]) -> list[dict[str, Any]]:
    """The keys that set each motion of a set; none without a set."""
    axis = set_axis(axes)
    if axis is None:
        return []
    rows = zip(*axis.following.values(), strict=True) if axis.following else repeat((), len(axis.values))
    return [
        {MOTION_FILE: name}
        | {key: value for key, value in zip(axis.following, row, strict=True) if value is not None}
        for name, row in zip(axis.values, rows, strict=True)
    ]


def _each(
    runner: Runner | None, what: str, items: Sequence[ItemT], work: Callable[[ItemT], FoundT]
) -> list[FoundT]:
    return runner.each(what, items, work) if runner and len(items) >= LARGE_SET else list(map(work, items))


def _components_of(case: Case, numbers: Iterable[Mapping[str, Any]]) -> tuple[FloorComponent, ...]:
    tables: list[tuple[MotionKey, str | None]] = [("motion", case.motion.file)]
    if case.vertical.kind == "table" and case.vertical.file is not None:
        tables.append(("vertical", case.vertical.file))
    return tuple(
        FloorComponent(name=name or "", case=case, table=table, numbers=facts)
        for (table, name), facts in zip(tables, numbers, strict=False)
    )


def _read(make: CaseMaker, keys: Mapping[str, Any]) -> MotionFacts:
    case = make(keys)
    numbers, contents = [], []
    for component in _components_of(case, repeat({})):
        motion = component.motion
        times, file = motion.times, case.data_files[f"{component.table}.file"]
        numbers.append(
            {
                "file": component.name,
                "duration_s": float(np.ptp(times)),
                "step_s": float(np.ptp(times)) / (times.size - 1),
                "samples": times.size,
            }
            | asdict(intensity(times, motion.accelerations))
            | {"sha256": hashlib.sha256(file.read_bytes()).hexdigest()}
        )
        contents.append(_content(motion))
    # Asked now, while the file is in memory.
    return MotionFacts(tuple(numbers), tuple(contents), motion_left_out(case), case_hash(case))


def _spectra(make: CaseMaker, periods: FloatArray, keys: Mapping[str, Any]) -> list[FloatArray]:
    motions = (component.motion for component in _components_of(make(keys), repeat({})))
    return [
        response_spectrum(
            *evenly_sampled(motion.times, motion.accelerations), periods
        ).pseudo_acceleration_m_s2
        for motion in motions
    ]


def _table(motion: object) -> TableMotion:
    if not isinstance(motion, TableMotion):
        raise CaseError(f'{MOTION_FILE!r}: the case has motion.kind other than "table"; take it out of [set]')
    return motion


def _content(motion: TableMotion) -> str:
    """A digest that is equal for the same motion, whatever its scale and sign."""
    values = motion.accelerations
    largest = values[np.argmax(np.abs(values))] or 1.0
    times = motion.times - motion.times[0]
    shape = np.round(np.concatenate([times / (times[-1] or 1.0), values / largest]), 6) + 0.0
    return hashlib.sha256(shape.tobytes()).hexdigest()
