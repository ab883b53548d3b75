"""What a page is made of: sections and the blocks in them, each set by the macro of its name in `sections.html.j2`.

A text is escaped unless it is `Markup`; a text among blocks is a paragraph. A look is a class of `page.css`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from operator import getitem, itemgetter
from typing import Any, Generic, NamedTuple, TypeVar

from markupsafe import Markup

from fem.html.units import figure_cell, figure_head, typeset
from fem.results.figures import Shown

MOST_ROWS = 1000  #: of a table on a page
NUMBER = "number"  #: look of a column that is aligned to the right

Item = TypeVar("Item")


def code(text: object) -> Markup:
    """A name or command within a text."""
    return Markup("<code>{}</code>").format(text)


def strong(text: object) -> Markup:
    """An emphasised word."""
    return Markup("<strong>{}</strong>").format(text)


def marked(text: object, look: str) -> Markup:
    """Words within a text that have a look of their own."""
    return Markup('<span class="{}">{}</span>').format(look, text)


def link(text: str, name: str) -> Markup:
    """A link to a section of the same page."""
    return Markup('<a href="#{}">{}</a>').format(name, text)


def joined(*parts: object) -> Markup:
    """One text of several, of which some may be `Markup`."""
    return Markup("").join(map(Markup.escape, parts))


@dataclass(frozen=True)
class Paragraph:
    """A paragraph."""

    text: str
    look: str = ""


@dataclass(frozen=True)
class Note:
    """A paragraph in small print."""

    text: str


@dataclass(frozen=True)
class Html:
    """Blocks that a template has set."""

    text: Markup


@dataclass(frozen=True)
class Heading:
    """A heading within a section."""

    text: str
    name: str = ""  #: where it can be linked to


@dataclass(frozen=True)
class Bullets:
    """A list."""

    lines: Sequence[str]
    look: str = "tight"


@dataclass(frozen=True)
class Listing:
    """A file or command, as it is."""

    text: str
    look: str = "case"


@dataclass(frozen=True)
class Pairs:
    """Names and their values."""

    rows: Sequence[tuple[str, str]]
    _: KW_ONLY
    caption: str = ""
    look: str = ""


class Headline(NamedTuple):
    """A value that is to be seen first."""

    name: str
    value: str
    below: str = ""  #: in small print


@dataclass(frozen=True)
class Headlines:
    """The values to be seen first, side by side."""

    values: Sequence[Headline]


class Cell(NamedTuple):
    """A cell of a table."""

    text: str
    look: str = ""
    span: int = 1  #: columns


@dataclass(frozen=True)
class TableRow:
    """A row of a table; the first cell names it."""

    cells: Sequence[Cell]
    look: str = ""


@dataclass(frozen=True)
class Table:
    """A table, which scrolls sideways where it is too wide."""

    label: str  #: for screen readers
    head: Sequence[Cell]
    rows: Sequence[TableRow]
    _: KW_ONLY
    caption: str = ""
    look: str = ""
    left_out: str = ""  #: what the table does not show


#: what an item shows in a column
CellOf = Callable[[Item], str]


@dataclass(frozen=True)
class Column(Generic[Item]):
    """A column of a table that is made from items."""

    head: str
    cell: Callable[[Item], str | Cell]  #: what an item shows in it
    look: str = ""
    optional: bool = False  #: left out where it is empty in every row


def in_order(*heads: str, look: str = "") -> list[Column[Sequence[str]]]:
    """Columns of items that are the texts of a row."""
    return [Column(head, itemgetter(k), look if k else "") for k, head in enumerate(heads)]


def key_column(
    head: str, key: str, look: str = "", *, empty: object = None, text: Callable[[Any], str] = str
) -> Column[Mapping[str, Any]]:
    """A column of a key of rows, left out where it says nothing: where each is None, or `empty`."""

    def cell(row: Mapping[str, Any]) -> str:
        return "" if row[key] in (None, empty) else text(row[key])

    return Column(head, cell, look, optional=True)


def figure_columns(
    figures: Mapping[str, Shown],
    *,
    text: Callable[[Shown, Any], str] = figure_cell,
    value: Callable[[Any, str], Any] = getitem,
) -> list[Column[Any]]:
    """Columns of declared figures.

    Args:
        figures: how each is shown, by key.
        text: of a value, without its unit.
        value: that of an item by the key.
    """

    def column(key: str, figure: Shown) -> Column[Any]:
        return Column(figure_head(figure), lambda item: text(figure, value(item, key)), NUMBER)

    return [column(key, figure) for key, figure in figures.items()]


def table_of(
    label: str,
    columns: Sequence[Column[Item]],
    items: Iterable[Item],
    *,
    row_look: Callable[[Item], str] = lambda item: "",
    file: str = "",
    most: int = MOST_ROWS,
    **options: Any,
) -> Table:
    """A table with a row for each item, cut to the rows that a page can carry.

    Args:
        label: for screen readers.
        columns: of the table; the first names its rows.
        items: what the rows are about.
        row_look: the look of a row.
        file: holds all rows.
        most: rows.
        options: of the table.
    """
    listed = list(items)
    rows = [
        ([_cell(column.cell(item), column.look) for column in columns], row_look(item)) for item in listed
    ]
    visible = [
        k
        for k, column in enumerate(columns)
        if not column.optional or any(cells[k].text for cells, _ in rows)
    ]
    more = len(listed) - most
    return Table(
        label,
        [Cell(columns[k].head, columns[k].look) for k in visible],
        [TableRow([cells[k] for k in visible], look) for cells, look in rows[:most]],
        left_out=f"{more} more rows are in {file}." if more > 0 else "",
        **options,
    )


def _cell(content: str | Cell, look: str) -> Cell:
    cell = content if isinstance(content, Cell) else Cell(content, look)
    return cell if isinstance(cell.text, Markup) else cell._replace(text=typeset(cell.text))


@dataclass(frozen=True)
class Figure:
    """A drawing; with a label in a box that scrolls."""

    svg: Markup
    label: str = ""  #: for screen readers
    _: KW_ONLY
    caption: str = ""


@dataclass(frozen=True)
class Group:
    """Blocks that stand together: side by side with the look `columns`."""

    look: str
    blocks: Sequence["Block"]


@dataclass(frozen=True)
class Folded:
    """Blocks folded behind a line, which opens them."""

    summary: str
    blocks: Sequence["Block"]
    open: bool = False


@dataclass(frozen=True)
class PageSection:
    """A part of a page with a heading that can be linked to; without blocks it is left out."""

    title: str
    name: str  #: of the heading
    blocks: Sequence["Block"]
    look: str = ""


def section(title: str, name: str, *blocks: "Block", look: str = "") -> PageSection:
    """A section of these blocks."""
    return PageSection(title, name, blocks, look)


def columns(*blocks: "Block") -> Group:
    """Blocks side by side."""
    return Group("columns", blocks)


class Choice(NamedTuple):
    """An entry of a menu."""

    value: Any
    text: str
    chosen: bool = False


@dataclass(frozen=True)
class CellMap:
    """The map of a sweep, which `map.js` draws."""

    quantities: Sequence[Choice]
    across: Sequence[Choice]
    up: Sequence[Choice] = ()


#: a macro of `sections.html.j2` for each
@dataclass(frozen=True)
class Written:
    """Sections that a template of their own writes."""

    template: str  #: its file
    values: Mapping[str, Any]  #: what it shows


Block = (
    str
    | Paragraph
    | Note
    | Html
    | Heading
    | Bullets
    | Listing
    | Pairs
    | Headlines
    | Table
    | Figure
    | Group
    | Folded
    | PageSection
    | CellMap
    | Written
)
