"""A sweep over a set of recorded motions: seven pairs, both signs, five frictions, 40 s, rigid, through the command.

The motions are random numbers under an envelope, scaled so that the container rocks in most of them and overturns in
some. The limit holds for two cores; compilation is not included.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from measuring import Figure, at_most, report

LIMIT_S = 10.0  # wall time of the command
STEP, LENGTH, MOTIONS = 0.005, 40.0, 7
SWEEP = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"floor.kind" = "rigid"
"motion.scale_to_m_s2" = 3.8
"contact.mu_kinetic" = 0.3
[axes]
motion.file = [{pairs}]
vertical.scale = [1.0, -1.0]
contact.mu_static = [0.3, 0.35, 0.4, 0.5, 0.6]
[perturbation]
cells = "none"
"""


def motion(seed: int) -> np.ndarray:
    """Times and a random acceleration whose spectrum falls beyond 3 Hz, shape (n, 2)."""
    generator = np.random.default_rng(seed)
    times = np.arange(0.0, LENGTH + 0.5 * STEP, STEP)
    frequencies = np.fft.rfftfreq(times.size, STEP)
    size = np.where(frequencies > 0.3, 1.0 / (1.0 + (frequencies / 3.0) ** 2), 0.0)
    noise = np.fft.irfft(size * np.exp(2j * np.pi * generator.random(frequencies.size)), times.size)
    envelope = np.clip(times / 3.0, 0.0, 1.0) * np.clip((LENGTH - times) / 10.0, 0.0, 1.0)
    return np.column_stack([times, noise * envelope / np.abs(noise).max()])


def main() -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        pairs = []
        for k in range(MOTIONS):
            files = f"m{k}_h.csv", f"m{k}_v.csv"
            for seed, file, factor in zip((10 * k, 10 * k + 1), files, (3.0, 2.0), strict=True):
                columns = motion(seed) * [1.0, factor]
                np.savetxt(
                    folder / file, columns, "%.6g", ",", header="time_s,acceleration_m_s2", comments=""
                )
            pairs.append('["{}", "{}"]'.format(*files))
        (folder / "set.toml").write_text(SWEEP.format(pairs=", ".join(pairs)), encoding="utf-8")
        command = [
            sys.executable,
            "-m",
            "fem",
            "sweep",
            str(folder / "set.toml"),
            "--out",
            str(folder / "out"),
        ]
        walls = []
        for _ in range(3):  # the first compiles
            began = time.perf_counter()
            said = subprocess.run(
                [*command, "-j", "2", "--force"], check=True, capture_output=True, text=True
            )
            walls.append(time.perf_counter() - began)
    outcomes = [line.strip() for line in said.stdout.splitlines()[2:6] if "%" in line]
    return report(
        "70 cases of 40 s over a set of motions",
        [
            at_most("wall time of the command [s]", min(walls[1:]), LIMIT_S),
            Figure("outcomes", "; ".join(outcomes)),
        ],
    )


if __name__ == "__main__":
    sys.exit(main())
