"""What was asked, for the page and the simplified methods, and as files in the folder of results."""

from pathlib import PurePath

from fem.case.data_files import place_of
from fem.records.source import decoded
from fem.results.kinds import ResultKind
from fem.results.run_files import require_free_name
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


def texts_of(request: SiteRequest, kind: ResultKind) -> dict[str, str]:
    """The site file, its container, and the files of points that it names, by their names in a folder of results.

    Raises:
        CaseError: a file of points is named like a result, which would replace it.
        OSError: it cannot be read.
    """
    own = {"site.toml": request.origin.text, "container.toml": request.container.text}
    for table, name in request.point_files.items():
        require_free_name(place_of(f"{table}.file"), PurePath(name), kind, own)
    files = {name: (request.origin.folder / name).read_bytes() for name in request.point_files.values()}
    return own | {name: decoded(content) or "" for name, content in files.items()}
