"""The page of a verification at a site: the answer first, then its basis, then all numbers."""

import csv
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from markupsafe import Markup

from fem.batch.study import read_study
from fem.html import sections as html
from fem.html.page import Page, Signature, html_of
from fem.html.units import ABSENT, millimetres, number, quantity, short, typeset
from fem.results.errors import FolderError
from fem.results.figures import TURNED
from fem.results.kinds import SITE
from fem.runtime.arrays import FloatArray
from fem.site_check import method_sections, site_sections
from fem.site_check.answer import FULFILLED
from fem.site_check.answer_words import beside_the_set
from fem.site_check.figures import draw_motion, draw_spectra
from fem.site_check.reasons import NOT_FULFILLED, destroyed, unit_of
from fem.site_check.reasons import span as span_in_words
from fem.site_check.result import (
    RESULT_FILE,
    ActionAnswer,
    MotionSet,
    RuleRange,
    SetCheck,
    SiteAnswer,
    SiteBody,
    SiteMotion,
    SiteResult,
)

COPIES = ("site.toml", "container.toml")  #: in the folder, printed on the page
CODE = (
    "EN 1998-1:2004, 4.4.2.4 (2), for building structures in special cases and applied here by analogy, allows the "
    "equilibrium to be verified by geometrically non-linear methods with the action of 3.2.3.1. It names no number of "
    "motions, no limit of rotation or slip and no partial factor: worst or mean follow 4.3.3.4.3 (3), by analogy, the "
    "limits are those of the user. That any overturning means not fulfilled, the limit of a single rotation, and the "
    "largest slip against the clearance are rules of this program."
)
STANDARD = "EN 1998-1:2004"
SIGNING = ("prepared", "checked", "approved")
MOST_DRAWN = 30  #: motions whose curves are on the page
NOT_COVERED = (
    "rocking under two horizontal components at once, torsion, motion out of the plane",
    "failure of the joints of a stack, sloshing of the content, buckling",
    "strength and stiffness of floor and soil",
    "neighbouring containers and walls, ropes, stops",
    "partial factors on friction: its range is computed instead",
)


def site_report(
    folder: Path,
    result: SiteResult | None = None,
    *,
    signature: Signature | None = None,
    brief: bool = False,
) -> str:
    """The page, as the text of an HTML file; there is nothing to sign before the verification is finished.

    Args:
        folder: of the verification.
        result: of it; None: as its folder holds it.
        signature: author, checker, revision.
        brief: two printed sheets: that which is signed, and what the runs found.

    Raises:
        FolderError: the folder holds no result of `assess`, or it is damaged.
    """
    result = result or read_study(folder, SITE, SiteResult)
    signing = SIGNING if result.state == "finished" else ()
    view, document = site_sections.SiteView(result=result), asdict(result.document or Signature())
    motions = [
        site_sections.DrawnMotion(
            motion, motion_figure(folder, motion, result) if motion.number <= MOST_DRAWN else None
        )
        for motion in (() if brief else result.set.motions)
    ]
    copies = [(name, _text(folder / name)) for name in COPIES if (folder / name).is_file()]
    page = Page(
        kind=f"Verification of an unanchored container{', short' if brief else ''}",
        title=result.title or folder.name,
        name=folder.name,
        hash=result.provenance.site_hash,
        signature=(signature or Signature()).completed(document) if signing else None,
        sections=[
            html.Group(
                "first site",
                [
                    answer_section(result),
                    inputs_section(result),
                    set_section(result),
                    html.section(
                        "Not covered", "not-covered", html.Paragraph(f"{'; '.join(NOT_COVERED)}.", "tight")
                    ),
                    *(
                        [html.Group("sign", [f"{who}: name, date, signature" for who in signing])]
                        if signing
                        else []
                    ),
                ],
            ),
            html.section("The rule and the code", "rule", html.Paragraph(CODE, "tight")),
            site_sections.runs_section(view, brief=brief),
            *(
                []
                if brief
                else [
                    spectra_section(result),
                    method_sections.methods_section(view),
                    method_sections.unchecked_section(view),
                    site_sections.motions_section(motions),
                    site_sections.every_run_section(view),
                    method_sections.sheet_section(view),
                    site_sections.repeat_section(view, copies),
                ]
            ),
        ],
    )
    return html_of(page)


def answer_section(result: SiteResult) -> html.PageSection:
    """The answer, the numbers that it rests on, what speaks against it, and the rule."""
    answer, reasons = result.result, result.set.reasons
    standing = {FULFILLED: "stood", NOT_FULFILLED: "fell"}.get(answer.answer or "", "open")
    first = (
        f"{answer.answer.capitalize()} under the rule below."
        if answer.reasons and answer.answer
        else answer.sentence
    )
    return html.section(
        "Answer",
        "verdict-title",
        html.Paragraph(typeset(first), "sentence"),
        *([html.Bullets([typeset(words) for words in answer.reasons], "tight")] if answer.reasons else []),
        *([html.Paragraph(actions_in_words(answer.actions))] if len(answer.actions) > 1 else []),
        *([html.Headlines(_headlines(result))] if answer.answer is not None else []),
        *([html.Paragraph(typeset(words)) for words in beside_the_set(result)]),
        html.Note(html.joined(html.strong("Rule:"), f" {answer.rule}.")),
        *([html.Paragraph(typeset(f"Reasons: {'; '.join(reasons)}."), "fail")] if reasons else []),
        look=f"answer {standing}",
    )


def actions_in_words(actions: Sequence[ActionAnswer]) -> Markup:
    """The answer for each action with its utilisation, on a line."""
    parts: list[object] = []
    for action in actions:
        used = "" if action.utilisation is None else f" (utilisation {number(action.utilisation, figures=3)})"
        parts += [
            "; " if parts else "",
            html.strong(f"{action.name}:"),
            f" {action.answer or 'no answer'}{used}",
        ]
    return html.joined(*parts, ".")


def _headlines(result: SiteResult) -> list[html.Headline]:
    answer, inputs = result.result, result.inputs
    span = answer.rule_range or RuleRange()
    tried = [point.factor for point in answer.scan]
    far = f"factors {short(tried[0])} to {short(tried[-1])} tried" if tried else "other factors not computed"
    if answer.factor_at_first_movement is not None:
        moves = f"a rigid body moves from {short(answer.factor_at_first_movement, figures=3)} on"
    else:
        moves = far
    slip, both = f"{_with_range('slip_m', answer, span)} mm", answer.two_directions
    where = f"mean {millimetres(answer.slip_mean_m)}"
    if both and both.slip_largest_m > (answer.slip_m or 0.0):  # of which the first sentence speaks
        where = f"under both horizontal components; in the plane {slip}, {where}"
        slip = f"{millimetres(both.slip_largest_m)} mm"

    def at(factor: float | None) -> str:
        if factor is None:
            return "none" if tried else ABSENT
        least = "at most " if tried and factor == tried[0] else ""
        return f"{least}{short(factor, figures=3)} × the set"

    return [
        html.Headline("overturned", f"{answer.overturned} of {answer.runs} runs{destroyed(answer.invalid)}"),
        html.Headline(
            "rotation, by the rule",
            _with_range(TURNED, answer, span),
            f"limit {short(inputs.rotation_ratio_limit)}; a single motion "
            f"{_with_range('rotation_ratio_largest', answer, span)}, limit {short(inputs.single_rotation_ratio_limit)}",
        ),
        html.Headline(
            "slip, largest",
            slip,
            f"limit {quantity(inputs.slip_limit_m, 'mm', 1000, 3)}; {where}",
        ),
        html.Headline("the rule first fails at", at(answer.margin_factor), far),
        html.Headline("first overturned at", at(answer.factor_at_first_overturning), moves),
    ]


def _with_range(key: str, answer: SiteAnswer, span: RuleRange) -> str:
    """A figure of the rule, with the range that it has over the repetitions."""
    if answer[key] is None:
        return ABSENT
    text = unit_of(key).text(answer[key], figures=2, bare=True)
    ends = span_in_words(key, span[key][0], span[key][-1]) if span[key] else ""
    return typeset(f"{text} ({ends})" if " to " in ends else text)


def inputs_section(result: SiteResult) -> html.PageSection:
    """The action beside the container, friction and limits."""

    def listed(title: str, rows: Sequence[tuple[str, str]]) -> html.Group:
        pairs = [(site_sections.symbols(name), site_sections.symbols(typeset(value))) for name, value in rows]
        return html.Group("", [html.Heading(title), html.Pairs(pairs, look="asked")])

    given = [
        listed("Action", site_rows(result)),
        listed("Container, friction, limits", container_rows(result)),
    ]
    stated = "; ".join(f"{name}: {words or 'not stated'}" for name, words in result.inputs.sources)
    sources = [html.Note(f"Sources, as stated by the user: {stated}.")] if stated else []
    return html.section("Inputs", "inputs", html.Group("columns even", given), *sources)


def set_section(result: SiteResult) -> html.PageSection:
    """The checks of the set of motions, and its mean spectrum."""
    columns: list[html.Column[SetCheck]] = [
        html.Column("check", lambda check: check.name),
        html.Column("found", found_in_words, html.NUMBER),
        html.Column("required", lambda check: check.demanded),
        html.Column(
            "fulfilled",
            lambda check: html.Cell("yes", "pass") if check.fulfilled else html.Cell("no", "fail"),
        ),
        html.Column(
            STANDARD,
            lambda check: html.Cell(
                check.clause.removeprefix(f"{STANDARD}, ") or "this program's own", "note"
            ),
        ),
    ]
    return html.section(
        f"The set of motions: {'its checks' if result.set.valid else 'not valid'}",
        "set",
        html.table_of("checks of the set of motions", columns, result.set.checks),
        *(html.Note(typeset(f"{note}.")) for note in result.set.notes),
    )


def spectra_section(result: SiteResult) -> html.PageSection:
    """The mean spectrum of the set, and those of its motions."""
    caption = "mean and every motion" if result.set.source == "floor" else "target, mean and every motion"
    drawn = site_sections.figure(draw_spectra(result.action, result.set, result.floor), "spectra", caption)
    words = html.Note(site_sections.symbols(period_sentence(result.set)))
    return html.section("Spectra of the set", "spectra-of-the-set", drawn, words)


def site_rows(result: SiteResult) -> list[tuple[str, str]]:
    """The action in numbers: name and value."""
    action, floor = result.action, result.floor
    factors = f"γ_I = {short(action.importance_factor)}, γ_a = {short(action.element_importance_factor)}"
    if action.topographic_factor != 1.0:
        factors += (
            f", S_T = {short(action.topographic_factor)} for topography (EN 1998-5:2004, Annex A; its values are not "
            "checked against its text)"
        )
    corners = ", ".join(short(period) for period in action.corner_periods_s)
    vertical = ", ".join(short(period) for period in action.vertical_corner_periods_s)
    rows = [
        ("spectrum", action.source),
        (
            "reference acceleration",
            f"a_gR = {quantity(action.reference_acceleration_m_s2, 'm/s²')}, {factors}",
        ),
        (
            "peak, horizontal",
            f"a_g S = {short(action.ag_m_s2)} × {short(action.soil_factor)} = {quantity(action.ag_S_m_s2, 'm/s²')}",
        ),
        (
            "peak, vertical",
            f"a_vg = {quantity(action.avg_m_s2, 'm/s²')} ({short(action.vertical_ratio)} a_g)",
        ),
        ("corner periods T_B, T_C, T_D", f"{corners} s; vertical {vertical} s"),
        ("displacement of the ground", f"d_g = {quantity(action.displacement_m, 'mm', 1e3, 3)}"),
    ]
    if floor is None:
        return [*rows, ("level", "on the ground: the motions of the ground")]
    if floor.z_over_h is None:
        upward = (
            f"{quantity(floor.vertical_peak_m_s2, 'm/s²')} vertically"
            if floor.vertical_peak_m_s2 is not None
            else "no vertical motion"
        )
        return [
            *rows,
            (
                "level",
                f"on a floor, given by {floor.building}: mean peak {quantity(floor.peak_m_s2, 'm/s²')}, {upward}. It "
                "is taken as it is: no building, storey, importance or element factor is applied to it. The numbers "
                "above are those of the ground",
            ),
        ]
    periods = ", ".join(short(period) for period in floor.building_periods_s)
    model = f" ({floor.building})" if floor.building else ""
    words = (
        f"floor at z/H = {short(floor.z_over_h)} of a building{model} with T_1 = {periods} s, damping "
        f"{short(100.0 * floor.damping_ratio)} %: mean peak there {quantity(floor.peak_m_s2, 'm/s²')}"
    )
    if floor.peak_m_s2 < result.set.mean_pga_m_s2:
        words += (
            f", below that of the ground, {quantity(result.set.mean_pga_m_s2, 'm/s²')}: a slow building follows little "
            "of a motion that is mostly faster, and at this height its modes act against each other"
        )
    return [*rows, ("level", words)]


def container_rows(result: SiteResult) -> list[tuple[str, str]]:
    """Container, friction and model: name and value."""
    inputs, rows = result.inputs, [("container", result.inputs.container)]
    rows += [
        (f"{body.mass}, {body.elevation} {short(body.width_m)} m", _body(body)) for body in result.bodies
    ]
    static, share = _range(inputs.mu_static), _range(inputs.mu_kinetic_over_static)
    rows += [
        ("friction", f"μ_s = {static}, μ_k/μ_s = {share}; no factor on it"),
        ("model", inputs.model),
        (
            "limits of the user",
            f"rotation ratio {short(inputs.rotation_ratio_limit)}, of a single motion "
            f"{short(inputs.single_rotation_ratio_limit)}; slip {quantity(inputs.slip_limit_m, 'mm', 1e3, 3)}",
        ),
    ]
    if inputs.wind_pressure_Pa is not None:
        pressure = (
            f"q_p = {quantity(inputs.wind_pressure_Pa, 'kN/m²', 1e-3, 3)} ({inputs.wind_pressure_source})"
        )
        rows.append(("wind", f"{pressure}, γ_μ = {short(inputs.gamma_mu)}"))
    return rows


def _body(body: SiteBody) -> str:
    return (
        f"{quantity(body.mass_kg, 't', 1e-3)}, mass centre {short(body.centroid_m)} m high, support "
        f"{short(body.support_width_m)} m wide, p = {quantity(body.frequency_parameter_1_s, '1/s')}, "
        f"e = {number(body.housner_restitution, figures=3)}, "
        f"uplift at {quantity(body.uplift_acceleration_m_s2, 'm/s²')}"
    )


def found_in_words(check: SetCheck) -> str:
    """What a check of the set found."""
    if check.found is None:
        return ABSENT
    text = short(check.found, figures=4)
    return f"{text} {typeset(check.unit)}".strip()


def period_sentence(motions: MotionSet) -> str:
    """The band of periods, and why a rocking body has no period."""
    low, high = motions.band_s[0], motions.band_s[-1]
    if motions.source == "floor":
        return (
            "The motions of the floor are taken as they are, and no spectrum is demanded of them. The target drawn "
            "beside a motion is the mean of their own spectra."
        )
    return (
        "T_1 does not exist for a rocking body: below the uplift moment it does not rotate, then its period grows with "
        f"its rotation. The mean spectrum is compared from {short(low)} s to {short(high)} s, which holds 0.2 T_1 to "
        f"2 T_1 for every T_1 from {short(low / 0.2)} s to {short(high / 2.0)} s."
    )


def motion_figure(folder: Path, motion: SiteMotion, result: SiteResult) -> str:
    """The figure of a motion, from its files."""
    curves = {name[-5:]: _curve(folder / name) for name in motion.files if name.endswith(".csv")}
    if "h.csv" not in curves:
        raise FolderError(f"{folder / RESULT_FILE}: motion {motion.number} has no curve; compute it again")
    times, horizontal = curves["h.csv"]
    vertical = curves["v.csv"][1] if "v.csv" in curves else None
    return draw_motion(motion, result.action, times, horizontal, vertical)


def _curve(path: Path) -> tuple[FloatArray, FloatArray]:
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))[1:]
        values = np.array(rows, dtype=np.float64)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error}); compute it again") from None
    return values[:, 0], values[:, 1]


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error})") from None


def _range(values: Sequence[float]) -> str:
    return " to ".join(short(value) for value in dict.fromkeys((min(values), max(values))))
