"""Maps of a sweep: outcome, rotation and slip over two axes, drawn from its table alone.

Two axes span a map; there is a panel for each combination of the others, unless they are held at one value. A line
encloses the cells that overturn; unsure cells are hatched.
"""

from collections.abc import Mapping
from itertools import islice, product
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import Colormap, LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fem.batch.axes import Axis, axis_label
from fem.figures.heat_map import MapAxis, Panel, draw_heat_map, value_label
from fem.figures.style import GREY, STATE_COLOURS, VERMILLION, WIDTH, house_style, number, svg_of
from fem.results.files import write_atomically
from fem.sweep.table import SweepTable

OUTCOME_COLOURS = {**STATE_COLOURS, "failed": VERMILLION, "": "#FFFFFF"}
MOST_PANELS = 12
LEAST_SLIP_MM = 1e-2  #: less is no slip


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
    return _map(table, x, y, fixed, codes, title="Outcome", colours=OUTCOME_COLOURS)


def rotation_map(
    table: SweepTable, x: str | None = None, y: str | None = None, fixed: Mapping[str, Any] | None = None
) -> Figure:
    """Largest rotation over the slenderness angle where the container stands; see `outcome_map`."""
    return _map(
        table, x, y, fixed,
        np.where(table.outcome == "overturned", np.nan, table["rotation_ratio"]),
        title="Largest rotation over slenderness angle, where it stands",
        colours=matplotlib.colormaps["viridis"],
        norm=Normalize(0.0, 1.0),
        bar="rotation ratio [-]",
    )  # fmt: skip


def slip_map(
    table: SweepTable, x: str | None = None, y: str | None = None, fixed: Mapping[str, Any] | None = None
) -> Figure:
    """Largest slip where the container stands; see `outcome_map`."""
    slip = 1e3 * np.where(table.outcome == "overturned", np.nan, table["max_slip_m"])
    largest = max(np.nanmax(slip, initial=0.0), 10.0 * LEAST_SLIP_MM)
    return _map(
        table, x, y, fixed,
        np.maximum(slip, LEAST_SLIP_MM),
        title="Largest slip, where it stands",
        colours=matplotlib.colormaps["cividis"],
        norm=LogNorm(LEAST_SLIP_MM, largest),
        bar=f"slip [mm] (below {number(LEAST_SLIP_MM)}: none)",
    )  # fmt: skip


def rotation_curve(table: SweepTable) -> Figure:
    """Largest rotation along the one axis of a sweep, coloured by outcome; overturned cells at 1."""
    axis = max(table.axes, key=lambda one: len(one.values))
    numeric = all(not isinstance(value, bool | str) for value in axis.values)
    places = np.array(axis.values, dtype=float) if numeric else np.arange(len(axis.values), dtype=float)
    ratio = np.where(table.outcome == "overturned", 1.0, table["rotation_ratio"])
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


def _map(
    table: SweepTable,
    x: str | None,
    y: str | None,
    fixed: Mapping[str, Any] | None,
    values: NDArray[Any],
    *,
    title: str,
    colours: Colormap | Mapping[str, str],
    norm: Normalize | None = None,
    bar: str = "",
) -> Figure:
    """The panels of values (n_cells,)."""
    across, up = _plane(table, x, y)
    picks, left_out = _picks(table, (across, up), fixed or {})
    swapped = table.axes.index(across) < table.axes.index(up)

    def plane(column: NDArray[Any], pick: Mapping[int, int]) -> NDArray[Any]:
        grid = column.reshape(table.shape)[tuple(pick.get(k, slice(None)) for k in range(len(table.axes)))]
        return grid.T if swapped else grid

    unsure = table.columns.get("unsure")
    panels = [
        Panel(
            values=plane(values, pick),
            title=name,
            overturned=plane(table.outcome == "overturned", pick),
            unsure=None if unsure is None else plane(unsure == 1.0, pick),
        )
        for name, pick in picks
    ]
    subject = table.info.get("title") or table.info.get("sweep", "")
    more = f"; {left_out} more panels are not drawn" if left_out else ""
    return draw_heat_map(
        map_axis(across),
        map_axis(up),
        panels,
        title=f"{title}\n{subject}{more}",
        colours=colours,
        norm=norm,
        bar=bar,
    )


def map_axis(axis: Axis) -> MapAxis:
    """An axis as a map draws it."""
    scale = axis.scale if axis.is_numeric else "list"
    return MapAxis(label=axis_label(axis), values=axis.values, scale=scale)


def _plane(table: SweepTable, x: str | None, y: str | None) -> tuple[Axis, Axis]:
    by_key = {axis.key: axis for axis in table.axes}
    for key in (x, y):
        if key is not None and key not in by_key:
            raise MapError(f"no axis {key!r} in this sweep (axes: {', '.join(by_key)})")
    if x is not None and x == y:
        raise MapError(f"a map needs two axes, got {x!r} twice")
    if len(table.axes) < 2:
        raise MapError("a map needs two axes, this sweep has one")
    largest = sorted(table.axes, key=lambda axis: -len(axis.values))
    rest = [axis for axis in largest if axis.key not in (x, y)]
    found = [by_key[key] if key is not None else rest.pop(0) for key in (x, y)]
    if x is None and y is None:
        found.sort(key=table.axes.index)
    return found[0], found[1]


def _picks(
    table: SweepTable, plane: tuple[Axis, Axis], fixed: Mapping[str, Any]
) -> tuple[list[tuple[str, dict[int, int]]], int]:
    """Name and indices of the other axes for each panel, and how many panels are left out."""
    others = [(k, axis) for k, axis in enumerate(table.axes) if axis not in plane]
    unknown = set(fixed) - {axis.key for _, axis in others}
    if unknown:
        raise MapError(f"{sorted(unknown)[0]!r} is no axis that can be held fixed here")
    choices = []
    for _, axis in others:
        if axis.key not in fixed:
            choices.append(list(range(len(axis.values))))
        elif fixed[axis.key] in axis.values:
            choices.append([axis.values.index(fixed[axis.key])])
        else:
            listed = ", ".join(str(value) for value in axis.values)
            raise MapError(f"axis {axis.key!r} has no value {fixed[axis.key]!r} (values: {listed})")
    picks = []
    for indices in islice(product(*choices), MOST_PANELS):
        pairs = list(zip(others, indices, strict=True))
        name = ", ".join(
            f"{axis_label(axis).partition(' [')[0]} {value_label(axis.values[index])} {axis.unit}".strip()
            for (_, axis), index in pairs
        )
        picks.append((name, {k: index for (k, _), index in pairs}))
    return picks, int(np.prod([len(one) for one in choices])) - len(picks)
