"""Files that users name: they may be anything, such as a device without an end, a pipe that nobody fills, or a link."""

import os
import stat
from pathlib import Path


def read_regular(path: Path, most: int) -> bytes:
    """The content of a regular file; no more of it than the file states, for one of the kernel may never end.

    Args:
        path: of the file; links are followed.
        most: that it may hold [bytes].

    Raises:
        ValueError: without the path: there is none, it is no regular file, too large, or cannot be read.
    """
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise ValueError("is a folder, not a file")
        if not stat.S_ISREG(status.st_mode):
            raise ValueError("is a device or a pipe, not a regular file")
        if status.st_size > most:
            raise ValueError(f"is larger than {1e-6 * most:.3g} MB")
        with path.open("rb") as stream:
            return stream.read(status.st_size)
    except FileNotFoundError:
        raise ValueError("does not exist or is not a file") from None
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None


def real_path(path: Path) -> Path:
    """The path without links; `Path.resolve` fails where they form a circle."""
    return Path(os.path.realpath(path))


def leads_out(folder: Path, path: Path) -> bool:
    """Whether a path lies outside a folder once links are followed."""
    return not real_path(path).is_relative_to(real_path(folder))
