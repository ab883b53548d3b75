"""The page of a study, and its table for a terminal, from what `study.json` holds."""

import datetime as dt
from collections.abc import Mapping
from typing import Any

from fem.html.page import Signature, render_page, svg_element
from fem.paper.claims import Verdict

MARKS = {
    Verdict.CONFIRMED.value: "pass",
    Verdict.BOUNDED.value: "doubt",
    Verdict.REFUTED.value: "fail",
    Verdict.UNDECIDED.value: "fail",
}


def study_page(
    document: Mapping[str, Any], svgs: Mapping[str, str], *, signature: Signature | None = None
) -> str:
    """One self-contained HTML page.

    Args:
        document: a `study.json`.
        svgs: its figures, by their names.
        signature: author, checker, revision.
    """
    return render_page(
        "study.html.j2",
        scripts=["signature.js"],
        name=f"study_{document['study']}",
        signature=signature or Signature(),
        today=dt.date.today().isoformat(),
        study=document,
        marks=MARKS,
        figures={
            one["name"]: svg_element(svgs[one["name"]], label=one["caption"], prefix=one["name"])
            for group in document["groups"]
            for entry in group["statements"]
            for one in entry.get("drawings", ())
            if one["name"] in svgs
        },
        versions=", ".join(f"{name} {version}" for name, version in document["versions"].items()),
        number=number,
        limit=limit,
    )


def table_lines(document: Mapping[str, Any]) -> list[str]:
    """One line a statement, for a terminal, and the counts."""
    lines = []
    for group in document["groups"]:
        lines += ["", group["title"]]
        for entry in group["statements"]:
            rule = entry.get("rule") or entry.get("error", "")
            lines.append(f"  {entry['name']:<26} {entry['verdict']:<31} {rule}")
    counts = ", ".join(f"{count} {verdict}" for verdict, count in document["counts"].items() if count)
    return [*lines, "", f"{document['statements']} statements: {counts}"]


def number(value: Any) -> str:
    """A value of a table: numbers to four figures, a dash for nothing."""
    if value is None or value == "":
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return f"{value:.4g}".replace("-", "−")
    return str(value)


def limit(comparison: Mapping[str, Any]) -> str:
    """What a comparison asks for."""
    sign = {"<=": "≤", ">=": "≥", "=": "="}[comparison["relation"]]
    tolerance = f" ± {number(comparison['tolerance'])}" if comparison["tolerance"] else ""
    return f"{sign} {number(comparison['limit'])}{tolerance}"
