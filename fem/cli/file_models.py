"""Whole sweep, ensemble and site files as models, for their JSON schemas; the files are read table by table."""

from typing import Any

from pydantic import Field

from fem.case.tables.run_tables import DocumentTable, WindTable
from fem.site import tables
from fem.site.request import SiteHeading
from fem.study.axes import Range
from fem.study.design import MapChoice, Perturbation, Threshold
from fem.study.draws import Distribution
from fem.study.file import EnsembleHeading, StudyHeading

Axes = dict[str, list[float | bool | str] | Range]
CHANGES = "keys changed in the base case"
DERIVED = "keys that follow others, as expressions in quotes"


class SweepFile(StudyHeading):
    """A sweep: a base case over one to four axes."""

    set: dict[str, Any] = Field(default={}, description=CHANGES)
    axes: Axes = Field(description="one to four keys: a list of values each, or a range")
    derived: dict[str, str] = Field(default={}, description=DERIVED)
    perturbation: Perturbation = Perturbation()
    threshold: Threshold | None = None
    maps: MapChoice = MapChoice()


class EnsembleFile(EnsembleHeading):
    """An ensemble: a base case with random quantities over one to three axes."""

    set: dict[str, Any] = Field(default={}, description=CHANGES)
    axes: Axes = Field(
        description="one to three keys, or variables free.NAME: a list of values each, or a range"
    )
    random: dict[str, Distribution] = Field(description="distributions of keys, or of variables free.NAME")
    derived: dict[str, str] = Field(default={}, description=DERIVED)


class SiteFile(SiteHeading):
    """A site: action, motions, container, friction and limits."""

    site: tables.SiteTable
    building: tables.BuildingTable | None = None
    motions: tables.MotionsTable = tables.MotionsTable()
    friction: tables.FrictionTable
    limits: tables.LimitsTable
    wind: WindTable | None = None
    sources: tables.SourcesTable = tables.SourcesTable()
    document: DocumentTable | None = None


FILE_MODELS = {"sweep": SweepFile, "ensemble": EnsembleFile, "site": SiteFile}
