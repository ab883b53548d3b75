"""Figures of an ensemble: the fragility curve, or the boundary between points, with their intervals."""

from collections.abc import Sequence
from dataclasses import replace
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from fem.batch.answers import falling_in_words
from fem.batch.axes import MOTION_FILE
from fem.batch.labels import axis_label
from fem.ensemble.fragility import Lognormal
from fem.ensemble.plan import Ensemble
from fem.ensemble.result import Fragility, Resampled
from fem.ensemble.statistics import PointRow
from fem.ensemble.unknown import UnknownInputs
from fem.figures import style
from fem.figures.heat_map import Panel, draw_heat_map
from fem.runtime.arrays import FloatArray
from fem.sweep.maps import map_axis

#: of the regions; lightness differs as well
COLOURS = {"below": style.SKY, "undecided": "#DDDDDD", "above": style.VERMILLION}
FINE = 240  #: points of a drawn curve
LINE, SMALL_LINE = 92, 104  #: letters of a line above a figure
MOST_NUMBERS = 320  #: cells of a panel up to which each holds its number


def ensemble_figures(
    ensemble: Ensemble, unknown: UnknownInputs, points: Sequence[PointRow], fragility: Fragility | None
) -> dict[str, str]:
    """Figures as SVG documents, by name."""
    with style.house_style():
        if len(ensemble.axes) == 1:
            return {"fragility": style.svg_of(draw_fragility(ensemble, unknown, points, fragility))}
        return {"boundary": style.svg_of(draw_boundary(ensemble, unknown, points))}


def draw_fragility(
    ensemble: Ensemble, unknown: UnknownInputs, points: Sequence[PointRow], fragility: Fragility | None
) -> Figure:
    """Counts with their intervals, and the lognormal curve with its band."""
    statement = fill(_statement(ensemble, unknown), SMALL_LINE)
    figure, (axes,) = style.panels((3.2,), header=3 + statement.count("\n"))
    axis = ensemble.axes[0]
    style.head(figure, ensemble.title or ensemble.name, statement)
    if fragility is not None and (fitted := fragility.lognormal) is not None:
        strengths = np.linspace(float(axis.values[0]), float(axis.values[-1]), FINE)
        curve = Lognormal(median=fitted.median, deviation=fitted.deviation)
        if fitted.resampled is not None:
            low, high = band_of(fitted.resampled, strengths, ensemble.confidence)
            axes.fill_between(
                strengths, low, high, color=style.BLUE, alpha=0.18, linewidth=0, label="bootstrap band"
            )
        word = "lognormal fitted" if fitted.adequate else "lognormal, which does not fit"
        axes.plot(strengths, curve.probability(strengths), color=style.BLUE, linestyle="--", label=word)
    known = [point for point in points if point["probability"] is not None]
    value = np.array([point["probability"] for point in known], dtype=float)
    low = np.array([point["low"] for point in known])
    high = np.array([point["high"] for point in known])
    axes.errorbar(
        [point[axis.key] for point in known],
        value,
        yerr=[np.maximum(value - low, 0.0), np.maximum(high - value, 0.0)],
        color=style.BLACK,
        marker="o",
        markersize=3.0,
        linewidth=0.8,
        capsize=2.0,
        label=f"counted, {100.0 * ensemble.confidence:g} % interval",
    )
    limit = f"{100.0 * ensemble.probability:g} %"
    axes.axhline(ensemble.probability, color=style.GREY, linewidth=0.8, linestyle=":", label=limit)
    axes.set_ylim(-0.02, 1.02)
    axes.margins(x=0.02)
    axes.set_ylabel(f"probability of {falling_in_words(ensemble.limit_slip_m)} [-]")
    axes.set_xlabel(axis_label(axis))
    style.legend_above(axes)
    return figure


def draw_boundary(ensemble: Ensemble, unknown: UnknownInputs, points: Sequence[PointRow]) -> Figure:
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
    x = replace(
        map_axis(across, ensemble.base.name),
        label=f"{axis_label(across)}   (numbers: % that {falling_in_words(ensemble.limit_slip_m, past=True)})",
    )
    return draw_heat_map(
        x,
        map_axis(down, ensemble.base.name),
        maps,
        title=f"{ensemble.title or ensemble.name}\n{fill(_statement(ensemble, unknown), LINE)}",
        colours={words[region]: colour for region, colour in COLOURS.items()},
    )


def band_of(resampled: Resampled, strengths: FloatArray, confidence: float) -> tuple[FloatArray, FloatArray]:
    """Pointwise ends of the bootstrapped curves, shapes (n,)."""
    curves = np.array(
        [
            Lognormal(median=median, deviation=deviation).probability(strengths)
            for median, deviation in zip(resampled.median, resampled.deviation, strict=True)
        ]
    )
    outside = 50.0 * (1.0 - confidence)
    low, high = np.percentile(curves, [outside, 100.0 - outside], axis=0)
    return low, high


def _statement(ensemble: Ensemble, unknown: UnknownInputs) -> str:
    names = ", ".join(
        quantity.key.rpartition(".")[2].removesuffix("_rad").replace("_", " ")
        for quantity in ensemble.random
        if quantity.key != MOTION_FILE
    )
    ranges = f"; {len(unknown.keys)} unknown inputs drawn over their ranges" if unknown.keys else ""
    held = f"; {unknown.held}" if unknown.held else ""
    drawn = f"{ensemble.draws} draws a point ({ensemble.sampling})"
    motions = ensemble.motions
    floor = "not the floor's motion" if motions is None else f"{len(motions.values)} motions equally often"
    return f"{drawn}; random: {names}{ranges}{held}; {floor}"
