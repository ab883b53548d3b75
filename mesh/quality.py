"""Quality of the cells for finite elements.

The scaled Jacobian of a quadrilateral is the smallest over its corners of the cross product of the two
edges that meet there, divided by their lengths: the sine of the corner angle, negative for a corner that
points inwards. The division by the edge lengths removes the anisotropy: a rectangle has 1 at any aspect
ratio, so the ring of a container may be as thin as its steel. Knupp, SIAM J. Sci. Comput. 22 (2000);
Verdict library (Sandia SAND2007-1751), quad scaled Jacobian.
"""

import numpy as np

from mesh.cells import FloatArray, IntArray
from mesh.errors import MeshError, MeshQualityError

#: Smallest scaled Jacobian accepted: corner angles between 11.5 and 168.5 degrees.
LEAST_SCALED_JACOBIAN = 0.2

#: Larger positions are refused [m]; squares and cubes of smaller ones are finite.
FARTHEST = 1e9

#: Smallest edge of a cell over its longest; a shorter edge is collapsed.
LEAST_EDGE_RATIO = 1e-9


def _corner_edges(points: FloatArray, quads: IntArray) -> tuple[FloatArray, FloatArray]:
    """Edges leaving every corner to the next and to the previous corner, each (m, 4, 2) [m]."""
    corners = points[quads]
    return np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners


def scaled_jacobian(points: FloatArray, quads: IntArray) -> FloatArray:
    """Scaled Jacobian (m,) in -1..1 of every cell; 1 for any rectangle, 0 for a collapsed edge.

    Args:
        points: corner positions, shape (n, 2) [m].
        quads: corner indices, shape (m, 4), counter-clockwise (clockwise cells come out negative).
    """
    ahead, behind = _corner_edges(points, quads)
    lengths = np.linalg.norm(ahead, axis=2)
    longest = lengths.max(axis=1, keepdims=True)
    # Lengths relative to the cell's longest edge: the products then neither under- nor overflow.
    scale = np.where(longest > 0.0, longest, 1.0)[..., None]
    ahead, behind = ahead / scale, behind / scale
    product = np.linalg.norm(ahead, axis=2) * np.linalg.norm(behind, axis=2)
    cross = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    sines = np.divide(cross, product, out=np.zeros_like(cross), where=product > 0.0)
    collapsed = (lengths <= LEAST_EDGE_RATIO * longest).any(axis=1)
    return np.where(collapsed, np.minimum(sines.min(axis=1), 0.0), sines.min(axis=1))


def corner_angles(points: FloatArray, quads: IntArray) -> FloatArray:
    """Interior angles (m, 4) of counter-clockwise cells, in order of their corners [degrees, 0..360]."""
    ahead, behind = _corner_edges(points, quads)
    cross = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    dot = np.einsum("mcd,mcd->mc", ahead, behind)
    return np.mod(np.degrees(np.arctan2(cross, dot)), 360.0)


def require_quality(points: FloatArray, quads: IntArray) -> None:
    """Refuse a mesh with a cell whose scaled Jacobian is below `LEAST_SCALED_JACOBIAN`.

    Raises:
        MeshError: points or cells of the wrong shape, positions that are not finite, corners not in the mesh.
        MeshQualityError: with number, centre, corner angles and scaled Jacobian of the worst cell.
    """
    _require_numbers(points, quads)
    quality = scaled_jacobian(points, quads)
    worst = int(np.argmin(quality))
    if quality[worst] >= LEAST_SCALED_JACOBIAN:
        return
    centre = points[quads[worst]].mean(axis=0)
    angles = ", ".join(f"{angle:.1f}" for angle in corner_angles(points, quads[worst : worst + 1])[0])
    below = int(np.sum(quality < LEAST_SCALED_JACOBIAN))
    fault = "inverted, folded or without area" if quality[worst] <= 0.0 else "too distorted"
    raise MeshQualityError(
        f"cell {worst} at x = {centre[0]:.4g} m, z = {centre[1]:.4g} m is {fault}: scaled Jacobian "
        f"{quality[worst]:.4g} (at least {LEAST_SCALED_JACOBIAN} needed), corner angles {angles} degrees; "
        f"{below} of {len(quads)} cells are below; move its corners or remesh there"
    )


def require_positions(points: FloatArray) -> None:
    """Refuse points (n, any) [m] not finite or beyond `FARTHEST`; raises MeshError naming the first."""
    placed = (np.abs(points) <= FARTHEST).all(axis=1)  # also refuses nan
    if not placed.all():
        first = int(np.argmin(placed))
        raise MeshError(
            f"point {first} has no finite position within {FARTHEST:g} m: {points[first].tolist()} m "
            f"({int(np.sum(~placed))} such points)"
        )


def _require_numbers(points: FloatArray, quads: IntArray) -> None:
    if points.ndim != 2 or points.shape[1] != 2:
        raise MeshError(f"points must have shape (n, 2), got {points.shape}")
    if quads.ndim != 2 or quads.shape[1] != 4 or len(quads) == 0:
        raise MeshError(f"quads must have shape (m, 4) with at least one cell, got {quads.shape}")
    require_positions(points)
    if quads.min() < 0 or quads.max() >= len(points):
        raise MeshError(
            f"cells name points {quads.min()} to {quads.max()}, "
            f"but the mesh has points 0 to {len(points) - 1}"
        )
