"""A study shared by machines that know nothing of one another: `--shard 3/64`, and `--merge` for the whole.

A shard computes its share of the runs, and stops where it would need those of others. Its folder is that of an
interrupted study. A merge joins the logs of all shards, and continues as one that is resumed: rows depend on the item
alone and tables are in its order, so the whole is what it is in one go. A shard of a merge shares the next stage.
"""

import re
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self, TypeVar

from fem.case.validation import CaseError
from fem.results.errors import FolderError
from fem.results.folder import ResultFolder, require_same_program
from fem.results.json_block import JsonBlock
from fem.results.kinds import ResultKind, read_result

MOST_SHARDS = 100_000
MOST_NAMED = 20  #: missing shards in a message

ItemT = TypeVar("ItemT")


@dataclass(frozen=True)
class Shard(JsonBlock):
    """One of the parts of a study, numbered from 1; as a marking file holds it, with whether its share is computed."""

    number: int
    count: int
    done: bool = False
    lines: int = field(default=0, compare=False)  #: of its logs, when it was done

    def lost(self, folder: Path, kind: ResultKind) -> str:
        """What its folder lacks since it was done, in words; "" where nothing is missing."""
        lines = lines_of_logs(folder, kind)
        return f"{' and '.join(kind.logs)}: {lines} of {self.lines} lines" if lines < self.lines else ""

    @classmethod
    def parse(cls, text: str) -> Self:
        """From "3/64".

        Raises:
            CaseError: no such part.
        """
        match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text.strip(), re.ASCII)
        number, count = map(int, match.groups()) if match else (0, 0)
        if not 1 <= number <= count <= MOST_SHARDS:
            raise CaseError(f"--shard {text}: a part and how many there are is needed, from 1/64 to 64/64")
        return cls(number, count)

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"


@dataclass
class Share:
    """The share of a shard while it is computed."""

    shard: Shard
    waits: bool = field(default=False, init=False)  #: what comes next needs what other shards compute

    def of(self, items: Sequence[ItemT], numbers: Iterable[int]) -> list[ItemT]:
        """Its own of some items, by their numbers."""
        own = self.shard.number - 1
        return [item for item, number in zip(items, numbers, strict=True) if number % self.shard.count == own]


def number_of(item: object) -> int:
    """A number that an item has on every machine, whatever is computed already."""
    return item if isinstance(item, int) else zlib.crc32(repr(item).encode())


def read_shards(place: ResultFolder, request: str, folders: Sequence[Path]) -> list[Mapping[str, Any]]:
    """The marking files of all shards of a study.

    Args:
        place: where they are merged.
        request: hash of what is asked.
        folders: of the shards, in any order.

    Raises:
        FolderError: a folder of something else or of another program, an unfinished shard, missing shards.
    """
    marks: list[Mapping[str, Any]] = []
    numbers: set[tuple[int, int]] = set()
    for folder in folders:
        if folder.resolve() == place.path.resolve():
            raise FolderError(
                f"--merge {folder}: it is the folder of the result; name another with --out DIR"
            )
        mark = read_result(folder / place.kind.mark, place.kind)
        shard = Shard.from_json(mark["shard"]) if isinstance(mark.get("shard"), dict) else None
        if mark[place.kind.request] != request or shard is None:
            other = (
                f"of another {place.kind.subject}"
                if shard
                else f"of no shard of {place.kind.article} {place.kind.name}"
            )
            raise FolderError(f"--merge {folder}: it holds the results {other}")
        require_same_program(folder, mark)
        if not shard.done:
            raise FolderError(
                f"--merge {folder}: shard {shard} is not finished; --shard {shard} --resume continues it"
            )
        if lost := shard.lost(folder, place.kind):
            raise FolderError(
                f"--merge {folder}: damaged, {lost}; --shard {shard} --resume computes what is missing"
            )
        marks.append(mark)
        numbers.add((shard.number, shard.count))
    counts = {count for _, count in numbers}
    if len(counts) > 1:
        raise FolderError(
            f"--merge: shards of {' and of '.join(map(str, sorted(counts)))}; give those of one set"
        )
    count = counts.pop()
    if missing := [f"{number}/{count}" for number in range(1, count + 1) if (number, count) not in numbers]:
        more = f" and {len(missing) - MOST_NAMED} more" if len(missing) > MOST_NAMED else ""
        raise FolderError(f"--merge: missing shards {', '.join(missing[:MOST_NAMED])}{more}")
    if len({str(mark.get(place.kind.later)) for mark in marks}) > 1:
        raise FolderError(f"--merge: the shards ask for other later stages of the {place.kind.name}")
    return marks


def whole_lines(path: Path) -> list[str]:
    """The lines of a log but for one that was not written whole; none where there is no file."""
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    return text.split("\n")[:-1]


def lines_of_logs(folder: Path, kind: ResultKind) -> int:
    """How many whole lines the logs of a study have."""
    return sum(len(whole_lines(folder / name)) for name in kind.logs)


def join_logs(place: Path, kind: ResultKind, folders: Sequence[Path]) -> None:
    """Write the logs of a study from those of its shards, every line once; what is there already stays.

    Raises:
        FolderError: a log has other columns.
    """
    for name in kind.logs:
        lines: dict[str, None] = {}
        for path in (folder / name for folder in (place, *folders)):
            whole = whole_lines(path)
            if whole and lines and whole[0] != next(iter(lines)):
                raise FolderError(f"{path}: damaged, its columns are not those of the other shards")
            lines |= dict.fromkeys(whole)
        if lines:
            (place / name).write_text("".join(f"{line}\n" for line in lines), encoding="utf-8", newline="")
