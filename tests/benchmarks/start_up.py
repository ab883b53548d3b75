"""Start-up time: help, check, and a run whose kernels are already compiled.

Median wall time of whole processes. The start of a run is that of the default case with 5 ms of motion, without
fields; a new folder for the compiled kernels shows the first run after an installation.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measuring import Figure, at_most, median_of, report

REPEATS = 5
HELP, CHECK, START = 0.5, 1.0, 3.0  # s


def wall_seconds(*arguments: str, environment: dict[str, str] | None = None) -> float:
    """Of `python -m fem` with these arguments [s]."""
    began = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "fem", *arguments],
        check=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | (environment or {}),
    )
    return time.perf_counter() - began


def main() -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        short = ["run", "-q", "--force", "--out", str(folder / "run")]
        short += ["--set", "solver.duration_s=0.005", "--set", "output.fields_s=0"]
        first = wall_seconds(*short, environment={"NUMBA_CACHE_DIR": str(folder / "kernels")})
        wall_seconds(*short)
        wall_seconds("check")
        figures = [
            at_most("--help [s]", median_of(REPEATS, lambda: wall_seconds("--help")), HELP),
            at_most("check [s]", median_of(REPEATS, lambda: wall_seconds("check")), CHECK),
            at_most("run, kernels compiled [s]", median_of(REPEATS, lambda: wall_seconds(*short)), START),
            Figure("run, kernels not compiled [s]", f"{first:.1f}", "for information"),
        ]
    return report("start-up, wall time of whole processes", figures)


if __name__ == "__main__":
    sys.exit(main())
