"""Files that users name or that lie in their folders: each may be anything, such as a device without an end, a pipe
that nobody fills, or a link."""

import errno
import json
import os
import stat
from pathlib import Path
from typing import Any

from fem.runtime.terminal import one_line

LARGEST_RESULT, LARGEST_JSON = 2**31, 2**29  #: files of a result [bytes]
#: flags of what is opened for reading
UNBLOCKED = sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_CLOEXEC", "O_BINARY"))
MOST_NESTED = 40  #: lists and tables in each other, in JSON
NESTED = "its lists are nested too deeply"
LARGEST_NUMBER = 1e150  #: whose square is finite


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
    return parsed_json(read_own(path, LARGEST_JSON).decode())


def parsed_json(text: str) -> Any:
    """What a text holds as JSON; ValueError where it is none or too deeply nested, and with the key of a number that is
    not finite or huge.
    """
    try:
        content = json.loads(text)
    except RecursionError:
        raise ValueError(NESTED) from None
    level: list[tuple[str, Any]] = [("", {"": content})]
    for _ in range(MOST_NESTED + 1):
        above, level = level, []
        for place, block in above:
            for key, item in block.items() if isinstance(block, dict) else enumerate(block):
                if isinstance(item, dict | list):
                    name = f"[{key}]" if isinstance(block, list) else f".{one_line(str(key))}"
                    level.append((place + name, item))
                elif isinstance(item, int | float) and not abs(item) < LARGEST_NUMBER:
                    raise ValueError(f"{place[1:]}.{one_line(str(key))} is no number of a result".strip("."))
    if level:
        raise ValueError(NESTED)
    return content


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
