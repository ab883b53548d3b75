"""The rules of thumb on the page of a site: side by side, and with their numbers."""

from collections.abc import Sequence
from dataclasses import replace

from markupsafe import Markup

from fem.html import sections as html
from fem.html.formula import formula_markup
from fem.html.units import ABSENT, number, quantity
from fem.site_check.page.figures import draw_methods
from fem.site_check.page.view import SiteView, elevation_in_words, figure, symbols
from fem.site_check.result import SiteMethod


def methods_section(view: SiteView) -> html.PageSection:
    """The simplified methods side by side, and what each says of the strength."""
    result = view.result
    if not result.methods:
        return html.section("", "methods")
    governing = result.result.governing
    mass = governing.mass if governing else result.bodies[0].mass
    drawn = [row for row in result.methods if row.mass == mass and not row.beyond]
    capacities = (
        draw_methods(drawn, result.result, mass) if any(row.factor is not None for row in drawn) else ""
    )
    action = "the same action as the runs"
    if result.floor and result.floor.z_over_h:
        action = (
            "the motions of the floor, as the runs do, but for those that name a_g S, which is of the ground: "
            "Eq. (4.25) raises it to the floor, the plateau does not"
        )
    return html.section(
        "Rules of thumb side by side",
        "methods",
        html.joined(
            f"All use the least friction of the range and {action}. The last columns give what the rule counts, and "
            "whether the method is conservative against that. A median is what half of such motions or bodies exceed, "
            "so it gets no verdict; nor does a rule out of its range, in grey. Formulas and numbers are in the ",
            html.link("static calculation", "sheet"),
            ".",
        ),
        _methods_table("rules of thumb side by side", result.methods),
        *([figure(capacities, "methods-0", "capacity over strength by each method")] if capacities else []),
    )


def _methods_table(caption: str, rows: Sequence[SiteMethod]) -> html.Table:
    def compared(row: SiteMethod) -> html.Cell:
        if row.beyond:
            return html.Cell(f"out of range: {row.beyond}", "note")
        if row.median:
            return html.Cell("a median: no verdict", "note")
        return html.Cell(row.compared or ABSENT, "doubt" if row.compared == "not conservative" else "")

    columns: list[html.Column[SiteMethod]] = [
        html.Column("method", lambda row: symbols(row.name)),
        html.Column("check", lambda row: row.quantity),
        html.Column("weight", lambda row: row.mass + elevation_in_words(row.elevation)),
        html.Column("utilisation", lambda row: _utilisation(row, 3), html.NUMBER),
        html.Column("conclusion", lambda row: row.says),
        html.Column("the rule counts", lambda row: html.Cell(Markup.escape(row.found), "wide")),
        html.Column("the method is", compared),
        html.Column("source", lambda row: html.Cell(Markup.escape(row.source), "note")),
    ]
    return html.table_of(
        caption,
        columns,
        merged_methods(rows),
        row_look=lambda row: "outside" if row.beyond else "",
        look="methods",
    )


def sheet_section(view: SiteView) -> html.PageSection:
    """Appendix C: the simplified methods with their numbers."""
    if not view.result.methods:
        return html.section("", "sheet")

    def name(row: SiteMethod) -> str:
        return html.joined(
            symbols(row.name), f", {row.quantity}, {row.mass}{elevation_in_words(row.elevation)}"
        )

    def demand(row: SiteMethod) -> str:
        return "none" if row.demand is None else quantity(row.demand, row.unit)

    columns: list[html.Column[SiteMethod]] = [
        html.Column("method", name),
        html.Column("formula", lambda row: formula_markup(row.formula)),
        html.Column("with numbers", lambda row: symbols(row.numbers)),
        html.Column("demand", demand, html.NUMBER),
        html.Column("capacity", lambda row: quantity(row.capacity, row.unit), html.NUMBER),
        html.Column("utilisation", lambda row: _utilisation(row, 4), html.NUMBER),
        html.Column("valid for", lambda row: html.Cell(Markup.escape(row.validity), "note")),
    ]
    table = html.table_of("static calculation with numbers", columns, view.result.methods, look="methods")
    return html.section("Appendix C: static calculation with numbers", "sheet", table)


def _utilisation(row: SiteMethod, figures: int) -> str:
    return "∞" if row.utilisation is None else number(row.utilisation, figures=figures)


def merged_methods(methods: Sequence[SiteMethod]) -> list[SiteMethod]:
    """The methods side by side; weights of which a method says the same, to three figures, share a row."""
    merged: dict[tuple[str, ...], list[SiteMethod]] = {}
    for method in methods:
        key = (
            method.name,
            method.quantity,
            method.elevation,
            number(method.utilisation, figures=3),
            method.says,
        )
        merged.setdefault((*key, method.compared), []).append(method)
    rows = []
    for same in merged.values():
        findings = {method.mass: method.found for method in same}
        alike = len(set(findings.values())) == 1
        words = same[0].found if alike else "; ".join(f"{mass}: {findings[mass]}" for mass in findings)
        rows.append(replace(same[0], mass=", ".join(method.mass for method in same), found=words))
    return rows
