"""Figures of recorded motions: acceleration, velocity, displacement and response spectrum; the spectra of a set."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.case.case import CaseError
from fem.case.recorded import MotionKey, recorded_motion
from fem.figures import style
from fem.html.units import rounded
from fem.records.processing import motion_of
from fem.records.record import Component
from fem.records.spectrum import evenly_sampled, log_spaced_periods, response_spectrum
from fem.results.reader import RunData
from fem.runtime.arrays import FloatArray

COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.ORANGE, style.SKY, style.PURPLE, style.GREY)
LINES = ("-", "--", ":", "-.")
MOST_NAMED = 8  #: motions that the legend names
NAMES_A_LINE = 3
MOST_DRAWN = 100  #: motions that have a line each; fractiles of more


def draw_spectra(
    periods: FloatArray, spectra: Mapping[str, FloatArray], *, vertical: Sequence[str] = ()
) -> Figure:
    """Pseudo-acceleration spectra for 5 % of damping, and their mean; of many motions their fractiles.

    Args:
        periods: (k,) [s].
        spectra: (k,) each [m/s2], by file.
        vertical: files of vertical motions, which have a panel below the horizontal ones.
    """
    groups = [("horizontal", [name for name in spectra if name not in vertical])]
    if vertical:
        groups.append(("vertical", list(vertical)))
    with style.house_style():
        named = (  # each motion, or three fractiles of many, and their mean
            (count if count <= MOST_NAMED else 3 * (count > MOST_DRAWN)) + (count > 1)
            for count in (len(names) for _, names in groups)
        )
        lines = -(-max(named) // NAMES_A_LINE)
        gaps = [0.35 + style.LINE * lines] * (len(groups) - 1)
        figure, axes = style.panels([2.6] * len(groups), gaps=gaps, header=2 + lines)
        style.head(figure, "Response spectra of the motions", "pseudo-acceleration, 5 % damping")
        for panel, (direction, names) in zip(axes, groups, strict=True):
            if len(names) > MOST_DRAWN:
                _draw_fractiles(panel, periods, np.array([spectra[name] for name in names]))
            for k, name in enumerate(names if len(names) <= MOST_DRAWN else ()):
                label = name if len(names) <= MOST_NAMED else None
                colour, line = COLOURS[k % len(COLOURS)], LINES[k // len(COLOURS) % len(LINES)]
                panel.plot(periods, spectra[name], color=colour, linestyle=line, linewidth=0.8, label=label)
            if len(names) > 1:
                mean = np.mean([spectra[name] for name in names], axis=0)
                panel.plot(periods, mean, color=style.BLACK, linewidth=1.8, label=f"mean of {len(names)}")
            style.spectrum_axes(panel)
            panel.set_ylabel(f"{direction} [m/s²]")
            if lines:
                style.legend_above(panel, NAMES_A_LINE)
        axes[-1].set_xlabel("period [s]")
        return figure


def _draw_fractiles(panel: Axes, periods: FloatArray, spectra: FloatArray) -> None:
    """Bands of spectra (n, k) that hold all motions, and those from 16 to 84 %; the median."""
    low, middle, high = np.quantile(spectra, (0.16, 0.5, 0.84), axis=0)
    look: dict[str, Any] = {"color": style.BLUE, "linewidth": 0.0}
    panel.fill_between(periods, spectra.min(axis=0), spectra.max(axis=0), alpha=0.15, label="all", **look)
    panel.fill_between(periods, low, high, alpha=0.35, label="16 to 84 %", **look)
    panel.plot(periods, middle, color=style.BLUE, linewidth=1.2, label="median")


DAMPED = "pseudo-acceleration, 5 % of critical damping"


def spectrum_of(component: Component) -> tuple[FloatArray, FloatArray]:
    """Periods (k,) [s] and pseudo-accelerations (k,) [m/s2] of a processed component, for 5 % of damping.

    From what its samples resolve up to 4 s.
    """
    step, values = evenly_sampled(component.times, motion_of(component)[2])
    periods = log_spaced_periods(component.step)
    return periods, response_spectrum(step, values, periods)


def spectrum_figure(run: RunData) -> Figure | None:
    """Response spectra of the records that move the floor of a run; None where none does, or its file is gone."""
    case = run.case
    tables: dict[MotionKey, str] = {"motion": "along x", "vertical": "upward"}
    try:
        curves = [
            (name, recorded_motion(case, table).motion)
            for table, name in tables.items()
            if getattr(case, table).kind == "table"
        ]
    except CaseError:
        return None
    if not curves:
        return None
    figure, (axes,) = style.panels((2.4,), header=2 + (len(curves) > 1))
    _draw_spectra(axes, curves)
    periods, largest = _largest(curves[0][1])
    style.head(
        figure,
        f"Response spectrum of the floor's motion: {rounded(largest)} m/s² at {rounded(periods)} s",
        DAMPED,
    )
    return figure


def record_figure(components: Sequence[Component], title: str) -> Figure:
    """Acceleration, velocity and displacement of processed components over time, and their response spectra.

    Args:
        components: three at most; those of one record lie over each other.
        title: such as the name of the file.
    """
    named = [(component.name or component.direction or "", component) for component in components]
    with style.house_style():
        figure, axes = style.panels((1.3, 1.3, 1.3, 2.2), gaps=(0.1, 0.1, 0.75), header=2 + (len(named) > 1))
        for k, (name, component) in enumerate(named):
            displacement, velocity, acceleration = motion_of(component)
            for panel, label, values in (
                (axes[0], "acceleration [m/s²]", acceleration),
                (axes[1], "velocity [m/s]", velocity),
                (axes[2], "displacement [mm]", 1e3 * displacement),
            ):
                shown = name if panel is axes[0] and len(named) > 1 else None
                style.curve_panel(
                    panel, label, component.times, (values, COLOURS[k], "-", shown), zero=k == 0
                )
        for panel in axes[:2]:
            panel.tick_params(labelbottom=False)
        axes[2].set_xlabel(style.TIME)
        _draw_spectra(axes[3], named)
        if len(named) > 1:
            style.legend_above(axes[0])
        first = components[0]
        peak = float(np.abs(motion_of(first)[2]).max())
        statement = f"{first.times.size} samples of {rounded(first.step)} s; below: {DAMPED}"
        style.head(figure, f"{title}: {rounded(peak)} m/s² at most", statement)
        return figure


def _largest(component: Component) -> tuple[float, float]:
    periods, spectrum = spectrum_of(component)
    at = int(np.argmax(spectrum))
    return float(periods[at]), float(spectrum[at])


def _draw_spectra(axes: Axes, named: Sequence[tuple[str, Component]]) -> None:
    for k, (name, component) in enumerate(named):
        label = name if len(named) > 1 else None
        axes.plot(*spectrum_of(component), color=COLOURS[k], linestyle=LINES[k], label=label)
    style.spectrum_axes(axes)
    axes.set_ylabel("spectrum [m/s²]")
    axes.set_xlabel("period [s]")
    if len(named) > 1:
        style.legend_above(axes)
