"""Figures of an ensemble: the fragility curve, or the boundary between points, with how sure they are."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from fem.batch.axes import Axis
from fem.ensemble.fragility import Lognormal
from fem.ensemble.plan import FREE, Ensemble
from fem.ensemble.statistics import PointResult
from fem.figures.style import (
    BLACK,
    BLUE,
    GREY,
    LEFT,
    SKY,
    VERMILLION,
    WIDTH,
    head,
    house_style,
    legend_above,
    panels,
    svg_of,
)
from fem.runtime.arrays import FloatArray

#: of the regions; lightness differs as well
COLOURS = {"below": SKY, "undecided": "#DDDDDD", "above": VERMILLION}
FINE = 240  #: points of a drawn curve
MOST_NUMBERS = 320  #: cells of a panel up to which each holds its number
COLUMNS = 2


def ensemble_figures(
    ensemble: Ensemble, points: Sequence[PointResult], fragility: Mapping[str, Any] | None
) -> dict[str, str]:
    """Figures as SVG documents, by name."""
    with house_style():
        if len(ensemble.axes) == 1:
            return {"fragility": svg_of(draw_fragility(ensemble, points, fragility or {}))}
        return {"boundary": svg_of(draw_boundary(ensemble, points))}


def draw_fragility(ensemble: Ensemble, points: Sequence[PointResult], fragility: Mapping[str, Any]) -> Figure:
    """Counts with their intervals, and the lognormal curve with its band."""
    figure, (axes,) = panels((3.2,), header=3)
    axis = ensemble.axes[0]
    head(figure, ensemble.title or ensemble.name, _statement(ensemble))
    fitted = fragility.get("lognormal")
    if fitted is not None:
        strengths = np.linspace(float(axis.values[0]), float(axis.values[-1]), FINE)
        curve = Lognormal(median=fitted["median"], deviation=fitted["deviation"])
        if "resampled" in fitted:
            low, high = band_of(fitted["resampled"], strengths, ensemble.confidence)
            axes.fill_between(
                strengths, low, high, color=BLUE, alpha=0.18, linewidth=0, label="bootstrap band"
            )
        word = "lognormal fitted" if fitted["adequate"] else "lognormal, which does not fit"
        axes.plot(strengths, curve.probability(strengths), color=BLUE, linestyle="--", label=word)
    known = [point for point in points if point.estimate.value is not None]
    value = np.array([point.estimate.value for point in known], dtype=float)
    low = np.array([point.estimate.low for point in known])
    high = np.array([point.estimate.high for point in known])
    axes.errorbar(
        [point.values[axis.key] for point in known],
        value,
        yerr=[np.maximum(value - low, 0.0), np.maximum(high - value, 0.0)],
        color=BLACK,
        marker="o",
        markersize=3.0,
        linewidth=0.8,
        capsize=2.0,
        label=f"counted, {100.0 * ensemble.confidence:g} % interval",
    )
    asked = f"{100.0 * ensemble.probability:g} %"
    axes.axhline(ensemble.probability, color=GREY, linewidth=0.8, linestyle=":", label=asked)
    axes.set_ylim(-0.02, 1.02)
    axes.margins(x=0.02)
    axes.set_ylabel("probability of overturning [-]")
    axes.set_xlabel(label_of(axis))
    legend_above(axes)
    return figure


def draw_boundary(ensemble: Ensemble, points: Sequence[PointResult]) -> Figure:
    """Which points overturn with at most the probability asked for, which with more, which is open."""
    *outer, down, across = ensemble.axes
    outside = outer[0].values if outer else (None,)
    columns = min(COLUMNS, len(outside))
    rows = -(-len(outside) // columns)
    tall_panel, gap, header = (2.6 if outer else 3.6), 0.75, 0.85
    tall = header + rows * tall_panel + (rows - 1) * gap + 0.5
    figure = Figure(figsize=(WIDTH, tall))
    head(figure, ensemble.title or ensemble.name, _statement(ensemble))
    wide = (WIDTH - LEFT - 0.15 - (columns - 1) * 0.7) / columns
    shape = (len(outside), len(down.values), len(across.values))
    regions = np.array([point.region for point in points]).reshape(shape)
    values = np.array([point.estimate.value for point in points], dtype=float).reshape(shape)
    for k, held in enumerate(outside):
        left = LEFT + (k % columns) * (wide + 0.7)
        bottom = tall - header - tall_panel - (k // columns) * (tall_panel + gap)
        axes = figure.add_axes((left / WIDTH, bottom / tall, wide / WIDTH, tall_panel / tall))
        _draw_panel(axes, across, down, regions[k], values[k])
        if held is not None:
            axes.set_title(f"{label_of(outer[0])} = {held:g}", fontsize=8)
    words = {
        "below": f"at most {ensemble.probability:g}",
        "undecided": "not decided by the draws",
        "above": f"more than {ensemble.probability:g}",
    }
    figure.legend(
        handles=[Patch(facecolor=COLOURS[name], label=words[name]) for name in COLOURS],
        loc="upper left",
        bbox_to_anchor=((LEFT - 0.1) / WIDTH, 1.0 - 0.42 / tall),
        ncols=3,
        title=None,
    )
    return figure


def band_of(
    resampled: Mapping[str, Any], strengths: FloatArray, confidence: float
) -> tuple[FloatArray, FloatArray]:
    """Pointwise ends of the bootstrapped curves, shapes (n,)."""
    curves = np.array(
        [
            Lognormal(median=median, deviation=deviation).probability(strengths)
            for median, deviation in zip(resampled["median"], resampled["deviation"], strict=True)
        ]
    )
    outside = 50.0 * (1.0 - confidence)
    low, high = np.percentile(curves, [outside, 100.0 - outside], axis=0)
    return low, high


def label_of(axis: Axis) -> str:
    """An axis for people: `peak acceleration [m/s²]`."""
    name = axis.key.rpartition(".")[2]
    if axis.key.startswith(FREE) or not axis.unit:
        return f"{name.replace('_', ' ')} [-]"
    suffix = "_" + axis.unit.replace("/", "_").replace(" ", "_")
    return (
        f"{name.removesuffix(suffix).replace('_', ' ')} [{axis.unit.replace('s2', 's²').replace('m3', 'm³')}]"
    )


def _statement(ensemble: Ensemble) -> str:
    names = ", ".join(
        one.key.rpartition(".")[2].removesuffix("_rad").replace("_", " ") for one in ensemble.random
    )
    return f"{ensemble.draws} draws a point ({ensemble.sampling}); random: {names}; not the floor's motion"


def _draw_panel(axes: Axes, across: Axis, down: Axis, regions: np.ndarray, values: FloatArray) -> None:
    """Cells in the colour of their region, each with its probability in per cent."""
    xs, ys = _edges(across), _edges(down)
    codes = np.vectorize(list(COLOURS).index, otypes=[float])(regions)
    colours = ListedColormap(list(COLOURS.values()))
    axes.pcolormesh(
        xs, ys, codes, cmap=colours, vmin=-0.5, vmax=len(COLOURS) - 0.5, edgecolor="white", linewidth=0.4
    )
    if values.size <= MOST_NUMBERS:
        for row, y in enumerate(down.values):
            for column, x in enumerate(across.values):
                text = "?" if np.isnan(values[row, column]) else f"{100.0 * values[row, column]:.0f}"
                dark = regions[row, column] == "above"
                axes.text(
                    x, y, text, ha="center", va="center", fontsize=6.5, color="white" if dark else BLACK
                )
    for scale, setter in ((across.scale, axes.set_xscale), (down.scale, axes.set_yscale)):
        if scale == "log":
            setter("log")
    axes.set_xlabel(f"{label_of(across)}   (numbers: % that overturned)")
    axes.set_ylabel(label_of(down))
    axes.grid(visible=False)


def _edges(axis: Axis) -> FloatArray:
    """Edges of the cells of an axis, halfway between its values (n + 1,)."""
    values = np.array(axis.values, dtype=float)
    if values.size == 1:
        return values[0] + np.array([-0.5, 0.5]) * max(abs(values[0]) * 0.1, 0.1)
    scaled = np.log(values) if axis.scale == "log" else values
    inner = 0.5 * (scaled[1:] + scaled[:-1])
    edges = np.concatenate([[2.0 * scaled[0] - inner[0]], inner, [2.0 * scaled[-1] - inner[-1]]])
    return np.exp(edges) if axis.scale == "log" else edges
