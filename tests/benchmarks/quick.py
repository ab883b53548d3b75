"""What a user waits for, in one table: first compilation, a run, `check`, `full`, maps, motions, memory.

    python tests/benchmarks/quick.py [compile run full reduced rigid motions memory scheduler ..]

Without a name all parts are measured. CPU time and memory of commands are those of whole processes: the memory is
the largest sum over a process and its workers, sampled ten times a second. Medians of three, but for compilation.
Needs the extra `cluster`.
"""

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import full_box
import numpy as np
import psutil
import reduced_runs
import rigid_throughput
from measuring import Figure, at_most, cpu_seconds, median_of, report
from motion_set import motion

from fem.case.case import load_case
from fem.site.action import SiteAction, eurocode_shape
from fem.site.artificial import artificial_motions

REPEATS = 3
COMPILE_S, RUN_S, CHECK_S, FULL_S, MOTION_S, TEN_THOUSAND_S, MEMORY_MB = (
    15.0,
    2.5,
    0.4,
    0.6,
    0.02,
    300.0,
    1000.0,
)
MOTIONS = 100, 300  #: of the studies from whose difference ten thousand motions follow
EFFICIENCY = 0.85
STUDY = """
case = "seed_stack_plateau"
draws = {count}
probability = 0.5
[set]
"solver.model" = "rigid"
[axes]
"motion.scale_to_m_s2" = [3.8]
[random]
"motion.file" = [{files}]
"contact.mu_static" = {{ distribution = "uniform", from = 0.3, to = 0.6 }}
"""
MAP = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
[axes]
"motion.frequency_Hz" = { from = 0.5, to = 2.0, count = 40 }
"motion.peak_acceleration_m_s2" = { from = 2.0, to = 8.0, count = 40 }
[perturbation]
cells = "none"
"""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Of a command, with its workers."""

    wall_s: float
    cpu_s: float
    peak_MB: float  # noqa: N815 - the symbol of the unit


def cost_of(*arguments: str, environment: dict[str, str] | None = None, cwd: Path | None = None) -> Cost:
    """Of `python -m fem` with these arguments."""
    began, peak, done = time.perf_counter(), 0, threading.Event()
    process = subprocess.Popen(
        [sys.executable, "-m", "fem", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | (environment or {}),
        cwd=cwd,
    )

    def watch() -> None:
        nonlocal peak
        root = psutil.Process(process.pid)
        while not done.wait(0.1):
            try:
                family = [root, *root.children(recursive=True)]
                peak = max(peak, sum(one.memory_info().rss for one in family))
            except psutil.Error:
                continue

    watcher = threading.Thread(target=watch)
    watcher.start()
    _, status, usage = os.wait4(process.pid, 0)
    done.set()
    watcher.join()
    if os.waitstatus_to_exitcode(status):
        raise RuntimeError(f"{' '.join(arguments)}: exit code {os.waitstatus_to_exitcode(status)}")
    wall = time.perf_counter() - began
    return Cost(
        wall_s=wall, cpu_s=usage.ru_utime + usage.ru_stime, peak_MB=max(peak / 1e6, usage.ru_maxrss / 1e3)
    )


def compiling(folder: Path) -> Iterator[Figure]:
    """The default command with an empty cache of kernels, without what it costs afterwards."""
    empty = {"NUMBA_CACHE_DIR": str(folder / "kernels")}
    arguments = ["run", "rocking", "--no-band", "-q", "--force", "--out", str(folder / "first")]
    first, again = (cost_of(*arguments, environment=empty) for _ in range(2))
    yield at_most("compiling for a run [CPU s]", first.cpu_s - again.cpu_s, COMPILE_S, ".1f")
    yield Figure(
        "its first run [s], peak [MB]", f"{first.wall_s:.1f}, {first.peak_MB:.0f}", "for information"
    )


def running(folder: Path) -> Iterator[Figure]:
    """A run with its figures and frames, and the start of `check`."""

    def run() -> float:
        place = Path(tempfile.mkdtemp(dir=folder))
        found = cost_of("run", "rocking", "--no-band", "-q", "--force", "--out", str(place))
        sizes.append(sum(frame.stat().st_size for frame in (place / "fields").iterdir()) / 1e6)
        return found.cpu_s

    sizes: list[float] = []
    cost_of("run", "rocking", "--no-band", "-q", "--out", str(folder / "warm"))
    yield at_most("run rocking --no-band [CPU s]", median_of(REPEATS, run), RUN_S)
    yield Figure("its frames [MB]", f"{sizes[0]:.1f}", "18.1 by meshio")
    yield at_most("check [CPU s]", median_of(REPEATS, lambda: cost_of("check", "rocking").cpu_s), CHECK_S)


def full(folder: Path) -> Iterator[Figure]:
    yield from full_box.rocking("full, 966 unknowns, automatic step", "auto", FULL_S)[:2]


def reduced(folder: Path) -> Iterator[Figure]:
    yield from reduced_runs.single_runs()


def rigid(folder: Path) -> Iterator[Figure]:
    for name, limit in (("seed_stack", rigid_throughput.STACK_RATE), ("seed_box", rigid_throughput.BOX_RATE)):
        settings = [*rigid_throughput.JERK, *rigid_throughput.FLOOR, *rigid_throughput.SETTING]
        case = load_case(name, [*settings, f"solver.duration_s={rigid_throughput.DURATION}"])
        rate, _ = rigid_throughput.throughput(case)
        yield Figure(f"{name}: rigid runs per second and core", f"{rate:.0f}", f">= {limit:g}", rate >= limit)


def study(folder: Path, count: int) -> Path:
    """An ensemble of so many motions of 20 to 40 s, each with its own friction."""
    names = []
    for seed in range(count):
        names.append(f'"m{seed}.csv"')
        if not (folder / f"m{seed}.csv").exists():
            columns = motion(seed)[: 4000 + 40 * (37 * seed % 101)] * [1.0, 3.0]
            np.savetxt(
                folder / f"m{seed}.csv", columns, "%.6g", ",", header="time_s,acceleration_m_s2", comments=""
            )
    file = folder / f"study{count}.toml"
    file.write_text(STUDY.format(count=count, files=", ".join(names)), encoding="utf-8")
    return file


def motions(folder: Path) -> Iterator[Figure]:
    """Ten thousand motions on two cores, from the difference of two smaller studies."""
    action = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)
    artificial_motions(action, count=1, seed=1)
    seconds = median_of(REPEATS, lambda: cpu_seconds(lambda: artificial_motions(action, count=5, seed=2)) / 5)
    yield at_most("an artificial motion, with its vertical one [CPU s]", seconds, MOTION_S, ".4f")
    files = [study(folder, count) for count in MOTIONS]
    cost_of("ensemble", str(files[0]), "-j", "2", "--out", str(folder / "warm"))
    costs = [
        cost_of("ensemble", str(file), "-j", "2", "--force", "--out", str(folder / "out")) for file in files
    ]
    few, many = costs
    each = (many.wall_s - few.wall_s) / (MOTIONS[1] - MOTIONS[0])
    grown = (many.peak_MB - few.peak_MB) / (MOTIONS[1] - MOTIONS[0])
    whole, memory = many.wall_s + each * (10_000 - MOTIONS[1]), many.peak_MB + grown * (10_000 - MOTIONS[1])
    details = f" (each {1e3 * each:.1f} ms)"
    yield at_most(
        "ten thousand motions, two cores, extrapolated [s]", whole, TEN_THOUSAND_S, ".0f", details=details
    )
    yield at_most("their memory, extrapolated [MB]", memory, MEMORY_MB, ".0f")


def memory(folder: Path) -> Iterator[Figure]:
    """Largest memory of four commands on two cores."""
    for what, arguments in {
        "run rocking, with its band": ("run", "rocking"),
        "sweep outcome_map": ("sweep", "outcome_map", "-j", "2"),
        "ensemble fragility": ("ensemble", "fragility", "-j", "2"),
        "assess site": ("assess", "site", "-j", "2"),
    }.items():
        found = cost_of(*arguments, "--force", "--out", str(folder / what.replace(" ", "_")))
        yield at_most(
            f"{what}: peak [MB]", found.peak_MB, MEMORY_MB, ".0f", details=f" ({found.wall_s:.0f} s)"
        )


def scheduler(folder: Path) -> Iterator[Figure]:
    """A map of 40 x 40 rigid cells by the workers of a scheduler on this machine: one, two and four."""
    file, alone = folder / "map.toml", 0.0
    file.write_text(MAP, encoding="utf-8")
    for workers in (1, 2, 4):
        place = folder / f"scheduler{workers}.json"
        hidden: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        dask = [sys.executable, "-m", "dask"]
        server = subprocess.Popen(
            [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(place)],
            **hidden,
        )
        while not place.exists():
            time.sleep(0.1)
        hands = subprocess.Popen(
            [
                *(*dask, "worker", "--scheduler-file", str(place), "--nworkers", str(workers)),
                *("--nthreads", "1", "--local-directory", str(folder)),
            ],
            **hidden,
        )
        asked = ["sweep", str(file), "--scheduler", json.loads(place.read_text())["address"], "--force"]
        try:
            cost_of(*asked, "--out", str(folder / "warm"))
            before = psutil.Process(server.pid).memory_info().rss / 1e6
            found = cost_of(*asked, "--out", str(folder / "out"))
            after = psutil.Process(server.pid).memory_info().rss / 1e6
        finally:
            for process in (hands, server):
                process.terminate()
                process.wait()
        alone = alone or found.wall_s
        share = alone / (found.wall_s * min(workers, os.cpu_count() or 1))
        what = f"scheduler, {workers} workers: efficiency, wall [s], its memory before and after [MB]"
        measured = f"{share:.2f}, {found.wall_s:.1f}, {before:.0f}, {after:.0f}"
        yield Figure(what, measured, f">= {EFFICIENCY}", share >= EFFICIENCY)


PARTS: dict[str, Callable[[Path], Iterator[Figure]]] = {
    "compile": compiling,
    "run": running,
    "full": full,
    "reduced": reduced,
    "rigid": rigid,
    "motions": motions,
    "memory": memory,
    "scheduler": scheduler,
}


def main() -> int:
    asked = sys.argv[1:] or list(PARTS)
    with tempfile.TemporaryDirectory() as name:
        figures = [figure for part in asked for figure in PARTS[part](Path(name))]
    return report("quick", figures)


if __name__ == "__main__":
    sys.exit(main())
