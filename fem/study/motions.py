"""The motions of a set: read once, checked against each other, with their measures and spectra.

A set is the values of `motion.file` in a study: recorded motions, alone or with a vertical component each.
"""

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from contact.motion.table import TableMotion
from fem.case.case import Case, CaseError, case_hash
from fem.figures.motions import draw_spectra
from fem.figures.style import svg_of
from fem.model.motion import build_motion, build_motions, motion_result
from fem.records.intensity import Intensity, intensity
from fem.records.spectrum import evenly_sampled, log_spaced_periods, response_spectrum
from fem.results.figures import types_of
from fem.results.folder import ResultFolder
from fem.results.outcome import COUNTED
from fem.run.described import part_covered
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import real_path
from fem.study.axes import MOTION_FILE, VERTICAL_FILE, Axis, with_following
from fem.study.design import CaseMaker
from fem.study.runner import Runner
from fem.study.table import Columns, table_of_rows, table_text
from fem.study.workers import FoundT, ItemT

LONGEST_PERIOD_S = 4.0
SPECTRA = "figures/spectra.svg"
#: columns of a component of a motion
MEASURED: Columns = {"file": str, "duration_s": float, "step_s": float, "samples": int}
MEASURED |= types_of(Intensity) | {"sha256": str}
LARGE_SET = 32  #: motions from which several workers read them


@dataclass(frozen=True, kw_only=True, eq=False)
class FloorMotionPair:
    """One motion of a set; its samples are not kept."""

    case: Case  #: the base case with this motion
    keys: Mapping[str, Any]  #: that set it
    #: of the horizontal, and of the vertical component where there is one
    measures: tuple[Mapping[str, Any], ...]
    contents: tuple[str, ...]  #: digests of these, equal for the same motion whatever its scale and sign
    left_out: str | None  #: the part of the motion that a run covers, where it ends before it
    case_hash: str  #: of its case

    @property
    def name(self) -> str:
        """File of the horizontal motion."""
        return str(self.measures[0]["file"])

    def numbers(self) -> dict[str, Any]:
        """Those of the horizontal motion, and of the vertical one as `vertical`; None without one."""
        return {**self.measures[0], "vertical": next(iter(self.measures[1:]), None)}


def read_motion_set(
    base: Case, axis: Axis | None, runner: Runner | None = None
) -> tuple[FloorMotionPair, ...]:
    """Read the motions of a set, as the base case takes them; none without a set.

    The workers of a runner read a large set. CaseError for a file that cannot be used, components that were not sampled
    together, two motions of one file, two files that hold the same motion.
    """
    keys = [with_following([axis], {axis.key: name}) for name in axis.values] if axis else []
    pairs = _each(runner, "motions read", keys, partial(_read, CaseMaker(base)))
    contents, owners = dict[str, str](), dict[Path, str]()
    for pair in pairs:
        keys_of_files = (MOTION_FILE, VERTICAL_FILE)[: len(pair.measures)]
        for path in {real_path(pair.case.data_files[key]) for key in keys_of_files}:
            if path in owners:
                raise CaseError(
                    f"{MOTION_FILE!r}: {owners[path]!r} and {pair.name!r} are motions of one file, {path.name}; those "
                    "of a set must be of different ones: leave one out"
                )
            owners[path] = pair.name
        for measures, content in zip(pair.measures, pair.contents, strict=True):
            if content in contents:
                raise CaseError(
                    f"{MOTION_FILE!r}: {measures['file']!r} and {contents[content]!r} hold the same motion; those of a "
                    "set must differ: leave one out"
                )
            contents[content] = measures["file"]
    return tuple(pairs)


def motions_left_out(base: Case, motions: Sequence[FloorMotionPair] = ()) -> str | None:
    """The part of the motion that the runs cover, where they end before it; of a set, that of the first one cut.

    None where every motion is covered.
    """
    if not motions:
        try:
            return part_covered(motion_result(base, *build_motions(base))) or None
        except CaseError:  # a row of the study says so
            return None
    cut = [f"{motion.left_out} ({motion.name}" for motion in motions if motion.left_out is not None]
    more = f", and {len(cut) - 1} more motions are cut" if len(cut) > 1 else ""
    return f"{cut[0]}{more})" if cut else None


def write_motions(
    place: ResultFolder,
    motions: Sequence[FloorMotionPair],
    outcomes: Sequence[Mapping[str, int]],
    runner: Runner | None = None,
) -> dict[str, Any]:
    """Write `motions.csv`, `spectra.csv` and the figure of the spectra; returns what the result says of them.

    `outcomes`: of each motion, as `COUNTED`.
    """
    measures = [{**motion.numbers(), **outcome} for motion, outcome in zip(motions, outcomes, strict=True)]

    def upward(numbers: Mapping[str, Any]) -> dict[str, Any]:
        return {f"vertical_{name}": value for name, value in numbers.items()}

    columns: Columns = MEASURED | dict.fromkeys(COUNTED, int)
    columns |= upward(MEASURED) if any(measure["vertical"] for measure in measures) else {}
    rows = ({**measure, **upward(measure["vertical"] or {})} for measure in measures)
    place.write("motions.csv", table_of_rows(columns, rows))
    periods, spectra = spectra_of(motions, runner)
    samples = np.column_stack([periods, *spectra.values()]).tolist()
    place.write("spectra.csv", table_text(["period_s", *spectra], samples))
    vertical = [measure["vertical"]["file"] for measure in measures if measure["vertical"]]
    place.write(SPECTRA, svg_of(draw_spectra(periods, spectra, vertical=vertical)))
    return {"motions": tuple(measures), "motion_figures": (SPECTRA,)}


def spectra_of(
    motions: Sequence[FloorMotionPair], runner: Runner | None = None
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Periods (k,) [s] that all motions resolve, and pseudo-accelerations (k,) [m/s2] by `file`, 5 % damping."""
    step = max(measures["step_s"] for motion in motions for measures in motion.measures)
    periods = log_spaced_periods(step, longest_s=max(LONGEST_PERIOD_S, 10.0 * step))
    work = partial(_spectra, CaseMaker(motions[0].case), periods)
    found = _each(runner, "spectra", [motion.keys for motion in motions], work)
    return periods, {
        measures["file"]: values
        for motion, spectra in zip(motions, found, strict=True)
        for measures, values in zip(motion.measures, spectra, strict=True)
    }


def _each(
    runner: Runner | None, what: str, items: Sequence[ItemT], work: Callable[[ItemT], FoundT]
) -> list[FoundT]:
    return runner.each(what, items, work) if runner and len(items) >= LARGE_SET else list(map(work, items))


def _components(case: Case) -> Iterator[tuple[str, TableMotion]]:
    """The horizontal motion of a case, and the vertical one where there is one; with the keys of their files."""
    motions = {MOTION_FILE: build_motion(case)}
    if case.vertical.kind == "table":
        motions[VERTICAL_FILE] = build_motion(case, "vertical")
    for key, motion in motions.items():
        if not isinstance(motion, TableMotion):
            other = 'the case has motion.kind other than "table"'
            raise CaseError(f"{MOTION_FILE!r}: {other}; take it out of [set]")
        yield key, motion


def _read(make: CaseMaker, keys: Mapping[str, Any]) -> FloorMotionPair:
    case, measures, contents = make(keys), [], []
    for key, motion in _components(case):
        times, length = motion.times, float(np.ptp(motion.times))
        name = (case.motion if key == MOTION_FILE else case.vertical).file
        numbers = {"file": name, "duration_s": length}
        numbers |= {"step_s": length / (times.size - 1), "samples": times.size}
        digest = hashlib.sha256(case.data_files[key].read_bytes()).hexdigest()
        measures.append(numbers | asdict(intensity(times, motion.accelerations)) | {"sha256": digest})
        values, since = motion.accelerations, times - times[0]
        largest = values[np.argmax(np.abs(values))] or 1.0  # with its sign
        shape = np.round(np.concatenate([since / (since[-1] or 1.0), values / largest]), 6) + 0.0
        contents.append(hashlib.sha256(shape.tobytes()).hexdigest())
    return FloorMotionPair(
        case=case,
        keys=keys,
        measures=tuple(measures),
        contents=tuple(contents),
        left_out=motions_left_out(case),  # asked now, while the file is in memory
        case_hash=case_hash(case),
    )


def _spectra(make: CaseMaker, periods: FloatArray, keys: Mapping[str, Any]) -> list[FloatArray]:
    return [
        response_spectrum(*evenly_sampled(motion.times, motion.accelerations), periods)
        for _, motion in _components(make(keys))
    ]
