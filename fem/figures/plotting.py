"""The style of all figures for what matplotlib draws: maps, intervals, sketches, pictures; and its export as SVG.

Drawn through matplotlib's objects, without its global state; the same bytes for the same numbers.
"""

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.figures.style import BLACK, GREY, layout_of

COORDINATE = re.compile(r"(?<=\.\d\d)\d+")  #: digits beyond a hundredth of a point
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",  # text stays text: small, searchable
    "svg.hashsalt": "unanchored",
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.labelcolor": BLACK,
    "axes.formatter.useoffset": False,
    "axes.xmargin": 0.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "legend.columnspacing": 1.4,
    "legend.handlelength": 2.2,
    "hatch.linewidth": 0.6,
    "text.color": BLACK,
    "xtick.color": BLACK,
    "ytick.color": BLACK,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in this style, whatever the user's settings of matplotlib."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


def plotted_panels(heights: Sequence[float], **layout: Any) -> tuple[Figure, list[Axes]]:
    """As `fem.figures.style.panels`, of matplotlib."""
    size, places, beside = layout_of(heights, **layout)
    figure = Figure(figsize=size)
    drawn = [figure.add_axes(place) for place in places]
    for axes in drawn:
        axes.yaxis.set_label_coords(beside, 0.5)
    return figure, drawn


def svg_of(figure: Figure) -> str:
    """A figure, drawn in the house style, as an SVG document; the same bytes for the same drawing."""
    stream = io.StringIO()
    with house_style():
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return re.sub(r' d="[^"]*"', lambda path: COORDINATE.sub("", path[0]), stream.getvalue())
