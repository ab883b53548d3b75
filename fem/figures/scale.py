"""One axis of a chart: its limits, from what is drawn unless they are set; its ticks and its label."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from fem.figures.ticks import decade_places, tick_labels, tick_places
from fem.runtime.arrays import FloatArray

FONT = 9.0  #: size of labels [point]
MARGIN = 0.05  #: above and below what is drawn, over its height


@dataclass(kw_only=True, eq=False)
class Scale:
    """One axis of a panel: limits, ticks and label."""

    extent: float  #: of the panel along it [point]
    aspect: float  #: of a tick label along it, over its font
    margin: float
    label: str = ""
    label_at: float | None = None  #: across the axis, as a share of the panel
    limits: tuple[float, float] | None = None  #: if set
    logarithmic: bool = False
    places: list[tuple[float, str]] | None = None  #: ticks with labels, if set
    label_size: float = FONT
    tick_length: float = 3.5
    labelled: bool = True
    grid: bool = True
    form: Callable[[float, int], str] | None = None
    data: list[FloatArray] = field(default_factory=list)
    sticky: list[FloatArray] = field(default_factory=list)
    shared: list["Scale"] = field(default_factory=list)

    def set_label_coords(self, x: float, y: float) -> None:
        self.label_at = x

    def set_major_formatter(self, form: Callable[[float, int], str]) -> None:
        self.form = form

    def limit(self, low: float | None, high: float | None) -> None:
        """Set one end or both."""
        before = self.view()
        self.limits = before[0] if low is None else low, before[1] if high is None else high

    def set_ticks(self, places: Sequence[float], labels: Sequence[str], size: float) -> None:
        """Set the places of ticks with their labels, or none, in letters of a size [point]."""
        named = [*labels, *[""] * (len(places) - len(labels))]
        self.places = list(zip(map(float, places), named, strict=True))
        self.data.append(np.asarray(places, dtype=np.float64))
        self.label_size = size

    def share_with(self, other: "Scale") -> None:
        """Have the same limits as another axis."""
        group = other.shared or [other]
        group.append(self)
        other.shared = self.shared = group

    def view(self) -> tuple[float, float]:
        """Limits: as set, else around all that is drawn, without a margin at the foot of a bar."""
        if self.limits is not None:
            return self.limits
        group = self.shared or [self]
        for one in group:
            if one.limits is not None:
                return one.limits
        drawn = [values for one in group for values in one.data]
        finite = np.concatenate([np.empty(0), *drawn])
        finite = finite[np.isfinite(finite)]
        if not finite.size:
            return 0.0, 1.0
        low, high = _apart(float(finite.min()), float(finite.max()))
        sticky = np.concatenate([np.empty(0), *(values for one in group for values in one.sticky)])
        slack = 1e-5 * (high - low)
        below, above = sticky[sticky <= low + slack], sticky[sticky >= high - slack]
        ends = np.array([low, high])
        ends = np.log10(ends) if self.logarithmic else ends
        wide = self.margin * (ends[1] - ends[0])
        ends += np.array([-wide, wide])
        low, high = (10.0**ends if self.logarithmic else ends).tolist()
        return max([low, *below[-1:]]), min([high, *above[:1]])

    def share(self, values: FloatArray) -> FloatArray:
        """Place along the axis, 0 at its start and 1 at its end."""
        ends = np.array(self.view())
        if self.logarithmic:
            ends, values = np.log10(ends), np.log10(values)
        return (values - ends[0]) / (ends[1] - ends[0])

    def ticks(self) -> tuple[list[tuple[float, str]], FloatArray, str]:
        """Places in view with their labels, smaller ticks, and the power of ten common to the labels."""
        low, high = sorted(self.view())
        if self.places is not None:
            return [one for one in self.places if low <= one[0] <= high], np.empty(0), ""
        if self.logarithmic:
            places, smaller = decade_places(low, high)
            smaller = smaller[(smaller >= low) & (smaller <= high)]
        else:
            places = tick_places(low, high, math.floor(self.extent / (self.aspect * FONT)))
            smaller = np.empty(0)
        slack = 1e-10 * (high - low)
        shown = places[(places >= low - slack) & (places <= high + slack)]
        labels, power = tick_labels(places, shown)
        if self.form is not None:
            labels, power = [self.form(float(place), k) for k, place in enumerate(shown)], ""
        return list(zip(shown.tolist(), labels, strict=True)), smaller, power


def _apart(low: float, high: float) -> tuple[float, float]:
    """Ends of a range, wide enough to draw."""
    if high - low > 1e-15 * max(abs(low), abs(high)):
        return low, high
    if low == 0.0 == high:
        return -MARGIN, MARGIN
    return low - MARGIN * abs(low), high + MARGIN * abs(high)
