"""Figures of the claims: curves, and outcome maps."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from paper.claims import ClaimFigure
from paper.maps import OutcomeMap

from fem.figures.heat_map import MapCurve, Panel, draw_heat_map
from fem.figures.style import GREY, WIDTH, house_style, svg_of
from fem.runtime.arrays import FloatArray
from fem.study.maps import OUTCOME_COLOURS

#: distinguishable without colour vision (Okabe and Ito) and dark enough on white
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#7a4d9f", "#333333", "#b8860b")
HEIGHT = 3.3  #: [inch]


class Curve(NamedTuple):
    """A line, or points where the style of matplotlib says so."""

    x: Sequence[float] | FloatArray
    y: Sequence[float] | FloatArray
    label: str = ""
    style: str = "-"


def draw_curves(
    name: str,
    caption: str,
    labels: str,
    lines: Sequence[Curve],
    *,
    levels: Mapping[str, float] | None = None,
    log_x: bool = False,
    y_limits: tuple[float, float] | None = None,
) -> ClaimFigure:
    """Curves over one pair of axes, labelled "x | y"; `levels` are horizontal lines with a name."""
    with house_style():
        figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
        across, up = labels.split(" | ")
        axes = figure.add_subplot(xlabel=across, ylabel=up)
        for line, colour in zip(lines, COLOURS * (1 + len(lines) // len(COLOURS)), strict=False):
            axes.plot(line.x, line.y, line.style, color=colour, label=line.label, linewidth=1.4, markersize=4)
        for text, level in (levels or {}).items():
            axes.axhline(level, color=GREY, linewidth=0.8, linestyle=":")
            coordinates = ("axes fraction", "data")
            axes.annotate(text, (1.0, level), xycoords=coordinates, ha="right", va="bottom", color=GREY)
        if log_x:
            axes.set_xscale("log")
        if y_limits is not None:
            axes.set_ylim(*y_limits)
        if any(line.label for line in lines):
            figure.legend(loc="outside lower center", ncols=4)
        axes.margins(x=0.02)
    return ClaimFigure(name=name, caption=caption, svg=svg_of(figure))


def draw_map(name: str, caption: str, outcome_map: OutcomeMap, curves: Sequence[MapCurve]) -> ClaimFigure:
    """Outcome of every cell by colour, unsure cells hatched, curves on top."""
    words = list(OUTCOME_COLOURS)
    panel = Panel(
        values=np.array(
            [[words.index(cell.row["outcome"] or "failed") for cell in row] for row in outcome_map.rows]
        ),
        overturned=np.array([[cell.fell for cell in row] for row in outcome_map.rows]),
        unsure=np.array([[not cell.sure for cell in row] for row in outcome_map.rows]),
        curves=curves,
    )
    figure = draw_heat_map(outcome_map.x, outcome_map.y, [panel], colours=OUTCOME_COLOURS)
    return ClaimFigure(name=name, caption=caption, svg=svg_of(figure))
