"""The action of a site, from the table [site] of its file."""

from fem.seismic.action import (
    GERMAN_ZONES,
    SiteAction,
    SpectrumShape,
    eurocode_shape,
    german_shape,
    second_generation_shape,
)
from fem.site_check.tables import SiteTable


def action_of(site: SiteTable) -> SiteAction:
    """The action of a site.

    Raises:
        ValueError: a ground that the spectrum does not have.
    """
    reference = site.reference_acceleration_m_s2
    if site.spectrum == "EN1998-1":
        shape = eurocode_shape(site.type or 1, site.ground or "")
    elif site.spectrum == "DIN-NA-2011":
        shape = german_shape(site.ground or "", site.vertical_ratio or 0.0)
        reference = GERMAN_ZONES[site.zone or 0]
    elif site.spectrum == "second-generation":
        plateau = site.plateau_m_s2 or 0.0
        reference = plateau / site.plateau_over_peak
        shape = second_generation_shape(
            plateau=plateau,
            one_second=site.one_second_m_s2 or 0.0,
            periods=_three(site.end_periods_s),
            vertical_ratio=site.vertical_ratio or 0.0,
            ratio=site.plateau_over_peak,
        )
    else:
        shape = SpectrumShape(
            soil_factor=site.soil_factor or 0.0,
            corner_periods=_three(site.corner_periods_s),
            vertical_ratio=site.vertical_ratio or 0.0,
            vertical_corner_periods=_three(site.vertical_corner_periods_s),
        )
    return SiteAction(
        shape=shape,
        reference_acceleration=reference or 0.0,
        importance_factor=site.importance_factor,
        element_importance_factor=site.element_importance_factor,
        topographic_factor=site.topographic_factor,
    )


def _three(values: list[float] | None) -> tuple[float, float, float]:
    first, second, third = values or (0.0, 0.0, 0.0)
    return first, second, third
