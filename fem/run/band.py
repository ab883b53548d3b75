"""The band of a run: what it does when the unknown inputs change.

`fem.case.uncertainty` says which inputs these are, in which ranges, and makes the changed cases;
`fem.run.changed_runs` runs them, and `fem.assessment.sureness` says what they show. What does not fit the budget is
left out: first the draws, then the changes of which another of the same input is tried.
"""

from collections.abc import Callable
from dataclasses import dataclass

from fem.assessment.sureness import judged, static_use
from fem.case.case import Case
from fem.case.uncertainty import InputChange, all_changes, largest_first, stiff_floor
from fem.model.model import Model
from fem.results.outcome import Outcome
from fem.results.run_result import Numerics, RunResult, StaticResult, Verdict
from fem.run.changed_runs import changed_run, cost_of, run_changes
from fem.run.changed_runs_file import ChangedRunsFile

#: share of a static limit from which a container at rest may be brought to move by what is not known
NEAR_LIMIT = 0.7
MOST_LIFTING = 0.3  #: vertical acceleration over g up to which that holds
#: shares of the uplift acceleration between which a soft bed may rock a container that a rigid floor would not
BELOW_UPLIFT = (0.85, 1.0)
#: processor time for the members, by the estimate of `cost_of` [s]; members that are computed in any case
BUDGET_S, LEAST_MEMBERS = 30.0, 6


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Which members a band has."""

    changes: tuple[InputChange, ...]
    left_out: tuple[InputChange, ...]  #: for which there is no time


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
    stated = any(isinstance(span, list) for _, span in case.uncertainty)
    used, lifting = static_use(result), (result.static or StaticResult()).ruling.utilisation_lifting or 0.0
    if (
        case.container.is_loose
        or case.neighbour
        or case.initial.is_pushed
        or stated
        or lifting > MOST_LIFTING
        or used is None
    ):
        return False
    return (result.verdict or Verdict()).outcome == Outcome.REST and used < NEAR_LIMIT


def plan_of(model: Model, result: RunResult) -> Plan:
    """The members of a band, those that decide most often first."""
    case, penalty = model.case, model.penalty
    own = (result.static or StaticResult()).ruling
    low, high = BELOW_UPLIFT
    bears = case.support.kind != "corners"
    soft = bears and low <= (own.utilisation_overturning or 0.0) <= high
    floor = (stiff_floor(case, penalty),) if soft else ()
    singles, pairs, draws = all_changes(case, penalty)
    ordered = (*floor, *largest_first(singles), *pairs, *draws)
    cost = cost_of(result.numerics or Numerics())
    most = LEAST_MEMBERS if case.solver.model == "full" else max(LEAST_MEMBERS, int(BUDGET_S / cost))
    return Plan(changes=ordered[:most], left_out=ordered[most:])


def with_band(
    model: Model,
    result: RunResult,
    *,
    stop: Callable[[], bool],
    kept_in: ChangedRunsFile | None = None,
    inner_forces: bool = True,
) -> Verdict | None:
    """Compute the members of a band side by side and judge the verdict of the run by them.

    Args:
        model: of the run; the mesh and modes of its container serve every member.
        result: of the run, which is itself a member.
        stop: called in pauses; true ends the band.
        kept_in: the file of its finished members, to resume from.
        inner_forces: whether the members find stresses and the forces in joints of a stack.

    Returns:
        The verdict with its band, or None if it was stopped.

    Raises:
        OSError: the file could not be written; the other members have stopped then.
    """
    plan, numerics = plan_of(model, result), result.numerics or Numerics()
    members = run_changes(
        model, plan.changes, numerics=numerics, stop=stop, kept_in=kept_in, inner_forces=inner_forces
    )
    if any(member.status == "interrupted" for member in members):
        return None
    verdict = result.verdict or Verdict()
    own = changed_run(None, model, result.status, verdict, result.joints)
    return judged(verdict, [own, *members], plan.changes, plan.left_out, width=model.container.mesh.width)
