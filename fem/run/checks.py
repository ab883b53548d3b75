"""Checks of a finished run, where they are wanted and missing: rigid block, band over what is not known, margin.

All can be added to a run that was finished without them.
"""

import importlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from fem.assessment.sureness import SURE
from fem.case.case import Case
from fem.model.model import Model
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.run_result import Numerics, RigidCheckResult, RunResult
from fem.run.band import rests_far_below_limits, wants_band, with_band
from fem.run.changed_runs_file import ChangedRunsFile
from fem.run.margin import margin_of, wants_margin
from fem.runtime.progress import Reporter

if TYPE_CHECKING:
    from fem.assessment.rigid_check import RigidCheck


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
    if _lacks_rigid_check(result, model.case, wanted):
        history = history_of()
        block = importlib.import_module("fem.assessment.rigid_check")
        events = importlib.import_module("contact.reference.event_driven")
        try:
            check = block.check_against_rigid_block(model, history, verdict)
            result = replace(result, rigid_check=check.result)
        except (ValueError, events.EventError) as error:  # a run too short, a block that bounces without end
            result = replace(result, rigid_check=RigidCheckResult(reasons=(str(error),)))
    if wanted.analytic and verdict.analytic is None and _has_analytic_block(model.case):
        block = importlib.import_module("fem.assessment.rigid_check")
        events = importlib.import_module("contact.reference.event_driven")
        end = (result.numerics or Numerics()).simulated_s or 0.0
        with suppress(ValueError, events.EventError):  # a block that bounces without end has no row
            verdict = replace(verdict, analytic=block.analytic_block(model, end))
            result = replace(result, verdict=verdict)
    if lacks_band(result, model.case, wanted) and not stop():
        reporter.message("band: repeating the run over what is not known of its inputs")
        judged = with_band(model, result, stop=stop, kept_in=members, inner_forces=wanted.inner_forces)
        if judged is not None:
            result = replace(result, verdict=judged)
    elif verdict.sure is None and wanted.band is None and rests_far_below_limits(model.case, result):
        result = replace(result, verdict=replace(verdict, sure=SURE))
    if lacks_margin(result, model.case, wanted) and not stop():
        reporter.message("margin: repeating the run under stronger and weaker motions")
        margin = margin_of(model, result, drawn=wanted.band is not False, stop=stop)
        if margin is not None:
            result = replace(result, verdict=replace(result.verdict or verdict, margin=margin))
    return result, check


def lacks_checks(result: RunResult, case: Case, wanted: WantedChecks) -> bool:
    """Whether a finished run is still to have its rigid check, its band or its margin."""
    return (
        _lacks_rigid_check(result, case, wanted)
        or lacks_band(result, case, wanted)
        or lacks_margin(result, case, wanted)
    )


def lacks_margin(result: RunResult, case: Case, wanted: WantedChecks) -> bool:
    """Whether a finished run is still to have its margin."""
    verdict = result.verdict
    if verdict is None or verdict.margin is not None or (wanted.band is False and not wanted.margin):
        return False
    return wants_margin(wanted.margin, case, result)


def lacks_band(result: RunResult, case: Case, wanted: WantedChecks) -> bool:
    """Whether a finished run is still to have its band."""
    verdict = result.verdict
    return verdict is not None and wants_band(wanted.band, case, result) and verdict.band is None


def _has_analytic_block(case: Case) -> bool:
    """Whether a case is a block on rigid ground whose motion formulas give: harmonic, a pulse, or a release."""
    alone = not (case.links or case.neighbour or case.container.is_loose or case.floor.is_slab)
    moves = case.motion.kind in ("harmonic", "pulse") or case.initial.rotation_rad != 0.0
    return (
        alone and moves and case.support.kind == "corners" and not case.rolls and case.motion.kind != "table"
    )


def wants_rigid_check(choice: bool, case: Case) -> bool:
    """Free rocking always has the check, other runs on request."""
    return choice or (case.motion.kind == "none" and case.initial.rotation_rad != 0.0)


def _lacks_rigid_check(result: RunResult, case: Case, wanted: WantedChecks) -> bool:
    return wants_rigid_check(wanted.check_rigid, case) and result.rigid_check is None
