"""A folder belongs to one process at a time.

The file `.lock` is held with `filelock`: the operating system releases it however its owner ends, so a lock that a
killed process left behind is no obstacle, and no option breaks a live one. The file `.owner` names the owner for
people and carries a token, by which an owner notices that its folder was removed or replaced.
"""

import contextlib
import json
import os
import secrets
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from fem.results.errors import (
    OTHER_FOLDER,
    FolderError,
    FolderLockedError,
    FolderLostError,
    OutputError,
    obstacle,
)
from fem.runtime.own_files import make_folder, remove, write_atomically
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
        """Make sure that the folder is still held.

        Raises:
            FolderLostError: it is not.
        """
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
