"""A hall as it is computed: which containers differ, which runs there are, and the case of each."""

import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
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
from fem.run.expected import expected_s
from fem.runtime.progress import clock_time

MOST_RUNS = 200_000  #: unless it is forced
#: processor time of checking a row [s]
OF_A_ROW = 3e-3


class HallItem(NamedTuple):
    """A run: a container under a motion."""

    container: int
    motion: int
    values: Mapping[str, Any]  #: of the keys that its row sets


@dataclass(frozen=True, kw_only=True)
class HallCases:
    """Makes the case of a run; picklable."""

    base: Case
    motions: tuple[Mapping[str, Any], ...]  #: keys that set each; one without keys: that of the base case

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

    reasons: tuple[str, ...]  #: why each is refused; empty where it is not
    of_row: tuple[int | None, ...]  #: the container of each
    containers: tuple[Mapping[str, Any], ...]  #: values of the keys that each sets; no two alike
    hashes: tuple[str, ...]  #: of these


@dataclass(frozen=True, kw_only=True, eq=False)
class Hall:
    """A list of containers with the case that they start from, and the motions that they undergo."""

    file: HallFile
    base: Case
    motions: tuple[FloorMotionPair, ...]
    cases: HallCases
    inventory: Inventory
    named: tuple[str, ...] = ()  #: motions as they were named on the command line

    @property
    def containers(self) -> tuple[Mapping[str, Any], ...]:
        """Values of the keys that each container sets."""
        return self.inventory.containers

    def items(self) -> list[HallItem]:
        """All runs; those of a container follow one another."""
        return [
            HallItem(number, motion, values)
            for number, values in enumerate(self.containers)
            for motion in range(len(self.cases.motions))
        ]

    def item(self, container: int, motion: int) -> HallItem:
        """One run."""
        return HallItem(container, motion, self.containers[container])

    def model_of(self, item: HallItem) -> str:
        """The model of a run."""
        return str(item.values.get("solver.model", self.base.solver.model))

    def command(self, row: HallRow, motion: int) -> str:
        """The command that computes a row under a motion by itself."""
        words = ["python", "-m", "fem", "run", self.base_place]
        words += ["--allow-outside"] * self.base.origin_with({}).allow_outside
        if self.named:
            words += ["--motion", self.named[motion].partition(",")[0].strip()]
        # of a pair its vertical file; of a motion alone among pairs that it has none
        set_by_motion = {k: v for k, v in self.cases.motions[motion].items() if k != MOTION_FILE}
        for key, value in set_by_motion.items():
            words += ["--set", f"{key}={value}"]
        for key, value in row.values.items():
            words += ["--set", f"{key}={value if isinstance(value, str) else toml_value(value)}"]
        return shlex.join(words)

    @property
    def base_place(self) -> str:
        """How the command line named the base case."""
        return self.base.origin_with({}).place


def plan_hall(
    file: HallFile,
    base: Case,
    motions: Sequence[str],
    runner: Runner,
    *,
    strict: bool = False,
    force: bool = False,
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
    check_size(file, base, max(len(motions), 1), runner.jobs, force=force, say=runner.reporter.message)
    named = [key for key in file.keys.values() if key in (MOTION_FILE, VERTICAL_FILE)]
    if motions and named:
        raise CaseError(f"{file.name}: column {named[0]!r} and --motion both name the motion; use one")
    pairs: tuple[FloorMotionPair, ...] = ()
    cases = HallCases(base=base, motions=({},))
    if motions:
        origin = replace(base.origin_with({}), trusted=frozenset(FILE_KEYS), allow_outside=True)
        base_of_set = base.from_origin(origin)
        pairs = read_motion_set(base_of_set, [_axis(base.folder, motions)], runner)
        cases = HallCases(base=base_of_set, motions=tuple(pair.keys for pair in pairs))
    return Hall(
        file=file,
        base=base,
        motions=pairs,
        cases=cases,
        inventory=take_inventory(
            file, partial(_hash_of, cases, outside=bool(motions)), base.origin_with({}).place, strict=strict
        ),
        named=tuple(motions),
    )


def check_size(file: HallFile, base: Case, motions: int, jobs: int, *, force: bool, say: Any) -> None:
    """Announce how long a long list takes, before its rows are read; refuse more than `MOST_RUNS` runs.

    Raises:
        CaseError: with the number, the time and the way out.
    """
    rows, each = file.count, 1.0
    runs = rows * motions
    with suppress(ValueError):
        each = expected_s(base)
    seconds = float(f"{runs * each / jobs + OF_A_ROW * rows:.1g}")
    words = f"{rows} rows" + (f" under {motions} motions" if motions > 1 else "")
    time = f"roughly {clock_time(seconds)} on {jobs} core{'s' * (jobs > 1)}"
    if runs > MOST_RUNS and not force:
        raise CaseError(
            f"{file.name}: {words}, {runs} runs: {time}; take fewer rows, split them with --shard, or use --force"
        )
    if seconds > 20.0:
        say(f"{file.name}: {words}: {time}")


def _axis(folder: Path, motions: Sequence[str]) -> Axis:
    pairs = [[as_named_from(folder, name.strip()) for name in pair.split(",")] for pair in motions]
    try:
        names, following = read_motion_files([pair if len(pair) > 1 else pair[0] for pair in pairs])
    except AxisError as error:
        raise CaseError(f"--motion {error}") from None
    return Axis(key=MOTION_FILE, values=names, following=following)


def take_inventory(
    file: HallFile, look: Callable[[Mapping[str, Any]], str], base_place: str, *, strict: bool
) -> Inventory:
    """Check every row before any is computed; equal rows are one container.

    Args:
        file: the list.
        look: gives a hash of a container from the values of a row, or raises a ValueError.
        base_place: how messages of `look` name the base case.
        strict: refuse the whole list for one bad row.

    Raises:
        CaseError: no good row; with `strict` any bad row.
    """
    reasons: list[str] = []
    of_row: list[int | None] = []
    containers: dict[str, Mapping[str, Any]] = {}
    seen: dict[str, tuple[str, int | None]] = {}  #: by what a row sets: why not, and which container
    numbers: dict[str, int] = {}  #: of the containers, by hash
    for row in file.rows:
        values = repr(sorted(row.values.items()))
        if not row.reason and values not in seen:
            try:
                digest = look(row.values)
                containers.setdefault(digest, row.values)
                seen[values] = "", numbers.setdefault(digest, len(numbers))
            except ValueError as error:
                seen[values] = _in_words_of_list(str(error), base_place), None
        reason, container = (row.reason, None) if row.reason else seen[values]
        reasons.append(reason)
        of_row.append(container)
    bad = [(row, reason) for row, reason in zip(file.rows, reasons, strict=True) if reason]
    if not containers or (strict and bad):
        lines = [f"{file.name}, line {row.line} ({row.name}): {reason}" for row, reason in bad[:20]]
        lines += [f"and {len(bad) - 20} more rows"] * (len(bad) > 20)
        raise CaseError("\n".join(lines + ["no row can be computed"] * (not containers)))
    return Inventory(
        reasons=tuple(reasons),
        of_row=tuple(of_row),
        containers=tuple(containers.values()),
        hashes=tuple(containers),
    )


def _hash_of(cases: HallCases, values: Mapping[str, Any], *, outside: bool) -> str:
    """The hash of a container's case under the first motion, once its mesh and motions can be built.

    Raises:
        CaseError, MeshError, RecordError: what a run would be refused for.
    """
    mesh = values.get("container.mesh_file")
    if (
        outside and isinstance(mesh, str) and not stays_in_the_folder(mesh)
    ):  # the motions alone may lie anywhere
        raise CaseError(f"[container] mesh_file {outside_the_folder(mesh)}")
    moved = any(key.startswith(("motion.", "vertical.")) for key in values)
    first = cases(HallItem(0, 0, values))
    if reasons := excluded_values(first):
        raise CaseError("\n".join(reasons))
    build_container(first)
    for motion in range(len(cases.motions) if moved else 1):
        build_motions(cases(HallItem(0, motion, values)))
    return case_hash(first)


def _in_words_of_list(reason: str, base_place: str) -> str:
    """Why a case cannot be used, on one line, without mention of the command line."""
    lines = (
        re.sub(r" \(--set \S+?=.*\)$", "", line.removeprefix(f"{base_place}: "))
        for line in reason.splitlines()
    )
    return "; ".join(line for line in lines if line and not line.startswith("with --set "))
