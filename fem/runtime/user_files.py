"""Files that users name or that lie in their folders: each may be anything, such as a device without an end, a pipe
that nobody fills, or a link."""

import errno
import json
import math
import os
import stat
from pathlib import Path
from typing import Any

LARGEST_RESULT = 2**31  #: file of a result [bytes]
#: flags of what is opened for reading
UNBLOCKED = sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_CLOEXEC", "O_BINARY"))
MOST_NESTED = 40  #: lists and tables in each other, in JSON


def read_regular(path: Path, most: int) -> bytes:
    """The content of a regular file of a user; links are followed.

    Raises:
        ValueError: without the path: there is none, it is no regular file, larger than `most` bytes, or cannot be read.
    """
    try:
        return read_own(path, most)
    except FileNotFoundError:
        raise ValueError("does not exist or is not a file") from None
    except OSError as error:
        said = error.errno in (errno.EINVAL, errno.EFBIG, errno.EISDIR)
        raise ValueError(f"{'' if said else 'cannot be read: '}{error.strerror}") from None


def read_own(path: Path, most: int = LARGEST_RESULT) -> bytes:
    """The content of a regular file, such as one of a result; no more than it states, for one may never end.

    Raises:
        OSError: there is none, it is no regular file, larger than `most` bytes, or cannot be read.
    """
    _require_regular(path.stat(), most, path)  # before it is opened, for opening may block
    with os.fdopen(os.open(path, os.O_RDONLY | UNBLOCKED), "rb") as stream:
        return stream.read(_require_regular(os.fstat(stream.fileno()), most, path))


def read_text(path: Path, errors: str = "strict") -> str:
    """The text of a file of a result; OSError as `read_own`, ValueError where it is no text."""
    return read_own(path).decode("utf-8", errors).replace("\r\n", "\n")


def read_json(path: Path) -> Any:
    """What a file of a result holds as JSON; OSError as `read_own`, ValueError where it is none."""
    return parsed_json(read_text(path))


def parsed_json(text: str) -> Any:
    """What a text holds as JSON; ValueError where it is none, too deeply nested, or a number is not finite."""
    try:
        content = json.loads(text, parse_float=_finite, parse_int=_whole, parse_constant=_finite)
    except RecursionError:
        raise ValueError("its lists are nested too deeply") from None
    level = [content]
    for _ in range(MOST_NESTED):
        level = [
            item
            for one in level
            if isinstance(one, dict | list)
            for item in (one.values() if isinstance(one, dict) else one)
        ]
    if level:
        raise ValueError("its lists are nested too deeply")
    return content


def _finite(digits: str) -> float:
    if not math.isfinite(number := float(digits)):
        raise ValueError(f"{digits:.20} is no finite number")
    return number


def _whole(digits: str) -> int:
    _finite(digits)
    return int(digits)


def _require_regular(status: os.stat_result, most: int, path: Path) -> int:
    """The size of a regular file."""
    if stat.S_ISDIR(status.st_mode):
        raise OSError(errno.EISDIR, "is a folder, not a file", str(path))
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "is a device or a pipe, not a regular file", str(path))
    if status.st_size > most:
        raise OSError(errno.EFBIG, f"is larger than {1e-6 * most:.3g} MB", str(path))
    return status.st_size


def real_path(path: Path) -> Path:
    """The path without links; `Path.resolve` fails where they form a circle."""
    return Path(os.path.realpath(path))


def leads_out(folder: Path, path: Path) -> bool:
    """Whether a path lies outside a folder once links are followed."""
    return not real_path(path).is_relative_to(real_path(folder))
