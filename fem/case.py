"""The case: one container, one base motion, and how the run is to be made, read once and frozen.

`load_case` reads a file or a shipped case into a `Case`; below that nobody sees a dictionary. All
values are SI, the unit is part of every key. What the file leaves out has its default in the tables
of `fem.case_tables`; what follows from several keys is a property here.
"""

import hashlib
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import resources
from pathlib import Path
from typing import Any, Self

from pydantic import Field, PrivateAttr

from fem.case_overrides import parse_override, with_overrides
from fem.case_reading import CaseError, did_you_mean, problem_lines, read_case_tables
from fem.case_rules import RULES_OF_A_CASE
from fem.case_tables import (
    TABLES,
    Contact,
    Container,
    Heading,
    Initial,
    Motion,
    Output,
    Solver,
    StaticRule,
    Support,
)
from fem.case_toml import toml_document

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


class Case(Heading):
    """A whole case; the attributes are the tables of the case file.

    Raises pydantic's ValidationError when built from contradicting tables; files, overrides and
    mappings go through `load_case`, `read_case` and `with_values`, which raise `CaseError`.
    """

    container: Container
    support: Support = Field(default_factory=Support)
    contact: Contact
    motion: Motion
    initial: Initial = Field(default_factory=Initial)
    static: StaticRule = Field(default_factory=StaticRule)
    solver: Solver = Field(default_factory=Solver)
    output: Output = Field(default_factory=Output)

    _origin: Origin = PrivateAttr(default_factory=Origin)

    rules = RULES_OF_A_CASE

    @property
    def name(self) -> str:
        """File stem or name of the shipped case."""
        return self._origin.name

    @property
    def folder(self) -> Path:
        """The folder in which mesh and motion files are looked for."""
        return self._origin.folder

    @property
    def text(self) -> str:
        """The case file as given."""
        return self._origin.text

    @property
    def overrides(self) -> tuple[str, ...]:
        """What was changed on the command line or by a sweep, as `table.key=value`."""
        return self._origin.overrides

    @property
    def box_mass(self) -> float:
        """Mass of one box with its fill [kg]."""
        box = self.container
        if box.weight_N is not None:
            return box.weight_N / self.gravity_m_s2
        if box.density_kg_m3 is not None:
            return box.density_kg_m3 * box.box_volume
        raise CaseError("[container] weight_N or density_kg_m3 is missing")  # a rule has seen to it

    @property
    def mass(self) -> float:
        """Mass of all boxes with their fill [kg]."""
        return self.container.boxes * self.box_mass

    @property
    def weight(self) -> float:
        """Weight of all boxes with their fill [N]."""
        return self.mass * self.gravity_m_s2

    @property
    def mean_areal_density(self) -> float:
        """Mass over elevation, the mean of what the cells of the mesh carry [kg/m2]."""
        return self.box_mass / (self.container.width_m * self.container.height_m)

    @property
    def amplitude(self) -> float:
        """A of a harmonic floor x = A sin(Omega t + phase) [m]; 0 for every other kind."""
        return self.motion.amplitude

    @property
    def angular_frequency(self) -> float:
        """Omega of a harmonic floor [rad/s]; 0 for every other kind."""
        return self.motion.angular_frequency

    @property
    def nominal_peak_acceleration(self) -> float | None:
        """A Omega^2 of a harmonic floor, the peak of a pulse, 0 of a floor at rest [m/s2].

        Without ramps, and without the end of a run that stops before the peak: what the floor really
        reaches is asked of the motion itself. None for a table, whose file is not read here.
        """
        match self.motion.kind:
            case "none":
                return 0.0
            case "harmonic":
                return self.amplitude * self.angular_frequency**2
            case "pulse":
                return abs(self.motion.peak_acceleration_m_s2 or 0.0)
        return None

    @property
    def data_files(self) -> dict[str, Path]:
        """The files beside the case file that it reads, by dotted key: mesh and motion table.

        Raises:
            CaseError: if one is missing, is no file, or lies outside the folder of the case file.
        """
        named = {"container.mesh_file": self.container.mesh_file}
        named["motion.file"] = self.motion.file if self.motion.kind == "table" else None
        return {key: _file_beside(self.folder, key, name) for key, name in named.items() if name is not None}

    def given(self) -> dict[str, Any]:
        """The keys that were set, by table, as a case file would hold them."""
        keys = self.model_dump(by_alias=True, exclude_unset=True, exclude=set(TABLES))
        tables = {name: getattr(self, name).model_dump(exclude_unset=True) for name in TABLES}
        return keys | {name: content for name, content in tables.items() if content}

    def resolved(self) -> dict[str, Any]:
        """Every key that plays a part, with every default written out, by table."""
        document = self.model_dump(by_alias=True, exclude=set(TABLES))
        for name in TABLES:
            table = getattr(self, name)
            idle = table.idle_keys()
            document[name] = {
                key: value
                for key, value in table.model_dump().items()
                if value is not None and key not in idle
            }
        return document

    def with_values(self, values: Mapping[str, Any]) -> "Case":
        """This case with dotted keys set, such as `contact.mu_static`; alternatives are replaced.

        Raises:
            CaseError: as for a case file; the message names the keys that were set.
        """
        overrides = (*self.overrides, *(f"{key}={value}" for key, value in values.items()))
        origin = replace(self._origin, overrides=overrides)
        return _read(with_overrides(self.given(), values), origin, values)

    def from_origin(self, origin: Origin) -> Self:
        """This case with another place of birth."""
        copy = self.model_copy()
        copy._origin = origin
        return copy


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


def load_case(name_or_path: str | Path | None = None, overrides: Sequence[str] = ()) -> Case:
    """Read a case file or a shipped case, changed by overrides of the form `table.key=value`.

    A file wins over a shipped case of the same name; None is the shipped default. The mesh and
    motion files of a shipped case are looked for in the current folder.

    Raises:
        CaseError: with one line for each reason why the case cannot be used.
    """
    name = DEFAULT_CASE if name_or_path is None else str(name_or_path)
    if name_or_path is not None and _is(Path.is_file, name):
        path = Path(name)
        origin = Origin(
            name=path.stem,
            place=str(path),
            folder=path.parent,
            text=_read_text(path),
            overrides=tuple(overrides),
        )
    elif name in shipped_cases():
        origin = Origin(name=name, place=name, text=shipped_text(name), overrides=tuple(overrides))
    else:
        raise CaseError(_no_such_case(name))
    values = dict(parse_override(text) for text in overrides)
    return _read(with_overrides(_parse(origin), values), origin, values)


def read_case(text: str, *, name: str = "case", folder: Path | None = None) -> Case:
    """Read the text of a case file; `folder` is where its mesh and motion files are.

    Raises:
        CaseError: with one line for each reason why the case cannot be used.
    """
    origin = Origin(name=name, place=name, folder=folder or Path(), text=text)
    return _read(_parse(origin), origin, {})


def to_toml(case: Case) -> str:
    """The resolved case as a file that reads back to the same numbers, bit for bit."""
    return toml_document(case.resolved())


def case_hash(case: Case) -> str:
    """SHA-256 of the resolved case without its title, and of the files that it reads.

    Cases that differ only in a comment, in what is written out, or in the keys of an option that is
    not chosen have the same hash.

    Raises:
        CaseError: if a mesh or motion file cannot be read.
    """
    document = {key: value for key, value in case.resolved().items() if key != "title"}
    digest = hashlib.sha256(toml_document(document).encode())
    for key, path in sorted(case.data_files.items()):
        try:
            with path.open("rb") as stream:
                content = hashlib.file_digest(stream, "sha256").hexdigest()
        except OSError as error:
            raise CaseError(_place(key) + f"cannot be read: {path}: {error.strerror}") from error
        digest.update(f"{key} {content}\n".encode())
    return digest.hexdigest()


def _read(data: Mapping[str, Any], origin: Origin, overrides: Mapping[str, Any]) -> Case:
    values, problems = read_case_tables(data)
    if problems:
        lines = problem_lines(problems, f"{origin.place}: ")
        raise CaseError("\n".join(_naming_overrides(lines, overrides)))
    return Case.model_validate(values).from_origin(origin)


def _naming_overrides(lines: list[str], overrides: Mapping[str, Any]) -> list[str]:
    """Say which override is to blame: behind its own key, else below the reasons."""
    named = []
    unnamed = dict(overrides)
    for line in lines:
        for dotted, value in overrides.items():
            table, _, key = dotted.rpartition(".")
            if (
                f"[{table}] {key} " if table else f" {key} "
            ) in line or f"[{table}] unknown key {key!r}" in line:
                line += f" ({_as_override(dotted, value)})"
                unnamed.pop(dotted, None)
        named.append(line)
    if unnamed and not any("(--set " in line for line in named):
        named.append("with " + " ".join(_as_override(dotted, value) for dotted, value in unnamed.items()))
    return named


def _as_override(dotted: str, value: object) -> str:
    shown = str(value)[:80]
    return f"--set {dotted}={shown if shown.isprintable() else repr(shown)}"


def _parse(origin: Origin) -> dict[str, Any]:
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


def _file_beside(folder: Path, key: str, name: str) -> Path:
    path = folder / name
    if not path.resolve().is_relative_to(folder.resolve()):
        raise CaseError(
            _place(key) + f"must lie in the folder of the case file, got {name!r}, which leads to "
            f"{path.resolve()}; copy the file there"
        )
    if not path.is_file():
        raise CaseError(
            _place(key) + f"names no file: {name!r}, looked for in {folder.resolve()}; "
            "its path is relative to the case file"
        )
    return path


def _place(dotted: str) -> str:
    table, _, key = dotted.partition(".")
    return f"[{table}] {key} "
