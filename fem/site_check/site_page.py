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
from fem.html.units import ABSENT, millimetres, number, quantity, ratio, short, typeset
from fem.results.errors import FolderError
from fem.results.figures import FIGURES, TURNED, RunFigures
from fem.results.kinds import SITE
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray
from fem.seismic.hazard import ACCELERATION
from fem.site_check import site_sections
from fem.site_check.answer import FULFILLED
from fem.site_check.figures import draw_motion, draw_spectra
from fem.site_check.reasons import NOT_FULFILLED, both_ways, destroyed, unit_of
from fem.site_check.reasons import span as span_in_words
from fem.site_check.result import (
    RESULT_FILE,
    ActionAnswer,
    AnnualRates,
    ConfirmedRun,
    MotionSet,
    RuleRange,
    SetCheck,
    SiteAnswer,
    SiteBody,
    SiteMotion,
    SiteResult,
    TwoDirections,
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
                    site_sections.methods_section(view),
                    site_sections.unchecked_section(view),
                    site_sections.motions_section(motions),
                    site_sections.every_run_section(view),
                    site_sections.sheet_section(view),
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


def beside_the_set(result: SiteResult) -> list[str]:
    """What the further motions and the repeated deciding runs showed, and what was not computed, each in a sentence."""
    answer, words = result.result, []
    if answer.still:
        count = f"{answer.still} of {answer.runs} runs stay"
        if answer.still == answer.runs:
            moved = answer.factor_at_first_movement
            count = f"Nothing moves up to {short(moved, figures=3)} × the set: all {answer.runs} runs stay"
        words.append(f"{count} below uplift and slip of a rigid body and were not computed.")
    if answer.two_directions:
        words.append(two_directions_in_words(answer.two_directions))
    if known := [group for group in answer.further if group.motions]:
        worst = max(known, key=lambda group: (group.overturned + group.invalid, group.beyond_limits))
        furthest = max(known, key=lambda group: group.beyond_limits)
        slips = [group.slip_largest_m for group in known if group.slip_largest_m is not None]
        slid = f" (the largest in both directions is {millimetres(max(slips))} mm)" if slips else ""
        low, high = (short(end, 100, 2) for end in worst.interval)
        location = "floor" if result.floor and result.floor.z_over_h is None else "site"
        of_both = " of both" if worst.invalid else ""
        pairs, most = "", ""
        if len(known) > 1:
            pairs, most = f" for each of {len(known)} combinations of weight and friction", "at most "
        overturned, beyond = (
            f"{most}{count}" if count else "none" for count in (worst.overturned, furthest.beyond_limits)
        )
        words.append(
            f"Of {worst.motions} further motions{pairs} {overturned} overturned it{destroyed(worst.invalid)} "
            f"(95 % interval{of_both} {low} to {high} %) and {beyond} went beyond a limit of a single "
            f"motion{both_ways(furthest)}{slid}. All these motions have the spectrum of the {location}; recorded ones "
            "scatter more."
        )
    if repeated := confirmation(result):
        words.append(repeated)
    if repeated and (bolts := bolts_in_words(answer.confirmed)):
        words[-1] += f" {bolts}"
    if failed := {point.factor: point.failed for point in answer.scan if point.failed}:
        words.append(
            f"{sum(failed.values())} runs failed at the factors {', '.join(map(short, failed))} on the set: the margin "
            "does not know how they end."
        )
    if answer.failed_between:
        words.append(
            f"{answer.failed_between} runs failed at factors between those of the scan: the margin does not know how "
            "they end."
        )
    if answer.hazard:
        words += rates_in_words(answer.hazard, result.inputs.slip_limit_m)
    return words


def rates_in_words(rates: AnnualRates, slip_limit: float) -> list[str]:
    """How often a year it overturns and slides too far, and what that rests on."""
    unit = "m/s²" if rates.measure == ACCELERATION else "m/s"
    low, high = rates.interval
    most = ""
    if rates.most_from is not None:
        begin = short(rates.most_from, figures=3)
        strengths = (
            f"beyond {begin}"
            if rates.most_to is None
            else f"from {begin} to {short(rates.most_to, figures=3)}"
        )
        most = f"; {short(rates.share, 100, 2)} % of it arises {strengths} {unit}"
    fitted = "no lognormal curve fits the counts"
    if rates.fit_per_year is not None:
        fitted = (
            f"a lognormal curve through them (median {short(rates.median, figures=3)} {unit}, with the scatter beta "
            f"{short(rates.beta, figures=2)}) gives {rates.fit_per_year:.2g} per year, the closed form "
            f"{rates.closed_form_per_year:.2g}"
        )
    slip = "of that the rate is not known on a sloping floor."
    if rates.slip_per_year is not None:
        slow, shigh = rates.slip_interval
        slip = f"{rates.slip_per_year:.2g} per year ({slow:.2g} to {shigh:.2g})."
    failed = sum(level.failed for level in rates.levels)
    return [
        f"Rate of overturning by counts: {rates.overturning_per_year:.2g} per year ({low:.2g} to {high:.2g} with the "
        f"95 % intervals of all counts and the tails as bounds), {100.0 * rates.in_50_years:.2g} % in 50 years"
        f"{most}. Slip beyond {quantity(slip_limit, 'mm', 1000, 3)}: {slip}",
        f"The counts ({rates.mass}, friction {rates.mu_static:.3g}/{rates.mu_kinetic:.3g}) are in a table behind this "
        f"sheet; {fitted}. Artificial motions scatter less than records; the hazard is spread by {rates.scatter:g} of "
        "the logarithm for it. Targets are the user's: none is compared.",
        *([f"{failed} of these runs failed; they count into the upper ends alone."] if failed else []),
    ]


def two_directions_in_words(slip: TwoDirections) -> str:
    """How far it slides under both horizontal components, and how much further than in the plane of the runs."""
    largest, mean = millimetres(slip.slip_largest_m), millimetres(slip.slip_mean_m)
    again = ""
    if slip.slip_range_m:
        again = f"; in the repetitions {' to '.join(dict.fromkeys(map(millimetres, slip.slip_range_m)))} mm"
    return (
        f"Under both horizontal components at once, sliding without rocking: largest slip {largest} mm, mean {mean} "
        f"mm, in the plane {millimetres(slip.slip_mean_in_plane_m)} mm{again}. It is held against the clearance, too, "
        "also under the further motions. Rocking, and the slip of a container that rocks or bends, are computed in the "
        "plane only."
    )


def confirmation(result: SiteResult) -> str:
    """The result of the deciding runs when they are repeated; empty where they were not."""
    again = result.result.confirmed
    if not again:
        return ""
    words = f"The {len(again)} deciding runs, repeated with the elastic model"
    inputs = "their unknown inputs"
    if len(again) == 1:
        words, inputs = "The deciding run, repeated with the elastic model", "its unknown inputs"
    failed = sum(repeated.outcome is None for repeated in again)
    invalid = sum(Outcome.INVALID in (repeated.outcome, *repeated.outcomes) for repeated in again)
    fell = sum(Outcome.OVERTURNED in (repeated.outcome, *repeated.outcomes) for repeated in again)
    if failed or fell or invalid:
        corner = f", {invalid} can destroy a corner" if invalid else ""
        return f"{words} over {inputs}: {fell} can overturn{corner}, {failed} failed."

    def largest(runs: Sequence[RunFigures]) -> str:
        turned, slipped = max(run.turned for run in runs), max(run.slipped for run in runs)
        return f"largest rotation ratio {ratio(turned)}, largest slip {millimetres(slipped)} mm"

    turned = max((end for run in again for end in run.rotation_ratio_range), default=None)
    slipped = max((end for run in again for end in run.max_slip_m_range), default=None)
    over = (
        f"; over {inputs} none overturns, either, with up to {ratio(turned)} and {millimetres(slipped)} mm"
        if turned is not None and slipped is not None
        else ""
    )
    return (
        f"{words}: none overturns, {largest(again)}{over}; in the set {largest([run.run for run in again])}. The "
        "answer rests on the set: a single rotation is chaotic with either model, and a repetition counts where it "
        "overturns, destroys a corner, fails or, with the inputs as given, goes beyond a limit of a single motion."
    )


def bolts_in_words(confirmed: Sequence[ConfirmedRun]) -> str:
    """What the bolts of a stack carry in the deciding runs; empty of a single box, or without such runs."""
    loaded = [repeated for repeated in confirmed if repeated.bolt_tension_N is not None]
    if not loaded:
        return ""
    most = max(loaded, key=lambda run: run.bolt_tension_N or 0.0)
    tension, used = FIGURES["bolt_tension_N"].unit.text(most.bolt_tension_N, figures=2), most.bolt_utilisation
    of_it = (
        "; no joints.bolt_capacity_N is given"
        if used is None
        else f", {short(used, 100, 2)} % of their capacity"
    )
    return f"The bolts along one edge carry at most {tension} of tension there{of_it}."


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
