"""The containers of a site as bodies: full and empty, in the elevations that are run."""

from fem.case.case import CaseError
from fem.model.geometry import build_container
from fem.model.static_checks import static_checks_of
from fem.site_check.file import EMPTY, Variant
from fem.site_check.result import SiteBody


def body_of(variant: Variant) -> SiteBody:
    """Mass, dimensions and rocking parameters of a container.

    Raises:
        CaseError, MeshError: it cannot be built.
    """
    case = variant.case
    try:
        mesh = build_container(case)
    except ValueError as error:
        if variant.mass == EMPTY:
            raise CaseError(f"empty_mass_kg: {error}") from None
        raise
    static = static_checks_of(case, mesh, 0.0)
    return SiteBody(
        mass=variant.mass,
        elevation=variant.elevation,
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
