"""Columns of numbers: values with a sampling interval; time and value; or time and the components of one recording.

Columns are separated by semicolons, tabs, commas or blanks; decimals by points, or by commas where these do not
separate. Fields may be quoted, and separators may end a line, as spreadsheets write them. `#`, `%` and `//` begin a
comment. Lines before the first number, comments too, are a header: what it says of units, names, directions, number,
interval and peak of the samples must agree with what is read and given.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from fem.records.record import SAME_TIME, Component, Direction, Record
from fem.records.source import BLOCK, LARGEST_NUMBER, NUMBER, MotionText, as_numbers, require_interval
from fem.records.table import fields_in, stated_separator
from fem.records.units import BRACKETS, RATES, TIMES, UNITS, Name, named, unit_spelled, units_in_words
from fem.runtime.arrays import FloatArray

NAME = "columns"
GIVEN = "motion.csv"  #: file name of a motion that was given by arrays
MOST_COLUMNS = 4  #: time and three components, all of which name their direction
MOST_HEADER = 1000  #: lines
NOT_NUMBERS = ("nan", "inf", "+inf", "-inf")
COMMENT = re.compile(r"\s*(?:#|%|//)")
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(\s+[-+]?\d+,\d+)+\s*", re.ASCII)
#: bounded: a line of brackets would be scanned for each of them
BRACKETED = re.compile(r"[\[(]([^\])]{0,40})[\])]")
LABELLED = re.compile(r"[^\[\](),;]{1,60}[\[(][^\])]{0,40}[\])]")
MOST_WORDS = 6  #: of the name of a column
#: by the number of columns without names
DIRECTIONS: dict[int, tuple[Direction | None, ...]] = {1: (None,), 2: ("horizontal", "vertical")}
#: what a header states of the samples: "NPTS = 1000", "dt: 0.01 s", "Sampling rate 100 Hz", "PGA (cm/s2) = 58"
FACT = re.compile(
    r"\b(?:(?P<count>npts|n(?:o|um|umber)?\.? of (?:points|samples|data|values))"
    r"|(?P<step>dt|delta t|sampling (?:interval|period|step)|time (?:step|interval))"
    r"|(?P<rate>sampl(?:ing|e) (?:rate|freq[a-z]*))|(?P<length>^\W*(?:record )?(?:duration|length)(?: time)?)"
    r"|(?P<peak>pga|(?:peak|max(?:imum)?\.?) (?:ground )?acc[a-z]*\.?))\s*(?:[\[(](?P<unit>[^\])]{0,20})[\])])?"
    rf"\s*[:=,]?\s*(?P<value>{NUMBER}\s*[^\s,;:=]*)",
    re.IGNORECASE,
)


@dataclass
class _Header:
    """What the lines above the numbers say of the columns, and of the samples."""

    names: list[Name]
    units: list[str | None]
    line: int | None = None  #: of the names
    unclear: bool = False  #: names that are no directions
    facts: dict[str, tuple[float, int]] = field(default_factory=dict)  #: in SI units, and their lines
    peak: tuple[str, str | None, int] | None = None  #: number, unit, line

    @property
    def timeless(self) -> bool:
        """Whether the first column is a component, too."""
        first, *others = self.names
        if not others:
            return True
        if first.is_time or first.other or first.word == "x":
            return False
        if first.word == "s":  # seconds, or south
            return all(name.direction for name in others)
        return bool(first.direction or first.quantity) or self.units[0] in UNITS


def read_columns(source: MotionText, *, unit: str | None, sample_interval: float | None) -> Record:
    """Read a file of one to four columns; a RecordError gives the line that does not fit."""
    top = list(islice(_down_to_numbers(source.lines), MOST_HEADER))
    if not top or not _is_data(top[-1][1], stated_separator(source.line(1)) or " "):
        raise source.refused("no numbers were found; a motion file is needed")
    first, line = top.pop()
    separator, decimal_comma = _separators(line, source.line(1))
    count = len(fields_in(line.partition("#")[0], separator))
    header = _header(source, top, count, separator)
    _require_motion(source, header)
    directed = all(name.direction for name in header.names[not header.timeless :])
    if count > MOST_COLUMNS or (count == MOST_COLUMNS and not directed):
        raise source.refused(
            f"{count} columns; a motion has one (with sample_interval_s), two (time, value) or three (time, "
            "horizontal, vertical), or a time and three components that name their directions, such as NS, EW, UD",
            first,
        )
    step = _interval(source, header, sample_interval, separator)
    table = read_table(source, first, count, separator, decimal_comma)
    _require_begin(source, top, table, separator, step)
    if step is None:
        times = table[:, 0] * TIMES[header.units[0] or "s"]
        _require_increasing(source, times, first)
        if len(times) > 1:
            require_interval(float(np.median(np.diff(times))), "the samples have")
    else:
        times = np.arange(len(table), dtype=np.float64) * step
    components = _components(source, table, header, times, unit)
    _require_facts(source, header, components)
    return Record(components=components)


def _down_to_numbers(lines: Sequence[str]) -> Iterator[tuple[int, str]]:
    """The lines down to the first of numbers, with their places, without empty ones; of comments their text."""
    mark = stated_separator(lines[0]) or " "
    for place, text in enumerate(map(str.strip, lines), start=1):
        comment = COMMENT.match(text)
        if said := text.strip("#%/ \t") if comment else text:
            yield place, said + "#" if comment else said  # a comment is no number, whatever it holds
        if said and not comment and _is_data(text, mark):
            return


def _contents(lines: Sequence[str], first: int = 1) -> Iterator[tuple[int, str]]:
    """The lines from number `first` on, with their numbers, without comments and empty lines."""
    for number, line in enumerate(lines, start=first):
        content = (line.partition("#")[0] if "#" in line else line).strip()
        if content and not COMMENT.match(content):
            yield number, content


def _is_data(line: str, mark: str = " ") -> bool:
    """Whether a line holds numbers alone, or what is meant as such, between separators or this one."""
    parts = re.split(r"[;,\s]+", line.partition("#")[0].replace(mark, " "))
    fields = [text for part in parts if (text := part.strip('"')) and text.lower() not in NOT_NUMBERS]
    return (
        not line.endswith("#") and any(part.strip('"') for part in parts) and as_numbers(fields) is not None
    )


def _separators(line: str, first: str) -> tuple[str | None, bool]:
    """What separates columns (None: blanks), and whether a comma is the decimal mark.

    By the first line of data, and by the first of the file, which may say so.
    """
    if mark := stated_separator(first):
        return mark, mark != "," and "," in line
    for mark in (";", "\t"):
        if mark in line:
            return mark, "," in line
    if DECIMAL_COMMA.fullmatch(line):
        return None, True
    return ("," if "," in line else None), any("," in text for text in fields_in(line, ","))


def read_table(
    source: MotionText, first: int, count: int, separator: str | None, decimal_comma: bool = False
) -> FloatArray:
    """The numbers from the line `first` on, shape (n, columns)."""

    def rows(lines: Sequence[str], start: int) -> Iterator[tuple[int, list[str]]]:
        for number, line in _contents(lines, start):
            if decimal_comma and "." in line:
                raise source.refused("decimal commas and decimal points in one file; use one of them", number)
            row = fields_in(line, separator)
            if len(row) != count:
                raise source.refused(
                    f"{count} columns are needed as in line {first}, found {len(row)}", number
                )
            yield number, [text.replace(",", ".") for text in row] if decimal_comma else row

    blocks = []
    for start in range(first, len(source.lines) + 1, BLOCK):
        lines = source.lines[start - 1 : start - 1 + BLOCK]
        table = _plain_table(lines, separator, decimal_comma, count)
        blocks.append(source.read_rows(rows(lines, start)) if table is None else table)
    return np.concatenate(blocks, axis=None).reshape(-1, count)


def _plain_table(
    lines: Sequence[str], separator: str | None, decimal_comma: bool, count: int
) -> FloatArray | None:
    """Lines of numbers alone, read by numpy, many times faster; None where they hold anything else."""
    if not lines[0].strip() or (decimal_comma and any("." in line for line in lines)):
        return None
    points = [line.replace(",", ".") for line in lines] if decimal_comma else lines
    try:
        table = np.loadtxt(points, delimiter=separator, comments=None, ndmin=2)
    except ValueError:
        return None
    plain = table.shape == (len(lines), count) and bool((np.abs(table) <= LARGEST_NUMBER).all())
    return table if plain else None


def _header(source: MotionText, top: list[tuple[int, str]], count: int, separator: str | None) -> _Header:
    """What the lines above the numbers say; of names the last line that has any."""
    header = _Header([Name()] * count, [None] * count)
    for number, text in ((number, line.rstrip("#")) for number, line in top):
        for fact in FACT.finditer(text):
            value = fact["value"]
            if fact["peak"]:
                peak = re.match(NUMBER, value)
                unit = unit_spelled(fact["unit"] or value[peak.end() if peak else 0 :])
                header.peak = (peak[0] if peak else "", unit, number)
            elif fact["count"]:
                header.facts["count"] = source.whole_number(value, "number of samples", number), number
            elif fact["rate"]:
                rate = source.measured(value, "sampling rate", number, units=RATES)
                header.facts["step"] = 1.0 / rate, number
            elif fact["step"]:
                header.facts["step"] = source.measured(value, "interval of the samples", number), number
            else:
                header.facts["length"] = source.measured(value, "duration", number), number
        said = FACT.sub(" ", text)
        labels = _labels(said, count, separator) if said == text else None
        units = _units_in(said, count, separator) if labels is None else [_unit_of(label) for label in labels]
        names = [named(label) for label in labels or ()]
        if labels and not all(map(_is_unit, labels)) and any(name != Name() for name in names):
            header.names, header.line = names, number
            bare = (BRACKETS.sub("", label).strip() for label in labels)
            header.unclear = any(label and not name.word for label, name in zip(bare, names, strict=True))
        for column, unit in enumerate(units):
            if column >= count:
                raise source.refused(f"the header names more units than the {count} columns have", number)
            if unit is not None and header.units[column] not in (None, unit):
                raise source.refused(f"the header gives two units for column {column + 1}", number)
            header.units[column] = unit or header.units[column]
    return header


def _labels(text: str, count: int, separator: str | None) -> list[str] | None:
    """The names of the columns in a line of the header; None where it is another text."""
    if re.search(r"[:=]\s*[-+.\d]", text) or units_in_words(text):
        return None
    marks = [mark for mark in dict.fromkeys((separator, ";", "\t", ",")) if mark and mark in text]
    splits = [*(fields_in(text, mark) for mark in marks), LABELLED.findall(text), re.split(r"\s{2,}", text)]
    most = MOST_WORDS if count > 1 else MOST_WORDS // 2
    for labels in splits:
        if len(labels) == count and all(len(label.split()) <= most for label in labels):
            units = sum(map(_is_unit, labels))
            text_alone = any(as_numbers([label]) is not None for label in labels) or 0 < units < count
            return None if text_alone else labels
    words = text.split()  # a title, where one of them says nothing
    says = (
        len(words) == count
        and not BRACKETED.search(text)
        and all(named(word) != Name() or unit_spelled(word) for word in words)
        and not 0 < sum(map(_is_unit, words)) < count
    )
    return words if says else None


def _is_unit(label: str) -> bool:
    """Whether the name of a column is a unit alone."""
    return label.strip()[:1] not in ("[", "(") and unit_spelled(label) is not None


def _units_in(line: str, count: int, separator: str | None) -> list[str | None]:
    """Units in a line of the header that is no list of names, by column."""
    units = units_in_words(line) or [unit_spelled(text) for text in BRACKETED.findall(line)]
    units = units or [unit_spelled(text) for text in fields_in(line, separator or ",")[1:]]
    known = [unit for unit in units if unit is not None]
    if len(known) == 1 and known[0] not in TIMES:  # one unit, of all values
        return [None] * (count > 1) + known * max(1, count - 1)
    return [*known]


def _unit_of(label: str) -> str | None:
    """The unit in the name of a column: in brackets, behind an underscore or a blank, or the whole name."""
    if _is_unit(label):
        return unit_spelled(label)
    if bracketed := BRACKETED.findall(label):
        known = [unit for text in bracketed if (unit := unit_spelled(text))]
        return known[0] if known else "?" if named(label).is_time else None
    parts = re.split(r"[_\s]", label.strip())[-2:]  # no unit has more, such as m_s2
    spelled = [unit_spelled("_".join(parts[k:])) for k in range(len(parts))]
    return next((unit for unit in spelled if unit in UNITS or unit in TIMES or (unit and "/" in unit)), None)


def _require_motion(source: MotionText, header: _Header) -> None:
    """Refuse columns that are neither times nor motions, by their names and units."""
    ordinal = ("first", "second", "third", "fourth")
    spectral, timeless = any(name.other == "a spectrum" for name in header.names), header.timeless
    for column, name in enumerate(header.names):
        misplaced = name.is_time and (column > 0 or timeless) and "a time"
        if what := "a period" if spectral and name.word == "t" else name.other or misplaced:
            word = name.word if len(name.word) > 3 else name.word.capitalize()
            raise source.refused(
                f"its {ordinal[column]} column is {word}, {what}; a motion has times, and accelerations or "
                "displacements of a floor",
                header.line,
            )
    unit = header.units[0]
    if not timeless and unit not in (None, *TIMES):
        named_unit = f"{unit!r}" if unit != "?" else "a unit that is not known"
        raise source.refused(
            f"the header gives times in {named_unit}; they must be in {', '.join(TIMES)}", header.line
        )


def _interval(
    source: MotionText, header: _Header, given: float | None, separator: str | None
) -> float | None:
    """The interval of samples without times, as the file states it or it is given [s]; None with times."""
    count = len(header.names)
    if not header.timeless:
        if given is None:
            return None
        raise source.refused(
            f"sample_interval_s is for a file of one column, and {count} were found"
            + ("; write decimals with a point" if separator == "," else "")
        )
    stated, _ = header.facts.get("step", (given, 0))
    if stated is None:
        columns = "one column" if count == 1 else f"{count} columns that are named as components, all"
        raise source.refused(f"{columns} without times: give the interval as sample_interval_s")
    if given is not None and abs(stated - given) > SAME_TIME * given:
        raise source.refused(
            f"the file states an interval of {stated:g} s, but sample_interval_s = {given:g} is given; correct one of "
            "them"
        )
    require_interval(stated, "the header gives")
    return stated


def _require_begin(
    source: MotionText,
    top: list[tuple[int, str]],
    table: FloatArray,
    separator: str | None,
    step: float | None,
) -> None:
    """Refuse a broken row that would be taken for a title, and a count or interval that would be taken for a value."""
    for number, text in top:
        fields = fields_in(text, separator)
        begin = as_numbers(fields[:1]) if len(fields) == table.shape[1] > 1 else None
        if begin is not None and not text.endswith("#") and begin[0] < table[0, 0]:
            raise source.refused("not a number, or too large for one (no unit, no text)", number)
    value, behind = float(table[0, 0]), len(table) - 1
    if table.shape[1] == 1 and behind > 1 and value in (behind, behind - 1, step):
        what = "the interval of the samples" if value == step else "the number of the values below it"
        raise source.refused(
            f"its first number is {what}; delete the line, or write number and interval in one line above the values"
        )


def _require_increasing(source: MotionText, times: FloatArray, first: int) -> None:
    back = np.flatnonzero(np.diff(times) <= 0.0)
    if back.size:
        row = int(back[0])
        how = "occurs twice" if times[row] == times[row + 1] else "is earlier than that of the line before"
        number, _ = next(islice(_contents(source.lines[first - 1 :], first), row + 1, None))
        raise source.refused(
            f"times must increase, but time {times[row + 1]:g} s {how}; where the first column is a component and no "
            "time, name the columns, such as NS, EW, UD, and give sample_interval_s",
            number,
        )


def _components(
    source: MotionText, table: FloatArray, header: _Header, times: FloatArray, unit: str | None
) -> tuple[Component, ...]:
    """The columns that are no times, with the directions of their names, or by number where none has a name."""
    timeless, begin = header.timeless, int(not header.timeless)
    names = header.names[begin:]
    if header.unclear or timeless or any(name.direction for name in names):
        # beside what names no direction, "v" and "d" are velocities and displacements
        plain = not any(name.direction and name.word not in ("v", "d", "z") for name in names)
        names = [
            name._replace(direction=None) if plain and name.word in ("v", "d") else name for name in names
        ]
    else:
        by_number = zip(names, DIRECTIONS[len(names)], strict=True)
        names = [
            name._replace(word=direction or name.word, direction=direction) for name, direction in by_number
        ]
    components = []
    for column, name in enumerate(names, start=begin):
        settled, by_file = source.settled_unit(header.units[column], unit)
        if name.quantity not in (None, UNITS[settled].quantity):
            raise source.refused(
                f"the header names column {column + 1} {name.word}, and {settled!r} measures {UNITS[settled].quantity}",
                header.line,
            )
        components.append(
            Component(
                times=times,
                readings=table[:, column],
                factor=name.sense * UNITS[settled].factor,
                quantity=UNITS[settled].quantity,
                unit=settled,
                unit_stated=by_file,
                time_stated=timeless or header.units[0] is not None,
                name=(name.word.upper() if len(name.word) < 4 else name.word) if name.direction else "",
                direction=name.direction,
            )
        )
    return tuple(components)


def _require_facts(source: MotionText, header: _Header, components: Sequence[Component]) -> None:
    """Refuse samples that are not what the header says of them."""
    facts, first = header.facts, components[0]
    if "count" in facts:
        source.require_count(first.times.size, int(facts["count"][0]), facts["count"][1])
    if "step" in facts and abs(facts["step"][0] - first.step) > 0.01 * first.step:
        raise source.refused(
            f"the header states an interval of {facts['step'][0]:g} s, and the samples are {first.step:g} s apart",
            facts["step"][1],
        )
    if "length" in facts:
        source.require_length(facts["length"][0], first.times.size, first.step, facts["length"][1])
    if header.peak:
        number, unit, line = header.peak
        factor = UNITS[unit].factor if unit in UNITS else abs(first.factor)
        source.require_peak([component.values / factor for component in components], number, line)


def given_record(times: FloatArray, accelerations: Mapping[Direction, FloatArray]) -> Record:
    """A record of accelerations in m/s2, by direction, at the same times; RecordError: they are no motion."""
    components = [
        Component(times=times, readings=values, name=direction, direction=direction)
        for direction, values in accelerations.items()
    ]
    return Record(components=tuple(components), name=GIVEN, format=NAME)


def written(record: Record) -> str:
    """Times and SI values of all components as a file of columns, which reads back to the same bits."""
    columns = [record.components[0].times, *(component.values for component in record.components)]
    names = [
        f"{component.name if len(columns) > 2 else 'acceleration'}_m_s2" for component in record.components
    ]
    rows = map(",".join, zip(*(map(repr, column.tolist()) for column in columns), strict=True))
    return "\n".join([",".join(["time_s", *names]), *rows, ""])
