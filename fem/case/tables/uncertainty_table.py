"""The table [uncertainty]: what is not known of the inputs of a case."""

from typing import Annotated, Literal

from pydantic import Field, Strict

from fem.case.tables import quantities as q
from fem.case.tables.table import CaseTable, case_key, optional_key
from fem.case.tables.unknown_inputs import UNCERTAINTY_RULES

#: a range [low, high], or that the value of the case is known
Unknown = Annotated[list[float], Field(min_length=2, max_length=2)] | Literal["held", "known"] | None


class UncertaintyTable(CaseTable):
    """What is not known of the inputs: [low, high], or "held" as given. The band of a run covers it."""

    mu_static: Unknown = optional_key(
        "of static friction; default: 0.9 to 1.1 times; mu_kinetic keeps its share", [0.3, 0.4]
    )
    mu_kinetic: Unknown = optional_key(
        "of kinetic friction; default: half of mu_static to all of it", [0.2, 0.4]
    )
    joints_mu_static: Unknown = optional_key(
        "loose joints: of static friction; default: half to twice where [joints] leaves it out", [0.2, 0.8]
    )
    joints_mu_kinetic: Unknown = optional_key(
        "loose joints: of kinetic friction; default: half of mu_static to all of it", [0.2, 0.4]
    )
    joints_weakening_m: Unknown = optional_key(
        "loose joints: default: 0, or 1e-4 of the width to 5 mm", [0.0, 0.005]
    )
    joints_damping_ratio: Unknown = optional_key("loose joints: default: 0.1 to 2, and as given", [0.1, 2.0])
    camber_m: Unknown = optional_key(
        "of the support; default: half to twice, of a level base flat or on feet 0 to 2 mm", [0.0, 0.002]
    )
    rocking_damping_ratio: Unknown = optional_key(
        "of the support, where it is cambered; default: 0.02 to 0.1, and as given", [0.02, 0.1]
    )
    weakening_m: Unknown = optional_key(
        "of the contact; default: 0, or 1e-4 of the width to 5 mm", [0.0, 0.005]
    )
    stribeck_velocity_m_s: Unknown = optional_key("of the contact; default: 0 to 0.3 m/s", [0.0, 0.3])
    normal_penalty_Pa_m: Unknown = optional_key(
        "of the contact; default: a ninth to three times", [1e9, 3e10]
    )
    bearing_strength_Pa: Unknown = optional_key(
        "of the floor, slab only; default: half to twice", [25e6, 1e8]
    )
    floor_youngs_modulus_Pa: Unknown = optional_key(
        "of the floor, slab only; default: half to twice", [1.5e10, 6e10]
    )
    damping_ratio: Unknown = optional_key("of the contact; default: half to twice", [1.0, 4.0])
    restitution_over_housner: Unknown = optional_key(
        "of the contact, where it is given; default: a loss 1 - e of 0.8 to 1.5 times", [0.9, 1.0]
    )
    material_damping_ratio: Unknown = optional_key("of the container; default: half to twice", [0.01, 0.04])
    fill_damping_ratio: Unknown = optional_key(
        "of the container; default: a quarter to two and a half times", [0.05, 0.5]
    )
    stop_gap_m: Unknown = optional_key(
        "of the stops, where they differ the largest, and all in proportion; default: 0.8 to 1.2 times",
        [0.04, 0.06],
    )
    stop_stiffness_N_m: Unknown = optional_key("of the stops, likewise; default: half to twice", [5e7, 2e8])
    stop_mu: Unknown = optional_key("friction on the stops, likewise; default: half to twice", [0.1, 0.4])
    tie_slack_m: Unknown = optional_key("of the ties, likewise; default: 0.8 to 1.2 times", [0.0, 0.01])
    tie_stiffness_N_m: Unknown = optional_key("of the ties, likewise; default: half to twice", [5e5, 2e6])
    neighbour_gap_m: Unknown = optional_key(
        "between the neighbours, likewise; default: 0.8 to 1.2 times", [0.08, 0.12]
    )
    neighbour_stiffness_N_m: Unknown = optional_key(
        "of the sides, likewise; default: half to twice", [5e7, 2e8]
    )
    neighbour_mu: Unknown = optional_key(
        "friction between the sides, likewise; default: half to twice", [0.1, 0.4]
    )
    centroid_m: Unknown = optional_key(
        "height of the mass centre in a box; default: 0.98 to 1.02 times", [0.45, 0.55]
    )
    eccentricity_m: Unknown = optional_key(
        "of the mass centre; default: a hundredth of the width to both sides", [-0.01, 0.01]
    )
    effective_width: Unknown = optional_key("of the base; default: 0.97 to 1 times", [0.97, 1.0])
    slope_percent: Unknown = optional_key(
        "of the floor; default: half a per cent less to half a per cent more", [-0.5, 0.5]
    )
    vertical_phase_rad: Unknown = optional_key(
        "of a vertical harmonic beside a horizontal one; default: the whole turn", [0.0, 3.14]
    )
    phase_rad: Unknown = optional_key("harmonic: of the motion; default: held", [0.0, 3.14])
    sign: bool | Literal["held", "known"] | None = optional_key(
        "record or pulse: whether it may come from the other side; default: true where left and right differ",
        True,
    )
    vertical_sign: bool | Literal["held", "known"] | None = optional_key(
        "record or pulse: true tries the vertical motion with the other sign; default: false", True
    )
    support: bool | Literal["held", "known"] | None = optional_key(
        "corners and flat: whether the base may touch as the other does; default: true", True
    )
    start: bool | Literal["held", "known"] | None = optional_key(
        "harmonic: true tries the other motion.start, a jump of the floor's velocity; default: false", True
    )
    ramp: bool | Literal["held", "known"] | None = optional_key(
        "harmonic: whether a ramp of two cycles may begin it, or none; default: true", True
    )
    draws: Annotated[int, Strict(), q.DRAWS] = case_key("runs in which all of these are drawn at once", 32)

    rules = UNCERTAINTY_RULES
