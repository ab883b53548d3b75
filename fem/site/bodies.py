"""The containers of a site as bodies: full and empty, in the elevations that are run, and what starts to move them.

A rigid body that neither uplifts nor slips under the whole motion need not be computed: the bound is that of
`fem.model.resting`.
"""

from fem.case.case import Case, CaseError
from fem.model.geometry import build_container
from fem.model.resting import BodyAtRest
from fem.model.static_checks import static_checks_of
from fem.site.request import EMPTY, SiteRequest
from fem.site.result import SiteBody


def bodies_of(request: SiteRequest) -> tuple[SiteBody, ...]:
    """Every container that is run; raises as `body_of`."""
    return tuple(body_of(*name, case) for name, case in request.variants.items())


def body_of(mass: str, elevation: str, case: Case) -> SiteBody:
    """Mass, dimensions and rocking parameters of a container.

    Raises:
        CaseError, MeshError: it cannot be built.
    """
    try:
        mesh = build_container(case)
    except ValueError as error:
        if mass == EMPTY:
            raise CaseError(f"empty_mass_kg: {error}") from None
        raise
    static = static_checks_of(case, mesh, 0.0)
    return SiteBody(
        mass=mass,
        elevation=elevation,
        mass_kg=mesh.mass,
        centroid_m=static.centroid,
        inertia_kg_m2=static.inertia,
        support_width_m=static.width,
        width_m=case.container.width_m,
        height_m=case.container.total_height,
        depth_m=case.container.depth_m,
        gravity_m_s2=case.gravity_m_s2,
        slenderness_angle_rad=static.slenderness_angle,
        frequency_parameter_1_s=static.frequency_parameter,
        uplift_acceleration_m_s2=static.uplift_acceleration,
        housner_restitution=static.housner_restitution,
    )


def at_rest_by_the_bound(request: SiteRequest) -> dict[tuple[str, str], BodyAtRest]:
    """The rigid bodies that a bound may show to be at rest, by weight and elevation.

    None of a container that rolls on a cambered base, that is not run as a rigid one, or below which the floor gives
    way.

    Raises:
        CaseError, MeshError: one cannot be built.
    """
    bodies = {}
    for name, variant in request.variants.items():
        case = variant.with_values({"solver.model": request.heading.model})
        mesh = build_container(case)
        bodies[name] = BodyAtRest.of(case, mesh, static_checks_of(case, mesh, 0.0))
    return {name: body for name, body in bodies.items() if body is not None}
