"""Maps over two axes: a colour for every cell, the change of outcome as a line, doubtful cells hatched.

Cells are drawn side by side at equal size, whatever the spacing of their values; ticks stand at round values. Each
panel is one map; all have the same axes and colours.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Colormap, ListedColormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import LogLocator, MaxNLocator
from matplotlib.transforms import Affine2D

from fem.figures.style import BLACK, GREY, WHITE, WIDTH, house_style
from fem.html.units import rounded
from fem.runtime.arrays import BoolArray, FloatArray

COLUMNS = 3  #: of panels
TICKS = 7
HATCH = "////"
#: seen on black cells as well
CASED: list[AbstractPathEffect] = [withStroke(linewidth=2.8, foreground=WHITE)]


@dataclass(frozen=True, kw_only=True, eq=False)
class MapAxis:
    """An axis of a map."""

    label: str
    values: Sequence[Any]  #: one a column or row; numbers that rise, or words
    scale: str = "list"  #: linear | log: round values between the cells are marked; list: cells are
    marks: Sequence[float] = ()  #: values at which a line is drawn; where lines of both axes meet, a cross
    marked: str = ""  #: what they are

    def positions(self, values: FloatArray) -> FloatArray:
        """Positions of values, counted in cells from the middle of the first; nan outside of the axis."""
        known, points = np.array(self.values, dtype=float), np.asarray(values, dtype=float)
        if self.scale == "log":
            known, points = np.log(known), np.log(points)
        return np.interp(points, known, np.arange(known.size), left=np.nan, right=np.nan)

    def ticks(self) -> tuple[list[float], list[str]]:
        """Positions and labels of the marks."""
        count = len(self.values)
        if self.scale == "list":
            chosen = sorted({round(k) for k in np.linspace(0, count - 1, min(count, TICKS))})
            return [float(k) for k in chosen], [value_label(self.values[k]) for k in chosen]
        low, high = float(self.values[0]), float(self.values[-1])
        locator: Any = MaxNLocator(TICKS)
        if self.scale == "log":
            locator = LogLocator(subs=(1.0,) if high / low > 100.0 else (1.0, 2.0, 3.0, 5.0), numticks=20)
        margin = 1e-9 * abs(high)
        marks = [mark for mark in locator.tick_values(low, high) if low - margin <= mark <= high + margin]
        return self.positions(np.clip(marks, low, high)).tolist(), [rounded(mark) for mark in marks]


@dataclass(frozen=True, kw_only=True, eq=False)
class MapCurve:
    """A line over a map, in the units of its axes."""

    x: FloatArray
    y: FloatArray
    label: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """One map; arrays have a row for each value of y and a column for each of x."""

    values: FloatArray
    title: str = ""
    overturned: BoolArray | None = None  #: cells enclosed by a line; black where colours are a scale
    unsure: BoolArray | None = None  #: cells that are hatched
    #: colours of its own by their words, to whose places `values` refer
    look: Mapping[str, str] | None = None
    texts: Sequence[Sequence[str]] | None = None  #: within the cells
    curves: Sequence[MapCurve] = ()


def draw_heat_map(
    x: MapAxis,
    y: MapAxis,
    panels: Sequence[Panel],
    *,
    title: str = "",
    colours: Colormap | Mapping[str, str],
    norm: Normalize | None = None,
    bar: str = "",
    columns: int = COLUMNS,
) -> Figure:
    """Draw maps side by side.

    Args:
        x, y: the axes, the same for all panels.
        panels: the maps.
        title: above all.
        colours: a colour scale; or colours by their words, to whose places `values` refer.
        norm: limits of the colour scale.
        bar: label of the colour scale.
        columns: of panels, at most.
    """
    shared, ramp = (colours, None) if isinstance(colours, Mapping) else (None, colours)
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    height = {1: 4.6, 2: 3.4 * rows}.get(columns, 2.6 * rows)
    with house_style():
        figure = Figure(figsize=(WIDTH, height + 0.9), layout="constrained")
        subplots = list(figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat)
        for axes in subplots[len(panels) :]:
            axes.set_visible(False)
        for k, (axes, panel) in enumerate(zip(subplots, panels, strict=False)):
            look = panel.look or shared
            scale = ScalarMappable(
                cmap=ListedColormap(list(look.values())) if look else ramp,
                norm=Normalize(-0.5, len(look) - 0.5) if look else norm,
            )
            _fill_cells(axes, scale.to_rgba(np.ma.masked_invalid(panel.values)))
            _draw_over(axes, x, y, panel, look)
            _draw_marks(axes, x, y)
            axes.set_title(panel.title, fontsize=8.5)
            axes.grid(visible=False)
            axes.spines[:].set_visible(panel.look is not None)
            axes.set_xticks(*x.ticks())
            axes.set_yticks(*y.ticks())
            if k % columns == 0:
                axes.set_ylabel(y.label)
            if k + columns >= len(panels):
                axes.set_xlabel(x.label)
                axes.tick_params(labelbottom=True)
            if panel.look and k + columns >= len(panels):
                handles = _classes([other for other in panels if other.look is panel.look], panel.look)
                below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.2), "ncols": 2}
                axes.legend(handles=handles, handlelength=1.4, columnspacing=1.0, **below)
        figure.suptitle(title, x=0.01, ha="left", fontsize=10.0)
        if bar:
            figure.colorbar(scale, ax=subplots[: len(panels)], label=bar, pad=0.02, aspect=30)
        plain = [panel for panel in panels if panel.look is None]
        handles = _classes(plain, shared) if shared else []
        if not shared and any(panel.overturned is not None for panel in plain):
            handles.append(Patch(facecolor=BLACK, label="overturned"))
        if any(panel.unsure is not None and panel.unsure.any() for panel in plain):
            handles.append(Patch(facecolor=WHITE, edgecolor=BLACK, hatch=HATCH, label="unsure", linewidth=0))
        handles += subplots[0].get_legend_handles_labels()[0]
        if handles:  # names of curves are long
            columns = 4 if len(handles) > 7 or any(panel.curves for panel in panels) else 7
            figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), columns))
    return figure


def value_label(value: Any) -> str:
    """A value of an axis for people."""
    return str(value) if isinstance(value, bool | str) else rounded(float(value))


def _classes(panels: Sequence[Panel], look: Mapping[str, str]) -> list[Any]:
    """A patch for every class that occurs."""
    seen = {int(value) for panel in panels for value in np.unique(panel.values)}
    return [
        Patch(facecolor=colour, edgecolor=GREY, label=word)
        for k, (word, colour) in enumerate(look.items())
        if k in seen and word
    ]


def _fill_cells(axes: Axes, colours: FloatArray) -> None:
    """Fill cells, all of a colour as one path of rectangles: an image would be blurred by some viewers.

    Args:
        axes: of the panel.
        colours: (rows, columns, 4); what is not opaque is left out.
    """
    rows, columns, _ = colours.shape
    for colour in np.unique(colours[colours[..., 3] > 0.0], axis=0):
        own = np.pad((colours == colour).all(axis=2), ((0, 0), (1, 1)))
        starts, ends = (np.argwhere(own[:, 1:] & ~own[:, :-1]), np.argwhere(~own[:, 1:] & own[:, :-1]))
        runs = [
            Path.unit_rectangle().transformed(
                Affine2D().scale(end - start, 1.0).translate(start - 0.5, row - 0.5)
            )
            for (row, start), (_, end) in zip(starts, ends, strict=True)
        ]
        path = Path.make_compound_path(*runs)
        axes.add_patch(PathPatch(path, facecolor=colour, linewidth=0, antialiased=False, zorder=0))
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(-0.5, rows - 0.5))


def _draw_marks(axes: Axes, x: MapAxis, y: MapAxis) -> None:
    """Lines at the marked values, and crosses where they meet."""
    across, up = (axis.positions(np.array(axis.marks)) if axis.marks else np.empty(0) for axis in (x, y))
    look: dict[str, Any] = {"color": BLACK, "linewidth": 0.8, "path_effects": CASED[:1]}
    for place in across:
        axes.axvline(place, linestyle=":", **look)
    for place in up:
        axes.axhline(place, linestyle=":", **look)
    crossed = [(a, b) for a in across for b in up] or [(np.nan, np.nan)]
    if x.marks or y.marks:
        label = x.marked or y.marked
        sign = "+" if x.marks and y.marks else ""
        look |= {
            "linestyle": "none" if sign else ":",
            "marker": sign,
            "markersize": 11.0,
            "markeredgewidth": 1.6,
        }
        axes.plot(*np.transpose(crossed), label=label, **look)


def _draw_over(axes: Axes, x: MapAxis, y: MapAxis, panel: Panel, look: Mapping[str, str] | None) -> None:
    """What is drawn over the colours of a panel."""
    fallen = np.zeros(panel.values.shape, dtype=bool) if panel.overturned is None else panel.overturned
    if look is None:
        _fill_cells(axes, np.where(fallen[..., np.newaxis], to_rgba(BLACK), 0.0))
    if panel.unsure is not None:
        _hatch(axes, panel.unsure & fallen, HATCH, WHITE)
        _hatch(axes, panel.unsure & ~fallen, HATCH, BLACK)
    _outline(axes, fallen, WHITE, 1.6)
    _outline(axes, fallen, BLACK, 0.7)
    for row, words in enumerate(panel.texts or ()):
        for column, text in enumerate(words):
            colour = WHITE if fallen[row, column] else BLACK
            axes.text(column, row, text, ha="center", va="center", fontsize=6.5, color=colour)
    for curve, style in zip(panel.curves, ("-", "--", ":", "-."), strict=False):
        axes.plot(
            x.positions(curve.x),
            y.positions(curve.y),
            style,
            color=BLACK,
            linewidth=1.2,
            label=curve.label,
            path_effects=CASED,
        )


def _hatch(axes: Axes, cells: BoolArray, hatch: str, colour: str) -> None:
    """Hatch cells, all as one path."""
    if not cells.any():
        return
    squares = [
        Path.unit_rectangle().transformed(Affine2D().translate(column - 0.5, row - 0.5))
        for row, column in np.argwhere(cells)
    ]
    path = Path.make_compound_path(*squares)
    axes.add_patch(PathPatch(path, facecolor="none", edgecolor=colour, hatch=hatch, linewidth=0))


def _outline(axes: Axes, cells: BoolArray, colour: str, width: float) -> None:
    """Draw the line between cells that are and cells that are not."""
    upright = np.argwhere(cells[:, 1:] != cells[:, :-1])
    level = np.argwhere(cells[1:] != cells[:-1])
    lines = [[(column + 0.5, row - 0.5), (column + 0.5, row + 0.5)] for row, column in upright]
    lines += [[(column - 0.5, row + 0.5), (column + 0.5, row + 0.5)] for row, column in level]
    axes.add_collection(LineCollection(lines, colors=colour, linewidths=width, capstyle="projecting"))
