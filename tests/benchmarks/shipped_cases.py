"""Every shipped case as it stands: outcome, energy ledger, rejected steps; then how the imbalance falls with the step.

At the end the whole default run with the `full` model, fields and files included (about 20 s of motion; leave it out
with `--quick`).
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from measuring import Figure, report, stepped

from fem.assessment.verdict import outcome_of
from fem.case.case import load_case
from fem.case.files import CASES, DEFAULT_CASE
from fem.run.run import RunOptions, run_case

REJECTED = 0.05  # share of the steps tried
DEFAULT_RUN = 600.0  # CPU seconds of the whole default run, full model
#: free motion from half the slenderness angle, before the first impact: nothing switches
SMOOTH = ("solver.duration_s=0.6", "solver.model=rigid")
STEPS = (4e-3, 2e-3, 1e-3)  # s
ORDER = 2.0
ORDER_ACCURACY = 0.25


def case_figures(name: str) -> list[Figure]:
    run = stepped(load_case(name))
    outcome, share = outcome_of(run.model), run.rejected_share
    ratio = float(run.model.run.track[0].max_rotation) / run.model.static.slenderness_angle
    stands = run.ledger
    return [
        Figure(f"{name}: outcome, rotation ratio", f"{outcome}, {ratio:.4f}"),
        Figure(f"{name}: {stands.what}", stands.measured, stands.target, stands.reached),
        Figure(
            f"{name}: steps, rejected, CPU s",
            f"{run.steps}, {100.0 * share:.2f} %, {run.cpu_s:.3f}",
            f"< {100.0 * REJECTED:g} % rejected",
            share < REJECTED,
        ),
    ]


def imbalance(step: float) -> float:
    """Largest |imbalance| over the energy to overturn, at steps of one size where nothing switches."""
    run = stepped(load_case("free_rocking", [*SMOOTH, f"solver.step_s={step}"]))
    clock = run.model.run.clock[0]
    return max(-float(clock.least_imbalance), float(clock.most_imbalance)) / (
        run.model.run.control.reference_energy
    )


def order_figure() -> Figure:
    errors = [imbalance(step) for step in STEPS]
    order = float(np.polyfit(np.log(STEPS), np.log(errors), 1)[0])
    return Figure(
        f"imbalance of free motion at steps {', '.join(f'{step:g}' for step in STEPS)} s: order",
        f"{', '.join(f'{error:.1e}' for error in errors)}: {order:.2f}",
        f">= {ORDER - ORDER_ACCURACY:g}",
        order >= ORDER - ORDER_ACCURACY,
    )


def default_run() -> list[Figure]:
    """The default case with the full model, as the command would compute it."""
    case = load_case(DEFAULT_CASE, ["solver.model=full"])
    with tempfile.TemporaryDirectory() as folder:
        began, wall = time.process_time(), time.perf_counter()
        result = run_case(
            case, case_text=case.text, folder=Path(folder) / "run", options=RunOptions(band=False)
        )
        cpu, wall = time.process_time() - began, time.perf_counter() - wall
        size = sum(path.stat().st_size for path in Path(folder).rglob("*") if path.is_file()) / 1e6
    verdict, numerics = result.result["verdict"], result.result["numerics"]
    return [
        Figure(
            f"{case.name}, full: the whole run, CPU s",
            f"{cpu:.0f} ({wall:.0f} s, {size:.0f} MB of results)",
            f"<= {DEFAULT_RUN:g}",
            cpu <= DEFAULT_RUN and result.status != "failed",
        ),
        Figure(
            f"{case.name}, full: status, outcome, rotation ratio",
            f"{result.status}, {verdict['outcome']}, {verdict['rotation_ratio']:.4f}",
        ),
        Figure(
            f"{case.name}, full: unknowns, steps, rejected",
            f"{numerics['unknowns']}, {numerics['steps']}, {numerics['rejected']}",
        ),
    ]


def main() -> int:
    figures = [figure for name in CASES.names for figure in case_figures(name)]
    figures.append(order_figure())
    if "--quick" not in sys.argv[1:]:
        figures += default_run()
    return report("shipped cases", figures)


if __name__ == "__main__":
    sys.exit(main())
