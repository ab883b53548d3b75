"""Figure of the joints between the boxes of a stack: the forces in them, and what their bolts must carry.

Above: the range of each force over the height of the stack, with the force from the weight above (curves of several
joints over time would hide one another). Below: the largest bolt force at any joint over time; where it is not zero, a
joint without bolts opens at an edge or slides.
"""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.case.columns import JOINTS
from fem.case.tables.boxes import shared_face
from fem.figures import style
from fem.html.units import rounded
from fem.model.joints import edge_forces
from fem.results.reader import RunData
from fem.results.run_result import Verdict
from fem.runtime.arrays import FloatArray

HEADER = 3  #: lines of text above the panels of ranges: title, legend, largest force
RANGES, BETWEEN, BELOW = 1.4, 0.3, 0.78  #: height of these panels, gaps beside and below them [inch]
USUAL = (0.05, 0.95)  #: quantiles that enclose a force nine tenths of the time
THICK = 0.5  #: of a bar, over the height of a box
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
        bars = axes.barh(levels, end - start, left=start, height=THICK * box, label=label)
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
