"""A canvas as an SVG document: text stays text, and the same drawing gives the same bytes.

Sizes and distances are those of matplotlib with the settings of `fem.figures.style`, in points, with y downwards.
"""

from collections.abc import Iterator
from html import escape

import numpy as np

from fem.figures.canvas import LEGEND_FONT, POINTS, TEXT, Area, Canvas, Chart, Curve
from fem.figures.scale import FONT, Scale
from fem.runtime.arrays import FloatArray

FAMILY = "'DejaVu Sans', 'Bitstream Vera Sans', Verdana, Geneva, Arial, Helvetica, sans-serif"
GRID, FRAME = "#DDDDDD", "#6E6E6E"
TICK, GAP, SMALL_TICK = 0.8, 3.5, 2.0  #: width of a tick, distance to its label, length of a smaller one
ASCENT, DESCENT, MIDDLE = 0.76, 0.24, 0.38  #: of text, over its font
LABEL_BELOW = 13.0  #: from the tick labels along x to the label of the axis, baseline to baseline
LABEL_BESIDE = 4.0  #: from the tick labels along y to the label of the axis
LEADING = 1.2 * 0.97  #: of lines of text, over their font
LEGEND_LINE, HANDLE_GAP, COLUMN_GAP, LEGEND_PAD, BASE = (
    12.0,
    0.8,
    1.4,
    0.4,
    0.24,
)  #: the last four over the font
PATCH = 0.7  #: height of a patch in a legend, over its font
FLAT = 0.05  #: points of a curve nearer than that to the line through their neighbours are left out
#: advance widths of DejaVu Sans from the blank on [1/2048 of the font]; other signs count as wide as a digit
WIDTHS = (
    "651 821 942 1716 1303 1946 1597 563 799 799 1024 1716 651 739 651 690 1303 1303 1303 1303 "
    "1303 1303 1303 1303 1303 1303 690 690 1716 1716 1716 1087 2048 1401 1405 1430 1577 1294 1178 1587 "
    "1540 604 604 1343 1141 1767 1532 1612 1235 1612 1423 1300 1251 1499 1401 2025 1403 1251 1403 799 "
    "690 799 1716 1024 1024 1255 1300 1126 1300 1260 721 1300 1298 569 569 1186 569 1995 1298 1253 "
    "1300 1300 842 1067 803 1298 1212 1675 1212 1212 1075 1303 690 1303 1716"
)
ADVANCE = {chr(32 + k): int(width) for k, width in enumerate(WIDTHS.split())}
ADVANCE |= dict.fromkeys("±×−≤≥", 1716) | dict.fromkeys("⁰¹²³⁴⁵⁶⁷⁸⁹", 821) | {"⁻": 1081, "°": 1024, "·": 651}


def svg_document(canvas: Canvas) -> str:
    """The figure as an SVG document."""
    width, height = (POINTS * inches for inches in canvas.get_size_inches())
    parts = [
        '<?xml version="1.0" encoding="utf-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}pt" height="{height:g}pt" '
        f'viewBox="0 0 {width:g} {height:g}" version="1.1">\n'
        f'<path d="M0 0H{width:g}V{height:g}H0z" fill="#ffffff"/>\n'
        f'<g font-family="{FAMILY}" font-size="{FONT:g}" fill="{TEXT}" stroke-linejoin="round">\n'
    ]
    for number, panel in enumerate(canvas.axes, 1):
        parts += [f'<g id="panel_{number}">\n', *_panel(panel, width, height, f"clip_{number}"), "</g>\n"]
    for words in canvas.texts:
        for row, line in enumerate(words.text.split("\n")):
            y = (1.0 - words.y) * height + (ASCENT + row * LEADING) * words.size
            parts.append(_text(words.x * width, y, line, words.size, colour=words.colour))
    return "".join([*parts, "</g>\n</svg>\n"])


def text_width(text: str, size: float) -> float:
    """Width of a text in DejaVu Sans [point]."""
    return sum(ADVANCE.get(sign, 1303) for sign in text) * size / 2048.0


def _panel(panel: Chart, width: float, height: float, clip: str) -> Iterator[str]:
    frame = panel.get_position()
    left, right = frame.x0 * width, frame.x1 * width
    top, bottom = (1.0 - frame.y1) * height, (1.0 - frame.y0) * height
    if panel.framed:
        box = f"M{left:.2f} {top:.2f}H{right:.2f}V{bottom:.2f}H{left:.2f}z"
        yield f'<clipPath id="{clip}"><path d="{box}"/></clipPath>\n'
        yield from _axis_along(panel.xaxis, left, right, top, bottom)
        yield from _axis_upward(panel.yaxis, left, right, top, bottom)
    within = f' clip-path="url(#{clip})"' if panel.framed else ""

    def placed(x: FloatArray, y: FloatArray) -> FloatArray:
        across = left + (right - left) * panel.xaxis.share(x)
        upward = bottom - (bottom - top) * panel.yaxis.share(y)
        # lines across the panel have no end
        return np.column_stack([np.clip(across, -1e5, 1e5), np.clip(upward, -1e5, 1e5)])

    def ends(x: FloatArray, y: FloatArray) -> FloatArray:
        x = np.where(np.isinf(x), np.where(x > 0.0, *panel.get_xlim()[::-1]), x)
        y = np.where(np.isinf(y), np.where(y > 0.0, *panel.get_ylim()[::-1]), y)
        return placed(x, y)

    for area in panel.areas:
        outlines = "".join(_path(_bent(placed(*polygon.T))) + "z" for polygon in area.polygons)
        yield f'<path d="{outlines}"{within} {_filled(area)}/>\n'
    for curve in panel.lines:
        points = ends(curve.x, curve.y)
        inside = within if curve.clipped else ""
        if curve.dashes is not None and len(points) > 1:
            yield f'<path d="{_broken_path(points)}"{inside} {_stroke(curve)}/>\n'
        if curve.marker:
            yield _marks(curve, points[np.isfinite(points).all(axis=1)], inside)
    if panel.framed:
        yield (
            f'<path d="M{left:.2f} {top:.2f}V{bottom:.2f}H{right:.2f}" fill="none" stroke="{FRAME}" '
            f'stroke-width="0.8" stroke-linecap="square" stroke-linejoin="miter"/>\n'
        )
    if panel.title is not None:
        text, size, pad, side = panel.title
        x, anchor = (left, "start") if side == "left" else (0.5 * (left + right), "middle")
        yield _text(x, top - pad, text, size, anchor=anchor)
    if panel.legend_place is not None:
        yield from _legend(panel, left, right, top, bottom)


def _axis_along(axis: Scale, left: float, right: float, top: float, bottom: float) -> Iterator[str]:
    """Grid, ticks, their labels and the label of the axis along x."""
    ticks, smaller, power = axis.ticks()
    places = left + (right - left) * axis.share(np.array([place for place, _ in ticks]))
    if axis.grid:
        yield _rules([f"M{x:.2f} {bottom:.2f}V{top:.2f}" for x in places], GRID, 0.6)
    yield _rules([f"M{x:.2f} {bottom:.2f}v{axis.tick_length:g}" for x in places], TEXT, TICK)
    small = left + (right - left) * axis.share(smaller)
    yield _rules([f"M{x:.2f} {bottom:.2f}v{SMALL_TICK:g}" for x in small], TEXT, 0.6)
    base = bottom + axis.tick_length + GAP
    labelled = axis.labelled and any(label for _, label in ticks)
    if labelled:
        size = axis.label_size
        for x, (_, label) in zip(places, ticks, strict=True):
            yield _text(float(x), base + ASCENT * size, label, size, anchor="middle")
        base += size + LABEL_BELOW - ASCENT * FONT - (1.0 - ASCENT) * size
        if power:
            yield _text(right, base + LABEL_BELOW, power, FONT, anchor="end")
    if axis.label:
        yield _text(0.5 * (left + right), base + ASCENT * FONT, axis.label, FONT, anchor="middle")


def _axis_upward(axis: Scale, left: float, right: float, top: float, bottom: float) -> Iterator[str]:
    """The same along y."""
    ticks, _, power = axis.ticks()
    places = bottom - (bottom - top) * axis.share(np.array([place for place, _ in ticks]))
    if axis.grid:
        yield _rules([f"M{left:.2f} {y:.2f}H{right:.2f}" for y in places], GRID, 0.6)
    if axis.tick_length:
        yield _rules([f"M{left:.2f} {y:.2f}h{-axis.tick_length:g}" for y in places], TEXT, TICK)
    edge, size = left - axis.tick_length - GAP, axis.label_size
    if axis.labelled:
        for y, (_, label) in zip(places, ticks, strict=True):
            yield _text(edge, float(y) + MIDDLE * size, label, size, anchor="end")
        if power:
            yield _text(left, top - 4.0, power, FONT)
    if axis.label:
        widest = max((text_width(label, size) for _, label in ticks), default=0.0) if axis.labelled else 0.0
        place = edge - widest - LABEL_BESIDE
        if axis.label_at is not None:
            place = left + axis.label_at * (right - left)
        yield _text(
            place - DESCENT * FONT, 0.5 * (top + bottom), axis.label, FONT, anchor="middle", turned=True
        )


def _legend(panel: Chart, left: float, right: float, top: float, bottom: float) -> Iterator[str]:
    """The entries, column by column."""
    place, shown = panel.legend_place, panel.get_legend_handles_labels()[0]
    if place is None or not shown:
        return
    size = LEGEND_FONT
    columns = [list(part) for part in np.array_split(np.arange(len(shown)), min(place.columns, len(shown)))]
    x = left + place.anchor[0] * (right - left) + (place.pad + LEGEND_PAD) * size
    base = bottom - place.anchor[1] * (bottom - top) - (place.pad + LEGEND_PAD + BASE) * size
    highest = base - (max(map(len, columns)) - 1) * LEGEND_LINE
    for column in columns:
        widest = max(text_width(shown[k].label, size) for k in column)
        for row, k in enumerate(column):
            y, artist = highest + row * LEGEND_LINE, shown[k]
            yield from _handle(artist, x, y, place.handle * size)
            yield _text(x + (place.handle + HANDLE_GAP) * size, y, artist.label, size)
        x += (place.handle + HANDLE_GAP + COLUMN_GAP) * size + widest


def _handle(artist: Curve | Area, x: float, y: float, length: float) -> Iterator[str]:
    """The sample of a curve or an area in a legend; its text stands on y."""
    high = PATCH * LEGEND_FONT
    if isinstance(artist, Area):
        yield f'<path d="M{x:.2f} {y:.2f}h{length:.2f}v{-high:.2f}h{-length:.2f}z" {_filled(artist)}/>\n'
        return
    middle = y - 0.5 * high
    if artist.dashes is not None:
        yield f'<path d="M{x:.2f} {middle:.2f}h{length:.2f}" {_stroke(artist)}/>\n'
    if artist.marker:
        yield _marks(artist, np.array([[x + 0.5 * length, middle]]), "")


def _marks(curve: Curve, points: FloatArray, within: str) -> str:
    """The marks of a curve at points (n, 2)."""
    half = 0.5 * curve.marker_size
    shape = {
        "o": f"m{-half:g} 0a{half:g} {half:g} 0 1 0 {2 * half:g} 0a{half:g} {half:g} 0 1 0 {-2 * half:g} 0z",
        "s": f"m{-half:g} {-half:g}h{2 * half:g}v{2 * half:g}h{-2 * half:g}z",
        "^": f"m0 {-half:g}l{half:g} {2 * half:g}h{-2 * half:g}z",
        "v": f"m0 {half:g}l{half:g} {-2 * half:g}h{-2 * half:g}z",
        "x": f"m{-half:g} {-half:g}l{2 * half:g} {2 * half:g}m{-2 * half:g} 0l{2 * half:g} {-2 * half:g}",
        "|": f"m0 {-half:g}v{2 * half:g}",
    }[curve.marker]
    fill = "none" if curve.hollow or curve.marker in "x|" else curve.colour
    edge = f'stroke="{curve.marker_edge or curve.colour}" stroke-width="{curve.marker_edge_width:g}"'
    path = "".join(f"M{x:.2f} {y:.2f}{shape}" for x, y in points.tolist())
    return f'<path d="{path}"{within} fill="{fill}" {edge}/>\n'


def _stroke(curve: Curve) -> str:
    """Attributes of a line; dashes are as long as the line is wide."""
    text = f'fill="none" stroke="{curve.colour}" stroke-width="{curve.width:g}"'
    if curve.dashes:
        return text + f' stroke-dasharray="{",".join(f"{curve.width * dash:.6g}" for dash in curve.dashes)}"'
    return text + ' stroke-linecap="square"'


def _filled(area: Area) -> str:
    edge = f' stroke="{area.colour}" stroke-width="{area.edge_width:g}"' if area.edge_width else ""
    return f'fill="{area.colour}"{edge}'


def _rules(paths: list[str], colour: str, width: float) -> str:
    if not paths:
        return ""
    return f'<path d="{"".join(paths)}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>\n'


def _text(
    x: float,
    y: float,
    text: str,
    size: float,
    *,
    anchor: str = "start",
    colour: str = TEXT,
    turned: bool = False,
) -> str:
    place = f'transform="translate({x:.2f} {y:.2f}) rotate(-90)"' if turned else f'x="{x:.2f}" y="{y:.2f}"'
    looks = f' font-size="{size:g}"' if size != FONT else ""
    looks += f' text-anchor="{anchor}"' if anchor != "start" else ""
    looks += f' fill="{colour}"' if colour != TEXT else ""
    return f"<text {place}{looks}>{escape(text, quote=False)}</text>\n"


def _broken_path(points: FloatArray) -> str:
    """Through points (n, 2), interrupted where one is not a number."""
    known = np.isfinite(points).all(axis=1)
    if known.all():
        return _path(_bent(points))
    starts = np.flatnonzero(np.diff(np.concatenate([[False], known])) & known)
    ends = np.flatnonzero(np.diff(np.concatenate([known, [False]])) & known) + 1
    return "".join(_path(_bent(points[start:end])) for start, end in zip(starts, ends, strict=True))


def _bent(points: FloatArray) -> FloatArray:
    """Without points that lie on the line between their neighbours: every other one, several times."""
    while len(points) > 2:
        before, after = points[:-2:2], points[2::2]
        between = points[1:-1:2]
        along = after - before
        length = np.maximum(np.hypot(*along.T), 1e-9)
        aside = (
            np.abs(along[:, 0] * (between - before)[:, 1] - along[:, 1] * (between - before)[:, 0]) / length
        )
        inside = ((between - before) * along).sum(axis=1) / length
        needless = (aside < FLAT) & (inside > 0.0) & (inside < length)
        if np.count_nonzero(needless) < len(points) // 50 + 1:
            break
        kept = np.ones(len(points), dtype=bool)
        kept[1:-1:2] = ~needless
        points = points[kept]
    return points


def _path(points: FloatArray) -> str:
    """A path through points (n, 2)."""
    return ("M" + "%.2f %.2f " * len(points)) % tuple(points.ravel().tolist())
