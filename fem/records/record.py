"""A recorded motion: one or more components, each with its times, values, quantity and unit. SI units.

What the file states (format, station, event, date, names and directions of components) is kept; what it does
not state stays empty. Values are positive as in the file.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from fem.runtime.arrays import FloatArray

Quantity = Literal["acceleration", "velocity", "displacement"]
Direction = Literal["horizontal", "vertical"]
PLURALS: dict[Quantity, str] = {
    "acceleration": "accelerations", "velocity": "velocities", "displacement": "displacements",
}  # fmt: skip
#: largest difference of two sampling times that count as one, over the interval: what seven printed digits leave
SAME_TIME = 1e-3
LEAST_SHARED = 0.5  #: samples that components of one recording share, over those of the longer one


class RecordError(ValueError):
    """A file that is no motion, or a motion that cannot be used; the message names the file."""


@dataclass(frozen=True, kw_only=True, eq=False)  # arrays have no single truth value
class Component:
    """One component of a recorded motion: two samples or more, finite, at times that increase, else RecordError."""

    times: FloatArray  #: increasing, shape (n,) [s]
    readings: FloatArray  #: in the unit of the file, shape (n,)
    factor: float = 1.0  #: that makes the readings SI
    quantity: Quantity = "acceleration"
    unit: str = "m/s2"  #: of the readings
    unit_stated: bool = True  #: by the file; else by who reads it
    time_stated: bool = True  #: the unit of the times or the interval; else they are taken in s
    name: str = ""  #: as the file calls it, such as "HNE" or "Chan 2: 360 Deg"
    direction: Direction | None = None  #: None where the file does not say

    def __post_init__(self) -> None:
        for name in ("times", "readings"):  # read-only copies: a record is read once and shared
            column = np.array(getattr(self, name), dtype=np.float64)
            column.flags.writeable = False
            object.__setattr__(self, name, column)
        if self.times.ndim != 1 or self.times.shape != self.readings.shape:
            raise RecordError(
                f"{self.times.size} times and {self.readings.size} values: they must be as many"
            )
        if self.times.size < 2:
            raise RecordError(f"two samples or more are needed, found {self.times.size}")
        for kind, column in (("time", self.times), ("value", self.readings)):
            if not np.isfinite(column).all():
                row = int(np.flatnonzero(~np.isfinite(column))[0])
                raise RecordError(f"{kind} of sample {row + 1} is not a finite number")
        steps = np.diff(self.times)
        if (steps <= 0.0).any():
            row = int(np.flatnonzero(steps <= 0.0)[0])
            how = "is the same as" if steps[row] == 0.0 else "is earlier than"
            raise RecordError(
                f"times must increase, but that of sample {row + 2}, {self.times[row + 1]:g} s, {how} "
                f"that of sample {row + 1}, {self.times[row]:g} s"
            )

    @property
    def values(self) -> FloatArray:
        """The readings in SI, shape (n,) [m/s2], [m/s] or [m]."""
        return self.readings * self.factor

    @property
    def notes(self) -> tuple[str, ...]:
        """What is done to its readings besides."""
        turned = self.direction == "vertical" and self.factor < 0.0
        said = f"its component {self.name} is positive downward; its sign is reversed, so that up is positive"
        return (said,) if turned else ()

    @cached_property
    def step(self) -> float:
        """Median interval of the samples [s]."""
        return float(np.median(np.diff(self.times)))

    def require_no_gap(self, name: str, ways_out: str = "") -> None:
        """Refuse samples of which some are missing: an interval is twice the usual one or longer."""
        long = np.flatnonzero(np.diff(self.times) > (2.0 - SAME_TIME) * self.step)
        if long.size:
            before, behind = self.times[long[0] : long[0] + 2]
            raise RecordError(
                f"{name}: no samples between {before:.7g} and {behind:.7g} s, where they are usually {self.step:.4g} s "
                f"apart; complete the file{ways_out}"
            )

    @property
    def described(self) -> str:
        """Name, direction and quantity for a message."""
        parts = (self.name, self.direction, self.quantity)
        return ", ".join(part for part in parts if part) or "unnamed"


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """A recorded motion as its file holds it."""

    components: tuple[Component, ...]  #: in the order of the file, at least one
    name: str = "record"  #: of the file
    format: str = ""  #: such as "PEER AT2"
    station: str = ""
    event: str = ""
    date: str = ""
    notes: tuple[str, ...] = ()  #: doubts that the file itself states

    def component(self, direction: Direction, *, quantity: Quantity, channel: str = "") -> Component:
        """The component of a quantity that moves the floor in a direction.

        Directions stated in the file decide; a component without one serves either. A channel, by number from 1 or
        by name, is taken whatever its direction.

        Raises:
            RecordError: there is none, or more than one to choose from; the message names the channels.
        """
        if channel:
            number, called = channel.lstrip("0"), channel.casefold()
            by_number = [one for k, one in enumerate(self.components, start=1) if str(k) == number]
            chosen = by_number or [one for one in self.components if one.name.casefold() == called]
            if len(chosen) != 1:
                raise RecordError(f"{self.name}: no channel {channel[:40]!r} ({self._channels()})")
            if chosen[0].quantity != quantity:
                raise RecordError(
                    f"{self.name}: channel {channel[:40]!r} holds {PLURALS[chosen[0].quantity]}, and "
                    f"{PLURALS[quantity]} are needed"
                )
            return chosen[0]
        of_quantity = [component for component in self.components if component.quantity == quantity]
        if not of_quantity:
            held = " and ".join(sorted({PLURALS[component.quantity] for component in self.components}))
            needed = PLURALS[quantity]
            raise RecordError(
                f"{self.name}: it holds {held}, and {needed} are needed; take the file of {needed}"
                + ('; or set quantity = "displacement"' if "displacement" in held else "")
            )
        components = [component for component in of_quantity if component.direction == direction] or [
            component for component in of_quantity if component.direction is None
        ]
        if len(components) == 1:
            return components[0]
        several = f"{len(components)} components may be the {direction} one"
        problem = several if components else f"no {direction} component"
        raise RecordError(
            f"{self.name}: {problem} ({self._channels()}); choose one as {self.name}#NUMBER or {self.name}#NAME"
        )

    def _channels(self) -> str:
        return "; ".join(
            f"#{number} {component.described}" for number, component in enumerate(self.components, start=1)
        )


def cut_together(components: Sequence[Component], names: Sequence[str]) -> tuple[list[Component], str]:
    """Components of one recording, cut to the samples that all have, and a note where that cuts any.

    RecordError, with their names and both values: they were not sampled together, interval or times differ.
    """
    first = components[0]
    for other, name in zip(components[1:], names[1:], strict=True):
        apart = f"{names[0]} and {name} do not belong together: "
        if abs(first.step - other.step) > SAME_TIME * min(first.step, other.step):
            raise RecordError(
                f"{apart}{first.step:g} and {other.step:g} s between samples; both components must be of one recording"
            )
        shared, longest = sorted((first.times.size, other.times.size))
        if shared < LEAST_SHARED * longest:
            raise RecordError(
                f"{apart}{first.times.size} and {other.times.size} samples; start_s and end_s cut them"
            )
        off = float(np.abs(first.times[:shared] - other.times[:shared]).max())
        if off > SAME_TIME * first.step:
            raise RecordError(
                f"{apart}their samples are up to {off:g} s apart in time; start_s and end_s cut them"
            )
    counts = [component.times.size for component in components]
    if len(set(counts)) == 1:
        return list(components), ""
    shared = min(counts)
    note = f"{', '.join(names)} have {', '.join(map(str, counts))} samples: they are cut to the {shared} that all have"
    return [
        replace(component, times=component.times[:shared], readings=component.readings[:shared])
        for component in components
    ], note
