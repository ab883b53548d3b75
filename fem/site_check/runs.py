"""The runs of a verification: which there are, the case of each, and their rows."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from fem.batch.case_maker import CaseMaker
from fem.batch.log import fields_of, number_in, table_of_lines
from fem.batch.runner import Row
from fem.case.case import Case, read_case
from fem.case.data_files import FILE_KEYS
from fem.case.toml import toml_document
from fem.results.figures import Place, keys_of
from fem.results.outcome import Outcome
from fem.run.bracket import values_to_try
from fem.site_check.file import FULL, SiteRequest
from fem.site_check.result import MOTIONS, SiteRun

SET, SCAN, REFINED, FURTHER = "set", "scan", "refined", "further"
WIDTH = "width"  #: the elevation that a case file shows
#: factors on the motions beside 1, and values tried between the first that overturns and the one below it
SCANNED = (0.5, 0.75, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0)
BETWEEN = 3


class RunKey(NamedTuple):
    """One run: what it is made of."""

    stage: str
    motion: int
    vertical_sign: int
    mu_static: float
    mu_kinetic: float
    mass: str
    elevation: str
    building_period_s: float | None
    model: str
    factor: float

    @property
    def stem(self) -> str:
        """Of the names of the files of its motion."""
        return motion_stem(self.motion, self.building_period_s, further=self.stage == FURTHER)


COLUMNS = (*RunKey._fields, "outcome", *keys_of(Place.RUNS), "reason")


def motion_stem(number: int, period: float | None, *, further: bool = False) -> str:
    """Beginning of the names of the files of a motion."""
    name = f"further_{number:03d}" if further else f"motion_{number:02d}"
    return name if period is None else f"{name}_floor_{period:g}s"


@dataclass(frozen=True, kw_only=True, eq=False)
class RunPlan:
    """The runs of a request, stage by stage."""

    request: SiteRequest
    motions: int  #: of the set
    vertical: bool  #: whether they have a vertical component
    periods: tuple[float | None, ...]  #: of the building

    def of_set(self) -> list[RunKey]:
        """Every motion with both signs, over weights, elevations, periods and frictions.

        Neighbours differ in their motion alone, so that they share the equilibrium that they start from.
        """
        signs = (1, -1) if self.vertical else (0,)
        return [
            RunKey(
                stage=SET,
                motion=motion,
                vertical_sign=sign,
                mu_static=mu_static,
                mu_kinetic=mu_kinetic,
                mass=variant.mass,
                elevation=variant.elevation,
                building_period_s=period,
                model=self.request.heading.model,
                factor=1.0,
            )
            for variant, period, (mu_static, mu_kinetic), motion, sign in product(
                self.request.variants,
                self.periods,
                self.request.frictions,
                range(1, self.motions + 1),
                signs,
            )
        ]

    def of_scan(self) -> list[RunKey]:
        """All of these at the other factors."""
        return [key._replace(stage=SCAN, factor=factor) for factor in SCANNED for key in self.of_set()]

    def refined(self, runs: Mapping[RunKey, SiteRun]) -> list[RunKey]:
        """Those that overturned at the least factor, at factors between it and the one below."""
        fell = [
            key for key, run in runs.items() if run.outcome == Outcome.OVERTURNED and key.stage in (SET, SCAN)
        ]
        first = min((key.factor for key in fell), default=0.0)
        to_first = {factor: "" for factor in (1.0, *SCANNED) if factor < first} | {first: "overturned"}
        return [
            key._replace(stage=REFINED, factor=factor)
            for factor in values_to_try(to_first, resolution=0.0, inner=BETWEEN)
            for key in fell
            if key.factor == first
        ]

    def of_further(self, governing: RunKey, count: int) -> list[RunKey]:
        """Further motions with both signs, for what governs the set."""
        signs = (1, -1) if self.vertical else (0,)
        return [
            governing._replace(stage=FURTHER, motion=number, vertical_sign=sign, factor=1.0)
            for number in range(1, count + 1)
            for sign in signs
        ]


@dataclass(frozen=True, kw_only=True, eq=False)
class RunCases:
    """Makes the case of a run; picklable. Motions are read from the folder of results."""

    folder: Path  #: of the results, absolute
    bases: Mapping[tuple[str, str], Case]  #: by weight and elevation

    @classmethod
    def of(cls, request: SiteRequest, folder: Path) -> "RunCases":
        """For a request whose motions are written in a folder."""
        bases = {
            (one.mass, one.elevation): still(one.case, request.heading.model) for one in request.variants
        }
        return cls(folder=folder.resolve(), bases=bases)

    def __call__(self, key: RunKey) -> Case:
        """The case of a run.

        Raises:
            CaseError: its motion is missing.
        """
        place = self.folder / MOTIONS
        values: dict[str, Any] = {
            "solver.model": key.model,
            "contact.mu_static": key.mu_static,
            "contact.mu_kinetic": key.mu_kinetic,
            "motion.kind": "table",
            "motion.file": str(place / f"{key.stem}_h.csv"),
            "motion.scale": key.factor,
        }
        if key.vertical_sign:
            values |= {
                "vertical.kind": "table",
                "vertical.file": str(place / f"{key.stem}_v.csv"),
                "vertical.scale": key.vertical_sign * key.factor,
            }
        return self._makers[key.mass, key.elevation](values)

    @cached_property
    def _makers(self) -> dict[tuple[str, str], CaseMaker]:
        return {name: CaseMaker(base) for name, base in self.bases.items()}


def still(case: Case, model: str) -> Case:
    """A case without its own motion and start, whose files may lie anywhere."""
    data = case.given() | {"motion": {"kind": "none"}}
    for name in ("vertical", "initial", "static"):
        data.pop(name, None)
    alone = read_case(toml_document(data), name=case.name, folder=case.folder)
    origin = replace(alone.origin_with({}), trusted=frozenset(FILE_KEYS), allow_outside=True)
    return alone.from_origin(origin).with_values(
        {"solver.model": model, "solver.duration_s": "auto", "output.fields_s": 0.0}
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class RunRows:
    """The rows of the runs so far."""

    found: dict[RunKey, SiteRun] = field(default_factory=dict)
    lines: dict[RunKey, str] = field(default_factory=dict)  #: of the log
    reasons: list[str] = field(default_factory=list)  #: why runs failed

    def values(self, key: RunKey, row: Row) -> tuple[Any, ...]:
        """The row of a run for the log."""
        return (*key, *(row[name] for name in COLUMNS[len(key) :]))

    def note(self, line: str) -> None:
        """Add a line of the log."""
        fields = dict(zip(COLUMNS, fields_of(line), strict=True))
        key = RunKey(
            stage=fields["stage"],
            motion=int(fields["motion"]),
            vertical_sign=int(fields["vertical_sign"]),
            mu_static=float(fields["mu_static"]),
            mu_kinetic=float(fields["mu_kinetic"]),
            mass=fields["mass"],
            elevation=fields["elevation"],
            building_period_s=number_in(fields["building_period_s"]),
            model=fields["model"],
            factor=float(fields["factor"]),
        )
        figures: dict[str, Any] = {name: number_in(fields[name]) for name in keys_of(Place.RUNS)}
        self.found[key] = SiteRun(**key._asdict(), outcome=fields["outcome"] or None, **figures)
        self.lines[key] = line
        if fields["reason"]:
            self.reasons.append(fields["reason"])

    def in_order(self) -> dict[RunKey, SiteRun]:
        """All of them, stage by stage: not in the order in which they were ready, which depends on the cores."""
        return dict(sorted(self.found.items(), key=lambda pair: _place(pair[0])))

    def table(self) -> str:
        """`runs.csv`: a row a run, in the same order."""
        return table_of_lines(COLUMNS, (self.lines[key] for key in self.in_order()))

    def missing(self, keys: Iterable[RunKey]) -> list[RunKey]:
        """Those that have no row."""
        return [key for key in keys if key not in self.found]

    def of(self, keys: Sequence[RunKey]) -> list[SiteRun]:
        """The runs of these keys, in their order, as far as they are there."""
        return [self.found[key] for key in keys if key in self.found]


def _place(key: RunKey) -> tuple[Any, ...]:
    """What runs are sorted by."""
    stage = (SET, SCAN, REFINED, FURTHER).index(key.stage)
    container = key.mass != FULL, key.elevation != WIDTH, key.building_period_s or 0.0
    return stage, key.factor, *container, key.mu_static, key.mu_kinetic, key.motion, -key.vertical_sign
