"""Read the list of a hall: one row a container, under a header of keys of a case.

What is wrong with the list as a whole is an error; what is wrong with a row is its reason.
"""

import difflib
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import Any, get_args

from fem.case.overrides import parse_override
from fem.case.tables.all_tables import TABLES
from fem.case.validation import CaseError, known_keys, quantity_of
from fem.records.source import decoded
from fem.records.table import TableLine, UserTable, number_in
from fem.results.figures import RUN_COLUMNS, SLIPPED, TURNED
from fem.runtime.terminal import one_line
from fem.runtime.user_files import read_regular
from fem.study.axes import NAMED, NO_AXIS, AxisError, field_of
from fem.study.driver import StudyResult
from fem.study.runner import CHECKED
from fem.study.table import Columns, line_of, plain_text

REFUSED = "refused"  #: status of a row that cannot be computed
#: columns of a run, as in its log
OF_A_RUN = {"status": str} | RUN_COLUMNS | {"reason": str}
STATIC = dict.fromkeys(("utilisation_sliding", "utilisation_overturning"), float)
#: of a container under several motions
OF_MOTIONS: Columns = {"motion": str}
OF_MOTIONS |= dict.fromkeys(("motions_overturned", "motions_invalid", "motions_failed"), int)
OF_MOTIONS |= {"largest_slip_m": float, "largest_slip_motion": str}
COLUMNS = OF_A_RUN | CHECKED | STATIC | OF_MOTIONS | {"rank": int, "side": str}
FIRST = ("status", "reason", "outcome", *[*CHECKED][:3], TURNED, SLIPPED, "tilt_rad")
#: behind the columns of the list
#: of a row of the list
ROW_COLUMNS = {"row": int, "line": int, "name": str, "count": int, "tag": str, "command": str}
RESULT_COLUMNS = {name: COLUMNS[name] for name in (*FIRST, *STATIC, *OF_MOTIONS, *CHECKED, *COLUMNS)}
TYPED = {
    "table": RESULT_COLUMNS | ROW_COLUMNS,
    "tags": {"tag": str, "containers": int, "margin": float},
}


@dataclass(frozen=True, kw_only=True)
class HallResult(StudyResult):
    """All results of a hall."""

    written_where_given = StudyResult.written_where_given | {"allow_outside", "one_side"}
    columns_of = TYPED
    hall: str
    case: str
    asked: str  #: hash of what is computed
    listed: str = ""  #: hash of the list
    model: str
    motions: tuple[str, ...] = ()  #: files, of pairs both, as they were named; empty: the motion of the case
    motion_covered: str | None = None
    rows: int  #: of the list
    containers: int  #: rows times their counts
    distinct: int  #: containers that were computed
    refused: int = 0  #: rows
    runs: int = 0
    checks: str = "weakest"  #: which runs are repeated: weakest | all | none
    checked: int = 0  #: containers whose run was repeated
    one_side: bool | None = None  #: whether only the width was looked at
    #: of containers, by count
    outcomes: dict[str, int] = field(default_factory=dict)
    #: what the containers of each tag did: stood, overturned, invalid, failed, refused
    tags: tuple[dict[str, Any], ...] = ()
    kept: tuple[str, ...] = ()  #: columns of the list that set nothing
    columns: tuple[str, ...] = ()  #: of the list
    allow_outside: bool | None = None  #: files of the case may lie outside its folder
    table: tuple[dict[str, Any], ...] = ()  #: rows of `hall.csv`, with `row`, `name`, `count`, `command`

    @property
    def extent(self) -> str:
        """How much there is of it, in words."""
        under = f" under {len(self.motions)} motions" if len(self.motions) > 1 else ""
        return f"{self.rows} rows, {self.containers} containers, {self.distinct} that differ{under}: {self.runs} runs"

    @property
    def ranked(self) -> list[dict[str, Any]]:
        """The rows that were computed, the weakest first."""
        return sorted((row for row in self.table if row["rank"]), key=lambda row: (row["rank"], row["row"]))

    @property
    def not_computed(self) -> list[dict[str, Any]]:
        """The rows that were refused."""
        return [row for row in self.table if row["status"] == REFUSED]


DIGITS = 4  #: of a figure in the list; `hall.json` has all
LARGEST_FILE = 512 * 2**20  #: [bytes]
#: tables whose keys a column may name without the table
PLAIN_TABLES = ("container", "contact", "support", "floor")
NAME, COUNT, TAG = "name", "count", "tag"
OWN = (NAME, COUNT, TAG)
#: a unit at the end of a name, as people write it
UNIT = re.compile(r"[ _]*[\[(]?\b(mm|cm|m|kg|t|g|kn|n|mpa|gpa|pa|rad|deg|s|hz)\b[\])]?$", re.IGNORECASE)
LIKE = 0.8  #: likeness from which an unknown name is taken for a slip
OTHER_NAMES = {"mu": "mu_static", "friction_coefficient": "mu_static"}
LARGEST_COUNT = 10**9
#: of a row, what the result says of it
LISTED = ("line", "name", "count", "tag", "given")
A_HEADER = "the first line must name the columns, such as name;width_m;height_m;mass_kg;mu_static"


@dataclass(frozen=True, kw_only=True)
class HallRow:
    """A row of the list."""

    line: int  #: of the file, where it ends
    name: str
    count: int
    tag: str
    given: Mapping[str, str]  #: its fields by column
    values: Mapping[str, Any]  #: of the dotted keys that it sets
    reason: str  #: why it cannot be used; empty: it can
    across: Mapping[str, Any] = field(default_factory=dict)  #: keys that turn it; none: no narrower side
    container: int | None = None  #: its number among those that differ, once the row is checked


@dataclass(frozen=True, kw_only=True)
class HallFile:
    """A list as it was read."""

    path: Path
    table: UserTable
    header: Sequence[str]  #: names of all columns; empty for a column without
    #: of the columns that are read: a dotted key, a name of `OWN`; empty: it is kept
    meanings: Mapping[str, str]

    @property
    def name(self) -> str:
        """File stem."""
        return self.path.stem

    @property
    def keys(self) -> list[str]:
        """The dotted keys that columns name."""
        return [meaning for meaning in self.meanings.values() if meaning and meaning not in OWN]

    @cached_property
    def decimal_mark(self) -> str:
        """Of its numbers, a point or a comma; CaseError for both."""
        numeric = [column for column, meaning in self.meanings.items() if meaning not in ("", NAME, TAG)]
        return self.table.require_one_decimal_mark(self.header.index(column) for column in numeric)

    def with_results(self, rows: Iterable[Iterable[Any]]) -> str:
        """The list with its results behind it, in its own separator and decimal mark, figures with four digits."""
        separator, comma = self.table.separator, self.decimal_mark == ","
        if (
            separator == "," and comma
        ):  # quoted fields in the list, which most programs would not read as numbers
            separator = ";"
        lines = ([*self.meanings, *RESULT_COLUMNS], *rows)
        stated = f"sep={separator}\n" * (separator not in ",;\t")
        return stated + "".join(
            f"{line_of(line, separator=separator, comma=comma, digits=DIGITS)}\n" for line in lines
        )

    @cached_property
    def rows(self) -> tuple[HallRow, ...]:
        """A row for each line; CaseError for none, values below no name, decimal commas and points."""
        if not self.table.lines:
            raise CaseError(f"{self.path}: the list has a header and no rows; give one row a container")
        self.table.require_names()
        _ = self.decimal_mark
        places = {column: self.header.index(column) for column in self.meanings}
        named = [k for k, name in enumerate(self.header) if name]
        return tuple(
            self._row(number, line, places, named) for number, line in enumerate(self.table.lines, start=1)
        )

    def _row(self, number: int, line: TableLine, places: Mapping[str, int], named: Sequence[int]) -> HallRow:
        given = {column: one_line(plain_text(line.field(index))) for column, index in places.items()}
        texts = dict(zip(self.meanings.values(), given.values(), strict=True))
        count, reason = number_in(texts.get(COUNT) or "1") or 0.0, ""
        if not (count.is_integer() and 1.0 <= count <= LARGEST_COUNT):
            count, reason = 1.0, f"count must be a whole number of at least 1, got {texts[COUNT]!r}"
        whole = len(line.fields) > named[-1] and not any(line.fields[len(self.header) :])
        if not whole:
            reason = f"{len(line.fields)} fields, and the header names {len(named)} columns"
        return HallRow(
            line=line.number,
            name=texts.get(NAME) or str(number),
            count=int(count),
            tag=texts.get(TAG, ""),
            given=given,
            values={key: _value(key, texts[key]) for key in self.keys if whole and texts[key]},
            reason=reason,
        )


def read_hall(path: Path) -> HallFile:
    """Read a list; its rows are read on first use. CaseError for what is no list, or a column that cannot be one."""
    try:
        text = decoded(read_regular(path, LARGEST_FILE))
    except ValueError as error:
        raise CaseError(f"{path} {error}; a list of containers is needed") from None
    if text is None or "\0" in text:
        raise CaseError(f"{path}: not a text file; save the list as CSV")
    table = UserTable(str(path), text, CaseError)
    names = [one_line(plain_text(name)) for name in table.header]
    if not names:
        raise CaseError(f"{path}: the list is empty; {A_HEADER}")
    if not any(name.lower() in _plain_names() or name.partition(".")[0] in NAMED for name in names):
        raise CaseError(f"{path}: line 1 names no key of a case, so there is no header; {A_HEADER}")
    is_result = {"status", "outcome", TURNED} <= {*names}  # an earlier one, given as a list again
    read = [name for name in names if name and not (is_result and name in RESULT_COLUMNS)]
    return HallFile(path=path, table=table, header=names, meanings=_meanings_of(path, read))


def _meanings_of(path: Path, columns: Sequence[str]) -> dict[str, str]:
    """What each column means; CaseError with every problem of the header."""
    problems, meanings = [], dict[str, str]()
    for column, count in Counter(columns).items():
        if count > 1:
            problems.append(f"column {column!r} occurs {count} times; keep one")
        elif column in RESULT_COLUMNS:
            problems.append(f"column {column!r} has the name of a result; rename it")
        else:
            try:
                meanings[column] = _meaning(column)
            except AxisError as error:
                problems.append(f"column {column!r} {error}")
    for meaning, count in Counter(filter(None, meanings.values())).items():
        if count > 1:
            same = [repr(column) for column in columns if meanings.get(column) == meaning]
            problems.append(f"columns {' and '.join(same)} both set {meaning!r}; keep one")
    if problems:
        raise CaseError("\n".join(f"{path}: {problem}" for problem in problems))
    return meanings


def _meaning(column: str) -> str:
    """What a column means: a dotted key, or a name of `OWN`; empty for one that is kept as it is.

    AxisError for one that looks like a key and is none, or may be several.
    """
    table, dot, _ = column.partition(".")
    if dot and difflib.get_close_matches(table.lower(), NAMED, n=1, cutoff=LIKE):
        field_of(column)
        return "" if column in NO_AXIS or table == "document" else column
    meant = _plain_names().get(column.lower(), [])
    if len(meant) > 1:
        raise AxisError(f"may be {' or '.join(meant)}; write one of them")
    if not meant and (near := _nearest_name(column)):
        raise AxisError(
            f"is no key of a case; did you mean {near!r}? To keep it as a note, rename it, for instance to "
            f"'note {column}'"
        )
    return meant[0] if meant else ""


@cache
def _plain_names() -> dict[str, list[str]]:
    """What a name without a table, in small letters, may mean: dotted keys, or itself."""
    names = {name: [name] for name in (*OWN, "gravity_m_s2")}
    for table in PLAIN_TABLES:
        for key in known_keys(TABLES[table]):
            if key != "box":  # a table
                names.setdefault(key.lower(), []).append(f"{table}.{key}")
    return names


def _nearest_name(column: str) -> str:
    """The known name that an unknown one was meant for: without its unit the same, or very like it; else empty."""

    def stem(name: str) -> str:
        return UNIT.sub("", name.lower().replace(" ", "_").replace("-", "_")).strip("_ ")

    names = [key.rpartition(".")[2] for meant in _plain_names().values() for key in meant]
    stems = {stem(name): name for name in names} | OTHER_NAMES
    near = difflib.get_close_matches(stem(column), stems, n=1, cutoff=LIKE) if len(stem(column)) > 1 else []
    return stems[near[0]] if near else ""


def _value(key: str, text: str) -> Any:
    """A field as a case file would give it: a number, true or false, a list, else text."""
    field, number = field_of(key), number_in(text)
    whole = int in (field.annotation, *get_args(field.annotation))
    if number is not None and (whole or quantity_of(field.annotation, field.metadata)):
        return int(number) if whole and number.is_integer() else number
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    return parse_override(f"{key}={text}")[1] if text[0] == "[" else plain_text(text)
