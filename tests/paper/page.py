"""The page of the checked claims, and their table for a terminal, made from `study.json`."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from evidence.page import result_of, table_lines
from markupsafe import Markup
from paper.claims import Conclusion

from fem.html import sections
from fem.html.page import Page, Signature, html_of, svg_element
from fem.html.sections import NUMBER
from fem.html.units import ABSENT
from fem.results.errors import FolderError
from fem.results.folder import read_result
from fem.results.kinds import PAPER

LOOKS = {
    Conclusion.CONFIRMED.value: "pass",
    Conclusion.BOUNDED.value: "doubt",
    Conclusion.REFUTED.value: "fail",
    Conclusion.UNDECIDED.value: "fail",
    Conclusion.MISPRINT.value: "doubt",
    Conclusion.REMARK.value: "quiet",
}
RELATIONS = {"<=": "≤", ">=": "≥", "=": "="}
PAPER_TITLE = Markup(
    "Knoedel and Hrabowski, <i>A simple stick-slip model for the overturning stability of unanchored containers</i>"
)
RULE = Markup(
    "The check of each claim compares measured numbers with limits. A claim is <b>confirmed</b> if every comparison "
    "holds; <b>confirmed within stated bounds</b> if bounds are stated, every comparison inside them holds and one "
    "outside does not; <b>refuted</b> otherwise. A printed number that does not follow is a <b>misprint</b>, and a "
    "sentence that claims nothing a run could refute has a <b>remark</b>: neither is counted as refuted. The rule is "
    "the same code for all claims. The paper assumes a rigid body on a harmonic floor, and so does a conclusion, "
    "unless it says otherwise. The <b>band</b> beside it shows how the result depends on the deformable shell, on the "
    "stiffness and damping of the contact, and on the support: the rigid container; the 8 mm shell on two corners with "
    "a third, one and three times the contact penalty and contact damping ratios of 0.5 and 2; on feet; and on a flat "
    "base. A cell of a map is <b>sure</b> if small perturbations (amplitude ±2 %, friction ±0.02, contact damping 0.5, "
    "phase) do not change standing into overturning, with mu<sub>k</sub>/mu<sub>s</sub> as in the paper; what that "
    "ratio decides is counted under “Slipping stabilises”. Failed runs are not counted. A run shows only that the "
    "container did not overturn under this motion."
)
Entry = Mapping[str, Any]  #: of study.json
FEW_ROWS, FEW_TABLES = 12, 2  #: of a claim whose tables are open


def paper_report(folder: Path, *, signature: Signature | None = None) -> str:
    """One self-contained HTML page, as text.

    Raises:
        FolderError: `study.json` is missing, damaged, or something else.
    """
    path = folder / PAPER.mark
    study = read_result(path, PAPER)
    try:
        files = {svg.stem: svg.read_text(encoding="utf-8") for svg in (folder / "figures").glob("*.svg")}
        return html_of(
            Page(
                kind="Study",
                title="The paper, claim by claim",
                name=f"study_{study['study']}",
                introduction=_introduction(study),
                sections=[
                    sections.section("How a conclusion is reached", "rule", RULE),
                    sections.section("Overview", "overview", _overview(study["groups"])),
                    *(_group(group, files) for group in study["groups"]),
                    sections.section("Not checked", "untried", _untried(study["untried"])),
                ],
                signature=signature or Signature(),
                hash=study["program"],
            )
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise FolderError(
            f"{path}: damaged, or not the result of a study ({error}); compute it again with "
            "python -m fem study seed --force"
        ) from None


def lines_of(study: Mapping[str, Any]) -> list[str]:
    """One line a claim, for a terminal, and the counts."""
    groups = [(group["title"], [_line(entry) for entry in group["statements"]]) for group in study["groups"]]
    counts = ", ".join(f"{count} {plural(name, count)}" for name, count in study["counts"].items() if count)
    return table_lines(groups, f"{study['statements']} claims: {counts}")


def _line(entry: Entry) -> str:
    return f"  {entry['name']:<26} {entry['verdict']:<31} {_rule(entry)}"


def _rule(entry: Entry) -> str:
    """How many comparisons hold, or why there are none."""
    return str(entry.get("rule") or entry.get("error", ""))


def _introduction(study: Mapping[str, Any]) -> list[sections.Block]:
    unfinished = sections.joined("; the study is ", sections.strong(study["status"]))
    versions = ", ".join(f"{name} {version}" for name, version in study["versions"].items())
    counts = [
        sections.Headline(sections.marked(plural(name, count), LOOKS[name]), str(count))
        for name, count in study["counts"].items()
        if count
    ]
    return [
        sections.joined(
            PAPER_TITLE,
            f": {study['statements']} claims, each checked by runs or closed forms",
            "" if study["status"] == "completed" else unfinished,
            ".",
        ),
        sections.Headlines(counts),
        sections.Note(
            f"python -m fem study seed; {versions}; program {study['program'][:12]}; computed in "
            f"{study['wall_s']:.0f} s."
        ),
    ]


def _overview(groups: Sequence[Mapping[str, Any]]) -> sections.Table:
    rows = []
    for group in groups:
        rows.append(sections.TableRow([sections.Cell(group["title"], span=len(OVERVIEW))]))
        rows += sections.table_of("", OVERVIEW, group["statements"]).rows
    head = [sections.Cell(column.head) for column in OVERVIEW]
    return sections.Table("overview of all claims", head, rows, look="claims")


def _group(group: Mapping[str, Any], files: Mapping[str, str]) -> sections.PageSection:
    claims = (sections.Group("claim", list(_claim(entry, files))) for entry in group["statements"])
    return sections.section(group["title"], group["title"].lower().replace(" ", "-"), *claims)


def _conclusion(entry: Entry) -> Markup:
    bounds = f": {entry['bounds']}" if entry["verdict"] == Conclusion.BOUNDED.value else ""
    return sections.joined(sections.marked(entry["verdict"], LOOKS[entry["verdict"]]), bounds)


def _claim(entry: Entry, files: Mapping[str, str]) -> Iterator[sections.Block]:
    title, section = entry["name"].replace("-", " ").capitalize(), f"(section {entry['section']})"
    yield sections.Heading(sections.joined(title, " ", sections.marked(section, "quiet")), entry["name"])
    yield sections.Quote(entry["quote"])
    yield sections.Paragraph(_conclusion(entry), "conclusion")
    if "error" in entry:
        yield sections.Paragraph(f"Not computed: {entry['error']}", "fail")
        return
    yield entry["reading"]
    rule = f" {entry['rule']}." if entry["rule"] else ""
    failed = f" {entry['failed_runs']} failed runs are not counted." if entry["failed_runs"] else ""
    yield sections.Note(f"Check: {entry['tried']}{rule}{failed}")
    if entry["comparisons"]:
        bounded = bool(entry["bounds"])
        yield sections.table_of(
            f"comparisons of {entry['name']}",
            [sections.Column("compared", lambda row: _compared(row, bounded)), *COMPARISONS],
            entry["comparisons"],
            row_look=lambda row: "outside" if bounded and not row["inside"] else "",
        )
    for drawing in entry["drawings"]:
        if (name := drawing["name"]) in files:
            caption = drawing["caption"]
            yield sections.Figure(
                svg_element(files[name], label=caption, prefix=name), caption, caption=caption
            )
    if band := entry["band"]:
        unit = "" if band["unit"] == "-" else f" {band['unit']}"
        yield sections.table_of(
            f"band of {entry['name']}",
            MEMBERS,
            band["members"],
            caption=f"Band: {band['quantity']}, {number(band['low'])} to {number(band['high'])}{unit}. "
            f"Criterion: {band['criterion']}; it {band['summary']}.",
        )
    for table in entry["tables"]:
        few = len(table["rows"]) <= FEW_ROWS and len(entry["tables"]) <= FEW_TABLES
        rows = ([number(value) for value in row] for row in table["rows"])
        columns = sections.in_order(*table["columns"], look=NUMBER)
        yield sections.Folded(
            table["caption"], [sections.table_of(table["caption"], columns, rows)], open=few
        )
    if setups := entry["setups"]:
        commands = [
            block
            for setup in setups
            for block in (sections.Note(setup["what"]), sections.Listing(setup["command"], ""))
        ]
        runs = "1 run" if len(setups) == 1 else f"{len(setups)} runs"
        yield sections.Folded(f"Run it again ({runs})", commands)


def _compared(row: Entry, bounded: bool) -> str:
    if not bounded or row["inside"]:
        return str(row["what"])
    return sections.joined(row["what"], " ", sections.marked("(outside the bounds)", "note"))


def _band_summary(entry: Entry) -> str:
    return str(entry["band"]["summary"]) if entry.get("band") else ABSENT


def _limit(row: Entry) -> str:
    tolerance = f" ± {number(row['tolerance'])}" if row["tolerance"] else ""
    return f"{RELATIONS[row['relation']]} {number(row['limit'])}{tolerance}"


def _untried(untried: Sequence[Entry]) -> sections.Table:
    rows = [(entry["section"], entry["quote"], entry["reason"]) for entry in untried]
    return sections.table_of(
        "sentences that are not checked", sections.in_order("section", "sentence", "reason"), rows
    )


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


OVERVIEW = [
    sections.Column[Entry]("section", lambda entry: entry["section"]),
    sections.Column("claim", lambda entry: sections.link(entry["quote"], entry["name"])),
    sections.Column("conclusion", _conclusion),
    sections.Column("comparisons that hold", lambda entry: _rule(entry) or ABSENT),
    sections.Column("over deformation, contact and support", _band_summary),
]
COMPARISONS = [
    sections.Column[Entry]("measured", lambda row: number(row["measured"]), NUMBER),
    sections.Column("limit", _limit, NUMBER),
    sections.Column("unit", lambda row: row["unit"]),
    sections.Column("holds", lambda row: result_of(row["holds"], "yes", "no")),
]
MEMBERS = [
    sections.Column[Entry]("container and floor", lambda member: member["what"]),
    sections.Column("outcome", lambda member: number(member["outcome"])),
    sections.Column("value", lambda member: number(member["value"]), NUMBER),
    sections.Column("holds", lambda member: number(member["holds"])),
]
