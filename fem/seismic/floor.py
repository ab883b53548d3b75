"""Motions of a floor in a building, from the motions of the ground.

The building is an oscillator of its fundamental period. The floor moves with the ground and 1.5 z/H times the
oscillator relative to it: a mode that grows linearly with height in a building of uniform mass. 1.5 z/H is also what
formula (4.25) of EN 1998-1 gives a rigid element beyond the ground. The building stays elastic: nothing is divided by a
behaviour factor. The vertical motion is that of the ground.
"""

import math
from dataclasses import replace

import numpy as np

from fem.records.spectrum import oscillator_response
from fem.records.zero_end import ZeroEnd
from fem.runtime.arrays import FloatArray
from fem.seismic.ground_motion import GroundMotion, sampled_at

#: factors on the period, which is not known more precisely
PERIOD_FACTORS = (0.85, 1.0, 1.15)
MODE_AT_TOP = 1.5
#: samples of a period of the building, at least
SAMPLES_PER_PERIOD = 20.0
#: share to which the building swings out before the motion ends
SWUNG_OUT = 0.01
SHORTEST_PERIOD_S = 0.02


def floor_motion(
    ground: GroundMotion, *, height_ratio: float, period: float, damping_ratio: float = 0.05
) -> GroundMotion:
    """The motion of a floor at a height z/H of a building under a motion of its ground.

    Args:
        height_ratio: z/H, 0 at the foundation, 1 at the top.
        period: of the building [s]; damping_ratio: of the building.

    Raises:
        ValueError: a height, period or damping ratio that no building has.
    """
    if not 0.0 <= height_ratio <= 1.0:
        raise ValueError(f"z/H must lie between 0 and 1, got {height_ratio:g}")
    if not SHORTEST_PERIOD_S <= period <= 20.0:
        raise ValueError(
            f"the period of the building must lie between {SHORTEST_PERIOD_S:g} and 20 s, got {period:g} s"
        )
    if not 0.005 <= damping_ratio <= 0.3:
        raise ValueError(
            f"the damping ratio of the building must lie between 0.005 and 0.3, got {damping_ratio:g}"
        )
    if height_ratio == 0.0:
        return ground
    share = MODE_AT_TOP * height_ratio
    step = min(ground.step, period / SAMPLES_PER_PERIOD)
    ringing = -math.log(SWUNG_OUT) * period / (2.0 * math.pi * damping_ratio)
    longer = np.zeros(math.ceil(ringing / step))

    def extended(component: FloatArray) -> FloatArray:
        return np.concatenate([sampled_at(step, ground.step, component), longer])

    def swung(component: FloatArray) -> FloatArray:
        base = extended(component)
        absolute = oscillator_response(step, base, period, damping_ratio).acceleration_m_s2
        floor = (1.0 - share) * base + share * absolute
        return floor - ZeroEnd(times=np.arange(floor.size, dtype=np.float64) * step).baseline(floor)

    return replace(
        ground,
        step=step,
        horizontal=swung(ground.horizontal),
        vertical=None if ground.vertical is None else extended(ground.vertical),
        second=None if ground.second is None else swung(ground.second),
    )
