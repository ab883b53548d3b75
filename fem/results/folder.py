"""The folder of a result: a run, a sweep, an ensemble, a response curve, the claims of the paper.

One JSON file marks the folder; it holds the status and the hash of what was asked. It is written first, with status
"running", so that whatever comes between, the folder is known as this request's, and as unfinished. Every file is
replaced whole, one process writes at a time, and only files of results are ever removed.

The file `.lock` is held with `filelock`: the operating system releases it however its owner ends, so a lock that a
killed process left behind is no obstacle, and no option breaks a live one. The file `.owner` names the owner for
people and carries a token, by which an owner notices that its folder was removed or replaced.
"""

import contextlib
import errno
import json
import os
import secrets
import socket
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from filelock import FileLock, Timeout

from fem.results.archive import read_archive, write_archive
from fem.results.disk import free_disk, in_units
from fem.results.errors import (
    OTHER_FOLDER,
    FolderError,
    FolderLockedError,
    FolderLostError,
    OutputError,
    obstacle,
    writing_into,
)
from fem.results.json_block import to_json
from fem.results.kinds import KINDS, ResultKind, read_result
from fem.runtime.identity import program_identity, versions
from fem.runtime.own_files import (
    PART,
    make_folder,
    matching_files,
    place_in,
    remove,
    remove_files,
    remove_half_written,
    write_atomically,
)
from fem.runtime.terminal import one_line, say
from fem.runtime.user_files import read_json

LOCK_NAME, OWNER_NAME = ".lock", ".owner"
#: attempts to make a folder that another process removes at the same time, and the pause between two [s]
MOST_TRIES, RETRY_S = 100, 0.005


class FolderLock:
    """A folder that this process holds. `locked_folder` makes it."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._token = folder, secrets.token_hex(8)
        owner = {
            "pid": os.getpid(),
            "host": socket.gethostname(),
            "since": time.strftime("%Y-%m-%d %H:%M:%S"),
            "token": self._token,
        }
        write_atomically(folder / OWNER_NAME, json.dumps(owner) + "\n")

    @property
    def is_held(self) -> bool:
        """Whether the folder is still there and still this process's."""
        return _owner_of(self._folder).get("token") == self._token and (self._folder / LOCK_NAME).exists()

    def check(self) -> None:
        """Make sure that the folder is still held; FolderLostError where it is not."""
        if not self.is_held:
            lost = "emptied or taken by another process" if self._folder.is_dir() else "removed"
            raise FolderLostError(self._folder, lost)


@contextmanager
def locked_folder(folder: Path) -> Iterator[FolderLock]:
    """Hold a folder, made if it is missing; folders made for it that stay empty are removed again.

    Raises:
        FolderLockedError: another process holds it, or another part of this one.
        FolderError: it cannot be made.
        OutputError: a read-only place, or a full one.
    """
    missing = [place for place in (folder, *folder.parents) if not place.exists()]
    file = FileLock(folder / LOCK_NAME, timeout=0, thread_local=False)
    try:
        try:
            _acquire(folder, file)
            lock = FolderLock(folder)
        except Timeout:
            owner, named = _owner_of(folder), "another process writes there"
            if owner:
                who = f"process {owner.get('pid')} on {owner.get('host')} since {owner.get('since')}"
                own = (owner.get("pid"), owner.get("host")) == (os.getpid(), socket.gethostname())
                named = f"another run writes there, {who}{' (this very process)' * own}"
            raise FolderLockedError(f"{folder}: {named}; wait for it, end it, or {OTHER_FOLDER}") from None
        except (FileExistsError, NotADirectoryError):
            raise FolderError(f"{obstacle(folder)}; {OTHER_FOLDER}") from None
        except FileNotFoundError as error:
            raise FolderError(f"{folder}: cannot be made ({error.strerror}); {OTHER_FOLDER}") from None
        except OSError as error:
            if folder in missing:
                with contextlib.suppress(OSError):
                    remove(folder / LOCK_NAME)
            raise OutputError(f"{folder}: cannot be written ({error.strerror}); {OTHER_FOLDER}") from None
        try:
            yield lock
        finally:
            if lock.is_held:
                for name in (OWNER_NAME, LOCK_NAME):  # while it is held: nobody can have taken it meanwhile
                    with contextlib.suppress(OSError):
                        remove(folder / name)
    finally:
        file.release()
        for place in missing:
            with contextlib.suppress(OSError):
                place.rmdir()


def _acquire(folder: Path, file: FileLock) -> None:
    for last in [False] * (MOST_TRIES - 1) + [True]:
        try:
            make_folder(folder)
            file.acquire()
            return
        except (FileExistsError, FileNotFoundError):
            if last or (os.path.lexists(folder) and not folder.is_dir()):
                raise  # otherwise its last owner has just removed it, empty
            time.sleep(RETRY_S)


def _owner_of(folder: Path) -> dict[str, Any]:
    """Who holds a folder, as far as the file tells."""
    try:
        owner = read_json(folder / OWNER_NAME)
    except (OSError, ValueError):
        return {}
    return owner if isinstance(owner, dict) else {}


MOST_LISTED = 20  #: files of a user in a message
REMEDY = f"{OTHER_FOLDER}, or overwrite it with --force"


def program_of_results() -> dict[str, Any]:
    """What a marking file says of the program that wrote it: unfinished results hold for that program alone."""
    return {"program": program_identity()["sources"], "versions": versions()}


@dataclass(frozen=True, kw_only=True, eq=False)
class ResultFolder:
    """A folder of results, opened for writing by `open_result_folder`."""

    path: Path
    kind: ResultKind
    lock: FolderLock
    earlier: dict[str, Any] | None  #: an earlier result of the same request, unless --force is given
    resume: bool  #: --resume was given

    @property
    def finished(self) -> bool:
        """Whether the folder holds the finished result: there is nothing to compute."""
        return self.earlier is not None and self.earlier.get("status") in self.kind.finished

    @property
    def resuming(self) -> bool:
        """Whether an unfinished result is to be continued."""
        return self.resume and self.earlier is not None and not self.finished

    def begin(
        self, mark: Mapping[str, Any], texts: Mapping[str, str] | None = None, *, keep: bool | None = None
    ) -> None:
        """Mark the folder, remove the files of an earlier result of any kind, and write what was asked.

        Args:
            mark: content of the marking file, with status "running" and the hash of the request.
            texts: further files to write, by name, such as the case.
            keep: leave the earlier files, to continue with them; default: `resuming`.

        Raises:
            FolderError: nothing can be written; no file is then left in a folder that was empty.
        """
        texts = texts or {}
        was_empty = not _names_in(self.path)
        try:
            self.write_result(mark)
            remove_half_written(self.path, self.kind.own)
            if not (self.resuming if keep is None else keep):
                self.remove(*self.kind.own)
                for other in KINDS:  # only where it was told to overwrite what is there
                    if other is not self.kind and (self.path / other.mark).is_file():
                        self.remove(other.mark, *other.own)
            for name, text in texts.items():
                self.write(name, text)
        except OSError as error:
            for name in (self.kind.mark, *texts) if was_empty else ():
                with suppress(OSError):
                    remove(self.path / name)
            if error.errno == errno.ELOOP:
                raise FolderError(f"{error.filename} {error.strerror}") from None
            raise FolderError(f"{self.path}: cannot be written ({error.strerror}); {OTHER_FOLDER}") from None

    def check(self) -> None:
        """Make sure that the folder is still this process's; raises FolderLostError."""
        self.lock.check()

    def write_result(self, mark: Mapping[str, Any]) -> None:
        """Replace the marking file; numbers that are not finite become null."""
        write_atomically(self.path / self.kind.mark, to_json(mark))

    def write(self, name: str, text: str) -> None:
        """Replace a file, in a subfolder if its name says so."""
        write_atomically(place_in(self.path, name), text)

    def write_arrays(self, name: str, arrays: Mapping[str, np.ndarray]) -> None:
        """Replace an npz file of plain arrays, to continue from; the folder must still be held."""
        self.check()
        write_archive(self.path / name, {}, arrays)

    def read_arrays(self, name: str) -> dict[str, np.ndarray] | None:
        """The arrays of such a file, or None if there is none; FolderError where it is damaged."""
        return read_archive(self.path / name).arrays if (self.path / name).exists() else None

    def remove(self, *patterns: str) -> None:
        """Remove files by patterns of their names, and subfolders that are empty then."""
        remove_files(self.path, patterns)

    def require_room(self, size: float, what: str, way_out: str) -> None:
        """Refuse a result of a size [bytes] that the disk cannot hold, counting the files that it replaces.

        `what` is to be computed; `way_out`: other than another folder.

        Raises:
            FolderError: with the room needed and the room there is.
        """
        free = free_disk(self.path, self.kind.own)
        if free is not None and size > free:
            raise FolderError(
                f"{self.path}: {what} would write about {in_units(size)}, and there is room for {in_units(free)}; "
                f"{way_out}, or {OTHER_FOLDER}"
            )

    def require_same_program(self) -> None:
        """Refuse to continue with what another version of the program computed: a FolderError names what differs."""
        if self.earlier is None:
            return
        if self.earlier.get("program") != program_identity()["sources"]:
            raise FolderError(f"{self.path} holds results of another version of the program; {REMEDY}")
        theirs = self.earlier.get("versions")
        for name, mine in versions().items():
            other = theirs.get(name) if isinstance(theirs, dict) else None
            if other != mine:
                raise FolderError(
                    f"{self.path} holds results of another version of {name} ({other}, here {mine}); {REMEDY}"
                )

    def refuse_unfinished(self, progress: str) -> None:
        """Refuse to overwrite an unfinished result that is worth continuing.

        `progress`: how far it is ("12 of 20 rows").

        Raises:
            FolderError: neither --resume nor --force was given.
        """
        if self.earlier is not None and not self.finished and not self.resume:
            raise FolderError(
                f"{self.path} holds this {self.kind.name}, unfinished, with {progress}; --resume continues it, --force "
                "starts over"
            )


@contextmanager
def open_result_folder(
    path: Path, kind: ResultKind, request: str, *, force: bool = False, resume: bool = False, way_on: str = ""
) -> Iterator[ResultFolder]:
    """Hold the folder of a result, made if it is missing, and look at what is in it; `begin` changes it first.

    Args:
        path: of the folder.
        kind: of the result.
        request: hash of what is asked, as the marking file has it.
        force, resume: as on the command line.
        way_on: what to do after a full disk; default: "--resume continues".

    Raises:
        FolderError: it holds another request or something else (without `force`), is no folder, or cannot be made.
        FolderLockedError: another process writes into it.
        OutputError: a read-only place, a full disk, or a folder that was removed; in place of any OSError.
    """
    find_result(path, kind, request, force=force)  # before a lock is written into somebody's folder
    with writing_into(path, way_on):
        if force:
            _require_consent(path, kind)
    with locked_folder(path) as lock:
        earlier = find_result(path, kind, request, force=force)
        with writing_into(path, way_on or "--resume continues"):
            try:
                yield ResultFolder(
                    path=path, kind=kind, lock=lock, earlier=earlier, resume=resume and not force
                )
            except Exception:
                lock.check()  # whatever fails in a folder that is gone, that is the reason
                raise


def find_result(path: Path, kind: ResultKind, request: str, *, force: bool = False) -> dict[str, Any] | None:
    """What the marking file in a folder says; None without one, and with `force`. Nothing is written.

    Raises:
        FolderError: the folder holds another request or something else (without `force`), or is no folder.
    """
    try:
        if not path.exists():
            return None
        if not path.is_dir():
            raise FolderError(f"{path} is a file, not a folder; {OTHER_FOLDER}")
        names = _names_in(path)
    except OSError as error:
        raise FolderError(f"{path}: cannot be read ({error.strerror}); {OTHER_FOLDER}") from None
    if not names or force:
        return None
    if kind.mark not in names:
        raise FolderError(f"{path} is not empty and holds no {kind.name}; {REMEDY}")
    try:
        mark = read_result(path / kind.mark, kind)
    except FolderError as error:
        raise FolderError(f"{error}; {REMEDY}") from None
    if mark[kind.request] != request:
        raise FolderError(f"{path} holds the results of another {kind.subject}; {REMEDY}")
    return mark


def _names_in(path: Path) -> list[str]:
    """Names in a folder, without the locks and half-written files of this program."""
    names = [entry.name for entry in path.iterdir()]
    return [name for name in names if name not in (LOCK_NAME, OWNER_NAME) and not PART.fullmatch(name)]


def _require_consent(path: Path, kind: ResultKind) -> None:
    """Ask before files are deleted from a folder that no result of this program marks."""
    if any((path / known.mark).is_file() for known in KINDS):
        return
    names = [one_line(str(file.relative_to(path))) for file in matching_files(path, kind.own)]
    if not names:
        return
    listed = ", ".join(names[:MOST_LISTED]) + (", .." if len(names) > MOST_LISTED else "")
    asked = f"{path} holds no result of this program, and --force deletes files there: {listed}"
    if not (sys.stdin and sys.stdin.isatty()):
        raise FolderError(f"{asked}; delete them yourself, or {OTHER_FOLDER}")
    say(asked, file=sys.stderr)
    name = path.resolve().name
    if input(f"the name of the folder, to delete them ({name}): ") != name:
        raise FolderError(f"{path}: nothing was deleted; {OTHER_FOLDER}")
