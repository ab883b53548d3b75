"""The folder of a study that is no single run: what marks it, what may be removed from it, how it goes on.

One JSON file, named after the kind of study, marks the folder; it holds the status and the hash of what was asked.
It is written first, and every file is replaced whole.
"""

import contextlib
import io
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.results.disk import require_room
from fem.results.lock import locked_folder as held
from fem.results.run_folder import (
    FolderError,
    naming_what_cannot_be_written,
    to_json,
    write_atomically,
)
from fem.runtime.identity import program_identity, versions

COMPLETED = "completed"


def program_of_results() -> dict[str, Any]:
    """What every marking file says of the program that made it: only such results are gone on with."""
    return {"program": program_identity()["sources"], "versions": versions()}


@dataclass(frozen=True, kw_only=True)
class ResultFolder:
    """An opened folder."""

    path: Path
    mark: str  #: name of the JSON file that marks it
    finished: dict[str, Any] | None = None  #: result already there; None if there is something to compute

    def write_result(self, result: Mapping[str, Any]) -> None:
        """Replace the marking file; numbers that are not finite become null."""
        write_atomically(self.path / self.mark, to_json(result))

    def write_text(self, name: str, text: str) -> None:
        """Replace a file, in a folder below if its name says so."""
        place = self.path / name
        place.parent.mkdir(exist_ok=True)
        write_atomically(place, text)

    def write_arrays(self, name: str, arrays: Mapping[str, np.ndarray]) -> None:
        """Replace an npz file of plain arrays."""
        stream = io.BytesIO()
        np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
        part = self.path / f".{name}.part"
        try:
            with part.open("wb") as file:
                file.write(stream.getvalue())
                file.flush()
                os.fsync(file.fileno())
            os.replace(part, self.path / name)
        except BaseException:
            with contextlib.suppress(OSError):
                part.unlink()
            raise

    def read_arrays(self, name: str) -> dict[str, np.ndarray] | None:
        """The arrays of such a file, or None if there is none.

        Raises:
            FolderError: it is damaged.
        """
        place = self.path / name
        if not place.exists():
            return None
        try:
            with np.load(place, allow_pickle=False) as file:
                return {key: file[key] for key in file.files}
        except (OSError, ValueError, KeyError, EOFError) as error:
            raise FolderError(f"{place}: damaged ({error}); --force computes everything anew") from None


@contextlib.contextmanager
def opened_result_folder(
    path: Path,
    *,
    mark: str,
    kind: str,
    asked: str,
    own: Sequence[str],
    wanted: float,
    force: bool = False,
    resume: bool = False,
) -> Iterator[ResultFolder]:
    """Make or reuse a folder, hold it for this process, and mark it as running.

    A finished result of the same request is left untouched and returned, unless `force`; an unfinished one is begun
    anew, or gone on with under `resume`.

    Args:
        path: of the folder.
        mark: name of its JSON file.
        kind: what it holds, for messages.
        asked: hash of the request.
        own: patterns of the files that such a study makes; nothing else is ever removed.
        wanted: room that they will take [bytes].

    Raises:
        FolderError: it holds something else (without `force`), is no folder, cannot be written, or has not that room.
        FolderLockedError: another process writes into it.
        FolderUnwritableError: a read-only place, or a full one.
        OutputError: in the place of an OSError on the way.
    """
    _look_into(path, mark=mark, kind=kind, asked=asked, force=force)
    with held(path):
        found = _look_into(path, mark=mark, kind=kind, asked=asked, force=force)
        same = found.get("asked") == asked and not force
        by_another = any(found.get(key) != value for key, value in program_of_results().items())
        if same and resume and found.get("status") != COMPLETED and by_another:
            raise FolderError(
                f"{path} holds this {kind}, unfinished, by another version of the program or of its libraries; --force "
                "begins anew"
            )
        if same and found.get("status") == COMPLETED:
            yield ResultFolder(path=path, mark=mark, finished=found)
            return
        require_room(path, wanted, f"the {kind}", "ask for less", own)
        folder = ResultFolder(path=path, mark=mark)
        try:
            folder.write_result({"status": "running", "asked": asked} | program_of_results())
            if not (same and resume):
                for pattern in own:
                    for file in path.glob(pattern):
                        file.unlink(missing_ok=True)
        except OSError as error:
            raise FolderError(
                f"{path}: cannot be written ({error.strerror}); choose another folder with --out DIR"
            ) from None
        with naming_what_cannot_be_written(path, "--resume goes on"):
            yield folder


def _look_into(path: Path, *, mark: str, kind: str, asked: str, force: bool) -> dict[str, Any]:
    """What the mark of the folder says; refuses what is not of this request, unless forced."""
    remedy = "choose another folder with --out DIR, or overwrite it with --force"
    if path.exists() and not path.is_dir():
        raise FolderError(f"{path} is a file, not a folder; choose another with --out DIR")
    try:
        empty = not path.exists() or all(entry.name.startswith(".") for entry in path.iterdir())
    except OSError as error:
        raise FolderError(
            f"{path}: cannot be read ({error.strerror}); choose another folder with --out DIR"
        ) from None
    if empty:
        return {}
    found = _read_mark(path / mark)
    if found.get("asked") != asked and not force:
        holds = f"another {kind}" if found else f"no {kind}"
        raise FolderError(f"{path} holds {holds}; {remedy}")
    return found


def _read_mark(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}
