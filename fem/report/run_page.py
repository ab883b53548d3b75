"""The report of a run: one page from its folder, verdict first, with everything needed to check it.

The run is not computed again. What is added is what a checker asks next: the static calculation with its
numbers, the outcome under other assumptions, the elastic modes, the rigid block beside it, the motion itself.
"""

import datetime as dt
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from contact.reference.event_driven import EventError
from fem.assessment.rigid_check import check_against_rigid_block
from fem.assessment.summary import BAND_NOTE, CODE_NOTE, MARGIN_NOTE, outcome_sentence, run_rows
from fem.assessment.summary_joints import JOINTS_NOTE
from fem.figures.cache import drawings_of
from fem.html.page import Signature, render_page
from fem.html.units import (
    millimetres,
    number,
    quantity,
    rotation_ratio,
    short,
    turned,
    typeset,
)
from fem.model.model import Model, build_model
from fem.report.animation import Film, exaggeration, exaggerations, film_of, player_data
from fem.report.comparison import EXCLUSIONS, asked_rows, assumptions, compared_rows
from fem.report.curves import curves_of
from fem.report.sketch import sketch
from fem.report.static_sheet import static_sheet
from fem.report.stills import Still, colours, stills
from fem.report.variation_table import VariationTable, variations_meanwhile
from fem.results.fields import Fields
from fem.results.history import History
from fem.results.reader import OpenedRun
from fem.results.run_folder import FINISHED, FolderError
from fem.results.run_result import Verdict
from fem.solid.modes import FEW, elastic_mode_table, elastic_modes

COLOURS = 64  #: of the stress scale in the animation
#: figures beside the animation, in the order of reading; the others stand in their own sections
MOTION = ("rotation", "slip", "base_motion", "uplift", "forces", "phase_portrait", "energy")


def run_report(
    run: OpenedRun,
    *,
    signature: Signature | None = None,
    every_variation: bool = False,
    told: Callable[[str], None] = lambda text: None,
    stop: Callable[[], bool] = lambda: False,
) -> str:
    """The page, as the text of an HTML file.

    Args:
        run: opened; finished or not.
        signature: author, checker, revision.
        every_variation: compute those too that would take long.
        told: a sentence for the user where something takes time or cannot be had.
        stop: asked now and then; true leaves out what has not been computed.

    Raises:
        FolderError: the folder does not hold what a report needs.
        CaseError, MeshError: the resolved case in it cannot be read.
    """
    if not run.result.get("static"):
        raise FolderError(f"{run.place.result}: the run has not begun; run the case, then report it")
    case, result = run.case, run.result
    model = build_model(case)
    varying = (
        variations_meanwhile(
            case,
            run.place.variations,
            result=result,
            every=every_variation,
            container=None if case.solver.model == "full" else model.container,
            told=told,
            stop=stop,
        )
        if run.status in FINISHED
        else nullcontext(lambda: None)
    )
    with varying as variations:
        return _page(run, model, signature or Signature(), variations, told)


def _page(
    run: OpenedRun,
    model: Model,
    signature: Signature,
    variations: Callable[[], VariationTable | None],
    told: Callable[[str], None],
) -> str:
    """The page; the variations are waited for last."""
    case, result = run.case, run.result
    history = _history(run, told)
    film = film_of(model, _fields(run, told))
    drawn = curves_of(drawings_of(run, model.container).values())
    check = rigid_check(run, model, history)
    modes = elastic_modes(model.container.elements, FEW)  # whether or not they take part
    played = _film_data(film, history, model) if len(history) > 1 else {}
    static, verdict = result["static"], result.get("verdict") or {}
    peak = static["own_motion"]["base_shear_N"] / (static["weight_N"] / case.gravity_m_s2)
    return render_page(
        "run.html.j2",
        scripts=["player.js", "signature.js"] if len(history) > 1 else ["signature.js"],
        data={"film": played} if played else {},
        played=played,
        title=case.title or run.name,
        name=run.name,
        hash=str(result.get("case_hash") or ""),
        run=run,
        case=case,
        result=result,
        verdict=verdict,
        static=static,
        sentence=typeset(outcome_sentence(result)),
        standing=_standing(run),
        signature=signature,
        sketch=sketch(case, centroid=static["centroid_m"], peak_acceleration=peak),
        asked=asked_rows(case, history),
        assumptions=assumptions(result, case),
        exclusions=EXCLUSIONS,
        compared=compared_rows(result, case),
        sheet=static_sheet(result, case),
        found=[(name, typeset(value)) for name, value in run_rows(result)],
        warnings=[typeset(warning) for warning in result.get("warnings") or ()],
        film=film,
        exaggerations=exaggerations(film, model.container.mesh.height),
        film_exaggeration=exaggeration(film, model.container.mesh.height),
        colours=colours(COLOURS),
        stills=_stills(film, history, model, verdict),
        motion=[
            drawn[name]
            for name in MOTION
            if name in drawn and (name != "base_motion" or case.motion.kind != "none")
        ],
        drawn=drawn,
        check=check,
        variations=variations(),
        modes=elastic_mode_table(modes),
        resolved=run.place.resolved.read_text(encoding="utf-8"),
        computed=_written(run.place.result),
        version=metadata.version("unanchored"),
        today=dt.date.today().isoformat(),
        notes={"code": CODE_NOTE, "margin": MARGIN_NOTE, "band": BAND_NOTE, "joints": JOINTS_NOTE},
        turned=turned,
        rotation_ratio=rotation_ratio,
        millimetres=millimetres,
        number=number,
        quantity=quantity,
        short=short,
    )


def rigid_check(run: OpenedRun, model: Model, history: History) -> Mapping[str, Any] | None:
    """The comparison with the analytic block: that of the run, or else made now; None where there is none.

    Without a run to its end there is nothing to compare.
    """
    if run.result.get("rigid_check"):
        found: Mapping[str, Any] = run.result["rigid_check"]
        return found
    if run.status not in FINISHED or len(history) < 2:
        return None
    try:
        return check_against_rigid_block(
            model, history, Verdict.from_json(run.result["verdict"])
        ).result.to_json()
    except (ValueError, EventError) as error:
        return {"meaningful": False, "reasons": [str(error)]}


def _film_data(film: Film, history: History, model: Model) -> dict[str, Any]:
    data = player_data(film, history, model=model)
    turned = np.abs(history["rotation_rad"])
    # The page opens at the largest rotation that is not yet a fall: that is what one looks for.
    inside = np.where(turned < data["angle"], turned, -1.0)
    first = float(history["time_s"][int(np.argmax(inside))])
    return data | {"colours": colours(COLOURS), "first": first}


def _stills(film: Film, history: History, model: Model, verdict: Mapping[str, Any]) -> list[Still]:
    mesh = model.container.mesh
    return stills(
        film, history, verdict, angle=model.static.slenderness_angle, width=mesh.width, height=mesh.height
    )


def _history(run: OpenedRun, told: Callable[[str], None]) -> History:
    try:
        return run.history
    except FolderError as error:
        if run.status in FINISHED:
            raise
        told(f"{error}; the report goes without it")
        return History.empty()


def _fields(run: OpenedRun, told: Callable[[str], None]) -> Fields | None:
    try:
        return run.fields
    except FolderError as error:
        told(f"the animation shows no stresses: {error}")
        return None


def _standing(run: OpenedRun) -> str:
    """How the verdict is coloured: what the run found, never whether that is safe."""
    if run.status not in FINISHED:
        return "open"
    verdict = run.result.get("verdict") or {}
    if verdict.get("outcome") == "overturned":
        return "fell"
    return "unsure" if (verdict.get("band") or {}).get("unsure") else "stood"


def _written(path: Path) -> str:
    """When a file was written, to the minute."""
    return dt.datetime.fromtimestamp(path.stat().st_mtime).strftime("%Y-%m-%d %H:%M")
