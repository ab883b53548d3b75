"""What a study of many cases holds fixed of the unknown inputs, in words for its title and page."""

import math
from collections.abc import Collection, Iterator, Sequence

from fem.case.case import Case
from fem.case.tables.input_keys import MU_KINETIC, RAMP, START, STRIBECK, WEAKENING


def held_inputs(cases: Sequence[Case], varied: Collection[str]) -> str:
    """How friction falls and the motion begins in all cases: "with mu_k = mu_s/2 falling at once, no ramp".

    Args:
        cases: some of the study, such as those at the ends of its axes.
        varied: keys that the study varies by themselves; they are not held.
    """
    parts = [*_friction(cases, varied), *_beginning(cases, varied)]
    return f"with {', '.join(parts)}" if parts else ""


def _friction(cases: Sequence[Case], varied: Collection[str]) -> Iterator[str]:
    contacts = [case.contact for case in cases]
    law = ""
    if any(contact.mu_kinetic < contact.mu_static for contact in contacts) and not {
        WEAKENING,
        STRIBECK,
    } & set(varied):
        slips = [contact.weakening_m for contact in contacts]
        speeds = [contact.stribeck_velocity_m_s for contact in contacts]
        over = [f"{1e3 * slip:g} mm" for slip in slips[:1] if slip] + [f"{v:g} m/s" for v in speeds[:1] if v]
        if len({*slips}) == len({*speeds}) == 1:
            law = f" falling over {' and '.join(over)}" if over else " falling at once"
    if MU_KINETIC in varied:
        if law:
            yield f"friction{law}"
        return
    ratios = [contact.mu_kinetic / contact.mu_static for contact in contacts if contact.mu_static > 0.0]
    same = ratios and all(math.isclose(ratio, ratios[0], rel_tol=1e-9) for ratio in ratios)
    if same:
        inverse = 1.0 / ratios[0] if ratios[0] else 0.0
        times = f"{ratios[0]:.3g} mu_s"
        if ratios[0] == 1.0:
            times = "mu_s"
        elif inverse and math.isclose(inverse, round(inverse), rel_tol=1e-9):
            times = f"mu_s/{round(inverse)}"
        yield f"mu_k = {times}{law}"
    elif len({contact.mu_kinetic for contact in contacts}) == 1:
        yield f"mu_k = {contacts[0].mu_kinetic:g}{law}"
    elif law:
        yield f"friction{law}"


def _beginning(cases: Sequence[Case], varied: Collection[str]) -> Iterator[str]:
    motions = [case.motion for case in cases if case.motion.kind == "harmonic"]
    if not motions:
        return
    ramps, starts = {motion.ramp_cycles for motion in motions}, {motion.start for motion in motions}
    if START not in varied and starts == {"rest"}:
        yield "a start at rest"
    if RAMP not in varied and len(ramps) == 1:
        cycles = ramps.pop()
        yield f"a ramp of {cycles:g} cycles" if cycles else "no ramp"
