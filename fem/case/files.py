"""Find a case, sweep or ensemble and read it: a file of the user, or one that comes with the program.

A file of the user may hold anything: its size is checked before it is read, what is no text or no TOML is refused with
the line and a way out, and a file of another kind with the command that computes it.
"""

import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem.case.tables.problem import outside_the_folder, stays_in_the_folder
from fem.case.validation import CaseError, did_you_mean, told_as
from fem.runtime.user_files import leads_out, read_regular, real_path

if TYPE_CHECKING:  # it loads numpy, which `list` and bad input need not wait for
    from fem.records.record import Record

DEFAULT_CASE = "seed_stack_plateau"
LARGEST_FILE = 1_000_000  # bytes; a case file has a few thousand
#: kind of a file -> the command that computes it
COMMANDS = {"case": "run", "sweep": "sweep", "ensemble": "ensemble", "site": "assess", "list": "batch"}
#: columns of which one makes a file a list of containers
COLUMNS = {"width_m", "height_m", "depth_m", "mass_kg", "weight_N", "mu_static", "mu_kinetic"}
#: kind of a file -> keys and tables that make it one
MARKS = {
    "site": {"site"},
    "ensemble": {"random", "draws", "sampling", "replicates"},
    "sweep": {"axes", "perturbation", "threshold", "maps"},
    "case": {"container", "contact", "motion"},
}
#: what people write that TOML does not read: pattern of the line, and the way out
SLIPS = (
    (r"=\s*[-+]?\d+,\d", "write numbers with a decimal point, such as 1.1, not with a comma"),
    (r'"[^"]*\\', 'write paths with forward slashes, such as "records/floor.csv"'),
    (r"=\s*[-+]?\.\d", "write a digit before the decimal point, such as 0.4"),
    (r"=\s*[-+]?\d+\.(\s|$)", "write a digit after the decimal point, such as 4.0"),
    (r"=\s*[-+]?[\d.]+(e[-+]?\d+)?\s*[a-zA-Z%]", "give the bare number; its unit stands in the key"),
    (r"=\s*(True|False)\b", "write true or false in small letters"),
    (r"=\s*[A-Za-z]", 'put text in quotes, such as kind = "harmonic"'),
    (r"^\s*[\w.]+\s*:", "write = between a key and its value"),
    (r"=\s*(#|$)", "give a value behind =, or put # before the line"),
)


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where a case comes from; it plays no part when two cases are compared."""

    kind: str = field(default="case", compare=False)  #: of the file: a key of `COMMANDS`
    name: str = field(default="case", compare=False)  #: file stem or name of the shipped case
    place: str = field(default="case", compare=False)  #: how messages call it: path or name
    folder: Path = field(default_factory=Path, compare=False)  #: where its mesh and motion files are
    text: str = field(default="", compare=False)  #: the file as given, without overrides
    overrides: tuple[str, ...] = field(default=(), compare=False)  #: as given, `table.key=value`
    trusted: frozenset[str] = field(default=frozenset(), compare=False)  #: keys whose files may lie anywhere
    allow_outside: bool = field(default=False, compare=False)  #: all of them may, whoever sets them
    #: a motion given by arrays, in place of a file
    recorded: "Record | None" = field(default=None, compare=False)
    #: the cases that its neighbours name, each read once
    beside: Mapping[str, Any] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class Collection:
    """Files of one kind that come with the program, each commented."""

    kind: str  #: as messages call it
    folder: str  #: of the program, which holds them

    @property
    def _folder(self) -> Traversable:
        return resources.files("fem") / self.folder

    @property
    def names(self) -> tuple[str, ...]:
        """In alphabetical order."""
        entries = self._folder.iterdir()
        return tuple(sorted(entry.name[:-5] for entry in entries if entry.name.endswith(".toml")))

    def text(self, name: str) -> str:
        """The file of this name; CaseError: there is none, with the nearest one."""
        if name not in self.names:
            raise CaseError(f"no shipped {self.kind} {name!r}{self.hint(name)}")
        return (self._folder / f"{name}.toml").read_text(encoding="utf-8")

    def description(self, name: str) -> str:
        """What it shows: the first line of its file."""
        return self.text(name).partition("\n")[0].lstrip("# ").strip()

    def find(self, name_or_path: str | Path) -> Origin:
        """The text of a file, or of a shipped one of that name; a file wins.

        The mesh and motion files of a shipped case are looked for in the current folder. CaseError: if there is
        neither, or if the file cannot be read.
        """
        name = str(name_or_path)
        is_folder = os.path.isdir(name)
        if os.path.exists(name) and not is_folder:
            path = Path(name)
            with told_as(f"{path} "):
                content = read_regular(path, LARGEST_FILE)
            try:
                text = content.decode("utf-8-sig")  # editors on Windows put a mark in front
            except UnicodeDecodeError as error:
                line = content[: error.start].count(b"\n") + 1
                raise CaseError(f"{path}: not text in UTF-8 (line {line}); save the file as UTF-8") from error
            return Origin(kind=self.kind, name=path.stem, place=str(path), folder=path.parent, text=text)
        if name in self.names:
            return self.shipped(name)
        if name and is_folder:
            example = f", for instance {Path(name) / 'resolved.toml'}" if self is CASES else ""
            raise CaseError(f"{name!r} is a folder; give the {self.kind} file{example}")
        for other in COLLECTIONS:
            if name in other.names:
                raise CaseError(other_kind(name, other.kind))
        name = name if len(name) <= 200 else f"{name[:200]} ..."
        raise CaseError(
            f"no {self.kind} file {name!r} and no shipped {self.kind} of that name{self.hint(Path(name).stem)}"
        )

    def beside(self, name: str, origin: Origin, *, anywhere: bool = False) -> Origin:
        """One that another file names: a file beside that one wins over a shipped one of that name.

        CaseError: there is neither, it is outside, or it cannot be read; beginning with the kind.

        Args:
            name: as given there.
            origin: of the other file.
            anywhere: it may lie outside that folder.
        """
        path = origin.folder / name
        is_file = os.path.isfile(path)
        if not anywhere and not stays_in_the_folder(name):
            raise CaseError(f"{self.kind} {outside_the_folder(name)}")
        if not anywhere and is_file and leads_out(origin.folder, path):
            raise CaseError(
                f"{self.kind} {name!r} leads out of the folder of {origin.place}, to {real_path(path)}"
            )
        if not is_file and name not in self.names:
            raise CaseError(
                f"{self.kind} {name!r} is no file in {real_path(origin.folder)} and no shipped {self.kind}"
                f"{self.hint(name)}"
            )
        return self.find(path) if is_file else self.shipped(name)

    def shipped(self, name: str) -> Origin:
        """One that comes with the program, whatever files there are."""
        return Origin(kind=self.kind, name=name, place=name, text=self.text(name))

    def hint(self, name: str) -> str:
        """The one that may have been meant, and all there are."""
        return f"{did_you_mean(name, self.names)} (shipped: {', '.join(self.names)})"


CASES = Collection("case", "case/shipped")
SWEEPS = Collection("sweep", "study/sweeps")
ENSEMBLES = Collection("ensemble", "study/ensembles")
SITES = Collection("site", "site/shipped")
COLLECTIONS = (CASES, SWEEPS, ENSEMBLES, SITES)


def parse_case(origin: Origin) -> dict[str, Any]:
    """The tables of a file as TOML reads them.

    CaseError: if it is no TOML, with the line and a way out, or a file of another kind.
    """
    try:
        data = tomllib.loads(origin.text)
    except RecursionError as error:
        raise CaseError(f"{origin.place}: not a case file: lists or tables nested too deep") from error
    except ValueError as error:  # TOMLDecodeError, or a whole number of thousands of digits
        if (kind := kind_of_text(origin.text)) and kind != origin.kind:
            raise CaseError(other_kind(origin.place, kind)) from None
        # the line that is no TOML and the way out, for the slips that people make
        place, lines, slip = re.search(r"line (\d+)", str(error)), origin.text.splitlines(), ""
        if place is not None and int(place[1]) <= len(lines):
            line = lines[int(place[1]) - 1].strip()
            advice = (advice for pattern, advice in SLIPS if re.search(pattern, line))
            slip = "".join(f"\n  {words}" for words in (line[:80], *list(advice)[:1]))
        raise CaseError(f"{origin.place}: not a TOML file: {error}{slip}") from error
    kinds = _kinds(data)
    # An ensemble has axes, as a sweep has; a site file names its container, as a case does.
    more = {"sweep": "ensemble", "case": "site"}.get(origin.kind)
    if kinds and (origin.kind not in kinds or more in kinds):
        raise CaseError(other_kind(origin.place, kinds[0]))
    return data


def _kinds(data: Mapping[str, Any]) -> list[str]:
    """Kinds of a file with these keys and tables."""
    return [kind for kind, marks in MARKS.items() if not marks.isdisjoint(data)]


def kind_of_text(text: str) -> str:
    """The kind of a file with this text, a key of `COMMANDS`; empty of what is none."""
    try:
        return next(iter(_kinds(tomllib.loads(text))), "")
    except (RecursionError, ValueError):
        first = text.lstrip().partition("\n")[0]
        names = (name.strip(' "\r').rpartition(".")[2] for name in re.split("[;,\t]", first))
        return "" if COLUMNS.isdisjoint(names) else "list"


def kind_of(name_or_path: str | Path) -> str:
    """The kind of a file, or of a shipped one of that name; empty of what is none or cannot be read."""
    shipped = (collection for collection in COLLECTIONS if str(name_or_path) in collection.names)
    try:
        return kind_of_text(next(shipped, CASES).find(name_or_path).text)
    except CaseError:
        return ""


def other_kind(place: str | Path, kind: str) -> str:
    """What is said of a file of another kind than is asked for: the command that takes it."""
    article, case = "an" if kind == "ensemble" else "a", " --case CASE" * (kind == "list")
    what = "list of containers" if kind == "list" else f"{kind} file"
    return f"{place}: this is {article} {what}: python -m fem {COMMANDS[kind]} {place}{case}"
