"""A hall as it is computed: which containers differ, which runs there are, and the case of each."""

import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

from fem.batch.axes import MOTION_FILE, VERTICAL_FILE, Axis, AxisError, read_motion_files
from fem.batch.case_maker import CaseMaker
from fem.batch.motion_set import FloorMotionPair, read_motion_set
from fem.batch.runner import Runner
from fem.case.case import Case, case_hash
from fem.case.data_files import FILE_KEYS, as_named_from
from fem.case.problem import outside_the_folder, stays_in_the_folder
from fem.case.toml import toml_value
from fem.case.unknown_inputs import excluded_values
from fem.case.validation import CaseError
from fem.hall.file import HallFile, HallRow
from fem.model.geometry import build_container
from fem.model.motion import build_motions
from fem.run.expected import expected_s, expected_words, say_expected

MOST_RUNS = 200_000  #: unless it is forced
MOST_NAMED = 20  #: bad rows in a refusal
OF_A_ROW = 3e-3  #: processor time of checking a row [s]


class HallItem(NamedTuple):
    """A run: a container under a motion."""

    container: int
    motion: int
    values: Mapping[str, Any]  #: of the keys that its row sets


@dataclass(frozen=True, kw_only=True)
class HallCases:
    """Makes the case of a run; picklable."""

    base: Case
    motions: Sequence[Mapping[str, Any]] = (
        {},
    )  #: keys that set each; one without keys: that of the base case

    def __call__(self, item: HallItem) -> Case:
        """The case of a run.

        Raises:
            CaseError: it cannot be used.
        """
        return self._make({**self.motions[item.motion], **item.values})

    @cached_property
    def _make(self) -> CaseMaker:
        return CaseMaker(self.base.without_fields())


@dataclass(frozen=True, kw_only=True)
class Inventory:
    """The rows of a list, checked."""

    file: HallFile
    base: Case  #: that the rows change
    rows: tuple[HallRow, ...]  #: each with its container, or why it is refused
    containers: tuple[Mapping[str, Any], ...]  #: values of the keys that each sets; no two alike
    hashes: tuple[str, ...]  #: of these

    @property
    def base_place(self) -> str:
        """How the command line named the base case."""
        return self.base.origin_with({}).place


@dataclass(frozen=True, kw_only=True, eq=False)
class Hall:
    """A list of containers with the motions that they undergo."""

    inventory: Inventory
    motions: tuple[FloorMotionPair, ...]
    cases: HallCases
    named: tuple[str, ...]  #: motions as they were named on the command line

    def items(self) -> list[HallItem]:
        """All runs; those of a container follow one another."""
        return [
            self.item(number, motion)
            for number in range(len(self.inventory.containers))
            for motion in range(len(self.cases.motions))
        ]

    def item(self, container: int, motion: int) -> HallItem:
        """One run."""
        return HallItem(container, motion, self.inventory.containers[container])

    def model_of(self, item: HallItem) -> str:
        """The model of a run."""
        return str(item.values.get("solver.model", self.cases.base.solver.model))

    def command(self, row: HallRow, motion: int) -> str:
        """The command that computes a row under a motion by itself."""
        words = ["python", "-m", "fem", "run", self.inventory.base_place]
        words += ["--allow-outside"] * self.inventory.base.origin_with({}).allow_outside
        if self.named:
            words += ["--motion", self.named[motion].partition(",")[0].strip()]
        # with a vertical file of a pair, or that a motion among pairs has none
        set_by_motion = {k: v for k, v in self.cases.motions[motion].items() if k != MOTION_FILE}
        for key, value in {**set_by_motion, **row.values}.items():
            words += ["--set", f"{key}={value if isinstance(value, str) else toml_value(value)}"]
        return shlex.join(words)


def plan_hall(
    file: HallFile, base: Case, motions: tuple[str, ...], runner: Runner, *, strict: bool, force: bool
) -> Hall:
    """Check every row before any is computed.

    Args:
        file: the list.
        base: that rows change.
        motions: files named on the command line, "H" or "H,V"; none: the motion of the base case.
        runner: its workers read a large set of motions.
        strict: refuse the whole list for one bad row.
        force: allow more than `MOST_RUNS` runs.

    Raises:
        CaseError: too many runs, motions that cannot be used, no good row; with `strict` any bad row.
    """
    _say_expected(file, base, max(len(motions), 1), runner, force=force)
    named = [key for key in file.keys if key in (MOTION_FILE, VERTICAL_FILE)]
    if motions and named:
        raise CaseError(f"{file.name}: column {named[0]!r} and --motion both name the motion; use one")
    pairs: tuple[FloorMotionPair, ...] = ()
    cases = HallCases(base=base)
    if motions:
        origin = replace(base.origin_with({}), trusted=frozenset(FILE_KEYS), allow_outside=True)
        base_of_set = base.from_origin(origin)
        pairs = read_motion_set(base_of_set, [_axis(base, motions)], runner)
        cases = HallCases(base=base_of_set, motions=[pair.keys for pair in pairs])
    look = partial(_hash_of, cases, outside=bool(motions))
    inventory = take_inventory(file, base, look, strict=strict)
    return Hall(inventory=inventory, motions=pairs, cases=cases, named=motions)


def _say_expected(file: HallFile, base: Case, motions: int, runner: Runner, *, force: bool) -> None:
    """Say how long a long list takes, before its rows are read; refuse more than `MOST_RUNS` runs.

    Raises:
        CaseError: with the number, the time and the way out.
    """
    rows, each, jobs = file.count, 1.0, runner.jobs
    with suppress(ValueError):
        each = expected_s(base)
    seconds = rows * (motions * each / jobs + OF_A_ROW)
    words = f"{file.name}: {rows} rows" + (f" under {motions} motions" if motions > 1 else "")
    if rows * motions > MOST_RUNS and not force:
        raise CaseError(
            f"{words}, {rows * motions} runs: {expected_words(seconds, jobs)}; take fewer rows, split them with "
            "--shard, or use --force"
        )
    say_expected(runner.reporter, words, seconds, jobs)


def _axis(base: Case, motions: Sequence[str]) -> Axis:
    """Motions named on the command line, as the values of a study."""
    pairs = [[as_named_from(base.folder, name.strip()) for name in pair.split(",")] for pair in motions]
    try:
        names, following = read_motion_files([pair if len(pair) > 1 else pair[0] for pair in pairs])
    except AxisError as error:
        raise CaseError(f"--motion {error}") from None
    return Axis(key=MOTION_FILE, values=names, following=following)


def take_inventory(
    file: HallFile, base: Case, look: Callable[[Mapping[str, Any]], str], *, strict: bool
) -> Inventory:
    """Check every row before any is computed; equal rows are one container.

    Args:
        file: the list.
        base: that rows change.
        look: gives a hash of a container from the values of a row, or raises a ValueError.
        strict: refuse the whole list for one bad row.

    Raises:
        CaseError: no good row; with `strict` any bad row.
    """
    rows: list[HallRow] = []
    containers: dict[str, Mapping[str, Any]] = {}
    numbers: dict[str, int] = {}  #: of the containers, by hash
    seen: dict[str, dict[str, Any]] = {}  #: by what a row sets: its container, or why it is refused
    for row in file.rows:
        values = repr(sorted(row.values.items()))
        if not row.reason and values not in seen:
            try:
                digest = look(row.values)
                containers.setdefault(digest, row.values)
                seen[values] = {"container": numbers.setdefault(digest, len(numbers))}
            except ValueError as error:
                seen[values] = {"reason": _in_words_of_list(str(error), base)}
        rows.append(row if row.reason else replace(row, **seen[values]))
    bad = [f"{file.name}, line {row.line} ({row.name}): {row.reason}" for row in rows if row.reason]
    if not containers or (strict and bad):
        more = [f"and {len(bad) - MOST_NAMED} more rows"] * (len(bad) > MOST_NAMED)
        none = ["no row can be computed"] * (not containers)
        raise CaseError("\n".join([*bad[:MOST_NAMED], *more, *none]))
    return Inventory(
        file=file,
        base=base,
        rows=tuple(rows),
        containers=tuple(containers.values()),
        hashes=tuple(containers),
    )


def _hash_of(cases: HallCases, values: Mapping[str, Any], *, outside: bool) -> str:
    """The hash of a container's case under the first motion, once its mesh and motions can be built.

    Raises:
        CaseError, MeshError, RecordError: what a run would be refused for.
    """
    mesh = values.get("container.mesh_file")
    if outside and isinstance(mesh, str) and not stays_in_the_folder(mesh):  # motions alone may lie anywhere
        raise CaseError(f"[container] mesh_file {outside_the_folder(mesh)}")
    moved = any(key.startswith(("motion.", "vertical.")) for key in values)
    first = cases(HallItem(0, 0, values))
    if reasons := excluded_values(first):
        raise CaseError("\n".join(reasons))
    build_container(first)
    for motion in range(len(cases.motions) if moved else 1):
        build_motions(cases(HallItem(0, motion, values)))
    return case_hash(first)


def _in_words_of_list(reason: str, base: Case) -> str:
    """Why a case cannot be used, on one line, without mention of the command line."""
    lines = (
        re.sub(r" \(--set \S+?=.*\)$", "", line.removeprefix(f"{base.origin_with({}).place}: "))
        for line in reason.splitlines()
    )
    return "; ".join(line for line in lines if line and not line.startswith("with --set "))
