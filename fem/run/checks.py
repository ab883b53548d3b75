"""Checks of a finished run, where they are wanted and missing: rigid block, band over what is not known, margin.

All can be added to a run that was finished without them.
"""

import importlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from fem.case.case import Case
from fem.case.uncertainty import InputChange, all_changes, largest_first, stiff_floor
from fem.model.model import Model
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.outcome import Outcome
from fem.results.run_result import Numerics, RigidCheckResult, RunResult, StaticResult, Verdict
from fem.run.changed_runs import ChangedRunsFile, changed_run, cost_of, run_changes
from fem.run.margin import margin_of, wants_margin
from fem.run.sureness import SURE, judged, static_use
from fem.runtime.progress import Reporter

if TYPE_CHECKING:
    from fem.run.rigid_check import RigidCheck


@dataclass(frozen=True, kw_only=True)
class WantedChecks:
    """Which checks are asked for."""

    check_rigid: bool = False
    band: bool | None = None  #: None: wherever it takes no longer than it is worth
    margin: bool | None = None  #: None: wherever it takes seconds, and a band is not refused
    analytic: bool = (
        False  #: whether the analytic block under the same motion is followed, where there is one
    )
    inner_forces: bool = True  #: whether members of a band find stresses and the forces in joints of a stack


def add_checks(
    result: RunResult,
    model: Model,
    history_of: Callable[[], History],
    wanted: WantedChecks,
    members: ChangedRunsFile | None,
    *,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> tuple[RunResult, "RigidCheck | None"]:
    """Add the rigid check, the band and the margin to a finished run, where they are wanted and missing.

    Args:
        result, model: of the run; history_of: gives its samples.
        wanted: what is asked for.
        members: the file of the finished members of a band.
        reporter: of band and margin.
        stop: called in pauses; true ends them.

    Returns:
        The result with them, the same object where nothing was added; and the comparison with the rigid block, where
        it was made now.
    """
    verdict, check = result.verdict, None
    if result.status not in RUN.finished or verdict is None:
        return result, None
    case, missing = model.case, lacking(result, model.case, wanted)
    analytic = wanted.analytic and verdict.analytic is None and has_analytic_block(case)
    if "rigid check" in missing or analytic:  # with scipy.integrate
        block = importlib.import_module("fem.run.rigid_check")
        events = importlib.import_module("contact.reference.event_driven")
    if "rigid check" in missing:
        history = history_of()
        try:
            check = block.check_against_rigid_block(model, history, verdict)
            result = replace(result, rigid_check=check.result)
        except (ValueError, events.EventError) as error:  # a run too short, a block that bounces without end
            result = replace(result, rigid_check=RigidCheckResult(reasons=(str(error),)))
    if analytic:
        end = (result.numerics or Numerics()).simulated_s or 0.0
        with suppress(ValueError, events.EventError):  # a block that bounces without end has no row
            verdict = replace(verdict, analytic=block.analytic_block(model, end))
            result = replace(result, verdict=verdict)
    if "band" in missing and not stop():
        judged = with_band(
            model, result, stop=stop, reporter=reporter, kept_in=members, inner_forces=wanted.inner_forces
        )
        if judged is not None:
            result = replace(result, verdict=judged)
    elif verdict.sure is None and wanted.band is None and rests_far_below_limits(case, result):
        result = replace(result, verdict=replace(verdict, sure=SURE))
    if "margin" in missing and not stop():
        reporter.message("margin: repeating the run under stronger and weaker motions")
        margin = margin_of(model, result, drawn=wanted.band is not False, stop=stop)
        if margin is not None:
            result = replace(result, verdict=replace(result.verdict or verdict, margin=margin))
    return result, check


def lacking(result: RunResult, case: Case, wanted: WantedChecks) -> set[str]:
    """What a finished run is still to have, of `rigid check`, `band` and `margin`."""
    verdict = result.verdict
    if verdict is None:
        return set()
    margin = (wanted.band is not False or bool(wanted.margin)) and wants_margin(wanted.margin, case, result)
    missing = {
        "rigid check": result.rigid_check is None and wants_rigid_check(wanted.check_rigid, case),
        "band": verdict.band is None and wants_band(wanted.band, case, result),
        "margin": verdict.margin is None and margin,
    }
    return {check for check, is_missing in missing.items() if is_missing}


def has_analytic_block(case: Case) -> bool:
    """Whether a case is a block on rigid ground whose motion formulas give: harmonic, a pulse, or a release."""
    alone = not (case.links or case.neighbour or case.container.is_loose or case.floor.is_slab)
    moves = case.motion.kind in ("harmonic", "pulse") or case.initial.rotation_rad != 0.0
    return (
        alone and moves and case.support.kind == "corners" and not case.rolls and case.motion.kind != "table"
    )


def wants_rigid_check(choice: bool, case: Case) -> bool:
    """Free rocking always has the check, other runs on request."""
    return choice or (case.motion.kind == "none" and case.initial.rotation_rad != 0.0)


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
    reporter: Reporter | None = None,
    kept_in: ChangedRunsFile | None = None,
    inner_forces: bool = True,
) -> Verdict | None:
    """Compute the members of a band side by side and judge the verdict of the run by them.

    Args:
        model: of the run; the mesh and modes of its container serve every member.
        result: of the run, which is itself a member.
        stop: called in pauses; true ends the band.
        reporter: is told how many there are.
        kept_in: the file of its finished members, to resume from.
        inner_forces: whether the members find stresses and the forces in joints of a stack.

    Returns:
        The verdict with its band, or None if it was stopped.

    Raises:
        OSError: the file could not be written; the other members have stopped then.
    """
    plan, numerics = plan_of(model, result), result.numerics or Numerics()
    if reporter is not None:
        reporter.message(f"band: {len(plan.changes)} runs with the unknown inputs varied")
    members = run_changes(
        model, plan.changes, numerics=numerics, stop=stop, kept_in=kept_in, inner_forces=inner_forces
    )
    if any(member.status == "interrupted" for member in members):
        return None
    verdict = result.verdict or Verdict()
    own = changed_run(None, model, result.status, verdict, result.joints)
    return judged(verdict, [own, *members], plan.changes, plan.left_out, width=model.container.mesh.width)
