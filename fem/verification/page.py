"""The verification table for people: lines for a terminal, and one self-contained page with convergence plots."""

import io
import math

import matplotlib
import numpy as np
from jinja2 import Environment
from matplotlib.figure import Figure

from fem.run import versions
from fem.verification.ladder import Ladder, Rung
from fem.verification.rows import Convergence, Row

PAGE = """<!DOCTYPE html>
<html lang="en-GB"><head><meta charset="utf-8"><title>Verification</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 78em; padding: 0 1em; color: #222; }
table { border-collapse: collapse; width: 100%; font-size: 13px; }
th, td { text-align: left; vertical-align: top; padding: .25em .6em; border-bottom: 1px solid #ddd; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.failed { background: #fde8e6; } .pass { color: #2a6b2a; } .fail { color: #a11; font-weight: bold; }
.note { color: #666; } .plots { display: flex; flex-wrap: wrap; gap: 1em; } figure { margin: 0; width: 25em; }
figcaption { font-size: 12px; color: #444; } svg { max-width: 100%; height: auto; }
</style></head><body>
<h1>Verification</h1>
<p>{{ ladder.count }} rows, {{ ladder.failures }} failed;
{{ "the quick ladder" if ladder.quick else "the whole ladder" }}, {{ "%.0f" | format(ladder.seconds) }} s;
{{ versions }}.</p>
<p>A reference is <b>analytic</b> (a closed form, or a statement such as symmetry), <b>printed</b> (by somebody
else), or <b>computed</b> (by code that shares nothing with what is checked, or a converged limit). An error is
absolute, or relative where the tolerance is in per cent. An order is observed by least squares over all
refinements.</p>
{% for room, rungs in rooms %}
<h2>{{ room }}</h2>
<table><tr><th>case</th><th>what is compared</th><th>value</th><th>reference</th><th>kind</th><th>error</th>
<th>tolerance</th><th>order</th><th></th></tr>
{% for rung in rungs %}<tr><th colspan="9">{{ rung.check }}</th></tr>
{% for row in rung.rows %}<tr class="{{ '' if row.passed else 'failed' }}">
<td>{{ row.case }}</td>
<td>{{ row.compared }}{% if row.note %}<br><span class="note">{{ row.note }}</span>{% endif %}</td>
<td class="number">{{ number(row.value) }}</td>
<td class="number" title="{{ row.source }}">{{ number(row.reference) }}</td>
<td>{{ row.kind }}<br><span class="note">{{ row.source }}</span></td>
<td class="number">{{ error(row) }}</td><td class="number">{{ tolerance(row) }}</td>
<td class="number">{{ order(row) }}</td>
<td class="{{ 'pass' if row.passed else 'fail' }}">{{ "pass" if row.passed else "FAIL" }}</td></tr>
{% endfor %}{% endfor %}</table>
<div class="plots">{% for caption, svg in plots[room] %}<figure>{{ svg | safe }}
<figcaption>{{ caption }}</figcaption></figure>
{% endfor %}</div>
{% endfor %}</body></html>
"""


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
            (f"{row.case}: {row.compared}", convergence_plot(row.convergence))
            for rung in rungs
            for row in rung.rows
            if row.convergence is not None
        ]
        for room, rungs in rooms.items()
    }
    template = Environment(autoescape=True).from_string(PAGE)
    return template.render(
        ladder=ladder,
        versions=", ".join(f"{name} {version}" for name, version in versions().items()),
        rooms=rooms.items(),
        plots=plots,
        number=_number,
        error=_error,
        tolerance=_tolerance,
        order=_order,
    )


def convergence_plot(convergence: Convergence) -> str:
    """Error over refinement in logarithmic scales, beside the expected slope, as an SVG element."""
    sizes, errors = np.array(convergence.sizes), np.array(convergence.errors)
    # The text stays text: small, and the same bytes again.
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "unanchored", "font.size": 9}):
        figure = Figure(figsize=(3.6, 2.7), layout="constrained")
        axes = figure.add_subplot()
        axes.loglog(sizes, errors, "o-", color="#20507a", label=f"observed {convergence.observed:.2f}")
        guide = errors[np.argmin(sizes)] * (sizes / sizes.min()) ** convergence.expected
        axes.loglog(sizes, guide, "--", color="#999999", label=f"order {convergence.expected:g}")
        axes.set_xticks(sizes, [f"{size:.2g}" for size in sizes], rotation=30)
        axes.set_xticks([], minor=True)
        axes.set_xlabel(convergence.against)
        axes.set_ylabel("error")
        axes.grid(visible=True, which="both", linewidth=0.3)
        axes.legend(frameon=False)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    return text[text.index("<svg") :]


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
