"""The verification table for people: lines for a terminal, and one self-contained page with convergence plots."""

import datetime as dt
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from fem.evidence.verification.rows import Convergence, Row
from fem.evidence.verification.suite import ComputedCheck, SuiteResult
from fem.figures.style import house_style, svg_of
from fem.html.page import render_page, svg_element
from fem.html.units import ABSENT, short, typeset
from fem.runtime.arrays import FloatArray
from fem.runtime.identity import versions

LEAST_SIX = 1e-3  #: smaller values are errors, and printed with three figures
HEADING = f"{'value':>13} {'reference':>12}  {'kind':<9} {'error':>9} {'tolerance':>9}  order"


def table_lines(result: SuiteResult) -> list[str]:
    """The table for a terminal, one line a row, and the number of failures."""
    lines, topic = [], ""
    for check in result.checks:
        if check.topic != topic:
            topic = check.topic
            lines += ["", topic.upper().ljust(76) + HEADING]
        lines.append(f"  {check.title}  ({check.seconds:.1f} s)")
        for row in check.rows:
            lines += _row_lines(row)
    verdict = "all pass" if result.failures == 0 else f"{result.failures} FAIL"
    return [*lines, "", f"{result.count} rows in {result.seconds:.0f} s: {verdict}"]


def page(result: SuiteResult) -> str:
    """The page: every row with its source, and a plot of every convergence."""
    topics: dict[str, list[ComputedCheck]] = {}
    for check in result.checks:
        topics.setdefault(check.topic, []).append(check)
    return render_page(
        "verify.html.j2",
        result=result,
        versions=", ".join(f"{name} {version}" for name, version in versions().items()),
        today=dt.date.today().isoformat(),
        topics=topics.items(),
        sums={
            topic: _sum_of([row for check in checks for row in check.rows])
            for topic, checks in topics.items()
        },
        plots={topic: _plots(topic, checks) for topic, checks in topics.items()},
        number=lambda value: short(value, figures=6 if abs(value) >= LEAST_SIX else 3),
        typeset=typeset,
        error=_error,
        tolerance=_tolerance,
        order=_order,
    )


def convergence_plot(convergence: Convergence, prefix: str = "plot") -> Markup:
    """Error over refinement in logarithmic scales, beside the expected slope, as an SVG element.

    `prefix` keeps the ids of plots in one page apart.
    """
    sizes, errors = np.array(convergence.sizes), np.array(convergence.errors)
    with house_style():
        figure = Figure(figsize=(3.6, 2.7), layout="constrained")
        axes = figure.add_subplot(xlabel=convergence.against, ylabel="error")
        axes.loglog(sizes, errors, "o-", color="#20507a", label=f"observed {convergence.observed:.2f}")
        guide = errors[np.argmin(sizes)] * (sizes / sizes.min()) ** convergence.expected
        axes.loglog(sizes, guide, "--", color="#999999", label=f"order {convergence.expected:g}")
        axes.set_xticks(sizes, _labels(sizes), rotation=30)
        axes.set_xticks([], minor=True)
        axes.margins(0.05)
        axes.grid(visible=True, which="both", linewidth=0.3)
        axes.legend(frameon=False)
    label = f"error over {convergence.against}, observed order {convergence.observed:.2f}"
    return svg_element(svg_of(figure), label=label, prefix=prefix)


def _plots(topic: str, checks: Sequence[ComputedCheck]) -> list[tuple[str, Markup]]:
    """Caption and plot of every convergence of a topic."""
    return [
        (f"{row.case}: {row.compared}", convergence_plot(row.convergence, f"{topic}-{i}-{k}"))
        for i, check in enumerate(checks)
        for k, row in enumerate(check.rows)
        if row.convergence is not None
    ]


def _sum_of(rows: Sequence[Row]) -> dict[str, Any]:
    """Summary of the rows of a topic, for the overview of the page."""
    used = [row.error / row.tolerance for row in rows if row.tolerance]
    return {
        "rows": len(rows),
        "failed": sum(not row.passed for row in rows),
        "use": f"{max(used):.2f}" if used and math.isfinite(max(used)) else ABSENT,
        "orders": sum(row.convergence is not None for row in rows) or ABSENT,
    }


def _labels(sizes: FloatArray) -> list[str]:
    """Labels of the refinements on a logarithmic axis; empty where one would cover the one before."""
    labels, last = {}, -math.inf
    for size in np.sort(sizes):
        if math.log(size) - last > 0.1 * math.log(sizes.max() / sizes.min()):
            labels[size], last = f"{size:.2g}", math.log(size)
    return [labels.get(size, "") for size in sizes]


def _row_lines(row: Row) -> list[str]:
    name = f"    {row.case}: {row.compared}"
    figures = (
        f"{_number(row.value):>13} {_number(row.reference):>12}  {row.kind:<9} "
        f"{_error(row):>9} {_tolerance(row):>9}  {_order(row):<13}{'' if row.passed else ' FAIL'}"
    )
    lines = [name.ljust(76) + figures] if len(name) <= 75 else [name, " " * 76 + figures]
    if not row.passed and row.note:
        lines.append(f"      {row.note}")
    return [line.rstrip() for line in lines]


def _number(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else "-"


def _error(row: Row) -> str:
    if not math.isfinite(row.error):
        return "-"
    return f"{100.0 * row.error:.2g} %" if row.relative else f"{row.error:.2g}"


def _tolerance(row: Row) -> str:
    if row.tolerance is None:
        return ""
    return f"{100.0 * row.tolerance:.2g} %" if row.relative else f"{row.tolerance:.2g}"


def _order(row: Row) -> str:
    if row.convergence is None:
        return ""
    sign = ">= " if row.convergence.at_least else ""
    return f"{row.convergence.observed:.2f} ({sign}{row.convergence.expected:g})"
