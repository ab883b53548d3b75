"""Common parts of the reports of sweeps, ensembles and response curves: answer, drawings, how to repeat them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import escape

from fem.case.case import Case
from fem.html import sections as html
from fem.html.page import Page, Signature, html_of, svg_element
from fem.html.units import short, typeset
from fem.report.comparison import limits_section
from fem.results.errors import FolderError
from fem.runtime.identity import command_line
from fem.study.axes import Axis
from fem.study.driver import COMPLETED, StudyResult

MOST_DRAWING_BYTES = 400_000  #: of a drawing, as SVG


@dataclass(frozen=True, kw_only=True)
class Again:
    """How to repeat a study."""

    words: str
    command: str
    files: Sequence[tuple[str, str]]  #: names and texts of the files that it needs


def study_html(
    kind: str,
    *,
    info: StudyResult,
    title: str,
    name: str,
    case: Case,
    signature: Signature | None,
    sections: Sequence[html.Block],
    provenance: Sequence[tuple[str, str]],
    again: Again | None,
    **content: Any,
) -> str:
    """The page of a study, as the text of an HTML file; it ends with the limits of the case, and how to repeat it.

    Args:
        kind: of study.
        info: its result; an unfinished one is not signed.
        title, name: of the study.
        case: that it starts from.
        signature: author, checker, revision.
        sections: what it shows.
        provenance: names and values of what it was computed from.
        again: how to repeat it; None: a short page, without its end.
        content: further fields of the page.
    """
    end: list[html.Block] = (
        [] if again is None else [limits_section(case), repeat_section(provenance, info, again)]
    )
    return html_of(
        Page(
            kind=f"Report of {kind}",
            title=title or name,
            name=name,
            signature=None if info.no_answer_yet else (signature or Signature()).completed(case.named),
            sections=[*sections, *end],
            **content,
        )
    )


def answer_section(
    info: StudyResult, answer: str | None, count: str, *more: html.Block, note: str
) -> html.PageSection:
    """The answer of a study or what it lacks, how much of it is computed, and how to read it."""
    answer = info.no_answer_yet or answer
    sentence = [html.Paragraph(typeset(f"{answer[0].upper()}{answer[1:]}."), "sentence")] if answer else []
    counted = count if answer else html.Paragraph(count, "sentence")
    look = f"answer {'stood' if info.status == COMPLETED else 'open'}"
    return html.section("Found", "found", *sentence, counted, *more, html.Note(note), look=look)


def unfinished(info: StudyResult) -> str:
    """How a study ended that is not complete; empty of one that is."""
    return "" if info.status == COMPLETED else f" ({info.status})"


def repeat_section(rows: Sequence[tuple[str, str]], info: StudyResult, again: Again) -> html.PageSection:
    """From what a study was computed, and how to compute it again."""
    versions = ", ".join(f"{name} {version}" for name, version in info.versions.items())
    files = [
        block for name, text in again.files for block in (html.Heading(html.code(name)), html.Listing(text))
    ]
    return html.section(
        "Provenance and how to repeat it",
        "provenance",
        html.Pairs([*rows, ("versions", versions)], look="asked"),
        again.words,
        html.Listing(again.command, "command"),
        *files,
    )


def axes_table(axes: Sequence[Axis], derived: Mapping[str, str]) -> html.Table:
    """The axes of a study, and the keys that follow from them."""
    rows = [(axis.key, axis_words(axis), str(len(axis.values))) for axis in axes]
    rows += [(key, escape(f"= {rule}"), "follows") for key, rule in derived.items()]
    columns: list[html.Column[tuple[str, str, str]]] = [
        html.Column("key", lambda row: html.Cell(html.code(row[0]))),
        html.Column("values", lambda row: row[1]),
        html.Column("count", lambda row: row[2], html.NUMBER),
    ]
    return html.table_of("axes", columns, rows, caption="Axes")


def axis_words(axis: Axis) -> str:
    """The values of an axis."""
    first, last = axis.values[0], axis.values[-1]
    if axis.scale in ("linear", "log") and isinstance(first, int | float) and isinstance(last, int | float):
        return f"{short(first)} to {short(last)} {axis.unit}, {axis.scale}".replace(" ,", ",")
    words = ", ".join(str(value) for value in axis.values[:12])
    more = " ..." if len(axis.values) > 12 else ""
    return f"{words}{more} {axis.unit}".rstrip()


def drawings(folder: Path, names: Iterable[str], command: str, *, prefix: str = "drawn") -> list[html.Block]:
    """Drawings that a study has made, for the page; those that are missing, outside or too large are left out.

    Args:
        folder, names: where they are.
        command: that draws them again.
        prefix: of their ids on the page, another one for each list of drawings.

    Raises:
        FolderError: one holds what no drawing does; the command draws it again.
    """
    drawn = []
    for k, name in enumerate(names):
        path = folder / name
        inside = path.resolve().is_relative_to(folder.resolve())
        if not inside or not path.is_file() or path.stat().st_size > MOST_DRAWING_BYTES:
            continue
        text, label = path.read_text(encoding="utf-8"), path.stem.replace("_", " ")
        try:
            drawn.append(
                html.Figure(svg_element(text, label=label, prefix=f"{prefix}{k}"), f"figure: {label}")
            )
        except ValueError as error:
            raise FolderError(
                f"{path}: {error}; remove it and repeat the {command}, which draws it again"
            ) from None
    return [html.Group("drawn" if len(drawn) > 1 else "", drawn)] if drawn else []


def text_of(path: Path) -> str:
    """A text file of a folder; empty where it is missing."""
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def again_from_files(folder: Path, *, study: str, name: str, case: Case) -> Again:
    """How to compute a study again from the files in its folder: its own, and its base case."""
    records = " and the files of its motions" if case.motion.kind == "table" else ""
    return Again(
        words=f'Save the two files below in one folder{records}, with case = "base.toml" in {name}.toml:',
        command=command_line(study, f"{name}.toml"),
        files=[
            (f"{name}.toml", text_of(folder / f"{study}.toml")),
            ("base.toml", text_of(folder / "base.toml")),
        ],
    )
