"""A list of containers as it is read: what its columns mean, and the keys that each row sets.

What is wrong with the list as a whole is an error; what is wrong with a row is its reason.
"""

import difflib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import Any, get_args

from fem.case.files import kind_of, other_kind
from fem.case.overrides import parse_override
from fem.case.tables.all_tables import TABLES
from fem.case.validation import CaseError, known_keys, quantity_of, told_as
from fem.records.source import decoded
from fem.records.table import UserTable, number_in
from fem.results.figures import TURNED
from fem.runtime.terminal import one_line
from fem.runtime.user_files import read_regular
from fem.study.axes import NAMED, NO_AXIS, AxisError, field_of
from fem.study.hall_result import RESULT_COLUMNS
from fem.study.table import plain_text

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
        return self.table.require_one_decimal_mark(map(self.header.index, numeric))

    @cached_property
    def rows(self) -> tuple[HallRow, ...]:
        """A row for each line; CaseError for none, values below no name, decimal commas and points."""
        if not self.table.lines:
            raise CaseError(f"{self.path}: the list has a header and no rows; give one row a container")
        self.table.require_names()
        _ = self.decimal_mark
        places = {column: self.header.index(column) for column in self.meanings}
        named, rows = [k for k, name in enumerate(self.header) if name], []
        for number, line in enumerate(self.table.lines, start=1):
            given = {column: one_line(plain_text(line.field(k))) for column, k in places.items()}
            texts = dict(zip(self.meanings.values(), given.values(), strict=True))
            count, reason = number_in(texts.get(COUNT) or "1") or 0.0, ""
            if not (count.is_integer() and 1.0 <= count <= LARGEST_COUNT):
                count, reason = 1.0, f"count must be a whole number of at least 1, got {texts[COUNT]!r}"
            whole = len(line.fields) > named[-1] and not any(line.fields[len(self.header) :])
            if not whole:
                reason = f"{len(line.fields)} fields, and the header names {len(named)} columns"
            values = {key: _value(key, texts[key]) for key in self.keys if whole and texts[key]}
            name, tag = texts.get(NAME) or str(number), texts.get(TAG, "")
            own: dict[str, Any] = {"line": line.number, "name": name, "count": int(count), "tag": tag}
            rows.append(HallRow(**own, given=given, values=values, reason=reason))
        return tuple(rows)


def read_hall(path: Path) -> HallFile:
    """Read a list; its rows are read on first use. CaseError for what is no list, or a column that cannot be one."""
    if (kind := kind_of(path)) not in ("", "list"):
        raise CaseError(other_kind(path, kind))
    with told_as(f"{path} ", "; a list of containers is needed"):
        text = decoded(read_regular(path, LARGEST_FILE))
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
    problems, meanings = [], dict[str, str]()
    plain = [key.rpartition(".")[2] for known in _plain_names().values() for key in known]
    stems = {_stem(name): name for name in plain} | OTHER_NAMES
    for column, count in Counter(read).items():
        try:
            if count > 1:
                raise AxisError(f"occurs {count} times; keep one")
            if column in RESULT_COLUMNS:
                raise AxisError("has the name of a result; rename it")
            meanings[column] = _meaning(column, stems)
        except AxisError as error:
            problems.append(f"column {column!r} {error}")
    for meaning, count in Counter(filter(None, meanings.values())).items():
        if count > 1:
            same = [repr(column) for column in read if meanings.get(column) == meaning]
            problems.append(f"columns {' and '.join(same)} both set {meaning!r}; keep one")
    if problems:
        raise CaseError("\n".join(f"{path}: {problem}" for problem in problems))
    return HallFile(path=path, table=table, header=names, meanings=meanings)


def _stem(name: str) -> str:
    return UNIT.sub("", name.lower().replace(" ", "_").replace("-", "_")).strip("_ ")


def _meaning(column: str, stems: Mapping[str, str]) -> str:
    """What a column means: a dotted key, or a name of `OWN`; empty for one that is kept as it is.

    AxisError for one that looks like a key and is none, or may be several. `stems`: known names, by their stems.
    """
    table, dot, _ = column.partition(".")
    if dot and difflib.get_close_matches(table.lower(), NAMED, n=1, cutoff=LIKE):
        field_of(column)
        return "" if column in NO_AXIS or table == "document" else column
    meant = _plain_names().get(column.lower(), [])
    if len(meant) > 1:
        raise AxisError(f"may be {' or '.join(meant)}; write one of them")
    if meant:
        return meant[0]
    own = _stem(column)  # without its unit the same as a known name, or very like it
    near = difflib.get_close_matches(own, stems, n=1, cutoff=LIKE) if len(own) > 1 else []
    if near:
        raise AxisError(
            f"is no key of a case; did you mean {stems[near[0]]!r}? To keep it as a note, rename it, for instance to "
            f"'note {column}'"
        )
    return ""


@cache
def _plain_names() -> dict[str, list[str]]:
    """What a name without a table, in small letters, may mean: dotted keys, or itself."""
    names = {name: [name] for name in (*OWN, "gravity_m_s2")}
    for table in PLAIN_TABLES:
        for key in known_keys(TABLES[table]):
            if key != "box":  # a table
                names.setdefault(key.lower(), []).append(f"{table}.{key}")
    return names


def _value(key: str, text: str) -> Any:
    """A field as a case file would give it: a number, true or false, a list, else text."""
    field, number = field_of(key), number_in(text)
    whole = int in (field.annotation, *get_args(field.annotation))
    if number is not None and (whole or quantity_of(field.annotation, field.metadata)):
        return int(number) if whole and number.is_integer() else number
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    return parse_override(f"{key}={text}")[1] if text[0] == "[" else plain_text(text)
