"""Maps of a sweep: outcome, rotation and slip over two axes, drawn from its table alone.

Two axes span a map; a panel for each combination of the others, unless they are held at one value. Cells are drawn
side by side at equal size, whatever the spacing of their values, which stand at the ticks. A line parts cells that
overturn from cells that do not; the band of unsure cells is hatched and outlined.
"""

from collections.abc import Mapping, Sequence
from itertools import islice, product
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, LogNorm, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Path2D
from matplotlib.ticker import LogLocator, MaxNLocator
from matplotlib.transforms import Affine2D

from fem.batch.axes import Axis
from fem.figures.style import BLACK, GREY, STATE_COLOURS, VERMILLION, WIDTH, house_style, number, svg_of
from fem.results.run_folder import write_atomically
from fem.runtime.arrays import BoolArray, FloatArray
from fem.sweep.table import SweepTable

OUTCOME_COLOURS = {**STATE_COLOURS, "failed": VERMILLION, "": "#FFFFFF"}
MOST_PANELS = 12
COLUMNS = 3
LEAST_SLIP_MM = 1e-2  #: below, nothing has slid
TICKS = 7
HATCH = "////"


class MapError(ValueError):
    """A map that cannot be drawn as asked."""


def draw_maps(
    table: SweepTable,
    folder: Path,
    x: str | None = None,
    y: str | None = None,
    fixed: Mapping[str, Any] | None = None,
) -> list[str]:
    """Write every map of a sweep into a folder as SVG; returns their names there. Axes as for `outcome_map`."""
    folder.mkdir(exist_ok=True)
    if len(table.axes) == 1 or sum(len(axis.values) > 1 for axis in table.axes) < 2:
        figures = {"rotation": rotation_curve(table)}
    else:
        kinds = {"outcome": outcome_map, "rotation": rotation_map, "slip": slip_map}
        figures = {name: draw(table, x, y, fixed) for name, draw in kinds.items()}
    for name, figure in figures.items():
        write_atomically(folder / f"{name}.svg", svg_of(figure))
    return [f"{folder.name}/{name}.svg" for name in figures]


def outcome_map(
    table: SweepTable, x: str | None = None, y: str | None = None, fixed: Mapping[str, Any] | None = None
) -> Figure:
    """Outcome by colour.

    Args:
        table: of the sweep.
        x, y: keys of the axes that span the map; by default the two with the most values.
        fixed: values at which other axes are held; those that are not have a panel each.

    Raises:
        MapError: no such axis or value.
    """
    words = list(OUTCOME_COLOURS)
    codes = np.array([words.index(word) for word in table.outcome])
    colours = ListedColormap([OUTCOME_COLOURS[word] for word in words])
    seen = [word for word in words if word and (table.outcome == word).any()]
    maps = _Maps(table, x, y, fixed, "Outcome")
    maps.draw(codes, colours, Normalize(-0.5, len(words) - 0.5))
    maps.legend([Patch(facecolor=OUTCOME_COLOURS[word], edgecolor=GREY, label=word) for word in seen])
    return maps.figure


def rotation_map(
    table: SweepTable, x: str | None = None, y: str | None = None, fixed: Mapping[str, Any] | None = None
) -> Figure:
    """Largest rotation over the slenderness angle where the container stands; see `outcome_map`."""
    ratio = np.where(table.outcome == "overturned", np.nan, table["rotation_ratio"])
    maps = _Maps(table, x, y, fixed, "Largest rotation over slenderness angle, where it stands")
    maps.draw(ratio, "viridis", Normalize(0.0, 1.0))
    maps.colour_bar("rotation ratio [-]")
    maps.legend([Patch(facecolor=BLACK, label="overturned")])
    return maps.figure


def slip_map(
    table: SweepTable, x: str | None = None, y: str | None = None, fixed: Mapping[str, Any] | None = None
) -> Figure:
    """Largest slip where the container stands; see `outcome_map`."""
    slip = 1e3 * np.where(table.outcome == "overturned", np.nan, table["max_slip_m"])
    largest = max(np.nanmax(slip, initial=0.0), 10.0 * LEAST_SLIP_MM)
    maps = _Maps(table, x, y, fixed, "Largest slip, where it stands")
    maps.draw(np.maximum(slip, LEAST_SLIP_MM), "cividis", LogNorm(LEAST_SLIP_MM, largest))
    maps.colour_bar(f"slip [mm] (below {number(LEAST_SLIP_MM)}: none)")
    maps.legend([Patch(facecolor=BLACK, label="overturned")])
    return maps.figure


def rotation_curve(table: SweepTable) -> Figure:
    """Largest rotation along the one axis of a sweep, coloured by outcome; overturned cells at 1."""
    axis = max(table.axes, key=lambda one: len(one.values))
    numeric = all(not isinstance(value, bool | str) for value in axis.values)
    places = np.array(axis.values, dtype=float) if numeric else np.arange(len(axis.values), dtype=float)
    overturned = table.outcome == "overturned"
    ratio = np.where(overturned, 1.0, table["rotation_ratio"])
    low, high = table.columns.get("band_rotation_ratio_low"), table.columns.get("band_rotation_ratio_high")
    with house_style():
        figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
        axes = figure.add_subplot()
        if low is not None and high is not None and np.isfinite(low).any():
            axes.vlines(places, np.minimum(low, 1.0), np.minimum(high, 1.0), color=GREY, linewidth=1.0)
        for word, colour in OUTCOME_COLOURS.items():
            chosen = table.outcome == word
            if word and chosen.any():
                axes.plot(places[chosen], ratio[chosen], "o", color=colour, markersize=4, label=word)
        if axis.scale == "log":
            axes.set_xscale("log")
        if not numeric:
            axes.set_xticks(places, [str(value) for value in axis.values])
        axes.set_xlabel(axis_label(axis))
        axes.set_ylabel("largest rotation /\nslenderness angle [-]")
        axes.set_ylim(0.0, 1.05)
        axes.margins(x=0.02)
        axes.set_title("Largest rotation and outcome; grey: the range of the perturbed copies")
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def axis_label(axis: Axis) -> str:
    """A key for people: `motion.peak_acceleration_m_s2` is "peak acceleration [m/s²]"."""
    name = axis.key.rpartition(".")[2]
    unit = "_" + axis.unit.replace("/", "_")
    name = name.removesuffix(unit) if axis.unit else name
    shown = axis.unit.replace("m/s2", "m/s²").replace("kg/m3", "kg/m³") or "-"
    words = all(isinstance(value, bool | str) for value in axis.values)
    return name.replace("_", " ") + ("" if words else f" [{shown}]")


class _Maps:
    """The panels of one kind of map."""

    def __init__(
        self,
        table: SweepTable,
        x: str | None,
        y: str | None,
        fixed: Mapping[str, Any] | None,
        title: str,
    ) -> None:
        self._table = table
        self._x, self._y = _plane(table, x, y)
        self._picks, left_out = _panels(table, (self._x, self._y), fixed or {})
        columns = min(COLUMNS, len(self._picks))
        rows = -(-len(self._picks) // columns)
        with house_style():
            self.figure = Figure(
                figsize=(WIDTH, (4.6 if columns == 1 else 2.6 * rows) + 0.9), layout="constrained"
            )
            grid = self.figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        self._axes: list[Axes] = list(grid.flat)
        for unused in self._axes[len(self._picks) :]:
            unused.set_visible(False)
        subject = table.info.get("title") or table.info.get("sweep", "")
        more = f"; {left_out} more panels are not drawn" if left_out else ""
        self.figure.suptitle(f"{title}\n{subject}{more}", x=0.01, ha="left", fontsize=10.0)
        self._image: Any = None

    def draw(self, values: Any, colours: Any, norm: Normalize) -> None:
        """Fill the panels with a column's colours, (n_cells,)."""
        unsure = self._table.columns.get("unsure")
        overturned = self._table.outcome == "overturned"
        with house_style():
            for axes, (name, pick) in zip(self._axes, self._picks, strict=False):
                self._image = axes.imshow(
                    self._plane_of(values, pick), origin="lower", aspect="auto", interpolation="none",
                    cmap=colours, norm=norm,
                )  # fmt: skip
                fallen = self._plane_of(overturned, pick)
                if not isinstance(colours, ListedColormap):
                    _shade(axes, fallen, to_rgba(BLACK))
                if unsure is not None:
                    band = self._plane_of(unsure == 1.0, pick)
                    _hatch(axes, band & fallen, "#FFFFFF")
                    _hatch(axes, band & ~fallen, BLACK)
                _outline(axes, fallen, "#FFFFFF", 1.6)
                _outline(axes, fallen, BLACK, 0.7)
                axes.set_title(name, fontsize=8.5)
                axes.grid(visible=False)
                _ticks(axes, self._x, self._y)
            columns = min(COLUMNS, len(self._picks))
            for k, axes in enumerate(self._axes[: len(self._picks)]):
                if k % columns == 0:
                    axes.set_ylabel(axis_label(self._y))
                if k + columns >= len(self._picks):
                    axes.set_xlabel(axis_label(self._x))
                    axes.tick_params(labelbottom=True)

    def colour_bar(self, label: str) -> None:
        """The scale of the colours."""
        with house_style():
            shown = self._axes[: len(self._picks)]
            self.figure.colorbar(self._image, ax=shown, label=label, pad=0.02, aspect=30)

    def legend(self, handles: Sequence[Patch]) -> None:
        """What colours and lines mean."""
        marks = list(handles)
        unsure = self._table.columns.get("unsure")
        if unsure is not None and (unsure == 1.0).any():
            marks.append(
                Patch(facecolor="#FFFFFF", edgecolor=BLACK, hatch=HATCH, label="unsure", linewidth=0)
            )
        with house_style():
            self.figure.legend(handles=marks, loc="outside lower center", ncols=min(len(marks), 7))

    def _plane_of(self, values: Any, pick: Mapping[int, int]) -> Any:
        """The values of one panel, y downwards the rows and x along the columns."""
        axes = self._table.axes
        grid = np.asarray(values).reshape(self._table.shape)
        plane = grid[tuple(pick.get(k, slice(None)) for k in range(len(axes)))]
        return plane.T if axes.index(self._x) < axes.index(self._y) else plane


def _plane(table: SweepTable, x: str | None, y: str | None) -> tuple[Axis, Axis]:
    by_key = {axis.key: axis for axis in table.axes}
    for key in (x, y):
        if key is not None and key not in by_key:
            raise MapError(f"no axis {key!r} in this sweep (axes: {', '.join(by_key)})")
    if x is not None and x == y:
        raise MapError(f"a map needs two axes, got {x!r} twice")
    largest = sorted(table.axes, key=lambda axis: -len(axis.values))
    rest = [axis for axis in largest if axis.key not in (x, y)]
    if len(table.axes) < 2:
        raise MapError("a map needs two axes, this sweep has one")
    chosen = [by_key[key] if key is not None else None for key in (x, y)]
    found = [one if one is not None else rest.pop(0) for one in chosen]
    if x is None and y is None:
        found.sort(key=table.axes.index)
    return found[0], found[1]


def _panels(
    table: SweepTable, plane: tuple[Axis, Axis], fixed: Mapping[str, Any]
) -> tuple[list[tuple[str, dict[int, int]]], int]:
    """Name and indices of the other axes for each panel, and how many panels are left out."""
    unknown = set(fixed) - {axis.key for axis in table.axes if axis not in plane}
    if unknown:
        raise MapError(f"{sorted(unknown)[0]!r} is no axis that can be held fixed here")
    others = [(k, axis) for k, axis in enumerate(table.axes) if axis not in plane]
    choices = []
    for _, axis in others:
        if axis.key not in fixed:
            choices.append(list(range(len(axis.values))))
        elif fixed[axis.key] in axis.values:
            choices.append([axis.values.index(fixed[axis.key])])
        else:
            listed = ", ".join(str(value) for value in axis.values)
            raise MapError(f"axis {axis.key!r} has no value {fixed[axis.key]!r} (values: {listed})")
    count = int(np.prod([len(one) for one in choices]))
    picks = []
    for indices in islice(product(*choices), MOST_PANELS):
        name = ", ".join(
            f"{axis_label(axis).partition(' [')[0]} {_shown(axis.values[index])} {axis.unit}".strip()
            for (_, axis), index in zip(others, indices, strict=True)
        )
        picks.append((name, {k: index for (k, _), index in zip(others, indices, strict=True)}))
    return picks, count - len(picks)


def _shown(value: Any) -> str:
    return str(value) if isinstance(value, bool | str) else number(float(value))


def _shade(axes: Axes, cells: BoolArray, colour: tuple[float, ...]) -> None:
    """Cover cells with a colour."""
    cover = np.zeros((*cells.shape, 4))
    cover[cells] = colour
    axes.imshow(cover, origin="lower", aspect="auto", interpolation="none")


def _hatch(axes: Axes, cells: BoolArray, colour: str) -> None:
    """Hatch cells, all as one path."""
    if not cells.any():
        return
    squares = [
        Path2D.unit_rectangle().transformed(Affine2D().translate(column - 0.5, row - 0.5))
        for row, column in np.argwhere(cells)
    ]
    path = Path2D.make_compound_path(*squares)
    axes.add_patch(PathPatch(path, facecolor="none", edgecolor=colour, hatch=HATCH, linewidth=0))


def _outline(axes: Axes, cells: BoolArray, colour: str, width: float) -> None:
    """Draw the line between cells that are and cells that are not."""
    upright = np.argwhere(cells[:, 1:] != cells[:, :-1])
    level = np.argwhere(cells[1:] != cells[:-1])
    lines = [[(column + 0.5, row - 0.5), (column + 0.5, row + 0.5)] for row, column in upright]
    lines += [[(column - 0.5, row + 0.5), (column + 0.5, row + 0.5)] for row, column in level]
    axes.add_collection(LineCollection(lines, colors=colour, linewidths=width, capstyle="projecting"))


def _ticks(axes: Axes, x: Axis, y: Axis) -> None:
    for axis, put in ((x, axes.set_xticks), (y, axes.set_yticks)):
        places, labels = _tick_places(axis)
        put(places, labels)
    axes.spines[["left", "bottom"]].set_visible(False)


def _tick_places(axis: Axis) -> tuple[FloatArray | list[int], list[str]]:
    """Where round values of an axis lie between its cells, counted from the middle of the first."""
    count = len(axis.values)
    if not axis.is_numeric or axis.scale == "list":
        chosen = sorted({round(k) for k in np.linspace(0, count - 1, min(count, TICKS))})
        return chosen, [_shown(axis.values[k]) for k in chosen]
    values = np.array(axis.values, dtype=float)
    if axis.scale == "log":
        wide = values[-1] / values[0] > 100.0
        locator: Any = LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 3.0, 5.0), numticks=20)
        marks = locator.tick_values(values[0], values[-1])
        places = np.interp(np.log(marks), np.log(values), np.arange(count))
    else:
        marks = MaxNLocator(TICKS).tick_values(values[0], values[-1])
        places = np.interp(marks, values, np.arange(count))
    inside = (marks >= values[0] * (1.0 - 1e-9)) & (marks <= values[-1] * (1.0 + 1e-9))
    return places[inside], [number(mark) for mark in marks[inside]]
