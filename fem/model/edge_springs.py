"""Springs of a flat base on a half-space: stiffer near its edges, so that it resists tilting as the half-space does.

Under a rigid base the pressure of a half-space is largest at the edges. Springs shared evenly have 0.3 to 0.8 of its
rocking stiffness. Two intensities, one outside and one inside, meet the vertical and the rocking stiffness of the
source. No springs that push can resist tilting by more than all of them at the edges, three times the even ones: under
a base more than 1.5 times as deep as it is wide all are stiffer, so that the rocking stiffness, which decides about
uplift, is met, and the vertical one is more than that of the source: 1.09 and 1.45 times at 2 and 5 widths (NIST GCR
12-917-21, 2.2.3, has end zones and lets it grow, too). On a weak floor the edges would be crushed at rest: they have
less there.
"""

import math

import numpy as np

from contact.interface.support import Support
from fem.case.case import Case
from fem.model.floor import corner_patch, half_space_of, slab_of
from fem.runtime.arrays import FloatArray

LARGEST = 2.9  #: rocking stiffness over that of even springs; 3 takes all of them to the edges
MOST_AT_REST = 0.5  #: of its strength that the floor carries at the edges at rest
WHOLE_WIDTH = 0.99  #: share of the width of the base from which two patches are all of it


def rocking_ratio(case: Case) -> float | None:
    """Rocking stiffness of the half-space over that of springs shared evenly; None where no flat base bears on one."""
    support, floor = case.support, case.floor
    if not floor.is_slab or support.kind != "flat" or support.camber_m > 0.0:
        return None
    half, across = corner_patch(case)
    along, below = 2.0 * half, half_space_of(case)
    if along < WHOLE_WIDTH * case.stack[0].width:
        return None
    return below.rocking_stiffness(along, across) / (
        below.vertical_stiffness(along, across) * along**2 / 12.0
    )


def edge_factors(case: Case, support: Support, x: FloatArray) -> FloatArray:
    """Factors (n,) on the springs of the points of a base at x (n,) [m], shared by their lengths."""
    wanted = rocking_ratio(case)
    if wanted is None:
        return np.ones(x.size)
    ratio, half, lengths = min(wanted, LARGEST), 0.5 * float(x[-1] - x[0]), support.length
    # from farther out than the radius wanted, so that the inside pushes, too; a point may have a part of it, so that
    # its place does not depend on where the nodes are
    zone = half * (1.0 - math.sqrt(0.25 + 0.25 * ratio))
    ends = np.cumsum(lengths)
    left, right = (np.clip(zone - before, 0.0, lengths) for before in (ends - lengths, ends[-1] - ends))
    outside = (left + right) / lengths
    squares = ((x - x[0]) / half - 1.0) ** 2
    parts = lengths * np.array([1.0 - outside, outside])
    sums = np.array([parts.sum(axis=1), parts @ squares])
    inside, edge = np.linalg.solve(sums, lengths.sum() * np.array([1.0, ratio / 3.0]))
    # of edges that would be crushed at rest, only as much as they carry
    bearable = MOST_AT_REST * 2.0 * slab_of(case, case.mass).cap / (case.mass * case.gravity_m_s2)
    elastic = float(np.clip((bearable - 1.0) / (edge - 1.0), 0.0, 1.0))
    return 1.0 + elastic * (wanted / ratio * (inside + (edge - inside) * outside) - 1.0)
