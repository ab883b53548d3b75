"""The sketch of the case: the container in elevation with its dimensions, its support and the floor's motion.

Drawn to scale; lengths in m, x to the right, z up.
"""

import math

from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Rectangle
from matplotlib.transforms import Affine2D

from fem.case.case import Case
from fem.figures.style import BLACK, BLUE, GREY, house_style, svg_of
from fem.html.page import svg_element
from fem.html.units import degrees, quantity, short

WIDTH = 4.3  #: of the drawing [inch]
WIDEST, TALLEST = 1.8, 2.6  #: of the container in it [inch]
ABOVE, BELOW = 0.3, 1.2  #: room above and below the container [inch]
BODY = "#E4EBF1"


def sketch(
    case: Case, *, centroid: float, peak_acceleration: float, peak_vertical: float | None = None
) -> Markup:
    """An `svg` element.

    Args:
        case: the case.
        centroid: height of the mass centre above the floor [m].
        peak_acceleration: largest |acceleration| of the floor in the run [m/s2].
        peak_vertical: .. up or down; None: it does not move so.
    """
    box = case.container
    width, height = box.width_m, box.total_height
    inch = max(height / TALLEST, width / WIDEST)  # so many metres
    with house_style():
        figure = Figure(figsize=(WIDTH, ABOVE + height / inch + BELOW))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(-0.5 * WIDTH * inch, 0.5 * WIDTH * inch), ylim=(-BELOW * inch, height + ABOVE * inch))
        axes.set_axis_off()
        unit = 0.04 * inch
        _draw_floor(axes, case, unit)
        _draw_container(axes, case)
        _draw_mass_centre(axes, 0.5 * width, centroid, unit)
        _dimension(axes, (-0.5 * width, -7 * unit), (0.5 * width, -7 * unit), f"a = {short(width)} m")
        left, right = -0.5 * width - 8 * unit, 0.5 * width + 22 * unit
        boxes = f"{box.boxes} × c = {box.boxes} × " if box.boxes > 1 else "c = "
        _dimension(axes, (left, 0.0), (left, height), f"{boxes}{short(box.height_m)} m")
        _dimension(axes, (right, 0.0), (right, centroid), f"$z_c$ = {short(centroid)} m")
        axes.plot((0.0, right + unit), (centroid, centroid), color=GREY, linewidth=0.5)
        if case.motion.kind != "none":
            axes.annotate(
                "", (-10 * unit, -15 * unit), (10 * unit, -15 * unit), arrowprops=_arrow("<|-|>", BLUE)
            )
        if peak_vertical is not None:
            place = 15 * unit
            axes.annotate("", (place, -19 * unit), (place, -11 * unit), arrowprops=_arrow("<|-|>", BLUE))
        words = _motion(case, peak_acceleration)
        if peak_vertical is not None:
            words = [*words, f"vertical: {case.vertical.kind}, peak {short(peak_vertical)} m/s²"]
        axes.text(0.0, -17 * unit, "\n".join(words), color=BLUE, ha="center", va="top")
    label = (
        f"Sketch: container {short(width)} m wide and {short(height)} m high, mass centre at {short(centroid)} m, "
        f"on {case.support.kind}"
    )
    return svg_element(svg_of(figure), label=label, prefix="sketch")


def _arrow(style: str, colour: str) -> dict[str, object]:
    return {"arrowstyle": style, "color": colour, "shrinkA": 0, "shrinkB": 0}


def _draw_floor(axes: Axes, case: Case, unit: float) -> None:
    """The floor, and where the base may touch it: thick marks."""
    reach, width = 0.45 * (axes.get_xlim()[1] - axes.get_xlim()[0]), case.container.width_m
    axes.add_patch(
        Rectangle((-reach, -2 * unit), 2 * reach, 2 * unit, hatch="////", fill=False, ec=GREY, lw=0)
    )
    axes.plot((-reach, reach), (0.0, 0.0), color=BLACK, linewidth=1.5)
    support = case.support
    foot = {"corners": unit, "feet": support.foot_m or 0.0}.get(support.kind, 0.5 * width)
    for side in (-1.0, 1.0):
        inner = side * (0.5 * width - foot)
        axes.plot(
            (side * 0.5 * width, inner), (0.0, 0.0), color=BLUE, linewidth=4, solid_capstyle="butt", zorder=5
        )


def _draw_container(axes: Axes, case: Case) -> None:
    """The boxes with their walls, and dashed the tilted container where it starts so."""
    box, rotation = case.container, case.initial.rotation_rad
    left, width, height = -0.5 * box.width_m, box.width_m, box.height_m
    for k in range(box.boxes):
        axes.add_patch(Rectangle((left, k * height), width, height, fc=BODY, ec=BLACK, lw=1.1))
        wall = box.wall_m if box.section == "shell" and box.wall_m else 0.0
        if wall:
            inside = (left + wall, k * height + wall), width - 2 * wall, height - 2 * wall
            axes.add_patch(Rectangle(*inside, fill=False, ec=GREY, lw=0.5))
    if rotation:
        pivot = math.copysign(0.5 * width, rotation)
        turn = Affine2D().rotate_around(pivot, 0.0, -rotation) + axes.transData
        outline = Rectangle(
            (left, 0.0), width, box.total_height, fill=False, ec=BLUE, ls="--", transform=turn
        )
        axes.add_patch(outline)
        place = pivot + math.sin(rotation) * box.total_height, 0.8 * box.total_height
        side = "left" if rotation > 0.0 else "right"
        axes.text(*place, f" θ = {degrees(rotation)} at t = 0 ", color=BLUE, ha=side)


def _draw_mass_centre(axes: Axes, half_width: float, centroid: float, unit: float) -> None:
    """Mass centre and weight, and the slenderness angle at the right corner."""
    angle = math.atan2(half_width, centroid)
    reach = min(0.7 * math.hypot(half_width, centroid), 28 * unit)
    top = max(centroid, reach) + 2 * unit
    for x, z in ((half_width, top), (0.0, centroid)):
        axes.plot((half_width, x), (0.0, z), color=BLUE, linestyle="--", linewidth=0.9)
    turn = 90.0, 90.0 + math.degrees(angle)
    axes.add_patch(Arc((half_width, 0.0), 2 * reach, 2 * reach, theta1=turn[0], theta2=turn[1], ec=BLUE))
    axes.text(half_width + unit, reach, f"α = {degrees(angle)}", color=BLUE)
    axes.annotate("", (0.0, centroid - 12 * unit), (0.0, centroid), arrowprops=_arrow("-|>", BLACK))
    axes.plot(0.0, centroid, "o", color=BLACK, markerfacecoloralt="white", fillstyle="left", markersize=8)
    axes.text(-1.5 * unit, centroid - 9 * unit, "G", ha="right")


def _dimension(axes: Axes, start: tuple[float, float], end: tuple[float, float], words: str) -> None:
    """A dimension line with its words above it, or left of it where it is upright."""
    upright = start[0] == end[0]
    axes.annotate("", start, end, arrowprops=_arrow("|-|, widthA=0.25, widthB=0.25", GREY))
    middle = 0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])
    axes.annotate(
        words, middle, (-3, 0) if upright else (0, 3), textcoords="offset points",
        ha="right" if upright else "center", va="center" if upright else "bottom", rotation=90 if upright else 0,
    )  # fmt: skip


def _motion(case: Case, peak: float) -> list[str]:
    """The floor's motion."""
    motion = case.motion
    match motion.kind:
        case "none":
            return ["floor at rest"]
        case "harmonic":
            phase = f" + {degrees(motion.phase_rad)}" if motion.phase_rad else ""
            amplitude, omega = quantity(motion.amplitude, "mm", 1e3), short(motion.angular_frequency, 1.0, 5)
            return [f"x = A sin(Ωt{phase})", f"A = {amplitude}, Ω = {omega} rad/s, peak {short(peak)} m/s²"]
        case "pulse":
            return [f"{motion.shape} pulse", f"{short(motion.pulse_s)} s long, peak {short(peak)} m/s²"]
    scale = f"scale {short(motion.scale)}, " if motion.scale_to_m_s2 is None else ""
    return [f"record {motion.file}", f"{scale}peak {short(peak)} m/s²"]
