"""Errors of folders of results, each with a message that names the place, the reason and the way out."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile

OTHER_FOLDER = "choose another folder with --out DIR"


class FolderError(ValueError):
    """The folder of results cannot be used as asked."""


class FolderLockedError(FolderError):
    """Another process writes into the folder."""


class OutputError(RuntimeError):
    """Results cannot be written: a full disk, a read-only place, a folder that was removed."""

    exit_code = 3


class FolderLostError(OSError):
    """The folder was removed, or taken by another process, while this one was using it."""

    def __init__(self, folder: Path, how: str = "removed") -> None:
        super().__init__(None, f"the folder was {how} during the run", str(folder))


@contextmanager
def writing_into(folder: Path, way_on: str) -> Iterator[None]:
    """Turn errors of the file system into messages.

    `way_on`: what to do when the folder can be written again, such as "--resume continues the sweep".

    Raises:
        FolderError: a file stands where a folder should, or the folder cannot be made.
        OutputError: in place of any other OSError.
    """
    existed = os.path.isdir(folder)
    try:
        yield
    except (FileExistsError, NotADirectoryError) as error:
        raise FolderError(f"{obstacle(Path(error.filename or folder))}; choose another place") from None
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise FolderError(f"{error.filename} {error.strerror}") from None
        if isinstance(error, FileNotFoundError) and not existed:
            raise FolderError(f"{folder}: cannot be made ({error.strerror}); choose another place") from None
        raise OutputError(unwritable(folder, error, way_on)) from None


def require_writable(folder: Path, elsewhere: str = OTHER_FOLDER, size: int = 1) -> None:
    """Refuse a folder that cannot be written, before its results are computed; nothing is left in it.

    Tried is the nearest folder on the way to it that exists, with `size` [bytes]; `elsewhere` is the way out.

    Raises:
        OutputError: a read-only place, or a full disk.
    """
    place = next((part for part in (folder, *folder.absolute().parents) if part.exists()), folder)
    if place.is_dir():  # what else it may be is said where it is used
        try:
            with TemporaryFile(dir=place) as file:
                file.write(bytes(size))
        except OSError as error:
            raise OutputError(
                f"{place}: cannot be written ({error.strerror or error}); {elsewhere}"
            ) from None


def unwritable(folder: Path, error: OSError, way_on: str) -> str:
    """The message of a write that failed half-way."""
    if isinstance(error, FolderLostError):
        return f"{error.filename}: {error.strerror}; run the command again, or {OTHER_FOLDER}"
    return (
        f"{error.filename or folder}: cannot be written ({error.strerror or error}); what was written before can be "
        f"read; when it can be written again, {way_on}"
    )


def obstacle(path: Path) -> str:
    """What stands where a folder should, at this path or at one of its parents."""
    for place in (*reversed(path.parents), path):
        if os.path.islink(place) and not os.path.exists(place):
            return f"{place} is a link to {os.readlink(place)}, which does not exist"
        if os.path.exists(place) and not os.path.isdir(place):
            break
    return f"{place} is a file, not a folder"
