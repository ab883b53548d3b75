"""Read a site file: container, action, motions, friction, limits; the reasons why it cannot be used."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, Strict

from fem.case.case import Case
from fem.case.data_files import as_named_from
from fem.case.files import SITES, Origin
from fem.case.tables import quantities as q
from fem.case.tables.run_tables import DocumentTable, WindTable
from fem.case.tables.table import CaseTable, OneLine, case_key, optional_key
from fem.case.toml import toml_document
from fem.case.validation import CaseError, told_as
from fem.runtime.user_files import leads_out, real_path
from fem.seismic.action import (
    GERMAN_ZONES,
    HORIZONTAL,
    PERIOD,
    VERTICAL,
    FloorSpectrum,
    SiteAction,
    SpectrumShape,
    eurocode_shape,
    german_shape,
    read_spectrum,
    second_generation_shape,
)
from fem.seismic.wind import pressure_of
from fem.site.result import USUAL_BEHAVIOUR_FACTOR, SiteInputs
from fem.site.tables import (
    BuildingTable,
    FloorSpectrumTable,
    FrictionTable,
    LimitsTable,
    MotionsTable,
    SiteTable,
    SourcesTable,
)
from fem.study.file import base_case, read_as, read_study, split_tables

#: tables that must be given, and what is missing without them
REQUIRED = {
    "site": "the action: spectrum, ground, reference acceleration",
    "friction": "the range of mu_static",
    "limits": "slip_m, the clearance, without which there is no answer",
}
TABLES: dict[str, type[CaseTable]] = {
    "site": SiteTable,
    "building": BuildingTable,
    "floor_spectrum": FloorSpectrumTable,
    "motions": MotionsTable,
    "friction": FrictionTable,
    "limits": LimitsTable,
    "wind": WindTable,
    "sources": SourcesTable,
    "document": DocumentTable,
}
FULL, EMPTY = "full", "empty"
DEFAULTED = ("motions", "sources")  #: tables that may be left out, and then have their defaults
WIDTH, DEPTH = "width", "depth"  #: elevations: the dimension along the motion; a case file shows the first


#: contents for which gamma_a is at least that (EN 1998-1:2004, 4.3.5.3 (1))
HAZARDOUS = ("toxic", "explosive")
HAZARDOUS_FACTOR = 1.5
PLACEHOLDERS = ("placeholder", "example")  #: a source that begins so states nothing


class SiteHeading(CaseTable):
    """The keys of a site file that stand before its first table."""

    schema_version: Annotated[int, Strict(), q.SCHEMA] = Field(
        default=1, alias="schema", description="of this file's keys"
    )
    title: Annotated[str, Field(max_length=500), OneLine] = case_key("for people", "")
    container: str = case_key("a case file beside this one, or a shipped case; its motion is not used")
    empty_mass_kg: Annotated[float, q.MASS] | None = optional_key(
        "of one empty box; left out: full only", 400.0
    )
    empty_centroid_m: Annotated[float, q.LENGTH] | None = optional_key(
        "height of the mass centre of an empty box; default: half its height", 0.5
    )
    contents: Literal["ordinary", "toxic", "explosive"] | None = optional_key(
        '"ordinary" | "toxic" | "explosive": of the last two gamma_a is at least 1.5', "toxic"
    )
    model: Literal["rigid", "reduced"] = case_key(
        '"rigid" | "reduced", of all runs; the deciding ones are repeated with "reduced"', "rigid"
    )


@dataclass(frozen=True, kw_only=True)
class SiteRequest:
    """What a site file asks for."""

    origin: Origin
    data: Mapping[str, Any]  #: of the file, with what was changed
    heading: SiteHeading
    container: Case  #: as its file has it, with what was changed
    site: SiteTable
    building: BuildingTable | None
    floor_spectrum: FloorSpectrumTable | None
    motions: MotionsTable
    friction: FrictionTable
    limits: LimitsTable
    wind: WindTable | None
    sources: SourcesTable
    document: DocumentTable | None

    @property
    def name(self) -> str:
        """File stem, or the name of the shipped file."""
        return self.origin.name

    @cached_property
    def action(self) -> SiteAction:
        """The action of the site.

        Raises:
            CaseError: a ground that the spectrum does not have.
        """
        site, reference = self.site, self.site.reference_acceleration_m_s2
        with told_as("[site] "):
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
                element_importance_factor=self.element_factor,
                topographic_factor=site.topographic_factor,
            )

    @property
    def element_factor(self) -> float:
        """gamma_a as given, or by the contents; 1 on a floor whose motion is given."""
        if (given := self.site.element_importance_factor) is not None:
            return given
        hazardous = self.heading.contents in HAZARDOUS and not self.on_given_floor
        return HAZARDOUS_FACTOR if hazardous else 1.0

    @property
    def sources_in_use(self) -> dict[str, str]:
        """Where the inputs of this file come from, in the words of the user; empty: not stated."""
        unused = {"floor": self.building is None and not self.on_given_floor, "wind": self.wind is None}
        return {name: words for name, words in self.sources.model_dump().items() if not unused.get(name)}

    @property
    def unstated(self) -> tuple[str, ...]:
        """What must be stated before anybody signs: the contents, and sources that are missing or placeholders."""
        missing = (
            name
            for name, words in self.sources_in_use.items()
            if not words.strip() or words.strip().lower().startswith(PLACEHOLDERS)
        )
        contents = () if self.heading.contents else ("contents (ordinary, toxic or explosive)",)
        return (*contents, *(f"source of {name}" for name in missing))

    @property
    def on_given_floor(self) -> bool:
        """Whether the motions are those of the floor on which the container stands: no building filters them."""
        return self.floor_spectrum is not None or self.motions.source == "floor"

    @cached_property
    def floor_target(self) -> FloorSpectrum | None:
        """The spectrum of the floor, where it is given.

        Raises:
            CaseError: points that are no spectrum, or a file that holds none.
        """
        if (floor := self.floor_spectrum) is None:
            return None
        with told_as("[floor_spectrum] "):
            points = floor.model_dump() if floor.file is None else read_spectrum(self._beside(floor.file))
            return FloorSpectrum(
                periods=tuple(points[PERIOD]),
                accelerations=tuple(points[HORIZONTAL]),
                vertical_accelerations=tuple(points.get(VERTICAL) or ()),
                ground=self.action,
            )

    @property
    def frictions(self) -> list[tuple[float, float]]:
        """Pairs of static and kinetic friction: the corners of the ranges, and the middle."""
        given = self.friction.mu_static, self.friction.mu_kinetic_over_static
        static, share = ((values[0], values[-1]) for values in given)
        pairs = [*product(static, share), (0.5 * sum(static), 0.5 * sum(share))]
        # without the last bits of a product: 0.12 for 0.3 times 0.4
        return list(dict.fromkeys((mu, float(f"{mu * part:.9g}")) for mu, part in pairs))

    @cached_property
    def variants(self) -> dict[tuple[str, str], Case]:
        """The containers to run, by weight and elevation: full and empty, both ways where width and depth differ.

        Raises:
            CaseError: the empty mass cannot be.
        """
        box, masses = self.container.container, {FULL: self.container}
        if (mass := self.heading.empty_mass_kg) is not None:
            height = self.heading.empty_centroid_m or 0.5 * box.height_m
            masses[EMPTY] = self.container.with_values(
                {"container.mass_kg": mass, "container.centroid_m": height}
            )
        variants = {(mass, WIDTH): case for mass, case in masses.items()}
        if box.width_m != box.depth_m:
            turned = {"container.width_m": box.depth_m, "container.depth_m": box.width_m}
            variants |= {(mass, DEPTH): case.with_values(turned) for mass, case in masses.items()}
        return variants

    @property
    def wind_pressure(self) -> tuple[float, str] | None:
        """Peak velocity pressure [Pa] and where it comes from; None without wind.

        Raises:
            CaseError: the simplified pressures do not hold there.
        """
        if (wind := self.wind) is None:
            return None
        with told_as("[wind] "):
            return pressure_of(wind, self.container.container.total_height)

    @cached_property
    def inputs(self) -> SiteInputs:
        """What is asked, for the page and the simplified methods."""
        wind, static = self.wind_pressure, self.container.static
        return SiteInputs(
            container=self.heading.container,
            mu_static=tuple(self.friction.mu_static),
            mu_kinetic_over_static=tuple(self.friction.mu_kinetic_over_static),
            rotation_ratio_limit=self.limits.rotation_ratio,
            single_rotation_ratio_limit=self.limits.single_rotation_ratio,
            slip_limit_m=self.limits.slip_m,
            wind_pressure_Pa=wind[0] if wind else None,
            wind_pressure_source=wind[1] if wind else "",
            gamma_mu=self.wind.gamma_mu if self.wind else 1.0,
            behaviour_factor=static.behaviour_factor if static else USUAL_BEHAVIOUR_FACTOR,
            model=self.heading.model,
            contents=self.heading.contents or "",
            sources=tuple(self.sources_in_use.items()),
            unstated=self.unstated,
        )

    def with_value(self, key: str, value: float | int) -> "SiteRequest":
        """This request with one dotted key changed: of the site file, or of its container.

        `contact.mu_static` takes the place of the range of static friction.

        Raises:
            CaseError: no such key, or a value that cannot be used.
        """
        table, _, name = key.partition(".")
        if key == "contact.mu_static":
            table, name, value = "friction", "mu_static", [value]  # type: ignore[assignment]
        if table in TABLES:
            content = dict(self.data.get(table, {})) | {name: value}
            return _request(dict(self.data) | {table: content}, self.origin, self.container)
        return _request(self.data, self.origin, self.container.with_values({key: value}))

    def _beside(self, name: str) -> Path:
        """A file of points; a link to elsewhere is refused with ValueError, for messages quote what they read."""
        path = self.origin.folder / name
        if leads_out(self.origin.folder, path):
            raise ValueError(
                f"{name} leads out of the folder of the site file, to {real_path(path)}; copy it there"
            )
        return path


def load_site(
    name_or_path: str | Path, records: Sequence[str] = (), *, allow_baseline: bool = False
) -> SiteRequest:
    """Read a site file, or a shipped one.

    Args:
        name_or_path: of the site file.
        records: files of motions in place of those of the site file, relative to the current folder; a pair of a
            horizontal and a vertical component as "H,V". Without any pair, there is no vertical motion.
        allow_baseline: take matched records of which the baseline changes a peak by more than 20 %.

    Raises:
        CaseError: with one line for each reason why it cannot be used.
    """

    def read(data: Mapping[str, Any], origin: Origin) -> SiteRequest:
        if not records and not allow_baseline:
            return _request(data, origin)
        changed = dict(data)
        if records:
            named = [
                [as_named_from(origin.folder, name.strip()) for name in pair.split(",")] for pair in records
            ]
            motions = changed["motions"] = {**data.get("motions", {}), "files": named}
            if motions.get("source") not in ("matched", "floor"):
                motions["source"] = "records"
            if max(map(len, named)) == 1:
                motions["vertical"] = False
        if allow_baseline:  # refused as the key is, where nothing is matched
            changed["motions"] = {**changed.get("motions", {}), "allow_baseline": True}
        return _request(changed, replace(origin, text=toml_document(changed)))  # which the results keep

    return read_study(SITES.find(name_or_path), read)


def _request(data: Mapping[str, Any], origin: Origin, container: Case | None = None) -> SiteRequest:
    given, tables = split_tables(data, list(TABLES))
    problems: list[str] = []
    read: dict[str, Any] = dict.fromkeys(TABLES)

    def take(name: str, model: type[CaseTable], content: Mapping[str, Any]) -> None:
        try:
            read[name] = read_as(name, model, content)
        except CaseError as error:
            problems.extend(str(error).splitlines())

    take("", SiteHeading, given)
    for name, model in TABLES.items():
        if name in REQUIRED and name not in tables:
            problems.append(f"[{name}] is missing: {REQUIRED[name]}")
        elif name in tables or name in DEFAULTED:
            take(name, model, tables.get(name, {}))
    if problems:
        raise CaseError("\n".join(problems))
    heading = read.pop("")
    request = SiteRequest(
        origin=origin,
        data=data,
        heading=heading,
        container=container or base_case(heading.container, {}, origin),
        **read,
    )
    _check(request)
    return request


def _check(request: SiteRequest) -> None:
    """Ask for everything that may be refused, so that it is refused before anything is computed."""
    container = request.container.container
    differs = 'joints = "loose"' if container.is_loose else "[[container.box]]"
    know = "second component, rigid bound and simplified methods know a container that"
    for refused, what, why, way_out in (
        (
            container.is_loose or container.box is not None,
            f"{differs} is",
            "rules are those of equal boxes that move as one body",
            "take bolted boxes",
        ),
        (request.container.links, "[[stop]] and [[tie]] are", f"{know} nothing holds", "leave them out"),
        (request.container.neighbour, "[[neighbour]] is", f"{know} stands alone", "leave it out"),
    ):
        if refused:
            raise CaseError(
                f"container: {what} not verified at a site, whose {why}; {way_out}, or run the motions one by one"
            )
    _ = request.action, request.variants, request.wind_pressure, request.floor_target
    given = "[floor_spectrum]" if request.floor_spectrum is not None else '[motions] source = "floor"'
    if request.on_given_floor and request.building is not None:
        raise CaseError(
            f"{given} and [building] both say how the floor moves: the storey would be counted twice; keep one of them"
        )
    factors = request.site.importance_factor, request.element_factor
    if request.heading.contents in HAZARDOUS and not request.on_given_floor and factors[1] < HAZARDOUS_FACTOR:
        raise CaseError(
            f'[site] element_importance_factor = {factors[1]:g} with contents = "{request.heading.contents}": EN '
            f"1998-1:2004, 4.3.5.3 asks for {HAZARDOUS_FACTOR:g} at least; take the key out"
        )
    if request.on_given_floor and factors != (1.0, 1.0):
        raise CaseError(
            f"[site] importance_factor and element_importance_factor have no effect with {given}: the motion of the "
            "floor is taken as it is; leave them out, and if that motion holds them, let reference_acceleration_m_s2 "
            "hold them too"
        )
    if request.floor_spectrum is not None and request.motions.source == "floor":
        raise CaseError(
            '[floor_spectrum] and [motions] source = "floor" both say how the floor moves; leave the spectrum out, or '
            'fit the records to it with source = "records" or "matched"'
        )
    if request.heading.empty_centroid_m is not None and request.heading.empty_mass_kg is None:
        raise CaseError("empty_centroid_m has no effect without empty_mass_kg")


def _three(values: list[float] | None) -> tuple[float, float, float]:
    first, second, third = values or (0.0, 0.0, 0.0)
    return first, second, third
