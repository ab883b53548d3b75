"""Compute a list of containers, a CSV file in which each row changes the case."""

from pathlib import Path

import fem

if __name__ == "__main__":
    case = fem.load_case("seed_box", ["solver.model=rigid", "solver.duration_s=2"])
    table = fem.compute_list(Path(__file__).with_name("containers.csv"), case, margins="none")
    weakest = table["name"][table["rank"] == 1][0]
    print(f"{weakest} is the weakest; static utilisation {max(table['utilisation_overturning']):.2f}")
