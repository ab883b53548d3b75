"""Changes of an outcome along one axis: a scan, then every change located by refinement.

An island narrower than the step of the scan may be missed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Change:
    """A bracket within which the outcome changes."""

    low: float
    high: float
    below: str  #: outcome at the lower end: standing | overturned | failed
    above: str

    @property
    def value(self) -> float:
        """The middle of the bracket."""
        return 0.5 * (self.low + self.high)


def least_width(values: Sequence[float], resolution: float) -> float:
    """Largest width of a bracket around zero, where no share of its value is meaningful."""
    steps = [high - low for low, high in pairwise(values)]
    return resolution * min([*steps, *(abs(value) for value in values if value)])


def values_to_try(
    known: Mapping[float, str], *, resolution: float, inner: int, least: float = 0.0
) -> list[float]:
    """Values within the brackets that are too wide; empty if all are narrow enough.

    Args:
        known: outcome by value.
        resolution: largest width of a bracket, relative to its larger end (in magnitude).
        inner: values tried within a bracket at a time.
        least: width at which any bracket is narrow enough, from `least_width`.
    """
    return [
        float(value)
        for change in changes_of(known)
        if change.high - change.low > max(resolution * max(abs(change.low), abs(change.high)), least)
        for value in np.linspace(change.low, change.high, inner + 2)[1:-1]
        if change.low < value < change.high  # not between two neighbouring floating-point numbers
    ]


def changes_of(known: Mapping[float, str]) -> list[Change]:
    """Neighbouring values of different outcome."""
    values = sorted(known)
    return [
        Change(low=low, high=high, below=known[low], above=known[high])
        for low, high in pairwise(values)
        if known[low] != known[high]
    ]
