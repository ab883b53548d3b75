"""The report of a run: one page from its folder, verdict first, with everything needed to check it."""

import datetime as dt
from collections.abc import Callable
from contextlib import nullcontext
from importlib import metadata

from contact.reference.event_driven import EventError
from fem.assessment.code_note import code_note
from fem.assessment.floor_words import drawn_level
from fem.assessment.joint_tables import joints_note
from fem.assessment.loose_boxes import BOXES_NOTE, box_rows, largest_joint_slip
from fem.assessment.ranges import (
    impact_note,
    largest_rotation,
    largest_slip,
    largest_uplift,
    residual_slip,
    rotation_ratio,
)
from fem.assessment.rigid_check import check_against_rigid_block
from fem.assessment.rule_or_run import believed
from fem.assessment.summary import (
    BAND_NOTE,
    MARGIN_NOTE,
    outcome_sentence,
    result_rows,
)
from fem.case.case import Case
from fem.figures.cache import drawings_of
from fem.html.page import Signature, render_page, svg_element
from fem.html.units import ABSENT, millimetres, number, quantity, short, typeset
from fem.html.units import rotation_ratio as ratio_alone
from fem.model.model import Model, build_model
from fem.report.animation import (
    COLOURS,
    animation_of,
    colour_scale,
    exaggeration,
    exaggerations,
    player_data,
)
from fem.report.comparison import asked_rows, assumptions, compared_rows, exclusions
from fem.report.sketch import sketch
from fem.report.static_sheet import static_sheet
from fem.report.stills import stills
from fem.report.variation_table import VariationTable, variations_meanwhile
from fem.results.errors import FolderError
from fem.results.fields import Fields
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.outcome import Outcome
from fem.results.reader import OpenedRun
from fem.results.run_result import RigidCheckResult, Verdict
from fem.solid.modes import FEW, elastic_mode_table

#: figures beside the animation, in the order of reading; the others have their own sections
MOTION = ("rotation", "slip", "base_motion", "spectrum", "uplift", "forces", "phase_portrait", "energy")
SHORT_MOTION = ("rotation", "slip")


def run_report(
    run: OpenedRun,
    *,
    signature: Signature | None = None,
    every_variation: bool = False,
    brief: bool = False,
    message: Callable[[str], None] = lambda text: None,
    stop: Callable[[], bool] = lambda: False,
) -> str:
    """The page, as the text of an HTML file.

    Args:
        run: opened; finished or not.
        signature: author, checker, revision.
        every_variation: compute also those that take long.
        brief: three printed pages at most: answer, inputs, static rule and run, rotation and slip, limits.
        message: receives a sentence for the user where something takes time or is missing.
        stop: asked repeatedly; true leaves out what has not been computed.

    Raises:
        FolderError: the folder does not hold what a report needs.
        CaseError, MeshError: the resolved case in it cannot be read.
    """
    if run.typed_result.static is None:
        raise FolderError(f"{run.place.result}: the run has not begun; run the case, then report it")
    model = build_model(run.case)
    varying = (
        variations_meanwhile(
            run.case,
            run.place.variations,
            result=run.typed_result,
            every=every_variation,
            message=message,
            stop=stop,
        )
        if run.status in RUN.finished and not brief
        else nullcontext(lambda: None)
    )
    with varying as variations:
        return _page(run, model, signature or Signature(), variations, brief, message)


def _page(
    run: OpenedRun,
    model: Model,
    signature: Signature,
    variations: Callable[[], VariationTable | None],
    brief: bool,
    message: Callable[[str], None],
) -> str:
    """The page; the variations are waited for last."""
    case, result, static, mesh = run.case, run.typed_result, model.static, model.container.mesh
    verdict, history = result.verdict or Verdict(), _history(run, message)
    shown = animation_of(model, _fields(run, message))
    drawn, compared = drawings_of(run, model.container), compared_rows(static, verdict, case)
    motion = [drawn[name] for name in (SHORT_MOTION if brief else MOTION) if name in drawn]
    played = player_data(shown, history, model=model) if len(history) > 1 and not brief else {}
    computed = dt.datetime.fromtimestamp(run.place.result.stat().st_mtime)
    return render_page(
        "run.html.j2",
        scripts=["player.js", "signature.js"] if played else ["signature.js"],
        data={"run": played} if played else {},
        played=played,
        title=case.title or run.name,
        name=run.name,
        hash=str(result.case_hash or ""),
        run=run,
        case=case,
        result=result,
        verdict=verdict,
        sentence=typeset(outcome_sentence(result)),
        standing=_standing(run.status, verdict),
        signature=signature.completed(case.named),
        brief=brief,
        sketch=sketch(
            case,
            centroid=static.centroid,
            peak_acceleration=static.own_motion.sliding.demand * case.gravity_m_s2 / static.weight
            - static.downhill,
            peak_vertical=static.peak_vertical_acceleration,
        ),
        asked=asked_rows(case),
        assumptions=assumptions(case, result),
        exclusions=exclusions(case),
        compared=compared,
        ruling=compared[2:4] if case.has_vertical else compared[:2],
        sheet=static_sheet(static, case),
        head=_head(verdict),
        boxes=[[typeset(cell) for cell in row] for row in box_rows(result)],
        believed=[typeset(sentence) for sentence in believed(result)],
        found=[(name, typeset(value)) for name, value in result_rows(result)],
        warnings=[typeset(warning) for warning in result.warnings or ()],
        shown=shown,
        exaggerations=exaggerations(shown, mesh.height),
        first_exaggeration=exaggeration(shown, mesh.height),
        colours=colour_scale("YlGnBu", COLOURS),
        stills=stills(
            shown, history, verdict, angle=static.slenderness_angle, width=mesh.width, height=mesh.height
        ),
        motion=[one for one in motion if one.name != "base_motion" or _floor_moves(case)],
        drawn=drawn,
        svg_of=lambda drawing: svg_element(drawing.svg, label=drawing.title, prefix=drawing.name),
        check=rigid_check(run, model, history),
        modes=elastic_mode_table(model.container.lowest_modes(FEW)),  # also of a rigid run
        resolved=run.place.resolved.read_text(encoding="utf-8"),
        computed=computed.strftime("%Y-%m-%d %H:%M"),
        version=metadata.version("unanchored"),
        today=dt.date.today().isoformat(),
        notes={
            "code": typeset(code_note(static.to_result())),
            "margin": MARGIN_NOTE,
            "band": BAND_NOTE,
            "joints": joints_note(verdict),
            "boxes": BOXES_NOTE,
            "level": drawn_level(case.floor.slope_percent),
            "impact": impact_note(verdict),
        },
        rotation_ratio=ratio_alone,
        millimetres=millimetres,
        number=number,
        quantity=quantity,
        short=short,
        variations=variations(),
    )


def rigid_check(run: OpenedRun, model: Model, history: History) -> RigidCheckResult | None:
    """The comparison with the analytic block: that of the run, or else made now; None of an unfinished run."""
    result = run.typed_result
    if result.rigid_check is not None:
        return result.rigid_check
    if run.status not in RUN.finished or result.verdict is None or len(history) < 2:
        return None
    try:
        return check_against_rigid_block(model, history, result.verdict).result
    except (ValueError, EventError) as error:
        return RigidCheckResult(reasons=(str(error),))


def _floor_moves(case: Case) -> bool:
    return case.motion.kind != "none" or case.has_vertical


def _head(verdict: Verdict) -> dict[str, str]:
    """The first figures of the page, with their ranges."""
    slip, joint = largest_joint_slip(verdict)
    figures = {
        "rotation": largest_rotation(verdict),
        "ratio": rotation_ratio(verdict),
        "slip": largest_slip(verdict),
        "residual": residual_slip(verdict),
        "joint_slip": slip,
        "joint": joint,
        "uplift": largest_uplift(verdict),
    }
    return {name: typeset(words or ABSENT) for name, words in figures.items()}


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


def _standing(status: str, verdict: Verdict) -> str:
    """How the verdict is coloured: what the run found, never whether that is safe."""
    if status not in RUN.finished:
        return "open"
    if verdict.outcome == Outcome.OVERTURNED:
        return "fell"
    return "unsure" if verdict.band is not None and verdict.band.unsure else "stood"
