"""Rules between the keys of a case, and the problems of a case that breaks them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any

from fem.case.tables.quantities import with_unit


@dataclass(frozen=True, kw_only=True)
class Problem:
    """Why a case is refused."""

    table: str  #: empty: the keys before the first table
    key: str  #: empty: the whole table
    reason: str  #: with a way out


class BrokenRulesError(ValueError):
    """Every rule that a table or a case breaks."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        super().__init__("; ".join(f"{problem.key} {problem.reason}".strip() for problem in problems))
        self.problems = tuple(problems)


@dataclass(frozen=True)
class Rule:
    """One relation between keys: the key it is about, whether it holds, and the reason if it does not.

    It reads keys only, so that it can also judge a table of which other keys are wrong: a rule that reads a wrong key
    is left out, all others are judged, and one look at the messages of a file is enough to correct it.
    """

    place: str  #: dotted key
    holds: Callable[[Any], bool]  #: for a table, or for a whole case
    reason: str | Callable[[Any], str]  #: keys of the table stand in it in braces


def refused(place: str, reason: Callable[[Any], str]) -> Rule:
    """A rule that holds where there is no reason against it."""
    return Rule(place, lambda subject: not reason(subject), reason)


def left_out(where: Callable[[Any], Any], words: Mapping[str, str]) -> tuple[Rule, ...]:
    """Keys of a case, by dotted names, that must have their defaults `where` something holds of it, and why."""

    def rule(place: str, why: str) -> Rule:
        table, _, key = place.partition(".")

        def holds(case: Any) -> bool:
            content = getattr(case, table)
            return getattr(content, key) == type(content).model_fields[key].default or not where(case)

        return Rule(place, holds, why)

    return tuple(rule(place, why) for places, why in words.items() for place in places.split())


def file_beside(place: str, *, below: bool = True) -> Rule:
    """The file that a key of a table names, if it names one, is in the folder of the case file, or `below` it.

    Where it need not be below, whoever reads it says what else is wrong.
    """
    _, _, key = place.rpartition(".")

    def reason(table: Any) -> str:
        path = getattr(table, key)
        allowed = stays_in_the_folder(path) if below else path is None or is_a_file_name(path)
        return "" if allowed else outside_the_folder(path)

    return refused(place, reason)


def one_of(place: str, *others: str) -> Rule:
    """Of some keys of a table exactly one is given."""
    _, _, key = place.rpartition(".")
    count = {1: "two", 2: "three"}[len(others)]
    return Rule(
        place,
        lambda table: sum(getattr(table, name) is not None for name in (key, *others)) == 1,
        f"{'or ' if len(others) == 1 else ', '}{', '.join(others)}: exactly one of the {count} must be given",
    )


def broken(rules: Iterable[Rule], subject: Any) -> list[Problem]:
    """Problems of a table or a case, as far as its keys could be read."""
    problems = []
    for rule in rules:
        try:
            if rule.holds(subject):
                continue
            reason = (
                rule.reason.format_map(vars(subject))
                if isinstance(rule.reason, str)
                else rule.reason(subject)
            )
        except (AttributeError, KeyError):  # it reads a key that is refused already
            continue
        table, _, key = rule.place.partition(".")
        problems.append(Problem(table=table, key=key, reason=reason))
    return problems


def is_a_file_name(path: str) -> bool:
    """Whether a name can be that of a file."""
    return bool(path.strip() and path.isprintable())


def stays_in_the_folder(path: str | None) -> bool:
    """Whether a path, if there is one, names a file in the folder of the case file or below it."""
    if path is None:
        return True
    name = PurePosixPath(path)
    leaves = name.is_absolute() or ".." in name.parts or PureWindowsPath(path).drive or "\\" in path
    return is_a_file_name(path) and not leaves


def outside_the_folder(path: str) -> str:
    """The reason why such a path is refused."""
    return (
        f"must name a file in the folder of the case file or below it, got {with_unit(path, '')}; "
        "copy the file there and give its relative path, with forward slashes"
    )
