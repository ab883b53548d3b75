"""The figure of the energy over time: what is stored, what came in and where it went, what the time stepping lost."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.assessment.verdict import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT
from fem.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    LEGEND_GAP,
    LINE,
    NEAR_LIMIT,
    ORANGE,
    PURPLE,
    TIME,
    VERMILLION,
    draw_curve,
    follow_over_time,
    head,
    legend_above,
    number,
    panels,
    zero_line,
)
from fem.results.history import History
from fem.results.reader import OpenedRun

#: out of the energy that the floor puts in, as columns of a history
TAKEN = ("friction_J", "contact_damping_J", "material_damping_J", "imbalance_J")
SMALL = 1e3  #: energies that stand in J and not in kJ [J]
DECIMALS = 3  #: of an energy in a legend


def energy_figure(run: OpenedRun) -> Figure:
    """What is stored, what the floor put in and where it went, and what the time stepping lost, over time."""
    history, energy = run.history, run.result.get("energy") or {}
    figure, axes = panels((1.7, 1.9, 0.9), gaps=(LEGEND_GAP + LINE, LEGEND_GAP), header=2)
    stored, passed, imbalance = axes
    unit = _unit(history)
    _draw_stored(stored, run, unit)
    _draw_passed(passed, history, unit)
    zero_line(imbalance)
    draw_curve(
        imbalance, history["time_s"], history["imbalance_J"], color=PURPLE, label=_imbalance_limits(energy)
    )
    imbalance.set_ylabel("imbalance [J]")
    imbalance.set_xlabel(TIME)
    for panel in axes:
        follow_over_time(panel)
    for panel in (stored, passed):
        panel.sharex(imbalance)
        panel.tick_params(labelbottom=False)
    legend_above(stored)
    legend_above(passed, columns=3)
    legend_above(imbalance)
    closure = energy.get("closure_error")
    share = (
        "" if closure is None else f": largest imbalance {number(closure, 2)} of what it takes to overturn"
    )
    head(figure, f"Energy{share}", status=run.status)
    return figure


def _unit(history: History) -> tuple[str, float]:
    """The unit of energies and its size [J]: kJ, or J for a small container."""
    largest = max(
        float(np.abs(history[name]).max()) for name in ("kinetic_J", "strain_J", "base_work_J", *TAKEN)
    )
    return ("kJ", 1e3) if largest >= SMALL else ("J", 1.0)


def _draw_stored(axes: Axes, run: OpenedRun, unit: tuple[str, float]) -> None:
    """Energy of motion, height and strain, with what it takes to overturn."""
    history, reference = run.history, (run.result.get("energy") or {}).get("reference_J")
    # From the height of the mass centre of the container that stands: what its weight could still do.
    centroid = float((run.result.get("static") or {}).get("centroid_m") or 0.0)
    raised = history["potential_J"] - run.case.weight * centroid
    name_of_unit, size = unit
    for values, name, colour, style in (
        (history["kinetic_J"], "kinetic", BLUE, "-"),
        (raised, "gravity", VERMILLION, "--"),
        (history["strain_J"], "strain", GREEN, ":"),
    ):
        draw_curve(axes, history["time_s"], values / size, color=colour, linestyle=style, label=name)
    if reference and raised.max() > NEAR_LIMIT * reference:
        label = f"to overturn, {number(reference / size)} {name_of_unit}"
        axes.axhline(reference / size, color=BLACK, linestyle="-.", linewidth=0.9, label=label)
    axes.set_ylabel(f"stored [{name_of_unit}]")


def _draw_passed(axes: Axes, history: History, unit: tuple[str, float]) -> None:
    """Sums since the start; what is left of the floor's work is stored, in the springs of the contact too."""
    stored = history["base_work_J"] - sum(history[name] for name in TAKEN)
    name_of_unit, size = unit
    zero_line(axes)
    for values, name, colour, style in (
        (history["base_work_J"], "work of the floor", BLUE, "-"),
        (stored, "stored", GREY, "-"),
        (history["friction_J"], "friction", VERMILLION, "--"),
        (history["contact_damping_J"], "contact damping", GREEN, "-."),
        (history["material_damping_J"], "material damping", ORANGE, ":"),
    ):
        end = round(float(values[-1]) / size, DECIMALS) + 0.0  # no minus zero
        label = f"{name}, {number(end)} {name_of_unit}"
        draw_curve(axes, history["time_s"], values / size, color=colour, linestyle=style, label=label)
    axes.set_ylabel(f"since the start [{name_of_unit}]")


def _imbalance_limits(energy: Mapping[str, Any]) -> str:
    """What the scheme lost or won, and what would fail the run."""
    told, reference = "lost (> 0) or won by the time stepping", energy.get("reference_J")
    if not reference:
        return told
    spent = sum(energy.get(key) or 0.0 for key in ("friction_J", "contact_damping_J", "material_damping_J"))
    loss = max(LOSS_SHARE_LIMIT * spent, LOSS_LIMIT * reference)
    return f"{told}; to lose {number(loss)} J or win {number(GAIN_LIMIT * reference, 2)} J would fail the run"
