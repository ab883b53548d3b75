"""The report of a run: one page from its folder, verdict first, with everything needed to check it."""

import datetime as dt
import math
from collections.abc import Callable, Iterator

from markupsafe import Markup

from fem.assessment.code_note import code_note
from fem.assessment.drawn_links import drawn_links
from fem.assessment.floor_words import floor_rows
from fem.assessment.loose_boxes import largest_joint_slip
from fem.assessment.ranges import largest_ratio, largest_rotation, largest_slip, of_band
from fem.assessment.rule_or_run import governing
from fem.assessment.summary import MARGIN_NOTE, lacks_margin, outcome_sentence, result_rows
from fem.assessment.sureness import SURE, numerical
from fem.case.case import Case
from fem.case.tables.unknown_inputs import WORDS
from fem.figures.cache import drawings_of
from fem.html import sections as html
from fem.html.page import Page, Signature, html_of
from fem.html.units import ABSENT, number, quantity, short, typeset
from fem.model.model import build_model
from fem.report.animation import animation_of
from fem.report.comparison import case_rows, compared_table, limits_section
from fem.report.run_motion import motion_section
from fem.report.run_sections import (
    block_section,
    boxes_section,
    joints_section,
    modes_section,
    sheet_section,
    sureness_section,
)
from fem.report.run_view import RunView
from fem.report.sketch import sketch
from fem.results.errors import FolderError
from fem.results.fields import Fields
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.outcome import Outcome
from fem.results.reader import OpenedRun
from fem.results.run_result import Energy, Numerics, RunResult, Verdict, to_overturn

READ_AS = (
    " utilisation is demand over capacity; above 1 the rule says that it slides or overturns. Rotation ratio is the "
    "largest |rotation| over the slenderness angle α; left alone at 1, the container falls. Slip > 0 to the right, "
    "rotation > 0 clockwise; forces act on the container, and are means over milliseconds in impacts."
)
#: terms of the energy balance: fields of the result, and words
ENERGIES = {
    "reference_J": "to overturn",
    "base_work_J": "work of the floor",
    "friction_J": "friction",
    "contact_damping_J": "contact damping",
    "material_damping_J": "material damping",
    "crushing_J": "crushing of the floor",
    "impact_J": "restitution asked of the impacts",
    "numerical_J": "error at the end, > 0 lost",
}


def run_report(
    run: OpenedRun,
    *,
    signature: Signature | None = None,
    brief: bool = False,
    message: Callable[[str], None] = lambda text: None,
) -> str:
    """The page, as the text of an HTML file.

    Args:
        run: opened; finished or not.
        signature: author, checker, revision; an unfinished run is not signed.
        brief: three printed pages at most: answer, inputs, static rule and run, rotation and slip, limits.
        message: receives a sentence for the user where something is missing.

    Raises:
        FolderError: the folder does not hold what a report needs.
        CaseError, MeshError: the resolved case in it cannot be read.
    """
    if run.typed_result.static is None:
        raise FolderError(f"{run.place.result}: the run has not begun; run the case, then report it")
    model = build_model(run.case)
    view = RunView(
        run=run,
        model=model,
        history=_history(run, message),
        animation=animation_of(
            model, _fields(run, message), drawn_links(run.case, _broken(run.typed_result))
        ),
        drawn=drawings_of(run, model.container),
        brief=brief,
    )
    return html_of(_page(view, signature))


def _broken(result: RunResult) -> list[float]:
    """When stops and ties broke, in the order of the case; empty where none was computed [s]."""
    links = (*(result.stops or ()), *(result.ties or ()))
    return [math.inf if link.broken_at_s is None else link.broken_at_s for link in links]


def _page(view: RunView, signature: Signature | None) -> Page:
    """The sections in the order of reading."""
    further = [] if view.brief else [modes_section, block_section, joints_section, sheet_section]
    behind = [part(view) for part in (motion_section, boxes_section)]
    proof = [part(view) for part in (*further, numerics_section, provenance_section)]
    finished = view.run.status in RUN.finished
    first = [
        verdict_section(view),
        case_section(view),
        limits_section(view.case, view.result, joints_below=bool(view.result.joints) and not view.brief),
    ]
    return Page(
        kind=f"{'Short report' if view.brief else 'Report'} of a run",
        title=view.case.title or view.run.name,
        name=view.run.name,
        introduction=_changes(view),
        hash=str(view.result.case_hash or ""),
        signature=(signature or Signature()).completed(view.case.named) if finished else None,
        sections=[
            html.Group("first", first),
            static_section(view),
            *behind,
            sureness_section(view),
            *proof,
        ],
        scripts=["player.js"] if view.played else [],
        data={"run": view.played} if view.played else {},
    )


def _changes(view: RunView) -> list[html.Block]:
    """What the command line changed in the case file, whose title may say otherwise."""
    if not view.result.overrides:
        return []
    keys = Markup(", ").join(map(html.code, view.result.overrides))
    return [html.Paragraph(html.joined("Changed on the command line: ", keys), "changed")]


def verdict_section(view: RunView) -> html.PageSection:
    """The answer: one sentence, the first figures, and where to read on."""
    verdict = view.verdict
    first, _, further = outcome_sentence(view.result).partition(". ")
    return html.section(
        "Verdict",
        "verdict-title",
        html.Paragraph(typeset(f"{first}." if further else first), "sentence"),
        *([html.Paragraph(typeset(further))] if further else []),
        *([html.Headlines(list(_headlines(view)))] if verdict.outcome else []),
        html.Note(html.joined(*_reading(view))),
        look=f"answer {_standing(view.run.status, verdict)}",
    )


def _headlines(view: RunView) -> Iterator[html.Headline]:
    """The first figures of the page, with their ranges."""
    verdict, loose = view.verdict, bool(view.boxes)
    yield html.Headline(
        "largest rotation",
        _words(largest_rotation(verdict)),
        f"{_words(largest_ratio(verdict))} of the slenderness angle",
    )
    yield html.Headline(
        f"largest slip{' on the floor' if loose else ''}",
        _words(largest_slip(verdict)),
        f"at the end: {_words(of_band(verdict, 'residual_slip_m'))}",
    )
    if loose:
        slip, joint = largest_joint_slip(verdict)
        where = html.joined(_words(joint), "; see ", html.link("the boxes", "boxes"))
        yield html.Headline("largest slip between boxes", _words(slip), where)
    impacts = f"{verdict.impacts} impact{'' if verdict.impacts == 1 else 's'}"
    yield html.Headline("largest uplift", _words(of_band(verdict, "max_uplift_m")), impacts)
    sliding, overturning = view.compared[2:4] if view.case.has_vertical else view.compared[:2]
    yield html.Headline(
        "static rule, same motion",
        f"{overturning.rule}, {sliding.rule}",
        f"utilisations {overturning.utilisation} and {sliding.utilisation}",
    )
    yield html.Headline("how sure", *_sure(verdict))


def _words(text: str | None) -> str:
    return typeset(text or ABSENT)


def _sure(verdict: Verdict) -> tuple[str, str]:
    """How sure the outcome is, and why."""
    if (band := verdict.band) is not None:
        named = ", ".join(WORDS.get(key, key) for key in verdict.decided_by)
        decided = f"; decided by {named}" if named else ""
        known = verdict.sure or ("unsure" if band.unsure else "same outcome")
        if verdict.sure == SURE and all(map(numerical, band.members[1:])):
            known = "no input varied"
        return known, f"{', '.join(band.outcomes)}{decided}"
    if verdict.sure:
        return verdict.sure, "by the static rule alone"
    return "not computed", html.joined(html.code("run --band"), " computes it")


def _reading(view: RunView) -> Iterator[str]:
    """How the answer is to be read, and where there is more."""
    under = (
        "What happened under this motion" if view.run.status in RUN.finished else "What has happened so far"
    )
    yield (
        f"{under}; a margin is that of the same motion made stronger or weaker. This is a "
        "study, not a verification, and says nothing about motions of another form. "
    )
    if lacks_margin(view.result):
        yield f"{MARGIN_NOTE} "
    if warnings := len(view.result.warnings or ()):
        yield f"{warnings} warning{'' if warnings == 1 else 's'}: see "
        yield html.link("numerics", "numerics")
        yield "."


def case_section(view: RunView) -> html.PageSection:
    """The container in elevation, and the case in words."""
    static = view.model.static
    drawn = sketch(
        view.case,
        centroid=static.centroid,
        peak_acceleration=static.own_motion.sliding.demand * view.case.gravity_m_s2 / static.weight
        - static.downhill,
        peak_vertical=static.peak_vertical_acceleration,
    )
    floor = [(name, typeset(value)) for name, value in floor_rows(view.result.floor)]
    inputs = html.Pairs([*case_rows(view.case), *floor], look="asked")
    return html.section("The case", "asked", html.columns(html.Figure(drawn), inputs))


def static_section(view: RunView) -> html.PageSection:
    """The static rule beside the run, which of them governs, and all that the run found."""
    code = typeset(code_note(view.model.static.to_result()))
    own = "Only the rule under the peak floor acceleration of this run is compared with the run."
    note: list[str] = [f"{code} {own}" if code else own]
    if not view.brief:
        note += [" See ", html.link("the static calculation", "sheet"), " for the numbers."]
    of_floor = dict(floor_rows(view.result.floor))
    figures = [(name, typeset(value)) for name, value in result_rows(view.result) if name not in of_floor]
    of_itself = ", of the container itself" if view.case.neighbour else ""
    return html.section(
        "Static rule and run",
        "static",
        compared_table(view.compared, loose=bool(view.boxes)),
        *(typeset(sentence) for sentence in governing(view.result)),
        html.Note(html.joined(*note)),
        html.Note(html.joined(html.strong("Read as:"), READ_AS)),
        html.Pairs(figures, caption="What the run found" + of_itself, look="found"),
    )


def numerics_section(view: RunView) -> html.PageSection:
    """Warnings; steps and energies."""
    warnings = [typeset(warning) for warning in view.result.warnings or ()]
    listed: html.Block = html.Bullets(warnings, "") if warnings else "No warnings."
    if view.brief or view.result.numerics is None:
        title = "Warnings" if view.brief else "Numerics and warnings"
        return html.section(title, "numerics", listed)
    steps = html.Pairs(_stepping(view.case, view.result.numerics), caption="Stepping")
    energies = html.Pairs(_energies(view), caption="Energy balance")
    return html.section("Numerics and warnings", "numerics", listed, html.columns(steps, energies))


def _stepping(case: Case, numerics: Numerics) -> list[tuple[str, str]]:
    """How the run was stepped: name and value."""
    solver, least = case.solver, numerics.smallest_step_s
    tiny = least is not None and 0.0 < least < 1e-7
    smallest = quantity(least, "ns", 1e9, 3) if tiny else quantity(least, "µs", 1e6, 3)
    scheme = f"spectral radius {short(solver.spectral_radius)}"
    if solver.scheme == "newmark":
        scheme = f"β {short(solver.newmark_beta)}, γ {short(solver.newmark_gamma)}"
    penalty, penetrations = (
        numerics.normal_penalty_Pa_m,
        (numerics.static_penetration_m, numerics.max_penetration_m),
    )
    return [
        ("unknowns, contact nodes", f"{numerics.unknowns}, {numerics.contact_nodes}"),
        ("scheme", f"{solver.scheme}, {scheme}"),
        ("steps, rejected", f"{numerics.steps}, {numerics.rejected}"),
        ("step, smallest to largest", f"{smallest} to {quantity(numerics.largest_step_s, 'ms', 1000, 3)}"),
        ("element size, order", f"{quantity(solver.element_size_m, 'mm', 1000, 3)}, {solver.order}"),
        *([("contact penalty", quantity(penalty, "GPa/m", 1e-9))] if penalty is not None else []),
        (
            "penetration, static and largest",
            ", ".join(quantity(penetration, "µm", 1e6, 3) for penetration in penetrations),
        ),
    ]


def _energies(view: RunView) -> list[tuple[str, str]]:
    """The energy balance at the end: name and value."""
    energy = view.result.energy or Energy()
    row = bool(view.case.neighbour)
    error = f"{number(energy.closure_error, figures=3)} of the energy {to_overturn(row)}"
    absent = {
        "crushing_J": not view.case.floor.is_slab,
        "impact_J": not view.case.states_restitution,
    }
    rows = [
        (to_overturn(row) if key == "reference_J" else words, quantity(getattr(energy, key), "J"))
        for key, words in ENERGIES.items()
        if not absent.get(key, False)
    ]
    return [*rows, ("largest error", error)]


def provenance_section(view: RunView) -> html.PageSection:
    """From what the run was computed, and how to compute it again."""
    run, result = view.run, view.result
    computed = f"{dt.datetime.fromtimestamp(run.place.result.stat().st_mtime):%Y-%m-%d %H:%M}"
    if result.wall_s:
        computed += f", in {quantity(result.wall_s, 's', figures=3)}"
    if result.wall_s and result.compile_s:
        compiled = quantity(result.compile_s, "s", figures=3)
        computed += f", of which {compiled} compilation, once after installation"
    saved = "resolved.toml of the run" if view.brief else "the case below"
    again = html.joined(
        f"save {saved} as ", html.code("case.toml"), ", then ", html.code("python -m fem run case.toml")
    )
    rows = [
        ("case", f"{run.name}, status {run.status}"),
        ("computed", computed),
        ("case hash", html.joined(html.code(result.case_hash), " (SHA-256 of the resolved case)")),
        ("versions", ", ".join(f"{name} {version}" for name, version in (result.versions or {}).items())),
        ("again", again),
    ]
    if view.brief:
        return html.section("Provenance", "provenance", html.Pairs(rows))
    return html.section(
        "Provenance",
        "provenance",
        html.Pairs(rows),
        html.Heading("Resolved case: every default written out"),
        html.Listing(run.place.resolved.read_text(encoding="utf-8")),
    )


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
    unsure = verdict.outcome == Outcome.INVALID or (verdict.band is not None and verdict.band.unsure)
    return "unsure" if unsure else "stood"
