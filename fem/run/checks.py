"""Checks of a finished run, where they are wanted and missing: the rigid block, the band over what is not known.

Both can be added to a run that was finished without them.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from contact.reference.event_driven import EventError
from fem.assessment.rigid_check import check_against_rigid_block, wants_rigid_check
from fem.assessment.sureness import SURE
from fem.case.case import Case
from fem.model.model import Model
from fem.results.errors import FolderError
from fem.results.folder import ResultFolder
from fem.results.history import add_analytic_rotation, read_history
from fem.results.kinds import RUN
from fem.results.run_files import RunFiles
from fem.results.run_result import RigidCheckResult, RunResult, Verdict
from fem.run.band import rests_far_below_limits, wants_band, with_band
from fem.run.band_checkpoint import BandCheckpoint
from fem.runtime.progress import Reporter


@dataclass(frozen=True, kw_only=True)
class WantedChecks:
    """Which checks are asked for."""

    check_rigid: bool = False
    band: bool | None = None  #: None: wherever it takes no longer than it is worth


def add_checks(
    result: RunResult,
    model: Model,
    folder: ResultFolder,
    wanted: WantedChecks,
    *,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> RunResult:
    """Add the rigid check and the band to a finished run, where they are wanted and missing.

    Returns:
        The result with them; the same object where nothing was added.

    Raises:
        FolderError: the history in the folder cannot be read.
    """
    verdict = result.verdict
    if result.status not in RUN.finished or verdict is None:
        return result
    if _lacks_rigid_check(result, model.case, wanted):
        result = replace(result, rigid_check=_rigid_check(model, folder, verdict))
    if lacks_band(result, model.case, wanted) and not stop():
        reporter.message("band: repeating the run over what is not known of its inputs")
        checkpoint = BandCheckpoint(folder, case_hash=str(result.case_hash), reporter=reporter)
        judged = with_band(model, result, stop=stop, checkpoint=checkpoint)
        if judged is not None:
            result = replace(result, verdict=judged)
    elif verdict.sure is None and wanted.band is None and rests_far_below_limits(result):
        result = replace(result, verdict=replace(verdict, sure=SURE))
    return result


def lacks_checks(result: RunResult, case: Case, wanted: WantedChecks) -> bool:
    """Whether a finished run is still to have its rigid check or its band."""
    return _lacks_rigid_check(result, case, wanted) or lacks_band(result, case, wanted)


def lacks_band(result: RunResult, case: Case, wanted: WantedChecks) -> bool:
    """Whether a finished run is still to have its band."""
    verdict = result.verdict
    return verdict is not None and wants_band(wanted.band, case, result) and verdict.band is None


def _lacks_rigid_check(result: RunResult, case: Case, wanted: WantedChecks) -> bool:
    return wants_rigid_check(wanted.check_rigid, case) and result.rigid_check is None


def _rigid_check(model: Model, folder: ResultFolder, verdict: Verdict) -> RigidCheckResult:
    """The comparison with the rigid block; its rotation beside the run's goes into a table."""
    files = RunFiles(folder.path)
    try:
        history = read_history(files.history)
    except (OSError, ValueError) as error:
        raise FolderError(
            f"{files.history}: cannot be compared with the rigid block ({error}); --force repeats the run"
        ) from None
    try:
        check = check_against_rigid_block(model, history, verdict)
    except (ValueError, EventError) as error:  # a run too short, a block that bounces without end
        return RigidCheckResult(reasons=(str(error),))
    folder.write_text(files.rigid_check.name, check.table())
    add_analytic_rotation(files.history, check.analytic_rotation)
    return check.result
