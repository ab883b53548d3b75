"""The runs of a verification: which there are, the case of each, and their rows."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from fem.case.case import Case, read_case
from fem.case.data_files import FILE_KEYS
from fem.case.tables.input_keys import TOLERANCE
from fem.case.toml import toml_document
from fem.results.figures import Place, columns_of, types_of
from fem.results.outcome import Outcome
from fem.run.bracket import values_to_try
from fem.run.changed_runs import tolerance_of_draws
from fem.site_check.file import FULL, SiteRequest
from fem.site_check.result import MOTIONS, SiteRun
from fem.site_check.rule import RuleFound, RunGroup, groups_of
from fem.study.design import CaseMaker
from fem.study.runner import Row
from fem.study.table import row_of, table_text

SET, REPEATED, SCAN, REFINED, FURTHER = "set", "repeated", "scan", "refined", "further"
HAZARD = "hazard"  #: levels for the rate per year
STAGES = (SET, REPEATED, SCAN, REFINED, FURTHER, HAZARD)  #: in the order of the rows
WIDTH = "width"  #: the elevation that a case file shows
#: factors on the motions beside 1, and values tried below the first that fails and below the first that overturns
SCANNED = (0.5, 0.75, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0)
BETWEEN = 3
NOT_COMPUTED = "below uplift and slip of a rigid body: not computed"
#: factors of the repetitions: nobody can tell such motions from those of the set, rocking can
REPETITIONS = (1.0 - 1e-4, 1.0 - 1e-5, 1.0 + 1e-6, 1.0 + 1e-5, 1.0 + 1e-4)


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
        return motion_stem(self.motion, self.building_period_s, self.stage)


def key_of(run: SiteRun) -> RunKey:
    """What a run is made of."""
    return RunKey(*(run[name] for name in RunKey._fields))


FOUND = {"outcome": str} | columns_of(Place.RUNS)
COLUMNS = {key: types_of(RunKey)[key] for key in RunKey._fields} | FOUND | {"reason": str}


def motion_stem(number: int, period: float | None, stage: str = SET) -> str:
    """Beginning of the names of the files of a motion."""
    name = f"{stage}_{number:03d}" if stage in (FURTHER, HAZARD) else f"motion_{number:02d}"
    return name if period is None else f"{name}_floor_{period:g}s"


def runs_by_factor(runs: Mapping[RunKey, SiteRun], *stages: str) -> dict[float, list[SiteRun]]:
    """The runs of these stages, by rising factor."""
    by_factor: dict[float, list[SiteRun]] = {}
    for key, run in runs.items():
        if key.stage in stages:
            by_factor.setdefault(key.factor, []).append(run)
    return dict(sorted(by_factor.items()))


@dataclass(frozen=True, kw_only=True, eq=False)
class RunPlan:
    """The runs of a request, stage by stage."""

    request: SiteRequest
    motions: int  #: of the set
    vertical: bool  #: whether they have a vertical component
    periods: tuple[float | None, ...]  #: of the building

    @property
    def signs(self) -> tuple[int, ...]:
        """Of the vertical component."""
        return (1, -1) if self.vertical else (0,)

    @property
    def factors(self) -> list[float]:
        """Of the scan, rising; that of the set is not among them."""
        return sorted(SCANNED)

    def of_set(self) -> list[RunKey]:
        """Every motion with both signs, over weights, elevations, periods and frictions."""
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
                self.signs,
            )
        ]

    def repeated(self, groups: Iterable[RunGroup]) -> list[RunKey]:
        """The runs of some groups with changes that nobody can tell apart."""
        own = [key for group in groups for key in map(key_of, group.runs)]
        return [key._replace(stage=REPEATED, factor=factor) for factor in REPETITIONS for key in own]

    def scanned(self, factor: float) -> list[RunKey]:
        """All runs of the set at another factor."""
        return [key._replace(stage=SCAN, factor=factor) for key in self.of_set()]

    def refined(self, runs: Mapping[RunKey, SiteRun]) -> list[RunKey]:
        """Runs between the first factor at which a run overturns, or the rule fails, and the factor below.

        Where the rule fails, all runs of the groups that fail: it may count their mean.
        """
        by_factor = runs_by_factor(runs, SET, SCAN)
        wanted: dict[RunKey, None] = {}

        def between(first: float, keys: Iterable[RunKey]) -> None:
            known = {factor: str(factor == first) for factor in by_factor if factor <= first}
            for factor in values_to_try(known, resolution=0.0, inner=BETWEEN):
                wanted.update(dict.fromkeys(key._replace(stage=REFINED, factor=factor) for key in keys))

        limits = self.request.limits
        failing = {
            factor: [group for group in groups_of(own) if RuleFound.of([group]).fails(limits)]
            for factor, own in by_factor.items()
        }
        fell = {
            factor: [run for run in own if run.outcome == Outcome.OVERTURNED]
            for factor, own in by_factor.items()
        }
        if (first := min((factor for factor, groups in failing.items() if groups), default=None)) is not None:
            between(first, [key_of(run) for group in failing[first] for run in group.runs])
        if (first := min((factor for factor, own in fell.items() if own), default=None)) is not None:
            between(first, list(map(key_of, fell[first])))
        return list(wanted)

    def of_further(self, groups: Iterable[RunGroup], count: int) -> list[RunKey]:
        """Further motions with both signs, for the containers and frictions of these groups."""
        return [
            key_of(group.first)._replace(stage=FURTHER, motion=number, vertical_sign=sign)
            for group in groups
            for number in range(1, count + 1)
            for sign in self.signs
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
            (variant.mass, variant.elevation): still(variant.case, request.heading.model)
            for variant in request.variants
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
        if key.stage not in (SET, REPEATED):  # others are counted, or seek the margin of the rule
            values[TOLERANCE] = tolerance_of_draws(self.bases[key.mass, key.elevation])
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
        {
            "solver.model": model,
            "solver.duration_s": "auto",
            "output.fields_s": 0.0,
            "output.stop_when_still": True,
        }
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class RunRows:
    """The rows of the runs so far."""

    runs: dict[RunKey, SiteRun] = field(default_factory=dict)
    rows: dict[RunKey, Row] = field(default_factory=dict)  #: of the log
    still: set[RunKey] = field(default_factory=set)  #: those at rest that were not computed

    def note(self, line: str) -> None:
        """Add a line of the log."""
        self.add(row_of(COLUMNS, line))

    def add(self, row: Row) -> None:
        """Add the row of a run."""
        key = RunKey(*(row[name] for name in RunKey._fields))
        self.runs[key] = SiteRun(**key._asdict(), **{name: row[name] for name in FOUND})
        self.rows[key] = row

    def rest(self, key: RunKey) -> None:
        """Add a run that is at rest and was not computed."""
        self.still.add(key)
        at_rest = dict.fromkeys(FOUND, 0.0) | {"outcome": Outcome.REST, "reason": NOT_COMPUTED}
        self.add(key._asdict() | at_rest)

    def in_order(self) -> dict[RunKey, SiteRun]:
        """All of them, stage by stage: not in the order in which they were ready, which depends on the cores."""
        return dict(sorted(self.runs.items(), key=lambda pair: _place(pair[0])))

    def table(self) -> str:
        """`runs.csv`: a row a run, in the same order."""
        return table_text(COLUMNS, (self.rows[key].values() for key in self.in_order()))

    def missing(self, keys: Iterable[RunKey]) -> list[RunKey]:
        """Those that have no row."""
        return [key for key in keys if key not in self.runs]

    def of(self, keys: Sequence[RunKey]) -> list[SiteRun]:
        """The runs of these keys, in their order, as far as they are there."""
        return [self.runs[key] for key in keys if key in self.runs]


def _place(key: RunKey) -> tuple[Any, ...]:
    """What runs are sorted by."""
    stage = STAGES.index(key.stage)
    container = key.mass != FULL, key.elevation != WIDTH, key.building_period_s or 0.0
    return stage, key.factor, *container, key.mu_static, key.mu_kinetic, key.motion, -key.vertical_sign
