"""Room on the disk: results that would not fit are refused before anything is computed."""

import shutil
from collections.abc import Sequence
from pathlib import Path

from fem.results.errors import OTHER_FOLDER, FolderError


def require_room(folder: Path, size: float, what: str, way_out: str, replaced: Sequence[str] = ()) -> None:
    """Refuse results that the file system of their folder cannot hold.

    Args:
        folder: of the results; may not exist yet.
        size: of the results [bytes].
        what: is to be computed, and what of it needs the room; way_out: other than another folder.
        replaced: patterns of the files in the folder that the results replace; they make room.

    Raises:
        FolderError: with the room needed and the room there is.
    """
    free = free_disk(folder, replaced)
    if free is None or size <= free:
        return
    raise FolderError(
        f"{folder}: {what} would write about {in_units(size)}, and there is room for {in_units(free)}; {way_out}, or "
        + OTHER_FOLDER
    )


def free_disk(folder: Path, replaced: Sequence[str] = ()) -> float | None:
    """Room in a folder that may not exist yet, with the files that are replaced [bytes]; None if unknown."""
    try:
        place = next(part for part in (folder, *folder.absolute().parents) if part.is_dir())
        free = float(shutil.disk_usage(place).free)
        files = [file for pattern in replaced for file in folder.glob(pattern)]
        return free + sum(file.stat().st_size for file in files if file.is_file())
    except (OSError, StopIteration):
        return None


def in_units(size: float) -> str:
    """Bytes for people."""
    for unit, scale in (("GB", 1e9), ("MB", 1e6)):
        if size >= scale:
            return f"{size / scale:.3g} {unit}"
    return f"{size / 1e3:.3g} kB"
