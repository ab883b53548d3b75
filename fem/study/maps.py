"""Maps of a sweep: outcome, rotation and slip over two axes, drawn from its table alone.

Two axes span a map; there is a panel for each combination of the others, unless they are held at one value. Where cells
have copies, the first map shows the share of them that overturns, and beside it the outcomes. A line encloses the cells
that overturn. The title says what the map holds fixed of the unknown inputs.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice, product
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fem.figures import style
from fem.figures.heat_map import MapAxis, Panel, draw_heat_map, value_label
from fem.figures.paper_marks import LABEL, marks_of
from fem.html.units import rounded
from fem.results.figures import SLIPPED, TURNED
from fem.results.outcome import ENDINGS, Outcome
from fem.runtime.own_files import place_in, write_atomically
from fem.study.answers import Answer, StudyAnswer, falling_in_words, sweep_answer
from fem.study.axes import MOTION_FILE, Axis, axis_label, axis_name
from fem.study.design import Ensemble, MapChoice
from fem.study.fragility import Fragility, PointRow
from fem.study.sweep_table import RATIOS, SweepTable

OUTCOME_COLOURS = {**style.STATE_COLOURS, "failed": style.VERMILLION, "": style.WHITE}
#: shares of a cell and its copies that overturn: up to so much each, and its colour; their brightness falls, so that
#: the order is seen without colours, too
SHARES = {
    "none overturns": (0.0, "#DDEEF8"),
    "up to a quarter": (0.25, "#F5D878"),
    "up to three quarters": (0.75, "#EE9A3A"),
    "more": (1.0 - 1e-9, "#A6401B"),
    "all overturn": (1.0, style.BLACK),
}
SHARE_COLOURS = {word: colour for word, (_, colour) in SHARES.items()} | {"no outcome": style.WHITE}
Part = Callable[[NDArray[Any]], NDArray[Any]]  #: from a column (n_cells,) to a panel
MOST_PANELS = 12
WORDS_OF_SHARES = "Share of a cell's variations that do not stand"
LEAST_SLIP_MM = 1e-2  #: less is no slip
JOINT_SLIP = "max_joint_slip_m"
SLIPS = {
    "slip": ("Largest slip, where it stands", SLIPPED),
    "joint_slip": ("Largest slip between loose boxes, where they stand", JOINT_SLIP),
}


def draw_maps(table: SweepTable, folder: Path, choice: MapChoice) -> list[str]:
    """Write every map of a sweep into a folder as SVG; returns their names there."""
    if len(table.axes) == 1 or sum(len(axis.values) > 1 for axis in table.axes) < 2:
        figures = {"rotation": _rotation_curve(table)}
    else:
        loose = ("joint_slip",) if np.isfinite(table.columns.get(JOINT_SLIP, np.nan)).any() else ()
        kinds = ("outcome", "rotation", "slip", *loose)
        answer = sweep_answer(table, folder.parent) if table.info.threshold else None
        boundary = None if answer is None else safe_boundary(table, answer, choice)
        figures = {"boundary": boundary} if boundary else {}
        figures |= {kind: sweep_map(table, kind, choice) for kind in kinds}
    for name, figure in figures.items():
        write_atomically(place_in(folder.parent, f"{folder.name}/{name}.svg"), style.svg_of(figure))
    return [f"{folder.name}/{name}.svg" for name in figures]


def sweep_map(table: SweepTable, kind: str, choice: MapChoice) -> Figure:
    """One map of a sweep with two axes or more.

    `kind`: outcome (the share of copies that overturns, and the outcome) | rotation (largest, over the slenderness
    angle) | slip (largest) | joint_slip (largest between loose boxes); the last three where it stands.
    """
    share, unsure = shares_of(table), table.columns.get("unsure")
    stands = ~np.isin(table.outcome, list(ENDINGS))
    #: words, what joins them to a panel's name, values, look
    layers: list[tuple[str, str, NDArray[Any], Mapping[str, str] | None]]
    look: dict[str, Any]
    if kind == "outcome":
        outcome = np.array([list(OUTCOME_COLOURS).index(word) for word in table.outcome])
        layers = [("Outcome", "; ", outcome, OUTCOME_COLOURS)]
        title, unsure, look = "Outcome", None, {"colours": {}, "columns": 3}
        if share is not None:  # beside that of the outcomes
            title, look["columns"] = "Does it overturn?", 2
            layers = [(WORDS_OF_SHARES, "\n", share, SHARE_COLOURS), *layers]
    elif kind == "rotation":
        title = "Largest rotation over slenderness angle, where it stands"
        layers = [("", "", np.where(stands, table[TURNED], np.nan), None)]
        look = {"colours": matplotlib.colormaps["viridis"], "norm": Normalize(0.0, 1.0)}
        look["bar"] = "rotation ratio [-]"
    else:
        title, column = SLIPS[kind]
        slip = 1e3 * np.where(stands, table[column], np.nan)
        layers = [("", "", np.maximum(slip, LEAST_SLIP_MM), None)]
        norm = LogNorm(LEAST_SLIP_MM, max(np.nanmax(slip, initial=0.0), 10.0 * LEAST_SLIP_MM))
        look = {"colours": matplotlib.colormaps["cividis"], "norm": norm}
        look["bar"] = f"slip [mm] (below {rounded(LEAST_SLIP_MM)}: none)"
    grids, spanned, left_out = _grids(table, choice, most=MOST_PANELS // len(layers))
    panels = [
        Panel(
            values=plane(values),
            title=joint.join(filter(None, (words, name))),
            overturned=plane(table.outcome == Outcome.OVERTURNED),
            unsure=None if unsure is None else plane(unsure == 1.0),
            look=one,
        )
        for name, plane in grids
        for words, joint, values, one in layers
    ]
    return draw_heat_map(*spanned, panels, title=_titled(table, title, left_out), **look)


def safe_boundary(table: SweepTable, answer: StudyAnswer[Answer], choice: MapChoice) -> Figure | None:
    """The boundary of the safe region and its band over the two axes of the maps, of a sweep with thresholds.

    The line joins, at each value of the other axis, where the first run overturned. The band begins behind the last
    cell whose copies all agree with it: from there to the line the container stands, but what is not known may overturn
    it. None where the thresholds lie along neither axis, or a smaller value is not the safer one.
    """
    across, up = _plane(table, choice)
    if answer.axis not in (across, up) or not answer.rising or not (across.is_numeric and up.is_numeric):
        return None
    other = up if answer.axis is across else across
    groups: dict[str, list[tuple[float, float, float]]] = {}
    for row in (row for row in answer.rows if other.key in row.point):
        found, known = row.found, np.array(answer.axis.values, dtype=float)
        fell = np.nan if found.overturned_from is None else found.overturned_from
        unsure = min([low for low, _ in found.unsure], default=np.inf)
        safe = known[known < min(unsure, np.inf if np.isnan(fell) else fell)]
        name = _held((axis, row.point[axis.key]) for axis in answer.others if axis is not other)
        sure_to = safe[-1] if safe.size else known[0]
        groups.setdefault(name, []).append((float(row.point[other.key]), float(sure_to), float(fell)))
    columns = min(2, len(groups))
    rows = -(-len(groups) // columns)
    with style.house_style():
        figure = Figure(figsize=(style.WIDTH, 0.9 + 2.5 * rows), layout="constrained")
        subplots = list(figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat)
        for axes in subplots[len(groups) :]:
            axes.set_visible(False)
        for k, (axes, (name, found_at)) in enumerate(zip(subplots, groups.items(), strict=False)):
            places, sure_to, fell = np.array(sorted(found_at)).T
            least, most = float(answer.axis.values[0]), float(answer.axis.values[-1])
            fill = axes.fill_betweenx if answer.axis is across else axes.fill_between
            ends = np.where(np.isnan(fell), most, fell)
            sure, band = "stands, and so do its copies", "band: a copy may overturn"
            fill(places, least, sure_to, color=style.SKY, alpha=0.35, linewidth=0, label=sure)
            fill(places, sure_to, ends, color=style.ORANGE, alpha=0.45, linewidth=0, label=band)
            points = (fell, places) if answer.axis is across else (places, fell)
            axes.plot(*points, "o-", color=style.BLACK, markersize=3.5, label="first overturned")
            marked = [marks_of(table.info.case, axis.key) for axis in (across, up)]
            crosses = np.array(list(product(*marked))).reshape(-1, 2).T
            look: dict[str, Any] = {"color": style.VERMILLION, "markersize": 7, "clip_on": False, "zorder": 3}
            axes.plot(*crosses, "P", label=LABEL, **look)
            for axis, scale in ((across, axes.set_xscale), (up, axes.set_yscale)):
                scale("log" if axis.scale == "log" else "linear")
            axes.set_title(name, fontsize=8.5)
            if k % columns == 0:
                axes.set_ylabel(axis_label(up))
            if k + columns >= len(groups):
                axes.set_xlabel(axis_label(across))
        figure.legend(handles=subplots[0].get_legend_handles_labels()[0], loc="outside lower center", ncols=4)
        figure.suptitle(
            _titled(table, "Boundary of the safe region, and its band", 0), x=0.01, ha="left", fontsize=10.0
        )
    return figure


def _rotation_curve(table: SweepTable) -> Figure:
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
            chosen, look = unsure == 1.0, dict[str, Any](color=style.BLACK, fillstyle="none", markersize=8)
            axes.plot(places[chosen], ratio[chosen], "o", label="unsure", **look)
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


def shares_of(table: SweepTable) -> NDArray[Any] | None:
    """The place in `SHARE_COLOURS` of each cell (n_cells,); None where no cell has copies."""
    share = table.columns.get("overturned_share")
    if share is None or not np.isfinite(share).any():
        return None
    places = np.searchsorted([most for most, _ in SHARES.values()], np.nan_to_num(share))
    return np.where(np.isfinite(share), places, len(SHARES))


def _titled(table: SweepTable, title: str, left_out: int) -> str:
    """A title with the subject of the sweep, and what its maps hold fixed."""
    subject = table.info.title or table.info.sweep
    more = f"; {left_out} more panels are not drawn" if left_out else ""
    return "\n".join(filter(None, (title, f"{subject}{more}", table.info.held)))


def _grids(
    table: SweepTable, choice: MapChoice, most: int = MOST_PANELS
) -> tuple[list[tuple[str, Part]], tuple[MapAxis, MapAxis], int]:
    """For each panel its name and what takes its part of a column; the axes; how many panels are left out."""
    across, up = _plane(table, choice)
    others = [axis for axis in table.axes if axis not in (across, up)]
    choices = [
        [(axis, value) for value in axis.values if value == choice.fixed.get(axis.key, value)]
        for axis in others
    ]
    swapped = table.axes.index(across) < table.axes.index(up)

    def plane(held: Mapping[str, Any], column: NDArray[Any]) -> NDArray[Any]:
        places = (
            axis.values.index(held[axis.key]) if axis.key in held else slice(None) for axis in table.axes
        )
        grid = column.reshape(table.shape)[tuple(places)]
        return grid.T if swapped else grid

    grids: list[tuple[str, Part]] = [
        (_held(held), partial(plane, {axis.key: value for axis, value in held}))
        for held in islice(product(*choices), most)
    ]
    spanned = _map_axis(across, table.info.case), _map_axis(up, table.info.case)
    return grids, spanned, math.prod(map(len, choices)) - len(grids)


def _held(values: Iterable[tuple[Axis, Any]]) -> str:
    """Values on axes, as the name of a panel."""
    return ", ".join(f"{axis_name(axis)} {value_label(one)} {axis.unit}".strip() for axis, one in values)


def _map_axis(axis: Axis, base: str) -> MapAxis:
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


#: of the regions; lightness differs as well
COLOURS = {"below": style.SKY, "undecided": "#DDDDDD", "above": style.VERMILLION}
FINE = 240  #: points of a drawn curve
LINE, SMALL_LINE = 92, 104  #: letters of a line above a figure
MOST_NUMBERS = 320  #: cells of a panel up to which each holds its number


def ensemble_figures(
    ensemble: Ensemble, points: Sequence[PointRow], fragility: Fragility | None
) -> dict[str, str]:
    """Over one axis the counts and the lognormal curve, over more the boundary: SVG documents, by name."""
    names = ", ".join(
        quantity.key.rpartition(".")[2].removesuffix("_rad").replace("_", " ")
        for quantity in ensemble.random
        if quantity.key != MOTION_FILE
    )
    ranges = f"; {len(ensemble.unknown)} unknown inputs drawn over their ranges" if ensemble.unknown else ""
    held = f"; {ensemble.held}" if ensemble.held else ""
    motions = ensemble.motions
    floor = "not the floor's motion" if motions is None else f"{len(motions.values)} motions equally often"
    said = f"{ensemble.draws} draws a point ({ensemble.sampling}); random: {names}{ranges}{held}; {floor}"
    with style.house_style():
        if len(ensemble.axes) == 1:
            return {"fragility": style.svg_of(_draw_fragility(ensemble, points, fragility, said))}
        return {"boundary": style.svg_of(_draw_boundary(ensemble, points, said))}


def _draw_fragility(
    ensemble: Ensemble, points: Sequence[PointRow], fragility: Fragility | None, said: str
) -> Figure:
    """Counts with their intervals, and the lognormal curve with its band."""
    statement = fill(said, SMALL_LINE)
    figure, (axes,) = style.panels((3.2,), header=3 + statement.count("\n"))
    axis = ensemble.axes[0]
    style.head(figure, ensemble.title or ensemble.name, statement)
    if fragility is not None and (fitted := fragility.lognormal) is not None:
        strengths = np.linspace(float(axis.values[0]), float(axis.values[-1]), FINE)
        word = "lognormal fitted" if fitted.adequate else "lognormal, which does not fit"
        axes.plot(strengths, fitted.probability(strengths), color=style.BLUE, linestyle="--", label=word)
    known = [point for point in points if point["probability"] is not None]
    value, low, high = (
        np.array([point[name] for point in known], dtype=float) for name in ("probability", "low", "high")
    )
    spread = [np.maximum(value - low, 0.0), np.maximum(high - value, 0.0)]
    look: dict[str, Any] = {"color": style.BLACK, "marker": "o", "markersize": 3.0, "linewidth": 0.8}
    label = f"counted, {100.0 * ensemble.confidence:g} % interval"
    axes.errorbar([point[axis.key] for point in known], value, yerr=spread, capsize=2.0, label=label, **look)
    for k, mark in enumerate(marks_of(ensemble.base.name, axis.key)):
        axes.axvline(mark, color=style.GREY, linestyle=":", label="_" if k else LABEL)
    limit = f"{100.0 * ensemble.probability:g} %"
    axes.axhline(ensemble.probability, color=style.GREY, linewidth=0.8, linestyle=":", label=limit)
    axes.set_ylim(-0.02, 1.02)
    axes.margins(x=0.02)
    axes.set_ylabel(f"probability of {falling_in_words(ensemble.limit_slip_m)} [-]")
    axes.set_xlabel(axis_label(axis))
    style.legend_above(axes)
    return figure


def _draw_boundary(ensemble: Ensemble, points: Sequence[PointRow], said: str) -> Figure:
    """Points that overturn with at most the given probability, with more, or undecided."""
    *outer, down, across = ensemble.axes
    outside = outer[0].values if outer else (None,)
    shape = (len(outside), len(down.values), len(across.values))
    limit = f"{ensemble.probability:g}"
    words = {
        "below": f"at most {limit}",
        "undecided": "not decided by the draws",
        "above": f"more than {limit}",
    }
    codes = np.array([list(COLOURS).index(point["region"]) for point in points]).reshape(shape)
    shares = [point["probability"] for point in points]
    texts = np.array(["?" if share is None else f"{100.0 * share:.0f}" for share in shares]).reshape(shape)
    maps = [
        Panel(
            values=codes[k],
            title="" if held is None else f"{axis_label(outer[0])} = {held:g}",
            overturned=codes[k] == list(COLOURS).index("above"),
            texts=texts[k].tolist() if texts[k].size <= MOST_NUMBERS else None,
        )
        for k, held in enumerate(outside)
    ]
    x, y = (_map_axis(axis, ensemble.base.name) for axis in (across, down))
    numbers = f"(numbers: % that {falling_in_words(ensemble.limit_slip_m, past=True)})"
    return draw_heat_map(
        replace(x, label=f"{x.label}   {numbers}"),
        y,
        maps,
        title=f"{ensemble.title or ensemble.name}\n{fill(said, LINE)}",
        colours={words[region]: colour for region, colour in COLOURS.items()},
    )
