"""The figure of the energy: what is stored over time, what the time stepping lost, and where all of it went."""

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.drawing import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    LEGEND_GAP,
    NEAR_LIMIT,
    ORANGE,
    PURPLE,
    TIME,
    VERMILLION,
    draw_curve,
    head,
    legend_above,
    number,
    panels,
    zero_line,
)
from fem.history import History
from fem.opening import OpenedRun
from fem.verdict import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT

NAMES = 0.09  #: of a figure's width, for the names beside bars


def energy_figure(run: OpenedRun) -> Figure:
    """Stored energies and the imbalance over time; what went in and where it went, at the end."""
    history, energy = run.history, run.result.get("energy") or {}
    time, reference = history["time_s"], energy.get("reference_J")
    figure, axes = panels((2.0, 0.9, 1.1), gaps=(LEGEND_GAP, 0.55), header=2)
    stored, imbalance, budget = axes
    # From the height of the mass centre of the container that stands: what its weight could still do.
    centroid = float((run.result.get("static") or {}).get("centroid_m") or 0.0)
    raised = history["potential_J"] - run.case.weight * centroid
    for values, name, colour, style in (
        (history["kinetic_J"], "kinetic", BLUE, "-"),
        (raised, "gravity and contact springs", VERMILLION, "--"),
        (history["strain_J"], "strain", GREEN, ":"),
    ):
        draw_curve(stored, time, 1e-3 * values, color=colour, linestyle=style, label=name)
    if reference and raised.max() > NEAR_LIMIT * reference:
        label = f"to overturn, {number(1e-3 * reference)} kJ"
        stored.axhline(1e-3 * reference, color=BLACK, linestyle="-.", linewidth=0.9, label=label)
    stored.set_ylabel("energy [kJ]")
    legend_above(stored)
    zero_line(imbalance)
    draw_curve(imbalance, time, history["imbalance_J"], color=PURPLE, label=_imbalance_limits(energy))
    imbalance.set_ylabel("imbalance [J]")
    imbalance.set_xlabel(TIME)
    legend_above(imbalance)
    stored.sharex(imbalance)
    stored.tick_params(labelbottom=False)
    for panel in (stored, imbalance):
        panel.set_gid(TIME)
    box = budget.get_position()
    budget.set_position((box.x0 + NAMES, box.y0, box.width - NAMES, box.height))
    _draw_budget(budget, energy, history)
    closure = energy.get("closure_error")
    share = (
        "" if closure is None else f": largest imbalance {number(closure, 2)} of what it takes to overturn"
    )
    head(figure, f"Energy{share}", status=run.status)
    return figure


def _imbalance_limits(energy: Mapping[str, Any]) -> str:
    """What the scheme lost or won, and what would fail the run."""
    told, reference = "lost (> 0) or won by the time stepping", energy.get("reference_J")
    if not reference:
        return told
    spent = sum(energy.get(key) or 0.0 for key in ("friction_J", "contact_damping_J", "material_damping_J"))
    loss = max(LOSS_SHARE_LIMIT * spent, LOSS_LIMIT * reference)
    return f"{told}; to lose {number(loss)} J or win {number(GAIN_LIMIT * reference, 2)} J would fail the run"


def _draw_budget(axes: Axes, energy: Mapping[str, Any], history: History) -> None:
    """Bars of what the floor put in and what took it."""
    stored = sum(
        float(history[key][-1] - history[key][0]) for key in ("kinetic_J", "strain_J", "potential_J")
    )
    bars = (
        ("work of the floor", energy.get("base_work_J"), BLUE),
        ("stored since the start", stored, GREY),
        ("friction", energy.get("friction_J"), VERMILLION),
        ("contact damping", energy.get("contact_damping_J"), GREEN),
        ("material damping", energy.get("material_damping_J"), ORANGE),
        ("imbalance", energy.get("numerical_J"), PURPLE),
    )
    known = [(name, 1e-3 * float(value), colour) for name, value, colour in bars if value is not None]
    for row, (_, value, colour) in enumerate(known):
        axes.barh(row, value, height=0.72, color=colour)
        axes.annotate(
            number(value),
            (max(value, 0.0), row),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    axes.axvline(0.0, color=GREY, linewidth=0.7)
    axes.set_yticks(range(len(known)), [name for name, *_ in known], fontsize=7.5)
    axes.tick_params(axis="y", length=0)
    axes.invert_yaxis()
    axes.set_xmargin(0.13)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("over the whole run [kJ]")
