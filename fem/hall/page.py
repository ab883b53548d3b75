"""The page of a hall: what the containers did, the weakest first, by tag, and the command of each."""

import shlex
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fem.batch.study import read_study
from fem.case.case import Case, load_case
from fem.case.unknown_inputs import WORDS
from fem.hall.places import PICTURE
from fem.hall.result import HallResult
from fem.hall.table import NO_ANSWER
from fem.html import sections as html
from fem.html.page import Signature
from fem.html.units import ABSENT, number
from fem.report import studies
from fem.report.comparison import case_rows, limits_section
from fem.results.figures import TURNED, Place, figures_of
from fem.results.kinds import HALL
from fem.results.outcome import Outcome

BRIEFLY = 30  #: containers on the short page
MOST_INPUTS = 3  #: of those that decide
LOOKS = {"overturned": "bad", "invalid": "bad", "failed": "bad"}
MARGIN = (
    "Margin: the factor on the whole motion of the run from which it overturns, with the range that all unknown inputs "
    "together give it. Utilisation: of the static rule for overturning, under the peak of the motion."
)
AT_SITE = (
    "By the rule of each page, to which the answers lead: rotation and slip that count, and as margin the least of the "
    "factors tried on the motions at which the rule fails. The outcome is that of the run that governs."
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
    ranked, refused = info.ranked, info.not_computed
    table = weakest_table(ranked, BRIEFLY if brief else html.MOST_ROWS, linked=not brief)
    sections = [
        found_section(info),
        html.section("In plan", "plan", *studies.drawings(folder, [PICTURE], "batch")),
        html.section("By tag", "tags", *([tags_table(info)] if info.tags else [])),
        html.section("The weakest first", "weakest", table, html.Note(AT_SITE if info.site else MARGIN)),
        html.section("Refused rows", "refused", *([refused_table(refused)] if refused else [])),
    ]
    if not brief:
        sections += [
            start_section(info, case),
            html.section("One container by itself", "commands", commands_table(ranked)),
            limits_section(case),
            repeat_section(info, folder),
        ]
    return studies.study_html(
        "a hall",
        info=info,
        title="",
        name=info.hall,
        case=case,
        signature=signature,
        hash=info.asked,
        sections=sections,
    )


def start_section(info: HallResult, case: Case) -> html.PageSection:
    """The base case, and the motions of all containers."""
    base_case = html.Pairs(case_rows(case), caption="Base case, where a row changes nothing", look="asked")
    motions = html.Group("", [html.Heading("Motions of every container"), html.Bullets(info.motions)])
    both = html.columns(base_case, *([motions] if info.motions else []))
    return html.section("What the rows start from", "asked", both)


def repeat_section(info: HallResult, folder: Path) -> html.PageSection:
    """From what the hall was computed, and how to compute it again."""
    return studies.repeat_section(
        [("hall", f"{info.hall}, {info.status}, model {info.model}"), ("hash", info.asked)],
        info,
        studies.Again(
            words="With the two files of this folder, and the motions or the site:",
            command=again(info),
            files=[("base.toml", studies.text_of(folder / "base.toml"))],
        ),
    )


def again(info: HallResult) -> str:
    """The command that computes the hall."""
    words = ["python", "-m", "fem", "batch", "list.csv", "--case", "base.toml"]
    words += ["--motion", *info.motions] if info.motions else ["--site", info.site] if info.site else []
    words += ["--margins", info.checks] * (info.checks != "weakest")
    return shlex.join([*words, *["--allow-outside"] * bool(info.allow_outside)])


def found_section(info: HallResult) -> html.PageSection:
    """The answer, and what was computed."""
    under = f" under {len(info.motions)} motions" if len(info.motions) > 1 else ""
    extent = f"verified at {info.site}" if info.site else f"{info.runs} runs"
    count = f"{info.rows} rows, {info.containers} containers, {info.distinct} that differ{under}: "
    count += f"{extent}{studies.unfinished(info)}."
    if info.checked:
        which = "all" if info.checked == info.distinct else f"the weakest {info.checked}"
        count += f" Sure, deciding inputs and margin are those of {which}, each under its governing motion."
    elif not info.site and info.state == "finished":
        count += " No run was repeated, so sureness and margins are not known."
    outcomes = ", ".join(f"{word}: {number}" for word, number in info.outcomes.items())
    return studies.answer_section(
        info,
        info.answer,
        count,
        *([f"{outcomes[0].upper()}{outcomes[1:]}."] if outcomes else []),
        note=OF_SEVERAL if under else "Each container by itself, without neighbours.",
    )


def tags_table(info: HallResult) -> html.Table:
    """What the containers of each tag did."""

    def count(word: str, tag: A_ROW) -> str:
        return str(tag["counts"].get(word, ""))

    words = dict.fromkeys(word for tag in info.tags for word in sorted(tag["counts"]))
    columns: list[html.Column[A_ROW]] = [
        html.Column("tag", lambda tag: tag["tag"] or ABSENT),
        html.Column("containers", lambda tag: str(tag["containers"]), html.NUMBER),
        *(html.Column(word, partial(count, word), html.NUMBER) for word in words),
        html.Column("least margin", lambda tag: number(tag["margin"], figures=3), html.NUMBER),
    ]
    return html.table_of("tags", columns, info.tags, file="hall.csv")


def weakest_table(rows: Sequence[A_ROW], most: int, *, linked: bool) -> html.Table:
    """A row a container, the weakest first; its name leads to its command."""

    def column(head: str, key: str, empty: object = None, look: str = "") -> html.Column[A_ROW]:
        """A column of a field, which is left out where it is empty in every row."""
        return html.Column(
            head, lambda row: "" if row[key] in (None, empty) else str(row[key]), look, optional=True
        )

    def figure(row: A_ROW, name: str) -> Any:
        fallen = name == TURNED and row["outcome"] == Outcome.OVERTURNED  # how far it fell says nothing
        return None if fallen else row[name]

    def name(row: A_ROW) -> html.Cell:
        return html.Cell(html.link(row["name"], f"row-{row['row']}") if linked else row["name"])

    columns: list[html.Column[A_ROW]] = [
        html.Column("container", name),
        column("line", "line", look=html.NUMBER),
        column("count", "count", 1, html.NUMBER),
        column("tag", "tag"),
        html.Column("answer", _answer, optional=True),
        html.Column("outcome", _outcome),
        html.Column("margin", margin_words, html.NUMBER),
        column("sure", "sure"),
        html.Column("decided by", _deciding, optional=True),
        *html.figure_columns(figures_of(Place.KEY), value=figure),
        html.Column("utilisation", _utilisation, html.NUMBER, optional=True),
        column("motion", "motion"),
        column("runs overturned", "motions_overturned", look=html.NUMBER),
        column("runs not valid", "motions_invalid", 0, html.NUMBER),
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
    margin, low, high = row["margin"], row["margin_low"], row["margin_high"]
    if margin is None:
        tried = row["margin_tried_to"]
        return "" if tried is None else f"> {number(tried, figures=3)}"
    words = number(margin, figures=3)
    if low is None:
        return words
    least = number(low, figures=2)
    return f"{words} (from {least})" if high is None else f"{words} ({least} to {number(high, figures=2)})"


def refused_table(rows: Sequence[A_ROW]) -> html.Table:
    """The rows that were not computed, and why."""
    texts = ([row["name"], str(row["line"]), row["reason"]] for row in rows)
    return html.table_of("refused rows", html.in_order("container", "line", "reason"), texts)


def commands_table(rows: Sequence[A_ROW]) -> html.Table:
    """The command that computes each container by itself, under its governing motion."""
    target = Markup('<span id="row-{}">{}</span>')
    columns: list[html.Column[A_ROW]] = [
        html.Column("container", lambda row: html.Cell(target.format(row["row"], row["name"]))),
        html.Column("command", lambda row: html.Cell(html.code(row["command"]))),
    ]
    return html.table_of("commands", columns, rows, file="hall.json")


def _deciding(row: A_ROW) -> str:
    named = [WORDS.get(key, key) for key in (row["decided_by"] or "").split()]
    more = len(named) - MOST_INPUTS
    return ", ".join(named[:MOST_INPUTS]) + (f" and {more} more" if more > 0 else "")


def _outcome(row: A_ROW) -> str:
    return row["outcome"] or (f"none: {row['reason']}" if row["reason"] else ABSENT)


def _answer(row: A_ROW) -> html.Cell:
    words = row["answer"] or (NO_ANSWER if row["reasons"] else "")
    return html.Cell(Markup('<a href="{}">{}</a>').format(row["page"], words) if row["page"] else words)


def _utilisation(row: A_ROW) -> str:
    use = row["utilisation_overturning"]
    return "" if use is None else number(use, figures=3)
