"""The motions of a set: read once, checked against each other, with their measures and spectra.

A set is the values of `motion.file` in a study: recorded motions, alone or with a vertical component each.
"""

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact.motion.table import TableMotion
from fem.batch.axes import MOTION_FILE, Axis, set_axis, with_following
from fem.batch.log import table_text
from fem.batch.runner import motion_left_out
from fem.case.case import Case, CaseError
from fem.figures.motions import draw_spectra
from fem.figures.style import svg_of
from fem.model.motion import build_motion, build_vertical
from fem.records.intensity import intensity
from fem.records.spectrum import Spectrum, evenly_sampled, log_spaced_periods, response_spectrum
from fem.results.folder import ResultFolder
from fem.runtime.arrays import FloatArray

LONGEST_PERIOD_S = 4.0
SPECTRA = "figures/spectra.svg"


@dataclass(frozen=True, kw_only=True, eq=False)
class FloorComponent:
    """A horizontal or vertical motion, as the runs follow it."""

    name: str  #: of its file
    motion: TableMotion

    @property
    def step_s(self) -> float:
        """Mean interval of its samples [s]."""
        return float(np.ptp(self.motion.times)) / (self.motion.times.size - 1)

    def numbers(self) -> dict[str, Any]:
        """Length, interval, peaks and duration, by the names of `run.json`."""
        times = self.motion.times
        return {
            "file": self.name,
            "duration_s": float(np.ptp(times)),
            "step_s": self.step_s,
            "samples": times.size,
        } | asdict(intensity(times, self.motion.accelerations))

    def spectrum(self, periods_s: FloatArray) -> Spectrum:
        """Response spectrum for 5 % of damping."""
        return response_spectrum(*evenly_sampled(self.motion.times, self.motion.accelerations), periods_s)


@dataclass(frozen=True, kw_only=True, eq=False)
class FloorMotionPair:
    """One motion of a set."""

    case: Case  #: the base case with this motion
    horizontal: FloorComponent
    vertical: FloorComponent | None
    left_out: str | None  #: the part of the motion that a run covers, where it ends before it

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
        vertical = None if self.vertical is None else self.vertical.numbers()
        return self.horizontal.numbers() | {"vertical": vertical}


def motion_cases(base: Case, axes: Iterable[Axis]) -> list[Case]:
    """The base case with each motion of a set; none without a set."""
    axis = set_axis(axes)
    if axis is None:
        return []
    return [base.with_values(with_following([axis], {MOTION_FILE: name})) for name in axis.values]


def read_motion_set(base: Case, axes: Iterable[Axis]) -> tuple[FloorMotionPair, ...]:
    """Read the motions of a set, as the base case takes them; none without a set.

    Raises:
        CaseError: a file that cannot be used, components that were not sampled together, two motions of one file, two
            files that hold the same motion.
    """
    found: list[FloorMotionPair] = []
    contents: dict[str, str] = {}
    owners: dict[Path, str] = {}
    for case in motion_cases(base, axes):
        pair = _read_pair(case)
        for path in {case.data_files[f"{table}.file"].resolve() for table in _tables_of(pair)}:
            if path in owners:
                raise CaseError(
                    f"{MOTION_FILE!r}: {owners[path]!r} and {pair.name!r} are motions of one file, {path.name}; those "
                    "of a set must be of different ones: leave one out"
                )
            owners[path] = pair.name
        for component, content in zip(pair.components, _contents(pair), strict=True):
            if content in contents:
                raise CaseError(
                    f"{MOTION_FILE!r}: {component.name!r} and {contents[content]!r} hold the same motion; those of a "
                    "set must differ: leave one out"
                )
            contents[content] = component.name
        found.append(pair)
    return tuple(found)


def motions_left_out(base: Case, motions: Sequence[FloorMotionPair]) -> str | None:
    """The part of the motion that the runs cover, where they end before it; of a set, that of the first one cut.

    None where every motion is covered.
    """
    if not motions:
        return motion_left_out(base)
    cut = [(one.name, one.left_out) for one in motions if one.left_out is not None]
    if not cut:
        return None
    name, words = cut[0]
    return f"{words} ({name}{f', and {len(cut) - 1} more motions are cut' if len(cut) > 1 else ''})"


def write_motions(
    place: ResultFolder, motions: Sequence[FloorMotionPair], measures: Sequence[Mapping[str, Any]]
) -> list[str]:
    """Write `motions.csv`, `spectra.csv` and the figure of the spectra; returns the names of figures.

    Args:
        place: the folder of a study.
        motions: of the set.
        measures: of each motion, with its outcomes.
    """
    place.write_text("motions.csv", _motions_table(measures))
    periods, spectra = spectra_of(motions)
    rows = np.column_stack([periods, *spectra.values()]).tolist()
    place.write_text("spectra.csv", table_text(["period_s", *spectra], rows))
    vertical = [one.vertical.name for one in motions if one.vertical is not None]
    place.write_text(SPECTRA, svg_of(draw_spectra(periods, spectra, vertical=vertical)))
    return [SPECTRA]


def spectra_of(motions: Sequence[FloorMotionPair]) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Periods (k,) [s] that all motions resolve, and pseudo-accelerations (k,) [m/s2] by `file`."""
    components = [one for motion in motions for one in motion.components]
    step = max(one.step_s for one in components)
    periods = log_spaced_periods(step, longest_s=max(LONGEST_PERIOD_S, 10.0 * step))
    return periods, {one.name: one.spectrum(periods).pseudo_acceleration_m_s2 for one in components}


def _motions_table(measures: Sequence[Mapping[str, Any]]) -> str:
    """`motions.csv`: a row a motion, the numbers of its vertical component with `vertical_` before them."""
    columns = [name for name in measures[0] if name != "vertical"]
    verticals: Mapping[str, Any] = next((one["vertical"] for one in measures if one["vertical"]), {})
    return table_text(
        [*columns, *(f"vertical_{name}" for name in verticals)],
        (
            [*(one[name] for name in columns), *((one["vertical"] or {}).get(name) for name in verticals)]
            for one in measures
        ),
    )


def _read_pair(case: Case) -> FloorMotionPair:
    horizontal = FloorComponent(name=case.motion.file or "", motion=_table(build_motion(case)))
    vertical = None
    if case.vertical.kind == "table" and case.vertical.file is not None:
        vertical = FloorComponent(name=case.vertical.file, motion=_table(build_vertical(case)))
    # Asked now: of a large set, the files are no longer in memory later.
    return FloorMotionPair(
        case=case, horizontal=horizontal, vertical=vertical, left_out=motion_left_out(case)
    )


def _tables_of(pair: FloorMotionPair) -> tuple[str, ...]:
    return ("motion",) if pair.vertical is None else ("motion", "vertical")


def _table(motion: object) -> TableMotion:
    if not isinstance(motion, TableMotion):
        raise CaseError(f'{MOTION_FILE!r}: the case has motion.kind other than "table"; take it out of [set]')
    return motion


def _contents(pair: FloorMotionPair) -> Iterator[str]:
    """A digest that is equal for components of the same motion, whatever their scale and sign."""
    for one in pair.components:
        values = one.motion.accelerations
        largest = values[np.argmax(np.abs(values))] or 1.0
        times = one.motion.times - one.motion.times[0]
        shape = np.round(np.concatenate([times / (times[-1] or 1.0), values / largest]), 6) + 0.0
        yield hashlib.sha256(shape.tobytes()).hexdigest()
