"""The report of a run: one page from its folder, verdict first, with everything needed to check it.

`run.html.j2` is the page; this module hands it the run and the words for it.
"""

import datetime as dt
import math
from collections.abc import Callable, Sequence
from typing import Any

from contact.reference.event_driven import EventError
from fem.case.tables.unknown_inputs import WORDS
from fem.figures.cache import drawings_of
from fem.html.page import Page, Signature, html_of
from fem.model.container import modes_of_a_body
from fem.model.floor_numbers import drawn_level
from fem.model.model import Model, build_model
from fem.report.animation import (
    COLOURS,
    animation_of,
    colour_scale,
    exaggeration,
    exaggerations,
    player_data,
)
from fem.report.models import OfModel, compared_in_words
from fem.report.sketch import sketch
from fem.report.static_sheet import static_sheet
from fem.results.errors import FolderError
from fem.results.fields import Fields
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.level import SURE, Level, is_cut, level_of, numerical, sure_in_words
from fem.results.outcome import Outcome
from fem.results.reader import OpenedRun
from fem.results.run_result import RigidCheckResult, RunResult, Verdict, to_overturn
from fem.run import card, described, summary, words
from fem.run.card import card_of
from fem.run.drawn_links import drawn_links
from fem.run.rigid_check import check_against_rigid_block
from fem.runtime.user_files import read_text
from fem.solid.modes import FEW, elastic_mode_table

#: figures beside the animation, in the order of reading; the others have their own sections
MOTION = ("rotation", "slip", "base_motion", "spectrum", "uplift", "forces", "phase_portrait", "energy")
SHORT_MOTION = ("rotation", "slip")
#: modules whose words the template takes
SAID: dict[str, Any] = {
    module.__name__.rpartition(".")[2]: module for module in (card, described, summary, words)
}


def run_report(
    run: OpenedRun,
    *,
    signature: Signature | None = None,
    brief: bool = False,
    models: Sequence[OfModel] = (),
    message: Callable[[str], None] = lambda text: None,
) -> str:
    """The page, as the text of an HTML file.

    Args:
        run: opened; finished or not.
        signature: author, checker, revision; an unfinished run is not signed.
        brief: three printed pages at most: answer, inputs, static rule and run, rotation and slip, limits.
        models: what several models find of this container (`fem.report.models`).
        message: receives a sentence for the user where something is missing.

    Raises:
        FolderError: the folder does not hold what a report needs.
        CaseError, MeshError: the resolved case in it cannot be read.
    """
    if run.typed_result.static is None:
        raise FolderError(f"{run.place.result}: the run has not begun; run the case, then report it")
    model, result, case = build_model(run.case), run.typed_result, run.case
    verdict, history = result.verdict or Verdict(), _history(run, message)
    links = (*(result.stops or ()), *(result.ties or ()))
    broken = [math.inf if link.broken_at_s is None else link.broken_at_s for link in links]
    animation = animation_of(model, _fields(run, message), drawn_links(case, broken))
    played = {} if len(history.modes) < 2 or brief else player_data(animation, history, model=model)
    finished, height, static = run.status in RUN.finished, model.container.mesh.height, model.static
    card = card_of(result)
    peak = static.own_motion.sliding.demand * case.gravity_m_s2 / static.weight - static.downhill
    moves = case.motion.kind != "none" or case.has_vertical
    view = {
        "run": run,
        "case": case,
        "result": result,
        "verdict": verdict,
        "brief": brief,
        "finished": finished,
        "models": models,
        "models_compared": compared_in_words(case, models),
        "standing": _standing(result) if finished else "open",
        "sentences": (" ".join(card[:2]), " ".join(card[2:])),
        "sure": _sure(result),
        "cut": is_cut(result),
        "sketch": sketch(
            case,
            centroid=static.centroid,
            peak_acceleration=peak,
            peak_vertical=static.peak_vertical_acceleration,
        ),
        "static": static,
        "to_compare": summary.to_compare(result),
        "sheet": static_sheet(static, case),
        "drawn": drawings_of(run, model.container),
        "curves": [name for name in (SHORT_MOTION if brief else MOTION) if name != "base_motion" or moves],
        "animation": animation,
        "played": played,
        "exaggeration": exaggeration(animation, height),
        "exaggerations": exaggerations(animation, height),
        "colours": colour_scale("YlGnBu", COLOURS),
        "level": drawn_level(case.floor.slope_percent),
        "modes": [] if brief else elastic_mode_table(model.container.lowest_modes(FEW)),
        "check": None if brief else _check(model, history, result, finished=finished),
        "to_overturn": to_overturn(bool(case.neighbour)),
        "computed": f"{dt.datetime.fromtimestamp(run.place.result.stat().st_mtime):%Y-%m-%d %H:%M}",
        "resolved": read_text(run.place.resolved),
    }
    page = Page(
        kind=f"{'Short report' if brief else 'Report'} of a run",
        title=case.title or run.name,
        name=run.name,
        hash=str(result.case_hash or ""),
        signature=(signature or Signature()).completed(case.named) if finished else None,
        scripts=["player.js"] if played else [],
        data={"run": played} if played else {},
    )
    return html_of(page, "run.html.j2", view=view, modes_of_a_body=modes_of_a_body, **SAID)


def _standing(result: RunResult) -> str:
    """How the verdict is coloured: what the run found, never whether that is safe; nothing tried is not sure."""
    verdict = result.verdict or Verdict()
    if verdict.outcome == Outcome.OVERTURNED:
        return "fell"
    sure = verdict.sure is not None and level_of(result) == Level.STANDS
    return "stood" if verdict.outcome is None or sure else "unsure"


def _sure(result: RunResult) -> tuple[str, str]:
    """How sure the outcome is, and why; without a reason: nothing was tried."""
    verdict = result.verdict or Verdict()
    if (band := verdict.band) is None:
        return (verdict.sure, "by the static rule alone") if verdict.sure else ("not computed", "")
    named = ", ".join(WORDS.get(key, key) for key in verdict.decided_by)
    known = sure_in_words(result) or ("unsure" if band.unsure else "same outcome")
    if verdict.sure == SURE and all(map(numerical, band.members[1:])):
        known = "no input varied"
    return known, f"{', '.join(band.outcomes)}{f'; decided by {named}' if named else ''}"


def _check(model: Model, history: History, result: RunResult, *, finished: bool) -> RigidCheckResult | None:
    """The comparison with the analytic block: that of the run, or else made now; None of an unfinished run."""
    if result.rigid_check is not None or not finished or result.verdict is None or len(history.modes) < 2:
        return result.rigid_check
    try:
        return check_against_rigid_block(model, history, result.verdict).result
    except (ValueError, EventError) as error:
        return RigidCheckResult(reasons=(str(error),))


def _history(run: OpenedRun, message: Callable[[str], None]) -> History:
    try:
        return run.history
    except FolderError as error:
        if run.status in RUN.finished:
            raise
        message(f"{error}; the report is made without it")
        return History.empty()


def _fields(run: OpenedRun, message: Callable[[str], None]) -> Fields | None:
    try:
        return run.fields
    except FolderError as error:
        message(f"the animation shows no stresses: {error}")
        return None
