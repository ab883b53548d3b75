"""Figures of a run: floor motion, rotation, slip, uplift and phase portrait; the list of all figures.

Each function takes an opened run and returns a matplotlib Figure, or None where the run has no such data. Rotation in
degrees, lengths in mm, forces in kN; x to the right, rotation > 0 toward +x, forces on the container.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact.stepping.modes import ROCKING
from fem.figures import style
from fem.figures.boxes import OPENING, ROTATION, SLIP, box_figure, joints_figure
from fem.figures.checks import band_figure, rigid_check_figure
from fem.figures.forces import energy_figure, forces_figure
from fem.figures.modes import modes_figure
from fem.figures.motions import spectrum_figure
from fem.html.page import Drawing
from fem.html.units import rounded
from fem.model.container import Container
from fem.results.history import History
from fem.results.outcome import least_slide
from fem.results.reader import RunData
from fem.results.run_result import StaticResult, Verdict
from fem.runtime.arrays import FloatArray, IntArray
from fem.runtime.units import DEGREES, RATIO
from fem.solid.modes import FEW

LEAST_MOTION = 1e-3  #: of the floor, on its axes [mm, m/s, m/s2]
#: of a phase portrait
PHASES: dict[str, dict[str, Any]] = {
    "on the floor": {"color": style.BLUE, "linewidth": 0.8, "zorder": 2.2},
    "in the air": {"color": style.SKY, "linewidth": 0.6},
    "lands": {"color": style.GREY, "linewidth": 0.5, "linestyle": ":"},
}
ON_THE_FLOOR, IN_THE_AIR, LANDS = range(3)
#: one curve over time: column, factor, label
CURVES = {
    "rotation": ("rotation_rad", math.degrees(1.0), "rotation [degrees]"),
    "slip": ("slip_m", 1e3, "slip [mm]"),
    "uplift": ("uplift_m", 1e3, "uplift [mm]"),
}
LANDING_FORCE = 2.0  #: times weight: a larger force is that of a landing


def figures_of(run: RunData) -> dict[str, Figure]:
    """All figures of this run by name, in the order of reading; FolderError without a sound history."""
    if len(run.history.modes) < 2:
        return {}
    with style.house_style():
        drawn = {name: draw(run) for name, draw in FIGURES.items()}
    return {name: figure for name, figure in drawn.items() if figure is not None}


def figure_of(run: RunData, name: str) -> Figure:
    """The figure of this name.

    Raises:
        ValueError: this run has no such figure; with those that it has.
        FolderError: the history is missing or damaged.
    """
    with style.house_style():
        figure = FIGURES[name](run) if name in FIGURES and len(run.history.modes) > 1 else None
    if figure is None:
        raise ValueError(f"no figure {name!r} of this run; there are {', '.join(figures_of(run)) or 'none'}")
    return figure


def draw_curve(run: RunData, name: str, axes: Axes) -> Figure:
    """Draw rotation, slip or uplift over time into axes that hold other runs, too; returns their figure.

    Raises:
        ValueError: another figure, which has axes of its own.
        FolderError: the history is missing or damaged.
    """
    if name not in CURVES:
        raise ValueError(f"figure {name!r} has axes of its own; with ax=: {', '.join(CURVES)}")
    column, factor, label = CURVES[name]
    axes.plot(run.history["time_s"], factor * run.history[column], label=run.name)
    axes.set(xlabel=style.TIME, ylabel=label)
    return axes.figure.figure


def draw_all(run: RunData, container: Container) -> list[Drawing]:
    """The figures of a run as SVG, with the elastic modes of its container whatever the model; errors likewise."""
    figures, elements = figures_of(run), container.elements
    with style.house_style():
        figures["modes"] = modes_figure(
            points=elements.nodes,
            cells=elements.cells,
            box=elements.box,
            modes=container.lowest_modes(FEW),
            name=run.name,
        )
    drawings = []
    for name, figure in figures.items():
        svg = style.svg_of(figure)  # lays the figure out
        title = figure.texts[0].get_text()  # written by `head`
        drawings.append(Drawing(name=name, title=title, cursor=style.cursor_axes(figure), svg=svg))
    return drawings


def base_motion_figure(run: RunData) -> Figure:
    """Displacement, velocity and acceleration of the floor, along x and upward."""
    history, static = run.history, run.typed_result.static or StaticResult()
    displacement, acceleration = 1e3 * history["base_displacement_m"], history["base_acceleration_m_s2"]
    gaps = (style.LEGEND_GAP if history.vertical else style.GAP, style.LEGEND_GAP)
    figure, axes = style.time_panels((1.25, 1.25, 1.35), gaps=gaps, header=2 if history.vertical else 1)
    for panel, column, factor, label, colour in (
        (axes[0], "displacement_m", 1e3, "displacement [mm]", style.BLUE),
        (axes[1], "velocity_m_s", 1.0, "velocity [m/s]", style.GREEN),
        (axes[2], "acceleration_m_s2", 1.0, "acceleration [m/s²]", style.VERMILLION),
    ):
        values = factor * history[f"base_{column}"]
        name = "along x" if history.vertical and panel is axes[0] else None
        style.curve_panel(panel, label, history["time_s"], (values, colour, "-", name))
        if history.vertical:
            upward = factor * history[f"base_vertical_{column}"]
            style.curve_panel(
                panel, label, history["time_s"], (upward, style.GREY, "-", name and "upward"), zero=False
            )
        style.keep_visible(panel, LEAST_MOTION)
    peak, moved = float(np.abs(acceleration).max()), float(np.abs(displacement).max())
    weight = style.changing_weight(history, run.case.gravity_m_s2)
    downhill = abs(run.case.gravity_downhill)
    for limit, dashes, name in (
        (static.uplift_acceleration_m_s2, "--", "tilts"),
        (run.case.contact.mu_static * run.case.gravity_toward_floor - downhill, ":", "slides"),
    ):
        if limit and limit < 1.3 * peak:
            label = f"a static load {name} it from {rounded(limit)} m/s²"
            if history.vertical:
                label = f"{name} statically from {rounded(limit)} (g + a_v)/g"
            style.draw_limits(axes[2], (limit, -limit), label, dashes, of_weight=weight)
    if axes[2].get_legend_handles_labels()[0]:
        style.legend_above(axes[2])
    title = f"Motion of the floor: {rounded(moved)} mm and {rounded(peak)} m/s² at most"
    if not (peak or moved):
        title = "The floor stands still"
    if history.vertical:
        style.legend_above(axes[0])
        vertical = float(np.abs(history["base_vertical_acceleration_m_s2"]).max())
        along = title if peak or moved else "Motion of the floor"
        title = f"{along}; {rounded(vertical)} m/s² upward or downward"
    style.head(figure, title)
    return figure


def rotation_figure(run: RunData) -> Figure:
    """Rotation with the slenderness angle marked, the rigid block's beside it where there is one; of each loose box."""
    if boxes := run.verdict.boxes:
        return box_figure(run, ROTATION, boxes)
    verdict, angle = run.typed_result.verdict or Verdict(), math.degrees(run.slenderness_angle)
    rotation, check = np.degrees(run.history["rotation_rad"]), run.rigid_check
    figure, axes = _panel(run, rotation, "rotation [degrees]", f"{run.case.solver.model} model", legend=True)
    if check is not None:
        block = np.degrees(check["analytic_rotation_rad"])
        style.curve_panel(
            axes,
            "rotation [degrees]",
            check["time_s"],
            (block, style.VERMILLION, "--", "rigid block"),
            zero=False,
        )
    largest, rocking = float(np.abs(rotation).max()), ROCKING * angle
    if largest >= style.NEAR_LIMIT * angle:
        style.keep_visible(axes, 1.12 * angle)
        style.draw_limits(axes, (angle, -angle), f"slenderness angle ±{rounded(angle, 4)}°", "-.")
    else:
        style.keep_visible(axes, 1.2 * rocking)
        if largest < 10.0 * rocking:
            name = f"counts as rocking, ±{rounded(rocking, 2)}°"
            style.draw_limits(axes, (rocking, -rocking), name, ":", colour=style.GREY)
        axes.plot([], [], " ", label=f"slenderness angle ±{rounded(angle, 4)}°: far off the scale")
    style.mark_instant(axes, "first impact", verdict.first_impact_s)
    style.legend_above(axes)
    turned = math.degrees(verdict.max_rotation_rad or math.radians(largest))
    least, ratio = math.degrees(DEGREES.least), RATIO.text(turned / angle)
    largest_shown = f"< {least:g}" if 0.0 < turned < least else rounded(turned)
    style.head(
        figure, f"Rotation: {largest_shown}° at most, {ratio} of the slenderness angle", status=run.status
    )
    return figure


def slip_figure(run: RunData) -> Figure:
    """Sliding of the loaded contact points over the floor; of each loose box over what is below it."""
    if boxes := run.verdict.boxes:
        return box_figure(run, SLIP, boxes)
    verdict, slip = run.typed_result.verdict or Verdict(), 1e3 * run.history["slip_m"]
    limit = 1e3 * least_slide(run.case.container.width_m)
    small = bool(np.abs(slip).max() < 10.0 * limit)
    figure, axes = _panel(run, slip, "slip [mm]", zero=True, legend=small)
    style.keep_visible(axes, 1.5 * limit)
    if small:
        name = f"counts as sliding, ±{rounded(limit, 2)} mm"
        style.draw_limits(axes, (limit, -limit), name, ":", colour=style.GREY)
        style.legend_above(axes)
    largest = 1e3 * verdict.slipped
    travel = 1e3 * (verdict.slip_travel_m or 0.0)
    left = verdict.residual_slip_m  # the end may lie between two samples
    end = slip[-1] if left is None else 1e3 * left
    title = f"Slip: {_millimetres(largest)} at most, {_millimetres(end)} at the end, {_millimetres(travel)} travelled"
    style.head(figure, title, status=run.status)
    return figure


def uplift_figure(run: RunData) -> Figure:
    """Uplift of the higher side of the base; of each loose box from what is below it."""
    if boxes := run.verdict.boxes:
        return box_figure(run, OPENING, boxes)
    verdict, uplift = run.typed_result.verdict or Verdict(), 1e3 * run.history["uplift_m"]
    struck = verdict.first_impact_s is not None
    figure, axes = _panel(run, uplift, "uplift [mm]", legend=struck)
    axes.set_ylim(0.0, max(1.08 * float(uplift.max()), run.case.container.width_m))
    if struck:
        style.mark_instant(axes, "first impact", verdict.first_impact_s)
        style.legend_above(axes)
    impacts, largest = verdict.impacts, 1e3 * (verdict.max_uplift_m or 0.0)
    count = "" if impacts is None else f", {impacts} impact{'' if impacts == 1 else 's'}"
    title = f"Uplift of the base: {rounded(largest)} mm at most{count}"
    style.head(figure, title if largest > 0.0 else "The base never opens", status=run.status)
    return figure


def phase_portrait_figure(run: RunData) -> Figure | None:
    """Angular velocity over rotation: on a corner, landing, and in the air, where the angular velocity is constant.

    With the curve within which a free rigid block returns. Of a loose stack that of its lowest box; none where this
    does not rock.
    """
    static, history = run.typed_result.static or StaticResult(), run.history
    angle, parameter = run.slenderness_angle, static.frequency_parameter_1_s
    if run.verdict.boxes and run.verdict.boxes[0].max_rotation_rad < ROCKING * angle:
        return None
    rotation, rate = history["rotation_rad"], history["angular_velocity_rad_s"]
    figure, (axes,) = style.panels((4.0,), width=0.8 * style.WIDTH, header=3)
    axes.set_label(style.PLANE)  # for `cursor_axes`
    phase, share = phases(history, run.case.weight), run.verdict.flight_share
    ends = [0, *(np.flatnonzero(np.diff(phase)) + 1), len(phase)]
    spans = [(phase[first], slice(first, last + 1)) for first, last in pairwise(ends)]
    for k, (name, look) in enumerate(PHASES.items()):
        own = [
            np.degrees([[*rotation[span], np.nan], [*rate[span], np.nan]])
            for kind, span in spans
            if kind == k
        ]
        if own:
            axes.plot(*np.hstack(own), label=name, **look)
    axes.plot(*np.degrees([rotation[0], rate[0]]), "o", color=style.GREEN, label="start", zorder=3)
    axes.plot(*np.degrees([rotation[-1], rate[-1]]), "s", color=style.VERMILLION, label="end", zorder=3)
    if parameter and np.abs(rotation).max() >= style.NEAR_LIMIT * angle:
        tilt = np.linspace(-angle, angle, 201)
        bound = parameter * np.sqrt(2.0 * (1.0 - np.cos(angle - np.abs(tilt))))
        outline = np.degrees([[*tilt, *tilt[::-1]], [*bound, *-bound[::-1]]])
        axes.plot(
            *outline, "--", color=style.BLACK, linewidth=1.0, label="a free rigid block returns from within"
        )
    axes.margins(x=0.06)
    least = 1.2 * ROCKING * math.degrees(angle)
    axes.set_xlim(min(axes.get_xlim()[0], -least), max(axes.get_xlim()[1], least))
    style.keep_visible(axes, least)
    axes.set_xlabel("rotation [degrees]")
    axes.set_ylabel("angular velocity [degrees/s]")
    style.legend_above(axes, columns=3)
    of_box = " of box 1" if run.verdict.boxes else ""
    in_the_air = f", {rounded(100.0 * share, 2)} % of the rocking in the air" if share else ""
    style.head(figure, f"Phase portrait of the rotation{of_box}{in_the_air}", status=run.status)
    return figure


def phases(history: History, weight: float) -> IntArray:
    """Which of `PHASES` the motion from each sample to the next belongs to, shape (n_samples - 1,); weight [N]."""
    force, rotation, uplift = (history[name] for name in ("normal_force_N", "rotation_rad", "uplift_m"))
    lands = np.maximum(force[:-1], force[1:]) > LANDING_FORCE * weight
    lands |= (rotation[:-1] * rotation[1:] < 0.0) & (np.maximum(uplift[:-1], uplift[1:]) > 0.0)
    flies = np.minimum(force[:-1], force[1:]) <= 0.0
    return np.where(lands, LANDS, np.where(flies, IN_THE_AIR, ON_THE_FLOOR))


FIGURES: dict[str, Callable[[RunData], Figure | None]] = {
    "base_motion": base_motion_figure,
    "spectrum": spectrum_figure,
    "rotation": rotation_figure,
    "slip": slip_figure,
    "uplift": uplift_figure,
    "forces": forces_figure,
    "joints": joints_figure,
    "phase_portrait": phase_portrait_figure,
    "energy": energy_figure,
    "rigid_check": rigid_check_figure,
    "band": band_figure,
}


def _panel(
    run: RunData, values: FloatArray, label: str, name: str | None = None, *, legend: bool, zero: bool = False
) -> tuple[Figure, Axes]:
    """One curve over time with the states of motion below it, and room for a legend above."""
    figure, (axes,) = style.time_panels((2.3,), history=run.history, header=2 if legend else 1)
    style.curve_panel(axes, label, run.history["time_s"], (values, style.BLUE, "-", name), zero=zero)
    return figure, axes


def _millimetres(value: float) -> str:
    """A slip in a title; below 0.01 mm it has no practical meaning."""
    return "< 0.01 mm" if 0.0 < abs(value) < 0.01 else f"{rounded(value)} mm"
