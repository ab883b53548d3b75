"""What was asked, for the page and the simplified methods, and as files in the folder of results."""

import hashlib
import tomllib
from contextlib import suppress
from itertools import chain
from pathlib import Path, PurePath

from fem.case.case import CaseError
from fem.case.data_files import place_of, split_channel
from fem.case.toml import toml_document, toml_value
from fem.results.kinds import ResultKind
from fem.results.run_files import copy_data_files, require_free_name
from fem.runtime.own_files import copy_file, place_in
from fem.runtime.user_files import real_path
from fem.seismic.action import spectrum_text
from fem.site.request import SiteRequest
from fem.site.result import USUAL_BEHAVIOUR_FACTOR, SiteInputs

CONTAINER = "container.toml"
RECORDS = "records"  #: folder in the results of the records that the site file names
MOST_COPIED = 20_000_000  #: of a record [bytes]; a larger one stays where it is


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
        contents=request.heading.contents or "",
        sources=tuple(request.sources_in_use.items()),
        unstated=request.unstated,
    )


def texts_of(request: SiteRequest, kind: ResultKind) -> dict[str, str]:
    """The site file, its container, and the files of points that it names, by their names in a folder of results.

    The site file names what lies beside it there, so that it can be repeated from there alone.

    Raises:
        CaseError: a file of points is named like a result, which would replace it.
        ValueError: it cannot be read.
    """
    own = {"site.toml": _beside_its_files(request), CONTAINER: request.container.text}
    for table, name in request.point_files.items():
        require_free_name(place_of(f"{table}.file"), PurePath(name), kind, own)
    return own | {name: spectrum_text(request.origin.folder / name) for name in request.point_files.values()}


def copy_files(request: SiteRequest, folder: Path) -> None:
    """Copy the mesh of the container, and the records, to where the copies of their files name them."""
    for path, place in _records(request).values():
        if not Path(place).is_absolute():
            target = place_in(folder, place)
            if real_path(target) != real_path(path):
                copy_file(path, target)
    with suppress(CaseError):  # the motion of the container, which is not used here, may be none
        copy_data_files(request.container, folder)


def left_elsewhere(request: SiteRequest) -> list[str]:
    """The records that are too large to be copied, in a sentence each with what tells their content."""
    return [
        f"{place} is larger than {MOST_COPIED / 1e6:g} MB and is not copied into the results; SHA-256 "
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}; to repeat it from there needs --allow-outside"
        for path, place in dict.fromkeys(_records(request).values())
        if Path(place).is_absolute()
    ]


def _records(request: SiteRequest) -> dict[str, tuple[Path, str]]:
    """The records by their names in the site file: where each is, and its place in the results; if large, on disk."""
    places: dict[str, tuple[Path, str]] = {}
    taken: dict[str, Path] = {}
    for name in chain(*(request.motions.files or [])):
        path, _ = split_channel(request.origin.folder, name)
        if path.stat().st_size > MOST_COPIED:
            places[name] = path, str(real_path(path))
            continue
        own = path.name
        while taken.setdefault(own, path) != path:  # of another folder
            own = f"other-{own}"
        places[name] = path, f"{RECORDS}/{own}"
    return places


def _beside_its_files(request: SiteRequest) -> str:
    """The site file with the names of the copies beside it; with its comments, where these names alone change."""
    names = {request.heading.container: CONTAINER}
    wanted = {**request.data, "container": CONTAINER}
    if request.motions.files:
        for name, (_, place) in _records(request).items():
            channel = split_channel(request.origin.folder, name)[1]
            names[name] = f"{place}#{channel}" if channel else place
        files = [[names[name] for name in motion] for motion in request.motions.files]
        wanted["motions"] = {**request.data["motions"], "files": files}
    text = request.origin.text
    for name, own in names.items():
        text = text.replace(toml_value(name), toml_value(own)).replace(f"'{name}'", toml_value(own))
    with suppress(tomllib.TOMLDecodeError):
        if tomllib.loads(text) == wanted:
            return text
    return toml_document(wanted)
