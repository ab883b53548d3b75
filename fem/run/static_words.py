"""The static rule in words: what it concludes, which side governs, whose values the code has, and rule against run."""

from fem.case.tables.input_ranges import MU_KINETIC, STRIBECK, WEAKENING
from fem.case.tables.unknown_inputs import in_words
from fem.results.outcome import ROCKING, SLIDING, Outcome
from fem.results.run_result import ChangedRun, Plane, RunResult, Sides, StaticResult, Verdict
from fem.run.described import fall_in_row
from fem.run.joints import largest_joint_slip, limits
from fem.run.sureness import below_uplift, rests_on_stiff_floor
from fem.run.words import paragraphs, sentence
from fem.runtime.units import METRES
from fem.seismic.wind import COMBINATION

FRICTION = {MU_KINETIC, WEAKENING, STRIBECK}


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
