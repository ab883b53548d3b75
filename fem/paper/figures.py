"""Figures of the study, drawn as SVG with their text kept as text."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import AbstractPathEffect, withStroke

from fem.figures.style import STATE_COLOURS, VERMILLION
from fem.paper.claims import Drawing
from fem.runtime.arrays import FloatArray

#: distinguishable without colour vision (Okabe and Ito) and dark enough on white
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#7a4d9f", "#333333", "#b8860b")
OUTCOME_COLOURS = {**STATE_COLOURS, "failed": VERMILLION}  # as on every other map
CASED: list[AbstractPathEffect] = [
    withStroke(linewidth=2.8, foreground="white")
]  #: seen on black cells as well
DOTS: Any = {"color": "black", "markersize": 5.0, "markeredgecolor": "white", "markeredgewidth": 0.5}
STYLE: Any = {"svg.fonttype": "none", "svg.hashsalt": "unanchored", "font.size": 9, "axes.linewidth": 0.7}
WIDTH, HEIGHT = 6.2, 3.3  # inches


@dataclass(frozen=True, kw_only=True, eq=False)
class Line:
    """A curve, or points where the style says so."""

    x: Sequence[float] | FloatArray
    y: Sequence[float] | FloatArray
    label: str = ""
    style: str = "-"


def drawing(
    name: str,
    caption: str,
    lines: Sequence[Line],
    *,
    x_label: str,
    y_label: str,
    levels: Mapping[str, float] | None = None,
    log_x: bool = False,
    log_y: bool = False,
    y_limits: tuple[float, float] | None = None,
) -> Drawing:
    """Curves over one pair of axes; `levels` are horizontal lines with a name."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
        axes = figure.add_subplot()
        for line, colour in zip(lines, COLOURS * (1 + len(lines) // len(COLOURS)), strict=False):
            axes.plot(line.x, line.y, line.style, color=colour, label=line.label, linewidth=1.4, markersize=4)
        for text, level in (levels or {}).items():
            axes.axhline(level, color="#666666", linewidth=0.8, linestyle=":")
            axes.annotate(
                text,
                (1.0, level),
                xycoords=("axes fraction", "data"),
                ha="right",
                va="bottom",
                color="#444444",
            )
        if log_x:
            axes.set_xscale("log")
        if log_y:
            axes.set_yscale("log")
        if y_limits is not None:
            axes.set_ylim(*y_limits)
        if any(line.label for line in lines):
            axes.legend(frameon=False, fontsize=8)
        _finish(axes, x_label, y_label)
        return Drawing(name=name, caption=caption, svg=_svg(figure))


def outcome_map(
    name: str,
    caption: str,
    *,
    x: Sequence[float],
    y: Sequence[float],
    outcomes: Sequence[Sequence[str]],
    unsure: Sequence[Sequence[bool]] | None = None,
    x_label: str,
    y_label: str,
    curves: Sequence[Line] = (),
    log_y: bool = True,
) -> Drawing:
    """Outcome of every cell by colour, unsure cells dotted, curves on top; `outcomes[j][i]` at x[i], y[j]."""
    names = list(OUTCOME_COLOURS)
    values = np.array([[names.index(cell) for cell in row] for row in outcomes])
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 1.25 * HEIGHT), layout="constrained")
        axes = figure.add_subplot()
        axes.pcolormesh(
            x,
            y,
            values,
            cmap=ListedColormap(list(OUTCOME_COLOURS.values())),
            norm=BoundaryNorm(np.arange(len(names) + 1) - 0.5, len(names)),
            shading="nearest",
            rasterized=False,
        )
        if unsure is not None:
            rows, columns = np.nonzero(np.array(unsure))
            axes.plot(np.asarray(x)[columns], np.asarray(y)[rows], ".", **DOTS)
        for line, style in zip(curves, ("-", "--", ":", "-."), strict=False):
            axes.plot(
                line.x, line.y, style, color="black", linewidth=1.2, label=line.label, path_effects=CASED
            )
        if log_y:
            axes.set_yscale("log")
            axes.set_yticks(_round_ticks(y), [f"{tick:g}" for tick in _round_ticks(y)])
            axes.set_yticks([], minor=True)
        axes.set_xlim(min(x), max(x))
        axes.set_ylim(min(y), max(y))
        seen = [names[k] for k in sorted(set(values.ravel().tolist()))]
        handles: list[Any] = [
            Patch(facecolor=OUTCOME_COLOURS[outcome], edgecolor="#666666", label=outcome) for outcome in seen
        ]
        handles += axes.get_legend_handles_labels()[0]
        figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=8)
        _finish(axes, x_label, y_label)
        return Drawing(name=name, caption=caption, svg=_svg(figure))


def _round_ticks(values: Sequence[float]) -> list[float]:
    return [
        tick for tick in (0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0) if min(values) <= tick <= max(values)
    ]


def _finish(axes: Axes, x_label: str, y_label: str) -> None:
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.grid(visible=True, linewidth=0.3)


def _svg(figure: Figure) -> str:
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    return text[text.index("<svg") :]
