"""The case: one container, one base motion and the settings of the run, read once and frozen.

`load_case` reads a file or a shipped case into a `Case`; all other modules work with its attributes. All values are SI,
the unit is part of every key. Defaults are in `fem.case.tables`, and so is what follows from several keys
(`all_tables.CaseContent`).
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt
from pydantic import ConfigDict, PrivateAttr

from fem.case import data_files
from fem.case.case_rules import CASE_RULES
from fem.case.files import CASES, DEFAULT_CASE, Origin, parse_case
from fem.case.overrides import kinds_of, naming_overrides, parse_override, with_overrides
from fem.case.tables.all_tables import TABLES, CaseContent
from fem.case.tables.floors import PENALTY_KEYS
from fem.case.tables.links import LINK_RULES, ROWS
from fem.case.tables.neighbours import CORNER_PATCH, beside, case_of
from fem.case.tables.problem import Problem, broken, outside_the_folder, stays_in_the_folder
from fem.case.tables.unknown_inputs import excluded_values
from fem.case.toml import toml_document
from fem.case.validation import CaseError, problem_lines, read_case_tables, told_as
from fem.records.columns import given_record, written
from fem.records.record import Direction, Record

#: key and table that name a case and are no part of what is computed
LABELS = ("title", "document")


class Case(CaseContent):
    """A whole case; the attributes are the tables of the case file.

    Contradicting tables raise pydantic's ValidationError; `load_case`, `read_case`, `with_values` a `CaseError`.
    """

    model_config = ConfigDict(json_schema_extra={"description": "Tables of a case, and keys before them."})

    _origin: Origin = PrivateAttr(default_factory=Origin)

    rules = CASE_RULES

    @property
    def name(self) -> str:
        """File stem or name of the shipped case."""
        return self._origin.name

    @property
    def folder(self) -> Path:
        """The folder of its mesh and motion files."""
        return self._origin.folder

    @property
    def text(self) -> str:
        """The case file as given."""
        return self._origin.text

    @property
    def overrides(self) -> tuple[str, ...]:
        """Changes by the command line or a sweep, as `table.key=value`."""
        return self._origin.overrides

    @property
    def states_restitution(self) -> bool:
        """Whether a factor is stated on what its impacts leave, or those of a case beside it."""
        beside = (self._origin.beside.get(neighbour.case or "") for neighbour in self.neighbour)
        return super().states_restitution or any(
            case is not None and case.states_restitution for case in beside
        )

    @property
    def row(self) -> tuple["Case", ...]:
        """The case of each container of its row alone, its own first; empty without neighbours.

        CaseError: a neighbour cannot be.
        """
        row = []
        for number, neighbour in enumerate((None, *self.neighbour) if self.neighbour else ()):
            try:
                own = self if neighbour is None or neighbour.case is None else self._beside(neighbour.case)
                row.append(own.with_values(case_of(own, neighbour)))
            except CaseError as error:
                raise CaseError(f"[[neighbour]] {number}, as a container: {error}") from error
        return tuple(row)

    def _beside(self, name: str) -> "Case":
        """This case with the container of the case that a neighbour names."""
        if name not in self._origin.beside:
            # it is read once the keys are: until then no rule asks for it (`broken`)
            raise AttributeError(name)
        return _read(beside(self.given(), self._origin.beside[name].given()), self._origin, {})

    @property
    def _beside_alone(self) -> dict[str, "Case"]:
        """What its neighbours name, each alone on this floor, by its name in results; CaseError: two have one name."""
        copies: dict[str, Case] = {}
        names = {neighbour.case for neighbour in self.neighbour} - {None}
        for name in sorted(map(str, names)):
            own = self._beside(name)
            copies[data_files.copied_name(self.folder, name)] = own.with_values(case_of(own, None))
        if len(copies) < len(names):
            raise CaseError(
                "[neighbour] case names two files of one name from different folders; rename one of them"
            )
        return copies

    @property
    def texts(self) -> dict[str, str]:
        """The files of these cases, by their names in a folder of results; raises as `row`."""
        return {name: to_toml(own) for name, own in self._beside_alone.items()}

    @property
    def files(self) -> dict[str, data_files.DataFile]:
        """Its mesh and motion files, by dotted key.

        CaseError: one is missing, or outside its folder and not named on the command line.
        """
        named = {"container.mesh_file": self.container.mesh_file}
        for table, motion in (("motion", self.motion), ("vertical", self.vertical)):
            if self.recorded is None and motion.kind == "table":
                named[f"{table}.file"] = motion.file
        files = data_files.find_data_files(self.folder, named, trusted=self._origin.trusted)
        if self.recorded is None and self.vertical.kind == "table" and self.vertical.file is None:
            # another component of the same file
            files["vertical.file"] = replace(files["motion.file"], channel="")
        return files

    @property
    def data_files(self) -> dict[str, Path]:
        """Where these files are; raises as `files`."""
        return {key: file.path for key, file in self.files.items()}

    @property
    def recorded(self) -> Record | None:
        """The motion given by `with_motion`; None where a recorded motion has a file."""
        return self._origin.recorded

    def resolved(self) -> dict[str, Any]:
        """Every key that is used, defaults included, by table; files are named as their copies in the results are.

        A case without vertical motion, on a level rigid floor, of equal bolted prisms that bear on all of their base,
        without stops and ties, has no keys of these, and keeps its hash. What [joints] leaves out stays out: the
        floor's friction stands in its place, and the band treats it as unknown.
        """
        document = self.model_dump(by_alias=True, exclude={*TABLES, *ROWS})
        level = not self.floor.is_slab and self.floor.slope_percent == 0.0
        joints = self.container.is_loose and any(value is not None for value in vars(self.joints).values())
        says_nothing = {"vertical": not self.has_vertical, "floor": level, "joints": not joints}
        for name in TABLES:
            table = getattr(self, name)
            if table is None or says_nothing.get(name, False):
                continue
            idle: tuple[str, ...] = ()
            if name == "contact" and self.floor.is_slab:
                idle = (*PENALTY_KEYS, *(["damping_ratio"] if self.contact_damping_ratio is None else []))
            document[name] = {
                key: value
                for key, value in table.model_dump().items()
                if value is not None and key not in idle and not table.is_idle(key)
            }
        container, support = document["container"], document["support"]
        if not self.container.is_loose:
            del container["joints"]
            if self.joints.bolt_capacity_N is not None and self.container.bolted_joints:
                document["joints"] = {"bolt_capacity_N": self.joints.bolt_capacity_N}
        for table, key, usual in (
            (container, "shape", "prism"),
            (container, "eccentricity_m", 0.0),
            (support, "effective_width", 1.0),
        ):
            if table[key] == usual:
                del table[key]
        if self.support.camber_m == 0.0:
            del support["camber_m"], support["rocking_damping_ratio"]
        if self.container.box is not None:
            del container["boxes"]
            # with all that each takes from [container], so that the file reads back to the same boxes
            container["box"] = [
                {
                    **{"width_m": box.width, "height_m": box.height, "mass_kg": box.mass},
                    **{"centroid_m": box.centroid} | ({} if box.wall is None else {"wall_m": box.wall}),
                    "offset_m": table.offset_m,
                }
                for box, table in zip(self.stack, self.container.box, strict=True)
            ]
        for name in ROWS:
            rows = [table.model_dump(by_alias=True, exclude_none=True) for table in getattr(self, name)]
            document |= {name: rows} if rows else {}
        for dotted in data_files.FILE_KEYS:
            name, _, key = dotted.partition(".")
            content = document.get(name, [])
            for table in content if name in ROWS else [content]:
                if key in table:
                    table[key] = data_files.copied_name(self.folder, table[key])
        return document

    def with_values(self, values: Mapping[str, Any]) -> "Case":
        """This case with dotted keys set, such as `contact.mu_static`; alternatives are replaced.

        Raises:
            CaseError: as for a case file; the message names the keys that were set.
        """
        return _read(with_overrides(self.given(), values), self.origin_with(values), values)

    def with_chosen(self, values: Mapping[str, Any]) -> "Case":
        """This case with what is chosen for "auto", by dotted key: no change of a user, so none of its `overrides`."""
        return _read(with_overrides(self.given(), values), self._origin, values)

    def other_side(self) -> "Case | None":
        """This case turned by 90 degrees, its depth in the plane of the motion; None where `turned` has no keys."""
        turned = self.turned
        return self.with_values(turned) if turned else None

    @property
    def turned(self) -> dict[str, Any]:
        """The keys of `other_side`; none where that is the same or unknown.

        Of a container with a mesh of its own, unequal boxes, or something beside it nobody says how it is turned.
        """
        box, castings = self.container, self.support.casting_m
        alone = not (box.mesh_file or box.box or self.links or self.neighbour or self.floor.slope_percent)
        if not alone or box.depth_m == box.width_m:
            return {}
        turned: dict[str, Any] = {"container.width_m": box.depth_m, "container.depth_m": box.width_m}
        for key, pair in (
            ("support.casting_m", castings),
            ("floor.corner_patch_m", self.floor.corner_patch_m),
        ):
            if isinstance(pair, list | tuple):
                turned[key] = [pair[1], pair[0], *pair[2:]]
        return turned

    def replace(self, changes: Mapping[str, Any]) -> "Case":
        """This case with keys changed, for scripts: `case.replace({"contact.mu_static": 0.3})`.

        Args:
            changes: dotted keys and their values, which may be numpy's; alternatives are replaced, as by `--set`.

        Raises:
            CaseError: as for a case file; a ValueError.
        """
        return self.with_values({str(key): _plain(value) for key, value in changes.items()})

    def with_motion(
        self,
        time_s: npt.ArrayLike,
        acceleration_m_s2: npt.ArrayLike,
        vertical_m_s2: npt.ArrayLike | None = None,
    ) -> "Case":
        """This case on a motion given by arrays, in place of its own; the acceleration is linear between samples.

        Args:
            time_s: rising, shape (n,) [s].
            acceleration_m_s2: of the floor, > 0 toward +x, shape (n,) [m/s2].
            vertical_m_s2: of the floor, > 0 upward, shape (n,) [m/s2]; None: it does not move up and down.

        Raises:
            CaseError: arrays that are no motion, or not of one length; a ValueError.
        """
        values: dict[Direction, npt.ArrayLike] = {"horizontal": acceleration_m_s2}
        if vertical_m_s2 is not None:
            values["vertical"] = vertical_m_s2
        with told_as("with_motion: "):
            record = given_record(np.asarray(time_s), {name: np.asarray(a) for name, a in values.items()})
        data = {key: value for key, value in self.given().items() if key not in ("motion", "vertical")}
        data["motion"] = {"kind": "table", "file": record.name, "start": self.motion.start}
        if vertical_m_s2 is not None:
            data["vertical"] = {"kind": "table"}
        return _read(data, replace(self._origin, recorded=record), {})

    def without_fields(self) -> "Case":
        """This case without frames; not validated again, since no other key depends on them."""
        if self.output.fields_s == 0.0:
            return self
        output = self.output.model_copy(update={"fields_s": 0.0})
        return self.model_copy(update={"output": output}).from_origin(
            self.origin_with({"output.fields_s": 0.0})
        )

    def origin_with(self, values: Mapping[str, Any]) -> Origin:
        """The origin of this case with dotted keys set."""
        overrides = (*self.overrides, *(f"{key}={value}" for key, value in values.items()))
        trusted = self._origin.trusted if self._origin.allow_outside else self._origin.trusted - values.keys()
        return replace(self._origin, overrides=overrides, trusted=trusted)

    def from_origin(self, origin: Origin) -> Self:
        """This case with another origin."""
        copy = self.model_copy()
        copy._origin = origin
        return copy


def load_case(
    name_or_path: str | Path | None = None,
    overrides: Sequence[str] = (),
    *,
    motion: str | None = None,
    allow_outside: bool = False,
    allow_baseline: bool = False,
) -> Case:
    """Read a case file or a shipped case, changed by overrides of the form `table.key=value`.

    A file wins over a shipped case of the same name; None is the shipped default.

    Args:
        name_or_path: of the case.
        overrides: changes; files that they name may lie anywhere.
        motion: file of a recorded motion in place of the case's, relative to the current folder.
        allow_outside: let the case name files outside its folder.
        allow_baseline: take baselines of its records that change a peak by more than 20 %.

    Raises:
        CaseError: with one line for each reason why the case cannot be used.
    """
    source = CASES.shipped(DEFAULT_CASE) if name_or_path is None else CASES.find(name_or_path)
    values = dict(parse_override(text) for text in overrides)
    if motion is not None:
        recorded = {"motion.kind": "table", "motion.file": data_files.as_named_from(source.folder, motion)}
        for key in recorded:
            if values.get(key, recorded[key]) != recorded[key]:
                raise CaseError(f"--motion and --set {key} contradict each other; give one of them")
        values = recorded | values
        overrides = (*(f"{key}={value}" for key, value in recorded.items()), *overrides)
    if allow_baseline:
        kinds = kinds_of(with_overrides(parse_case(source), values))
        allowed = [f"{table}.allow_baseline" for table, kind in kinds.items() if kind == "table"]
        values |= dict.fromkeys(allowed, True)
        overrides = (*overrides, *(f"{key}=true" for key in allowed))
    trusted = frozenset(data_files.FILE_KEYS if allow_outside else values.keys() & set(data_files.FILE_KEYS))
    origin = replace(source, overrides=tuple(overrides), trusted=trusted, allow_outside=allow_outside)
    case = _read(with_overrides(parse_case(origin), values), origin, values)
    if reasons := excluded_values(case):
        raise CaseError("\n".join(f"{origin.place}: {reason}" for reason in reasons))
    return case


def read_case(text: str, *, name: str = "case", folder: Path | None = None) -> Case:
    """Read the text of a case file; `folder` is where its mesh and motion files are.

    Raises:
        CaseError: with one line for each reason why the case cannot be used.
    """
    origin = Origin(name=name, place=name, folder=folder or Path(), text=text)
    return _read(parse_case(origin), origin, {})


def case_from(mapping: Mapping[str, Any]) -> Case:
    """A case from a mapping that holds what a case file would hold.

    `fem.case_from({"container": {"width_m": 1.1, ...}, "contact": {"mu_static": 0.4}, "motion": {"kind": "none"}})`

    Args:
        mapping: tables by name, and the keys before the first table; values may be numpy's. Mesh and motion files are
            looked for in the current folder.

    Raises:
        CaseError: with one line for each reason why the case cannot be used; a ValueError.
    """
    if not isinstance(mapping, Mapping):
        raise CaseError(f"case_from: a mapping of tables is needed, got {type(mapping).__name__}")
    case = _read(_plain(mapping), Origin(), {})
    return case.from_origin(replace(case.origin_with({}), text=toml_document(case.given())))


def to_toml(case: Case) -> str:
    """The resolved case as a file that reads back to the same numbers, bit for bit."""
    return toml_document(case.resolved())


def case_hash(case: Case) -> str:
    """SHA-256 of the resolved case without its title and [document], and of the files that it reads.

    Comments, written-out defaults, keys of options that are not chosen and `output.figures` do not change it.
    CaseError: if a mesh or motion file cannot be read.
    """
    document = {key: value for key, value in case.resolved().items() if key not in LABELS}
    document["output"] = {key: value for key, value in document["output"].items() if key != "figures"}
    digest = hashlib.sha256(toml_document(document).encode())
    for key, path in sorted(case.data_files.items()):
        try:
            with path.open("rb") as stream:
                content = hashlib.file_digest(stream, "sha256").hexdigest()
        except OSError as error:
            raise CaseError(data_files.place_of(key) + f"cannot be read: {path}: {error.strerror}") from error
        digest.update(f"{key} {content}\n".encode())
    if case.recorded is not None:
        digest.update(written(case.recorded).encode())
    for name, own in case._beside_alone.items():
        digest.update(f"{name} {case_hash(own)}\n".encode())
    return digest.hexdigest()


def _plain(value: Any) -> Any:
    """A value of a script as a case file would give it: scalars, lists and tables, without numpy."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return str(value) if isinstance(value, Path) else value


def _read(data: Mapping[str, Any], origin: Origin, overrides: Mapping[str, Any]) -> Case:
    values, problems = read_case_tables(data)
    for dotted in data_files.FILE_KEYS:
        table, _, key = dotted.partition(".")
        name = getattr(values.get(table), key, None)
        if name is not None and dotted not in origin.trusted and not stays_in_the_folder(name):
            reason = outside_the_folder(name) + data_files.WAYS_OUT
            problems.append(Problem(table=table, key=key, reason=reason))
    if problems:
        lines = problem_lines(problems, f"{origin.place}: ")
        raise CaseError("\n".join(naming_overrides(lines, overrides)))
    case = Case.model_validate(values)
    named = sorted({neighbour.case for neighbour in case.neighbour if neighbour.case is not None})
    if not named:
        return case.from_origin(origin)
    read = {name: origin.beside.get(name) or _neighbour_case(name, case, origin, overrides) for name in named}
    case = case.from_origin(replace(origin, beside=read))
    _ = case.row  # one that cannot be is refused here
    if problems := broken(LINK_RULES, case):
        raise CaseError("\n".join(problem_lines(problems, f"{origin.place}: ")))
    return case


def _neighbour_case(name: str, case: Case, origin: Origin, overrides: Mapping[str, Any]) -> Case:
    """The case that a neighbour of a case names; CaseError: not to be used, with links, on another floor."""
    place = f"{origin.place}: [neighbour] "
    with told_as(place, of=CaseError):
        anywhere = origin.allow_outside or "neighbour.case" in origin.trusted
        source = CASES.beside(name, origin, anywhere=anywhere)
        data = parse_case(source)
        own = _read(
            {key: value for key, value in data.items() if key not in ROWS},
            replace(source, trusted=frozenset(data_files.FILE_KEYS)),
            {},
        )
    if held := [f"[[{key}]]" for key in ROWS if data.get(key)]:
        raise CaseError(
            f"{place}case = {name!r} has {' and '.join(held)} of its own; a row takes its container alone: name a "
            "file without them, and give what holds the row in this one"
        )
    floors = [
        (given.gravity_m_s2, given.floor.model_copy(update={CORNER_PATCH: None, "preset": None}))
        for given in (case, own)
    ]
    # for all of the row
    changed = any(key == "gravity_m_s2" or key.startswith("floor.") for key in overrides)
    if floors[0] != floors[1] and not changed:
        raise CaseError(
            f"{place}case = {name!r} stands on another floor: [floor] (without {CORNER_PATCH}) and gravity_m_s2 must "
            "be those of this case, for all of a row stand on one; make them equal"
        )
    return own
