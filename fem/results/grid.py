"""A frame of a run as a grid of pyvista, in the x-y plane."""

import numpy as np
import pyvista

from fem.results.fields import Frame
from fem.runtime.arrays import FloatArray

#: VTK's cells by their number of nodes
CELL_TYPES = {4: pyvista.CellType.QUAD, 9: pyvista.CellType.BIQUADRATIC_QUAD}


def grid_of(frame: Frame) -> pyvista.UnstructuredGrid:
    """A frame as a grid in the x-y plane, where the container stood, with its fields by their names in the files.

    `grid.warp_by_vector("displacement_m")` shows it where it is.
    """
    count, size = frame.cells.shape
    cells = np.column_stack([np.full(count, size), frame.cells]).ravel()
    grid = pyvista.UnstructuredGrid(cells, np.full(count, CELL_TYPES[size]), spatial(frame.points))
    grid.point_data["displacement_m"] = spatial(frame.displacement)
    grid.point_data["velocity_m_s"] = spatial(frame.velocity)
    if frame.von_mises is not None:
        grid.point_data["von_mises_Pa"] = frame.von_mises
    grid.point_data["contact_pressure_Pa"] = frame.contact_pressure
    grid.cell_data["region"] = frame.region
    grid.cell_data["box"] = frame.box
    return grid


def spatial(vectors: FloatArray) -> FloatArray:
    """(x, z) as (x, z, 0)."""
    return np.column_stack([vectors, np.zeros(len(vectors))])
