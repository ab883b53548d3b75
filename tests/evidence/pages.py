"""Pages, and tables for a terminal, of `verify`, `validate` and `study`: made from what their JSON files hold.

The pages are templates beside this module; a head of a table that begins with # stands over numbers.
"""

import datetime as dt
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from fem.figures.style import house_style, svg_of
from fem.html.page import Page, Signature, html_of, svg_element
from fem.html.units import ABSENT, short, typeset
from fem.runtime.arrays import FloatArray

LEAST_SIX = 1e-3  #: smaller values are errors, and shown with three figures
WIDE = 76  #: characters of a name in a terminal
HEADING = f"{'value':>13} {'reference':>12}  {'kind':<9} {'error':>9} {'tolerance':>9}  order"
#: by page: what stands above the title, and the title
TITLES = {
    "verify": ("Verification", "Verification"),
    "manual": ("Verification", "Verification manual"),
    "validate": ("Validation", "Validation"),
    "study": ("Study", "The paper, claim by claim"),
}
#: conclusions of a study, in the order in which they are told
FIRST = ("refuted", "confirmed within stated bounds", "not computed", "misprint", "confirmed", "remark")
Row = Mapping[str, Any]  #: of a document
Document = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A figure of a page."""

    name: str  #: of its file, without suffix
    caption: str
    svg: str


def page_of(
    command: str, document: Document, pictures: Mapping[str, Any], signature: Signature | None = None
) -> str:
    """The page of what a command has computed; its pictures by the names that the template has for them."""
    template = TEMPLATES.get_template(f"{command}.html.j2")
    shown: Any = template.make_module(
        {**document, "pictures": pictures, "today": dt.date.today().isoformat()}
    )
    kind, title = TITLES[command]
    return html_of(
        Page(
            kind=kind,
            title=title,
            name=f"{command}_{document['study']}" if "study" in document else command,
            introduction=Markup(shown.introduction()),
            content=Markup(shown),
            signature=signature,
            hash=document.get("program", ""),
        )
    )


def verification_lines(document: Document) -> list[str]:
    """The rows for a terminal, one line each, and the number of failures."""
    seconds = {check["check"]: check["seconds"] for check in document["checks"]}
    groups = []
    for topic, rows in by(document["rows"], "topic"):
        lines = []
        for title, some in by(rows, "check"):
            lines += [
                f"  {title}  ({seconds[title]:.1f} s)",
                f"    {some[0]['inputs']}",
                *(line for row in some for line in _row_lines(row)),
            ]
        groups.append((topic.upper().ljust(WIDE) + HEADING, lines))
    verdict = f"{document['failures']} FAIL" if document["failures"] else "all pass"
    return _table_lines(groups, f"{document['count']} rows in {document['seconds']:.0f} s: {verdict}")


def by(rows: Sequence[Row], key: str) -> list[tuple[str, list[Row]]]:
    """Rows that follow on each other with the same value of a key, by that value."""
    return [(value, list(group)) for value, group in groupby(rows, itemgetter(key))]


def largest_use(rows: Sequence[Row]) -> str:
    """The largest error over its tolerance."""
    judged = [row for row in rows if row["tolerance"]]
    used = [math.nan if row["error"] is None else row["error"] / row["tolerance"] for row in judged]
    return f"{max(used):.2f}" if used and math.isfinite(max(used)) else ABSENT


def _row_lines(row: Row) -> list[str]:
    """A row with its numbers in columns, in two lines where its name is long."""
    name = f"    {name_of(row)}"
    value, reference = (f"{x:.6g}" if x is not None else "-" for x in (row["value"], row["reference"]))
    figures = (
        f"{value:>13} {reference:>12}  {row['kind']:<9} {error(row):>9} {tolerance(row):>9}  "
        f"{order(row):<13}{'' if row['passed'] else ' FAIL'}"
    )
    lines = [name.ljust(WIDE) + figures] if len(name) < WIDE else [name, " " * WIDE + figures]
    if not row["passed"] and row["note"]:
        lines.append(f"      {row['note']}")
    return [line.rstrip() for line in lines]


def name_of(row: Row) -> str:
    """What was compared, of what case."""
    return f"{row['case']}: {row['compared']}" if row["case"] else str(row["compared"])


def error(row: Row) -> str:
    """The error, in per cent if relative."""
    if row["error"] is None:
        return "-"
    return f"{100.0 * row['error']:.2g} %" if row["relative"] else f"{row['error']:.2g}"


def tolerance(row: Row) -> str:
    """The tolerance, in per cent if relative."""
    if row["tolerance"] is None:
        return ""
    return f"{100.0 * row['tolerance']:.2g} %" if row["relative"] else f"{row['tolerance']:.2g}"


def order(row: Row) -> str:
    """The observed order of convergence, and the expected one."""
    if not (found := row["convergence"]):
        return ""
    observed = math.nan if found["observed"] is None else found["observed"]
    return f"{observed:.2f} ({'>= ' if found['at_least'] else ''}{found['expected']:g})"


def convergence_plot(convergence: Row, prefix: str = "plot") -> Markup:
    """Error over refinement in logarithmic scales, beside the expected slope; `prefix` keeps the ids of plots apart."""
    sizes, errors = (np.array(convergence[name], dtype=float) for name in ("sizes", "errors"))
    observed = math.nan if convergence["observed"] is None else convergence["observed"]
    with house_style():
        figure = Figure(figsize=(3.6, 2.7), layout="constrained")
        axes = figure.add_subplot(xlabel=convergence["against"], ylabel="error")
        axes.loglog(sizes, errors, "o-", color="#20507a", label=f"observed {observed:.2f}")
        guide = errors[np.argmin(sizes)] * (sizes / sizes.min()) ** convergence["expected"]
        axes.loglog(sizes, guide, "--", color="#999999", label=f"order {convergence['expected']:g}")
        axes.set_xticks(sizes, _labels(sizes), rotation=30)
        axes.set_xticks([], minor=True)
        axes.margins(0.05)
        axes.grid(visible=True, which="both", linewidth=0.3)
        axes.legend(frameon=False)
    label = f"error over {convergence['against']}, observed order {observed:.2f}"
    return svg_element(svg_of(figure), label=label, prefix=prefix)


def _labels(sizes: FloatArray) -> list[str]:
    """Labels of the refinements on a logarithmic axis; empty where one would cover the one before."""
    labels, last = {}, -math.inf
    for size in np.sort(sizes):
        if math.log(size) - last > 0.1 * math.log(sizes.max() / sizes.min()):
            labels[size], last = f"{size:.2g}", math.log(size)
    return [labels.get(size, "") for size in sizes]


def validation_lines(document: Document) -> list[str]:
    """The findings for a terminal."""
    groups = [
        (f"{one['title']}  ({one['tests']} tests, {one['seconds']:.0f} s)", _experiment_lines(one))
        for one in missed_first(document["experiments"])
    ]
    return [document["sentence"], *_table_lines(groups, "")]


def _experiment_lines(experiment: Row) -> list[str]:
    if experiment["not_computed"]:
        return [f"  not computed: {experiment['not_computed']}"]
    lines = [f"  fitted: {experiment['fitted']}"]
    for row in experiment["findings"]:
        judged = f"; {row['criterion']}: {'met' if row['passed'] else 'MISSED'}" if row["criterion"] else ""
        measured, predicted = three_figures(row["measured"]), three_figures(row["predicted"])
        lines += [f"  {row['quantity']}", f"    measured {measured}, predicted {predicted}{judged}"]
    return lines + [f"  {other['name']}: {other['agreement']}" for other in experiment["others"]]


def missed_first(experiments: Sequence[Row]) -> list[Row]:
    """Experiments, those with a missed criterion first."""
    return sorted(experiments, key=lambda experiment: not experiment["missed"])


def study_lines(document: Document) -> list[str]:
    """One line a claim, for a terminal, by conclusion, those refuted and those bounded first; and the counts."""
    entries = [entry for group in document["groups"] for entry in group["statements"]]
    groups = []
    for verdict in sorted({entry["verdict"] for entry in entries}, key=FIRST.index):
        chosen = [entry for entry in entries if entry["verdict"] == verdict]
        words = [entry["bounds"] if verdict == FIRST[1] else rule(entry) for entry in chosen]
        lines = [f"  {one['name']:<30} {said}" for one, said in zip(chosen, words, strict=True)]
        groups.append((verdict, lines))
    counts = ", ".join(
        f"{count} {plural(name, count)}" for name, count in document["counts"].items() if count
    )
    return _table_lines(groups, f"{document['statements']} claims: {counts}")


def rule(entry: Row) -> str:
    """How many comparisons hold, or why there are none."""
    return str(entry.get("rule") or entry.get("error", ""))


def plural(conclusion: str, count: int) -> str:
    """The conclusion behind a count: 3 remarks, 3 refuted."""
    return f"{conclusion}s" if conclusion in ("misprint", "remark") and count > 1 else conclusion


def _table_lines(groups: Iterable[tuple[str, Iterable[str]]], end: str) -> list[str]:
    """Titles, each with its lines, and a last line."""
    return [line for title, lines in groups for line in ("", title, *lines)] + ["", end]


def in_words(versions: Mapping[str, str]) -> str:
    """What a document was computed with."""
    return ", ".join(f"{name} {version}" for name, version in versions.items())


def six_figures(value: float | None) -> str:
    """Six figures; three of what is below a thousandth."""
    return short(value, figures=6 if value is not None and abs(value) >= LEAST_SIX else 3)


def three_figures(value: float | str | None) -> str:
    """Three figures without trailing zeros, or text as it is."""
    return value if isinstance(value, str) else short(value, figures=3)


def four_figures(value: Any) -> str:
    """A value of a table: numbers to four figures, a dash for nothing."""
    if value is None or value == "":
        return ABSENT
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}".replace("-", "−") if isinstance(value, int | float) else str(value)


def over_numbers(columns: Sequence[str]) -> list[str]:
    """Heads of columns of which all but the first hold numbers."""
    return [columns[0], *(f"#{column}" for column in columns[1:])]


TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
TEMPLATES.filters["svg"] = lambda text, label, prefix: svg_element(text, label=label, prefix=prefix)
WORDS = (typeset, by, largest_use, convergence_plot, missed_first, over_numbers, rule, plural, in_words)
NUMBERS = (name_of, error, tolerance, order, six_figures, three_figures, four_figures)
TEMPLATES.filters |= {function.__name__: function for function in (*WORDS, *NUMBERS)}

#: by command: its lines for a terminal, of a document
LINES = {"verify": verification_lines, "validate": validation_lines, "study": study_lines}
