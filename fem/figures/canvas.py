"""Figures of curves, bars and marks over straight axes: what matplotlib draws, drawn straight as SVG.

`Canvas` and `Chart` offer the part of the interface of matplotlib's `Figure` and `Axes` that the figures of a run
use, with the same names, defaults and meaning, so that the same function draws on either. With matplotlib, the figures
of a run take ten times as long. Lengths are in points, y upwards; `fem.figures.svg` writes them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.figures.scale import FONT, MARGIN, Scale
from fem.runtime.arrays import FloatArray

POINTS = 72.0  #: in an inch
LEGEND_FONT = 8.0
TEXT = "#222222"
ENDLESS = math.inf
LINES = {"-": (), "--": (3.7, 1.6), ":": (1.0, 1.65), "-.": (6.4, 1.6, 1.0, 1.6)}
MARKERS = frozenset("oxs^v|")

Dash = str | tuple[float, tuple[float, ...]]


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A line through points, marks at points, or a line across a panel."""

    x: FloatArray  #: shape (n,); not finite: the line reaches across the panel
    y: FloatArray
    colour: str
    dashes: tuple[float, ...] | None  #: over the width of the line; empty: solid; None: no line
    width: float
    label: str
    marker: str = ""
    marker_size: float = 6.0
    marker_edge: str = ""  #: colour; empty: that of the line
    marker_edge_width: float = 1.0
    hollow: bool = False
    clipped: bool = True


@dataclass(frozen=True, kw_only=True, eq=False)
class Area:
    """Filled polygons of one colour."""

    polygons: list[FloatArray]  #: shape (n, 2) each
    label: str = ""
    colour: str = ""
    edge_width: float = 0.0  #: in the same colour
    last: bool = False  #: in the legend


@dataclass(frozen=True, kw_only=True)
class Words:
    """A text at a place of the figure, as shares of its width and height."""

    x: float
    y: float
    text: str
    size: float
    colour: str


@dataclass(frozen=True, kw_only=True)
class Extent:
    """A rectangle as shares of the figure's width and height, from the lower left."""

    x0: float
    y0: float
    x1: float
    y1: float


@dataclass(frozen=True, kw_only=True)
class Legend:
    """Place of a legend over a panel, as shares of the panel, and its columns."""

    anchor: tuple[float, float]
    columns: int
    pad: float  #: around it, over its font
    handle: float  #: length of a line in it, over its font


class Chart:
    """Axes in a rectangle of a figure, as shares of its width and height: left, bottom, width, height."""

    def __init__(self, canvas: "Canvas", place: tuple[float, float, float, float]) -> None:
        wide, tall = canvas.get_size_inches()
        self._canvas, self.place = canvas, place
        self.xaxis = Scale(extent=POINTS * wide * place[2], aspect=3.0, margin=0.0)
        self.yaxis = Scale(extent=POINTS * tall * place[3], aspect=2.0, margin=MARGIN)
        self.artists: list[Curve | Area] = []
        self.legend_place: Legend | None = None
        self.title: tuple[str, float, float, str] | None = None  #: text, font, gap below, "left" or "center"
        self.framed, self._equal, self._name = True, False, ""

    @property
    def lines(self) -> list[Curve]:
        return [one for one in self.artists if isinstance(one, Curve)]

    @property
    def areas(self) -> list[Area]:
        return [one for one in self.artists if isinstance(one, Area)]

    def plot(
        self, *values: Any, color: str = TEXT, linestyle: Dash = "-", linewidth: float = 1.1,
        label: str | None = None, marker: str = "", markersize: float = 6.0, markeredgecolor: str = "",
        markeredgewidth: float = 1.0, fillstyle: str = "full", clip_on: bool = True,
    ) -> None:  # fmt: skip
        """A line through x and y, or marks there.

        Args:
            values: x, y and, if given, a marker, or a line style in place of `linestyle`; a blank draws nothing but an
                entry of the legend.
        """
        style = values[2] if len(values) > 2 else ""
        x, y = (np.atleast_1d(np.asarray(one, dtype=np.float64)) for one in values[:2])
        if style in MARKERS:
            marker, linestyle = style, "none"
        elif style:
            linestyle = style
        self._draw(
            Curve(
                x=x, y=y, colour=color, dashes=_dashes(linestyle), width=linewidth,
                label=_named(label), marker=marker, marker_size=markersize, marker_edge=markeredgecolor,
                marker_edge_width=markeredgewidth, hollow=fillstyle == "none", clipped=clip_on,
            ),
            x,
            y,
        )  # fmt: skip

    def axhline(
        self, y: float, *, color: str, linestyle: Dash = "-", linewidth: float = 1.1, label: str | None = None
    ) -> None:
        """A line across the panel at a height."""
        self._across(np.array([-ENDLESS, ENDLESS]), np.full(2, y), color, linestyle, linewidth, label)

    def axvline(
        self, x: float, *, color: str, linestyle: Dash = "-", linewidth: float = 1.1, label: str | None = None
    ) -> None:
        """A line up the panel at a place along x."""
        self._across(np.full(2, x), np.array([-ENDLESS, ENDLESS]), color, linestyle, linewidth, label)

    def fill_between(
        self, x: FloatArray, y: FloatArray, *, color: str, linewidth: float, label: str | None = None
    ) -> None:
        """The area between a curve and zero."""
        polygon = np.column_stack([np.concatenate([x, x[::-1]]), np.concatenate([y, np.zeros(len(x))])])
        self._fill(Area(polygons=[polygon], colour=color, edge_width=linewidth, label=_named(label)))

    def barh(
        self, y: NDArray[Any], width: NDArray[Any], *, left: NDArray[Any], height: float, color: str,
        linewidth: float, label: str | None = None,
    ) -> None:  # fmt: skip
        """Bars along x."""
        bars = [
            _rectangle(x, at - 0.5 * height, wide, height) for at, x, wide in zip(y, left, width, strict=True)
        ]
        self.xaxis.sticky.append(np.asarray(left))
        self._fill(Area(polygons=bars, colour=color, edge_width=linewidth, label=_named(label), last=True))

    def broken_barh(
        self, spans: Sequence[tuple[float, float]], rows: tuple[float, float], *, color: str, linewidth: float
    ) -> None:
        """Bars along x in one row; a span is a start and a length, and so is the row."""
        bars = [_rectangle(start, rows[0], length, rows[1]) for start, length in spans]
        self._fill(Area(polygons=bars, colour=color, edge_width=linewidth))

    def legend(
        self, *, loc: str = "lower left", bbox_to_anchor: tuple[float, float], ncols: int, borderaxespad: float,
        handlelength: float = 2.2,
    ) -> None:  # fmt: skip
        """A legend whose lower left corner is at a place of the panel."""
        self.legend_place = Legend(
            anchor=bbox_to_anchor, columns=ncols, pad=borderaxespad, handle=handlelength
        )

    def get_legend_handles_labels(self) -> tuple[list[Curve | Area], list[str]]:
        """What a legend shows: in the order of drawing, bars last."""
        shown = sorted(
            (one for one in self.artists if one.label), key=lambda one: getattr(one, "last", False)
        )
        return shown, [one.label for one in shown]

    def set_title(self, text: str, *, fontsize: float, pad: float, loc: str = "left") -> None:
        self.title = text, fontsize, pad, loc

    def set_xlabel(self, text: str) -> None:
        self.xaxis.label = text

    def get_xlabel(self) -> str:
        return self.xaxis.label

    def set_ylabel(self, text: str) -> None:
        self.yaxis.label = text

    def get_ylabel(self) -> str:
        return self.yaxis.label

    def set_label(self, name: str) -> None:
        self._name = name

    def get_label(self) -> str:
        return self._name

    def set_xlim(self, left: float | None = None, right: float | None = None) -> None:
        self.xaxis.limit(left, right)

    def get_xlim(self) -> tuple[float, float]:
        return self.xaxis.view()

    def set_ylim(self, bottom: float | None = None, top: float | None = None) -> None:
        self.yaxis.limit(bottom, top)

    def get_ylim(self) -> tuple[float, float]:
        return self.yaxis.view()

    def margins(self, *, x: float) -> None:
        """Beside what is drawn, over its width."""
        self.xaxis.margin = x

    def set_xscale(self, kind: str) -> None:
        self.xaxis.logarithmic = kind == "log"

    def set_xticks(self, places: Sequence[float], labels: Sequence[str], *, fontsize: float = FONT) -> None:
        self.xaxis.set_ticks(places, labels, fontsize)

    def set_yticks(self, places: Sequence[float], labels: Sequence[str], *, fontsize: float = FONT) -> None:
        self.yaxis.set_ticks(places, labels, fontsize)

    def tick_params(
        self,
        *,
        axis: str = "both",
        labelbottom: bool = True,
        labelleft: bool = True,
        length: float | None = None,
    ) -> None:
        """Which axes have labels, and how long ticks are [point]."""
        self.xaxis.labelled &= labelbottom
        self.yaxis.labelled &= labelleft
        for name, one in (("x", self.xaxis), ("y", self.yaxis)):
            if length is not None and axis in (name, "both"):
                one.tick_length = length

    def grid(self, *, visible: bool, axis: str) -> None:
        getattr(self, f"{axis}axis").grid = visible

    def sharex(self, other: "Chart") -> None:
        """Have the same limits along x."""
        self.xaxis.share_with(other.xaxis)

    def set_axis_off(self) -> None:
        self.framed = False

    def set(self, *, xlim: tuple[float, float], ylim: tuple[float, float], aspect: str) -> None:
        """Limits, and equal scales along both axes: the panel shrinks to them."""
        self.set_xlim(*xlim)
        self.set_ylim(*ylim)
        self._equal = aspect == "equal"

    def get_position(self) -> Extent:
        """The frame of the axes."""
        left, bottom, wide, tall = self.place
        if self._equal:
            width, height = self._canvas.get_size_inches()
            (x0, x1), (y0, y1) = self.get_xlim(), self.get_ylim()
            scale = min(wide * width / (x1 - x0), tall * height / (y1 - y0))
            within = scale * (x1 - x0) / width, scale * (y1 - y0) / height
            left, bottom = left + 0.5 * (wide - within[0]), bottom + 0.5 * (tall - within[1])
            wide, tall = within
        return Extent(x0=left, y0=bottom, x1=left + wide, y1=bottom + tall)

    def _across(
        self, x: FloatArray, y: FloatArray, colour: str, style: Dash, width: float, label: str | None
    ) -> None:
        line = Curve(x=x, y=y, colour=colour, dashes=_dashes(style), width=width, label=_named(label))
        self._draw(line, x, y)

    def _fill(self, area: Area) -> None:
        corners = np.concatenate([np.empty((0, 2)), *area.polygons])
        self._draw(area, corners[:, 0], corners[:, 1])

    def _draw(self, artist: Curve | Area, x: FloatArray, y: FloatArray) -> None:
        self.artists.append(artist)
        self.xaxis.data.append(x)
        self.yaxis.data.append(y)


class Canvas:
    """A figure of a width and a height [inch]."""

    def __init__(self, *, figsize: tuple[float, float]) -> None:
        self._size = figsize
        self.axes: list[Chart] = []
        self.texts: list[Words] = []

    def get_size_inches(self) -> tuple[float, float]:
        return self._size

    def add_axes(self, place: tuple[float, float, float, float], sharey: Chart | None = None) -> Chart:
        """A panel in a rectangle: left, bottom, width and height as shares of the figure."""
        panel = Chart(self, place)
        if sharey is not None:
            panel.yaxis.share_with(sharey.yaxis)
        self.axes.append(panel)
        return panel

    def text(self, x: float, y: float, text: str, *, fontsize: float, color: str, va: str = "top") -> None:
        """Words whose upper left corner is at a place of the figure."""
        self.texts.append(Words(x=x, y=y, text=text, size=fontsize, colour=color))


def _dashes(style: Dash) -> tuple[float, ...] | None:
    return LINES.get(style.strip()) if isinstance(style, str) else style[1]


def _named(label: str | None) -> str:
    return label or ""


def _rectangle(x: float, y: float, width: float, height: float) -> FloatArray:
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])
