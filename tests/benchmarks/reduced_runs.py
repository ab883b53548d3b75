"""Cost of a run with the `reduced` model: two corners, a flat base, longer runs, more modes, memory.

CPU seconds are those of the stepping loop alone, medians, as `stepping_cpu_s` in a result. Memory is the peak of a
whole process `python -m fem run` without fields.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from measuring import Figure, Stepped, at_most, report, stepped

from fem.case.case import Case, load_case
from fem.model.container import Container, discretise

REPEATS = 5
DURATION = 20.0  # s
CORNERS, FLAT = 0.06, 0.5  # CPU seconds of stepping for it
MEMORY = 300.0  # MB
EXPONENT = 0.25  # by which the cost may grow faster than the duration or the modes
CASES = ("seed_stack", "rocking")
DURATIONS, MODES = (5.0, 10.0, 20.0, 40.0), (10, 20, 40, 80)


def cost(case: Case, container: Container) -> tuple[float, Stepped]:
    """Median CPU seconds of stepping, and one of the runs."""
    runs = [stepped(case, container) for _ in range(REPEATS)]
    return statistics.median(run.cpu_s for run in runs), runs[0]


def growth(sizes: tuple[float, ...], costs: list[float]) -> float:
    """Exponent of the cost as a power of the size."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def peak_memory(name: str) -> float:
    """Of a process that runs a case without fields [MB]."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "fem", "run", name, "-q", "--out", str(Path(folder) / "run")]
        command += ["--set", "output.fields_s=0", "--set", f"solver.duration_s={DURATION}"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with exit code {process.returncode}")
    return usage.ru_maxrss / 1024.0


def single_runs() -> list[Figure]:
    figures = []
    for kind, limit in (("corners", CORNERS), ("flat", FLAT)):
        for name in CASES:
            case = load_case(
                name, ["floor.kind=rigid", f"support.kind={kind}", f"solver.duration_s={DURATION}"]
            )
            container = discretise(case)
            cpu, run = cost(case, container)
            what = f"{name}, {kind}, {container.support.index.size} contact nodes"
            details = f"{run.steps}, {100.0 * run.rejected_share:.1f} %, {run.rotation_ratio:.4f}"
            figures += [
                at_most(f"{what}: CPU s", cpu, limit, ".3f"),
                Figure(f"{what}: steps, rejected, rotation ratio", details),
            ]
    return figures


def scaling() -> list[Figure]:
    """Growth of the cost; with the modes the steps change a little too, so this measures the cost of a step."""
    base = load_case("rocking", ["floor.kind=rigid"])
    container = discretise(base)
    by_duration = [cost(base.with_values({"solver.duration_s": one}), container)[0] for one in DURATIONS]
    by_modes = []
    for count in MODES:
        case = base.with_values({"solver.elastic_modes": count, "solver.duration_s": DURATION})
        cpu, run = cost(case, discretise(case))
        by_modes.append(1e6 * cpu / run.steps)
    in_time, in_modes = growth(DURATIONS, by_duration), growth(tuple(map(float, MODES)), by_modes)
    limit = 1.0 + EXPONENT
    seconds, each = (
        ", ".join(f"{one:.{n}f}" for one in costs) for n, costs in ((3, by_duration), (2, by_modes))
    )
    durations, modes = ", ".join(f"{one:g}" for one in DURATIONS), ", ".join(map(str, MODES))
    return [
        at_most(f"power of CPU s over durations {durations} s", in_time, limit, details=f" ({seconds})"),
        at_most(f"power of microseconds a step over {modes} modes", in_modes, limit, details=f" ({each})"),
    ]


def main() -> int:
    memory = at_most("rocking, a whole run without fields: peak MB", peak_memory("rocking"), MEMORY, ".0f")
    title = f"reduced model, shell, 20 elastic modes, {DURATION:g} s of motion"
    return report(title, [*single_runs(), *scaling(), memory])


if __name__ == "__main__":
    sys.exit(main())
