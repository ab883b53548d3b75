"""What is written, told before it is computed; a disk that cannot hold it is no place to begin.

Of a run, measured on shells and blocks of 600 to 9000 nodes: a frame takes 20 (at rest) to 38 bytes a node, zlib being
what it is for fields in motion; a number of the history 18 to 19.4 bytes of text. Beside these lie a checkpoint and the
one that takes its place, figures, and a page of results. Sweeps, ensembles and response curves say themselves what a
row of theirs takes.
"""

import math
import shutil
from collections.abc import Sequence
from pathlib import Path

from fem.case.case import Case
from fem.results.history import history_columns
from fem.results.run_folder import FolderError

BYTES_OF_A_NODE, BYTES_OF_A_FRAME = 40.0, 2e3
BYTES_OF_A_NUMBER = 20.0
BYTES_OF_A_CHECKPOINT_NODE = 500.0
BYTES_BESIDE = 2e6
#: of what an earlier run left, patterns of the files that make room for the next
REPLACED = ("history.csv", "fields/frame_*.vtu")


def samples_of(case: Case) -> int:
    """Rows of the history of a run to its end."""
    return math.floor(case.solver.duration_s / case.output.history_s * (1.0 + 1e-12)) + 1


def frames_of(case: Case) -> int:
    """Frames of a run to its end."""
    if case.output.fields_s == 0.0:
        return 0
    return math.floor(case.solver.duration_s / case.output.fields_s * (1.0 + 1e-12)) + 1


def required_disk(case: Case, nodes: int) -> float:
    """What the folder of a run comes to hold [bytes]; `nodes` of the elements."""
    history = BYTES_OF_A_NUMBER * len(history_columns(case.container.boxes - 1)) * samples_of(case)
    frames = (BYTES_OF_A_NODE * nodes + BYTES_OF_A_FRAME) * frames_of(case)
    return history + frames + BYTES_OF_A_CHECKPOINT_NODE * nodes + BYTES_BESIDE


def require_disk(case: Case, nodes: int, folder: Path) -> None:
    """Refuse a run whose files the file system of its folder cannot hold; old results of the folder make room.

    Raises:
        FolderError: with what it would take and what there is.
    """
    require_room(
        folder,
        required_disk(case, nodes),
        f"the run ({frames_of(case)} frames of {in_units(BYTES_OF_A_NODE * nodes + BYTES_OF_A_FRAME)}, "
        f"{samples_of(case)} rows of history)",
        "set a larger output.fields_s (0: no frames) or output.history_s",
    )


def require_room(
    folder: Path, wanted: float, what: str, way_out: str, replaced: Sequence[str] = REPLACED
) -> None:
    """Refuse to begin what the file system of a folder cannot hold.

    Args:
        folder: of the results; may not exist yet.
        wanted: they come to [bytes].
        what: is to be computed, and what of it takes the room; way_out: other than another folder.
        replaced: patterns of the files in the folder that make room.

    Raises:
        FolderError: with what it would take and what there is.
    """
    free = free_disk(folder, replaced)
    if free is None or wanted <= free:
        return
    raise FolderError(
        f"{folder}: {what} would write about {in_units(wanted)}, and there is room for {in_units(free)}; {way_out}, or "
        "choose another folder with --out DIR"
    )


def free_disk(folder: Path, replaced: Sequence[str] = REPLACED) -> float | None:
    """Room in a folder that may not exist yet, files that are replaced counted in [bytes]."""
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
