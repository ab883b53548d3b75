"""Neighbours on the grid of a sweep: near a change of outcome, around cells, on a coarse grid; see the README."""

from collections.abc import Sequence

import numpy as np
from scipy import ndimage

from fem.batch.axes import Axis, shape_of
from fem.results.outcome import Ending
from fem.runtime.arrays import BoolArray, FloatArray, IntArray

#: one in so many values of a numeric axis belongs to the coarse grid
COARSE = 4


def _size(axes: Sequence[Axis], reach: int = 1) -> tuple[int, ...]:
    """Size of the neighbourhood along each axis."""
    return tuple(2 * reach + 1 if axis.is_numeric else 1 for axis in axes)


def near_cells(axes: Sequence[Axis], kind: IntArray, ratio: FloatArray, close: float) -> BoolArray:
    """Cells next to one of another kind, or standing and close to overturning.

    Args:
        axes: of the sweep.
        kind: endings, in the shape of the axes.
        ratio: largest rotation over the slenderness angle, in the shape of the axes; nan where there is none.
        close: rotation ratio that counts as close.
    """
    size = _size(axes)
    highest = ndimage.maximum_filter(kind, size=size, mode="nearest")
    lowest = ndimage.minimum_filter(kind, size=size, mode="nearest")
    with np.errstate(invalid="ignore"):
        return (highest != lowest) | ((kind == Ending.STANDING) & (ratio >= close))


def around(axes: Sequence[Axis], cells: BoolArray, reach: int = 1) -> BoolArray:
    """The cells and those up to `reach` away from them, diagonally as well."""
    grown: BoolArray = ndimage.maximum_filter(cells, size=_size(axes, reach), mode="constant", cval=False)
    return grown


def coarse_cells(axes: Sequence[Axis]) -> BoolArray:
    """Every fourth cell along each numeric axis, from the second on, in the shape of the axes."""
    chosen = np.zeros(shape_of(axes), dtype=bool)
    places = (
        slice((min(len(axis.values), COARSE) - 1) // 2, None, COARSE) if axis.is_numeric else slice(None)
        for axis in axes
    )
    chosen[tuple(places)] = True
    return chosen


def band_width(axes: Sequence[Axis], unsure: BoolArray, dimension: int) -> FloatArray:
    """Length along one axis of the stretch of unsure cells around a cell, in the unit of the axis; 0 for a sure cell.

    A cell extends half way to its neighbours (by ratio on a log scale), the outermost cells to their own value.
    """
    axis = axes[dimension]
    values = np.array(axis.values, dtype=float)
    middles = np.sqrt(values[:-1] * values[1:]) if axis.scale == "log" else 0.5 * (values[:-1] + values[1:])
    edges = np.concatenate([values[:1], middles, values[-1:]])
    lines = np.moveaxis(unsure, dimension, -1).reshape(-1, values.size)
    widths = np.zeros(lines.shape)
    for line, width in zip(lines, widths, strict=True):
        labels, count = ndimage.label(line)
        for label in range(1, count + 1):
            inside = np.flatnonzero(labels == label)
            width[inside] = edges[inside[-1] + 1] - edges[inside[0]]
    moved = np.moveaxis(unsure, dimension, -1).shape
    return np.moveaxis(widths.reshape(moved), -1, dimension)
