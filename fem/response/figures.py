"""Figures of a response curve: amplitudes over frequency, sections over frequency, phase portraits.

In degrees, mm, Hz. Up and down differ in colour, mark and line, so that they can be distinguished in grey.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.figures import style
from fem.response.branches import coexistences
from fem.response.records import PointRecord
from fem.response.request import ResponseRequest

LOOKS = {
    "up": {"color": style.BLUE, "marker": "^", "linestyle": "-"},
    "down": {"color": style.VERMILLION, "marker": "v", "linestyle": "--"},
}
PORTRAITS = 6  #: of the most different motions
COLUMNS = 3
FREQUENCY = "frequency of the drive [Hz]"


def response_figures(request: ResponseRequest, records: Sequence[PointRecord]) -> dict[str, str]:
    """Figures as SVG documents, by name."""
    with style.house_style():
        drawn = {"response_curve": draw_curves(request, records)}
        if any(record.stands for record in records):
            drawn |= {"sections": draw_sections(request, records), "portraits": draw_portraits(records)}
        return {name: style.svg_of(figure) for name, figure in drawn.items()}


def draw_curves(request: ResponseRequest, records: Sequence[PointRecord]) -> Figure:
    """Largest rotation and slip stroke over frequency, up and down."""
    figure, (rotation, slip, life) = style.panels((2.4, 1.2, 1.2), gaps=(0.12, 0.12), header=3)
    style.head(
        figure,
        f"{request.case.title or request.case.name}: frequency swept, the motion carried on",
        statement_of(request, records),
    )
    for direction in LOOKS:
        swept = sorted(
            (record for record in records if record.row.direction == direction),
            key=lambda record: record.row.number,
        )
        _draw_branch(rotation, swept, direction, "max_rotation_rad", 180.0 / np.pi)
        _draw_branch(slip, swept, direction, "slip_stroke_m", 1e3)
        _draw_branch(life, swept, direction, "undriven_s", 1.0)
        fallen = [record.row.frequency_Hz for record in swept if record.row.status == "overturned"]
        height = 0.97 if direction == "up" else 0.92
        rotation.plot(
            fallen,
            np.full(len(fallen), height),
            linestyle="none",
            marker="x",
            markersize=5,
            color=LOOKS[direction]["color"],
            transform=rotation.get_xaxis_transform(),
            label=f"{direction}: overturned" if fallen else None,
        )
    for pair in coexistences(records):
        for axes in (rotation, slip, life):
            axes.axvspan(pair.from_Hz, pair.to_Hz, color="#DDDDDD", alpha=0.6, linewidth=0, zorder=0)
    for axes, label, least in (
        (rotation, "largest rotation [deg]", 0.1),
        (slip, "slip stroke [mm]", 1.0),
        (life, "dies out in [s]", 1.0),
    ):
        axes.set_ylabel(label)
        axes.set_ylim(0.0, max(axes.get_ylim()[1], least))  # rounding is not to look like motion
        _frequency_axis(axes, request)
    for axes in (rotation, slip):
        axes.tick_params(labelbottom=False)
    life.set_xlabel(FREQUENCY)
    style.legend_above(rotation)
    return figure


def draw_sections(request: ResponseRequest, records: Sequence[PointRecord]) -> Figure:
    """Rotation at the sections over frequency: n dots for a motion of period n, a smear for one without period."""
    figure, (up, down) = style.panels((2.0, 2.0), gaps=(0.12,), header=2)
    style.head(
        figure,
        "Poincaré sections: rotation at the instant at which the floor turns back at +A",
        "n dots belong to a motion that repeats after n periods of the drive, a smear to one that does not repeat",
    )
    for axes, direction in ((up, "up"), (down, "down")):
        standing = [record for record in records if record.row.direction == direction and record.stands]
        for record in standing:
            turned = np.degrees(record.sections[:, 0])
            axes.plot(
                np.full(turned.size, record.row.frequency_Hz),
                turned,
                linestyle="none",
                marker="o",
                markersize=2.2,
                markeredgewidth=0.0,
                color=LOOKS[direction]["color"],
            )
        axes.set_ylabel(f"{direction}: rotation [deg]")
        _frequency_axis(axes, request)
    up.tick_params(labelbottom=False)
    up.sharey(down)
    up.autoscale(axis="y")
    down.set_xlabel(FREQUENCY)
    return figure


def draw_portraits(records: Sequence[PointRecord]) -> Figure:
    """Phase portraits of motions that differ the most, with their sections."""
    chosen = choose_portraits(records)
    rows = -(-len(chosen) // COLUMNS)
    figure = Figure(figsize=(style.WIDTH, 0.6 + 2.3 * rows), layout="constrained")
    figure.suptitle(
        "Phase portraits of the long-time motion\n"
        "dots: Poincaré sections, one a period; an impact is a jump of the angular velocity",
        x=0.01,
        ha="left",
        fontsize=10.0,
    )
    subplots = list(figure.subplots(rows, COLUMNS, squeeze=False).flat)
    for axes in subplots[len(chosen) :]:
        axes.set_visible(False)
    for k, (axes, record) in enumerate(zip(subplots, chosen, strict=False)):
        _draw_portrait(axes, record)
        if k % COLUMNS == 0:
            axes.set_ylabel("angular velocity [deg/s]")
        if k + COLUMNS >= len(chosen):
            axes.set_xlabel("rotation [deg]")
    return figure


def choose_portraits(records: Sequence[PointRecord]) -> list[PointRecord]:
    """A few motions: one of each kind there is, the largest first, then those in between."""
    standing = [record for record in records if record.stands and record.row.long_time != "rest"]
    standing = standing or [record for record in records if record.stands]
    by_size = sorted(standing, key=lambda record: -record.row.turned)
    kinds: dict[str, PointRecord] = {}
    for record in by_size:
        kinds.setdefault(record.row.words, record)
    chosen = list(kinds.values())[:PORTRAITS]
    for share in np.linspace(0.0, 1.0, PORTRAITS):
        candidate = by_size[round(share * (len(by_size) - 1))]
        if len(chosen) < PORTRAITS and all(candidate is not picked for picked in chosen):
            chosen.append(candidate)
    return sorted(chosen, key=lambda record: (record.row.frequency_Hz, record.row.direction))


def statement_of(request: ResponseRequest, records: Sequence[PointRecord]) -> str:
    """What is held and how the motion is judged, for the head of a figure."""
    grey = "; grey: up and down differ" if coexistences(records) else ""
    return f"{request.held_in_words}; {request.observe} periods judged, after {request.settle} left out{grey}"


def _draw_branch(
    axes: Axes, swept: Sequence[PointRecord], direction: str, column: str, factor: float
) -> None:
    """A line with marks, broken where there is no value."""
    numbers = [factor * record.number(column) for record in swept]
    frequencies = [record.row.frequency_Hz for record in swept]
    axes.plot(frequencies, numbers, label=direction, markersize=3.5, markeredgewidth=0.0, **LOOKS[direction])  # type: ignore[arg-type]


def _draw_portrait(axes: Axes, record: PointRecord) -> None:
    row, look = record.row, LOOKS[record.row.direction]
    rotation, rate = np.degrees(record.portrait).T
    repeats = row.long_time in ("periodic", "rest")
    axes.plot(
        rotation, rate, color=look["color"] if repeats else style.GREY, linewidth=0.9 if repeats else 0.6
    )
    turned, turning = np.degrees(record.sections[:, :2]).T
    axes.plot(
        turned, turning, linestyle="none", marker="o", markersize=2.6, markeredgewidth=0.0, color=style.BLACK
    )
    axes.set_title(f"{row.frequency_Hz:.3g} Hz, {row.direction}: {row.words}", fontsize=7.5)
    axes.margins(0.08)


def _frequency_axis(axes: Axes, request: ResponseRequest) -> None:
    if request.scale == "log":
        axes.set_xscale("log")
    margin = 0.015 * (request.last_Hz - request.first_Hz)
    low = request.first_Hz / 1.03 if request.scale == "log" else request.first_Hz - margin
    axes.set_xlim(low, request.last_Hz * 1.03 if request.scale == "log" else request.last_Hz + margin)
