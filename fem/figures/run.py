"""The figures of a run: what the floor did, what the container did, and where the energy went.

One function a figure; each takes an opened run and returns a matplotlib Figure. Titles say what one sees. Rotation in
degrees, lengths in mm, forces in kN; x to the right, rotation > 0 toward +x, forces on the container.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact.stepping.observables import ROCKING
from fem.assessment.summary import LEAST_DEGREES, LEAST_RATIO
from fem.assessment.verdict import SLIDING
from fem.figures.checks import band_figure, rigid_check_figure
from fem.figures.energy import energy_figure
from fem.figures.forces import forces_figure
from fem.figures.joints import joints_figure
from fem.figures.modes import modes_figure
from fem.figures.style import (
    BLACK,
    BLUE,
    GAP,
    GREEN,
    GREY,
    LEGEND_GAP,
    NEAR_LIMIT,
    VERMILLION,
    WIDTH,
    Drawing,
    draw_curve,
    draw_limits,
    draw_states,
    follow_in_plane,
    followed,
    head,
    house_style,
    keep_visible,
    kept_samples,
    legend_above,
    number,
    panels,
    states_of,
    svg_of,
    time_panels,
    title_of,
    zero_line,
)
from fem.model.container import Container
from fem.results.reader import OpenedRun
from fem.solid.modes import FEW, elastic_modes

LEAST_MOTION = 1e-3  #: of the floor, on its axes [mm, m/s, m/s2]


def figures_of(run: OpenedRun) -> dict[str, Figure]:
    """Every figure that this run has, by name, in the order of reading.

    Raises:
        FolderError: the history is missing or damaged.
    """
    if len(run.history) < 2:
        return {}
    with house_style():
        drawn = {name: draw(run) for name, draw in FIGURES.items()}
    return {name: figure for name, figure in drawn.items() if figure is not None}


def draw_all(run: OpenedRun, container: Container) -> list[Drawing]:
    """The figures of a run and the elastic modes of its container, whether or not they took part, as SVG.

    Raises:
        FolderError: the history is missing or damaged.
    """
    figures, elements = figures_of(run), container.elements
    with house_style():
        figures["modes"] = modes_figure(
            points=elements.nodes,
            cells=elements.cells,
            modes=elastic_modes(elements, FEW),
            boxes=run.case.container.boxes,
            name=run.name,
        )
    return [_drawing(name, figure) for name, figure in figures.items()]


def _drawing(name: str, figure: Figure) -> Drawing:
    svg = svg_of(figure)  # which lays the figure out
    return Drawing(
        name=name, title=title_of(figure) or name.replace("_", " "), followed=followed(figure), svg=svg
    )


def base_motion_figure(run: OpenedRun) -> Figure:
    """Displacement, velocity and acceleration of the floor."""
    history, static = run.history, run.result.get("static") or {}
    displacement, acceleration = 1e3 * history["base_displacement_m"], history["base_acceleration_m_s2"]
    figure, axes = time_panels((1.25, 1.25, 1.35), gaps=(GAP, LEGEND_GAP), header=1)
    for panel, values, label, colour in (
        (axes[0], displacement, "displacement [mm]", BLUE),
        (axes[1], history["base_velocity_m_s"], "velocity [m/s]", GREEN),
        (axes[2], acceleration, "acceleration [m/s²]", VERMILLION),
    ):
        zero_line(panel)
        draw_curve(panel, history["time_s"], values, color=colour)
        panel.set_ylabel(label)
        keep_visible(panel, LEAST_MOTION)
    peak, moved = float(np.abs(acceleration).max()), float(np.abs(displacement).max())
    for limit, style, name in (
        (static.get("uplift_acceleration_m_s2"), "--", "a static load tilts it"),
        (run.case.contact.mu_static * run.case.gravity_m_s2, ":", "a static load slides it"),
    ):
        if limit and limit < 1.3 * peak:
            draw_limits(axes[2], limit, f"{name} from {number(limit)} m/s²", color=BLACK, linestyle=style)
    if axes[2].get_legend_handles_labels()[0]:
        legend_above(axes[2])
    still = peak == 0.0 and moved == 0.0
    head(
        figure,
        "The floor stands still"
        if still
        else f"Motion of the floor: {number(moved)} mm and {number(peak)} m/s² at most",
    )
    return figure


def rotation_figure(run: OpenedRun) -> Figure:
    """Rotation with the slenderness angle marked, the rigid block's beside it where there is one."""
    history, verdict, angle = run.history, _verdict(run), math.degrees(run.slenderness_angle)
    rotation, check = np.degrees(history["rotation_rad"]), run.rigid_check
    figure, axes = _panel_with_states(run, "rotation [degrees]", legend=True)
    draw_curve(axes, history["time_s"], rotation, color=BLUE, label=f"{run.case.solver.model} model")
    if check is not None:
        block = np.degrees(check["analytic_rotation_rad"])
        draw_curve(axes, check["time_s"], block, color=VERMILLION, linestyle="--", label="rigid block")
    largest, rocking = float(np.abs(rotation).max()), ROCKING * angle
    if largest >= NEAR_LIMIT * angle:
        keep_visible(axes, 1.12 * angle)
        draw_limits(axes, angle, f"slenderness angle ±{number(angle, 4)}°", color=BLACK, linestyle="-.")
    else:
        keep_visible(axes, 1.2 * rocking)
        if largest < 10.0 * rocking:
            draw_limits(
                axes, rocking, f"counts as rocking, ±{number(rocking, 2)}°", color=GREY, linestyle=":"
            )
        axes.plot([], [], " ", label=f"slenderness angle ±{number(angle, 4)}°: far off the scale")
    _mark_impact(axes, verdict)
    legend_above(axes)
    found = math.degrees(verdict.get("max_rotation_rad") or math.radians(largest))
    told = f"{number(found)}° at most, {number(found / angle)} of the slenderness angle"
    if 0.0 < found < LEAST_DEGREES and found / angle < LEAST_RATIO:
        told = f"< {LEAST_DEGREES:g}° at most, < {LEAST_RATIO:g} of the slenderness angle"
    head(figure, f"Rotation: {told}", status=run.status)
    return figure


def slip_figure(run: OpenedRun) -> Figure:
    """Sliding of the loaded contact points over the floor."""
    verdict, slip = _verdict(run), 1e3 * run.history["slip_m"]
    limit = 1e3 * SLIDING * run.case.container.width_m
    small = bool(np.abs(slip).max() < 10.0 * limit)
    figure, axes = _panel_with_states(run, "slip [mm]", legend=small)
    zero_line(axes)
    draw_curve(axes, run.history["time_s"], slip, color=BLUE)
    keep_visible(axes, 1.5 * limit)
    if small:
        draw_limits(axes, limit, f"counts as sliding, ±{number(limit, 2)} mm", color=GREY, linestyle=":")
        legend_above(axes)
    largest = 1e3 * (verdict.get("max_slip_m") or 0.0)
    travel = 1e3 * (verdict.get("slip_travel_m") or 0.0)
    left = verdict.get("residual_slip_m")  # the end may lie between two samples
    end = slip[-1] if left is None else 1e3 * left
    head(
        figure,
        f"Slip: {_millimetres(largest)} at most, {_millimetres(end)} at the end, {_millimetres(travel)} travelled",
        status=run.status,
    )
    return figure


def uplift_figure(run: OpenedRun) -> Figure:
    """How high the lifted side of the base stands."""
    verdict, uplift = _verdict(run), 1e3 * run.history["uplift_m"]
    struck = verdict.get("first_impact_s") is not None
    figure, axes = _panel_with_states(run, "uplift [mm]", legend=struck)
    draw_curve(axes, run.history["time_s"], uplift, color=BLUE)
    axes.set_ylim(0.0, max(1.08 * float(uplift.max()), run.case.container.width_m))
    if struck:
        _mark_impact(axes, verdict)
        legend_above(axes)
    impacts, largest = verdict.get("impacts"), 1e3 * (verdict.get("max_uplift_m") or 0.0)
    count = "" if impacts is None else f", {impacts} impact{'' if impacts == 1 else 's'}"
    title = (
        f"Uplift of the base: {number(largest)} mm at most{count}"
        if largest > 0.0
        else "The base never opens"
    )
    head(figure, title, status=run.status)
    return figure


def phase_portrait_figure(run: OpenedRun) -> Figure:
    """Angular velocity over rotation, within the curve that a free rigid block returns from."""
    angle, parameter = run.slenderness_angle, (run.result.get("static") or {}).get("frequency_parameter_1_s")
    rotation, rate = run.history["rotation_rad"], run.history["angular_velocity_rad_s"]
    figure, (axes,) = panels((4.0,), width=0.8 * WIDTH, header=2)
    follow_in_plane(axes, "rotation", "rate", math.degrees(1.0))
    kept = kept_samples(rotation, rate)
    axes.plot(np.degrees(rotation[kept]), np.degrees(rate[kept]), color=BLUE, linewidth=0.7)
    axes.plot(*np.degrees([rotation[0], rate[0]]), "o", color=GREEN, label="start")
    axes.plot(*np.degrees([rotation[-1], rate[-1]]), "s", color=VERMILLION, label="end")
    if parameter and np.abs(rotation).max() >= NEAR_LIMIT * angle:
        tilt = np.linspace(-angle, angle, 201)
        bound = parameter * np.sqrt(2.0 * (1.0 - np.cos(angle - np.abs(tilt))))
        outline = np.degrees([[*tilt, *tilt[::-1]], [*bound, *-bound[::-1]]])
        axes.plot(*outline, "--", color=BLACK, linewidth=1.0, label="a free rigid block returns from within")
    axes.margins(x=0.06)
    least = 1.2 * ROCKING * math.degrees(angle)
    axes.set_xlim(min(axes.get_xlim()[0], -least), max(axes.get_xlim()[1], least))
    keep_visible(axes, least)
    axes.set_xlabel("rotation [degrees]")
    axes.set_ylabel("angular velocity [degrees/s]")
    legend_above(axes)
    head(figure, "Phase portrait of the rotation", status=run.status)
    return figure


FIGURES: dict[str, Callable[[OpenedRun], Figure | None]] = {
    "base_motion": base_motion_figure,
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


def _panel_with_states(run: OpenedRun, label: str, *, legend: bool) -> tuple[Figure, Axes]:
    """One panel over time, with room for a legend above and the states of motion below."""
    states = states_of(run.history.modes)
    figure, (axes, below) = time_panels((2.3,), states=states, header=2 if legend else 1)
    axes.set_ylabel(label)
    draw_states(below, run.history["time_s"], run.history.modes, states)
    return figure, axes


def _verdict(run: OpenedRun) -> Mapping[str, Any]:
    return run.result.get("verdict") or {}


def _millimetres(value: float) -> str:
    """A slip as told in a title; what is below 0.01 mm is nobody's measure."""
    return "< 0.01 mm" if 0.0 < abs(value) < 0.01 else f"{number(value)} mm"


def _mark_impact(axes: Axes, verdict: Mapping[str, Any]) -> None:
    """A line at the first impact, if there is one."""
    impact = verdict.get("first_impact_s")
    if impact is not None:
        label = f"first impact, {impact:.3f} s"
        axes.axvline(impact, color=GREY, linestyle=(0, (1, 2)), linewidth=1.0, label=label)
