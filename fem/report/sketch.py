"""The sketch of what was asked: the container in elevation with its dimensions, its support and the floor's motion.

Drawn to one scale, as SVG; lengths in m. x to the right, z up, as in the case.
"""

import math

from markupsafe import Markup, escape

from fem.case.case import Case
from fem.html.units import degrees, quantity, short

WIDTH = 430.0  #: of the drawing, in its own units
BODY_WIDTH, BODY_HEIGHT = 175.0, 250.0  #: room for the container
TOP = 30.0
INK, QUIET, ACCENT, STEEL = "#1c2330", "#55606f", "#0b5a8a", "#e4ebf1"


def sketch(case: Case, *, centroid: float, peak_acceleration: float) -> Markup:
    """An `svg` element.

    Args:
        case: what was asked.
        centroid: height of the mass centre above the floor [m].
        peak_acceleration: largest |acceleration| of the floor in the run [m/s2].
    """
    box = case.container
    scale = min(BODY_WIDTH / box.width_m, BODY_HEIGHT / box.total_height)
    width, height = scale * box.width_m, scale * box.total_height
    left, floor = 0.5 * (WIDTH - width), TOP + height
    right, middle = left + width, 0.5 * WIDTH
    centre = floor - scale * centroid
    parts = [
        *_floor(floor),
        *_tilted_outline(case, left, right, floor, width, height),
        *_body(case, left, floor, scale),
        *_support(case, left, floor, scale),
        *_angle(left + width, floor, middle, centre, case, centroid),
        *_mass_centre(middle, centre),
        *_dimension_below(left, right, floor + 30.0, f"a = {short(box.width_m)} m"),
        *_dimension_beside(left - 34.0, TOP, floor, _height_label(case), left),
        *_dimension_beside(right + 96.0, centre, floor, f"z_c = {short(centroid)} m", middle, after=True),
        *_motion(case, middle, floor + 58.0, peak_acceleration),
    ]
    label = (
        f"Sketch: container {short(box.width_m)} m wide and {short(box.total_height)} m high, mass centre at "
        f"{short(centroid)} m, on {case.support.kind}"
    )
    return Markup(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w:g} {h:g}" role="img" aria-label="{label}" '
        'font-family="system-ui, sans-serif" font-size="12.5" fill="{ink}">{parts}</svg>'
    ).format(w=WIDTH, h=floor + 98.0, label=label, ink=INK, parts=Markup("").join(parts))


def _line(x1: float, y1: float, x2: float, y2: float, colour: str = INK, extra: str = "") -> Markup:
    return Markup('<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}" {}/>').format(
        x1, y1, x2, y2, colour, Markup(extra)
    )


def _text(
    x: float, y: float, words: str, anchor: str = "middle", colour: str = INK, turn: bool = False
) -> Markup:
    """Words; `z_c` and the like get their index set lower."""
    shown = escape(words)
    for letter, index in (("z", "c"), ("μ", "s"), ("μ", "k")):
        shown = Markup(
            str(shown).replace(
                f"{letter}_{index}",
                f'{letter}<tspan dy="3" font-size="9">{index}</tspan><tspan dy="-3">\u200b</tspan>',
            )
        )
    place = Markup(' transform="rotate(-90 {:.1f} {:.1f})"').format(x, y) if turn else ""
    return Markup('<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}"{}>{}</text>').format(
        x, y, anchor, colour, place, shown
    )


def _floor(floor: float) -> list[Markup]:
    lines = [_line(40.0, floor, WIDTH - 40.0, floor, INK, 'stroke-width="2"')]
    return lines + [_line(x, floor, x - 8.0, floor + 8.0, QUIET) for x in range(56, int(WIDTH) - 36, 12)]


def _body(case: Case, left: float, floor: float, scale: float) -> list[Markup]:
    box = case.container
    width, height = scale * box.width_m, scale * box.height_m
    wall = max(scale * (box.wall_m or 0.0), 1.8) if box.section == "shell" else 0.0
    parts = []
    for k in range(box.boxes):
        top = floor - (k + 1) * height
        parts.append(
            Markup(
                '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}" stroke="{}" stroke-width="1.4"/>'
            ).format(left, top, width, height, STEEL, INK)
        )
        if wall:
            parts.append(
                Markup(
                    '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" '
                    'fill="none" stroke="{}" stroke-width=".6"/>'
                ).format(left + wall, top + wall, width - 2.0 * wall, height - 2.0 * wall, QUIET)
            )
    return parts


def _support(case: Case, left: float, floor: float, scale: float) -> list[Markup]:
    """Where the base may touch: thick marks."""
    width = scale * case.container.width_m
    match case.support.kind:
        case "corners":
            spans = [(left - 3.0, left + 3.0), (left + width - 3.0, left + width + 3.0)]
        case "feet":
            foot = scale * case.support.foot_m
            spans = [(left, left + foot), (left + width - foot, left + width)]
        case _:
            spans = [(left, left + width)]
    return [_line(a, floor, b, floor, ACCENT, 'stroke-width="5"') for a, b in spans]


def _tilted_outline(
    case: Case, left: float, right: float, floor: float, width: float, height: float
) -> list[Markup]:
    """Where a container starts that starts tilted: about its corner, dashed."""
    rotation = case.initial.rotation_rad
    if rotation == 0.0:
        return []
    pivot = right if rotation > 0.0 else left
    side = 1.0 if rotation > 0.0 else -1.0
    return [
        _text(
            pivot + side * (height * math.sin(abs(rotation)) + 8.0),
            floor - 0.8 * height,
            f"θ = {degrees(rotation)} at t = 0",
            "start" if rotation > 0.0 else "end",
            ACCENT,
        ),
        Markup(
            '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="{}" '
            'stroke-dasharray="4 3" transform="rotate({:.2f} {:.1f} {:.1f})"/>'
        ).format(left, floor - height, width, height, ACCENT, math.degrees(rotation), pivot, floor),
    ]


def _angle(
    corner: float, floor: float, middle: float, centre: float, case: Case, centroid: float
) -> list[Markup]:
    """The slenderness angle at the right corner, between the vertical and the line to the mass centre."""
    angle = math.atan2(0.5 * case.container.width_m, centroid)
    reach = min(0.7 * math.hypot(corner - middle, floor - centre), 120.0)
    x, y = corner - reach * math.sin(angle), floor - reach * math.cos(angle)
    return [
        _line(corner, floor, corner, min(centre, floor - reach) - 8.0, ACCENT, 'stroke-dasharray="5 3"'),
        _line(corner, floor, middle, centre, ACCENT, 'stroke-dasharray="5 3"'),
        Markup(
            '<path d="M{:.1f} {:.1f} A{:.1f} {:.1f} 0 0 0 {:.1f} {:.1f}" fill="none" stroke="{}"/>'
        ).format(corner, floor - reach, reach, reach, x, y, ACCENT),
        _text(corner + 5.0, floor - reach - 4.0, f"α = {degrees(angle)}", "start", ACCENT),
    ]


def _mass_centre(x: float, y: float) -> list[Markup]:
    return [
        Markup('<circle cx="{0:.1f}" cy="{1:.1f}" r="5" fill="#fff" stroke="{2}"/>').format(x, y, INK),
        Markup('<path d="M{0:.1f} {1:.1f}v-5a5 5 0 0 1 5 5zM{0:.1f} {1:.1f}v5a5 5 0 0 1 -5 -5z"/>').format(
            x, y
        ),
        _line(x, y + 6.0, x, y + 40.0, INK, 'stroke-width="1.6"'),
        Markup('<path d="M{0:.1f} {1:.1f}l-4 -9h8z"/>').format(x, y + 47.0),
        _text(x - 7.0, y + 36.0, "G", "end"),
    ]


def _dimension_below(left: float, right: float, y: float, words: str) -> list[Markup]:
    return [
        _line(left, y - 20.0, left, y + 4.0, QUIET, 'stroke-width=".7"'),
        _line(right, y - 20.0, right, y + 4.0, QUIET, 'stroke-width=".7"'),
        _line(left, y, right, y, QUIET),
        _line(left - 4.0, y + 4.0, left + 4.0, y - 4.0),
        _line(right - 4.0, y + 4.0, right + 4.0, y - 4.0),
        _text(0.5 * (left + right), y - 4.0, words),
    ]


def _dimension_beside(
    x: float, top: float, bottom: float, words: str, from_x: float, *, after: bool = False
) -> list[Markup]:
    reach = -5.0 if after else 5.0
    return [
        _line(x - reach, top, from_x + reach, top, QUIET, 'stroke-width=".7"'),
        _line(x, top, x, bottom, QUIET),
        _line(x - 4.0, top + 4.0, x + 4.0, top - 4.0),
        _line(x - 4.0, bottom + 4.0, x + 4.0, bottom - 4.0),
        _text(x + (14.0 if after else -6.0), 0.5 * (top + bottom), words, turn=True),
    ]


def _height_label(case: Case) -> str:
    box = case.container
    if box.boxes == 1:
        return f"c = {short(box.height_m)} m"
    return f"{box.boxes} × c = {box.boxes} × {short(box.height_m)} m"


def _motion(case: Case, middle: float, y: float, peak: float) -> list[Markup]:
    """The floor's motion below the floor."""
    motion = case.motion
    match motion.kind:
        case "none":
            return [_text(middle, y + 14.0, "floor at rest")]
        case "harmonic":
            first = f"x = A sin(Ωt{f' + {degrees(motion.phase_rad)}' if motion.phase_rad else ''})"
            second = f"A = {quantity(motion.amplitude, 'mm', 1e3)}, Ω = {short(motion.angular_frequency, 1.0, 5)} rad/s"
        case "pulse":
            first, second = f"{motion.shape} pulse", f"{short(motion.pulse_s)} s long"
        case _:
            first, second = f"record {motion.file}", f"scale {short(motion.scale)}"
    arrow = Markup(
        '<path d="M{0:.1f} {1:.1f}h90M{0:.1f} {1:.1f}l9 -5v10zm90 0l-9 -5v10z" '
        'stroke="{2}" fill="{2}" stroke-width="1.6"/>'
    )
    return [
        arrow.format(middle - 45.0, y - 4.0, ACCENT),
        _text(middle, y + 15.0, first, colour=ACCENT),
        _text(middle, y + 32.0, f"{second}, peak {short(peak)} m/s²", colour=ACCENT),
    ]
