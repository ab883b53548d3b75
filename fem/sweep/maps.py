"""Maps of a sweep: outcome, rotation and slip over two axes, drawn from its table alone.

Two axes span a map; there is a panel for each combination of the others, unless they are held at one value. A line
encloses the cells that overturn; unsure cells are hatched, those unsure in their regime alone are dotted. The title
says what the map holds fixed of the unknown inputs.
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

from fem.assessment.sureness import REGIME_UNSURE
from fem.batch.axes import Axis
from fem.batch.labels import axis_label, axis_name
from fem.figures import style
from fem.figures.heat_map import MapAxis, Panel, draw_heat_map, value_label
from fem.results.files import write_atomically
from fem.results.outcome import Outcome
from fem.sweep.plan import MapChoice
from fem.sweep.table import SweepTable

OUTCOME_COLOURS = {**style.STATE_COLOURS, "failed": style.VERMILLION, "": "#FFFFFF"}
MOST_PANELS = 12
LEAST_SLIP_MM = 1e-2  #: less is no slip
JOINT_SLIP = "max_joint_slip_m"
SLIPS = {
    "slip": ("Largest slip, where it stands", "max_slip_m"),
    "joint_slip": ("Largest slip between loose boxes, where they stand", JOINT_SLIP),
}


def draw_maps(table: SweepTable, folder: Path, choice: MapChoice) -> list[str]:
    """Write every map of a sweep into a folder as SVG; returns their names there."""
    folder.mkdir(exist_ok=True)
    if len(table.axes) == 1 or sum(len(axis.values) > 1 for axis in table.axes) < 2:
        figures = {"rotation": rotation_curve(table)}
    else:
        loose = ("joint_slip",) if np.isfinite(table.columns.get(JOINT_SLIP, np.nan)).any() else ()
        figures = {kind: sweep_map(table, kind, choice) for kind in ("outcome", "rotation", "slip", *loose)}
    for name, figure in figures.items():
        write_atomically(folder / f"{name}.svg", style.svg_of(figure))
    return [f"{folder.name}/{name}.svg" for name in figures]


def sweep_map(table: SweepTable, kind: str, choice: MapChoice) -> Figure:
    """One map.

    Args:
        table: of the sweep, which has two axes or more.
        kind: outcome (by colour) | rotation (largest, over the slenderness angle) | slip (largest) | joint_slip
            (largest between loose boxes); all but the first where the container stands.
        choice: of axes that the sweep has, and of values on them.
    """
    if kind == "outcome":
        codes = np.array([list(OUTCOME_COLOURS).index(word) for word in table.outcome])
        return _map(table, choice, codes, title="Outcome", colours=OUTCOME_COLOURS)
    fallen = table.outcome == Outcome.OVERTURNED
    if kind == "rotation":
        return _map(
            table,
            choice,
            np.where(fallen, np.nan, table["rotation_ratio"]),
            title="Largest rotation over slenderness angle, where it stands",
            colours=matplotlib.colormaps["viridis"],
            norm=Normalize(0.0, 1.0),
            bar="rotation ratio [-]",
        )
    title, column = SLIPS[kind]
    slip = 1e3 * np.where(fallen, np.nan, table[column])
    largest = max(np.nanmax(slip, initial=0.0), 10.0 * LEAST_SLIP_MM)
    return _map(
        table,
        choice,
        np.maximum(slip, LEAST_SLIP_MM),
        title=title,
        colours=matplotlib.colormaps["cividis"],
        norm=LogNorm(LEAST_SLIP_MM, largest),
        bar=f"slip [mm] (below {style.number(LEAST_SLIP_MM)}: none)",
    )


def rotation_curve(table: SweepTable) -> Figure:
    """Largest rotation along the one axis of a sweep, coloured by outcome; overturned cells at 1."""
    axis = max(table.axes, key=lambda one: len(one.values))
    numeric = all(not isinstance(value, bool | str) for value in axis.values)
    places = np.array(axis.values, dtype=float) if numeric else np.arange(len(axis.values), dtype=float)
    ratio = np.where(table.outcome == Outcome.OVERTURNED, 1.0, table["rotation_ratio"])
    unsure = table.columns.get("unsure")
    low, high = table.columns.get("band_rotation_ratio_low"), table.columns.get("band_rotation_ratio_high")
    with style.house_style():
        figure = Figure(figsize=(style.WIDTH, 3.4), layout="constrained")
        axes = figure.add_subplot()
        if low is not None and high is not None and np.isfinite(low).any():
            axes.vlines(places, np.minimum(low, 1.0), np.minimum(high, 1.0), color=style.GREY, linewidth=1.0)
        for word, colour in OUTCOME_COLOURS.items():
            chosen = table.outcome == word
            if word and chosen.any():
                axes.plot(places[chosen], ratio[chosen], "o", color=colour, markersize=4, label=word)
        if unsure is not None and (unsure == 1.0).any():
            chosen = unsure == 1.0
            axes.plot(
                places[chosen],
                ratio[chosen],
                "o",
                color=style.BLACK,
                fillstyle="none",
                markersize=8,
                label="unsure",
            )
        if axis.scale == "log":
            axes.set_xscale("log")
        if not numeric:
            axes.set_xticks(places, [str(value) for value in axis.values])
        axes.set_xlabel(axis_label(axis))
        axes.set_ylabel("largest rotation /\nslenderness angle [-]")
        axes.set_ylim(0.0, 1.05)
        axes.margins(x=0.02)
        title = "Largest rotation and outcome; grey: the range of the perturbed copies"
        axes.set_title("\n".join(filter(None, (title, table.info.held))))
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def _map(
    table: SweepTable,
    choice: MapChoice,
    values: NDArray[Any],
    *,
    title: str,
    colours: Colormap | Mapping[str, str],
    norm: Normalize | None = None,
    bar: str = "",
) -> Figure:
    """The panels of values (n_cells,)."""
    across, up = _plane(table, choice)
    picks, left_out = _picks(table, (across, up), choice.fixed)
    swapped = table.axes.index(across) < table.axes.index(up)

    def plane(column: NDArray[Any], pick: Mapping[int, int]) -> NDArray[Any]:
        grid = column.reshape(table.shape)[tuple(pick.get(k, slice(None)) for k in range(len(table.axes)))]
        return grid.T if swapped else grid

    unsure, sure = table.columns.get("unsure"), table.columns.get("sure")
    panels = [
        Panel(
            values=plane(values, pick),
            title=name,
            overturned=plane(table.outcome == Outcome.OVERTURNED, pick),
            unsure=None if unsure is None else plane(unsure == 1.0, pick),
            regime_unsure=None if sure is None else plane(sure == REGIME_UNSURE, pick),
        )
        for name, pick in picks
    ]
    subject = table.info.title or table.info.sweep
    more = f"; {left_out} more panels are not drawn" if left_out else ""
    return draw_heat_map(
        map_axis(across),
        map_axis(up),
        panels,
        title="\n".join(filter(None, (title, f"{subject}{more}", table.info.held))),
        colours=colours,
        norm=norm,
        bar=bar,
    )


def map_axis(axis: Axis) -> MapAxis:
    """An axis as a map draws it."""
    scale = axis.scale if axis.is_numeric else "list"
    return MapAxis(label=axis_label(axis), values=axis.values, scale=scale)


def _plane(table: SweepTable, choice: MapChoice) -> tuple[Axis, Axis]:
    """The axes across and up: those chosen, else those with the most values."""
    keys = choice.x, choice.y
    by_key = {axis.key: axis for axis in table.axes}
    largest = sorted(table.axes, key=lambda axis: -len(axis.values))
    rest = [axis for axis in largest if axis.key not in (*keys, *choice.fixed)]
    across, up = (by_key[key] if key is not None else rest.pop(0) for key in keys)
    if keys == (None, None) and table.axes.index(across) > table.axes.index(up):
        return up, across
    return across, up


def _picks(
    table: SweepTable, plane: tuple[Axis, Axis], fixed: Mapping[str, Any]
) -> tuple[list[tuple[str, dict[int, int]]], int]:
    """Name and indices of the other axes for each panel, and how many panels are left out."""
    others = [(k, axis) for k, axis in enumerate(table.axes) if axis not in plane]
    choices = [
        [axis.values.index(fixed[axis.key])] if axis.key in fixed else range(len(axis.values))
        for _, axis in others
    ]
    picks = []
    for indices in islice(product(*choices), MOST_PANELS):
        pairs = list(zip(others, indices, strict=True))
        name = ", ".join(
            f"{axis_name(axis)} {value_label(axis.values[index])} {axis.unit}".strip()
            for (_, axis), index in pairs
        )
        picks.append((name, {k: index for (k, _), index in pairs}))
    return picks, int(np.prod([len(one) for one in choices])) - len(picks)
