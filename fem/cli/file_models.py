"""Whole sweep, ensemble and site files as models, for their JSON schemas; the files are read table by table."""

from typing import Any

from pydantic import Field, create_model

from fem.site.request import DEFAULTED, REQUIRED, TABLES, SiteHeading
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


#: a required table; one that has its defaults where it is left out; one that may be missing
SITE_TABLES: dict[str, Any] = {
    name: (table, ...)
    if name in REQUIRED
    else (table, table())
    if name in DEFAULTED
    else (table | None, None)
    for name, table in TABLES.items()
}
SiteFile = create_model(
    "SiteFile",
    __base__=SiteHeading,
    __doc__="A site: action, motions, container, friction and limits.",
    **SITE_TABLES,
)

FILE_MODELS = {"sweep": SweepFile, "ensemble": EnsembleFile, "site": SiteFile}
