"""Where statements are tried: runs without files, each computed once, on all cores.

Rows hold the scalars of a verdict; a history is kept where a statement needs one. A run that failed has no
outcome and is counted nowhere as standing or fallen: where a number of it is needed, the statement is not decided;
where runs are counted, it is left out, and the page says how many were.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from contact.jit import is_compiled
from fem.batch.case_maker import CaseMaker
from fem.batch.runner import Shelf, run_cases
from fem.case.case import Case
from fem.model.model import Model, build_model
from fem.model.support import normal_penalty
from fem.paper.claims import Band, Member, Setup
from fem.results.history import History
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

Row = dict[str, Any]

RIGID = {"solver.model": "rigid"}
#: contact penalty over the one that "auto" chooses, and contact damping ratio, of the shell's members
PENALTY_FACTORS = (1.0 / 3.0, 1.0, 3.0)
DAMPING_RATIOS = (0.5, 2.0)
SUPPORTS = ("feet", "flat")


class FailedRunError(RuntimeError):
    """A run whose figures a statement needs has failed."""


class InterruptedStudyError(Exception):
    """The user has asked to stop."""

    exit_code = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """A finished run with its history."""

    model: Model
    history: History
    status: str  #: completed | overturned | failed

    @property
    def track(self) -> Any:
        """Extremes and events, see `contact.stepping.observables.OBSERVABLES`."""
        return self.model.run.track[0]


class Laboratory:
    """Runs setups and remembers them.

    Args:
        jobs: cores to use; None: all.
        progress: told how many of how many runs of a batch are done.
        stop: asked now and then; true ends the work with `InterruptedStudyError`.
    """

    def __init__(
        self,
        *,
        jobs: int | None = None,
        progress: Callable[[int, int], None] = lambda done, total: None,
        stop: Callable[[], bool] = lambda: False,
    ) -> None:
        self._jobs = jobs
        self._progress = progress
        self._stop = stop
        self._shelf = Shelf()
        self._makers: dict[str, CaseMaker] = {}
        self._rows: dict[Any, Row] = {}
        self._records: dict[Any, Record] = {}
        self.failed: set[Any] = set()  #: keys of the setups that failed, of those asked for; to be cleared

    def warm_up(self, tell: Callable[[str], None]) -> None:
        """Have the kernels of rigid container and shell compiled and loaded before a statement's clock starts."""
        if not is_compiled("advance_in_slices"):
            tell("compiling the stepping kernels, once after installation: some minutes")
        for model in ("rigid", "reduced"):
            values = {"solver.model": model, "solver.duration_s": 0.01, "output.history_s": 0.01}
            self.record(Setup(base="seed_stack", values=values))
            self.rows([Setup(base="seed_stack", values=values)])

    def case(self, setup: Setup) -> Case:
        """The case of a setup, without reading its shipped case again.

        Raises:
            CaseError: as for a case file.
        """
        if setup.base not in self._makers:
            self._makers[setup.base] = CaseMaker(Setup(base=setup.base).case)
        return self._makers[setup.base](setup.values)

    def attempts(self, setups: Sequence[Setup]) -> list[Row]:
        """Verdict scalars of each setup, in order; `status` says how each ended, `outcome` is None where it failed.

        Raises:
            CaseError: bad input.
            InterruptedStudyError: told to stop.
        """
        missing = {setup.key: setup for setup in setups if setup.key not in self._rows}
        if missing:
            cases = [self.case(setup) for setup in missing.values()]
            found = run_cases(
                cases, jobs=self._jobs, done=lambda done: self._progress(done, len(cases)), stop=self._stop
            )
            if self._stop():
                raise InterruptedStudyError("the study was stopped; what is finished is kept")
            self._rows.update(zip(missing, found, strict=True))
        rows = [self._rows[setup.key] for setup in setups]
        self.failed |= {s.key for s, row in zip(setups, rows, strict=True) if row["status"] == "failed"}
        return rows

    def rows(self, setups: Sequence[Setup]) -> list[Row]:
        """Verdict scalars of each setup, in order, of runs that all came to their end.

        Raises:
            FailedRunError: one failed.
            CaseError, InterruptedStudyError: as `attempts`.
        """
        rows = self.attempts(setups)
        for setup, row in zip(setups, rows, strict=True):
            if row["status"] == "failed":
                raise FailedRunError(f"{setup.what or setup.command}: {row['reason']}")
        return rows

    def attempt(self, setup: Setup) -> Record:
        """The run of a setup with its history, failed or not.

        Raises:
            CaseError: bad input.
            InterruptedStudyError: told to stop.
        """
        if setup.key not in self._records:
            model = self.model(setup)
            recorder = Recorder(model)
            ending = simulate(model, recorder, stop=self._stop)
            if ending.status == "interrupted":
                raise InterruptedStudyError("the study was stopped; what is finished is kept")
            self._records[setup.key] = Record(model=model, history=recorder.history(), status=ending.status)
        record = self._records[setup.key]
        if record.status == "failed":
            self.failed.add(setup.key)
        return record

    def record(self, setup: Setup) -> Record:
        """The run of a setup with its history, come to its end.

        Raises:
            FailedRunError: it failed.
            CaseError, InterruptedStudyError: as `attempt`.
        """
        record = self.attempt(setup)
        if record.status == "failed":
            raise FailedRunError(f"{setup.what or setup.command}: the run failed")
        return record

    def model(self, setup: Setup) -> Model:
        """What is stepped, at t = 0."""
        case = self.case(setup)
        return build_model(case, self._shelf.container_of(case))

    def penalty(self, setup: Setup) -> float:
        """Normal penalty of a setup, chosen or given [Pa/m]."""
        case = self.case(setup)
        return normal_penalty(case, self._shelf.container_of(case).mesh)

    def variants(self, setup: Setup) -> list[Setup]:
        """The rigid container and the shell: on corners of three penalties and two dampings, on feet, flat."""
        shell = setup.but({"solver.model": "reduced"})
        auto = self.penalty(shell)
        members = [setup.but(RIGID, "rigid, corners")]
        for factor in PENALTY_FACTORS:
            for damping in DAMPING_RATIOS:
                values = {
                    "contact.normal_penalty_Pa_m": float(f"{factor * auto:.6g}"),
                    "contact.damping_ratio": damping,
                }
                members.append(
                    shell.but(values, f"shell, corners, penalty x {factor:.2g}, contact damping {damping:g}")
                )
        return members + [shell.but({"support.kind": kind}, f"shell, {kind}") for kind in SUPPORTS]

    def band(
        self,
        setup: Setup,
        *,
        quantity: str,
        unit: str,
        value: Callable[[Row], float | None],
        criterion: str,
        holds: Callable[[Row], bool],
        values: Mapping[str, Any] | None = None,
    ) -> Band:
        """One number of a setup over deformation, contact stiffness, contact damping and support.

        Args:
            setup: the statement's case.
            quantity, unit, value: which number, of a row.
            criterion, holds: what the statement asks of a row.
            values: keys changed for all members, such as a shorter duration.
        """
        members = self.variants(setup.but(values or {}))
        found = []
        for member, row in zip(members, self.attempts(members), strict=True):
            stands = row["status"] != "failed"
            found.append(
                Member(
                    what=member.what,
                    command=member.command,
                    outcome=row["outcome"],
                    value=value(row) if stands else None,
                    holds=bool(holds(row)) if stands else None,
                )
            )
        return Band(quantity=quantity, unit=unit, criterion=criterion, members=tuple(found))
