"""Integrals over bilinear quadrilaterals in the x-z plane, exact up to quadratic integrands.

Points are (n, 2) [x, z] in m; quads are (m, 4) indices, counter-clockwise with x to the right and z up.
The 2 x 2 Gauss rule integrates cubics in each local coordinate: enough for x^2 + z^2 times the (linear)
Jacobian determinant. Hughes, The Finite Element Method (2000), 3.2 and 3.8.
"""

import math

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_GAUSS = math.sqrt(1.0 / 3.0)
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_XI = _GAUSS * _CORNERS
#: Bilinear shape functions at the Gauss points (4 Gauss points, 4 corners), and their local derivatives.
_SHAPE = 0.25 * (1.0 + _XI[:, None, 0] * _CORNERS[:, 0]) * (1.0 + _XI[:, None, 1] * _CORNERS[:, 1])
_SHAPE_XI = 0.25 * _CORNERS[:, 0] * (1.0 + _XI[:, None, 1] * _CORNERS[:, 1])
_SHAPE_ETA = 0.25 * _CORNERS[:, 1] * (1.0 + _XI[:, None, 0] * _CORNERS[:, 0])


def quadrature(points: FloatArray, quads: IntArray) -> tuple[FloatArray, FloatArray]:
    """Gauss points (m, 4, 2) [m] and weights (m, 4) [m2] of every cell; weights are negative if clockwise."""
    corners = points[quads]
    along_xi = np.einsum("gc,mcd->mgd", _SHAPE_XI, corners)
    along_eta = np.einsum("gc,mcd->mgd", _SHAPE_ETA, corners)
    weights = along_xi[..., 0] * along_eta[..., 1] - along_xi[..., 1] * along_eta[..., 0]
    return np.einsum("gc,mcd->mgd", _SHAPE, corners), weights


def areas_and_centroids(points: FloatArray, quads: IntArray) -> tuple[FloatArray, FloatArray]:
    """Area (m,) [m2] and centroid (m, 2) [m] of every cell; areas must not be zero."""
    positions, weights = quadrature(points, quads)
    areas = weights.sum(axis=1)
    return areas, np.einsum("mg,mgd->md", weights, positions) / areas[:, None]


def signed_areas(points: FloatArray, quads: IntArray) -> FloatArray:
    """Area (m,) of every cell, negative where the corners run clockwise [m2]."""
    first_diagonal = points[quads[:, 2]] - points[quads[:, 0]]
    second_diagonal = points[quads[:, 3]] - points[quads[:, 1]]
    cross = first_diagonal[:, 0] * second_diagonal[:, 1] - first_diagonal[:, 1] * second_diagonal[:, 0]
    return 0.5 * cross
