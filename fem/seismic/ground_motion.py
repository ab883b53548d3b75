"""A motion of the ground or of a floor: components sampled together, linear between samples, SI units; and its files.

Both files, CSV in m/s2 and PEER AT2 in g, read back to the same bits. A value in m/s2 is not in general a float64 in g
times 9.80665, so motions are made of values that are, by a rounding. Numbers are written with as many digits as a
float64 needs, so an AT2 file has columns wider than the usual 15; programs that read it number by number accept that.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from contact.motion.samples import sampled_motion
from fem.records.columns import given_record, written
from fem.records.intensity import Intensity, intensity
from fem.records.units import STANDARD_GRAVITY
from fem.runtime.arrays import FloatArray
from fem.runtime.own_files import write_atomically

AT2_PER_LINE = 5


def in_whole_g(acceleration: FloatArray) -> FloatArray:
    """The nearest accelerations (n,) that are a float64 in g times 9.80665 [m/s2]."""
    return acceleration / STANDARD_GRAVITY * STANDARD_GRAVITY


@dataclass(frozen=True, kw_only=True, eq=False)  # arrays have no single truth value
class GroundMotion:
    """A horizontal acceleration, a vertical one, and a second horizontal one across the first.

    Raises:
        ValueError: components of different length, fewer than two samples, numbers that are not finite, no step.
    """

    name: str
    step: float  #: between samples [s]
    horizontal: FloatArray  #: (n,) [m/s2]
    vertical: FloatArray | None = None  #: upward positive, (n,) [m/s2]
    second: FloatArray | None = None  #: horizontal, at right angles to the first, (n,) [m/s2]
    origin: str = ""  #: seed or files
    factor: float = 1.0  #: by which both components of the origin were multiplied
    notes: tuple[str, ...] = ()  #: what its processing changed that a user must know of
    event: str = ""  #: of a record, where its file names it
    stationary: float | None = None  #: stationary part of an artificial motion [s]

    def __post_init__(self) -> None:
        if not 0.0 < self.step < 1.0:
            raise ValueError(f"{self.name}: the step must be positive and below 1 s, got {self.step:g} s")
        for name in ("horizontal", "vertical", "second"):
            if (component := getattr(self, name)) is not None:
                object.__setattr__(self, name, in_whole_g(component))
        for component in self.components:
            if component.shape != self.horizontal.shape or component.ndim != 1 or component.size < 2:
                raise ValueError(
                    f"{self.name}: components of one length, with two samples or more, are needed"
                )
            if not np.isfinite(component).all():
                raise ValueError(f"{self.name}: a sample is not a finite number")

    @property
    def lettered(self) -> dict[str, FloatArray]:
        """The components that there are, by the letter that the names of their files end with."""
        parts = {"h": self.horizontal, "v": self.vertical, "t": self.second}
        return {letter: part for letter, part in parts.items() if part is not None}

    @property
    def components(self) -> tuple[FloatArray, ...]:
        """Horizontal, vertical and second horizontal, as far as there are."""
        return tuple(self.lettered.values())

    @property
    def times(self) -> FloatArray:
        """Of the samples, from 0, shape (n,) [s]."""
        return np.arange(self.horizontal.size, dtype=np.float64) * self.step

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return (self.horizontal.size - 1) * self.step

    @property
    def peak(self) -> float:
        """Largest |horizontal acceleration| [m/s2]."""
        return float(np.abs(self.horizontal).max())

    @property
    def intensities(self) -> dict[str, Intensity]:
        """Of each component, by its letter."""
        return {letter: intensity(self.times, component) for letter, component in self.lettered.items()}

    @property
    def ends(self) -> tuple[float, float]:
        """Velocity [m/s] and displacement [m] of the floor at the last sample, largest magnitude of the components."""
        moved = [sampled_motion(self.times, component, "acceleration") for component in self.components]
        return max(abs(float(v[-1])) for _, v, _ in moved), max(abs(float(x[-1])) for x, _, _ in moved)

    def scaled(self, horizontal: float, vertical: float | None = None) -> "GroundMotion":
        """The motion with its components multiplied; one factor for all unless the vertical has its own."""
        upward = None
        if self.vertical is not None:
            upward = self.vertical * (horizontal if vertical is None else vertical)
        return replace(
            self,
            horizontal=self.horizontal * horizontal,
            vertical=upward,
            second=None if self.second is None else self.second * horizontal,
            factor=self.factor * horizontal,
        )


def sampled_at(step: float, present: float, values: FloatArray) -> FloatArray:
    """Values (n,) at a step `present` sampled at another one, linear between samples, as a run takes them."""
    if step == present:
        return values
    times = np.arange(math.floor((values.size - 1) * present / step * (1.0 + 1e-12)) + 1) * step
    return np.asarray(np.interp(times, np.arange(values.size) * present, values))


def write_csv(path: Path, step: float, acceleration: FloatArray) -> None:
    """Write times and accelerations (n,) [m/s2]."""
    times = np.asarray(np.arange(acceleration.size) * step, dtype=np.float64)
    record = given_record(times, {"horizontal": acceleration})
    write_atomically(path, written(record), to_disk=False)


def write_at2(path: Path, step: float, acceleration: FloatArray, described: str) -> None:
    """Write an acceleration (n,) [m/s2] as a PEER file.

    Args:
        described: event, date, station and component of the second line; commas divide them.

    Raises:
        ValueError: a value that is no float64 in g times 9.80665; use `in_whole_g` first.
    """
    values = acceleration / STANDARD_GRAVITY
    for neighbour in (-np.inf, np.inf):
        off = values * STANDARD_GRAVITY != acceleration
        values[off] = np.nextafter(acceleration[off] / STANDARD_GRAVITY, neighbour)
    if (values * STANDARD_GRAVITY != acceleration).any():
        raise ValueError("an acceleration is no float64 in g times 9.80665; use in_whole_g first")
    rows = [
        " ".join(f"{value:24.16E}" for value in values[at : at + AT2_PER_LINE].tolist())
        for at in range(0, values.size, AT2_PER_LINE)
    ]
    heading = (
        "PROGRAM UNANCHORED",
        described,
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {values.size}, DT= {step!r} SEC",
    )
    write_atomically(path, "\n".join((*heading, *rows, "")), to_disk=False)
