"""The response spectra of a set of motions, and their mean or fractiles."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.figures import style
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
    panel.fill_between(
        periods,
        spectra.min(axis=0),
        spectra.max(axis=0),
        color=style.BLUE,
        alpha=0.15,
        linewidth=0.0,
        label="all",
    )
    panel.fill_between(periods, low, high, color=style.BLUE, alpha=0.35, linewidth=0.0, label="16 to 84 %")
    panel.plot(periods, middle, color=style.BLUE, linewidth=1.2, label="median")
