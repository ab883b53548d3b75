"""The band of a run: what it does when the unknown inputs change.

`fem.case.uncertainty` says which inputs these are, in which ranges, and makes the changed cases; here they are run, and
`fem.assessment.sureness` says what they show. All have the container of the run. Members of rigid and reduced models
that take seconds run without a history; those that change one input have one where a stack needs the forces in its
joints; long ones and those of the `full` model have one. What does not fit the budget is left out:
first the draws, then the changes of which another of the same input is tried. The choice follows from the sizes and
steps of the run, not from the clock, so that a resumed or repeated band is the same.
"""

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

from fem.assessment.joint_demands import joint_demands
from fem.assessment.ranges import largest_bolt_forces
from fem.assessment.sureness import judged, static_use
from fem.assessment.verdict import verdict_of
from fem.case.case import Case
from fem.case.uncertainty import InputChange, apart_from_floor, changes_of, draws_of, pairs_of, stiff_floor
from fem.case.unknown_inputs import TOLERANCE, Value
from fem.model.joints import Joints, joints_of
from fem.model.model import Model, build_model
from fem.model.recovery import Recovery, recovery_of
from fem.model.validity import runs_in_memory
from fem.results.figures import Place
from fem.results.outcome import Outcome
from fem.results.run_result import (
    BandMember,
    JointDemand,
    Numerics,
    RunResult,
    StaticResult,
    Verdict,
)
from fem.run.band_checkpoint import BandCheckpoint
from fem.run.outcome import run_without_history
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.runtime.threads import cores
from fem.solid.nodal_body import full_model_memory

#: share of a static limit from which a container at rest may be brought to move by what is not known
NEAR_LIMIT = 0.7
#: shares of the uplift acceleration between which a soft bed may rock a container that a rigid floor would not
BELOW_UPLIFT = (0.85, 1.0)
#: processor time for the members, by the estimate below [s]; members that are computed in any case
BUDGET_S, LEAST_MEMBERS = 30.0, 6
SHORT_S = 5.0  #: estimated time up to which a member is stepped in one go [s]
MEMBER_COST = 1.2  #: of a member over the run: stiffer floors and tighter tolerances take more steps
#: processor time of one attempted step of a modal model: fixed, by (base points)^2, by unknowns x 2 base points [s].
#: Measured: 0.42e-6 (rigid) and 0.87e-6 (20 modes) on corners, 4.3e-6 (feet), 5.6e-6 and 25e-6 (flat)
STEP_COST = (0.4e-6, 7e-9, 5e-9)
DRAWN_TOLERANCE = 10.0  #: energy tolerance of draws at least, as of maps: 0.01 to 10 give the same outcomes
STORED_S = 1.0  #: wall time between two notes of finished members


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Which members a band has."""

    changes: tuple[InputChange, ...]
    left_out: tuple[InputChange, ...]  #: for which there is no time
    short: bool  #: members are so short that they are stepped in one go


@dataclass(frozen=True, kw_only=True)
class Shared:
    """What all members take from the container that they share."""

    recovery: Recovery | None  #: of stresses
    joints: Joints | None  #: of a stack


def wants_band(asked: bool | None, case: Case, result: RunResult) -> bool:
    """Whether a finished run is to have a band: as asked, else unless it rests far below the static limits.

    A run of the `full` model has one only when asked: it would take several times as long.
    """
    if asked is not None:
        return asked
    outcome = (result.verdict or Verdict()).outcome
    return case.solver.model != "full" and outcome is not None and not rests_far_below_limits(result)


def rests_far_below_limits(result: RunResult) -> bool:
    """True if the run rests and no unknown input could use up the static reserve."""
    used = static_use(result)
    return (result.verdict or Verdict()).outcome == Outcome.REST and used is not None and used < NEAR_LIMIT


def plan_of(model: Model, result: RunResult) -> Plan:
    """The members of a band, those that decide most often first."""
    case, penalty = model.case, model.penalty
    own = (result.static or StaticResult()).ruling
    low, high = BELOW_UPLIFT
    soft = case.support.kind != "corners" and low <= (own.utilisation_overturning or 0.0) <= high
    floor = (stiff_floor(case, penalty),) if soft else ()
    one, pairs, draws = changes_of(case, penalty), pairs_of(case), draws_of(case, penalty)
    largest = {change.inputs: change for change in one}  # the last of each input is the end of its range
    first = tuple(largest.values())
    ordered = (*floor, *first, *(change for change in one if change not in first), *pairs, *draws)
    cost = cost_of(result.numerics or Numerics())
    most = LEAST_MEMBERS if case.solver.model == "full" else max(LEAST_MEMBERS, int(BUDGET_S / cost))
    return Plan(
        changes=ordered[:most],
        left_out=ordered[most:],
        short=case.solver.model != "full" and cost <= SHORT_S,
    )


def cost_of(numerics: Numerics) -> float:
    """Processor time that a member of a modal model takes, about, from the steps and sizes of its run [s]."""
    points, unknowns = numerics.contact_nodes or 0, numerics.unknowns or 0
    fixed, by_points, by_unknowns = STEP_COST
    step = fixed + by_points * points**2 + by_unknowns * unknowns * 2 * points
    return MEMBER_COST * step * max(1, (numerics.steps or 0) + (numerics.rejected or 0))


def with_band(
    model: Model, result: RunResult, *, stop: Callable[[], bool], checkpoint: BandCheckpoint | None = None
) -> Verdict | None:
    """Compute the members of a band side by side and judge the verdict of the run by them.

    Args:
        model: of the run; the mesh and modes of its container serve every member.
        result: of the run, which is itself a member.
        stop: called in pauses; true ends the band.
        checkpoint: of the finished members, to resume from.

    Returns:
        The verdict with its band, or None if it was stopped.

    Raises:
        OSError: a checkpoint could not be written; the other members have stopped then.
    """
    plan = plan_of(model, result)
    found = {_key(one.values): one for one in (checkpoint.read_members() if checkpoint else ())}
    one_at_a_time, broken, stored = threading.Lock(), threading.Event(), time.monotonic()
    shared = Shared(
        recovery=recovery_of(model) if model.case.solver.model == "reduced" else None,
        joints=joints_of(model) if plan.short else None,
    )

    def halted() -> bool:
        return stop() or broken.is_set()

    def member_of(change: InputChange) -> BandMember:
        nonlocal stored
        key = _key(change.values)
        if key in found:
            return replace(found[key], kind=change.kind)
        if halted():
            return _without_outcome(change, "interrupted")
        try:
            member = _run_member(model, plan, change, shared, halted)
            with one_at_a_time:
                if member.status != "interrupted":
                    found[key] = member
                    if checkpoint and (not plan.short or time.monotonic() - stored > STORED_S):
                        checkpoint.write_members(list(found.values()))
                        stored = time.monotonic()
        except BaseException:
            broken.set()  # stops the other members
            raise
        return member

    workers = min(cores(), max(1, len(plan.changes)))
    if model.case.solver.model == "full":
        workers = runs_in_memory(workers, full_model_memory(len(model.container.elements.nodes)))
    with ThreadPoolExecutor(max_workers=workers) as pool:
        members = list(pool.map(member_of, plan.changes))
    if any(member.status == "interrupted" for member in members):
        if checkpoint:
            checkpoint.write_members(list(found.values()))
        return None
    verdict = result.verdict or Verdict()
    own = _member(None, model.case, model, result.status, verdict, result.joints)
    return judged(verdict, [own, *members], plan.changes, plan.left_out, width=model.container.mesh.width)


def _run_member(
    run: Model, plan: Plan, change: InputChange, shared: Shared, stop: Callable[[], bool]
) -> BandMember:
    """One member; a problem of any kind is its error, never an outcome."""
    try:
        values = {**change.values, "output.fields_s": 0.0}
        if change.kind == "draw":
            values[TOLERANCE] = max(DRAWN_TOLERANCE, run.case.solver.energy_tolerance)
        case = run.case.with_values(apart_from_floor(run.case, values))
        model = build_model(case, run.container)
        if plan.short and (change.kind != "one" or case.container.bolted_joints == 0):
            verdict, error = run_without_history(model, shared.recovery)
            status = "overturned" if verdict.outcome == Outcome.OVERTURNED else "completed"
            if error is not None:
                return _without_outcome(change, "failed", error)
            return _member(change, case, model, status, verdict, None)
        recorder = Recorder(model, shared.recovery, joints=shared.joints)
        ending = simulate(model, recorder, stop=stop)
    # bad input, no equilibrium, a singular matrix
    except (ValueError, ArithmeticError, RuntimeError) as problem:
        return _without_outcome(change, "failed", str(problem))
    if ending.status not in ("completed", "overturned"):
        return _without_outcome(change, ending.status, ending.error)
    history = recorder.history()
    verdict = verdict_of(model, history, recorder.largest_von_mises)
    joints = joint_demands(model, history) if plan.short else None
    return _member(change, case, model, ending.status, verdict, joints)


def _member(
    change: InputChange | None,
    case: Case,
    model: Model,
    status: str,
    verdict: Verdict,
    joints: Sequence[JointDemand] | None,
) -> BandMember:
    """The member of a verdict; without a change, the run itself."""
    tension, shear = largest_bolt_forces(joints) if joints else (None, None)
    return replace(
        _without_outcome(change, status),
        normal_penalty_Pa_m=None if case.floor.is_slab else model.penalty,
        damping_ratio=model.damping_ratio,
        outcome=verdict.outcome,
        **verdict.figures(Place.BAND) | {"bolt_tension_N": tension, "bolt_shear_N": shear},
        boxes=verdict.boxes,
        fell_box=verdict.fell_box,
    )


def _without_outcome(change: InputChange | None, status: str, error: str | None = None) -> BandMember:
    if change is None:
        return BandMember(status=status)
    return BandMember(
        change=change.label, kind=change.kind, values=dict(change.values), status=status, error=error
    )


def _key(values: Mapping[str, Value] | None) -> tuple[tuple[str, Value], ...]:
    """Equal for members that change the same inputs to the same values."""
    return tuple(sorted((values or {}).items()))
