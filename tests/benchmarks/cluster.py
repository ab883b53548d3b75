"""Efficiency of `--scheduler` with local workers: the time of one worker over n times that of n workers.

Draws that wait instead of computing need no core, so they show what scheduler and main process cost whatever the
machine. Workers that compute share the cores with scheduler and main process: the limit holds where each has its own.
"""

import statistics
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from distributed import LocalCluster
from measuring import Figure, at_least, report

from fem.case.case import Case, load_case
from fem.results.figures import SCALARS
from fem.runtime.threads import cores
from fem.study.cluster import cluster
from fem.study.runner import CASES_AT_A_TIME, run_chunk
from fem.study.workers import hand_out

WORKERS, REPEATS = (1, 2, 4), 3
EFFICIENCY = 0.85
WAITING, DRAW_S = 600, 0.025  #: draws, and how long they wait: as long as a rigid one under a record takes
COMPUTING = 1600
BASE = load_case("seed_stack_plateau", ["solver.model=rigid", "floor.kind=rigid", "solver.duration_s=40"])


def wait_for(draws: Sequence[int]) -> list[dict[str, float]]:
    """Rows of draws, as large as those of runs."""
    time.sleep(DRAW_S * len(draws))
    return [dict.fromkeys(SCALARS, float(draw)) for draw in draws]


def case_of(draw: int) -> Case:
    """Case of a draw: a phase of the floor."""
    return BASE.with_values({"motion.phase_rad": 0.004 * draw})


def compute(address: str, work: Callable[[list[int]], Any], draws: int) -> None:
    """Hand out draws to the workers of a scheduler."""
    with cluster(address) as workers_of:
        pools = workers_of("rigid", draws)
        for _ in hand_out(range(draws), work, pools, at_a_time=CASES_AT_A_TIME["rigid"]):
            pass


def wall(work: Callable[[], None]) -> float:
    """Median of the wall times [s]; in a first turn workers load the program."""
    times = []
    for _ in range(REPEATS + 1):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return statistics.median(times[1:])


def main() -> int:
    waits, computes = {}, {}
    for count in WORKERS:
        with LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=None) as local:
            address = local.scheduler_address
            waits[count] = wall(partial(compute, address, wait_for, WAITING))
            computes[count] = wall(partial(compute, address, partial(run_chunk, case_of), COMPUTING))
    figures = [Figure("one worker: draws that wait; compute", f"{waits[1]:.1f} s; {computes[1]:.1f} s")]
    for count in WORKERS[1:]:
        waited, computed = (times[1] / (count * times[count]) for times in (waits, computes))
        what = f"{count} workers, draws that compute: efficiency"
        free = count + 2 <= cores()
        figures += [
            at_least(f"{count} workers, draws that wait: efficiency", waited, EFFICIENCY),
            at_least(what, computed, EFFICIENCY) if free else Figure(what, f"{computed:.2f}"),
        ]
    return report(f"--scheduler with local workers on {cores()} cores", figures)


if __name__ == "__main__":
    sys.exit(main())
