"""Room on the disk, and sizes in words."""

import shutil
from collections.abc import Sequence
from pathlib import Path

BYTES_OF_A_NUMBER = 20  #: in a table; 18 to 19.4 were measured
BYTES_BESIDE = 2_000_000  #: of a folder, besides its tables: figures, pages, texts


def table_bytes(rows: float, columns: float) -> float:
    """Size of a table [bytes]."""
    return BYTES_OF_A_NUMBER * rows * columns


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
