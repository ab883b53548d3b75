"""The verification suite for people: lines for a terminal, and a page with every finding and convergence plots."""

import math
from collections.abc import Iterator

import numpy as np
from evidence import page
from evidence.findings import Convergence, Finding, Value
from evidence.suite import failures
from markupsafe import Markup
from matplotlib.figure import Figure
from verification.suite import ComputedCheck, SuiteResult, Topic

from fem.figures.style import house_style, svg_of
from fem.html import sections
from fem.html.page import Page, html_of, svg_element
from fem.html.sections import NUMBER
from fem.html.units import ABSENT, short, typeset
from fem.runtime.arrays import FloatArray

LEAST_SIX = 1e-3  #: smaller values are errors, and printed with three figures
SHOWS = "shows the convergence plots"
INTRODUCTION = Markup(
    "Every row checks that the equations are solved right. A reference is <b>analytic</b> (a closed form, or a "
    "statement such as symmetry), <b>printed</b> (in the literature), or <b>computed</b> (by code that shares nothing "
    "with what is checked, or as a converged limit). An error is absolute, in the unit of the row, or relative where "
    "the tolerance is in per cent. An order is the observed slope of the error over the refinement, by least squares "
    "over all refinements; the expected order is in brackets. The overview gives the largest error over its tolerance "
    "and the number of observed orders of each topic."
)
SYMBOLS = (
    "SI units. Rotation > 0 toward +x. al: slenderness angle, from the vertical to the line from a corner to the mass "
    "centre; p: frequency parameter of rocking; e: restitution, a ratio of angular velocities; f1/f_c: first elastic "
    "over contact frequency; E, h: Young's modulus, element size; g: gravity; a/c: half width over height of the mass "
    "centre."
)


def lines_of(result: SuiteResult) -> list[str]:
    """The findings for a terminal, one line each, and the number of failures."""
    verdict = "all pass" if result.failures == 0 else f"{result.failures} FAIL"
    groups = [
        (
            topic.name.upper().ljust(page.WIDE) + page.HEADING,
            [line for check in topic.checks for line in _lines(check)],
        )
        for topic in result.topics
    ]
    return page.table_lines(groups, f"{result.count} rows in {result.seconds:.0f} s: {verdict}")


def _lines(check: ComputedCheck) -> list[str]:
    findings = (line for finding in check.findings for line in page.finding_lines(finding))
    return [f"  {check.title}  ({check.seconds:.1f} s)", *findings]


def page_of(result: SuiteResult) -> str:
    """The page: every finding with its source, and a plot of every convergence."""
    failed, count = result.failures, result.count
    sentence = f"{failed} of {count} rows fail." if failed else f"All {count} rows pass."
    extent = "Quick checks: the slowest checks are left out" if result.quick else "All checks"
    return html_of(
        Page(
            kind="Verification",
            title="Verification",
            name="verify",
            introduction=[
                sections.Paragraph(sentence, f"sentence {'fail' if failed else 'pass'}"),
                page.computed_now(f"{extent}. Computed in {result.seconds:.0f} s"),
            ],
            sections=[
                INTRODUCTION,
                sections.Note(SYMBOLS),
                sections.table_of(
                    "overview", OVERVIEW, result.topics, row_look=lambda topic: page.look_of(*topic.findings)
                ),
                *map(_section, result.topics),
            ],
        )
    )


def _section(topic: Topic) -> sections.PageSection:
    """All findings, and the plots of convergences."""
    rows = [row for check in topic.checks for row in _rows(check)]
    plots = [
        sections.Figure(convergence_plot(convergence, f"{topic.name}-{k}"), "", caption=typeset(name))
        for k, (name, convergence) in enumerate(_convergences(topic))
    ]
    table = sections.Table(f"rows of {topic.name}", HEAD, rows, look="checks")
    return sections.section(topic.name, topic.name, table, sections.Group("plots", plots))


def _convergences(topic: Topic) -> list[tuple[str, Convergence]]:
    """Names and orders of the findings that have one."""
    return [
        (finding.name, finding.convergence) for finding in topic.findings if finding.convergence is not None
    ]


def _largest_use(topic: Topic) -> str:
    """The largest error over its tolerance."""
    used = [finding.error / finding.tolerance for finding in topic.findings if finding.tolerance]
    return f"{max(used):.2f}" if used and math.isfinite(max(used)) else ABSENT


OVERVIEW = [
    sections.Column[Topic]("topic", lambda topic: sections.link(topic.name, topic.name)),
    sections.Column("checks", lambda topic: str(len(topic.checks)), NUMBER),
    sections.Column("rows", lambda topic: str(len(topic.findings)), NUMBER),
    sections.Column("failed", lambda topic: str(failures(topic.findings)), NUMBER),
    sections.Column("error / tolerance", _largest_use, NUMBER),
    sections.Column("orders", lambda topic: str(len(_convergences(topic)) or ABSENT), NUMBER),
]
COLUMNS = [
    sections.Column[Finding]("value", lambda finding: _number(finding.value), NUMBER),
    sections.Column("reference", lambda finding: _number(finding.reference), NUMBER),
    sections.Column("its source", lambda finding: _source(finding)),
    sections.Column("error", page.error, NUMBER),
    sections.Column("tolerance", page.tolerance, NUMBER),
    sections.Column("order", page.order, NUMBER),
    sections.Column("passed", lambda finding: page.result_of(finding.holds, "pass", "FAIL")),
]
HEAD = [sections.Cell(column.head, column.look) for column in COLUMNS]


def _rows(check: ComputedCheck) -> Iterator[sections.TableRow]:
    """The title of a check; then for each finding its name, and its numbers."""
    yield _spanning(typeset(check.title), "check")
    numbers = sections.table_of("", COLUMNS, check.findings, row_look=page.look_of).rows
    for finding, row in zip(check.findings, numbers, strict=True):
        yield _spanning(page.noted(finding.name, finding.note), f"case {row.look}".rstrip())
        yield row


def _spanning(text: str, look: str) -> sections.TableRow:
    return sections.TableRow([sections.Cell(text, span=len(COLUMNS))], look)


def _source(finding: Finding) -> str:
    if not finding.source:
        return finding.kind
    return sections.joined(finding.kind, ": ", sections.marked(typeset(finding.source), "note"))


def _number(value: Value) -> str:
    value = float(value)
    return short(value, figures=6 if abs(value) >= LEAST_SIX else 3)


def convergence_plot(convergence: Convergence, prefix: str = "plot") -> Markup:
    """Error over refinement in logarithmic scales, beside the expected slope, as an SVG element.

    `prefix` keeps the ids of plots in one page apart.
    """
    sizes, errors = (
        np.array(list(convergence.errors)),
        np.array(list(convergence.errors.values()), dtype=float),
    )
    with house_style():
        figure = Figure(figsize=(3.6, 2.7), layout="constrained")
        axes = figure.add_subplot(xlabel=convergence.against, ylabel="error")
        axes.loglog(sizes, errors, "o-", color="#20507a", label=f"observed {convergence.observed:.2f}")
        guide = errors[np.argmin(sizes)] * (sizes / sizes.min()) ** convergence.order
        axes.loglog(sizes, guide, "--", color="#999999", label=f"order {convergence.order:g}")
        axes.set_xticks(sizes, _labels(sizes), rotation=30)
        axes.set_xticks([], minor=True)
        axes.margins(0.05)
        axes.grid(visible=True, which="both", linewidth=0.3)
        axes.legend(frameon=False)
    label = f"error over {convergence.against}, observed order {convergence.observed:.2f}"
    return svg_element(svg_of(figure), label=label, prefix=prefix)


def _labels(sizes: FloatArray) -> list[str]:
    """Labels of the refinements on a logarithmic axis; empty where one would cover the one before."""
    labels, last = {}, -math.inf
    for size in np.sort(sizes):
        if math.log(size) - last > 0.1 * math.log(sizes.max() / sizes.min()):
            labels[size], last = f"{size:.2g}", math.log(size)
    return [labels.get(size, "") for size in sizes]
