"""One way to write a file: beside its place, to the disk, then renamed.

A reader, or the next run after a kill, finds the old file or the new one and never half of one.
"""

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give the place to write a file to; it is renamed at the end, or removed after an error.

    Raises:
        OSError: it cannot be written; the old file is still there.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        yield part
        os.replace(part, path)
    except BaseException as error:
        with suppress(OSError):
            part.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror or str(error), str(path)) from None
        raise


def write_atomically(path: Path, content: str | bytes) -> None:
    """Replace a file in one step; the new content reaches the disk before the old one goes.

    Raises:
        OSError: it cannot be written; the old file is still there.
    """
    with replacing(path) as part, open(part, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
        file.flush()
        os.fsync(file.fileno())


def remove_files(folder: Path, patterns: Sequence[str]) -> None:
    """Remove files that match these patterns, what a kill left of them, and subfolders that are empty then."""
    for pattern in map(Path, patterns):
        for name in (pattern.name, f".{pattern.name}.part"):
            for file in folder.glob(str(pattern.parent / name)):
                file.unlink(missing_ok=True)
    for parent in {str(Path(pattern).parent) for pattern in patterns} - {"."}:
        for place in folder.glob(parent):
            with suppress(OSError):  # it is not empty
                place.rmdir()


def to_json(content: Mapping[str, Any]) -> str:
    """Strict JSON: numpy scalars and arrays as numbers and lists, nan and infinity as null."""
    return json.dumps(_plain(content), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, str | Path):
        return str(value)
    if isinstance(value, Sequence | set | frozenset):
        return [_plain(item) for item in (sorted(value) if isinstance(value, set | frozenset) else value)]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
