"""Common parts of the reports of sweeps, ensembles and response curves: tables, drawings, how to repeat them."""

import datetime as dt
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fem.batch.axes import Axis
from fem.case.case import Case
from fem.html.page import Signature, render_page, svg_element
from fem.html.units import short, typeset
from fem.report.comparison import asked_rows, assumptions, exclusions
from fem.results.errors import FolderError

MOST_DRAWING_BYTES = 400_000  #: of a drawing, as SVG
MOST_ROWS = 1000  #: of a table on a page


@dataclass(frozen=True, kw_only=True)
class PageTable:
    """A table on a page; the first column names its rows."""

    label: str  #: for those who cannot see it
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    numbers: frozenset[int] = frozenset()  #: columns that are aligned to the right
    left_out: str = ""  #: what the table does not show


@dataclass(frozen=True, kw_only=True)
class Again:
    """How to repeat a study."""

    words: str
    command: str
    files: Sequence[tuple[str, str]]  #: names and texts of the files that it needs


def page_table(
    label: str,
    columns: Mapping[str, bool],
    rows: Iterable[Sequence[str]],
    *,
    caption: str = "",
    file: str = "",
    optional: frozenset[str] = frozenset(),
) -> PageTable:
    """A table, cut to the rows that a page can carry.

    Args:
        label: for those who cannot see it.
        columns: heads, and whether they are over numbers.
        rows: a text for each column.
        caption: above it.
        file: holds all rows.
        optional: columns that are left out where they are empty in every row.
    """
    listed = [list(row) for row in rows]
    heads = list(columns)
    kept = [k for k, head in enumerate(heads) if head not in optional or any(row[k] for row in listed)]
    more = len(listed) - MOST_ROWS
    return PageTable(
        label=label,
        head=[heads[k] for k in kept],
        rows=[[typeset(row[k]) for k in kept] for row in listed[:MOST_ROWS]],
        caption=caption,
        numbers=frozenset(place for place, k in enumerate(kept) if columns[heads[k]]),
        left_out=f"{more} more rows are in {file}." if more > 0 else "",
    )


def study_page(
    template: str,
    *,
    info: Mapping[str, Any],
    case: Case,
    signature: Signature | None,
    answer: str | None,
    scripts: Sequence[str] = (),
    data: Mapping[str, Any] | None = None,
    **content: Any,
) -> str:
    """The page of a study, as the text of an HTML file.

    Args:
        template: its file name.
        info: the content of the file that marks the study's folder.
        case: that it starts from.
        signature: author, checker, revision.
        answer: the sentence that comes first; None where there is none.
        scripts, data: as `render_page`, beside the script of the signature.
        content: further variables of the template.
    """
    return render_page(
        template,
        scripts=[*scripts, "signature.js"],
        data=data,
        info=info,
        case=case,
        signature=(signature or Signature()).completed(case.named),
        answer=typeset(answer[0].upper() + answer[1:]) if answer else None,
        asked=asked_rows(case),
        assumptions=assumptions(case),
        exclusions=exclusions(case),
        version=metadata.version("unanchored"),
        today=dt.date.today().isoformat(),
        **content,
    )


def axis_row(axis: Axis) -> tuple[str, str, str]:
    """Key, values and their number."""
    first, last = axis.values[0], axis.values[-1]
    if axis.scale in ("linear", "log") and isinstance(first, int | float) and isinstance(last, int | float):
        words = f"{short(first)} to {short(last)} {axis.unit}, {axis.scale}".replace(" ,", ",")
    else:
        words = ", ".join(str(value) for value in axis.values[:12]) + (
            " ..." if len(axis.values) > 12 else ""
        )
        words += f" {axis.unit}" if axis.unit else ""
    return axis.key, typeset(words), str(len(axis.values))


def drawings(folder: Path, names: Iterable[str], command: str, *, prefix: str = "drawn") -> list[Markup]:
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
        text = path.read_text(encoding="utf-8")
        try:
            drawn.append(svg_element(text, label=path.stem.replace("_", " "), prefix=f"{prefix}{k}"))
        except ValueError as error:
            raise FolderError(
                f"{path}: {error}; remove it and repeat the {command}, which draws it again"
            ) from None
    return drawn


def text_of(path: Path) -> str:
    """A text file of a folder; empty where it is missing."""
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def again_from_files(folder: Path, *, study: str, name: str, case: Case) -> Again:
    """How to compute a study again from the files in its folder: its own, and its base case."""
    records = " and the files of its motions" if case.motion.kind == "table" else ""
    return Again(
        words=f'Save the two files below in one folder{records}, with case = "base.toml" in {name}.toml:',
        command=f"python -m fem {study} {shlex.quote(name + '.toml')}",
        files=[
            (f"{name}.toml", text_of(folder / f"{study}.toml")),
            ("base.toml", text_of(folder / "base.toml")),
        ],
    )
