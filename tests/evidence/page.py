"""What the pages of evidence share, and their tables for a terminal."""

import datetime as dt
import math
from collections.abc import Iterable

from evidence.findings import Finding, Value
from evidence.suite import failures
from markupsafe import Markup

from fem.html.sections import Cell, joined, marked
from fem.html.units import short, typeset
from fem.runtime.identity import versions

MET_OR_MISSED = ("met", "MISSED")  #: a criterion
WIDE = 76  #: characters of a name in a terminal
HEADING = f"{'value':>13} {'reference':>12}  {'kind':<9} {'error':>9} {'tolerance':>9}  order"


def computed_now(extent: str = "Computed") -> str:
    """When and with what a suite was computed."""
    used = ", ".join(f"{name} {version}" for name, version in versions().items())
    return f"{extent} on {dt.date.today().isoformat()}; {used}."


def noted(text: str, note: str) -> Markup:
    """The name of a finding, with its note behind it."""
    return joined(typeset(text), *((" ", marked(f"({typeset(note)})", "note")) if note else ()))


def result_of(holds: bool | None, yes: str, no: str) -> Cell:
    """Whether a finding holds, in a word; empty where it is not judged."""
    return Cell("") if holds is None else Cell(yes, "pass") if holds else Cell(no, "fail")


def look_of(*findings: Finding) -> str:
    """The look of a row: failed where one of its findings fails."""
    return "failed" if failures(findings) else ""


def table_lines(groups: Iterable[tuple[str, Iterable[str]]], end: str) -> list[str]:
    """Lines for a terminal: titles, each with its lines, and a last one."""
    return [line for title, lines in groups for line in ("", title, *lines)] + ["", end]


def finding_lines(finding: Finding) -> list[str]:
    """A finding with its numbers in columns, in two lines where its name is long or it was measured."""
    if finding.kind == "measured":
        numbers = f"measured {short_text(finding.reference)}, predicted {short_text(finding.value)}"
        judged = f"; {finding.criterion}: {MET_OR_MISSED[not finding.holds]}" if finding.criterion else ""
        return [f"  {finding.what}", f"    {numbers}{judged}"]
    name = f"    {finding.name}"
    figures = (
        f"{_six(finding.value):>13} {_six(finding.reference):>12}  {finding.kind:<9} "
        f"{error(finding):>9} {tolerance(finding):>9}  {order(finding):<13}{'' if finding.holds else ' FAIL'}"
    )
    lines = [name.ljust(WIDE) + figures] if len(name) < WIDE else [name, " " * WIDE + figures]
    if not finding.holds and finding.note:
        lines.append(f"      {finding.note}")
    return [line.rstrip() for line in lines]


def short_text(value: Value) -> str:
    """Three figures without trailing zeros, or text as it is."""
    return value if isinstance(value, str) else short(float(value), figures=3)


def _six(value: Value) -> str:
    return f"{value:.6g}" if math.isfinite(float(value)) else "-"


def error(finding: Finding) -> str:
    """The error, in per cent if relative."""
    if not math.isfinite(finding.error):
        return "-"
    return f"{100.0 * finding.error:.2g} %" if finding.relative else f"{finding.error:.2g}"


def tolerance(finding: Finding) -> str:
    """The tolerance, in per cent if relative."""
    if finding.tolerance is None:
        return ""
    return f"{100.0 * finding.tolerance:.2g} %" if finding.relative else f"{finding.tolerance:.2g}"


def order(finding: Finding) -> str:
    """The observed order of convergence, and the expected one."""
    if finding.convergence is None:
        return ""
    sign = ">= " if finding.convergence.at_least else ""
    return f"{finding.convergence.observed:.2f} ({sign}{finding.convergence.order:g})"
