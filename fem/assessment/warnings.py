"""What the reader of a result must know before believing it: one function a warning.

A warning takes the result (the keys of `run.json`) and the case, and returns one sentence or two, or None. It
states the figure that raised it, the limit, and what can be done. None of them changes a verdict.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from fem.assessment.verdict import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT
from fem.case.case import Case

Result = Mapping[str, Any]

# A tilt of one hundredth of the slenderness angle counts as rocking; the contact alone must stay well below.
ROCKING_RATIO = 0.01
NEAR = 0.5  #: share of a limit from which it is worth telling
CREDIBLE_STIFFNESS_RATIO = 4.0  #: f1/f_c from which the impact of a rigid block is reproduced
REJECTED_SHARE = 0.05
#: largest von Mises stress over Young's modulus up to which `reduced` and `full` agree within 5 %: blocks of one to ten
#: boxes, corners and flat, of 1e9 to 1.5e6 Pa; at 0.024 they part by 9 % (`fem/README.md`)
SMALL_STRAIN = 0.01
#: relaxation time of the contact over the time scale of rocking 1/p, from which the dashpot is more than a loss at
#: impacts: the rotation ratio of a rigid `rocking` on its flat base is 0.85 at 0.006, 0.68 at 0.15, 0.49 at 0.31
FAST_RELAXATION = 0.1
YIELD_STRENGTH = 235e6  #: [Pa], S235, EN 1993-1-1 Table 3.1


def warnings_for(result: Result, case: Case) -> list[str]:
    """All warnings that apply to a result, weightiest first."""
    return [text for check in CHECKS if (text := check(result, case)) is not None]


def band_is_unsure(result: Result, case: Case) -> str | None:
    """The outcome changes within the uncertainty of the contact."""
    band = _part(result, "verdict").get("band") or {}
    if not band.get("unsure"):
        return None
    low, high = band["rotation_ratio"]
    failed = [member for member in band.get("members") or () if member["outcome"] is None]
    found = (
        "unsure: within the band of contact stiffness and damping the outcome is "
        f"{' or '.join(band['outcomes'])}, the rotation ratio {low:.3g} to {high:.3g}"
    )
    places = ", ".join(
        f"{member['normal_penalty_Pa_m']:.3g} Pa/m with damping ratio {member['damping_ratio']:g}"
        for member in failed
    )
    return f"{found}; no outcome, because the solution failed, at penalty {places}" if failed else found


def energy_is_near_its_limits(result: Result, case: Case) -> str | None:
    """The imbalance of the ledger, won or lost by the scheme, is past half of what fails a run."""
    energy = _part(result, "energy")
    reference, final = energy.get("reference_J"), energy.get("numerical_J")
    if not reference or final is None:
        return None
    if -final > NEAR * GAIN_LIMIT * reference:
        return (
            f"the time stepping won {-final / reference:.1e} of the energy it takes to overturn (limit "
            f"{GAIN_LIMIT:.0e}); a smaller solver.step_s should reduce it"
        )
    dissipated = sum(
        energy.get(key) or 0.0 for key in ("friction_J", "contact_damping_J", "material_damping_J")
    )
    limit = max(LOSS_SHARE_LIMIT * dissipated, LOSS_LIMIT * reference)
    largest = (energy.get("closure_error") or 0.0) * reference
    if largest > NEAR * limit:
        return (
            f"the energy ledger is open by {largest:.3g} J (limit {limit:.3g} J); a smaller solver.step_s "
            "should close it"
        )
    return None


def contact_penetrates(result: Result, case: Case) -> str | None:
    """The penetration of a corner alone tilts the container by a good part of what counts as rocking."""
    depth = _part(result, "numerics").get("max_penetration_m")
    angle = _part(result, "static").get("slenderness_angle_rad")
    if depth is None or not angle:
        return None
    limit = ROCKING_RATIO * angle * case.container.width_m
    if depth <= NEAR * limit:
        return None
    return (
        f"penetration reached {1e3 * depth:.3g} mm: that alone tilts the container by "
        f"{depth / (case.container.width_m * angle):.2g} of its slenderness angle (rocking counts from "
        f"{ROCKING_RATIO}); a larger contact.normal_penalty_Pa_m reduces it"
    )


def regularised_friction_creeps(result: Result, case: Case) -> str | None:
    """v = v_reg artanh(s) under a steady load of share s of what friction carries: no true stick."""
    if case.contact.friction != "regularised":
        return None
    share = _action(result, "own_motion").get("utilisation_sliding")
    start = "friction regularised in velocity never sticks: the container creeps"
    if share is None or not 0.0 < share < 1.0:
        return f"{start}; friction = 'elastic-stick' does not"
    creep = case.contact.regularisation_velocity_m_s * math.atanh(share) * case.solver.duration_s
    return (
        f"{start}, under a steady load of {share:.2g} of the friction limit, this run's peak, by "
        f"{1e3 * creep:.2g} mm in {case.solver.duration_s:g} s; friction = 'elastic-stick' does not"
    )


def without_impact(result: Result) -> bool:
    """No corner struck the floor, so that nothing hangs on how it rebounds."""
    return _part(result, "verdict").get("impacts") == 0


def shell_rings_on_the_floor(result: Result, case: Case) -> str | None:
    """Near and below f1/f_c = 4 an impact feeds vibration: restitution depends on the contact stiffness."""
    numerics = _part(result, "numerics")
    elastic, contact = numerics.get("elastic_frequencies_Hz"), numerics.get("contact_frequency_Hz")
    if case.solver.model == "rigid" or not elastic or not contact or without_impact(result):
        return None
    ratio = elastic[0] / contact
    if ratio >= CREDIBLE_STIFFNESS_RATIO:
        return None
    banded = _part(result, "verdict").get("band") is not None
    return (
        f"first elastic frequency over contact frequency is {ratio:.2g} (< {CREDIBLE_STIFFNESS_RATIO:g}): "
        "impacts feed vibration, so restitution depends on the contact stiffness; "
        + ("the band belongs to the result" if banded else "take results that matter as a band (run --band)")
    )


def housner_is_not_credible(result: Result, case: Case) -> str | None:
    """Below 0.5 the plastic impact of Housner (1963) at the far corner is not what a squat block does."""
    static = _part(result, "static")
    if static.get("housner_credible") is not False or without_impact(result):
        return None
    return (
        f"Housner's restitution is {static['housner_restitution']:.3f} (< 0.5): the container is too squat "
        "for his impact at a corner; compare no restitution with it"
    )


def opening_is_not_uplift(result: Result, case: Case) -> str | None:
    """A base edge opens on its elastic bed at a third of the acceleration that lifts the body."""
    verdict = _part(result, "verdict")
    opening, uplift = verdict.get("first_opening_s"), verdict.get("first_uplift_s")
    if opening is None or uplift is not None:
        return None
    return (
        f"a gap opened at the base at t = {opening:.4g} s, but no side was ever without load: that is the "
        "elastic bed, not uplift of the container"
    )


def lateral_force_method_does_not_apply(result: Result, case: Case) -> str | None:
    """EN 1998-1:2004, 4.3.3.2.1 (2): T1 <= 4 T_C and T1 <= 2.0 s."""
    static = _part(result, "static")
    if static.get("method_applicable") is not False:
        return None
    return (
        f"the lateral force method does not apply at this period ({static['clause']}); the code's rows are "
        "shown for comparison only"
    )


def motion_is_doubtful(result: Result, case: Case) -> str | None:
    """A recorded motion that drifts, or whose samples are too far apart."""
    return "; ".join(_part(result, "motion").get("notes") or ()) or None


def rest_proves_nothing(result: Result, case: Case) -> str | None:
    """Where the static rule also says that it stands, a run at rest is no argument against the rule."""
    own = _action(result, "own_motion")
    if _part(result, "verdict").get("outcome") != "rest" or not own:
        return None
    if max(own.get("utilisation_sliding") or 0.0, own.get("utilisation_overturning") or 0.0) > 1.0:
        return None
    return (
        "the static rule, too, says that it stands under this motion: the run confirms it and decides nothing"
    )


def stress_is_beyond_yield(result: Result, case: Case) -> str | None:
    """The model is elastic; a steel shell past its yield strength is not."""
    stress = _part(result, "verdict").get("max_von_mises_Pa")
    steel = case.container.section == "shell" and case.container.youngs_modulus_Pa > 1.5e11
    if not steel or stress is None or stress <= YIELD_STRENGTH:
        return None
    return (
        f"von Mises stress reached {stress / 1e6:.0f} MPa, beyond the yield strength of S235 (235 MPa): the "
        "model is elastic, and stress at a corner that carries the weight grows as the mesh is refined"
    )


def strain_is_not_small(result: Result, case: Case) -> str | None:
    """The reduced model is linear elasticity in a turning frame: it leaves out what grows with the strain."""
    stress = _part(result, "verdict").get("max_von_mises_Pa")
    if case.solver.model != "reduced" or stress is None:
        return None
    strain = stress / case.container.youngs_modulus_Pa
    if strain <= SMALL_STRAIN:
        return None
    return (
        f"strain reached {100.0 * strain:.2g} % (von Mises stress over Young's modulus; {100.0 * SMALL_STRAIN:g} % is "
        "small): the reduced model is linear in it, and parts from the full one, by 5 % and more; take "
        'solver.model = "full"'
    )


def contact_relaxes_slowly(result: Result, case: Case) -> str | None:
    """A dashpot that carries the weight for a good part of a swing is a floor that creeps."""
    frequency = _part(result, "numerics").get("contact_frequency_Hz")
    rate = _part(result, "static").get("frequency_parameter_1_s")
    if not frequency or not rate:
        return None
    # dashpot over spring, of the whole mass on half the base's stiffness: see contact.penalty.relaxation_time
    relaxation = 2.0 * case.contact.damping_ratio * math.sqrt(2.0) / (2.0 * math.pi * frequency)
    if relaxation * rate <= FAST_RELAXATION:
        return None
    return (
        f"the contact gives way over {relaxation:.2g} s (contact.damping_ratio = {case.contact.damping_ratio:g}), not "
        f"fast against rocking (1/p = {1.0 / rate:.2g} s): it creeps under the weight besides its work at impacts; "
        "a smaller contact.damping_ratio, or a larger contact.normal_penalty_Pa_m"
    )


def steps_were_rejected(result: Result, case: Case) -> str | None:
    """Many steps done twice mean that the contact was hard to solve."""
    numerics = _part(result, "numerics")
    steps, rejected = numerics.get("steps"), numerics.get("rejected")
    if not steps or rejected is None or rejected <= REJECTED_SHARE * (steps + rejected):
        return None
    return f"{100.0 * rejected / (steps + rejected):.0f} % of the steps were rejected and made again smaller"


CHECKS: tuple[Callable[[Result, Case], str | None], ...] = (
    band_is_unsure,
    motion_is_doubtful,
    energy_is_near_its_limits,
    contact_penetrates,
    regularised_friction_creeps,
    shell_rings_on_the_floor,
    contact_relaxes_slowly,
    steps_were_rejected,
    strain_is_not_small,
    stress_is_beyond_yield,
    housner_is_not_credible,
    opening_is_not_uplift,
    lateral_force_method_does_not_apply,
    rest_proves_nothing,
)


def _part(result: Result, name: str) -> Mapping[str, Any]:
    """A block of a result that may not have got that far."""
    return result.get(name) or {}


def _action(result: Result, name: str) -> Mapping[str, Any]:
    return _part(result, "static").get(name) or {}
