"""The figure of the joints between the boxes of a stack: what they carry, and whether they would hold unbolted.

Forces are means over `output.history_s`, on the boxes above (`fem.joints`). An unbolted joint slides where the shear
exceeds mu_static of the floor times the normal force, and opens at an edge where the moment exceeds the normal force
times half the width (`fem.joint_demands`): demand over capacity, of the joint that is worst at each instant.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.drawing import (
    BLACK,
    BLUE,
    GREEN,
    LEGEND_GAP,
    ORANGE,
    PURPLE,
    VERMILLION,
    draw_curve,
    draw_states,
    head,
    legend_above,
    number,
    states_of,
    time_panels,
    zero_line,
)
from fem.figures_forces import LARGE_FORCE, cut_off, scale_without_impacts
from fem.history import JOINT_COLUMNS, FloatArray
from fem.opening import OpenedRun

#: of the joints drawn, from the floor up
LINES = ((BLUE, "-"), (VERMILLION, "--"), (GREEN, ":"))
MOST_USE = 3.0  #: demand over capacity at which the scale ends


def joints_figure(run: OpenedRun) -> Figure | None:
    """Normal force, shear and moment of at most three joints; demand over capacity without bolts; None for one box."""
    history, case = run.history, run.case
    if history.joints == 0:
        return None
    width, mu, time = case.container.width_m, case.contact.mu_static, history["time_s"]
    normal, shear, moment = (
        1e-3 * np.array([history[name.format(joint)] for joint in range(1, history.joints + 1)])
        for name in JOINT_COLUMNS
    )
    above = 1e-3 * case.weight * (1.0 - 1.0 / case.container.boxes)  # the lowest joint
    states = states_of(history.modes)
    figure, axes = time_panels((1.0, 1.0, 1.0, 0.9), states=states, gaps=(0.1, 0.1, LEGEND_GAP), header=3)
    shown = _shown(history.joints)
    beyond = False
    for panel, forces, label, large in (
        (axes[0], normal, "normal [kN]", above),
        (axes[1], shear, "shear [kN]", mu * above),
        (axes[2], moment, "moment [kNm]", 0.5 * width * above),
    ):
        zero_line(panel)
        for (colour, style), joint in zip(LINES, shown, strict=False):
            name = f"joint {joint + 1}, {number((joint + 1) * case.container.height_m)} m above the floor"
            draw_curve(panel, time, forces[joint], color=colour, linestyle=style, linewidth=0.7, label=name)
        panel.set_ylabel(label)
        largest = _largest(forces)
        limit = scale_without_impacts(largest, LARGE_FORCE * large)
        if limit is not None:
            cut_off(panel, time, largest, limit)
            panel.set_ylim(bottom=max(-limit, min(0.0, 1.05 * forces.min()) - 0.03 * limit))
            beyond = True
    legend_above(axes[0], columns=3)
    _draw_use(axes[3], time, _use(mu * normal, shear), _use(0.5 * width * normal, moment))
    draw_states(axes[-1], time, history.modes, states)
    statement = (
        f"marks at the rim: beyond the scale, up to {number(np.abs(normal).max())} and "
        f"{number(np.abs(shear).max())} kN, {number(np.abs(moment).max())} kNm, in impacts"
    )
    head(figure, "Forces in the joints between the boxes", statement if beyond else "", status=run.status)
    return figure


def _shown(count: int) -> list[int]:
    """The lowest joint, the uppermost, and the one in between."""
    return sorted({0, (count - 1) // 2, count - 1})


def _largest(forces: FloatArray) -> FloatArray:
    """Of forces (J, n) the largest in size at every instant, with its sign, shape (n,)."""
    return np.take_along_axis(forces, np.abs(forces).argmax(axis=0)[None], axis=0)[0]


def _use(capacity: FloatArray, demand: FloatArray) -> FloatArray:
    """Largest demand over capacity of the joints (J, n), beyond the scale where nothing is carried, shape (n,)."""
    beyond = np.full(demand.shape, 2.0 * MOST_USE)
    use = np.divide(np.abs(demand), capacity, out=beyond, where=capacity > 0.0)
    return np.where(demand == 0.0, 0.0, np.minimum(use, 2.0 * MOST_USE)).max(axis=0)


def _draw_use(axes: Axes, time: FloatArray, sliding: FloatArray, opening: FloatArray) -> None:
    """Demand over capacity of the worst joint, were there no bolts."""
    draw_curve(axes, time, sliding, color=ORANGE, linewidth=0.7, label="slides: shear over mu N")
    draw_curve(
        axes,
        time,
        opening,
        color=PURPLE,
        linestyle="--",
        linewidth=0.7,
        label="opens: moment over N a/2",
    )
    axes.axhline(1.0, color=BLACK, linewidth=0.9, linestyle="-.", label="capacity without bolts")
    largest = float(max(sliding.max(), opening.max()))
    axes.set_ylim(0.0, min(MOST_USE, max(1.2, 1.05 * largest)))
    axes.set_ylabel("worst joint [-]")
    legend_above(axes, columns=3)
