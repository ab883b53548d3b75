"""The runs behind the claims: without files, each computed once, on all cores.

Rows hold the scalars of a verdict; a history is kept where a claim needs one. A failed run has no outcome and
counts neither as standing nor as overturned: where its number is needed, the claim is not decided; where runs are
counted, it is left out, and the page gives the number of failed runs.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from case_rows import run_cases
from paper.cases import RIGID, SHELL, PaperCase
from runs import Finished

from contact.reference.rigid_block import RigidBlock
from fem.case.case import Case
from fem.model.model import Model, build_model
from fem.model.support import normal_penalty
from fem.results.outcome import ENDINGS, ROCKING
from fem.run.recorder import Recorder
from fem.run.rigid_check import block_of
from fem.run.simulation import simulate
from fem.study.containers import ContainerCache
from fem.study.design import CaseMaker
from fem.study.runner import Row

#: contact penalty over the one that "auto" chooses, and contact damping ratio, of the variants with a shell
PENALTY_FACTORS = (1.0 / 3.0, 1.0, 3.0)
DAMPING_RATIOS = (0.5, 2.0)
SUPPORTS = ("feet", "flat")
NONE_HOLDS = "it holds in none of them"


class FailedRunError(RuntimeError):
    """A run whose numbers a claim needs has failed."""


class InterruptedStudyError(Exception):
    """The user has interrupted the work."""

    exit_code = 4


@dataclass(frozen=True, kw_only=True)
class VariantResult:
    """The case of a claim on another container or floor; without outcome and value where its run failed."""

    what: str
    command: str
    outcome: str | None
    value: float | None
    holds: bool | None  #: whether the criterion of the claim holds there


@dataclass(frozen=True, kw_only=True)
class VariantBand:
    """Range of one number of a claim over deformation, contact stiffness, contact damping and support."""

    quantity: str
    unit: str
    criterion: str
    members: Sequence[VariantResult]
    drop: bool = False  #: mu_k is below mu_s

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest computed value; nan without any."""
        values = [member.value for member in self.members if member.value is not None] or [math.nan]
        return min(values), max(values)

    @property
    def holding(self) -> int:
        """In how many variants the criterion holds."""
        return sum(member.holds is True for member in self.members)

    @property
    def summary(self) -> str:
        """One line: how often the criterion holds, and whether that depends on the variant."""
        total = len(self.members)
        failed = sum(member.holds is None for member in self.members)
        lost = f", {failed} not computed" if failed else ""
        change = "it depends on deformation, contact or support"
        if self.holding in (0, total):
            change = (
                "deformation, contact and support do not change it" if self.holding == total else NONE_HOLDS
            )
        # friction drops, and only some variants slide while they rock; see the claim rigid-assumption
        if self.drop and set(ROCKING) <= {member.outcome for member in self.members}:
            change += "; with mu_k below mu_s it is chance which of them slide after an impact"
        return f"holds in {self.holding} of {total}{lost}: {change}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `study.json`."""
        return asdict(self) | dict(zip(("low", "high"), self.ends, strict=True)) | {"summary": self.summary}


def variant_result(case: PaperCase, outcome: str | None, value: float | None, holds: bool) -> VariantResult:
    """The result of a variant; without value and criterion if it has no outcome."""
    known, met = (None, None) if outcome is None else (value, bool(holds))
    return VariantResult(what=case.what, command=case.command, outcome=outcome, value=known, holds=met)


def capped_ratio(row: Row) -> float:
    """Rotation ratio, 1 where the container overturned, nan where the run failed [-]."""
    return math.nan if row["status"] == "failed" else min(float(row["rotation_ratio"]), 1.0)


def stands(row: Row) -> bool:
    """Whether the container of a run that did not fail neither overturned nor destroyed a corner."""
    return row["outcome"] not in ENDINGS


class Experiments:
    """Runs cases on so many cores, or all, and remembers their results.

    `progress` is called with the number of finished runs of a batch and of all; `stop` now and then: true ends the work
    with `InterruptedStudyError`.
    """

    def __init__(
        self,
        *,
        jobs: int | None = None,
        progress: Callable[[int, int], None] = lambda done, total: None,
        stop: Callable[[], bool] = lambda: False,
    ) -> None:
        self._jobs, self._progress, self._stop = jobs, progress, stop
        self._containers = ContainerCache()
        self._makers: dict[str, CaseMaker] = {}
        self._rows: dict[Any, Row] = {}
        self._runs: dict[Any, Finished] = {}
        self.failed: set[Any] = set()  #: keys of the cases whose runs failed; the caller clears it

    def case(self, paper_case: PaperCase) -> Case:
        """The case as a run reads it; its shipped case is read once."""
        if paper_case.base not in self._makers:
            self._makers[paper_case.base] = CaseMaker(PaperCase(base=paper_case.base).case)
        return self._makers[paper_case.base](paper_case.values)

    def rows(self, cases: Sequence[PaperCase], *, also_failed: bool = False) -> list[Row]:
        """Verdict scalars of each case, in order; on request those of failed runs as well, with outcome None."""
        missing = {case.key: self.case(case) for case in cases if case.key not in self._rows}
        if missing:
            computed = run_cases(
                list(missing.values()),
                jobs=self._jobs,
                done=lambda done: self._progress(done, len(missing)),
                stop=self._stop,
            )
            self._require_going()
            self._rows.update(zip(missing, computed, strict=True))
        rows = [self._rows[case.key] for case in cases]
        for case, row in zip(cases, rows, strict=True):
            if row["status"] == "failed":
                self.failed.add(case.key)
                if not also_failed:
                    raise FailedRunError(f"{case.what or case.command}: {row['reason']}")
        return rows

    def row(self, paper_case: PaperCase) -> Row:
        """Verdict scalars of one case; raises as `rows`."""
        return self.rows([paper_case])[0]

    def run(self, paper_case: PaperCase, *, also_failed: bool = False) -> Finished:
        """The run of a case with its history; arguments and errors as for `rows`."""
        if paper_case.key not in self._runs:
            model = self.model(paper_case)
            recorder = Recorder(model)
            ending = simulate(model, recorder, stop=self._stop)
            self._require_going()
            self._runs[paper_case.key] = Finished(
                model=model, history=recorder.history(), status=ending.status
            )
        run = self._runs[paper_case.key]
        if run.status == "failed":
            self.failed.add(paper_case.key)
            if not also_failed:
                raise FailedRunError(f"{paper_case.what or paper_case.command}: the run failed")
        return run

    def model(self, paper_case: PaperCase) -> Model:
        """The model of a case, at t = 0."""
        case = self.case(paper_case)
        return build_model(case, self._containers.container_of(case))

    def block(self, paper_case: PaperCase) -> RigidBlock:
        """The analytic block with the mass and geometry of a case."""
        return block_of(self.model(paper_case.but(RIGID)))

    def on_floor(self, paper_case: PaperCase, factor: float) -> PaperCase:
        """The case with a multiple of the contact penalty that "auto" chooses."""
        case = self.case(paper_case)
        auto = normal_penalty(case, self._containers.container_of(case).mesh)
        return paper_case.but({"contact.normal_penalty_Pa_m": float(f"{factor * auto:.6g}")})

    def variants(self, paper_case: PaperCase) -> list[PaperCase]:
        """The rigid container and the shell: on corners of three penalties and two dampings, on feet, flat."""
        shell = paper_case.but(SHELL)
        corners = [
            variant
            for factor in PENALTY_FACTORS
            for variant in self.on_floor(shell, factor).scan(
                "damping", DAMPING_RATIOS, f"shell, corners, penalty x {factor:.2g}, contact damping {{:g}}"
            )
        ]
        others = [shell.but(support=kind, what=f"shell, {kind}") for kind in SUPPORTS]
        return [paper_case.but(RIGID, what="rigid, corners"), *corners, *others]

    def band(
        self,
        paper_case: PaperCase,
        quantity: str,
        criterion: str,
        holds: Callable[[Row], bool],
        *,
        value: Callable[[Row], float | None] = lambda row: row["rotation_ratio"],
        unit: str = "-",
    ) -> VariantBand:
        """One number of a case over deformation, contact stiffness, contact damping and support.

        `value` takes the number from a row; `criterion` and `holds` are what the claim requires of a row.
        """
        variants = self.variants(paper_case)
        members = []
        for variant, row in zip(variants, self.rows(variants, also_failed=True), strict=True):
            failed = row["status"] == "failed"
            result = (None, None, False) if failed else (row["outcome"], value(row), holds(row))
            members.append(variant_result(variant, *result))
        contact = self.case(paper_case).contact
        drop = contact.mu_kinetic < contact.mu_static
        return VariantBand(quantity=quantity, unit=unit, criterion=criterion, members=members, drop=drop)

    def _require_going(self) -> None:
        if self._stop():
            raise InterruptedStudyError("interrupted; the claims checked so far are kept")
