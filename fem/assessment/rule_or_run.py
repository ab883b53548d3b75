"""Which is to be believed where the static rule says that the container holds or stands, and the run moves it.

The rule is that of one body on its floor: of the joints of a loose stack it says nothing.
"""

from collections.abc import Sequence

from fem.assessment.loose_boxes import largest_joint_slip, limits
from fem.assessment.sureness import below_uplift, rests_on_stiff_floor
from fem.case.unknown_inputs import MU_KINETIC, STRIBECK, WEAKENING
from fem.results.outcome import ROCKING, SLIDING, Outcome
from fem.results.run_result import BandMember, RunResult, StaticResult, Verdict

FRICTION = {MU_KINETIC, WEAKENING, STRIBECK}
WITHOUT_BAND = "; which of the two is to be believed, only the band can say (--band)."


def believed(result: RunResult) -> tuple[str, ...]:
    """A sentence for sliding and one for rocking, as far as the rule and the run disagree."""
    verdict = result.verdict or Verdict()
    own = (result.static or StaticResult()).ruling
    members = verdict.band.members if verdict.band is not None else ()
    said = []
    use = own.utilisation_sliding
    least, _ = limits(result.static or StaticResult())
    if use and use <= 1.0 and _slides(verdict, least):
        said.append(
            f"Sliding: the static rule holds at {use:.3f} and the run slid{_on_sliding(members, least)}"
        )
    elif use and use <= 1.0 and verdict.outcome in SLIDING:
        slip, joint = largest_joint_slip(verdict)
        said.append(
            f"Sliding: the static rule holds at {use:.3f}, and the stack does not slide on the floor. The rule says "
            f"nothing of the joints between its boxes, where the run slid {slip} ({joint})."
        )
    use = own.utilisation_overturning
    if use and use <= 1.0 and verdict.outcome in (*ROCKING, Outcome.OVERTURNED):
        said.append(f"Rocking: the static rule stands at {use:.3f} and the run rocked{_on_rocking(members)}")
    return tuple(said)


def _slides(one: Verdict | BandMember, least: float) -> bool:
    """Whether it slides on the floor; of a loose stack its lowest box by at least so much [m]."""
    return one.outcome in SLIDING and (not one.boxes or one.boxes[0].max_slip_m > least)


def _on_sliding(members: Sequence[BandMember], least: float) -> str:
    """Friction that falls at once lets an instant of vibration decide, of which a static rule knows nothing."""
    if not members:
        return WITHOUT_BAND
    laws = [one for one in members if one.values and one.outcome and set(one.values) <= FRICTION]
    held = [one.change for one in laws if not _slides(one, least)]
    if held:
        return (
            f". Believe the rule: with {held[0]} the container does not slide. The run slid because friction fell to "
            "mu_kinetic in an instant of vibration and stayed there."
        )
    tried = (
        f"it slides with every law of friction tried ({len(laws)})" if laws else "its friction does not fall"
    )
    return f". Believe the run: {tried}."


def _on_rocking(members: Sequence[BandMember]) -> str:
    if not members:
        return WITHOUT_BAND
    if rests_on_stiff_floor(members):
        return (
            ". Believe the rule: it is below uplift of a rigid block, and on a floor thirty times as stiff it does not "
            "rock. The run rocked because its soft bed opens from the edge."
        )
    if below_uplift(members):
        return (
            ". Neither is to be believed: it is below uplift of a rigid block, and rocks on a floor thirty times as "
            "stiff, too, because the container itself opens from the edge of its base."
        )
    held = [
        one.change
        for one in members[1:]
        if one.kind == "one" and one.outcome in (Outcome.REST, Outcome.SLIDE)
    ]
    if held:
        return f". Neither is to be believed without {held[0].partition(' = ')[0]}: with {held[0]} it does not rock."
    return ". Believe the run: it rocks with every single change tried."
