"""What the floor of a case amounts to, for the result of a run: springs, caps and a typical impact."""

import math
from dataclasses import dataclass

from contact.interface.penalty import contact_frequency, relaxation_time
from fem.case.case import Case
from fem.model.floor import Slab, pivot_inset, slab_of
from fem.model.static_checks import StaticChecks
from fem.results.run_result import FloorNumbers
from mesh.container import ContainerMesh

HIT_RATIO = 0.2  #: rotation over the slenderness angle from which a typical impact is reckoned


@dataclass(frozen=True, kw_only=True)
class Hit:
    """An impact of one corner, of a rigid container that fell back from a rotation."""

    closing_speed: float  #: of the corner [m/s]
    plastic_work: float  #: that the corner or the floor takes [J]
    crushing: float  #: permanent indentation of an intact corner [m]


def hit_from(ratio: float, static: StaticChecks, slab: Slab) -> Hit:
    """The impact after a rotation of so much of the slenderness angle, released at rest.

    The energy M g R (cos(al - theta) - cos al) is that of the turn about one corner; Housner's impact, in which the
    other corner does not rebound, takes 1 - e^2 of it, as a corner that crushes does.
    """
    angle = static.slenderness_angle
    energy = static.weight * static.radius * (math.cos(angle * (1.0 - ratio)) - math.cos(angle))
    inertia = static.weight * static.radius / static.frequency_parameter**2
    lost = energy * (1.0 - max(static.housner_restitution, 0.0) ** 2)
    work = plastic_work(math.sqrt(2.0 * slab.normal_stiffness * lost), slab.cap, slab.normal_stiffness)
    speed = static.width * math.sqrt(2.0 * energy / inertia)
    share = work / slab.cap
    # work = cap d (1 + growth d/2)
    crushing = 2.0 * share / (1.0 + math.sqrt(1.0 + 2.0 * slab.cap_growth * share))
    return Hit(closing_speed=speed, plastic_work=work, crushing=crushing)


def floor_result(case: Case, mesh: ContainerMesh, static: StaticChecks) -> FloorNumbers | None:
    """What the floor of a case amounts to; None where it is rigid and level."""
    floor = case.floor
    if not floor.is_slab:
        slope = floor.slope_percent
        return FloorNumbers(kind=floor.kind, slope_percent=slope) if slope else None
    slab = slab_of(case, mesh.mass)
    hit = hit_from(HIT_RATIO, static, slab)
    return FloorNumbers(
        kind=floor.kind,
        slope_percent=floor.slope_percent,
        preset=floor.preset,
        youngs_modulus_Pa=floor.youngs_modulus_Pa,
        poisson_ratio=floor.poisson_ratio,
        bearing_strength_Pa=floor.bearing_strength_Pa,
        corner_patch_m=slab.patch,
        corner_stiffness_N_m=slab.normal_stiffness,
        corner_tangential_stiffness_N_m=slab.tangential_stiffness,
        contact_frequency_Hz=contact_frequency(mesh.mass, 2.0 * slab.normal_stiffness),
        damping_ratio=slab.relaxation_time / relaxation_time(1.0, mesh.mass, 2.0 * slab.normal_stiffness),
        static_indentation_m=0.5 * static.weight / slab.normal_stiffness,
        corner_cap_N=slab.cap,
        bearing_capacity_N=slab.bearing_capacity,
        steel_capacity_N=slab.steel_capacity,
        pivot_inset_m=pivot_inset(case, mesh) or None,
        governs="container" if slab.yields_first else "floor",
        cap_over_weight=slab.cap / static.weight,
        hit_rotation_ratio=HIT_RATIO,
        closing_speed_m_s=hit.closing_speed,
        crushing_per_hit_m=hit.crushing,
        crushing_per_hit_J=hit.plastic_work,
    )


def plastic_work(force: float, capacity: float, stiffness: float) -> float:
    """Work that a rigid-plastic corner takes where an elastic one reaches this force [J]: (F^2 - F_c^2)/(2 k).

    The spring below has stored F^2/(2 k) when the corner stands still; a corner that gives way at F_c leaves
    F_c^2/(2 k) in the spring and takes the rest (energy of an elastoplastic spring, as in Biggs, Introduction to
    Structural Dynamics, 1964, ch. 2).
    """
    return max(force**2 - capacity**2, 0.0) / (2.0 * stiffness)


def drawn_level(slope_percent: float) -> str:
    """The note beside a drawing of a sloping floor, which is drawn level; empty for a level floor."""
    if not slope_percent:
        return ""
    return f"the floor falls {abs(slope_percent):g} % to the {'right' if slope_percent > 0.0 else 'left'}, drawn level"
