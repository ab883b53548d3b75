"""How large a sweep is, and what it would take, before it is begun."""

from pathlib import Path

import numpy as np

from fem.case.validation import CaseError
from fem.results.disk import require_room
from fem.runtime.progress import clock_time
from fem.sweep.plan import Sweep

#: cells that a sweep may have unless it is forced
MOST_CELLS = 1_000_000
#: rough CPU time of a simulated second [s], and bytes of a row: to say what a very large sweep would take
SECONDS_PER_SECOND = {"rigid": 3e-4, "reduced": 3e-3, "full": 6.0}
BYTES_A_ROW = 350
#: bytes of the axes' values in a row; of the copies of a perturbed cell; of a cell in the maps; and of all else
BYTES_A_KEY, BYTES_OF_COPIES, BYTES_IN_MAPS, BYTES_BESIDE = 20, 700, 250, 500_000
#: files of an earlier sweep that make room for the next
REPLACED = ("*.csv", "maps/*.svg")


def check_size(sweep: Sweep, jobs: int, force: bool) -> None:
    """Refuse more cells than anybody asks for on purpose.

    Raises:
        CaseError: says how many, how long, how much disk.
    """
    if sweep.count <= MOST_CELLS or force:
        return
    model = sweep.base.solver.model
    axes = {axis.key: axis.values for axis in sweep.axes}
    durations = axes.get("solver.duration_s", (sweep.base.solver.duration_s,))
    speeds = [SECONDS_PER_SECOND[one] for one in axes.get("solver.model", (model,))]
    seconds = sweep.count * float(np.mean(durations)) * float(np.mean(speeds)) / jobs
    sizes = " x ".join(str(size) for size in sweep.shape)
    raise CaseError(
        f"{sweep.name}: [axes] make {sizes} = {sweep.count} cells, more than {MOST_CELLS}: about "
        f"{clock_time(seconds)} on {jobs} core{'s' * (jobs > 1)} with the {model} model, and "
        f"{sweep.count * BYTES_A_ROW / 1e9:.1f} GB of table; take fewer values, or say --force"
    )


def required_disk(sweep: Sweep) -> float:
    """What the folder of a sweep comes to hold [bytes]: rows as they come and the table of them, copies, maps.

    Measured: 366 bytes a row of two axes, 663 of the copies of a perturbed cell, 190 a cell of three maps. How many
    cells lie near a change of outcome nobody knows beforehand: all of them are counted.
    """
    row = BYTES_A_ROW + BYTES_A_KEY * (len(sweep.axes) + len(sweep.derived))
    model = sweep.base.solver.model
    cells = sweep.perturbation.cells
    perturbed = cells != "none" and not (cells == "auto" and model == "full")
    return sweep.count * (2 * row + BYTES_OF_COPIES * perturbed + BYTES_IN_MAPS) + BYTES_BESIDE


def check_disk(sweep: Sweep, folder: Path) -> None:
    """Refuse a sweep that the file system of its folder cannot hold.

    Raises:
        FolderError: with what it would take and what there is.
    """
    what = f"the sweep ({sweep.count} cells)"
    require_room(folder, required_disk(sweep), what, "take fewer values", REPLACED)
