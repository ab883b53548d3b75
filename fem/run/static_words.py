"""The static rule in words: what it concludes, which side governs, whose values the code has, and rule against run."""

from collections.abc import Sequence

from fem.case.tables.input_ranges import MU_KINETIC, STRIBECK, WEAKENING
from fem.case.tables.unknown_inputs import in_words
from fem.results.outcome import ROCKING, SLIDING, Outcome
from fem.results.run_result import ChangedRun, Plane, RunResult, Sides, StaticResult, Verdict
from fem.run.described import fall_in_row
from fem.run.joints import largest_joint_slip, limits
from fem.run.sureness import below_uplift, rests_on_stiff_floor
from fem.runtime.units import METRES
from fem.seismic.wind import COMBINATION

FRICTION = {MU_KINETIC, WEAKENING, STRIBECK}
WITHOUT_BAND = "; only the band can tell which of the two governs (--band)."


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
    own = static.ruling
    use = own.utilisation_overturning
    if width == depth or not use:
        return None
    planes = (
        Plane(
            width_m=size,
            utilisation_sliding=own.utilisation_sliding,
            utilisation_overturning=use * width / size,
        )
        for size in (width, depth)
    )
    return Sides(
        governing="computed" if width < depth else "other", computed=next(planes), other=next(planes)
    )


def sides_in_words(sides: Sides | None) -> str:
    """A sentence where the side that was not computed governs; empty elsewhere."""
    if sides is None or sides.governing == "computed":
        return ""
    own, other = (METRES.text(plane.width_m, figures=4) for plane in (sides.computed, sides.other))
    use = sides.other.utilisation_overturning or 0.0
    says = rule_says("overturning", use)
    return f". Only the {own} side was computed; the {other} side governs ({says}, {use:.3f}; --both-sides computes it)"


def code_note(static: StaticResult) -> str:
    """The note below the rows of the code and of the wind; empty where there are none."""
    values, note = static.code_values, ""
    if static.wind is not None:
        note = (
            "The wind (1.5 of it, 0.9 of the weight, level floor) acts on the container as it is; check it empty, too. "
            f"{COMBINATION} "
        )
    if static.code is None or values is None:
        return note.rstrip()
    note += (
        f"The code's rows take the values of the case: a_gR = {values.ground_acceleration_m_s2:g} m/s2, S = "
        f"{values.soil_factor:g}, q = {values.behaviour_factor:g}, gamma_I = {values.importance_factor:g}, T_C = "
        f"{values.corner_period_s:g} s. They are a design response (EN 1998-1:2004, 4.3.3.2), not the motion of this "
        "floor; they are not compared with the run."
    )
    if static.method_applicable is not False:
        return note
    reason = "the rocking period is too long"
    if static.period_eq3_s is not None and static.period_limit_s is not None:
        limit = f"min(4 T_C, 2 s) = {static.period_limit_s:.3g} s"
        reason = f"the rocking period, {static.period_eq3_s:.3g} s, is above {limit}"
    return f"{note} The lateral force method does not apply: {reason} ({static.clause})."


def governing(result: RunResult) -> tuple[str, ...]:
    """One sentence each for sliding and rocking where the static rule holds and the run moves it: which governs.

    The rule treats the container as one body on its floor; it does not cover the joints of a loose stack.
    """
    verdict, static = result.verdict or Verdict(), result.static or StaticResult()
    members = verdict.band.members if verdict.band is not None else ()
    own, (least, _), sentences = static.ruling, limits(static), []
    if (use := own.utilisation_sliding) and use <= 1.0 and verdict.outcome in SLIDING:
        if _slides(verdict, least):
            why = _on_sliding(members, least) if members else WITHOUT_BAND
            sentences.append(f"Sliding: the static rule holds at {use:.3f} and the run slid{why}")
        else:
            slip, joint = largest_joint_slip(verdict)
            sentences.append(
                f"Sliding: the static rule holds at {use:.3f}, and the stack does not slide on the floor. The rule "
                f"does not cover the joints between its boxes, where the run slid {slip} ({joint})."
            )
    use, rocks = own.utilisation_overturning, verdict.outcome in (*ROCKING, Outcome.OVERTURNED)
    if use and use <= 1.0 and rocks and not fall_in_row(verdict):
        why = _on_rocking(members) if members else WITHOUT_BAND
        sentences.append(f"Rocking: the static rule stands at {use:.3f} and the run rocked{why}")
    return tuple(sentences)


def _slides(run: Verdict | ChangedRun, least: float) -> bool:
    """True if it slides on the floor: in a loose stack, if its lowest box slides by more than `least` [m]."""
    return run.outcome in SLIDING and (not run.boxes or run.boxes[0].max_slip_m > least)


def _on_sliding(members: Sequence[ChangedRun], least: float) -> str:
    """Where friction drops at once, a moment of vibration can decide; a static rule cannot know of it."""
    laws = [
        member for member in members if member.values and member.outcome and set(member.values) <= FRICTION
    ]
    holding = [in_words(member.values or {}) for member in laws if not _slides(member, least)]
    if holding:
        return (
            f". The rule governs: with {holding[0]} the container does not slide. The run slid because friction "
            "dropped to the kinetic one in a moment of vibration and stayed there."
        )
    tried = f"it slides with every friction law tried ({len(laws)})" if laws else "its friction does not drop"
    return f". The run governs: {tried}."


def _on_rocking(members: Sequence[ChangedRun]) -> str:
    """A soft bed opens from the edge, and an input may decide whether it rocks."""
    if rests_on_stiff_floor(members):
        return (
            ". The rule governs: the motion is below uplift of a rigid block, and on a floor thirty times as stiff the "
            "container does not rock. The run rocked because its soft bed opens from the edge."
        )
    if below_uplift(members):
        return (
            ". Inconclusive: the motion is below uplift of a rigid block, but the container rocks even on a floor "
            "thirty times as stiff, because it opens from the edge of its own base."
        )
    for member in members[1:]:
        if member.kind == "one" and member.outcome in (Outcome.REST, Outcome.SLIDE):
            return f". Inconclusive: with {in_words(member.values or {})} it does not rock."
    return ". The run governs: it rocks with every single change tried."
