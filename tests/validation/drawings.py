"""Figures of measured beside predicted."""

from collections.abc import Sequence

import numpy as np
from evidence.pages import Picture
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from validation.shake_tests import ShakeTest
from validation.vote import BoolArray

from fem.figures.style import BLUE, GREY, VERMILLION, WIDTH, house_style, svg_of
from fem.records.units import STANDARD_GRAVITY
from fem.runtime.arrays import FloatArray

HEIGHT = 3.6  #: [inch]
Curve = tuple[FloatArray, FloatArray]


def shaken(name: str, tests: Sequence[ShakeTest], probability: FloatArray, overturned: BoolArray) -> Picture:
    """Outcomes over the strength of the motions, wrong predictions with their probability of overturning."""
    peak = np.array([test.peak for test in tests])
    length = np.array([test.peak_velocity for test in tests]) / (STANDARD_GRAVITY * peak)
    wrong = (probability > 0.5) != overturned
    with house_style():
        figure, axes = _axes("peak acceleration [g]", "peak velocity over peak acceleration [s]")
        _outcomes(axes, peak, length, overturned)
        axes.plot(
            peak[wrong], length[wrong], "o", color=VERMILLION, mfc="none", ms=11, label="predicted wrongly"
        )
        for x, y, chance in zip(peak[wrong], length[wrong], probability[wrong], strict=True):
            axes.annotate(f"{chance:.2f}", (x, y), xytext=(7, 4), textcoords="offset points", fontsize=7.0)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(0.06)
        figure.legend(loc="outside lower center", ncols=3)
    caption = (
        f"{name}: outcomes over the motion of the table; a number is the predicted probability of overturning"
    )
    return Picture(name=f"shaken_{name.replace(' ', '_')}", caption=caption, svg=svg_of(figure))


def landed(toss: int, measured: Curve, predicted: Curve) -> Picture:
    """Tilt of a landing, degrees over seconds."""
    with house_style():
        figure, axes = _axes("time [s]", "tilt [degrees]")
        axes.plot(*measured, "o", color=GREY, ms=3.5, label="measured")
        axes.plot(*predicted, "-", color=BLUE, label="predicted")
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        figure.legend(loc="outside lower center", ncols=2)
    caption = f"Landing {toss}: tilt from the face on which the cube comes to rest"
    return Picture(name=f"landing_{toss}", caption=caption, svg=svg_of(figure))


def kicked(
    gaps: FloatArray, speeds: FloatArray, falls: BoolArray, tests: Curve, overturned: BoolArray
) -> Picture:
    """Where the fitted block overturns, over gap and speed (speeds, gaps), and the tests."""
    with house_style():
        figure, axes = _axes("gap [mm]", "speed of the base [m/s]")
        axes.contourf(1e3 * gaps, speeds, falls.astype(float), levels=[0.5, 1.5], colors=["#CFE3F1"])
        _outcomes(axes, 1e3 * tests[0], tests[1], overturned)
        axes.plot([], [], "s", color="#CFE3F1", ms=9, label="overturns, predicted")
        axes.margins(0.04)
        figure.legend(loc="outside lower center", ncols=3)
    caption = "The kicked block: where the block fitted to all tests overturns, and the tests"
    return Picture(name="kicked", caption=caption, svg=svg_of(figure))


def _axes(across: str, up: str) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
    return figure, figure.add_subplot(xlabel=across, ylabel=up)


def _outcomes(axes: Axes, x: FloatArray, y: FloatArray, overturned: BoolArray) -> None:
    axes.plot(x[overturned], y[overturned], "x", color="black", ms=5.5, label="overturned")
    axes.plot(x[~overturned], y[~overturned], "o", color=BLUE, mfc="white", ms=4.5, label="stood")
