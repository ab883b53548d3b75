"""The band of a run: the run repeated with its unknown inputs changed, side by side on its container.

Members of rigid and reduced models that take seconds run without a history; of a bolted stack those that change one
unknown input have one, for the forces in its joints. Long ones and those of the `full` model have one. How many fit a
budget follows from the sizes and steps of the run, not from the clock, so that a resumed or repeated study is the same.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Event, Lock
from typing import Any

from fem.case.case import Case
from fem.case.tables.input_ranges import SUPPORT, TOLERANCE, Value
from fem.case.uncertainty import InputChange, all_changes, as_changed, stiff_floor
from fem.model.container import Container, adapted_container, discretise
from fem.model.joints import Joints, joints_of
from fem.model.model import Model, build_model
from fem.model.motion import build_motions
from fem.model.recovery import Recovery, recovery_of
from fem.model.validity import runs_in_memory
from fem.results.figures import FELL_FIRST, Place
from fem.results.json_block import to_json
from fem.results.outcome import Outcome
from fem.results.run_result import ChangedRun, JointDemand, Numerics, RunResult, StaticResult, Verdict
from fem.run.recorder import Recorder
from fem.run.simulation import run_without_history, simulate
from fem.run.sureness import judged, static_use
from fem.run.verdict import held_by, joint_demands, verdict_of
from fem.run.words import largest_bolt_forces
from fem.runtime.identity import program_identity
from fem.runtime.memory import threads_of_rigid_runs
from fem.runtime.progress import Reporter
from fem.runtime.threads import cores
from fem.runtime.user_files import read_json
from fem.solid.nodal_body import full_model_memory

SHORT_S = 5.0  #: estimated processor time up to which a run is stepped in one go [s]
COST = 1.2  #: of a changed run over the run: stiffer floors and tighter tolerances take more steps
#: processor time of one attempted step of a modal model: fixed, by (base points)^2, by unknowns x 2 base points [s].
#: Measured: 0.42e-6 (rigid) and 0.87e-6 (20 modes) on corners, 4.3e-6 (feet), 5.6e-6 and 25e-6 (flat)
STEP_COST = (0.4e-6, 7e-9, 5e-9)
DRAWN_TOLERANCE = 10.0  #: energy tolerance of draws at least, as of maps: 0.01 to 10 give the same outcomes
STORED_S = 1.0  #: wall time between two notes of finished runs
#: share of a static limit from which a container at rest may be brought to move by an unknown input
NEAR_LIMIT = 0.7
MOST_LIFTING = 0.3  #: vertical acceleration over g up to which that holds
#: shares of the uplift acceleration between which a soft bed may rock a container that a rigid floor would not
BELOW_UPLIFT = (0.85, 1.0)
#: processor time for the members, by the estimate of `cost_of` [s]; members that are computed in any case
BUDGET_S, LEAST_MEMBERS = 30.0, 6


class ChangedRunsFile:
    """The finished runs of a file; its methods may be called by several threads.

    `write` replaces the file by a text, and an OSError of it ends the work; `message` receives why a file is refused.
    """

    def __init__(
        self, path: Path, *, case_hash: str, write: Callable[[str], None], message: Callable[[str], None]
    ) -> None:
        self._path, self._write, self._message = path, write, message
        self._owner = {"case_hash": case_hash, "program": program_identity()}

    def read(self) -> list[ChangedRun]:
        """The finished runs."""
        if not self._path.exists():
            return []
        try:
            content = read_json(self._path)
            if any(content[key] != value for key, value in self._owner.items()):
                raise ValueError("of another case or another version of the program")
            return [ChangedRun.from_json(member) for member in content["members"]]
        except (OSError, ValueError, KeyError, TypeError) as error:
            self._message(f"{self._path} is refused ({error}): its members are computed again")
            return []

    def store(self, runs: Sequence[ChangedRun]) -> None:
        """Store the finished runs, in an order that does not depend on which were finished first."""
        ordered = sorted(runs, key=lambda run: repr(key_of(run.values)))
        self._write(to_json(self._owner | {"members": [run.to_json() for run in ordered]}))


def key_of(values: Mapping[str, Value] | None) -> tuple[tuple[str, Value], ...]:
    """Equal for runs that change the same inputs to the same values, within rounding."""
    rounded = {
        key: float(f"{value:.9g}") if isinstance(value, float) else value
        for key, value in (values or {}).items()
    }
    return tuple(sorted(rounded.items()))


@dataclass(frozen=True, kw_only=True)
class Shared:
    """What all runs take from the container that they share."""

    short: bool  #: they are stepped in one go
    recovery: Recovery | None  #: of stresses
    joints: Joints | None  #: of a bolted stack, where forces in them are wanted
    #: containers with their cases: that of the run first, then those built for bases that touch at other points
    built: list[tuple[Case, Container]]
    one_at_a_time: Lock  #: builds

    def container_of(self, case: Case) -> Container:
        """The container of a changed case, from one that is built, where it stands on the same points."""
        with self.one_at_a_time:
            for own, container in self.built:
                adapted = adapted_container(case, container, own)
                if adapted is not None:
                    return adapted
            self.built.append((case, discretise(case)))
            return self.built[-1][1]


def cost_of(numerics: Numerics) -> float:
    """Processor time that a changed run of a modal model takes, about, from the steps and sizes of its run [s]."""
    points, unknowns = numerics.contact_nodes or 0, numerics.unknowns or 0
    fixed, by_points, by_unknowns = STEP_COST
    step = fixed + by_points * points**2 + by_unknowns * unknowns * 2 * points
    return COST * step * max(1, (numerics.steps or 0) + (numerics.rejected or 0))


def workers_for(model: Model, runs: int) -> int:
    """How many runs of a model are stepped side by side: as many as cores and, of the full model, memory allow."""
    workers, kind = min(cores(), max(1, runs)), model.case.solver.model
    if kind != "full":
        return threads_of_rigid_runs(workers) if kind == "rigid" else workers
    return runs_in_memory(workers, full_model_memory(len(model.container.elements.nodes)))


def worker_threads(count: int) -> Executor:
    """So many threads; of one the thread that asks, whose stack is there already."""
    return ThreadPoolExecutor(count) if count > 1 else _Asking()


class _Asking(Executor):
    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except BaseException as error:  # raised where the result is asked for, as by a thread
            future.set_exception(error)
        return future


def tolerance_of_draws(case: Case) -> float:
    """Energy tolerance of runs that are drawn or counted."""
    return max(DRAWN_TOLERANCE, case.solver.energy_tolerance)


def run_changes(
    model: Model,
    changes: Sequence[InputChange],
    *,
    numerics: Numerics,
    stop: Callable[[], bool],
    kept_in: ChangedRunsFile | None = None,
    inner_forces: bool = True,
) -> list[ChangedRun]:
    """One run for each change, side by side; a problem of any kind is its error, never an outcome.

    Args:
        model: of the run, whose `numerics` these are; the mesh and modes of its container serve every change.
        stop: called in pauses; true ends the work.
        kept_in: a file of finished runs, to resume from and to add to.
        inner_forces: find stresses and the forces in joints of a stack, which takes twice as long.

    Returns:
        The runs in the order of the changes; those not finished have the status "interrupted".
        An OSError where the file cannot be written; the other runs have stopped then.
    """
    case = model.case
    short = case.solver.model != "full" and cost_of(numerics) <= SHORT_S
    shared = Shared(
        short=short,
        recovery=recovery_of(model) if inner_forces and case.solver.model == "reduced" else None,
        joints=joints_of(model) if inner_forces and short and case.container.bolted_joints else None,
        built=[(case, model.container)],
        one_at_a_time=Lock(),
    )
    kept = {key_of(run.values): run for run in (kept_in.read() if kept_in else ())}
    one_at_a_time, broken = Lock(), Event()
    stored, unstored = time.monotonic(), False

    def halted() -> bool:
        return stop() or broken.is_set()

    def run_of(change: InputChange) -> ChangedRun:
        nonlocal stored, unstored
        key = key_of(change.values)
        if key in kept:
            return replace(kept[key], kind=change.kind, change=change.label)
        if halted():
            return _without_outcome(change, "interrupted")
        try:
            run = _run_changed(model, change, shared, halted)
            with one_at_a_time:
                if run.status != "interrupted":
                    kept[key] = run
                    unstored = True
                    if kept_in and (not short or time.monotonic() - stored > STORED_S):
                        kept_in.store(list(kept.values()))
                        stored, unstored = time.monotonic(), False
        except BaseException:
            broken.set()  # stops the others
            raise
        return run

    with worker_threads(workers_for(model, len(changes))) as pool:
        runs = list(pool.map(run_of, changes))
    if kept_in and unstored:
        kept_in.store(list(kept.values()))
    return runs


def _run_changed(run: Model, change: InputChange, shared: Shared, stop: Callable[[], bool]) -> ChangedRun:
    try:
        values = {**change.values, "output.fields_s": 0.0}
        if change.kind == "draw" or SUPPORT in change.values:  # a flat base takes twenty times as long
            values[TOLERANCE] = tolerance_of_draws(run.case)
        case = run.case.with_values(as_changed(run.case, values))
        motions = build_motions(case, (run.case, run.motion, run.vertical))
        model = build_model(case, shared.container_of(case), motions=motions)
        same_elements = model.container.elements is run.container.elements
        recovery = shared.recovery if same_elements or shared.recovery is None else recovery_of(model)
        if shared.short and (change.kind != "one" or shared.joints is None):
            verdict, error = run_without_history(model, recovery)
            status = "completed" if verdict.overturned_at_s is None else "overturned"
            if error is not None:
                return _without_outcome(change, "failed", error)
            return _changed_run(change, model, status, verdict, None)
        # the forces in its joints follow from mass and weight
        same_load = model.container is run.container and case.floor.slope == run.case.floor.slope
        joints = shared.joints if same_load or shared.joints is None else joints_of(model)
        recorder = Recorder(model, recovery, joints=joints)
        # to drain a rigid run every second takes longer than to step it
        ending = simulate(model, recorder, stop=stop, slice_s=model.duration if shared.short else None)
    # bad input, no equilibrium, a singular matrix
    except (ValueError, ArithmeticError, RuntimeError) as problem:
        return _without_outcome(change, "failed", str(problem))
    if ending.status not in ("completed", "overturned"):
        return _without_outcome(change, ending.status, ending.error)
    history = recorder.history()
    verdict = verdict_of(model, history, recorder.largest_von_mises)
    demands = joint_demands(model, history) if shared.short else None
    return _changed_run(change, model, ending.status, verdict, demands)


def _changed_run(
    change: InputChange | None,
    model: Model,
    status: str,
    verdict: Verdict,
    joints: Sequence[JointDemand] | None,
) -> ChangedRun:
    """The changed run of a verdict; without a change, the run itself."""
    tension, shear = largest_bolt_forces(joints) if joints else (None, None)
    return replace(
        ChangedRun(status=status) if change is None else _without_outcome(change, status),
        normal_penalty_Pa_m=None if model.case.floor.is_slab else model.penalty,
        damping_ratio=model.damping_ratio,
        outcome=verdict.outcome,
        **verdict.figures(Place.BAND) | {"bolt_tension_N": tension, "bolt_shear_N": shear},
        boxes=verdict.boxes,
        links=held_by(model),
        **{key: getattr(verdict, key) for key in FELL_FIRST},
    )


def _without_outcome(change: InputChange, status: str, error: str | None = None) -> ChangedRun:
    return ChangedRun(
        change=change.label, kind=change.kind, values=dict(change.values), status=status, error=error
    )


def wants_band(choice: bool | None, case: Case, result: RunResult) -> bool:
    """Whether a finished run gets a band: as chosen, else unless it rests far below the static limits.

    A run of the `full` model, whose band would take several times as long as the run, and a run that is not valid get
    one only on request.
    """
    if choice is not None:
        return choice
    outcome = (result.verdict or Verdict()).outcome
    if outcome in (None, Outcome.INVALID):
        return False
    return case.solver.model != "full" and not rests_far_below_limits(case, result)


def rests_far_below_limits(case: Case, result: RunResult) -> bool:
    """True if the run rests and no unknown input could use up the static reserve; where all that acts is in the rule.

    It does not cover the joints of a loose stack, a neighbour, a push at the start, a floor that moves up by a part of
    gravity, or a range that the case states, which may be wider than the reserve.
    """
    beyond_rule = case.container.is_loose or case.neighbour or case.initial.is_pushed
    if beyond_rule or any(isinstance(span, list) for _, span in case.uncertainty):
        return False
    used, lifting = static_use(result), (result.static or StaticResult()).ruling.utilisation_lifting or 0.0
    rests = (result.verdict or Verdict()).outcome == Outcome.REST
    return rests and used is not None and used < NEAR_LIMIT and lifting <= MOST_LIFTING


def plan_of(model: Model, result: RunResult) -> tuple[list[InputChange], list[InputChange]]:
    """The members of a band, those that decide most often first; and those for which there is no time."""
    case, penalty = model.case, model.penalty
    use = (result.static or StaticResult()).ruling.utilisation_overturning or 0.0
    low, high = BELOW_UPLIFT
    soft = case.support.kind != "corners" and low <= use <= high
    floors = [stiff_floor(case, penalty)] if soft else []
    singles, pairs, draws = all_changes(case, penalty)
    ends = list(
        {change.inputs: change for change in singles}.values()
    )  # of their ranges, the last of the same inputs
    ordered = [*floors, *ends, *(change for change in singles if change not in ends), *pairs, *draws]
    cost = cost_of(result.numerics or Numerics())
    most = LEAST_MEMBERS if case.solver.model == "full" else max(LEAST_MEMBERS, int(BUDGET_S / cost))
    return ordered[:most], ordered[most:]


def with_band(
    model: Model,
    result: RunResult,
    *,
    stop: Callable[[], bool],
    reporter: Reporter | None = None,
    kept_in: ChangedRunsFile | None = None,
    inner_forces: bool = True,
) -> Verdict | None:
    """Compute the members of a band side by side and judge the verdict of the run by them.

    Args:
        model, result: of the run, which is itself a member.
        stop: called in pauses; true ends the band.
        reporter: is told how many members there are.
        kept_in: the file of its finished members, to resume from.
        inner_forces: as for `run_changes`.

    Returns:
        The verdict with its band, or None if it was stopped. An OSError as for `run_changes`.
    """
    (changes, left_out), numerics = plan_of(model, result), result.numerics or Numerics()
    if reporter is not None:
        reporter.message(f"band: {len(changes)} runs with the unknown inputs varied")
    members = run_changes(
        model, changes, numerics=numerics, stop=stop, kept_in=kept_in, inner_forces=inner_forces
    )
    if any(member.status == "interrupted" for member in members):
        return None
    verdict = result.verdict or Verdict()
    own = _changed_run(None, model, result.status, verdict, result.joints)
    return judged(verdict, [own, *members], changes, left_out, width=model.container.mesh.width)
