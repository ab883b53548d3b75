"""Figures of the claims: curves, and outcome maps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from fem.figures.style import GREY, STATE_COLOURS, VERMILLION, WIDTH, house_style, svg_of
from fem.paper.claims import ClaimFigure
from fem.paper.maps import OutcomeMap
from fem.runtime.arrays import FloatArray

#: distinguishable without colour vision (Okabe and Ito) and dark enough on white
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#7a4d9f", "#333333", "#b8860b")
OUTCOME_COLOURS = {**STATE_COLOURS, "failed": VERMILLION}  # as on every other map
DOTS: Any = {"color": "black", "markersize": 5.0, "markeredgecolor": "white", "markeredgewidth": 0.5}
HEIGHT = 3.3  #: [inch]
TICKS = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class PlottedLine:
    """A curve, or points where the style says so."""

    x: Sequence[float] | FloatArray
    y: Sequence[float] | FloatArray
    label: str = ""
    style: str = "-"


def draw_curves(
    name: str,
    caption: str,
    lines: Sequence[PlottedLine],
    *,
    x_label: str,
    y_label: str,
    levels: Mapping[str, float] | None = None,
    log_x: bool = False,
    y_limits: tuple[float, float] | None = None,
) -> ClaimFigure:
    """Curves over one pair of axes; `levels` are horizontal lines with a name."""
    with house_style():
        figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
        axes = figure.add_subplot(xlabel=x_label, ylabel=y_label)
        for line, colour in zip(lines, COLOURS * (1 + len(lines) // len(COLOURS)), strict=False):
            axes.plot(line.x, line.y, line.style, color=colour, label=line.label, linewidth=1.4, markersize=4)
        for text, level in (levels or {}).items():
            axes.axhline(level, color=GREY, linewidth=0.8, linestyle=":")
            place = ("axes fraction", "data")
            axes.annotate(text, (1.0, level), xycoords=place, ha="right", va="bottom", color=GREY)
        if log_x:
            axes.set_xscale("log")
        if y_limits is not None:
            axes.set_ylim(*y_limits)
        if any(line.label for line in lines):
            axes.legend()
    return ClaimFigure(name=name, caption=caption, svg=svg_of(figure))


def draw_map(
    name: str,
    caption: str,
    one: OutcomeMap,
    *,
    x_label: str,
    y_label: str,
    curves: Sequence[PlottedLine] = (),
    log_y: bool = True,
) -> ClaimFigure:
    """Outcome of every cell by colour, unsure cells dotted, curves on top."""
    names = list(OUTCOME_COLOURS)
    outcomes = [[cell.row["outcome"] or "failed" for cell in row] for row in one.rows]
    values = np.array([[names.index(cell) for cell in row] for row in outcomes])
    with house_style():
        figure = Figure(figsize=(WIDTH, 1.25 * HEIGHT), layout="constrained")
        axes = figure.add_subplot(xlabel=x_label, ylabel=y_label)
        axes.pcolormesh(
            one.x,
            one.y,
            values,
            cmap=ListedColormap(list(OUTCOME_COLOURS.values())),
            norm=BoundaryNorm(np.arange(len(names) + 1) - 0.5, len(names)),
            shading="nearest",
        )
        rows, columns = np.nonzero([[not cell.sure for cell in row] for row in one.rows])
        axes.plot(np.asarray(one.x)[columns], np.asarray(one.y)[rows], ".", **DOTS)
        cased = [withStroke(linewidth=2.8, foreground="white")]  # seen on black cells as well
        for line, style in zip(curves, ("-", "--", ":", "-."), strict=False):
            axes.plot(line.x, line.y, style, color="black", label=line.label, path_effects=cased)
        if log_y:
            _log_ticks(axes, one.y)
        axes.set_xlim(min(one.x), max(one.x))
        axes.set_ylim(min(one.y), max(one.y))
        seen = [names[k] for k in np.unique(values)]
        handles: list[Any] = [
            Patch(facecolor=OUTCOME_COLOURS[word], edgecolor=GREY, label=word) for word in seen
        ]
        handles += axes.get_legend_handles_labels()[0]
        figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return ClaimFigure(name=name, caption=caption, svg=svg_of(figure))


def _log_ticks(axes: Axes, y: Sequence[float]) -> None:
    """A log scale with round values."""
    ticks = [tick for tick in TICKS if min(y) <= tick <= max(y)]
    axes.set_yscale("log")
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_yticks([], minor=True)
