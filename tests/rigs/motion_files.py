"""Motions made by a formula, as files that the tests of sets of motions read."""

from pathlib import Path

import numpy as np

STEP = 0.02  #: [s]


def write_motion(folder: Path, name: str, *, frequency: float, peak: float = 3.0) -> str:
    """A sine of 1 s under an envelope of one sine, which has neither its mean nor its ends at fault; its name."""
    times = np.arange(0.0, 1.0 + 0.5 * STEP, STEP)
    shape = np.sin(2.0 * np.pi * frequency * times) * np.sin(np.pi * times) ** 2
    values = peak * shape / np.abs(shape).max()
    lines = [f"{time:.6f},{value:.9f}" for time, value in zip(times, values, strict=True)]
    (folder / name).write_text("\n".join(["time_s,acceleration_m_s2", *lines, ""]), encoding="utf-8")
    return name


def write_pair(folder: Path, name: str, *, frequency: float, peak: float = 3.0) -> tuple[str, str]:
    """A horizontal motion, and a vertical one of another frequency and two thirds of its peak; their names."""
    return (
        write_motion(folder, f"{name}_h.csv", frequency=frequency, peak=peak),
        write_motion(folder, f"{name}_v.csv", frequency=1.7 * frequency, peak=peak / 1.5),
    )
