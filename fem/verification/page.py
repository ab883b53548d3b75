"""The verification table for people: lines for a terminal, and one self-contained page with convergence plots."""

import datetime as dt
import io
import math
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from fem.html.page import render_page, svg_element
from fem.html.units import ABSENT, short, typeset
from fem.runtime.arrays import FloatArray
from fem.runtime.identity import versions
from fem.verification.rows import Convergence, Row
from fem.verification.suite import Ladder, Rung

LEAST_SIX = 1e-3  #: smaller values are errors, and printed with three figures
HEADING = f"{'value':>13} {'reference':>12}  {'kind':<9} {'error':>9} {'tolerance':>9}  order"


def table_lines(ladder: Ladder) -> list[str]:
    """The table for a terminal, one line a row, and what it came to."""
    lines, room = [], ""
    for rung in ladder.rungs:
        if rung.room != room:
            room = rung.room
            lines += ["", room.upper().ljust(76) + HEADING]
        lines.append(f"  {rung.check}  ({rung.seconds:.1f} s)")
        for row in rung.rows:
            lines += _row_lines(row)
    verdict = "all pass" if ladder.failures == 0 else f"{ladder.failures} FAIL"
    return [*lines, "", f"{ladder.count} rows in {ladder.seconds:.0f} s: {verdict}"]


def page(ladder: Ladder) -> str:
    """The page: every row with its source, and a plot of every convergence."""
    rooms: dict[str, list[Rung]] = {}
    for rung in ladder.rungs:
        rooms.setdefault(rung.room, []).append(rung)
    plots = {
        room: [
            (f"{row.case}: {row.compared}", convergence_plot(row.convergence, f"{room}-{i}-{k}"))
            for i, rung in enumerate(rungs)
            for k, row in enumerate(rung.rows)
            if row.convergence is not None
        ]
        for room, rungs in rooms.items()
    }
    return render_page(
        "verify.html.j2",
        ladder=ladder,
        versions=", ".join(f"{name} {version}" for name, version in versions().items()),
        today=dt.date.today().isoformat(),
        rooms=rooms.items(),
        sums={room: _sum_of([row for rung in rungs for row in rung.rows]) for room, rungs in rooms.items()},
        plots=plots,
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
    # The text stays text: small, and the same bytes again.
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "unanchored", "font.size": 9}):
        figure = Figure(figsize=(3.6, 2.7), layout="constrained")
        axes = figure.add_subplot()
        axes.loglog(sizes, errors, "o-", color="#20507a", label=f"observed {convergence.observed:.2f}")
        guide = errors[np.argmin(sizes)] * (sizes / sizes.min()) ** convergence.expected
        axes.loglog(sizes, guide, "--", color="#999999", label=f"order {convergence.expected:g}")
        axes.set_xticks(sizes, _labels(sizes), rotation=30)
        axes.set_xticks([], minor=True)
        axes.set_xlabel(convergence.against)
        axes.set_ylabel("error")
        axes.grid(visible=True, which="both", linewidth=0.3)
        axes.legend(frameon=False)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
    label = f"error over {convergence.against}, observed order {convergence.observed:.2f}"
    return svg_element(stream.getvalue(), label=label, prefix=prefix)


def _sum_of(rows: Sequence[Row]) -> dict[str, Any]:
    """What the rows of a room come to, for the overview of the page."""
    used = [row.error / row.tolerance for row in rows if row.tolerance]
    return {
        "rows": len(rows),
        "failed": sum(not row.passed for row in rows),
        "use": f"{max(used):.2f}" if used and math.isfinite(max(used)) else ABSENT,
        "orders": sum(row.convergence is not None for row in rows) or ABSENT,
    }


def _labels(sizes: FloatArray) -> list[str]:
    """What the refinements are called on a logarithmic axis; none where it would cover the one before."""
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
