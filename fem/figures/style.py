"""The style of all figures and their export as SVG: one palette, and the same bytes for the same numbers.

Drawn through matplotlib's objects, without its global state. Colours are those of Okabe and Ito
(https://jfly.uni-koeln.de/color/), distinguishable by the colour-blind; line styles differ as well, for print in
grey. Units are mm, kN, degrees and s.
"""

import io
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from fem.html.units import rounded
from fem.results.history import History
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray

BLACK, GREY, WHITE = "#222222", "#6E6E6E", "#FFFFFF"
BLUE, VERMILLION, GREEN = "#0072B2", "#D55E00", "#009E73"
ORANGE, SKY, PURPLE = "#E69F00", "#56B4E9", "#CC79A7"
#: of the states of motion; sky and orange, green and purple also differ in brightness
STATE_COLOURS: dict[str, str] = {
    Outcome.REST: "#BBBBBB",
    Outcome.SLIDE: SKY,
    Outcome.HOP: GREEN,
    Outcome.ROCK: ORANGE,
    Outcome.SLIDE_ROCK: PURPLE,
    Outcome.OVERTURNED: BLACK,
    Outcome.INVALID: BLUE,
}
WIDTH = 7.0  #: of a figure [inch], the text width of an A4 page
LEFT, RIGHT, FOOTER = 0.8, 0.15, 0.45  #: margins [inch]
GAP, LEGEND_GAP = 0.1, 0.3  #: between panels, without and with a legend [inch]
COORDINATE = re.compile(r"(?<=\.\d\d)\d+")  #: digits beyond a hundredth of a point
LINE = 0.21  #: height of a line of text above the panels [inch]
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",  # text stays text: small, searchable
    "svg.hashsalt": "unanchored",
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # not searched for
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.labelcolor": BLACK,
    "axes.formatter.useoffset": False,
    "axes.xmargin": 0.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "legend.columnspacing": 1.4,
    "legend.handlelength": 2.2,
    "hatch.linewidth": 0.6,
    "text.color": BLACK,
    "xtick.color": BLACK,
    "ytick.color": BLACK,
}
TIME = "time [s]"
PLANE = "plane"
#: share of the slenderness angle, or of the energy to overturn, from which that limit is drawn to scale
NEAR_LIMIT = 0.15
STRETCHES = 800  #: of a long curve, each drawn by its extremes: finer than print


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in this style, whatever the user's settings of matplotlib."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


def panels(
    heights: Sequence[float],
    *,
    gaps: Sequence[float] = (),
    header: int = 2,
    width: float = WIDTH,
    above: float = 0.0,
    below: float = FOOTER,
) -> tuple[Figure, list[Axes]]:
    """A figure of panels of equal width, one below the other, at fixed positions.

    Args:
        heights: of the panels [inch], downwards.
        gaps: between them [inch].
        header: lines of text above the first panel, title included.
        width: of the figure [inch].
        above: space between header and first panel, for other panels [inch].
        below: space under the last panel, for its labels [inch].
    """
    gaps = gaps or [GAP] * (len(heights) - 1)
    tall = 0.08 + header * LINE + above + sum(heights) + sum(gaps) + below
    figure = Figure(figsize=(width, tall))
    axes, top = [], tall - 0.08 - header * LINE - above
    for height, gap in zip(heights, [*gaps, 0.0], strict=True):
        box = (LEFT / width, (top - height) / tall, (width - LEFT - RIGHT) / width, height / tall)
        axes.append(figure.add_axes(box))
        axes[-1].yaxis.set_label_coords(-0.62 / (width - LEFT - RIGHT), 0.5)
        top -= height + gap
    return figure, axes


def time_panels(
    heights: Sequence[float],
    *,
    history: History | None = None,
    gaps: Sequence[float] = (),
    header: int = 2,
    above: float = 0.0,
) -> tuple[Figure, list[Axes]]:
    """Panels over a common time axis.

    Args:
        heights: of the panels [inch], downwards.
        history: its states of motion are drawn in a low panel below the others; None draws none.
        gaps: between the panels [inch].
        header: lines of text above the first panel.
        above: space between header and first panel [inch].

    Returns:
        The figure and its panels, without that of the states.
    """
    states = [] if history is None else [state for state in Outcome if state in set(history.modes)]
    rows = [*heights, *([0.06 + 0.14 * len(states)] if states else [])]
    spaces = [*(gaps or [GAP] * (len(heights) - 1)), *([GAP] if states else [])]
    figure, axes = panels(rows, gaps=spaces, header=header, above=above)
    for upper in axes[:-1]:
        upper.sharex(axes[-1])
        upper.tick_params(labelbottom=False)
    axes[-1].set_xlabel(TIME)
    for panel in axes[: len(heights)]:
        panel.set_label(TIME)  # for `cursor_axes`
    if history is not None and states:
        _draw_states(axes[-1], history["time_s"], history.modes, states)
    return figure, axes[: len(heights)]


def curve_panel(
    axes: Axes,
    label: str,
    time: FloatArray,
    *curves: tuple[FloatArray, str, str, str | None],
    zero: bool = True,
    **style: Any,
) -> None:
    """Draw curves over time into a panel.

    Args:
        label: of the vertical axis, with the unit.
        time: of the samples, shape (n,) [s].
        curves: values (n,), colour, line style, and name in the legend.
        zero: draw a line at zero.
        style: of all curves.
    """
    axes.set_ylabel(label)
    if zero:
        zero_line(axes)
    for values, colour, line, name in curves:
        samples = kept_samples(values)
        axes.plot(time[samples], values[samples], color=colour, linestyle=line, label=name, **style)


def head(figure: Figure, title: str, statement: str = "", *, status: str = "completed") -> None:
    """Title, with the status of an unfinished run, and below it a statement in smaller letters."""
    title = title if status in ("completed", "overturned") else f"{title} ({status})"
    width, height = figure.get_size_inches()
    for row, (text, size, colour) in enumerate(((title, 10.0, BLACK), (statement, 8.0, GREY))):
        if text:
            position = (LEFT / width, 1.0 - (0.06 + row * LINE) / height)
            figure.text(*position, text, fontsize=size, color=colour, va="top")


def legend_above(axes: Axes, columns: int = 4) -> None:
    """Legend above a panel, where it hides nothing."""
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.1, handlelength=2.4
    )


def spectrum_axes(axes: Axes) -> None:
    """Logarithmic periods with plain numbers, and ordinates from zero."""
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: rounded(value)))
    axes.set_ylim(bottom=0.0)


def _draw_states(axes: Axes, time: FloatArray, modes: Sequence[str], states: Sequence[str]) -> None:
    """One row for each state, filled while the container is in it; a state of one sample is visible."""
    names = np.asarray(modes)
    ends = np.append(time[1:], time[-1])
    for row, state in enumerate(states):
        inside = np.concatenate([[False], names == state, [False]])
        first, last = np.flatnonzero(~inside[:-1] & inside[1:]), np.flatnonzero(inside[:-1] & ~inside[1:])
        gap, spans = float(time[-1] - time[0]) / STRETCHES, list[list[float]]()
        for start, end in zip(time[first].tolist(), ends[last - 1].tolist(), strict=True):
            if spans and start - spans[-1][1] < gap:
                spans[-1][1] = end  # closer than can be seen
            else:
                spans.append([start, end])
        drawn = [(start, max(end - start, gap)) for start, end in spans]
        axes.broken_barh(drawn, (row - 0.4, 0.8), color=STATE_COLOURS[state], linewidth=0)
    axes.set_yticks(range(len(states)), states, fontsize=8)
    axes.set_ylim(len(states) - 0.45, -0.55)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")


def kept_samples(*columns: FloatArray) -> NDArray[np.int64]:
    """Indices of samples that draw the same curves: the ends and the extremes of each column in every stretch.

    No peak is lost, and only true samples are drawn. Short columns are kept whole.
    """
    count = len(columns[0])
    length = -(-count // STRETCHES)
    if length <= 2 + 2 * len(columns):
        return np.arange(count)
    starts = np.arange(0, count, length)
    indices = [starts, np.minimum(starts + length, count) - 1]
    for column in columns:
        padded = np.full(len(starts) * length, column[-1])
        padded[:count] = column
        stretches = np.nan_to_num(padded).reshape(len(starts), length)
        indices += [starts + stretches.argmin(axis=1), starts + stretches.argmax(axis=1)]
    return np.unique(np.minimum(np.concatenate(indices), count - 1))


def draw_limits(
    axes: Axes,
    limits: Sequence[float],
    label: str,
    linestyle: str,
    *,
    colour: str = BLACK,
    of_weight: tuple[FloatArray, FloatArray] | None = None,
) -> None:
    """Lines at limits, with one entry in the legend.

    Args:
        of_weight: times and share (g + a_v)/g, where the limits follow a weight that changes.
    """
    look: dict[str, Any] = {"color": colour, "linestyle": linestyle, "linewidth": 0.9}
    for k, limit in enumerate(limits):
        name = label if k == 0 else None
        if of_weight is None:
            axes.axhline(limit, label=name, **look)
        else:
            axes.plot(of_weight[0], limit * of_weight[1], label=name, **look)


def mark_instant(axes: Axes, what: str, instant: float | None) -> None:
    """A line at an instant [s], with its time in the legend; none where there is none."""
    if instant is not None:
        label = f"{what}, {instant:.3f} s"
        axes.axvline(instant, color=GREY, linestyle=(0, (1, 2)), linewidth=1.0, label=label)


def changing_weight(history: History, gravity: float) -> tuple[FloatArray, FloatArray] | None:
    """Times [s] and share (g + a_v)/g of a floor that moves up and down; None of any other."""
    if not history.vertical:
        return None
    return history["time_s"], 1.0 + history["base_vertical_acceleration_m_s2"] / gravity


def zero_line(axes: Axes) -> None:
    """A thin line at zero."""
    axes.axhline(0.0, color=GREY, linewidth=0.7)


def keep_visible(axes: Axes, least: float) -> None:
    """Extend the vertical axis to at least ± least, so that rounding does not look like motion."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -least), max(high, least))


def svg_of(figure: Figure) -> str:
    """A figure, drawn in the house style, as an SVG document; the same bytes for the same drawing."""
    stream = io.StringIO()
    with house_style():
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return re.sub(r' d="[^"]*"', lambda path: COORDINATE.sub("", path[0]), stream.getvalue())


def cursor_axes(figure: Figure) -> dict[str, Any] | None:
    """Axes over which a cursor moves, as shares of the figure's width and height from the lower left; None without.

    Reads the labels of the axes: `TIME`, or `PLANE` for the phase portrait. Call it after `svg_of`, which lays the
    figure out. A cursor over time spans all panels over time.
    """
    over_time = [axes for axes in figure.axes if axes.get_label() == TIME]
    chosen = over_time or [axes for axes in figure.axes if axes.get_label() == PLANE]
    if not chosen:
        return None
    boxes = [axes.get_position() for axes in chosen]
    area = {
        "kind": "time" if over_time else "plane",
        "left": boxes[0].x0,
        "right": boxes[0].x1,
        "top": max(box.y1 for box in boxes),
        "bottom": min(box.y0 for box in boxes),
        "x": list(chosen[0].get_xlim()),
    }
    if over_time:
        return area
    return area | {
        "y": list(chosen[0].get_ylim()),
        "horizontal": "rotation",  # by the names that the player of a report gives them
        "vertical": "rate",
        "factors": [math.degrees(1.0)] * 2,  # from SI units to those of the axes
    }
