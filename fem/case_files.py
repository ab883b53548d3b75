"""Find a case and read its text: a file of the user, or one of those that come with the program.

A case file is data from anywhere: its size is checked before it is read, and what is no text or no TOML is
refused with the line.
"""

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

from fem.case_reading import CaseError, did_you_mean

DEFAULT_CASE = "seed_stack_plateau"
LARGEST_FILE = 1_000_000  # bytes; a case file has a few thousand


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where a case comes from; it plays no part when two cases are compared."""

    name: str = field(default="case", compare=False)  #: file stem or name of the shipped case
    place: str = field(default="case", compare=False)  #: how messages call it: path or name
    folder: Path = field(default_factory=Path, compare=False)  #: where its mesh and motion files are
    text: str = field(default="", compare=False)  #: the file as given, without overrides
    overrides: tuple[str, ...] = field(default=(), compare=False)  #: as given, `table.key=value`


def shipped_cases() -> tuple[str, ...]:
    """Names of the cases that come with the program, in alphabetical order."""
    folder = resources.files("fem.cases")
    return tuple(sorted(entry.name[:-5] for entry in folder.iterdir() if entry.name.endswith(".toml")))


def shipped_text(name: str) -> str:
    """The commented file of a shipped case.

    Raises:
        CaseError: if there is none of this name; with the nearest one.
    """
    if name not in shipped_cases():
        raise CaseError(f"no shipped case {name!r}{_shipped_names(name)}")
    return (resources.files("fem.cases") / f"{name}.toml").read_text(encoding="utf-8")


def shipped_description(name: str) -> str:
    """What a shipped case shows: the first line of its file."""
    return shipped_text(name).partition("\n")[0].lstrip("# ").strip()


def find_case(name_or_path: str | Path | None) -> Origin:
    """The text of a case file or of a shipped case, with its name and folder.

    A file wins over a shipped case of the same name; None is the shipped default. The mesh and motion
    files of a shipped case are looked for in the current folder.

    Raises:
        CaseError: if there is neither, or if the file cannot be read.
    """
    name = DEFAULT_CASE if name_or_path is None else str(name_or_path)
    if name_or_path is not None and _is(Path.is_file, name):
        path = Path(name)
        return Origin(name=path.stem, place=str(path), folder=path.parent, text=_read_text(path))
    if name in shipped_cases():
        return Origin(name=name, place=name, text=shipped_text(name))
    raise CaseError(_no_such_case(name))


def parse_case(origin: Origin) -> dict[str, Any]:
    """The tables of a case file as TOML reads them.

    Raises:
        CaseError: if it is no TOML, with the line.
    """
    try:
        return tomllib.loads(origin.text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{origin.place}: not a TOML file: {error}") from error
    except RecursionError as error:
        raise CaseError(f"{origin.place}: not a case file: lists or tables nested too deep") from error
    except ValueError as error:  # a whole number of thousands of digits
        raise CaseError(f"{origin.place}: not a TOML file: {error}") from error


def _read_text(path: Path) -> str:
    try:
        with path.open("rb") as stream:
            content = stream.read(LARGEST_FILE + 1)
    except OSError as error:
        raise CaseError(f"{path}: cannot be read: {error.strerror}") from error
    if len(content) > LARGEST_FILE:
        raise CaseError(f"{path}: larger than {LARGEST_FILE} bytes; that is no case file")
    try:
        return content.decode("utf-8-sig")  # editors on Windows put a mark in front
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise CaseError(f"{path}: not text in UTF-8 (line {line}); save the file as UTF-8") from error


def _is(kind: Callable[[Path], bool], name: str) -> bool:
    """Whether there is such a file or folder; not for names that none can have."""
    try:
        return kind(Path(name))
    except (ValueError, OSError):  # a null character, a name too long, a folder that may not be entered
        return False


def _no_such_case(name: str) -> str:
    if name and _is(Path.is_dir, name):
        return f"{name!r} is a folder; give the case file, for instance {Path(name) / 'resolved.toml'}"
    name = name if len(name) <= 200 else f"{name[:200]} ..."
    return f"no case file {name!r} and no shipped case of that name{_shipped_names(Path(name).stem)}"


def _shipped_names(name: str) -> str:
    near = did_you_mean(name, shipped_cases())
    return f"{'; ' + near if near else ''} (shipped: {', '.join(shipped_cases())})"
