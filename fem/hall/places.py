"""The containers of a hall where they stand: a picture in plan, coloured by margin, and GeoJSON."""

import json
import math
from collections.abc import Mapping
from typing import Any

from fem.figures import style
from fem.hall.result import RESULT_COLUMNS, HallResult
from fem.results.outcome import Outcome

PICTURE = "figures/hall.svg"
EARTH_RADIUS_M = 6.371e6
MOST_NAMED = 8  #: of the weakest, in the picture
#: classes from the weakest, what they are called, colour and mark; margins up to the number, above the one before
OVERTURNED, INVALID, NONE = "overturned", "corner destroyed, not valid", "no outcome"
FALLEN = {None: NONE, Outcome.OVERTURNED: OVERTURNED, Outcome.INVALID: INVALID}  #: by outcome
UNKNOWN, BEYOND = "stood, margin not sought", "stood, margin above 3"
MARGINS = ((1.5, style.VERMILLION, "s"), (2.0, style.ORANGE, "s"), (3.0, style.SKY, "o"))
LOOKS = {
    OVERTURNED: (style.BLACK, "s"),
    INVALID: (style.BLACK, "D"),
    NONE: (style.BLACK, "x"),
    **{f"stood, margin up to {limit:g}": (colour, mark) for limit, colour, mark in MARGINS},
    BEYOND: (style.BLUE, "o"),
    UNKNOWN: ("#BBBBBB", "o"),
}


def plan_of(result: HallResult) -> list[tuple[float, float, Mapping[str, Any]]]:
    """The rows that have a place: east or x, north or y [m], and the row; places on the globe from their middle."""
    if placed := [(*row["place_m"], row) for row in result.table if row["place_m"]]:
        return placed
    located = [(*row["lon_lat"], row) for row in result.table if row["lon_lat"]]
    middle = [sum(point[k] for point in located) / max(len(located), 1) for k in (0, 1)]
    a_degree = math.radians(1.0) * EARTH_RADIUS_M
    shrink = math.cos(math.radians(middle[1]))
    return [
        (a_degree * shrink * (lon - middle[0]), a_degree * (lat - middle[1]), row)
        for lon, lat, row in located
    ]


def class_of(row: Mapping[str, Any]) -> str:
    """The class of a row in the picture."""
    margin = row["margin"] or row["margin_tried_to"]
    if row["outcome"] in FALLEN or margin is None:
        return FALLEN.get(row["outcome"], UNKNOWN)
    return next((f"stood, margin up to {limit:g}" for limit, *_ in MARGINS if margin <= limit), BEYOND)


def draw_places(result: HallResult) -> str:
    """The plan as SVG; empty where no row has a place."""
    placed = plan_of(result)
    if not placed:
        return ""
    classes = [class_of(row) for _, _, row in placed]
    size = max(3.0, min(9.0, 90.0 / math.sqrt(len(placed))))
    with style.house_style():
        present = [name for name in LOOKS if name in classes]
        figure, (axes,) = style.panels([4.0], header=1 + (len(present) + 2) // 3, below=0.5)
        axes.margins(0.12)
        for name in reversed(present):  # the weakest on top
            at = [(x, y) for (x, y, _), own in zip(placed, classes, strict=True) if own == name]
            colour, mark = LOOKS[name]
            axes.plot(*zip(*at, strict=True), mark, color=colour, markersize=size)
        for name in present:
            axes.plot([], [], LOOKS[name][1], color=LOOKS[name][0], markersize=6.0, label=name)
        weakest = sorted((row["rank"], x, y, row["name"]) for x, y, row in placed if row["rank"])[:MOST_NAMED]
        for _, x, y, name in weakest:
            offset, over = (0.0, 0.5 * size + 2.0), "offset points"
            axes.annotate(
                name[:30], (x, y), offset, textcoords=over, ha="center", fontsize=7.0, parse_math=False
            )
        axes.set_aspect("equal", adjustable="datalim")
        local = bool(placed[0][2]["place_m"])
        axes.set_xlabel("x [m]" if local else "east of the middle [m]")
        axes.set_ylabel("y [m]" if local else "north of the middle [m]")
        style.legend_above(axes, 3)
        style.head(figure, "The hall in plan")
        return style.svg_of(figure)


def geojson(result: HallResult) -> str:
    """The rows with longitude and latitude as a GeoJSON feature collection (RFC 7946); empty without any."""
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": list(row["lon_lat"])},
            "properties": {key: row[key] for key in ("row", "name", "count", "tag")}
            | {key: row["given"][key] for key in result.kept}
            | {key: row[key] for key in RESULT_COLUMNS if row[key] is not None},
        }
        for row in result.table
        if row["lon_lat"]
    ]
    if not features:
        return ""
    lines = ",\n".join(json.dumps(feature, ensure_ascii=False, allow_nan=False) for feature in features)
    return f'{{"type": "FeatureCollection", "features": [\n{lines}\n]}}\n'
