"""A hall as it is computed: which containers differ, which runs there are, and the case of each."""

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple, Self

from fem.batch.axes import MOTION_FILE, VERTICAL_FILE, AxisError, read_axis
from fem.batch.case_maker import CaseMaker
from fem.batch.motion_set import FloorMotionPair, read_motion_set
from fem.batch.runner import Runner
from fem.case.case import Case, case_hash
from fem.case.data_files import as_named_from
from fem.case.tables.unknown_inputs import excluded_values
from fem.case.toml import toml_value
from fem.case.validation import CaseError
from fem.hall.file import HallFile, HallRow
from fem.model.geometry import build_container
from fem.model.motion import build_motions
from fem.run.expected import expected_s, expected_words, say_expected
from fem.runtime.identity import command_line

MOST_RUNS = 200_000  #: unless it is forced
MOST_NAMED = 20  #: bad rows in a refusal
OF_A_ROW = 3e-3  #: processor time of checking a row [s]


class HallItem(NamedTuple):
    """A run: a container under a motion."""

    container: int
    motion: int
    values: Mapping[str, Any]  #: of the keys that its row sets


@dataclass(frozen=True, kw_only=True, eq=False)
class Hall:
    """A list of containers, and the motions that they undergo."""

    file: HallFile
    base: Case  #: that the rows change
    motions: tuple[FloorMotionPair, ...] = ()  #: in place of that of the base case
    named: tuple[str, ...] = ()  #: these, as they were named on the command line
    rows: tuple[HallRow, ...] = ()  #: each with its container, or why it is refused
    containers: Mapping[str, HallRow]  #: by hash, the first row of each

    @cached_property
    def keys(self) -> list[Mapping[str, Any]]:
        """Those that set each motion; of the motion of the base case none."""
        return [pair.keys for pair in self.motions] or [{}]

    @cached_property
    def make(self) -> Callable[[HallItem], Case]:
        """Makes the case of a run; picklable."""
        base = with_files_of_the_command_line(self.base) if self.motions else self.base
        return partial(_case_of, CaseMaker(base.without_fields()), self.keys)

    @property
    def items(self) -> list[HallItem]:
        """All runs; those of a container follow one another."""
        motions = range(len(self.keys))
        rows = enumerate(self.containers.values())
        return [HallItem(number, motion, row.values) for number, row in rows for motion in motions]

    def model_of(self, item: HallItem) -> str:
        """The model of a run."""
        return str(item.values.get("solver.model", self.base.solver.model))

    def command(self, item: HallItem, values: Mapping[str, Any]) -> str:
        """The command that computes a run by itself, with the values of a row."""
        origin = self.base.origin_with({})
        words = ["run", origin.place, *["--allow-outside"] * origin.allow_outside]
        if self.named:
            words += ["--motion", self.named[item.motion].partition(",")[0].strip()]
        # with a vertical file of a pair, or that a motion among pairs has none
        set_by_motion = {k: v for k, v in self.keys[item.motion].items() if k != MOTION_FILE}
        for key, value in {**set_by_motion, **values}.items():
            words += ["--set", f"{key}={value if isinstance(value, str) else toml_value(value)}"]
        return command_line(*words)

    def hash_of(self, values: Mapping[str, Any]) -> str:
        """The hash of a container's case under the first motion, once its mesh and motions can be built.

        Raises:
            CaseError, MeshError, RecordError: what a run would be refused for.
        """
        moved = any(key.startswith(("motion.", "vertical.")) for key in values)
        first = self.make(HallItem(0, 0, values))
        if reasons := excluded_values(first):
            raise CaseError("\n".join(reasons))
        build_container(first)
        for motion in range(len(self.keys) if moved else 1):
            build_motions(self.make(HallItem(0, motion, values)))
        return case_hash(first)

    def checked(self, hash_of: Callable[[Mapping[str, Any]], str], *, strict: bool) -> Self:
        """With every row checked before any is computed; equal rows are one container.

        Args:
            hash_of: a hash of a container from the values of a row; raises a ValueError where it cannot be used.
            strict: refuse the whole list for one bad row.

        Raises:
            CaseError: no good row; with `strict` any bad row.
        """
        containers: dict[str, HallRow] = {}
        numbers: dict[str, int] = {}  #: of the containers, by hash
        seen: dict[str, dict[str, Any]] = {}  #: by what a row sets: its container, or why it is refused
        rows = []
        for row in self.file.rows:
            values = repr(sorted(row.values.items()))
            if not row.reason and values not in seen:
                try:
                    digest = hash_of(row.values)
                    containers.setdefault(digest, row)
                    seen[values] = {"container": numbers.setdefault(digest, len(numbers))}
                except ValueError as error:
                    seen[values] = {"reason": _in_words_of_list(str(error), self.base)}
            rows.append(row if row.reason else replace(row, **seen[values]))
        bad = [f"{self.file.name}, line {row.line} ({row.name}): {row.reason}" for row in rows if row.reason]
        if not containers or (strict and bad):
            more = [f"and {len(bad) - MOST_NAMED} more rows"] * (len(bad) > MOST_NAMED)
            none = ["no row can be computed"] * (not containers)
            raise CaseError("\n".join([*bad[:MOST_NAMED], *more, *none]))
        return replace(self, rows=tuple(rows), containers=containers)


def read_motions(base: Case, named: Sequence[str], runner: Runner) -> tuple[FloorMotionPair, ...]:
    """Motions named on the command line, from anywhere: files "H" or "H,V"; a large set is read by the workers.

    Raises:
        CaseError: one cannot be used, or is named twice.
    """
    pairs = [[as_named_from(base.folder, name.strip()) for name in pair.split(",")] for pair in named]
    try:
        axis = read_axis(MOTION_FILE, [pair if len(pair) > 1 else pair[0] for pair in pairs])
    except AxisError as error:
        raise CaseError(f"--motion {error}") from None
    return read_motion_set(with_files_of_the_command_line(base), [axis], runner)


def with_files_of_the_command_line(base: Case) -> Case:
    """The base case with motions from anywhere."""
    origin = base.origin_with({})
    trusted = origin.trusted | {MOTION_FILE, VERTICAL_FILE}
    return base.from_origin(replace(origin, trusted=trusted, allow_outside=True))


def _case_of(make: CaseMaker, keys: Sequence[Mapping[str, Any]], item: HallItem) -> Case:
    return make({**keys[item.motion], **item.values})


def say_time(file: HallFile, base: Case, motions: int, runner: Runner, *, force: bool) -> None:
    """Say how long a long list takes, before its rows are read; refuse more than `MOST_RUNS` runs.

    Raises:
        CaseError: with the number, the time and the way out.
    """
    rows, each, jobs = file.table.count, 1.0, runner.jobs
    with suppress(ValueError):
        each = expected_s(base)
    seconds = rows * (motions * each / jobs + OF_A_ROW)
    words = f"{file.name}: {rows} rows" + (f" under {motions} motions" if motions > 1 else "")
    if rows * motions > MOST_RUNS and not force:
        raise CaseError(
            f"{words}, {rows * motions} runs: {expected_words(seconds, jobs)}; take fewer rows, or use --force"
        )
    say_expected(runner.reporter, words, seconds, jobs)


def _in_words_of_list(reason: str, base: Case) -> str:
    """Why a case cannot be used, on one line, without mention of the command line."""
    lines = (
        re.sub(r" \(--set \S+?=.*\)$", "", line.removeprefix(f"{base.origin_with({}).place}: "))
        for line in reason.splitlines()
    )
    return "; ".join(line for line in lines if line and not line.startswith("with --set "))
