"""Verification at a site: spectra, artificial motions, and the shipped example through the command on two cores.

Compilation is not included.
"""

import subprocess
import sys
import tempfile
import time

import numpy as np
from measuring import at_most, cpu_seconds, median_of, report

from fem.records.spectrum import log_spaced_periods, response_spectrum
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_set

REPEATS = 3
SPECTRUM_S, MOTIONS_S, EXAMPLE_S = 0.1, 2.0, 15.0
STEP = 0.005


def example() -> float:
    """Wall time of the shipped example [s]."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        command = [sys.executable, "-m", "fem", "assess", "site", "--out", f"{folder}/site", "-j", "2", "-q"]
        subprocess.run(command, check=True, capture_output=True)
        return time.perf_counter() - began


def main() -> int:
    action = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=1.6)
    record = np.random.default_rng(1).normal(size=8001)
    periods = log_spaced_periods(STEP)
    example()  # compiles
    return report(
        "verification at a site",
        [
            at_most(
                "100 periods of 40 s [CPU s]",
                median_of(REPEATS, lambda: cpu_seconds(lambda: response_spectrum(STEP, record, periods))),
                SPECTRUM_S,
            ),
            at_most(
                "seven artificial motions [CPU s]",
                median_of(REPEATS, lambda: cpu_seconds(lambda: artificial_set(action, count=7, seed=5))),
                MOTIONS_S,
            ),
            at_most("the shipped example [s]", median_of(REPEATS, example), EXAMPLE_S),
        ],
    )


if __name__ == "__main__":
    sys.exit(main())
