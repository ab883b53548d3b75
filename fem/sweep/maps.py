"""Maps of a sweep: outcome, rotation and slip over two axes, drawn from its table alone.

Two axes span a map; there is a panel for each combination of the others, unless they are held at one value. Where cells
have copies, the first map shows the share of them that overturns, and beside it the outcomes. A line encloses the cells
that overturn. The title says what the map holds fixed of the unknown inputs.
"""

from collections.abc import Callable, Mapping
from functools import partial
from itertools import islice, product
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import Colormap, LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fem.batch.axes import Axis
from fem.batch.labels import axis_label, axis_name
from fem.figures import style
from fem.figures.heat_map import Look, MapAxis, Panel, draw_heat_map, value_label
from fem.figures.paper_marks import LABEL, marks_of
from fem.html.units import rounded
from fem.results.figures import SLIPPED, TURNED
from fem.results.files import write_atomically
from fem.results.outcome import ENDINGS, Outcome
from fem.sweep.plan import MapChoice
from fem.sweep.table import RATIOS, SweepTable

OUTCOME_COLOURS = {**style.STATE_COLOURS, "failed": style.VERMILLION, "": style.WHITE}
#: shares of a cell and its copies that overturn, up to so much each; their brightness falls, so that the order is seen
#: without colours, too
SHARES = {
    "none overturns": 0.0,
    "up to a quarter": 0.25,
    "up to three quarters": 0.75,
    "more": 1.0 - 1e-9,
    "all overturn": 1.0,
}
SHARE_COLOURS = {
    "none overturns": "#DDEEF8",
    "up to a quarter": "#F5D878",
    "up to three quarters": "#EE9A3A",
    "more": "#A6401B",
    "all overturn": style.BLACK,
    "no outcome": style.WHITE,
}
GREYS = (style.WHITE, "#DDDDDD", "#AAAAAA", style.GREY, style.BLACK)
PRINTED_SHARES = dict(zip(SHARES, GREYS, strict=True)) | {"no outcome": style.WHITE}
PRINTED_OUTCOMES = dict(
    zip(
        style.STATE_COLOURS,
        (style.WHITE, "#DDDDDD", "#EEEEEE", "#DDDDDD", "#AAAAAA", style.BLACK, "#EEEEEE"),
        strict=True,
    )
)
PRINTED_OUTCOMES |= {"failed": style.WHITE, "": style.WHITE}
HATCHES = {
    Outcome.SLIDE: "---",
    Outcome.HOP: "..",
    Outcome.ROCK: "///",
    Outcome.SLIDE_ROCK: "xxx",
    Outcome.INVALID: "**",
    "failed": "oo",
}
MOST_PANELS = 12
LEAST_SLIP_MM = 1e-2  #: less is no slip
JOINT_SLIP = "max_joint_slip_m"
SLIPS = {
    "slip": ("Largest slip, where it stands", SLIPPED),
    "joint_slip": ("Largest slip between loose boxes, where they stand", JOINT_SLIP),
}


def draw_maps(table: SweepTable, folder: Path, choice: MapChoice) -> list[str]:
    """Write every map of a sweep into a folder as SVG; returns their names there."""
    folder.mkdir(exist_ok=True)
    if len(table.axes) == 1 or sum(len(axis.values) > 1 for axis in table.axes) < 2:
        figures = {"rotation": rotation_curve(table)}
    else:
        loose = ("joint_slip",) if np.isfinite(table.columns.get(JOINT_SLIP, np.nan)).any() else ()
        kinds = ("outcome", "outcome_print", "rotation", "slip", *loose)
        figures = {kind: sweep_map(table, kind, choice) for kind in kinds}
    for name, figure in figures.items():
        write_atomically(folder / f"{name}.svg", style.svg_of(figure))
    return [f"{folder.name}/{name}.svg" for name in figures]


def sweep_map(table: SweepTable, kind: str, choice: MapChoice) -> Figure:
    """One map.

    Args:
        table: of the sweep, which has two axes or more.
        kind: outcome (the share of copies that overturns, and the outcome) | outcome_print (the same without colours)
            | rotation (largest, over the slenderness angle) | slip (largest) | joint_slip (largest between loose
            boxes); the last three where the container stands.
        choice: of axes that the sweep has, and of values on them.
    """
    if kind.startswith("outcome"):
        return _outcome_map(table, choice, printed=kind == "outcome_print")
    fallen = np.isin(table.outcome, list(ENDINGS))
    if kind == "rotation":
        return _map(
            table,
            choice,
            np.where(fallen, np.nan, table[TURNED]),
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
        bar=f"slip [mm] (below {rounded(LEAST_SLIP_MM)}: none)",
    )


def rotation_curve(table: SweepTable) -> Figure:
    """Largest rotation along the one axis of a sweep, coloured by outcome; overturned cells at 1."""
    axis = max(table.axes, key=lambda axis: len(axis.values))
    numeric = all(not isinstance(value, bool | str) for value in axis.values)
    places = np.array(axis.values, dtype=float) if numeric else np.arange(len(axis.values), dtype=float)
    ratio = np.where(table.outcome == Outcome.OVERTURNED, 1.0, table[TURNED])
    unsure = table.columns.get("unsure")
    low, high = map(table.columns.get, RATIOS)
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
        for k, value in enumerate(marks_of(table.info.case, axis.key)):
            axes.axvline(value, color=style.GREY, linestyle=":", label="_" if k else LABEL)
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


def _outcome_map(table: SweepTable, choice: MapChoice, *, printed: bool) -> Figure:
    """Panels of the share of copies that overturns, where there are copies, each beside that of the outcomes."""
    outcome, share = np.array([list(OUTCOME_COLOURS).index(word) for word in table.outcome]), shares_of(table)
    outcomes = Look(colours=PRINTED_OUTCOMES, hatches=HATCHES) if printed else Look(colours=OUTCOME_COLOURS)
    shares = Look(colours=PRINTED_SHARES if printed else SHARE_COLOURS)
    grids, across, up, left_out = _grids(
        table, choice, most=MOST_PANELS if share is None else MOST_PANELS // 2
    )
    panels = []
    for name, plane in grids:
        overturned = plane(table.outcome == Outcome.OVERTURNED)
        if share is not None:
            words = "\n".join(filter(None, ("Share of a cell's variations that do not stand", name)))
            panels.append(Panel(values=plane(share), title=words, overturned=overturned, look=shares))
        words = "; ".join(filter(None, ("Outcome", name)))
        panels.append(Panel(values=plane(outcome), title=words, overturned=overturned, look=outcomes))
    title = _titled(table, "Outcome" if share is None else "Does it overturn?", left_out)
    return draw_heat_map(
        map_axis(across, table.info.case),
        map_axis(up, table.info.case),
        panels,
        title=title,
        colours={},
        columns=3 if share is None else 2,
    )


def shares_of(table: SweepTable) -> NDArray[Any] | None:
    """The place in `SHARE_COLOURS` of each cell (n_cells,); None where no cell has copies."""
    share = table.columns.get("overturned_share")
    if share is None or not np.isfinite(share).any():
        return None
    places = np.searchsorted(list(SHARES.values()), np.nan_to_num(share))
    return np.where(np.isfinite(share), places, len(SHARES))


def _map(
    table: SweepTable,
    choice: MapChoice,
    values: NDArray[Any],
    *,
    title: str,
    colours: Colormap,
    norm: Normalize,
    bar: str,
) -> Figure:
    """The panels of values (n_cells,)."""
    grids, across, up, left_out = _grids(table, choice)
    unsure = table.columns.get("unsure")
    panels = [
        Panel(
            values=plane(values),
            title=name,
            overturned=plane(table.outcome == Outcome.OVERTURNED),
            unsure=None if unsure is None else plane(unsure == 1.0),
        )
        for name, plane in grids
    ]
    title = _titled(table, title, left_out)
    return draw_heat_map(
        map_axis(across, table.info.case),
        map_axis(up, table.info.case),
        panels,
        title=title,
        colours=colours,
        norm=norm,
        bar=bar,
    )


def _titled(table: SweepTable, title: str, left_out: int) -> str:
    """A title with the subject of the sweep, and what its maps hold fixed."""
    subject = table.info.title or table.info.sweep
    more = f"; {left_out} more panels are not drawn" if left_out else ""
    return "\n".join(filter(None, (title, f"{subject}{more}", table.info.held)))


def _grids(
    table: SweepTable, choice: MapChoice, most: int = MOST_PANELS
) -> tuple[list[tuple[str, Callable[[NDArray[Any]], NDArray[Any]]]], Axis, Axis, int]:
    """For each panel its name and what takes its part of a column; the axes; how many panels are left out."""
    across, up = _plane(table, choice)
    picks, left_out = _picks(table, (across, up), choice.fixed, most)
    swapped = table.axes.index(across) < table.axes.index(up)

    def plane(pick: Mapping[int, int], column: NDArray[Any]) -> NDArray[Any]:
        grid = column.reshape(table.shape)[tuple(pick.get(k, slice(None)) for k in range(len(table.axes)))]
        return grid.T if swapped else grid

    return [(name, partial(plane, pick)) for name, pick in picks], across, up, left_out


def map_axis(axis: Axis, base: str) -> MapAxis:
    """An axis as a map draws it, with marks for a base case of this name."""
    scale = axis.scale if axis.is_numeric else "list"
    marks = marks_of(base, axis.key) if axis.is_numeric else ()
    return MapAxis(label=axis_label(axis), values=axis.values, scale=scale, marks=marks, marked=LABEL)


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
    table: SweepTable, plane: tuple[Axis, Axis], fixed: Mapping[str, Any], most: int
) -> tuple[list[tuple[str, dict[int, int]]], int]:
    """Name and indices of the other axes for each panel, and how many panels are left out."""
    others = [(k, axis) for k, axis in enumerate(table.axes) if axis not in plane]
    choices = [
        [axis.values.index(fixed[axis.key])] if axis.key in fixed else range(len(axis.values))
        for _, axis in others
    ]
    picks = []
    for indices in islice(product(*choices), most):
        pairs = list(zip(others, indices, strict=True))
        name = ", ".join(
            f"{axis_name(axis)} {value_label(axis.values[index])} {axis.unit}".strip()
            for (_, axis), index in pairs
        )
        picks.append((name, {k: index for (k, _), index in pairs}))
    return picks, int(np.prod([len(choice) for choice in choices])) - len(picks)
