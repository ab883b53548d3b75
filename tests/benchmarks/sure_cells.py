"""Do the sure cells of the shipped outcome map stay as they are, and do the unsure ones flip?

Cells of the sweep `outcome_map` are taken at random, with a stated seed, and run again with one change at a time that
the sweep did not choose. A cell flips if it stands instead of overturning, or the reverse. Printed: the share of the
cells that are not unsure which flip under any change, of the unsure ones which flip under a change of an input that
`decided_by` names, and of all cells which are not unsure.

    python tests/benchmarks/sure_cells.py [FOLDER] [--cells 150] [--seed 1]

FOLDER holds the finished sweep; without it the sweep is computed.
"""

import argparse
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from measuring import Figure, at_least, at_most, report

from fem.case.case import Case
from fem.model.geometry import build_container
from fem.model.support import normal_penalty
from fem.results.outcome import ending_of
from fem.study.design import Sweep
from fem.study.file import load_sweep
from fem.study.runner import run_cases
from fem.study.sweep import run_sweep
from fem.study.sweep_table import SweepTable, open_sweep

MOST_FLIPS, LEAST_FLIPS, LEAST_SURE = 0.01, 0.5, 0.4


def changes_of(case: Case) -> dict[str, dict[str, Any]]:
    """What a cell is run again with, one at a time."""
    contact = case.contact
    penalty = normal_penalty(case, build_container(case))
    return {
        "mu_k = mu_s": {"contact.mu_kinetic": contact.mu_static},
        "mu_k = 0.3": {"contact.mu_kinetic": 0.3},
        "start at rest": {"motion.start": "rest"},
        "ramp of 2 cycles": {"motion.ramp_cycles": 2.0},
        "weakening 5 mm": {"contact.weakening_m": 5e-3},
        "Stribeck 0.3 m/s": {"contact.stribeck_velocity_m_s": 0.3},
        "energy tolerance x 0.1": {"solver.energy_tolerance": 0.1},
        "energy tolerance x 10": {"solver.energy_tolerance": 10.0},
        "penalty / 9": {"contact.normal_penalty_Pa_m": penalty / 9.0},
        "penalty x 3": {"contact.normal_penalty_Pa_m": 3.0 * penalty},
        "damping ratio 0.5": {"contact.damping_ratio": 0.5},
        "damping ratio x 0.5": {"contact.damping_ratio": 0.5 * contact.damping_ratio},
        "damping ratio x 2": {"contact.damping_ratio": 2.0 * contact.damping_ratio},
    }


def flips(sweep: Sweep, table: SweepTable, cells: list[int]) -> list[list[tuple[str, str]]]:
    """For each cell the changes that flip it, by name and key."""
    asked = [(cell, name, values) for cell in cells for name, values in changes_of(sweep.case(cell)).items()]
    rows = run_cases([sweep.make.case(sweep.item(cell)._replace(more=values)) for cell, _, values in asked])
    found: dict[int, list[tuple[str, str]]] = {cell: [] for cell in cells}
    for (cell, name, values), row in zip(asked, rows, strict=True):
        own = ending_of(str(table["status"][cell]), str(table["outcome"][cell]))
        if ending_of(row["status"], row["outcome"]) != own:
            found[cell].append((name, next(iter(values))))
    return [found[cell] for cell in cells]


def figures_of(folder: Path, count: int, seed: int) -> list[Figure]:
    """Draw the cells, run them again, and count."""
    sweep, table = load_sweep("outcome_map"), open_sweep(folder)
    unsure = table["unsure"] == 1.0
    random = np.random.default_rng(seed)

    def some(chosen: Any) -> list[int]:
        places = np.flatnonzero(chosen)
        return sorted(random.choice(places, min(count, places.size), replace=False).tolist())

    sure_cells, unsure_cells = some(~unsure), some(unsure)
    of_sure = flips(sweep, table, sure_cells)
    of_unsure = flips(sweep, table, unsure_cells)
    named = [
        any(key in str(table["decided_by"][cell]).split() for _, key in found)
        for cell, found in zip(unsure_cells, of_unsure, strict=True)
    ]
    for cell, found in zip(sure_cells, of_sure, strict=True):
        if found:
            print(f"sure cell {cell} flips under {', '.join(name for name, _ in found)}: {sweep.point(cell)}")
    counts = Counter(name for found in of_unsure for name, _ in found)
    print("unsure cells flip under", ", ".join(f"{name}: {number}" for name, number in counts.most_common()))
    print(
        "cells:", {word: int((table["sure"] == word).sum()) for word in ("sure", "regime unsure", "unsure")}
    )
    flipped = sum(map(bool, of_sure)) / len(sure_cells)
    return [
        at_most(
            f"of {len(sure_cells)} cells that are not unsure, share that flips", flipped, MOST_FLIPS, ".4f"
        ),
        at_least(
            f"of {len(unsure_cells)} unsure cells, share that flips under an input that is named",
            sum(named) / len(named),
            LEAST_FLIPS,
        ),
        at_least("share of all cells that is not unsure", float(np.mean(~unsure)), LEAST_SURE, ".3f"),
    ]


def main() -> int:
    """Print the shares beside what they should be; 1 if one is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path)
    parser.add_argument("--cells", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or Path(temporary) / "map"
        if given.folder is None:
            run_sweep(load_sweep("outcome_map"), folder)
        return report(f"sure cells, seed {given.seed}", figures_of(folder, given.cells, given.seed))


if __name__ == "__main__":
    raise SystemExit(main())
