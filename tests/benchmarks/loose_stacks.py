"""Cost of loose stacks of four: a run of the `rigid` and of the `reduced` model, and a map over two cores.

A run: 20 s of the default motion, CPU seconds of the stepping, median over five strengths of the motion, because
loose boxes that rock are chaotic. The map: 50 x 50 cells over friction between the boxes and peak acceleration, in the
settings of the shipped sweep `loose_stack`, loose cells without copies; wall time. Compilation is not included.
"""

import statistics
import sys
from dataclasses import replace

from measuring import Figure, at_most, report, stepped
from outcome_map import seconds

from fem.case.case import load_case
from fem.study.axes import read_axis
from fem.study.design import Sweep
from fem.study.file import load_sweep
from fem.study.runner import run_cases

LIMITS = {"rigid": 0.15, "reduced": 1.0}  # CPU seconds
FLOORS = ("rigid", "slab")
STRENGTHS = (0.92, 0.96, 1.0, 1.04, 1.08)
CELLS, MAP_S = 50, 120.0


def runs(model: str, floor: str) -> Figure:
    """Median cost of a run of the default case with loose boxes."""
    base = load_case("seed_stack_plateau", ["container.joints=loose", f"solver.model={model}"])
    base = base.with_values({"floor.kind": floor, "solver.duration_s": 20.0})
    peak = base.motion.peak_acceleration_m_s2
    done = [stepped(base.with_values({"motion.peak_acceleration_m_s2": f * peak})) for f in STRENGTHS]
    ratios = ", ".join(f"{run.rotation_ratio:.3f}" for run in done)
    cpu = statistics.median(run.cpu_s for run in done)
    what = f"{model}, {floor} floor: CPU s (rotation ratios)"
    return at_most(what, cpu, LIMITS[model], ".3f", details=f" ({ratios})")


def loose_map() -> Sweep:
    """The loose cells of the shipped sweep, more of them."""
    shipped = load_sweep("loose_stack")
    axes = (
        read_axis("motion.peak_acceleration_m_s2", {"from": 2.0, "to": 10.0, "count": CELLS}),
        read_axis("joints.mu_static", {"from": 0.1, "to": 0.7, "count": CELLS}),
    )
    perturbation = shipped.perturbation.model_copy(update={"cells": "none"})
    base = shipped.base.with_values({"container.joints": "loose"})
    return replace(shipped, base=base, axes=axes, perturbation=perturbation)


def main() -> int:
    figures = [runs(model, floor) for model in LIMITS for floor in FLOORS]
    sweep = loose_map()
    run_cases([sweep.case(0), sweep.case(sweep.count - 1)], jobs=2)  # compiled and loaded
    wall, _, _ = seconds(sweep, 2)
    figures.append(at_most(f"map of {CELLS} x {CELLS} cells, rigid, two cores: s", wall, MAP_S, ".0f"))
    return report("loose stacks of four boxes", figures)


if __name__ == "__main__":
    sys.exit(main())
