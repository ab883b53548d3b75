"""What was asked, for the page and the simplified methods."""

from fem.site_check.file import SiteRequest
from fem.site_check.result import USUAL_BEHAVIOUR_FACTOR, SiteInputs


def inputs_of(request: SiteRequest) -> SiteInputs:
    """What was asked, for the page and the simplified methods."""
    wind, static = request.wind_pressure, request.container.static
    return SiteInputs(
        container=request.heading.container,
        mu_static=tuple(request.friction.mu_static),
        mu_kinetic_over_static=tuple(request.friction.mu_kinetic_over_static),
        rotation_ratio_limit=request.limits.rotation_ratio,
        single_rotation_ratio_limit=request.limits.single_rotation_ratio,
        slip_limit_m=request.limits.slip_m,
        wind_pressure_Pa=wind[0] if wind else None,
        wind_pressure_source=wind[1] if wind else "",
        gamma_mu=request.wind.gamma_mu if request.wind else 1.0,
        behaviour_factor=static.behaviour_factor if static else USUAL_BEHAVIOUR_FACTOR,
        model=request.heading.model,
        sources=tuple(request.sources.model_dump().items()),
    )
