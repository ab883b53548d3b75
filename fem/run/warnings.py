"""Warnings: what the reader must know before relying on a result. One function a warning.

A warning takes the result of a run and its case, and returns one sentence or two, or None. It states the value
that raised it, the limit, and what can be done. No warning changes a verdict.
"""

import math
from collections.abc import Callable

from fem.case.case import Case
from fem.case.tables.duration import MOST_FREE_MOTION, ends_at_rest, longest_time
from fem.case.tables.input_ranges import DASHPOT, WEAKENING
from fem.case.tables.unknown_inputs import in_words
from fem.results import run_result
from fem.results.outcome import Outcome
from fem.run.card import sureness
from fem.run.described import doubts
from fem.run.ranges import plastic_corner
from fem.run.sureness import REGIME_UNSURE, UNSURE, numerical
from fem.run.verdict import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT

# A tilt of one hundredth of the slenderness angle counts as rocking; the contact alone must stay well below.
ROCKING_RATIO = 0.01
NEAR = 0.5  #: share of a limit from which there is a warning
REJECTED_SHARE = 0.05
#: slip over the width, and its change over the larger one, from which a scatter is said
SLIPS, SCATTER = 1e-3, 0.2
FLIGHT = 0.05  #: share of the rocking in the air from which it is said
ROCKS = (Outcome.ROCK, Outcome.SLIDE_ROCK)
#: largest von Mises stress over Young's modulus up to which `reduced` and `full` agree within 5 %: blocks of one to ten
#: boxes, corners and flat, of 1e9 to 1.5e6 Pa; at 0.024 they differ by 9 % (`fem/README.md`)
SMALL_STRAIN = 0.01
#: relaxation time of the contact over the time scale of rocking 1/p, from which the dashpot is more than a loss at
#: impacts: the rotation ratio of a rigid `rocking` on its flat base is 0.85 at 0.006, 0.68 at 0.15, 0.49 at 0.31
FAST_RELAXATION = 0.1


def warnings_for(result: run_result.RunResult, case: Case) -> list[str]:
    """All warnings that apply to a result, the most important first."""
    return [text for check in CHECKS if (text := check(result, case)) is not None]


def verdict_is_unsure(result: run_result.RunResult, case: Case) -> str | None:
    """The outcome changes within the uncertainty of the inputs."""
    verdict = _verdict(result)
    if verdict.band is None or verdict.sure not in (UNSURE, None) or verdict.outcome == Outcome.INVALID:
        return None
    failed = [member for member in verdict.band.members if member.outcome is None]
    return sureness(result) + (
        f". The first without an outcome, with {in_words(failed[0].values or {})}: {failed[0].error}"
        if failed
        else ""
    )


def friction_decides(result: run_result.RunResult, case: Case) -> str | None:
    """Rocking takes more friction than is left once the container slides: a landing decides which it does."""
    analytic = _verdict(result).analytic
    needed = None if analytic is None else analytic.friction_needed
    static, kinetic = case.contact.mu_static, case.contact.mu_kinetic
    if needed is None or not kinetic < needed < static or _verdict(result).outcome not in ROCKS:
        return None
    gradual = _changed_alone(result, WEAKENING)
    words = (
        f"to rock without sliding takes friction of {needed:.2g}: static friction ({static:g}) gives it, kinetic "
        f"friction ({kinetic:g}) does not, so one landing that breaks it loose decides"
    )
    if not gradual:
        return words
    length = max(gradual)
    slip, ratio = 1e3 * (gradual[length].max_slip_m or 0.0), gradual[length].rotation_ratio
    return (
        f"{words}; if friction falls over {1e3 * length:g} mm of slip instead of at once, it reaches {ratio:.2g} of "
        f"its slenderness angle, slip {slip:.3g} mm"
    )


def it_bounces(result: run_result.RunResult, case: Case) -> str | None:
    """A container that is in the air for a good part of its rocking."""
    share = _verdict(result).flight_share
    if share is None or share < FLIGHT or _verdict(result).outcome not in ROCKS:
        return None
    band = _verdict(result).band
    reach = band.flight_share if band else None
    span = f" ({reach[0]:.0%} to {reach[1]:.0%} over the variations)" if reach else ""
    numerics = _numerics(result)
    own, contact = numerics.bounce_container_damping_ratio, numerics.bounce_contact_damping_ratio
    dashpot = ""
    if (contact or 0.0) > (own or 0.0) and not case.floor.is_slab:
        dashpot = "; on a rigid floor the dashpot of the contact, a numerical one, takes most of it"
        ratios = {case.contact_damping_ratio: _verdict(result).rotation_ratio} | {
            ratio: member.rotation_ratio for ratio, member in _changed_alone(result, DASHPOT).items()
        }
        if len(ratios) > 1:
            found = ", ".join(f"{turned:.2g} with {ratio:g}" for ratio, turned in sorted(ratios.items()))
            dashpot += f". Rotation over the slenderness angle by the ratio of that dashpot: {found}"
    return (
        f"it bounces: nothing touches the floor for {share:.0%} of the time in which it rocks{span}. What its fill and "
        f"its walls take of a landing decides that{dashpot}"
    )


def _changed_alone(result: run_result.RunResult, key: str) -> dict[float, run_result.ChangedRun]:
    """The variations of a run that change nothing but a number, by that number."""
    band = _verdict(result).band
    return {
        float(member.values[key]): member
        for member in (band.members if band else ())
        if member.values is not None and [*member.values] == [key] and member.rotation_ratio is not None
    }


def slip_follows_the_steps(result: run_result.RunResult, case: Case) -> str | None:
    """Steps ten times as accurate give another slip: a landing decides how far it slides."""
    band, own = _verdict(result).band or run_result.Band(), _verdict(result).max_slip_m
    finer = next((member.max_slip_m for member in band.members[1:] if numerical(member)), None)
    if own is None or finer is None or band.max_slip_m is None:
        return None
    low, high = band.max_slip_m
    small = max(own, finer) < SLIPS * case.stack[0].width or abs(own - finer) < SCATTER * max(own, finer)
    if small or not low <= finer <= high:  # it fell, or destroyed a corner
        return None
    return (
        f"slip scatters with the accuracy of the steps: {1e3 * own:.3g} mm, and {1e3 * finer:.3g} mm with "
        "solver.energy_tolerance ten times tighter; its range holds both"
    )


def energy_is_near_its_limits(result: run_result.RunResult, case: Case) -> str | None:
    """The energy balance error is past half of what fails a run."""
    energy = result.energy or run_result.Energy()
    reference, final = energy.reference_J, energy.numerical_J
    if not reference or final is None:
        return None
    if -final > NEAR * GAIN_LIMIT * reference:
        return (
            f"numerical energy gain {-final / reference:.1e} of the energy that it takes "
            f"{run_result.to_overturn(bool(case.neighbour))} (limit {GAIN_LIMIT:.0e}); a smaller solver.step_s "
            "should reduce it"
        )
    parts = (energy.friction_J, energy.contact_damping_J, energy.material_damping_J, energy.crushing_J)
    limit = max(LOSS_SHARE_LIMIT * sum(part or 0.0 for part in parts), LOSS_LIMIT * reference)
    largest = (energy.closure_error or 0.0) * reference
    if largest > NEAR * limit:
        return f"energy balance error {largest:.3g} J (limit {limit:.3g} J); a smaller solver.step_s should reduce it"
    return None


def contact_penetrates(result: run_result.RunResult, case: Case) -> str | None:
    """The penetration of a corner alone tilts the container by a good part of what counts as rocking."""
    depth, angle = _numerics(result).max_penetration_m, _static(result).slenderness_angle_rad
    if depth is None or not angle:
        return None
    width = case.stack[0].width
    limit = ROCKING_RATIO * angle * width
    if depth <= NEAR * limit:
        return None
    return (
        f"penetration reached {1e3 * depth:.3g} mm: that alone tilts the container by "
        f"{depth / (width * angle):.2g} of its slenderness angle (rocking counts from "
        f"{ROCKING_RATIO}); {_stiffer(case)} reduces it"
    )


def _stiffer(case: Case) -> str:
    slab = "a stiffer floor or a larger floor.corner_patch_m"
    return slab if case.floor.is_slab else "a larger contact.normal_penalty_Pa_m"


def regularised_friction_creeps(result: run_result.RunResult, case: Case) -> str | None:
    """v = v_reg artanh(s) under a steady load of share s of what friction carries: no true stick."""
    if case.contact.sticks:
        return None
    share = _own_motion(result).utilisation_sliding
    start = "friction regularised in velocity never sticks: the container creeps"
    if share is None or not 0.0 < share < 1.0:
        return f"{start}; friction = 'elastic-stick' does not"
    creep = case.contact.regularisation_velocity_m_s * math.atanh(share) * longest_time(case)
    return (
        f"{start}, under a steady load of {share:.2g} of the friction limit, the peak of this run, by "
        f"{1e3 * creep:.2g} mm in {longest_time(case):g} s; friction = 'elastic-stick' does not"
    )


def housner_is_not_credible(result: run_result.RunResult, case: Case) -> str | None:
    """Below 0.5 the plastic impact of Housner (1963) at the far corner is not what a squat block does."""
    static = _static(result)
    if static.housner_credible is not False or _verdict(result).impacts == 0:
        return None
    return (
        f"Housner's restitution is {static.housner_restitution or 0.0:.3f} (< 0.5): the container is too squat for "
        "his impact at a corner; compare no restitution with it"
    )


def opening_is_not_uplift(result: run_result.RunResult, case: Case) -> str | None:
    """A base edge opens on its elastic bed at a third of the acceleration that lifts the body."""
    opening = _verdict(result).first_opening_s
    if opening is None or _verdict(result).first_uplift_s is not None:
        return None
    return (
        f"a gap opened at the base at t = {opening:.4g} s, but no side was ever without load: that is the "
        "elastic bed, not uplift of the container"
    )


def it_still_moves(result: run_result.RunResult, case: Case) -> str | None:
    """The free motion after a pulse or a record was given up before the container came to rest."""
    if not ends_at_rest(case) or _verdict(result).at_rest_s is not None or result.status != "completed":
        return None
    return (
        f"the container still moves {MOST_FREE_MOTION:g} s after the end of the motion, where the run ends; a longer "
        "solver.duration_s follows it further"
    )


def motion_is_doubtful(result: run_result.RunResult, case: Case) -> str | None:
    """A recorded motion that drifts, or whose samples are too far apart; a floor that falls away."""
    return "; ".join(doubts(result.motion or run_result.MotionResult(), case.gravity_m_s2)) or None


def rest_proves_nothing(result: run_result.RunResult, case: Case) -> str | None:
    """Where the static rule also says that it stands, a run at rest is no argument against the rule.

    Nothing is confirmed where a variation moves the container.
    """
    own, verdict = _own_motion(result), _verdict(result)
    if verdict.outcome != Outcome.REST or verdict.sure in (REGIME_UNSURE, UNSURE) or case.neighbour:
        return None
    uses = (own.utilisation_sliding, own.utilisation_overturning)
    if any(use is None or use > 1.0 for use in uses):
        return None
    return (
        "the static rule also says that the container stands under this motion: the run confirms it and "
        "decides nothing"
    )


def stress_is_beyond_yield(result: run_result.RunResult, case: Case) -> str | None:
    """The model is elastic; a steel shell past its yield strength is not."""
    stress, limit = _verdict(result).max_von_mises_Pa, _verdict(result).yield_strength_Pa
    if limit is None or stress is None or stress <= limit:
        return None
    peak = ", and stress at a corner that carries the weight grows as the mesh is refined"
    corner = plastic_corner(_verdict(result))
    return (
        f"von Mises stress reached {stress / 1e6:.0f} MPa, beyond the yield strength of S235 (235 MPa): the "
        f"model is elastic{peak if _verdict(result).stress_from_corner_m is None else ''}"
        + (f"; {corner}" if corner else "")
    )


def strain_is_not_small(result: run_result.RunResult, case: Case) -> str | None:
    """The reduced model is linear elasticity in a turning frame: it leaves out what grows with the strain."""
    stress = _verdict(result).max_von_mises_Pa
    if case.solver.model != "reduced" or stress is None:
        return None
    strain = stress / case.container.youngs_modulus_Pa
    if strain <= SMALL_STRAIN:
        return None
    return (
        f"strain reached {100.0 * strain:.2g} % (von Mises stress over Young's modulus; "
        f"{100.0 * SMALL_STRAIN:g} % is small): the reduced model is linear in strain and differs from the full one by "
        "5 % and more" + ("" if case.neighbour else '; use solver.model = "full"')
    )


def contact_relaxes_slowly(result: run_result.RunResult, case: Case) -> str | None:
    """A dashpot that carries the weight for a good part of a swing is a floor that creeps."""
    frequency, rate = _numerics(result).contact_frequency_Hz, _static(result).frequency_parameter_1_s
    ratio = _numerics(result).contact_damping_ratio or case.contact.damping_ratio
    if not frequency or not rate or not ratio:
        return None
    # dashpot over spring, of the whole mass on half the base's stiffness: see contact.penalty.relaxation_time
    relaxation = 2.0 * ratio * math.sqrt(2.0) / (2.0 * math.pi * frequency)
    if relaxation * rate <= FAST_RELAXATION:
        return None
    return (
        f"the contact relaxes in {relaxation:.2g} s (contact.damping_ratio = {ratio:g}), not "
        f"fast compared with rocking (1/p = {1.0 / rate:.2g} s): it creeps under the weight; use a smaller "
        f"contact.damping_ratio, or {_stiffer(case)}"
    )


def steps_were_rejected(result: run_result.RunResult, case: Case) -> str | None:
    """Many steps done twice mean that the contact was hard to solve."""
    steps, rejected = _numerics(result).steps, _numerics(result).rejected
    if not steps or rejected is None or rejected <= REJECTED_SHARE * (steps + rejected):
        return None
    return f"{100.0 * rejected / (steps + rejected):.0f} % of the steps were rejected and repeated with a smaller step"


CHECKS: tuple[Callable[[run_result.RunResult, Case], str | None], ...] = (
    verdict_is_unsure,
    friction_decides,
    it_bounces,
    slip_follows_the_steps,
    motion_is_doubtful,
    it_still_moves,
    energy_is_near_its_limits,
    contact_penetrates,
    regularised_friction_creeps,
    contact_relaxes_slowly,
    steps_were_rejected,
    strain_is_not_small,
    stress_is_beyond_yield,
    housner_is_not_credible,
    opening_is_not_uplift,
    rest_proves_nothing,
)


# The blocks of a result that may not have got that far.
def _verdict(result: run_result.RunResult) -> run_result.Verdict:
    return result.verdict or run_result.Verdict()


def _static(result: run_result.RunResult) -> run_result.StaticResult:
    return result.static or run_result.StaticResult()


def _numerics(result: run_result.RunResult) -> run_result.Numerics:
    return result.numerics or run_result.Numerics()


def _own_motion(result: run_result.RunResult) -> run_result.ActionResult:
    return _static(result).ruling
