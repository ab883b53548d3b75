"""The page of the checked claims, and their table for a terminal, made from `study.json`."""

import datetime as dt
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fem.evidence.paper.claims import Conclusion
from fem.html.page import Signature, render_page, svg_element
from fem.results.errors import FolderError
from fem.results.folder import read_result
from fem.results.kinds import PAPER

MARKS = {
    Conclusion.CONFIRMED.value: "pass",
    Conclusion.BOUNDED.value: "doubt",
    Conclusion.REFUTED.value: "fail",
    Conclusion.UNDECIDED.value: "fail",
    Conclusion.MISPRINT.value: "doubt",
    Conclusion.REMARK.value: "quiet",
}


def paper_report(folder: Path, *, signature: Signature | None = None) -> str:
    """One self-contained HTML page, as text.

    Raises:
        FolderError: `study.json` is missing, damaged, or something else.
    """
    path = folder / PAPER.mark
    document = read_result(path, PAPER)
    try:
        files = {one.stem: one.read_text(encoding="utf-8") for one in (folder / "figures").glob("*.svg")}
        entries = [entry for group in document["groups"] for entry in group["statements"]]
        drawings = [one for entry in entries for one in entry.get("drawings", ()) if one["name"] in files]
        return render_page(
            "study.html.j2",
            scripts=["signature.js"],
            name=f"study_{document['study']}",
            signature=signature or Signature(),
            today=dt.date.today().isoformat(),
            study=document,
            marks=MARKS,
            figures={
                one["name"]: svg_element(files[one["name"]], label=one["caption"], prefix=one["name"])
                for one in drawings
            },
            versions=", ".join(f"{name} {version}" for name, version in document["versions"].items()),
            number=number,
            plural=plural,
            limit=limit,
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise FolderError(
            f"{path}: damaged, or not the result of a study ({error}); compute it again with "
            "python -m fem study seed --force"
        ) from None


def table_lines(document: Mapping[str, Any]) -> list[str]:
    """One line a claim, for a terminal, and the counts."""
    lines = []
    for group in document["groups"]:
        lines += ["", group["title"]]
        for entry in group["statements"]:
            rule = entry.get("rule") or entry.get("error", "")
            lines.append(f"  {entry['name']:<26} {entry['verdict']:<31} {rule}")
    counts = ", ".join(
        f"{count} {plural(name, count)}" for name, count in document["counts"].items() if count
    )
    return [*lines, "", f"{document['statements']} claims: {counts}"]


def plural(conclusion: str, count: int) -> str:
    """The conclusion behind a count: 3 remarks, 3 refuted."""
    noun = conclusion in (Conclusion.MISPRINT.value, Conclusion.REMARK.value)
    return f"{conclusion}s" if noun and count > 1 else conclusion


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
    """The limit of a comparison, with its relation."""
    sign = {"<=": "≤", ">=": "≥", "=": "="}[comparison["relation"]]
    tolerance = f" ± {number(comparison['tolerance'])}" if comparison["tolerance"] else ""
    return f"{sign} {number(comparison['limit'])}{tolerance}"
