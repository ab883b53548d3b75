"""The floor, its motion, the static rule, the boxes of a stack and what stands beside a container, in words."""

import math
from collections.abc import Sequence

from contact.stepping.modes import ROCKING as ROCKING_SHARE
from fem.case.case import Case
from fem.case.tables.input_ranges import MU_KINETIC, STRIBECK, WEAKENING
from fem.case.tables.unknown_inputs import in_words
from fem.records.units import STANDARD_GRAVITY
from fem.results.figures import BOX_FIGURES
from fem.results.outcome import ROCKING, SLIDING, Outcome, least_slide
from fem.results.run_result import (
    WHOLE,
    Band,
    BoxReach,
    ChangedRun,
    FloorNumbers,
    HeldReach,
    JointDemand,
    MotionResult,
    Plane,
    RunResult,
    Sides,
    StaticResult,
    Verdict,
)
from fem.run.sureness import below_uplift, rests_on_stiff_floor
from fem.run.words import paragraphs, rows, sentence
from fem.runtime.units import JOINT_MILLIMETRES, MANY, METRES, SHORT_MILLIMETRES, Reach, in_figures
from fem.seismic.wind import COMBINATION

FRICTION = {MU_KINETIC, WEAKENING, STRIBECK}
ROUNDING = 1e-9  #: share of a peak
LEAST = 0.1  #: of a number in a unit, before a smaller unit is taken
NAMES = {"table": "record", "pulse": "pulse"}
AS_ONE = "the boxes moved as one"


def motion_in_words(motion: MotionResult) -> str:
    """Length, samples and peaks of one motion; empty of a floor at rest, and of a result of an older version."""
    return sentence(
        "motion.txt.j2",
        motion=motion,
        # the residual at the end of a motion; 0 where it is rounding error
        beside=lambda residual, peak: 0.0 if abs(residual) <= ROUNDING * (peak or 0.0) else residual,
        GRAVITY=STANDARD_GRAVITY,
    )


def doubts(motion: MotionResult, case: Case) -> tuple[str, ...]:
    """Doubts about a case: those of records, a floor that falls with g, a mass centre of a box of another height."""
    upward, box = motion.vertical, case.container
    changed = {override.partition("=")[0] for override in case.overrides} & {
        "container.height_m",
        "container.centroid_m",
    }
    left: tuple[str, ...] = ()
    if changed == {"container.height_m"} and box.centroid_m != 0.5 * box.height_m:
        left = (
            f"height_m was set to {box.height_m:g} m, and the mass centre stays at {box.centroid_m:g} m, where the "
            "case states it; set container.centroid_m, too, if it moves",
        )
    if upward is None:
        return (*motion.notes, *left)
    falls = (upward.peak_in_run_m_s2 or 0.0) >= case.gravity_m_s2
    note = (
        f"the vertical acceleration of the floor reaches {upward.peak_in_run_m_s2:.4g} m/s2, gravity or more: where it "
        "is downward, the floor bears nothing and the container leaves it"
    )
    return (*motion.notes, *upward.notes, *((note,) if falls else ()), *left)


def part_covered(motion: MotionResult) -> str:
    """The part of its motion that a run covers, with a peak that is not in it; empty where it covers the whole."""
    upward = motion.vertical
    known = [one for one in (motion, upward) if one is not None and one.covered is not None]
    cut = min(known, key=lambda one: one.covered or 0.0, default=motion)
    if motion.few_periods is not None:
        return f"{motion.few_periods:.2g} periods, {motion.duration_s:.3g} s"
    if cut.covered is None or cut.duration_s is None or cut.covered >= WHOLE:
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
    verdict = result.verdict or Verdict()
    beside = verdict.neighbours or ()
    count = len(beside) + len(result.stops or ()) + len(result.ties or ())
    ranges = (verdict.band or Band()).links or [HeldReach()] * count
    return "; ".join(paragraphs("held.txt.j2", result=result, neighbours=beside, ranges=ranges))


def fall_in_row(verdict: Verdict) -> tuple[float, int, str] | None:
    """When the first neighbour of a row overturned [s], its number and side; None where none did."""
    beside = enumerate(verdict.neighbours or (), 1)
    fallen = ((one.overturned_at_s, number, one.side) for number, one in beside)
    return min(((at, number, side) for at, number, side in fallen if at is not None), default=None)


def used(utilisation: float | None, demand: float | None) -> float | None:
    """A utilisation; `run.json` has none of a demand without any capacity: it is infinite."""
    return math.inf if utilisation is None and demand else utilisation


def rule_says(check: str, utilisation: float | None) -> str:
    """What the static rule concludes from a utilisation, for `sliding`, `overturning` or `lifting`."""
    if not utilisation:  # a push or a tilt at the start is no load that the rule knows
        return "-" if utilisation is None else "no demand"
    below, beyond = {
        "lifting": ("stays", "lifts off"),
        "sliding": ("holds", "slides"),
        "overturning": ("stands", "overturns"),
    }[check]
    return beyond if utilisation > 1.0 else below


def sides_of(width: float, depth: float, static: StaticResult) -> Sides | None:
    """The planes of a rectangular base under the same motion; None of a square one.

    Sliding is the same in both; the capacity against overturning is in proportion to the width.
    """
    sliding, use = static.ruling.utilisation_sliding, static.ruling.utilisation_overturning
    if width == depth or not use:
        return None
    computed, other = (
        Plane(width_m=size, utilisation_sliding=sliding, utilisation_overturning=use * width / size)
        for size in (width, depth)
    )
    return Sides(governing="computed" if width < depth else "other", computed=computed, other=other)


def sides_in_words(sides: Sides | None) -> str:
    """A sentence where the side that was not computed governs; empty elsewhere."""
    if sides is None or sides.governing == "computed":
        return ""
    own, other = (METRES.text(plane.width_m, figures=4) for plane in (sides.computed, sides.other))
    use = sides.other.utilisation_overturning or 0.0
    says = rule_says("overturning", use)
    return (
        f". This is the {own} side; the {other} side governs ({says}, {use:.3f}; --both-sides computes both)"
    )


def code_note(static: StaticResult) -> str:
    """The note below the rows of the code and of the wind; empty where there are none."""
    return sentence("code_note.txt.j2", static=static, COMBINATION=COMBINATION)


def governing(result: RunResult) -> list[str]:
    """One sentence each for sliding and rocking where the static rule holds and the run moves it: which governs.

    Where friction drops at once, a moment of vibration can decide; a soft bed opens from the edge. A static rule knows
    of neither, and treats the container as one body on its floor: it does not cover the joints of a loose stack.
    """
    verdict, static = result.verdict or Verdict(), result.static or StaticResult()
    members = verdict.band.members if verdict.band is not None else ()
    least, _ = limits(static)
    laws = [
        member for member in members if member.values and member.outcome and set(member.values) <= FRICTION
    ]
    holding = [member for member in laws if not _slides(member, least)]
    still = (Outcome.REST, Outcome.SLIDE)
    resting = [member for member in members[1:] if member.kind == "one" and member.outcome in still]
    return paragraphs(
        "governing.txt.j2",
        verdict=verdict,
        rule=static.ruling,
        members=members,
        slides_on_floor=_slides(verdict, least),
        joint_slip=largest_joint_slip(verdict),
        laws=len(laws),
        holding=in_words(holding[0].values or {}) if holding else "",
        rocks=verdict.outcome in (*ROCKING, Outcome.OVERTURNED) and not fall_in_row(verdict),
        rests_on_stiff_floor=rests_on_stiff_floor(members),
        below_uplift=below_uplift(members),
        resting=in_words(resting[0].values or {}) if resting else "",
    )


def _slides(run: Verdict | ChangedRun, least: float) -> bool:
    """True if it slides on the floor: in a loose stack, if its lowest box slides by more than `least` [m]."""
    return run.outcome in SLIDING and (not run.boxes or run.boxes[0].max_slip_m > least)


def joints_in_words(verdict: Verdict, static: StaticResult | None) -> str:
    """How the boxes of a loose stack moved on one another: the largest slip and opening, with ranges; empty of one."""
    if len(verdict.boxes or ()) < 2:
        return ""
    slip_limit, opening_limit = limits(static or StaticResult())
    moved = []
    for verb, preposition, key, limit, unit in (
        ("slid", "on", "max_slip_m", slip_limit, JOINT_MILLIMETRES),
        ("opened", "from", "max_opening_m", opening_limit, SHORT_MILLIMETRES),
    ):
        most, own, reach = _farthest(verdict, key)
        if max((own, *(reach or ()))) > limit:
            moved.append(f"box {most + 1} {verb} {unit.text(own, reach)} {preposition} box {most}")
    return ", ".join(moved) or AS_ONE


def largest_joint_slip(verdict: Verdict) -> tuple[str, str]:
    """The largest slip of a box on another with its range, and which slid on which; empty of one body."""
    if len(verdict.boxes or ()) < 2:
        return "", ""
    most, own, reach = _farthest(verdict, "max_slip_m")
    return JOINT_MILLIMETRES.text(own, reach), f"box {most + 1} on box {most}"


def _farthest(verdict: Verdict, key: str) -> tuple[int, float, Reach | None]:
    """The box that moves farthest on the one below, in any variation: its index, figure and range."""
    moved: list[tuple[float, Reach | None]] = [
        (box[key], reach[key] if reach else None)
        for box, reach in zip(verdict.boxes or (), box_reaches(verdict), strict=True)
    ]
    most = max(range(1, len(moved)), key=lambda k: max((moved[k][0], *(moved[k][1] or ()))))
    return most, *moved[most]


def limits(static: StaticResult) -> tuple[float, float]:
    """Slip and opening from which a joint counts as sliding and rocking [m], by the limits of the whole stack."""
    centroid, angle = static.centroid_m, static.slenderness_angle_rad
    if centroid is None or angle is None:
        return SHORT_MILLIMETRES.least, SHORT_MILLIMETRES.least
    width = 2.0 * centroid * math.tan(angle)
    return least_slide(width), ROCKING_SHARE * angle * width


def box_rows(result: RunResult) -> list[tuple[str, ...]]:
    """Box, largest rotation in degrees, slip, slip left and opening in mm, whether it fell; from the floor up.

    With their ranges over the band, and in how many of its runs the box fell first.
    """
    verdict = result.verdict or Verdict()
    rows: list[tuple[str, ...]] = []
    members = len(verdict.band.members) if verdict.band is not None else 0
    for number, (box, reach) in enumerate(zip(verdict.boxes or (), box_reaches(verdict), strict=True), 1):
        of_band = f"in {reach.fell} of {members} runs" if reach and reach.fell else ""
        figures = (
            figure.text(box[key], reach[key] if reach else None, bare=True)
            for key, figure in BOX_FIGURES.items()
        )
        rows.append((str(number), *figures, ", ".join(filter(None, ("fell" if box.fell else "", of_band)))))
    return rows


def box_reaches(verdict: Verdict) -> Sequence[BoxReach | None]:
    """The ranges of each box over the band, where there is one."""
    ranges = verdict.band.boxes if verdict.band is not None else None
    return ranges or [None] * len(verdict.boxes or ())


def unbolted(joint: JointDemand) -> str:
    """What the joint would do without bolts."""
    events = (("opens", joint.opens_at_s), ("slides", joint.slides_at_s))
    instants = [f"{verb} at {instant:.3g} s" for verb, instant in events if instant is not None]
    return ", ".join(instants) or "stays closed, sticks"
