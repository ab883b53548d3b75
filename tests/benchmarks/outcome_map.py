"""Cost of outcome maps of the stack on one core and on two, with and without perturbed copies.

`rigid`: 100 x 100 cells over frequency and peak acceleration, 20 s each; `reduced` (20 modes, corners): 50 x 50. The
settings are those of the shipped sweep `outcome_map`. Wall time, since cores are compared, with CPU time beside it,
which other work on the machine affects less; compilation is not included. `--quick` computes a ninth of the
cells, `--rigid` leaves out the reduced model.
"""

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from measuring import Figure, at_most, report

from fem.model.container import discretise
from fem.model.equilibrium import find_equilibrium
from fem.model.model import build_model
from fem.study.axes import read_axis
from fem.study.design import Sweep
from fem.study.file import load_sweep
from fem.study.runner import run_cases
from fem.study.sweep import run_sweep

FREQUENCY, PEAK = "motion.angular_frequency_rad_s", "motion.peak_acceleration_m_s2"
RIGID_CELLS, REDUCED_CELLS = 100, 50
RIGID_S, REDUCED_S, SPEEDUP = 30.0, 300.0, 1.8
BUILDS = 500


def map_of(model: str, cells: int, *, band: bool) -> Sweep:
    """The shipped outcome map with so many cells along each axis."""
    shipped = load_sweep("outcome_map")
    axes = (
        read_axis(FREQUENCY, {"from": 1.5, "to": 12.0, "count": cells, "scale": "log"}),
        read_axis(PEAK, {"from": 1.0, "to": 16.0, "count": cells}),
    )
    perturbation = shipped.perturbation.model_copy(update={"cells": "auto" if band else "none"})
    base = shipped.base.with_values({"solver.model": model})
    return replace(shipped, base=base, axes=axes, perturbation=perturbation)


def seconds(sweep: Sweep, jobs: int) -> tuple[float, float, dict[str, Any]]:
    """Wall and CPU time of a whole sweep into a folder, and its result."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter(), time.process_time()
        info = run_sweep(sweep, Path(folder) / "map", jobs=jobs)
        if info["status"] != "completed":
            raise RuntimeError(f"the sweep was {info['status']}: its time means nothing")
        return time.perf_counter() - began[0], time.process_time() - began[1], info


def figures_of(model: str, cells: int, limit: float, *, share: float) -> list[Figure]:
    """Cost of one map; `limit` holds for the whole one, `share` of which is computed."""
    plain = map_of(model, cells, band=False)
    run_cases([plain.case(0), plain.case(plain.count - 1)], jobs=2)  # compiled and loaded
    one, cpu, _ = seconds(plain, 1)
    two, both, info = seconds(plain, 2)
    banded, cpu_banded, whole = seconds(map_of(model, cells, band=True), 2)
    name, outcomes = f"{model}, {cells} x {cells} cells", info["outcomes"]
    found = ", ".join(f"{word} {count}" for word, count in outcomes.items())
    speedup = f"{one / two:.2f} ({one:.1f} s, CPU {cpu:.1f} s on one)"
    perturbed = f"{whole['perturbed']} cells perturbed, {whole['unsure']} unsure"
    return [
        at_most(f"{name}, two cores [s]", two, share * limit, ".1f", details=f" (CPU {both:.1f} s)"),
        Figure(f"{name}: one core over two", speedup, f">= {SPEEDUP:g}", one / two >= SPEEDUP),
        Figure(f"{name}: outcomes", found, "none failed", outcomes.get("failed", 0) == 0),
        Figure(f"{name}, two cores, with its band", f"{banded:.1f} s (CPU {cpu_banded:.1f} s); {perturbed}"),
    ]


def cost_of_a_cell() -> Figure:
    """Time to build the model of a cell."""
    sweep = map_of("rigid", RIGID_CELLS, band=False)
    container = discretise(sweep.case(0))
    first = sweep.case(0)
    equilibrium = find_equilibrium(first, container, first.gravity_m_s2)  # shared: only the motion differs
    times = []
    for cell in range(BUILDS):
        began = time.process_time()
        build_model(sweep.case(cell), container, equilibrium)
        times.append(time.process_time() - began)
    return at_most("from a cell's number to its model [ms]", 1e3 * float(np.median(times)), 1.0)


def main() -> int:
    third = 3 if "--quick" in sys.argv else 1
    share = 1.0 / third**2
    figures = [cost_of_a_cell()]
    figures += figures_of("rigid", RIGID_CELLS // third, RIGID_S, share=share)
    if "--rigid" not in sys.argv:
        figures += figures_of("reduced", REDUCED_CELLS // third, REDUCED_S, share=share)
    return report("outcome map of the stack, 20 s a cell", figures)


if __name__ == "__main__":
    sys.exit(main())
