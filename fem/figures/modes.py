"""Figure of the elastic modes: each shape over the undeformed container, with its frequency."""

import math

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fem.figures.style import BLUE, GREY, LINE, WIDTH, head
from fem.html.units import rounded
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.edges import chained, outline_edges
from fem.solid.modes import ElasticModes

MOST = 20  #: modes in one figure
COLUMNS = 5
AMPLITUDE = 0.12, 0.22  #: largest displacement drawn, over the longer and over the shorter side
TALLEST = 2.6  #: panel [inch]


def modes_figure(
    *, points: FloatArray, cells: IntArray, box: NDArray[np.integer], modes: ElasticModes, name: str = ""
) -> Figure:
    """Deformed outlines over the undeformed one, all to the same amplitude; drawn in the house style.

    Args:
        points: undeformed nodes (n, 2) [m].
        cells: nodes of each cell in the order of VTK, shape (m, 4 or 9).
        box: of each cell, shape (m,).
        modes: of these nodes.
        name: of the case, for the title.
    """
    count = min(len(modes.frequencies_Hz), MOST)
    columns = min(COLUMNS, count)
    rows = math.ceil(count / columns)
    size = np.ptp(points, axis=0)
    reach = min(AMPLITUDE[0] * size.max(), AMPLITUDE[1] * size.min())
    low, high = points.min(axis=0) - 1.1 * reach, points.max(axis=0) + 1.1 * reach
    wide = (WIDTH - 0.2) / columns
    tall = min(TALLEST, wide * (high - low)[1] / (high - low)[0])
    top = 0.15 + 2 * LINE
    height = top + rows * (tall + LINE) + 0.1
    figure = Figure(figsize=(WIDTH, height))
    lines = chained(outline_edges(cells, box))
    for k in range(count):
        row, column = divmod(k, columns)
        bottom = height - top - (row + 1) * (tall + LINE)
        rectangle = ((0.1 + column * wide) / WIDTH, bottom / height, wide / WIDTH, tall / height)
        axes = figure.add_axes(rectangle)
        axes.set_axis_off()
        shape = modes.shapes[k]
        moved = points + shape * (reach / np.linalg.norm(shape, axis=1).max())
        for line in lines:
            axes.plot(*points[line].T, color=GREY, linewidth=0.6, linestyle=":")
            axes.plot(*moved[line].T, color=BLUE, linewidth=1.1)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.set_title(
            f"{k + 1}: {rounded(modes.frequencies_Hz[k], 4)} Hz", loc="center", fontsize=8.5, pad=3
        )
    more = len(modes.frequencies_Hz) - count
    rest = f"; {more} more are in the table" if more else ""
    head(
        figure,
        f"Elastic modes of the free container{f', {name}' if name else ''}",
        f"blue: the shape, to one amplitude; dotted: undeformed{rest}",
    )
    return figure
