"""The floor, its motion, and what stands beside a container, in words: of a case, and of what happened."""

from fem.case.case import Case
from fem.records.units import STANDARD_GRAVITY
from fem.results.run_result import FloorNumbers, MotionResult, RunResult, Verdict
from fem.run.joints import leaning_in_words
from fem.run.words import paragraphs, rows, sentence
from fem.runtime.units import MANY, in_figures

ROUNDING = 1e-9  #: share of a peak
LEAST = 0.1  #: of a number in a unit, before a smaller unit is taken
NAMES = {"table": "record", "pulse": "pulse"}


def motion_in_words(motion: MotionResult) -> str:
    """Length, samples and peaks of one motion; empty of a floor at rest, and of a result of an older version."""

    def beside(residual: float, peak: float | None) -> float:
        """The residual at the end of a motion; 0 where it is rounding error."""
        return 0.0 if abs(residual) <= ROUNDING * (peak or 0.0) else residual

    return sentence("motion.txt.j2", motion=motion, beside=beside, GRAVITY=STANDARD_GRAVITY)


def doubts(motion: MotionResult, gravity: float) -> tuple[str, ...]:
    """Doubts about the floor's motions under this gravity [m/s2]: those of records, and a floor that falls with g."""
    upward = motion.vertical
    if upward is None:
        return motion.notes
    falls = (upward.peak_in_run_m_s2 or 0.0) >= gravity
    note = (
        f"the vertical acceleration of the floor reaches {upward.peak_in_run_m_s2:.4g} m/s2, gravity or more: where it "
        "is downward, the floor bears nothing and the container leaves it"
    )
    return (*motion.notes, *upward.notes, *((note,) if falls else ()))


def part_covered(motion: MotionResult) -> str:
    """The part of its motion that a run covers, with a peak that is not in it; empty where it covers the whole."""
    cut, upward = motion, motion.vertical
    if (
        upward is not None
        and upward.covered is not None
        and (motion.covered is None or upward.covered < motion.covered)
    ):
        cut = upward
    if cut.covered is None or cut.duration_s is None or cut.covered >= 1.0 - 1e-9:
        return ""
    part = f"{cut.covered * cut.duration_s:.4g} of {cut.duration_s:.4g} s"
    words = f"the first {part}" if cut.begin_s is None else f"{part}, from {-cut.begin_s:.4g} s of it on"
    if cut is upward:
        words += " (vertical motion)"
    for one, name in ((motion, NAMES.get(motion.kind or "", "motion")), (upward, "vertical motion")):
        whole, within = (one.peak_acceleration_m_s2, one.peak_in_run_m_s2) if one else (None, None)
        if whole is not None and within is not None and within < whole * (1.0 - 1e-9):
            words += f"; the {name}'s peak of {whole / STANDARD_GRAVITY:.3g} g is not in it"
    return words


def floor_rows(floor: FloorNumbers | None, *, lands: bool = True) -> list[tuple[str, str]]:
    """Name and value in everyday units; empty for a rigid, level floor. `lands`: whether it may land on a corner."""

    def in_units(value: float, *named: tuple[str, float]) -> str:
        """Three figures in the first of the units, largest first, in which the number is not small."""
        name, factor = next(((name, factor) for name, factor in named if value * factor >= LEAST), named[-1])
        return f"{in_figures(value, MANY - 1, factor)} {name}"

    return [] if floor is None else rows("floor.txt.j2", floor=floor, lands=lands, in_units=in_units)


def link_rows(case: Case) -> list[tuple[str, str]]:
    """Each stop, tie and neighbour of a case: name and what it is."""
    return rows("links.txt.j2", case=case)


def links_in_words(result: RunResult) -> str:
    """What each stop, tie and neighbour did, without a full stop; empty where there are none."""
    neighbours = (result.verdict or Verdict()).neighbours or ()
    return "; ".join(paragraphs("held.txt.j2", result=result, neighbours=neighbours))


def fall_in_row(verdict: Verdict) -> str:
    """Who overturned first in a row, and when; empty where there are no neighbours or none of them did."""
    fallen = [
        (one.overturned_at_s, number, one.side)
        for number, one in enumerate(verdict.neighbours or (), 1)
        if one.overturned_at_s is not None
    ]
    if not fallen:
        return ""
    at, number, side = min(fallen)
    name = f"neighbour {number} on the {side}"
    if verdict.leans:
        return leaning_in_words(name, verdict)
    return f"{name} overturned at t = {at:.3f} s, where the run ends"
