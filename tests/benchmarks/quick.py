"""What a user waits for, in one table: compilation, first page, run, `check`, `full`, batches, motions, memory.

    python tests/benchmarks/quick.py [commands rigid full reduced motions memory ..]

Without a name all parts are measured (some minutes). Commands are measured as whole processes with their workers: CPU
time by the operating system, memory as the largest sum over the processes, sampled twenty times a second. Needs psutil,
which comes with the extra `cluster`.
"""

import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import full_box
import numpy as np
import psutil
import reduced_runs
import rigid_throughput
from measuring import Figure, at_least, at_most, cpu_seconds, median_of, report, stepped
from motion_set import motion

from fem.case.case import load_case
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions

REPEATS, SAMPLING_S = 5, 0.05
COMPILE_S, PAGE_S, RUN_S, CHECK_S = 15.0, 70.0, 2.5, 0.4
STEP_MS = 4.0  # of the shell stack with all nodes
FREE_SHELL = (
    *("solver.model=full", "floor.kind=rigid", "motion.kind=none"),
    *("initial.rotation_rad=0.05", "solver.duration_s=1.5"),
)
MOTION_S, TEN_THOUSAND_S, MEMORY_MB = 0.02, 300.0, 1000.0
MOTIONS = 100, 300  #: of the ensembles from whose difference ten thousand motions follow
ENSEMBLE = """
case = "seed_stack_plateau"
draws = {count}
probability = 0.5
[set]
"solver.model" = "rigid"
"floor.kind" = "rigid"
[axes]
"motion.scale_to_m_s2" = [3.8]
[random]
"motion.file" = [{files}]
"contact.mu_static" = {{ distribution = "uniform", from = 0.3, to = 0.6 }}
"""
STUDIES = {
    "run rocking, with its band": ("run", "rocking"),
    "sweep outcome_map": ("sweep", "outcome_map", "-j", "2"),
    "ensemble fragility": ("ensemble", "fragility", "-j", "2"),
    "assess site": ("assess", "site", "-j", "2"),
}


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Of a command, with its workers."""

    wall_s: float
    cpu_s: float
    peak_MB: float  # noqa: N815 - the symbol of the unit


def cost_of(*arguments: str, environment: dict[str, str] | None = None) -> Cost:
    """Of `python -m fem` with these arguments."""
    began, peak, done = time.perf_counter(), 0, threading.Event()
    process = subprocess.Popen(
        [sys.executable, "-m", "fem", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | (environment or {}),
    )

    def watch() -> None:
        nonlocal peak
        root = psutil.Process(process.pid)
        while not done.wait(SAMPLING_S):
            try:
                peak = max(peak, sum(one.memory_info().rss for one in (root, *root.children(recursive=True))))
            except psutil.Error:  # one of them has just ended
                continue

    watcher = threading.Thread(target=watch)
    watcher.start()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    done.set()
    watcher.join()
    if process.returncode:
        raise RuntimeError(f"{' '.join(arguments)}: exit code {process.returncode}")
    return Cost(
        wall_s=time.perf_counter() - began,
        cpu_s=usage.ru_utime + usage.ru_stime,
        peak_MB=peak / 1e6,  # not `ru_maxrss`, in which a child starts with the memory of this process
    )


def commands(folder: Path) -> Iterator[Figure]:
    """First page, compilation, run and `check`; the first page of an installation adds the time of pip."""
    empty = {"NUMBA_CACHE_DIR": str(folder / "kernels")}
    page = cost_of("run", "-q", "--out", str(folder / "first"), environment=empty)
    yield at_most("first page: `run` with an empty cache [s]", page.wall_s, PAGE_S, ".0f")
    short = ["run", "rocking", "--no-band", "-q", "--force", "--out", str(folder / "run")]
    empty = {"NUMBA_CACHE_DIR": str(folder / "kernels of a run")}
    first, again = (cost_of(*short, environment=empty) for _ in range(2))
    yield at_most("compiling for a run [CPU s]", first.cpu_s - again.cpu_s, COMPILE_S, ".1f")
    yield at_most("run rocking --no-band [CPU s]", median_of(REPEATS, lambda: cost_of(*short).cpu_s), RUN_S)
    size = sum(file.stat().st_size for file in (folder / "run" / "fields").iterdir()) / 1e6
    yield Figure("its frames [MB]; peak [MB]", f"{size:.1f}; {again.peak_MB:.0f}")
    yield at_most("check [CPU s]", median_of(REPEATS, lambda: cost_of("check", "rocking").cpu_s), CHECK_S)


def full(_: Path) -> Iterator[Figure]:
    yield full_box.rocking("full, box of 966 unknowns", "auto", full_box.ADAPTIVE)[0]
    stack = stepped(load_case("rocking", FREE_SHELL))
    cost, details = 1e3 * stack.cpu_s / stack.steps, f" ({stack.cpu_s:.1f} CPU s for 1.5 s of free rocking)"
    yield at_most("full, shell stack of 5238 unknowns: ms a step", cost, STEP_MS, details=details)


def reduced(_: Path) -> Iterator[Figure]:
    yield from reduced_runs.single_runs()[::2]


def rigid(_: Path) -> Iterator[Figure]:
    for name in ("seed_stack", "seed_box"):
        settings = [*rigid_throughput.JERK, *rigid_throughput.FLOOR, *rigid_throughput.SETTING]
        case = load_case(name, [*settings, f"solver.duration_s={rigid_throughput.DURATION}"])
        rate, _, over = rigid_throughput.throughput(case)
        what = f"{name}, rigid: rate over that of the Moreau kernel ({rate:.0f} runs/s/core)"
        yield at_least(what, over, rigid_throughput.OVER_MOREAU)


def ensemble(folder: Path, count: int) -> str:
    """The file of an ensemble of so many motions of 20 to 40 s, each with a friction of its own."""
    files = [f"m{seed}.csv" for seed in range(count)]
    for seed, name in enumerate(files):
        if not (folder / name).exists():
            columns = motion(seed)[: 4000 + 40 * (37 * seed % 101)]
            header = "time_s,acceleration_m_s2"
            np.savetxt(folder / name, columns, "%.6g", ",", header=header, comments="")
    text = ENSEMBLE.format(count=count, files=", ".join(f'"{name}"' for name in files))
    (folder / f"ensemble{count}.toml").write_text(text, encoding="utf-8")
    return str(folder / f"ensemble{count}.toml")


def motions(folder: Path) -> Iterator[Figure]:
    """An artificial motion; ten thousand given ones on two cores, from the difference of two ensembles."""
    action = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)
    artificial_motions(action, count=1, seed=1)
    seconds = median_of(REPEATS, lambda: cpu_seconds(lambda: artificial_motions(action, count=5, seed=2)) / 5)
    yield at_most("an artificial motion, with its vertical one [CPU s]", seconds, MOTION_S, ".4f")
    _, few, many = (  # the first compiles
        cost_of("ensemble", ensemble(folder, count), "-j", "2", "--force", "--out", str(folder / "out"))
        for count in (MOTIONS[0], *MOTIONS)
    )
    more = (10_000 - MOTIONS[1]) / (MOTIONS[1] - MOTIONS[0])
    whole = many.wall_s + more * (many.wall_s - few.wall_s)
    memory = many.peak_MB + more * max(0.0, many.peak_MB - few.peak_MB)
    yield at_most("ten thousand motions, two cores, extrapolated [s]", whole, TEN_THOUSAND_S, ".0f")
    yield at_most("their memory, extrapolated [MB]", memory, MEMORY_MB, ".0f")


def memory(folder: Path) -> Iterator[Figure]:
    """Largest memory of four commands, two of them on two cores."""
    for number, (what, arguments) in enumerate(STUDIES.items()):
        found = cost_of(*arguments, "-q", "--out", str(folder / f"study{number}"))
        details = f" ({found.wall_s:.0f} s, {found.cpu_s:.0f} CPU s)"
        yield at_most(f"{what}: peak [MB]", found.peak_MB, MEMORY_MB, ".0f", details=details)


PARTS: dict[str, Callable[[Path], Iterator[Figure]]] = {
    "commands": commands,
    "rigid": rigid,  # before others leave this process's memory in pieces: a run touches some hundred arrays
    "full": full,
    "reduced": reduced,
    "motions": motions,
    "memory": memory,
}


def main() -> int:
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        for part in sys.argv[1:] or PARTS:
            figures += PARTS[part](Path(folder))
    return report("what a user waits for", figures)


if __name__ == "__main__":
    sys.exit(main())
