"""Every shipped case unchanged: outcome, energy balance, rejected steps.

At the end the whole default run with the `full` model, fields and files included (about 20 s of motion; `--quick`
leaves it out).
"""

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from measuring import Figure, at_most, report, stepped

from fem.assessment.verdict import outcome_of
from fem.case.case import load_case
from fem.case.files import CASES, DEFAULT_CASE
from fem.run.run import RunOptions, run_case

REJECTED = 0.05  # share of the steps tried
DEFAULT_RUN = 600.0  # CPU seconds of the whole default run, full model


def case_figures(name: str) -> list[Figure]:
    run = stepped(load_case(name))
    share, energy = run.rejected_share, run.ledger
    details = f" ({run.steps} steps, CPU {run.cpu_s:.3f} s)"
    return [
        Figure(f"{name}: outcome, rotation ratio", f"{outcome_of(run.model)}, {run.rotation_ratio:.4f}"),
        replace(energy, what=f"{name}: {energy.what}"),
        at_most(f"{name}: rejected share of the steps", share, REJECTED, ".4f", details=details),
    ]


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
    name, details = f"{case.name}, full", f" ({wall:.0f} s, {size:.0f} MB of results)"
    outcome = f"{result.status}, {verdict['outcome']}, {verdict['rotation_ratio']:.4f}"
    steps = f"{numerics['unknowns']}, {numerics['steps']}, {numerics['rejected']}"
    return [
        at_most(f"{name}: the whole run, CPU s", cpu, DEFAULT_RUN, ".0f", details=details),
        Figure(f"{name}: status, outcome, rotation ratio", outcome, "not failed", result.status != "failed"),
        Figure(f"{name}: unknowns, steps, rejected", steps),
    ]


def main() -> int:
    figures = [figure for name in CASES.names for figure in case_figures(name)]
    if "--quick" not in sys.argv[1:]:
        figures += default_run()
    return report("shipped cases", figures)


if __name__ == "__main__":
    sys.exit(main())
