"""The basis of a verification on its page: action, container, friction, limits, and the set of motions."""

from collections.abc import Sequence

from fem.html import sections as html
from fem.html.units import ABSENT, number, quantity, short, typeset
from fem.site_check.page.figures import draw_spectra
from fem.site_check.page.view import figure, symbols
from fem.site_check.result import MotionSet, SetCheck, SiteBody, SiteResult

STANDARD = "EN 1998-1:2004"


def inputs_section(result: SiteResult) -> html.PageSection:
    """The action beside the container, friction and limits."""

    def listed(title: str, rows: Sequence[tuple[str, str]]) -> html.Group:
        pairs = [(symbols(name), symbols(typeset(value))) for name, value in rows]
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
    drawn = figure(draw_spectra(result.action, result.set, result.floor), "spectra", caption)
    words = html.Note(symbols(period_sentence(result.set)))
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


def _range(values: Sequence[float]) -> str:
    return " to ".join(short(value) for value in dict.fromkeys((min(values), max(values))))
