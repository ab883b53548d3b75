"""The strength of a motion that overturns a rigid block in its first swing, by bisection of the event-driven block."""

import math
from collections.abc import Callable

from runs import bisected

from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.planar_block import PlanarMode
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking


def first_swing_threshold(
    block: RigidBlock,
    floor_of_peak: Callable[[float], FloorAcceleration],
    *,
    low: float,
    high: float,
    duration: float,
    relative_tolerance: float = 1e-9,
) -> float:
    """Peak floor acceleration from which the block overturns before any impact [m/s2].

    Bisection on the exact motion of the first swing only, where overturning is monotone in the peak of the
    motions considered here; with impacts there are safe islands above it and no single threshold. The peaks `low` and
    `high` [m/s2] do not, and do, overturn; the duration [s] must do to overturn or to come back.
    """

    def overturns(peak: float) -> bool:
        motion = simulate_rocking(block, floor_of_peak(peak), duration=duration, stop_at_impact=True)
        return motion.outcome is PlanarMode.OVERTURNED

    peak = bisected(overturns, low, high, resolution=relative_tolerance)
    if math.isnan(peak):
        raise ValueError(f"first swing: no change from standing to overturned between {low} and {high} m/s2")
    return peak
