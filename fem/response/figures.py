"""Figures of a response curve: amplitudes over frequency, and phase portraits with their sections.

In degrees, mm, Hz. Up and down differ in colour, mark and line, so that they can be distinguished in grey. What is not
valid is marked and not joined.
"""

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.figures import style
from fem.figures.paper_marks import LABEL, marks_of
from fem.response.lasting import PointRecord, coexistences, frequencies_of, lasting_at, of_first_model, shown
from fem.response.request import ResponseRequest
from fem.results.figures import TURNED
from fem.results.outcome import Outcome
from fem.runtime.units import MILLIMETRES

LOOKS: dict[str, dict[str, Any]] = {
    "up": {"color": style.BLUE, "marker": "^", "linestyle": "-"},
    "down": {"color": style.VERMILLION, "marker": "v", "linestyle": "--"},
    "start": {"color": style.PURPLE},
}
SMALL: dict[str, Any] = {"markersize": 3.5, "markeredgewidth": 0.0}
DOTS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 2.6, "markeredgewidth": 0.0}
SHELL: dict[str, Any] = {"color": style.GREEN, "linewidth": 0.9}
PORTRAITS = 5  #: frequencies whose motions are drawn
COLUMNS = 3
FREQUENCY = "frequency of the drive [Hz]"


def response_figures(request: ResponseRequest, records: Sequence[PointRecord]) -> dict[str, str]:
    """Figures as SVG documents, by name."""
    with style.house_style():
        own = of_first_model(records)
        drawn = {"response_curve": draw_curves(request, own, records[len(own) :])} if records else {}
        if any(record.stands for record in own):
            drawn |= {"portraits": _draw_portraits(own)}
        return {name: style.svg_of(figure) for name, figure in drawn.items()}


def draw_curves(
    request: ResponseRequest, records: Sequence[PointRecord], shell: Sequence[PointRecord] = ()
) -> Figure:
    """Largest rotation, share of the starts that fall, slip stroke and decay over frequency, up and down."""
    slides = any(record.number("slip_stroke_m") > MILLIMETRES.least for record in records)
    heights = [2.6, *[0.8] * bool(request.starts), *[1.0] * slides, 1.0]
    figure, panels = style.panels(heights, gaps=(0.12,) * (len(heights) - 1), header=4, below=1.05)
    rotation, life = panels[0], panels[-1]
    drawn = [
        (rotation, TURNED, 1.0, "rotation ratio", 0.01),
        *[(panels[-2], "slip_stroke_m", 1e3, "slip stroke [mm]", 1.0)] * slides,
        (life, "undriven_s", 1.0, "dies out in [s]", 1.0),
    ]
    frequencies = list(frequencies_of(records))
    coexisting = list(coexistences(frequencies))
    title = request.case.title or request.case.name
    style.head(
        figure,
        f"{title}: response over frequency",
        f"{request.held_in_words}; {request.observe} periods judged, after {request.settle} left out"
        + ("; grey: motions coexist" if coexisting else ""),
    )
    for axes, column, factor, label, least in drawn:
        for direction in ("up", "down"):
            look = LOOKS[direction]
            beside = SHELL | {"linestyle": look["linestyle"]}
            for named, drawn_so, of in ((direction, look, records), (f"shell, {direction}", beside, shell)):
                if branch := _swept(of, direction):  # broken where there is no value
                    axes.plot(
                        [record.row.frequency_Hz for record in branch],
                        [factor * record.number(column) for record in branch],
                        label=named,
                        **SMALL | drawn_so,
                    )
        axes.set_ylabel(label)
        axes.set_ylim(0.0, max(axes.get_ylim()[1], least))  # rounding is not to look like motion
    _draw_ends(rotation, records)
    for k, row in enumerate(one.row for one in shown(records) if one.row.direction == "start"):
        mark: dict[str, Any] = {"color": style.PURPLE, "linestyle": "none", "markersize": 5.5}
        label, digit = "_" if k else "from random states: its period", f"${row.period_n or '?'}$"
        rotation.plot(row.frequency_Hz, row.turned, label=label, marker=digit, **mark)
    if request.starts:
        width = 0.5 * (request.last_Hz - request.first_Hz) / request.count
        places = [at.frequency_Hz for at in frequencies]
        shares = [100.0 * (at.fell + at.destroyed) / max(at.starts, 1) for at in frequencies]
        panels[1].bar(places, shares, width=width, color=style.BLACK)
        panels[1].set_ylim(0.0, 100.0)
        panels[1].set_ylabel("starts fall [%]")
    for axes in panels:
        for several in coexisting:
            axes.axvspan(several.from_Hz, several.to_Hz, color="#DDDDDD", alpha=0.6, linewidth=0, zorder=0)
        axes.axvline(request.own_frequency, color=style.GREY, linestyle=":", linewidth=0.8)
        for value in marks_of(request.case.name, "motion.frequency_Hz"):
            label = LABEL if axes is rotation else "_"
            axes.axvline(value, color=style.ORANGE, linestyle="-.", linewidth=0.9, label=label)
        margin = 0.015 * (request.last_Hz - request.first_Hz)
        axes.set_xlim(request.first_Hz - margin, request.last_Hz + margin)
    for axes in panels[:-1]:
        axes.tick_params(labelbottom=False)
    life.set_xlabel(f"{FREQUENCY}; dotted: that of the case, {request.own_frequency:.4g} Hz")
    ratio = (records[0].row.eta or 1.0) / records[0].row.frequency_Hz
    below = life.secondary_xaxis(
        -0.5, functions=(lambda f: np.multiply(f, ratio), lambda eta: np.divide(eta, ratio))
    )
    below.set_xlabel("η = Ω/ω, over the frequency parameter ω of the container")
    style.legend_above(rotation)
    return figure


def _draw_portraits(records: Sequence[PointRecord]) -> Figure:
    """Phase portraits with their sections: all motions that last at a few frequencies."""
    # of most motions first, else evenly over all that move
    groups = {number: lasting_at(records, number) for number in {record.row.number for record in records}}
    moving = sorted(n for n, found in groups.items() if any(group[0].row.turned > 0.01 for group in found))
    moving = moving or sorted(number for number, found in groups.items() if found)
    parts = [part for part in np.array_split(moving, PORTRAITS) if part.size]
    chosen = [int(max(part, key=lambda number: len(groups[int(number)]))) for part in parts]
    rows = -(-len(chosen) // COLUMNS)
    figure = Figure(figsize=(style.WIDTH, 0.6 + 2.3 * rows), layout="constrained")
    figure.suptitle(
        "Phase portraits of the motions that last\n"
        "dots: Poincaré sections, one a period; an impact is a jump of the angular velocity",
        x=0.01,
        ha="left",
        fontsize=10.0,
    )
    subplots = list(figure.subplots(rows, COLUMNS, squeeze=False).flat)
    for axes in subplots[len(chosen) :]:
        axes.set_visible(False)
    for k, (axes, number) in enumerate(zip(subplots, chosen, strict=False)):
        drawn = [group[0] for group in groups[number]]
        for record in sorted(drawn, key=lambda record: -record.row.turned):
            repeats = record.row.long_time in ("periodic", "rest")
            colour = LOOKS[record.row.direction]["color"] if repeats else style.GREY
            axes.plot(*np.degrees(record.portrait).T, color=colour, linewidth=0.9 if repeats else 0.6)
            axes.plot(*np.degrees(record.sections[:, :2]).T, color=style.BLACK, **DOTS)
        row, words = drawn[0].row, fill(" and ".join(record.row.words for record in drawn), width=24)
        axes.set_title(f"{row.frequency_Hz:.3g} Hz, η = {row.eta or 0.0:.3g}\n{words}", fontsize=7.5)
        axes.margins(0.08)
        if k % COLUMNS == 0:
            axes.set_ylabel("angular velocity [deg/s]")
        if k + COLUMNS >= len(chosen):
            axes.set_xlabel("rotation [deg]")
    return figure


def _swept(records: Sequence[PointRecord], direction: str) -> list[PointRecord]:
    """The points of a sweep, rising."""
    swept = [record for record in records if record.row.direction == direction]
    return sorted(swept, key=lambda record: record.row.number)


def _draw_ends(axes: Axes, records: Sequence[PointRecord]) -> None:
    """Where a sweep overturned or destroyed a corner: marks at the upper edge, joined with nothing."""
    look: dict[str, Any] = {"linestyle": "none", "markersize": 5, "markerfacecolor": "none"}
    for direction, height in (("up", 0.97), ("down", 0.91)):
        rows = [record.row for record in _swept(records, direction)]
        look |= {"color": LOOKS[direction]["color"], "transform": axes.get_xaxis_transform()}
        for words, marker, ends in (
            ("overturned", "x", [row.frequency_Hz for row in rows if row.fell]),
            ("a corner destroyed", "s", [row.frequency_Hz for row in rows if row.motion == Outcome.INVALID]),
        ):
            if ends:
                label, heights = f"{direction}: {words}", np.full(len(ends), height)
                axes.plot(ends, heights, marker=marker, label=label, **look)
