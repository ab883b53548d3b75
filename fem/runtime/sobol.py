"""Sobol's points: a sequence that fills the unit cube evenly, unscrambled, in the order of the Gray code.

Primitive polynomials and initial numbers: S. Joe, F. Y. Kuo, Constructing Sobol sequences with better two-dimensional
projections, SIAM J. Sci. Comput. 30 (2008) 2635-2654, their file new-joe-kuo-6.21201. scipy has the same sequence;
importing it takes half a second of processor time, a third of a rigid band.
"""

import numpy as np

from fem.runtime.arrays import FloatArray, IntArray

BITS = 30  #: of a coordinate
#: of the second dimension and the following: the polynomial, its coefficients as bits, and the initial numbers
# fmt: off
INITIAL = (
    (3, 1), (7, 1, 3), (11, 1, 3, 1), (13, 1, 1, 1), (19, 1, 1, 3, 3), (25, 1, 3, 5, 13),
    (37, 1, 1, 5, 5, 17), (41, 1, 1, 5, 5, 5), (47, 1, 1, 7, 11, 19), (55, 1, 1, 5, 1, 1),
    (59, 1, 1, 1, 3, 11), (61, 1, 3, 5, 5, 31), (67, 1, 3, 3, 9, 7, 49), (91, 1, 1, 1, 15, 21, 21),
    (97, 1, 3, 1, 13, 27, 49), (103, 1, 1, 1, 15, 7, 5), (109, 1, 3, 1, 15, 13, 25),
    (115, 1, 1, 5, 5, 19, 61), (131, 1, 3, 7, 11, 23, 15, 103), (137, 1, 3, 7, 13, 13, 15, 69),
    (143, 1, 1, 3, 13, 7, 35, 63), (145, 1, 3, 5, 9, 1, 25, 53), (157, 1, 3, 1, 13, 9, 35, 107),
    (167, 1, 3, 1, 5, 27, 61, 31), (171, 1, 1, 5, 11, 19, 41, 61), (185, 1, 3, 5, 3, 3, 13, 69),
    (191, 1, 1, 7, 13, 1, 19, 1), (193, 1, 3, 7, 5, 13, 19, 59), (203, 1, 1, 3, 9, 25, 29, 41),
    (211, 1, 3, 5, 13, 23, 1, 55), (213, 1, 3, 7, 3, 13, 59, 17), (229, 1, 3, 1, 3, 5, 53, 69),
    (239, 1, 1, 5, 5, 23, 33, 13), (241, 1, 1, 7, 7, 1, 61, 123), (247, 1, 1, 7, 9, 13, 61, 49),
    (253, 1, 3, 3, 5, 3, 55, 33), (285, 1, 3, 1, 15, 31, 13, 49, 245), (299, 1, 3, 5, 15, 31, 59, 63, 97),
    (301, 1, 3, 1, 11, 11, 11, 77, 249),
)
# fmt: on
MOST_DIMENSIONS = 1 + len(INITIAL)


def sobol_points(count: int, dimensions: int) -> FloatArray:
    """The first points of the sequence, shape (count, dimensions), each in the middle of its cell.

    The cells are those of the next power of two, to which the points belong.

    Raises:
        ValueError: more than `MOST_DIMENSIONS`.
    """
    if dimensions > MOST_DIMENSIONS:
        raise ValueError(f"Sobol's points have at most {MOST_DIMENSIONS} dimensions here, got {dimensions}")
    bits = max(count - 1, 0).bit_length()
    directions = np.array([_directions(dimension, bits) for dimension in range(dimensions)], dtype=np.int64)
    numbers = np.arange(count)
    gray, places = numbers ^ (numbers >> 1), np.zeros((count, dimensions), dtype=np.int64)
    for bit in range(bits):
        places ^= (gray[:, None] >> bit & 1) * directions[:, bit]
    return places / 2.0**BITS + 0.5 / 2**bits


def _directions(dimension: int, bits: int) -> IntArray:
    """The numbers that the bits of a point's number turn over in a coordinate, shape (bits,)."""
    polynomial, *initial = INITIAL[dimension - 1] if dimension else (1, *[1] * bits)
    degree = len(initial)
    found = list(initial[:bits])
    for k in range(degree, bits):
        new = found[k - degree] ^ found[k - degree] << degree
        for i in range(1, degree):
            new ^= (polynomial >> (degree - i) & 1) * found[k - i] << i
        found.append(new)
    return np.array([number << (BITS - 1 - k) for k, number in enumerate(found)], dtype=np.int64)
