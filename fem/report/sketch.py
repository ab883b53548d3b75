"""The sketch of the case: the container in elevation with its dimensions, its support and the floor's motion.

Drawn to scale; lengths in m, x to the right, z up. A floor that slopes is drawn level, as the frame of the results
lies on it: the weight is then oblique, and the floor says how it falls.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, assert_never

from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Rectangle
from matplotlib.transforms import Affine2D

from fem.case.case import Case
from fem.case.tables.boxes import Box, centre_above, shared_face
from fem.case.tables.neighbours import places_of
from fem.figures.style import BLACK, BLUE, GREY, house_style, svg_of
from fem.html.page import svg_element
from fem.html.units import degrees, quantity, short
from fem.run.drawn_links import drawn_links

WIDTH = 4.3  #: of the drawing [inch]
WIDEST, TALLEST = 1.8, 2.6  #: of the container in it [inch]
ABOVE, BELOW = 0.3, 1.2  #: room above and below the container [inch]
BODY = "#E4EBF1"
#: the look of where it may touch
TOUCHES: dict[str, Any] = {"color": BLUE, "linewidth": 4, "solid_capstyle": "butt", "zorder": 5}
MOST_HEIGHTS = 4  #: of boxes that differ, in one dimension


def sketch(
    case: Case, *, centroid: float, peak_acceleration: float, peak_vertical: float | None = None
) -> Markup:
    """An `svg` element.

    Args:
        case: the case.
        centroid: height of the mass centre above the floor [m].
        peak_acceleration: largest |acceleration| of the floor in the run [m/s2].
        peak_vertical: the largest vertical one [m/s2]; None: no vertical motion.
    """
    boxes, width = case.stack, case.stack[0].width
    low, high = min(box.sides[0] for box in boxes), max(box.sides[1] for box in boxes)
    height = boxes[-1].top
    inch = max(height / TALLEST, 2.0 * max(-low, high) / WIDEST)  # so many metres
    with house_style():
        figure = Figure(figsize=(WIDTH, ABOVE + height / inch + BELOW))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(-0.5 * WIDTH * inch, 0.5 * WIDTH * inch), ylim=(-BELOW * inch, height + ABOVE * inch))
        axes.set_axis_off()
        unit = 0.04 * inch
        _draw_floor(axes, case, unit)
        _draw_container(axes, case, unit)
        ends = _draw_beside(axes, case, unit)
        middle = centre_above(boxes, 0)
        _draw_mass_centre(axes, 0.5 * width, middle, centroid, unit, slope=case.floor.slope)
        _dimension(axes, (-0.5 * width, -7 * unit), (0.5 * width, -7 * unit), f"a = {short(width)} m")
        most = 0.4 * WIDTH * inch
        left = min(low - 8 * unit, max(-most, ends[0] - 4 * unit))
        right = max(high + 22 * unit, min(most, ends[1] + 4 * unit))
        _dimension(axes, (left, 0.0), (left, height), _height(boxes))
        _dimension(axes, (right, 0.0), (right, centroid), f"$z_c$ = {short(centroid)} m", beyond=True)
        axes.plot((middle, right + unit), (centroid, centroid), color=GREY, linewidth=0.5)
        if case.motion.kind != "none":
            ends_of_arrow = (-10 * unit, -15 * unit), (10 * unit, -15 * unit)
            axes.annotate("", *ends_of_arrow, arrowprops=_arrow("<|-|>", BLUE))
        words = _motion(case, peak_acceleration)
        if peak_vertical is not None:
            x = 15 * unit
            axes.annotate("", (x, -19 * unit), (x, -11 * unit), arrowprops=_arrow("<|-|>", BLUE))
            words = [*words, f"vertical: {case.vertical.kind}, peak {short(peak_vertical)} m/s²"]
        axes.text(0.0, -17 * unit, "\n".join(words), color=BLUE, ha="center", va="top")
    stack = f" of {len(boxes)} {case.container.joints} boxes" if len(boxes) > 1 else ""
    label = (
        f"Sketch: container{stack}, {short(high - low)} m wide and {short(height)} m high, mass centre at "
        f"{short(centroid)} m, on {case.support.kind}"
    )
    held = ((len(case.stop), "stop"), (len(case.tie), "tie"), (len(case.neighbour), "neighbour"))
    label += "".join(f", {count} {name}{'s' * (count > 1)}" for count, name in held if count)
    return svg_element(svg_of(figure), label=label, prefix="sketch")


def _arrow(style: str, colour: str) -> dict[str, object]:
    return {"arrowstyle": style, "color": colour, "shrinkA": 0, "shrinkB": 0}


def _draw_floor(axes: Axes, case: Case, unit: float) -> None:
    """The floor, and where the base may touch it: thick marks."""
    reach, width = 0.45 * (axes.get_xlim()[1] - axes.get_xlim()[0]), case.stack[0].width
    axes.add_patch(
        Rectangle((-reach, -2 * unit), 2 * reach, 2 * unit, hatch="////", fill=False, ec=GREY, lw=0)
    )
    axes.plot((-reach, reach), (0.0, 0.0), color=BLACK, linewidth=1.5)
    if slope := case.floor.slope_percent:
        side = math.copysign(1.0, slope)
        words = f"falls {short(abs(slope))} % →" if slope > 0.0 else f"← falls {short(abs(slope))} %"
        position = side * reach, -2.5 * unit
        axes.text(*position, words, color=BLUE, ha="right" if slope > 0.0 else "left", va="top")
    foot = case.foot or (unit if case.support.kind == "corners" else 0.5 * width)
    outer = 0.5 * width - case.support.inset
    for side in (-1.0, 1.0):
        axes.plot((side * outer, side * (outer - foot)), (0.0, 0.0), **TOUCHES)


def _height(boxes: Sequence[Box]) -> str:
    """Height of the stack: a multiple of equal heights, or the sum of different ones."""
    heights = {box.height for box in boxes}
    if len(boxes) == 1:
        return f"c = {short(boxes[0].height)} m"
    if len(heights) == 1:
        return f"{len(boxes)} × c = {len(boxes)} × {short(boxes[0].height)} m"
    if len(boxes) <= MOST_HEIGHTS:
        return f"{' + '.join(short(box.height) for box in boxes)} = {short(boxes[-1].top)} m"
    return f"{len(boxes)} boxes, {short(boxes[-1].top)} m"


def _draw_container(axes: Axes, case: Case, unit: float) -> None:
    """The boxes with their walls, marks at loose joints, and dashed the tilted container where it starts so."""
    boxes, rotation = case.stack, case.initial.rotation_rad
    pivot = math.copysign(0.5 * boxes[0].width, rotation)
    turn = Affine2D().rotate_around(pivot, 0.0, -rotation) + axes.transData
    for box in boxes:
        left, _ = box.sides
        axes.add_patch(Rectangle((left, box.bottom), box.width, box.height, fc=BODY, ec=BLACK, lw=1.1))
        if wall := box.wall or 0.0:
            inside = (left + wall, box.bottom + wall), box.width - 2 * wall, box.height - 2 * wall
            axes.add_patch(Rectangle(*inside, fill=False, ec=GREY, lw=0.5))
    outlines = boxes if case.container.box else (replace(boxes[0], height=boxes[-1].top),)
    for box in outlines if rotation else ():
        corner = box.sides[0], box.bottom
        outline = Rectangle(corner, box.width, box.height, fill=False, ec=BLUE, ls="--")
        outline.set_transform(turn)
        axes.add_patch(outline)
    if rotation:
        height = boxes[-1].top
        side = "left" if rotation > 0.0 else "right"
        position = pivot + math.sin(rotation) * height, 0.8 * height
        axes.text(*position, f" θ = {degrees(rotation)} at t = 0 ", color=BLUE, ha=side)
    if case.container.is_loose:
        _draw_loose_joints(axes, case, unit)
    if case.container.is_loose or case.container.box is not None:
        for number, box in enumerate(boxes, 1):
            position = box.sides[0] + unit, box.bottom + 0.5 * box.height
            axes.text(*position, str(number), color=GREY, fontsize=8.0, ha="left", va="center")


def _draw_beside(axes: Axes, case: Case, unit: float) -> tuple[float, float]:
    """Neighbours, stops and ties, as far as the figure is wide; left and right end of all that stands there [m]."""
    ends = [box.sides for box in case.stack]
    row = case.row
    positions = places_of(case, [container.stack[0].width for container in row])
    for neighbour, x in zip(row[1:], positions.x[1:], strict=True):
        width, height = neighbour.stack[0].width, neighbour.stack[-1].top
        left = x - 0.5 * width
        axes.add_patch(Rectangle((left, 0.0), width, height, fc=BODY, ec=GREY, lw=0.8, clip_on=True))
        ends.append((left, left + width))
    for link in drawn_links(case):
        x, outer, height = link.x, link.x, max(link.height, unit)
        if link.anchor is not None:
            outer = link.outer
            axes.plot((x, outer), (height, link.anchor), color=BLUE, linewidth=1.2, linestyle=":", zorder=6)
            axes.plot(x, height, color=BLUE, marker="o", markersize=3, linestyle="", zorder=6)
        else:
            outer = x + math.copysign(2 * unit, link.outer - x)
            wall = Rectangle((min(x, outer), 0.0), 2 * unit, height, hatch="////", fill=False, ec=GREY, lw=0)
            axes.add_patch(wall)
            axes.plot((x, x), (0.0, height), color=BLACK, linewidth=1.5)
        ends.append((min(x, outer), max(x, outer)))
    return min(end[0] for end in ends), max(end[1] for end in ends)


def _draw_loose_joints(axes: Axes, case: Case, unit: float) -> None:
    """Marks where a box may touch the next, as on the floor, and the friction between them."""
    for below, box in pairwise(case.stack):
        for end, inward in zip(shared_face(below, box), (unit, -unit), strict=True):
            axes.plot((end, end + inward), (box.bottom, box.bottom), **TOUCHES)
    static, kinetic = (case.joint_friction[name] for name in ("mu_static", "mu_kinetic"))
    words = f"loose, μ {short(static)}" + (f" / {short(kinetic)}" if kinetic != static else "")
    top = case.stack[-1]
    position = max(box.sides[1] for box in case.stack[-2:]) + unit, top.bottom + 0.5 * unit
    axes.text(*position, words, color=BLUE, va="bottom")


def _draw_mass_centre(
    axes: Axes, half_width: float, middle: float, centroid: float, unit: float, *, slope: float
) -> None:
    """Mass centre and weight, and the slenderness angle at the nearer corner; the drawing stands on the slope."""
    side = math.copysign(1.0, middle)
    corner, arm = side * half_width, half_width - abs(middle)
    angle = math.atan2(arm, centroid)
    reach = min(0.7 * math.hypot(arm, centroid), 28 * unit)
    top = max(centroid, reach) + 2 * unit
    for x, z in ((corner, top), (middle, centroid)):
        axes.plot((corner, x), (0.0, z), color=BLUE, linestyle="--", linewidth=0.9)
    from_x, to_x = sorted((90.0, 90.0 + side * math.degrees(angle)))
    axes.add_patch(Arc((corner, 0.0), 2 * reach, 2 * reach, theta1=from_x, theta2=to_x, ec=BLUE))
    name = f"α = {degrees(angle)}"
    axes.text(corner + side * unit, reach, name, color=BLUE, ha="left" if side > 0.0 else "right")
    downward = middle + 12 * unit * math.sin(slope), centroid - 12 * unit * math.cos(slope)
    axes.annotate("", downward, (middle, centroid), arrowprops=_arrow("-|>", BLACK))
    axes.plot(middle, centroid, "o", color=BLACK, markerfacecoloralt="white", fillstyle="left", markersize=8)
    axes.text(middle - 1.5 * unit, centroid - 9 * unit, "G", ha="right")


def _dimension(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], words: str, *, beyond: bool = False
) -> None:
    """A dimension line with its words above it, or left of it (`beyond`: right) where it is upright."""
    upright = start[0] == end[0]
    axes.annotate("", start, end, arrowprops=_arrow("|-|, widthA=0.25, widthB=0.25", GREY))
    middle = 0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])
    axes.annotate(
        words, middle, (3 if beyond else -3, 0) if upright else (0, 3), textcoords="offset points",
        ha=("left" if beyond else "right") if upright else "center", va="center" if upright else "bottom",
        rotation=90 if upright else 0,
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
        case "table":
            scale = f"scale {short(motion.scale)}, " if motion.scale_to_m_s2 is None else ""
            return [f"record {motion.file}", f"{scale}peak {short(peak)} m/s²"]
    assert_never(motion.kind)
