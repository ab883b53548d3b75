"""The runs of a verification: the case of each, and their rows."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from fem.case.case import Case, read_case
from fem.case.data_files import FILE_KEYS
from fem.case.tables.input_ranges import TOLERANCE
from fem.case.toml import toml_document
from fem.results.figures import Place, columns_of, types_of
from fem.results.outcome import Outcome
from fem.run.changed_runs import tolerance_of_draws
from fem.site.request import FULL, WIDTH, SiteRequest
from fem.site.result import MOTIONS, REPEATED, SET, STAGES, RunKey, SiteRun
from fem.study.design import CaseMaker
from fem.study.runner import Row
from fem.study.table import table_text

CONFIRMING = (
    "reduced"  #: model with which the deciding runs are repeated, and how many of them there are at most
)
MOST_DECIDING = 2
NOT_COMPUTED = "below uplift and slip of a rigid body: not computed"
#: the columns that tell which run a row is of
KEYS = (
    *("stage", "motion", "vertical_sign", "mu_static", "mu_kinetic"),
    *("mass", "elevation", "building_period_s", "model", "factor"),
)
FOUND = {"outcome": str} | columns_of(Place.RUNS)
COLUMNS = {name: types_of(RunKey)[name] for name in KEYS} | FOUND | {"reason": str}


def key_of(run: SiteRun | Row) -> RunKey:
    """What a run, or that of a row, is made of."""
    return RunKey(**{name: run[name] for name in KEYS})


def cells_of(key: RunKey) -> tuple[Any, ...]:
    """The first cells of its row."""
    return tuple(getattr(key, name) for name in KEYS)


def cases_of(request: SiteRequest, folder: Path) -> Callable[[RunKey], Case]:
    """What makes the case of a run, picklable; its motion is read from the folder of results.

    That raises CaseError where the motion is missing.
    """
    bases = {name: still(case, request.heading.model) for name, case in request.variants.items()}
    return partial(_case, folder.resolve() / MOTIONS, {name: CaseMaker(base) for name, base in bases.items()})


def _case(place: Path, makers: Mapping[tuple[str, str], CaseMaker], key: RunKey) -> Case:
    make = makers[key.mass, key.elevation]
    values: dict[str, Any] = {
        "solver.model": key.model,
        "contact.mu_static": key.mu_static,
        "contact.mu_kinetic": key.mu_kinetic,
        "motion.kind": "table",
        "motion.file": str(place / f"{key.stem}_h.csv"),
        "motion.scale": key.factor,
    }
    if key.stage not in (SET, REPEATED):  # others are counted, or seek the margin of the rule
        values[TOLERANCE] = tolerance_of_draws(make.base)
    if key.vertical_sign:
        values |= {
            "vertical.kind": "table",
            "vertical.file": str(place / f"{key.stem}_v.csv"),
            "vertical.scale": key.vertical_sign * key.factor,
        }
    return make(values)


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

    def add(self, row: Row) -> None:
        """Add the row of a run."""
        key = key_of(row)
        self.runs[key] = SiteRun(**vars(key), **{name: row[name] for name in FOUND})
        self.rows[key] = row

    def rest(self, key: RunKey) -> None:
        """Add a run that is at rest and was not computed."""
        self.still.add(key)
        cells = dict(zip(KEYS, cells_of(key), strict=True))
        self.add(cells | dict.fromkeys(FOUND, 0.0) | {"outcome": Outcome.REST, "reason": NOT_COMPUTED})

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
