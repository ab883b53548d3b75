"""Figures of the contact forces of the floor on the container, and of the energy over time.

The force of an impact on a rigid floor is far larger than those between impacts. It is cut off, marked at the edge of
the panel and given in words. A slab crushes before that. Energy is stored, supplied by the floor and dissipated, lost
or gained by the time stepping.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact.stepping.ledger import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT
from fem.figures import style
from fem.html.units import rounded
from fem.results.history import History
from fem.results.reader import RunData
from fem.results.run_result import Energy, StaticResult, to_overturn
from fem.runtime.arrays import FloatArray

LARGE_FORCE = 2.5  #: times weight, or its static friction: larger forces are those of impacts
OFF_SCALE = 1.3  #: over the limit of the scale: larger forces are cut off
MARKS = 300  #: of cut-off forces, that fit side by side


def forces_figure(run: RunData) -> Figure:
    """Normal and shear force of the floor on the container."""
    history, contact = run.history, run.case.contact
    time, normal, shear = history["time_s"], 1e-3 * history["normal_force_N"], 1e-3 * history["shear_force_N"]
    weight = 1e-3 * run.case.weight
    cap = run.typed_result.floor.corner_cap_N if run.typed_result.floor else None
    limits = [
        scale_without_impacts(force, LARGE_FORCE * large) if cap is None else None
        for force, large in ((normal, weight), (shear, contact.mu_static * weight))
    ]
    cut = any(limit is not None for limit in limits)
    figure, axes = style.time_panels(
        (1.5, 1.7), history=history, gaps=(style.LEGEND_GAP,), header=3 if cut else 2
    )
    for panel, force, label, colour in (
        (axes[0], normal, "normal force [kN]", style.BLUE),
        (axes[1], shear, "shear force [kN]", style.VERMILLION),
    ):
        style.curve_panel(panel, label, time, (force, colour, "-", None), zero=False, linewidth=0.8)
    changing = style.changing_weight(history, run.case.gravity_m_s2)
    times = " times (g + a_v)/g" if changing is not None else ""
    name = f"weight, {rounded(weight, 4)} kN{times}"
    style.draw_limits(axes[0], (weight,), name, "--", of_weight=changing)
    if cap is not None and style.NEAR_LIMIT * 1e-3 * cap < normal.max():
        style.draw_limits(axes[0], (1e-3 * cap,), f"a corner crushes at {rounded(1e-3 * cap)} kN", ":")
    axes[0].set_ylim(bottom=0.0)
    friction = {"static": (contact.mu_static, "--"), "kinetic": (contact.mu_kinetic, ":")}
    for name, (mu, dashes) in friction.items():
        label = f"{name} friction{' of the weight' if not times else ''}, ±{rounded(mu * weight)} kN{times}"
        style.draw_limits(axes[1], (mu * weight, -mu * weight), label, dashes, of_weight=changing)
        if contact.mu_static == contact.mu_kinetic:
            break
    for panel, force, limit in zip(axes, (normal, shear), limits, strict=True):
        if limit is not None:
            cut_off(panel, time, force, limit)
        style.legend_above(panel)
    statement = (
        f"marks at the rim: beyond the scale, up to {rounded(normal.max(), 4)} and "
        f"{rounded(np.abs(shear).max(), 4)} kN, when the contact's damper stops an impact"
    )
    style.head(figure, "Forces of the floor on the container", statement if cut else "", status=run.status)
    return figure


def scale_without_impacts(force: FloatArray, large: float) -> float | None:
    """Limit of the scale of a force if impacts far exceed the forces between them; else None."""
    limit = max(large, 1.2 * float(np.quantile(np.abs(force), 0.9)))
    return limit if np.abs(force).max() > OFF_SCALE * limit else None


def cut_off(axes: Axes, time: FloatArray, force: FloatArray, limit: float) -> None:
    """End the scale at a limit, with a mark at the edge for each force beyond it."""
    axes.set_ylim(0.0 if axes.get_ylim()[0] == 0.0 else -limit, limit)
    for sign, marker in ((1.0, "^"), (-1.0, "v")):
        beyond = time[sign * force > limit]
        # Marks closer than that would overlap.
        _, apart = np.unique(np.round(beyond / (time[-1] - time[0]) * MARKS), return_index=True)
        rim = np.full(len(apart), sign * limit)
        axes.plot(beyond[apart], rim, marker, color=style.GREY, markersize=3, clip_on=False)


#: columns of a floor that crushes, and of a restitution that was asked for: words, colour, line
SOMETIMES = {
    "crushing_J": ("crushing of the floor", style.PURPLE, "-"),
    "impact_J": ("restitution asked of the impacts", style.BLACK, ":"),
}
DISSIPATED = ("friction_J", "contact_damping_J", "material_damping_J")  #: columns of a history
SMALL = 1e3  #: largest energy below which J is the unit, not kJ [J]
DECIMALS = 3  #: of an energy in a legend


def energy_figure(run: RunData) -> Figure:
    """Energy stored; supplied and dissipated since the start; imbalance of the time stepping."""
    history, energy = run.history, run.typed_result.energy or Energy()
    figure, axes = style.time_panels((1.7, 1.9, 0.9), gaps=(style.LEGEND_GAP + style.LINE, style.LEGEND_GAP))
    largest = max(
        float(np.abs(history[name]).max())
        for name in ("kinetic_J", "strain_J", "base_work_J", "imbalance_J", *DISSIPATED)
    )
    unit = ("kJ", 1e3) if largest >= SMALL else ("J", 1.0)
    _draw_stored(axes[0], run, energy.reference_J, *unit)
    _draw_supplied(axes[1], history, *unit)
    imbalance = (history["imbalance_J"], style.PURPLE, "-", _imbalance_limits(energy))
    style.curve_panel(axes[2], "imbalance [J]", history["time_s"], imbalance)
    style.legend_above(axes[0])
    style.legend_above(axes[1], columns=3)
    style.legend_above(axes[2])
    closure = energy.closure_error
    whose = to_overturn(bool(run.case.neighbour))
    share = "" if closure is None else f": largest imbalance {rounded(closure, 2)} of the energy {whose}"
    style.head(figure, f"Energy{share}", status=run.status)
    return figure


def _draw_stored(axes: Axes, run: RunData, reference: float | None, unit: str, size: float) -> None:
    """Kinetic, gravitational and strain energy, and the energy to overturn [J]; drawn in units of `size` [J]."""
    history = run.history
    # From the mass centre of the standing container: the work that its weight can still do; of a row from the start.
    static, row = run.typed_result.static or StaticResult(), bool(run.case.neighbour)
    standing = history["potential_J"][0] if row else run.case.weight * (static.centroid_m or 0.0)
    raised = history["potential_J"] - standing
    style.curve_panel(
        axes,
        f"stored [{unit}]",
        history["time_s"],
        (history["kinetic_J"] / size, style.BLUE, "-", "kinetic"),
        (raised / size, style.VERMILLION, "--", "gravity"),
        (history["strain_J"] / size, style.GREEN, ":", "strain"),
        zero=False,
    )
    if reference and not row and raised.max() > style.NEAR_LIMIT * reference:
        style.draw_limits(axes, (reference / size,), f"to overturn, {rounded(reference / size)} {unit}", "-.")


def _draw_supplied(axes: Axes, history: History, unit: str, size: float) -> None:
    """Energies since the start; the rest of the floor's work is stored, also in the springs of the contact."""
    others = [name for name in SOMETIMES if name in history]
    stored = history["base_work_J"] - sum(history[name] for name in (*DISSIPATED, *others, "imbalance_J"))
    curves = []
    for values, name, colour, line in (
        (history["base_work_J"], "work of the floor", style.BLUE, "-"),
        (stored, "stored", style.GREY, "-"),
        (history["friction_J"], "friction", style.VERMILLION, "--"),
        (history["contact_damping_J"], "contact damping", style.GREEN, "-."),
        (history["material_damping_J"], "material damping", style.ORANGE, ":"),
        *((history[name], *SOMETIMES[name]) for name in others),
    ):
        end = round(float(values[-1]) / size, DECIMALS) + 0.0  # no minus zero
        curves.append((values / size, colour, line, f"{name}, {rounded(end)} {unit}"))
    style.curve_panel(axes, f"since the start [{unit}]", history["time_s"], *curves)


def _imbalance_limits(energy: Energy) -> str:
    """Meaning of the imbalance, and the values that would fail the run."""
    text, reference = "lost (> 0) or gained by the time stepping", energy.reference_J
    if not reference:
        return text
    dissipated = sum(getattr(energy, key) or 0.0 for key in (*DISSIPATED, "crushing_J"))
    loss = max(LOSS_SHARE_LIMIT * dissipated, LOSS_LIMIT * reference)
    gain = rounded(GAIN_LIMIT * reference, 2)
    return f"{text}; a loss of {rounded(loss)} J or a gain of {gain} J fails the run"
