"""How large a sweep is, and what it would take, before it is begun."""

import numpy as np

from fem.case_reading import CaseError
from fem.progress import clock_time
from fem.sweep.plan import Sweep

#: cells that a sweep may have unless it is forced
MOST_CELLS = 1_000_000
#: rough CPU time of a simulated second [s], and bytes of a row: to say what a very large sweep would take
SECONDS_PER_SECOND = {"rigid": 3e-4, "reduced": 3e-3, "full": 6.0}
BYTES_A_ROW = 350


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
