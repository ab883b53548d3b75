"""The figures of a run in its report: the same drawings as in `figures/`, with places for a moving cursor."""

import json
import math
from dataclasses import dataclass

from markupsafe import Markup
from matplotlib.figure import Figure

from fem.drawing import svg_of, time_axes
from fem.pages import svg_element

#: figures with a mark that moves in the plane: what stands across and up, and the factors to their units
PLANES = {"phase_portrait": ("rotation", "rate", 180.0 / math.pi)}


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A figure, ready to stand in a page."""

    name: str
    title: str
    svg: Markup
    axes: str  #: for the cursor, as JSON; empty where there is nothing to follow


def curves_of(figures: dict[str, Figure]) -> dict[str, Curve]:
    """Figures of a run as elements of a page."""
    return {name: _curve(name, figure) for name, figure in figures.items()}


def _curve(name: str, figure: Figure) -> Curve:
    title = next((text.get_text() for text in figure.texts if text.get_text()), name.replace("_", " "))
    svg = svg_element(svg_of(figure), label=title, prefix=name)
    return Curve(name=name, title=title, svg=svg, axes=_axes(name, figure))


def _axes(name: str, figure: Figure) -> str:
    panels = time_axes(figure)
    if panels:
        first = panels[0]
        return json.dumps(
            {
                "kind": "time",
                "left": first.left,
                "right": first.right,
                "top": max(panel.top for panel in panels),
                "bottom": min(panel.bottom for panel in panels),
                "x": [first.start, first.end],
            }
        )
    if name not in PLANES:
        return ""
    across, up, factor = PLANES[name]
    axes = figure.axes[0]
    box = axes.get_position()
    return json.dumps(
        {
            "kind": "plane",
            "left": box.x0,
            "right": box.x1,
            "top": box.y1,
            "bottom": box.y0,
            "x": list(axes.get_xlim()),
            "y": list(axes.get_ylim()),
            "horizontal": across,
            "vertical": up,
            "factors": [factor, factor],
        }
    )
