"""What a finished run is held against, where that is wanted and missing: the rigid block, the band over the contact.

Both can be added to a run that was finished without them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from contact.reference.event_driven import EventError
from fem.assessment.rigid_check import check_against_rigid_block, wants_rigid_check
from fem.case.case import Case
from fem.model.model import Model
from fem.results.history import add_analytic_rotation, read_history
from fem.results.lock import FolderLock
from fem.results.run_folder import FINISHED, FolderError, RunFolder, write_atomically
from fem.run.band import band_of, wants_band
from fem.run.band_checkpoint import BandFolder
from fem.runtime.progress import Reporter


@dataclass(frozen=True, kw_only=True)
class WantedChecks:
    """Which checks are asked for."""

    check_rigid: bool = False
    band: bool | None = None  #: None: where the outcome depends on impacts


def add_checks(
    result: dict[str, Any],
    model: Model,
    place: RunFolder,
    lock: FolderLock,
    wanted: WantedChecks,
    *,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> bool:
    """Add the rigid check and the band to a finished run, where they are wanted and missing.

    Returns:
        Whether anything was added.

    Raises:
        FolderError: the history in the folder cannot be read.
    """
    case, verdict = model.case, result["verdict"]
    added = False
    if result["status"] not in FINISHED:
        return added
    if _lacks_rigid_check(result, case, wanted):
        result["rigid_check"] = _rigid_check(model, place, verdict)
        added = True
    if lacks_band(result, case, wanted) and not stop():
        reporter.message("band: the same run over contact penalty and damping")
        verdict["band"] = band_of(
            case,
            model.container,
            penalty=model.penalty,
            verdict=verdict,
            stop=stop,
            keeping=BandFolder(place, lock, case_hash=str(result["case_hash"]), reporter=reporter),
        )
        added = added or verdict["band"] is not None
    return added


def lacks_checks(result: dict[str, Any], case: Case, wanted: WantedChecks) -> bool:
    """Whether a finished run is still to have its rigid check or its band."""
    return _lacks_rigid_check(result, case, wanted) or lacks_band(result, case, wanted)


def lacks_band(result: dict[str, Any], case: Case, wanted: WantedChecks) -> bool:
    """Whether a finished run is still to have its band."""
    verdict = result["verdict"]
    return wants_band(wanted.band, case, verdict) and verdict.get("band") is None


def _lacks_rigid_check(result: dict[str, Any], case: Case, wanted: WantedChecks) -> bool:
    return wants_rigid_check(wanted.check_rigid, case) and result.get("rigid_check") is None


def _rigid_check(model: Model, place: RunFolder, verdict: dict[str, Any]) -> dict[str, Any]:
    """The comparison with the rigid block, its rotation beside the run's in a table of its own."""
    try:
        history = read_history(place.history)
    except (OSError, ValueError) as error:
        raise FolderError(
            f"{place.history}: cannot be compared with the rigid block ({error}); --force runs it again"
        ) from None
    try:
        check = check_against_rigid_block(model, history, verdict)
    except (ValueError, EventError) as error:  # a run too short, a block that bounces without end
        return {"reference": None, "meaningful": False, "reasons": [str(error)]}
    write_atomically(place.rigid_check, check.table())
    add_analytic_rotation(place.history, check.analytic_rotation)
    return check.summary
