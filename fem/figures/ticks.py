"""Where the ticks of an axis stand and what they say: round steps, as many as there is room for.

The rules are those of matplotlib: `MaxNLocator` with steps 1, 2, 2.5 and 5, and `ScalarFormatter` without offset.
"""

import math
from collections.abc import Sequence

import numpy as np

from fem.runtime.arrays import FloatArray

STEPS = np.array([1.0, 2.0, 2.5, 5.0, 10.0])
MOST, LEAST = 9, 2  #: steps and ticks of an axis
POWERS = (-5, 6)  #: from these on, a common power of ten is taken out of the labels
SLACK = 1e-10  #: share of a step within which an end counts as a multiple of it


def tick_places(low: float, high: float, room: int) -> FloatArray:
    """Multiples of a round step from the last below `low` to the first above `high`.

    Args:
        low, high: limits of the axis, low < high.
        room: steps that its labels leave room for.
    """
    most = min(max(room, 1), MOST)
    scale = 10.0 ** math.floor(math.log10((high - low) / most))
    steps = scale * np.concatenate([0.1 * STEPS[:-1], STEPS, [10.0 * STEPS[1]]])
    large = np.flatnonzero(steps >= (high - low) / most)
    places = np.array([low, high])
    for step in steps[: (large[0] if large.size else steps.size - 1) + 1][::-1]:
        first, last = math.floor(low / step + SLACK), math.ceil(high / step - SLACK)
        places = step * np.arange(first, last + 1)
        if np.count_nonzero((places >= low) & (places <= high)) >= LEAST:
            break
    return places


def decade_places(low: float, high: float) -> tuple[FloatArray, FloatArray]:
    """Powers of ten on a logarithmic axis, and the multiples between them."""
    orders = np.arange(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1, dtype=np.float64)
    powers: FloatArray = np.power(10.0, orders)
    return powers, np.outer(powers, np.arange(2.0, 10.0)).ravel()


def tick_labels(places: FloatArray, shown: FloatArray) -> tuple[list[str], str]:
    """Labels of the places shown, with as many decimals as tell all places apart, and their common power of ten.

    Args:
        places: from `tick_places`.
        shown: those of them between the limits.
    """
    largest = float(np.abs(shown).max(initial=0.0))
    power = math.floor(math.log10(largest)) if largest > 0.0 else 0
    power = power if power <= POWERS[0] or power >= POWERS[1] else 0
    values = places / 10.0**power
    spread = float(np.ptp(values)) or float(np.abs(values).max()) or 1.0
    order = math.floor(math.log10(spread))
    decimals = max(0, 3 - order)
    while decimals > 0 and np.abs(values - np.round(values, decimals - 1)).max() < 1e-3 * 10.0**order:
        decimals -= 1
    labels = [f"{value / 10.0**power:.{decimals}f}" for value in shown]
    return _signed(labels), f"1e{power}".replace("-", "−") if power else ""


def _signed(labels: Sequence[str]) -> list[str]:
    """With a minus sign for the hyphen, and none before a zero."""
    return [label.replace("-", "−") if float(label) else label.lstrip("-") for label in labels]
