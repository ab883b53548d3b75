"""Which result governs where the static rule and the run disagree: the rule says that the container holds or stands,
and the run moves it.

The rule treats the container as one body on its floor; it does not cover the joints of a loose stack.
"""

from collections.abc import Sequence

from fem.assessment.link_words import fall_in_row
from fem.assessment.loose_boxes import largest_joint_slip, limits
from fem.assessment.sureness import below_uplift, rests_on_stiff_floor
from fem.case.tables.input_keys import MU_KINETIC, STRIBECK, WEAKENING
from fem.case.tables.unknown_inputs import WORDS, in_words
from fem.results.outcome import ROCKING, SLIDING, Outcome
from fem.results.run_result import ChangedRun, RunResult, StaticResult, Verdict

FRICTION = {MU_KINETIC, WEAKENING, STRIBECK}
WITHOUT_BAND = "; only the band can tell which of the two governs (--band)."


def governing(result: RunResult) -> tuple[str, ...]:
    """One sentence each for sliding and rocking where the rule and the run disagree, saying which governs."""
    verdict = result.verdict or Verdict()
    own = (result.static or StaticResult()).ruling
    members = verdict.band.members if verdict.band is not None else ()
    sentences = []
    use = own.utilisation_sliding
    least, _ = limits(result.static or StaticResult())
    if use and use <= 1.0 and _slides(verdict, least):
        sentences.append(
            f"Sliding: the static rule holds at {use:.3f} and the run slid{_on_sliding(members, least)}"
        )
    elif use and use <= 1.0 and verdict.outcome in SLIDING:
        slip, joint = largest_joint_slip(verdict)
        sentences.append(
            f"Sliding: the static rule holds at {use:.3f}, and the stack does not slide on the floor. The rule "
            f"does not cover the joints between its boxes, where the run slid {slip} ({joint})."
        )
    use = own.utilisation_overturning
    if use and use <= 1.0 and verdict.outcome in (*ROCKING, Outcome.OVERTURNED) and not fall_in_row(verdict):
        sentences.append(
            f"Rocking: the static rule stands at {use:.3f} and the run rocked{_on_rocking(members)}"
        )
    return tuple(sentences)


def _slides(run: Verdict | ChangedRun, least: float) -> bool:
    """True if it slides on the floor: in a loose stack, if its lowest box slides by more than `least` [m]."""
    return run.outcome in SLIDING and (not run.boxes or run.boxes[0].max_slip_m > least)


def _on_sliding(members: Sequence[ChangedRun], least: float) -> str:
    """Where friction drops at once, a moment of vibration can decide; a static rule cannot know of it."""
    if not members:
        return WITHOUT_BAND
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
    if not members:
        return WITHOUT_BAND
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
    standing = [
        member
        for member in members[1:]
        if member.kind == "one" and member.outcome in (Outcome.REST, Outcome.SLIDE)
    ]
    if standing:
        values = standing[0].values or {}
        named = ", ".join(WORDS.get(key, key) for key in values)
        return f". Inconclusive: rocking depends on {named} (with {in_words(values)} it does not rock)."
    return ". The run governs: it rocks with every single change tried."
