"""Figures of the boxes of a stack: of loose ones rotation, slip and opening, of bolted ones the forces in their joints.

Of joints, above: the range of each force over the height of the stack, with the force from the weight above (curves of
several joints over time would hide one another). Below: the largest bolt force at any joint over time; where it is not
zero, a joint without bolts opens at an edge or slides.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from fem.case.columns import JOINTS
from fem.case.tables.boxes import shared_face
from fem.figures import style
from fem.html.units import rounded
from fem.model.joints import edge_forces
from fem.results.figures import BOX_FIGURES, SLIPPED, BoxResult
from fem.results.reader import RunData
from fem.results.run_result import Verdict
from fem.runtime.arrays import FloatArray

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
        style.draw_limits(axes, (angle, -angle), f"α, ±{rounded(angle, 4)}°", "-.")
        low, high = axes.get_ylim()
        # a box that falls leaves the scale
        axes.set_ylim(max(low, -FARTHEST * angle), min(high, FARTHEST * angle))
    if verdict.fell_box is not None:
        style.mark_instant(axes, "fell", verdict.overturned_at_s)
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


HEADER = 3  #: lines of text above the panels of ranges: title, legend, largest force
RANGES, BETWEEN, BELOW = 1.4, 0.3, 0.78  #: height of these panels, gaps beside and below them [inch]
USUAL = (0.05, 0.95)  #: quantiles that enclose a force nine tenths of the time
BAR = 0.5  #: thickness of a bar, over the height of a box
LEAST_FORCE = 1.0  #: on the axes of bolt forces [kN]


def joints_figure(run: RunData) -> Figure | None:
    """Ranges of normal force, shear and moment over the height; bolt forces over time; None for one box."""
    history, case = run.history, run.case
    if history.joints == 0:
        return None
    verdict = run.typed_result.verdict or Verdict()
    overturned_at = verdict.overturned_at_s
    standing = history["time_s"] <= (np.inf if overturned_at is None else overturned_at)
    time, mu, stack = history["time_s"][standing], case.contact.mu_static, case.stack
    faces = np.array([shared_face(lower, upper) for lower, upper in pairwise(stack)])
    half = 0.5 * (faces[:, 1] - faces[:, 0])
    normal, shear, moment = (
        1e-3 * np.array([history[name][standing] for name in same])
        for same in zip(*(JOINTS.names((joint,)) for joint in range(1, history.joints + 1)), strict=True)
    )
    figure, axes = style.time_panels(
        (1.1, 0.7), history=history, gaps=(style.LEGEND_GAP,), header=HEADER, above=RANGES + BELOW
    )
    levels = np.array([*(box.bottom for box in stack[1:]), stack[-1].top])
    weight = 1e-3 * case.gravity_m_s2 * np.cumsum([box.mass for box in stack[:0:-1]])[::-1]
    over_height = _side_by_side(figure)
    _draw_ranges(over_height[0], levels, normal, "normal", "kN", [weight])
    _draw_ranges(over_height[1], levels, shear, "shear", "kN", [mu * weight, -mu * weight])
    _draw_ranges(over_height[2], levels, moment, "moment", "kNm", [half * weight, -half * weight])
    over_height[0].legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0 + style.LINE / RANGES), ncols=3, borderaxespad=0.1
    )
    left, right = (np.maximum(0.0, -edge) for edge in edge_forces(normal, moment, 2.0 * half[:, None]))
    beyond = np.maximum(0.0, np.abs(shear) - mu * np.maximum(normal, 0.0))
    style.zero_line(axes[0])
    _draw_bolt_force(axes[0], time, left, "left edge", style.BLUE)
    _draw_bolt_force(axes[0], time, right, "right edge", style.VERMILLION, sign=-1.0)
    style.keep_visible(axes[0], LEAST_FORCE)
    axes[0].yaxis.set_major_formatter(lambda value, position: f"{abs(value):g}")  # both are tension
    _draw_bolt_force(axes[1], time, beyond, f"beyond μ = {rounded(mu)}", style.BLUE)
    axes[1].set_ylim(0.0, max(1.08 * float(beyond.max()), LEAST_FORCE))
    for panel, label in zip(axes, ("tension [kN]", "shear [kN]"), strict=True):
        panel.set_ylabel(label)
        style.legend_above(panel)
    title = "Joints between the boxes: forces over the height, and what bolts must carry"
    style.head(figure, title, status=run.status)
    return figure


def _side_by_side(figure: Figure) -> list[Axes]:
    """Three panels side by side below the header, over the height above the floor."""
    wide, tall = figure.get_size_inches()
    each = (wide - style.LEFT - style.RIGHT - 2.0 * BETWEEN) / 3.0
    bottom = tall - 0.08 - HEADER * style.LINE - RANGES
    panels: list[Axes] = []
    for column in range(3):
        rectangle = (
            (style.LEFT + column * (each + BETWEEN)) / wide,
            bottom / tall,
            each / wide,
            RANGES / tall,
        )
        panels.append(figure.add_axes(rectangle, sharey=panels[0] if panels else None))
        panels[-1].tick_params(labelleft=column == 0)
    panels[0].set_ylabel("above the floor [m]")
    return panels


def _draw_ranges(
    axes: Axes, levels: FloatArray, forces: FloatArray, name: str, unit: str, marks: list[FloatArray]
) -> None:
    """Bars from the least to the largest of forces (J, n), and marks of the forces from the weight above.

    `levels` are the heights of the joints and of the top, shape (J + 1,) [m].
    """
    levels, top, box = levels[:-1], levels[-1], np.diff(levels).min(initial=levels[0])
    low, high = forces.min(axis=1), forces.max(axis=1)
    usually = np.quantile(forces, USUAL, axis=1)
    axes.axvline(0.0, color=style.BLACK, linewidth=0.7)
    for (start, end), colour, label in (
        ((low, high), style.SKY, "least to largest"),
        (usually, style.BLUE, "nine tenths of the time"),
    ):
        bars = axes.barh(levels, end - start, left=start, height=BAR * box, label=label)
        for bar in bars:
            bar.set(color=colour, linewidth=0.8)
    name_of_marks: str | None = "weight above: N, ±μN, ±N × width/2"
    for mark in marks:
        axes.plot(
            mark, levels, "|", color=style.BLACK, markersize=11.0, markeredgewidth=1.2, label=name_of_marks
        )
        name_of_marks = None
    axes.set_ylim(0.0, top)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel(f"{name} [{unit}]")
    axes.margins(x=0.06)
    joint = int(np.abs(forces).max(axis=1).argmax())
    largest = f"up to {rounded(np.abs(forces[joint]).max())} {unit}, at {rounded(levels[joint])} m"
    axes.set_title(largest, fontsize=8.0, pad=4.0)


def _draw_bolt_force(
    axes: Axes, time: FloatArray, forces: FloatArray, name: str, colour: str, sign: float = 1.0
) -> None:
    """The largest of forces (J, n) >= 0 at every instant, drawn upwards or, with `sign` -1, downwards."""
    largest = forces.max(axis=0)
    joint, instant = np.unravel_index(int(forces.argmax()), forces.shape)
    where = f": {rounded(largest[instant])} kN at most, joint {joint + 1}, {time[instant]:.3f} s"
    if largest[instant] == 0.0:
        axes.plot([], [], color=colour, label=f"{name}: none")
        return
    samples = style.kept_samples(largest)
    axes.fill_between(time[samples], sign * largest[samples], color=colour, linewidth=0.4, label=name + where)
