"""Files that this program writes: beside their place, to the disk, then renamed, and never through a link.

A reader, or the next run after a kill, finds the old file or the new one and never half of one. A folder may come from
somebody else: what is a link in it is refused, and what it points to stays as it is. The folder itself may be one.
"""

import errno
import os
import re
import secrets
import shutil
import stat
from collections.abc import Iterable
from contextlib import suppress
from io import FileIO
from pathlib import Path, PurePath
from typing import BinaryIO

from contact.folders import open_to_others
from fem.runtime.user_files import read_own

#: flags of what is opened for writing; no link at the end of a path is followed
FLAGS = sum(getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_CLOEXEC", "O_BINARY"))
PART = re.compile(r"\.part-[0-9a-f]{16}")  #: name of a half-written file
LINKED = "is a link, through which no results are written; remove it, or choose another folder with --out DIR"


def created(path: Path) -> BinaryIO:
    """Open a new file for writing, with the mode of the umask; FileExistsError where anything is, a link too."""
    return os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | FLAGS, 0o666), "wb")


def appended(path: Path, length: int) -> FileIO:
    """Open a file for appending behind its first `length` bytes, made where it is missing.

    Raises:
        OSError: it is a link, or has another name, or is no file.
    """
    require_no_link(path)
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | FLAGS | getattr(os, "O_NONBLOCK", 0), 0o666)
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode) or status.st_nlink > 1:
        os.close(descriptor)
        raise OSError(errno.ELOOP, LINKED.replace("a link", "another file's name, or no file"), str(path))
    file = FileIO(descriptor, "r+")
    file.truncate(length)
    file.seek(length)
    return file


def write_atomically(path: Path, content: str | bytes, *, to_disk: bool = True) -> None:
    """Replace a file in one step; it reaches the disk before the old one goes.

    Raises:
        OSError: it cannot be written; the old file is still there.
    """
    part = path.with_name(f".part-{secrets.token_hex(8)}")
    try:
        with created(part) as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            if to_disk:
                os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException as error:
        with suppress(OSError):
            part.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror or str(error), str(path)) from None
        raise


def copy_file(source: Path, target: Path) -> None:
    """Replace a file by a copy of a regular one; errors as `read_own` and `write_atomically`."""
    write_atomically(target, read_own(source))


def kept_folder(name: str) -> Path | None:
    """A folder beside that of the compiled kernels, for what can be made again; None where others may write into it."""
    named = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    with suppress(OSError, RuntimeError):  # without a home
        root = Path(named) if named else Path.home() / ".cache"
        folder = root / "unanchored" / name
        folder.mkdir(parents=True, exist_ok=True)
        if open_to_others(folder, folder.parent, root) is None:
            return folder
    return None


def make_folder(folder: Path) -> None:
    """Make a folder that the user names, where it is missing."""
    folder.mkdir(parents=True, exist_ok=True)


def place_in(folder: Path, name: str | PurePath) -> Path:
    """The place of a file by its name in a folder of results; subfolders are made, and OSError where one is a link."""
    for parent in [*PurePath(name).parents][-2::-1]:
        require_no_link(folder / parent)
        (folder / parent).mkdir(parents=True, exist_ok=True)
    return folder / name


def require_no_link(path: Path) -> None:
    """Refuse a link, by an OSError with its name."""
    if path.is_symlink():
        raise OSError(errno.ELOOP, LINKED, str(path))


def matching_files(folder: Path, patterns: Iterable[str]) -> list[Path]:
    """The files in a folder that match patterns of names; OSError where a subfolder in a pattern is a link."""
    for parent in {Path(pattern).parent for pattern in patterns}:
        if parent != Path():
            require_no_link(folder / parent)
    return [file for pattern in patterns for file in sorted(folder.glob(pattern))]


def remove(path: Path) -> None:
    """Remove a file, or a link and not what it points to, where there is one."""
    path.unlink(missing_ok=True)


def remove_half_written(folder: Path, patterns: Iterable[str]) -> None:
    """Remove what a kill left of files that match these patterns."""
    parents = {Path(pattern).parent for pattern in patterns}
    for file in matching_files(folder, [str(parent / ".part-*") for parent in parents]):
        if PART.fullmatch(file.name):
            remove(file)


def remove_files(folder: Path, patterns: Iterable[str]) -> None:
    """Remove files that match these patterns, what a kill left of such, and subfolders that are empty then."""
    remove_half_written(folder, patterns)
    for file in matching_files(folder, patterns):
        remove(file)
    for parent in {Path(pattern).parent for pattern in patterns} - {Path()}:
        with suppress(OSError):  # it is not empty
            (folder / parent).rmdir()


def remove_tree(folder: Path) -> None:
    """Remove a folder of this program's own with all that is in it, as far as it can be."""
    shutil.rmtree(folder, ignore_errors=True)
