"""A folder belongs to one process at a time: the lock of a run, or of anything else that writes a folder.

The lock is the file `.lock` in the folder. Its owner holds it with `flock`, which the kernel lets go however the
owner ends, and writes into it who he is: host, process and when that started, and, as the file's time, his last
sign of life. The second is what a refusal names, and what decides where `flock` does not reach: a folder shared
between hosts (Linux carries `flock` over NFS, but mounts with `local_lock` or `nolock` keep it to the host) or
a file system without it. So a lock is stale when nobody holds it and its owner
- ran on this host and is gone, or its number now belongs to a process that started at another time;
- ran on another host and has given no sign of life for `SILENCE_S` (the clocks must agree to about a minute).
A stale lock is taken over; a live one is never broken, by no option.
"""

import contextlib
import errno
import json
import os
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: the owner's word alone counts
    fcntl = None  # type: ignore[assignment]

LOCK_NAME = ".lock"
HEARTBEAT_S = 20.0  #: between signs of life
SILENCE_S = 120.0  #: after which an owner on another host counts as dead
UNWRITABLE = {errno.EROFS, errno.EACCES, errno.EPERM, errno.ENOSPC, errno.EDQUOT}
#: to make a folder that others take away meanwhile, and between two; some places, as in /proc, have none ever
MOST_TRIES, RETRY_S = 100, 0.005
LARGEST_LOCK = 10_000  #: bytes that are read of one


class FolderLockedError(ValueError):
    """Another process writes into the folder; the message names it and the way out."""


class FolderUnwritableError(RuntimeError):
    """The folder cannot be made or written; the message names it, the reason and the way out."""

    exit_code = 3


class FolderLostError(OSError):
    """The folder, or its lock, was removed or replaced while it was held."""


@dataclass(frozen=True, kw_only=True)
class Owner:
    """Who holds a folder."""

    pid: int
    host: str
    boot: str  #: of the machine, so that two hosts of one name and two boots of one host differ; may be empty
    started: str  #: when the process did, in the words of the system; empty where it does not tell
    since: str  #: when it took the folder, for people

    @property
    def is_here(self) -> bool:
        """It wrote this on this host, since its last boot."""
        return (self.host, self.boot) == (socket.gethostname(), _boot())

    def is_alive(self, silent_s: float) -> bool:
        """Whether the process still runs; of another host's, whether it was heard of less than SILENCE_S ago.

        Args:
            silent_s: time since its last sign of life [s].
        """
        if not self.is_here or os.name != "posix":
            return silent_s < SILENCE_S
        try:
            os.kill(self.pid, 0)
        except ProcessLookupError:
            return False
        except PermissionError:  # it runs, under another user
            pass
        return self.started == _started(self.pid)


class FolderLock:
    """A folder that is held. `held_folder` makes it."""

    def __init__(self, path: Path, file: int) -> None:
        self._path = path
        self._file = file
        self._over = threading.Event()
        self._heart = threading.Thread(target=self._beat, name=f"heartbeat of {path}", daemon=True)
        self._heart.start()

    def check(self) -> None:
        """Make sure that the folder is still there and still held.

        Raises:
            FolderLostError: it is not.
        """
        if not _lies_at(self._path, self._file):
            gone = (
                "was removed" if not self._path.parent.is_dir() else "was emptied or taken by another process"
            )
            raise FolderLostError(None, f"the folder {gone} during the run", str(self._path.parent))

    def release(self) -> None:
        """Give the folder back; the file goes, if it is still this one."""
        self._over.set()
        self._heart.join()
        if _lies_at(self._path, self._file):
            with contextlib.suppress(OSError):
                os.unlink(self._path)  # still under `flock`: nobody can have taken it in between
        os.close(self._file)

    def _beat(self) -> None:
        while not self._over.wait(HEARTBEAT_S):
            with contextlib.suppress(OSError):
                os.utime(self._file if os.utime in os.supports_fd else self._path)


@contextmanager
def held_folder(folder: Path) -> Iterator[FolderLock]:
    """Hold a folder, made if it is missing; folders made for it that stay empty go again.

    Raises:
        FolderLockedError: another process holds it, or another part of this one.
        FolderUnwritableError: a read-only place, or a full one.
        OSError: it cannot be made for another reason, as where a file stands in the way.
    """
    missing = [place for place in (folder, *folder.parents) if not place.exists()]
    try:
        try:
            lock = _make_and_take(folder)
        except OSError as error:
            if error.errno not in UNWRITABLE:
                raise
            raise FolderUnwritableError(
                f"{folder}: cannot be written ({error.strerror}); choose another folder with --out DIR"
            ) from None
        try:
            yield lock
        finally:
            lock.release()
    finally:
        for place in missing:
            with contextlib.suppress(OSError):
                place.rmdir()


def _make_and_take(folder: Path) -> FolderLock:
    tries = 0
    while True:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            return _take(folder / LOCK_NAME)
        except (FileExistsError, FileNotFoundError):
            tries += 1
            if (os.path.lexists(folder) and not folder.is_dir()) or tries == MOST_TRIES:
                raise  # else who held it has just taken it away again, empty
            time.sleep(RETRY_S)


def _take(path: Path) -> FolderLock:
    while True:
        file = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o666)
        try:
            free = _flock(file)
            silent = time.time() - os.fstat(file).st_mtime
            owner = _read(file)
            if not free or (owner is not None and owner.is_alive(silent)):
                raise FolderLockedError(_refusal(path, owner, silent))
            if _lies_at(
                path, file
            ):  # else its last owner has removed it just now: the next one is another file
                _write(file, _myself())
                return FolderLock(path, file)
        except BaseException:
            os.close(file)
            raise
        os.close(file)


def _flock(file: int) -> bool:
    """Hold an open file against other processes; True also where the system cannot."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # ENOLCK, EOPNOTSUPP, EINVAL: not on this file system
        return True
    return True


def _lies_at(path: Path, file: int) -> bool:
    try:
        return os.path.samestat(os.stat(path), os.fstat(file))
    except OSError:
        return False


def _read(file: int) -> Owner | None:
    """Who wrote himself into the lock; None if nobody did, or not to the end."""
    os.lseek(file, 0, os.SEEK_SET)
    try:
        content = json.loads(os.read(file, LARGEST_LOCK))
        pid = int(content["pid"])
        words = {name: str(content[name]) for name in ("host", "boot", "started", "since")}
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
    return Owner(pid=pid, **words) if 0 < pid < 2**31 else None


def _write(file: int, owner: Owner) -> None:
    os.ftruncate(file, 0)
    os.lseek(file, 0, os.SEEK_SET)
    os.write(file, (json.dumps(asdict(owner)) + "\n").encode())


def _refusal(path: Path, owner: Owner | None, silent_s: float) -> str:
    wait = "wait for it, end it, or choose another folder with --out DIR"
    if owner is None:
        return f"{path.parent}: another process is about to write there; {wait}"
    named = f"process {owner.pid} on {owner.host} since {owner.since}"
    if owner.is_here and owner.pid == os.getpid():
        named += " (this very process)"
    if not owner.is_here:
        named += f", last heard of {max(silent_s, 0.0):.0f} s ago (after {SILENCE_S:.0f} s it counts as dead)"
    return f"{path.parent}: another run writes there, {named}; {wait}"


def _myself() -> Owner:
    pid = os.getpid()
    return Owner(
        pid=pid,
        host=socket.gethostname(),
        boot=_boot(),
        started=_started(pid),
        since=time.strftime("%Y-%m-%d %H:%M:%S"),
    )


def _boot() -> str:
    """What tells this boot of the machine from others, on Linux."""
    return _first_line("/proc/sys/kernel/random/boot_id")


def _started(pid: int) -> str:
    """When a process started, in ticks since boot, on Linux."""
    # The name, in brackets, may hold anything; the start is the 20th word behind it.
    words = _first_line(f"/proc/{pid}/stat").rpartition(")")[2].split()
    return words[19] if len(words) > 19 else ""


def _first_line(path: str) -> str:
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.readline().strip()
    except OSError:
        return ""
