"""Figures of a loose stack, whose boxes move separately: rotation, slip and opening of each box over time."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from fem.figures import style
from fem.html.units import rounded
from fem.results.figures import BOX_FIGURES, SLIPPED, BoxResult
from fem.results.reader import RunData

#: of up to six boxes; more take theirs from a colour map
COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.ORANGE, style.PURPLE, style.SKY)
LEGEND_COLUMNS = 6
THICK, THIN = 3.2, 0.9  #: lines of the lowest and the uppermost box
FARTHEST = 2.0  #: end of the scale of rotations, over the slenderness angle


class BoxQuantity(NamedTuple):
    """What is drawn of each box."""

    title: str
    label: str  #: of the vertical axis, with the unit
    unit: str  #: behind a number of the title
    figure: str  #: the largest, of `BOX_FIGURES`
    lowest: str  #: column of the lowest box
    further: str  #: column of a box above it, whose number takes the place of the braces

    @property
    def factor(self) -> float:
        """From SI units."""
        return BOX_FIGURES[self.figure].unit.factor

    @property
    def least(self) -> float:
        """A smaller value is rounding, in the units of the figure."""
        return self.factor * BOX_FIGURES[self.figure].unit.least


ROTATION = BoxQuantity(
    *("Rotation of each box", "rotation [degrees]", "°", "max_rotation_rad"),
    *("rotation_rad", "box_{}_rotation_rad"),
)
SLIP = BoxQuantity(
    *("Slip of each box over what is below", "slip [mm]", " mm", SLIPPED),
    *("slip_m", "box_{}_slip_m"),
)
OPENING = BoxQuantity(
    *("Opening under each box", "opening [mm]", " mm", "max_opening_m"),
    *("uplift_m", "box_{}_opening_m"),
)


def box_figure(run: RunData, quantity: BoxQuantity, boxes: tuple[BoxResult, ...]) -> Figure:
    """A curve over time for each box of a loose stack, with the states of motion below."""
    history, verdict = run.history, run.verdict
    names = [quantity.lowest, *(quantity.further.format(k) for k in range(2, len(boxes) + 1))]
    largest = max(float(np.abs(history[name]).max()) for name in names)
    tilted = quantity is ROTATION and largest >= style.NEAR_LIMIT * run.slenderness_angle
    entries = len(boxes) + tilted + (verdict.fell_box is not None)
    figure, (axes,) = style.time_panels(
        (2.3,), history=history, header=1 + math.ceil(entries / LEGEND_COLUMNS)
    )
    for k, name in enumerate(names):
        curve = quantity.factor * history[name], colour_of(k, len(boxes)), "-", f"box {k + 1}"
        # of boxes that move as one, each is seen below the next
        width = THIN + (THICK - THIN) * (1.0 - k / (len(boxes) - 1))
        style.curve_panel(axes, quantity.label, history["time_s"], curve, zero=k == 0, linewidth=width)
    style.keep_visible(axes, 10.0 * quantity.least)
    if tilted:
        angle = math.degrees(run.slenderness_angle)
        style.keep_visible(axes, 1.12 * angle)
        style.draw_limits(axes, angle, f"α, ±{rounded(angle, 4)}°", color=style.BLACK, linestyle="-.")
        low, high = axes.get_ylim()
        # a box that falls leaves the scale
        axes.set_ylim(max(low, -FARTHEST * angle), min(high, FARTHEST * angle))
    if verdict.fell_box is not None and verdict.overturned_at_s is not None:
        name = f"fell, {verdict.overturned_at_s:.3f} s"
        axes.axvline(
            verdict.overturned_at_s, color=style.GREY, linestyle=(0, (1, 2)), linewidth=1.0, label=name
        )
    style.legend_above(axes, LEGEND_COLUMNS)
    sizes = [quantity.factor * box[quantity.figure] for box in boxes]
    most = int(np.argmax(sizes))
    most_words = f"< {quantity.least:g}" if 0.0 < sizes[most] < quantity.least else rounded(sizes[most])
    title = f"{quantity.title}: {most_words}{quantity.unit} at most (box {most + 1})"
    style.head(figure, title, status=run.status)
    return figure


def colour_of(box: int, boxes: int) -> str:
    """Colour of a box, from 0 at the floor, in a stack of `boxes`."""
    return COLOURS[box] if boxes <= len(COLOURS) else str(to_hex(colormaps["viridis"](box / (boxes - 1))))
