"""The page of a hall: what the containers did, the weakest first, by tag, and the command of each."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fem.assessment.margin_words import FACTOR
from fem.assessment.sure_words import deciding_in_words
from fem.batch.study import read_study
from fem.case.case import load_case
from fem.hall.places import PICTURE
from fem.hall.result import HallResult
from fem.html import sections as html
from fem.html.page import Signature
from fem.html.units import ABSENT, number
from fem.report import studies
from fem.report.comparison import case_rows
from fem.results.figures import TURNED, Place, figures_of
from fem.results.kinds import HALL
from fem.results.outcome import Outcome
from fem.runtime.identity import command_line

BRIEFLY = 30  #: containers on the short page
LOOKS = {"overturned": "bad", "invalid": "bad", "failed": "bad"}
MARGIN = (
    "Margin: the factor on the whole motion of the run from which it overturns, with the range that all unknown inputs "
    "together give it. Utilisation: of the static rule for overturning, under the peak of the motion."
)
OF_SEVERAL = (
    "Of several motions the worst governs: one that overturns the container, else one that destroys a corner, else the "
    "one of the largest rotation. The margin under another motion may be less."
)
A_ROW = Mapping[str, Any]


def hall_report(
    folder: Path, *, signature: Signature | None = None, result: HallResult | None = None, brief: bool = False
) -> str:
    """The page, as the text of an HTML file.

    Args:
        folder: of the hall.
        signature: author, checker, revision.
        result: what its marking file is to hold; default: what it holds.
        brief: only the answer, the plan, the tags and the weakest.

    Raises:
        FolderError: it is not the folder of a hall, it is damaged, or it is not finished.
        CaseError: the base case in it cannot be read.
    """
    info = result or read_study(folder, HALL, HallResult)
    case = load_case(str(folder / "base.toml"), allow_outside=True)
    weakest = weakest_table(info.ranked, BRIEFLY if brief else html.MOST_ROWS, linked=not brief)
    refused = ([row["name"], str(row["line"]), row["reason"]] for row in info.not_computed)
    refused_table = html.table_of("refused rows", html.in_order("container", "line", "reason"), refused)
    base_case = html.Pairs(case_rows(case), caption="Base case, where a row changes nothing", look="asked")
    motions = html.Group("", [html.Heading("Motions of every container"), html.Bullets(info.motions)])
    start = html.columns(base_case, *([motions] if info.motions else []))
    whole = [
        html.section("What the rows start from", "asked", start),
        html.section("One container by itself", "commands", commands_table(info.ranked)),
    ]
    again = studies.Again(
        words="With the two files of this folder, and the motions:",
        command=command_again(info),
        files=[("base.toml", studies.text_of(folder / "base.toml"))],
    )
    return studies.study_html(
        "a hall",
        info=info,
        title="",
        name=info.hall,
        case=case,
        signature=signature,
        hash=info.asked,
        sections=[
            found_section(info),
            html.section("In plan", "plan", *studies.drawings(folder, [PICTURE], "batch")),
            html.section("By tag", "tags", *([tags_table(info)] if info.tags else [])),
            html.section("The weakest first", "weakest", weakest, html.Note(MARGIN)),
            html.section("Refused rows", "refused", *([refused_table] if info.not_computed else [])),
            *([] if brief else whole),
        ],
        provenance=[("hall", f"{info.hall}, {info.status}, model {info.model}"), ("hash", info.asked)],
        again=None if brief else again,
    )


def command_again(info: HallResult) -> str:
    """The command that computes the hall."""
    words = ["--motion", *info.motions] if info.motions else []
    words += ["--margins", info.checks] * (info.checks != "weakest")
    outside = bool(info.allow_outside)
    return command_line("batch", "list.csv", "--case", "base.toml", *words, allow_outside=outside)


def found_section(info: HallResult) -> html.PageSection:
    """The answer, and what was computed."""
    count = f"{info.extent}{studies.unfinished(info)}."
    if info.checked:
        which = "all" if info.checked == info.distinct else f"the weakest {info.checked}"
        count += f" Sure, deciding inputs and margin are those of {which}, each under its governing motion."
    elif info.state == "finished":
        count += " No run was repeated, so sureness and margins are not known."
    outcomes = ", ".join(f"{word}: {number}" for word, number in info.outcomes.items())
    return studies.answer_section(
        info,
        info.answer,
        count,
        *([f"{outcomes[0].upper()}{outcomes[1:]}."] if outcomes else []),
        note=OF_SEVERAL if len(info.motions) > 1 else "Each container by itself, without neighbours.",
    )


def tags_table(info: HallResult) -> html.Table:
    """What the containers of each tag did."""
    words = dict.fromkeys(word for tag in info.tags for word in sorted(tag["counts"]))
    rows = (
        [
            tag["tag"] or ABSENT,
            str(tag["containers"]),
            *(str(tag["counts"].get(word, "")) for word in words),
            number(tag["margin"], figures=3),
        ]
        for tag in info.tags
    )
    heads = html.in_order("tag", "containers", *words, "least margin", look=html.NUMBER)
    return html.table_of("tags", heads, rows, file="hall.csv")


def weakest_table(rows: Sequence[A_ROW], most: int, *, linked: bool) -> html.Table:
    """A row a container, the weakest first; its name leads to its command."""

    def figure(row: A_ROW, name: str) -> Any:
        fallen = name == TURNED and row["outcome"] == Outcome.OVERTURNED  # how far it fell says nothing
        return None if fallen else row[name]

    def name(row: A_ROW) -> html.Cell:
        return html.Cell(html.link(row["name"], f"row-{row['row']}") if linked else row["name"])

    columns: list[html.Column[A_ROW]] = [
        html.Column("container", name),
        html.key_column("line", "line", html.NUMBER),
        html.key_column("count", "count", html.NUMBER, empty=1),
        html.key_column("tag", "tag"),
        html.Column(
            "outcome", lambda row: row["outcome"] or (f"none: {row['reason']}" if row["reason"] else ABSENT)
        ),
        html.Column("margin", margin_words, html.NUMBER),
        html.key_column("sure", "sure"),
        html.key_column("decided by", "decided_by", text=lambda keys: deciding_in_words(keys.split())),
        *html.figure_columns(figures_of(Place.KEY), value=figure),
        html.key_column(
            "utilisation", "utilisation_overturning", html.NUMBER, text=partial(number, figures=3)
        ),
        html.key_column("motion", "motion"),
        html.key_column("runs overturned", "motions_overturned", html.NUMBER),
        html.key_column("runs not valid", "motions_invalid", html.NUMBER, empty=0),
    ]
    return html.table_of(
        "containers",
        columns,
        rows,
        row_look=lambda row: LOOKS.get(row["outcome"] or "failed", ""),
        file="hall.csv",
        most=most,
    )


def margin_words(row: A_ROW) -> str:
    """A margin with its range: "1.8 (1.5 to 2.1)", "1.8 (from 1.5)" where not all overturn, "> 4"; empty without."""
    margin, tried = row["margin"], row["margin_tried_to"]
    if margin is None:
        return "" if tried is None else f"> {FACTOR.text(tried)}"
    low, high = (FACTOR.text(row[name]) for name in ("margin_low", "margin_high"))
    if not low:
        return FACTOR.text(margin)
    return f"{FACTOR.text(margin)} ({f'{low} to {high}' if high else f'from {low}'})"


def commands_table(rows: Sequence[A_ROW]) -> html.Table:
    """The command that computes each container by itself, under its governing motion."""
    target = Markup('<span id="row-{}">{}</span>')
    columns: list[html.Column[A_ROW]] = [
        html.Column("container", lambda row: html.Cell(target.format(row["row"], row["name"]))),
        html.Column("command", lambda row: html.Cell(html.code(row["command"]))),
    ]
    return html.table_of("commands", columns, rows, file="hall.json")
