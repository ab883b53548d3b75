"""What the file of a study of many cases has: a heading, tables, the case it starts from, the keys that vary."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from fem.batch.axes import VERTICAL_FILE, Axis, AxisError, hint, set_axis
from fem.case.case import Case, load_case
from fem.case.files import CASES, Origin, is_there, parse_case
from fem.case.overrides import keys_in_effect
from fem.case.tables.table import CaseTable
from fem.case.validation import CaseError, problem_lines, read_table
from fem.runtime.left import left_words

TableT = TypeVar("TableT", bound=CaseTable)
StudyT = TypeVar("StudyT")


def read_study(origin: Origin, read: Callable[[dict[str, Any], Origin], StudyT]) -> StudyT:
    """Parse the file of a study, and have `read` make it from the data.

    Raises:
        CaseError: with one line for each reason why it cannot be used, each beginning with the file.
    """
    data = parse_case(origin)
    try:
        return read(data, origin)
    except CaseError as error:
        raise CaseError("\n".join(f"{origin.place}: {line}" for line in str(error).splitlines())) from None


def read_as(name: str, model: type[TableT], content: Mapping[str, Any]) -> TableT:
    """A table of the file; `name` is empty for the keys before the first one.

    Raises:
        CaseError: with one line for each reason why it cannot be used.
    """
    given, _, problems = read_table(name, model, content)
    if problems:
        raise CaseError("\n".join(problem_lines(problems)))
    return model.model_validate(given)


def split_tables(
    data: Mapping[str, Any], known: Sequence[str]
) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """The keys before the first table, and the tables; a missing one is empty.

    Raises:
        CaseError: an unknown table, or a table written as a value.
    """
    tables = {key: value for key, value in data.items() if isinstance(value, dict)}
    heading = {key: value for key, value in data.items() if key not in tables}
    for name in tables:
        if words := left_words(f"[{name}]"):
            raise CaseError(f"[{name}] {words}")
        if name not in known:
            raise CaseError(
                f"[{name}] unknown table{hint(name, known)} (known: {', '.join(known)}); "
                'dotted keys stand in quotes, such as "contact.mu_static"'
            )
    for key in heading:
        if key in known:
            raise CaseError(f"{key} must be a table; write [{key}] above its keys")
    return heading, tables


def flat(name: str, content: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted keys, whether they were written in quotes or, as TOML would have it, as tables in tables.

    Raises:
        CaseError: one is given in both ways.
    """
    keys: dict[str, Any] = {}
    for key, value in content.items():
        # A table is a range of one key, but for `vertical.scale = [1, -1]`, which TOML reads as a table, too.
        is_range = isinstance(value, dict) and (
            {"from", "to", "count"} & value.keys() or isinstance(value.get("scale"), str)
        )
        if isinstance(value, dict) and not is_range:
            inner = {f"{key}.{part}": what for part, what in value.items()}
        else:
            inner = {key: value}
        for dotted, what in inner.items():
            if dotted in keys:
                raise CaseError(f"[{name}] {dotted} is given twice")
            keys[dotted] = what
    return keys


def base_case(
    name: str,
    changes: Mapping[str, Any],
    origin: Origin,
    motion: Mapping[str, Any] | None = None,
    varied: Iterable[str] = (),
) -> Case:
    """The case that is varied, with the keys of [set] changed.

    A file is looked for beside the one that names it, and wins over a shipped case.

    Args:
        name: of the case.
        changes: the table [set].
        origin: of the study.
        motion: keys of the first of a set of motions; the files of a shipped case are then beside the study.
        varied: keys of the table [axes].

    Raises:
        CaseError: there is neither, it is outside that folder, or it cannot be used.
    """
    CASES.beside(name, origin)
    path = origin.folder / name
    is_file = is_there(Path.is_file, path)
    base = load_case(path if is_file else name)
    values = flat("set", changes)
    if motion:
        values = {"motion.kind": "table"} | values | dict(motion)
        if not is_file:
            base = base.from_origin(replace(base.origin_with({}), folder=origin.folder))
    try:
        return base.with_values(values) if values else base
    except CaseError as error:
        raise CaseError(
            "\n".join(_in_words_of_study(line, varied) for line in str(error).splitlines())
        ) from None


def _in_words_of_study(line: str, varied: Iterable[str]) -> str:
    """What is wrong with a key of [set], in words of the file that has it."""
    line = re.sub(r"\(--set (\S+?)=(.*)\)$", r'([set] "\1" = \2)', line)
    for key in varied:
        if re.search(rf"\b{key.rpartition('.')[2]}\b", line):
            return (
                f"{line}; {key!r} varies, and a key that must follow it stands in [derived] in place of [set]"
            )
    return line


def read_axes(
    content: Mapping[str, Any], most: int, example: str, read: Callable[[str, Any], Axis]
) -> tuple[Axis, ...]:
    """The table [axes].

    Args:
        content: of the table.
        most: axes that there may be.
        example: of an entry.
        read: an axis from its key and what is given; may raise an `AxisError`.

    Raises:
        CaseError: with one line for each reason.
    """
    if not 1 <= len(content) <= most:
        raise CaseError(f"[axes] must hold one to {most} keys, got {len(content)}; for instance {example}")
    axes, problems = [], []
    for key, value in content.items():
        try:
            axes.append(read(key, value))
        except AxisError as error:
            problems.append(f"[axes] {key!r} {error}")
    if problems:
        raise CaseError("\n".join(problems))
    return tuple(axes)


def require_verticals(axes: Iterable[Axis], varied: Iterable[str], base: Case) -> None:
    """Refuse a motion alone in a set where a key of its vertical motion varies.

    Raises:
        CaseError: with the key and the motion.
    """
    motions = set_axis(axes)
    key = next((key for key in varied if key.startswith("vertical.")), None)
    if motions is None or key is None or (not motions.following and base.has_vertical):
        return
    verticals = motions.following.get(VERTICAL_FILE, (None,) * len(motions.values))
    alone = [name for name, vertical in zip(motions.values, verticals, strict=True) if vertical is None]
    if alone:
        raise CaseError(
            f"{key!r} varies, and {alone[0]!r} has no vertical motion; give it as a pair, "
            f'["{alone[0]}", "its vertical file"]'
        )


def require_once(changes: Mapping[str, Any], varied: Sequence[str], base: Case) -> None:
    """Refuse a key of [set] that varies, and two that are one in this case: one of the two would have no effect.

    Raises:
        CaseError: with the key.
    """
    effects = [next(iter(keys_in_effect({key: None}, base.kinds))) for key in varied]
    for key, effect in zip(varied, effects, strict=True):
        if {key, effect} & flat("set", changes).keys():
            raise CaseError(f"[set] {key!r} varies as well; take it out of [set], or do not vary it")
        if effects.count(effect) > 1 and key != effect:
            raise CaseError(f"{key!r} of a record is its {effect!r}, which varies as well; leave one out")
