"""Figure of the contact forces of the floor on the container.

The force of an impact on a rigid floor is far larger than those between impacts. It is cut off, marked at the edge of
the panel and given in words. A slab crushes before that.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.figures import style
from fem.html.units import rounded
from fem.results.reader import RunData
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
    if changing is None:
        axes[0].axhline(weight, color=style.BLACK, linestyle="--", linewidth=0.9, label=name)
    else:
        axes[0].plot(
            changing[0], weight * changing[1], color=style.BLACK, linestyle="--", linewidth=0.9, label=name
        )
    if cap is not None and style.NEAR_LIMIT * 1e-3 * cap < normal.max():
        label = f"a corner crushes at {rounded(1e-3 * cap)} kN"
        axes[0].axhline(1e-3 * cap, color=style.BLACK, linestyle=":", linewidth=0.9, label=label)
    axes[0].set_ylim(bottom=0.0)
    friction = {"static": (contact.mu_static, "--"), "kinetic": (contact.mu_kinetic, ":")}
    for name, (mu, dashes) in friction.items():
        label = f"{name} friction{' of the weight' if not times else ''}, ±{rounded(mu * weight)} kN{times}"
        style.draw_limits(
            axes[1], mu * weight, label, of_weight=changing, color=style.BLACK, linestyle=dashes
        )
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
