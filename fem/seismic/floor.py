"""Motions of a floor in a building, from the motions of the ground.

The floor moves with the ground and, for each mode of the building, with the share of the mode at the floor times an
oscillator relative to the ground. The modes are those of a chain of equal masses, one a storey: a shear building with
equal storeys, or a cantilever of one stiffness in bending. Modes above 33 Hz follow the ground. A stiff, low building
may be one mode that grows linearly with height, 1.5 z/H, which is also what formula (4.25) of EN 1998-1 gives a rigid
element beyond the ground; higher up and in softer buildings it leaves out what most starts uplift and slip. The
building stays elastic: nothing is divided by a behaviour factor. The vertical motion is that of the ground.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np
from scipy.linalg import eigh

from fem.records.processing import ZeroEnd
from fem.records.spectrum import oscillator_response
from fem.runtime.arrays import FloatArray
from fem.seismic.ground_motion import GroundMotion, sampled_at

PERIOD_FACTORS = (0.85, 1.0, 1.15)  #: factors on the period, which is not known more precisely
MODE_AT_TOP = 1.5
#: up to which one mode is good for the floors of low, stiff buildings, and beyond which it is refused [s]
ONE_MODE_TO_S, ONE_MODE_REFUSED_S = 0.5, 0.7
HIGHEST_HZ = 33.0
#: samples of a period, at least: of the building, and of its fastest mode
SAMPLES_PER_PERIOD, SAMPLES_OF_FASTEST = 20.0, 10.0
SWUNG_OUT = 0.01  #: share to which the building swings out before the motion ends
SHORTEST_PERIOD_S = 0.02
LEAST_DAMPING, MOST_DAMPING = 0.005, 0.3  #: ratios of a building
BETWEEN_FLOORS = 0.05  #: of a storey: how far z/H may lie from a floor
BuildingKind = Literal["shear", "cantilever"]


class FloorMode(NamedTuple):
    """A mode of a building, as a floor feels it."""

    period: float  #: [s]
    share: float  #: participation factor times the mode at the floor [-]


def one_mode(*, height_ratio: float, period: float) -> list[FloorMode]:
    """A building as one oscillator, its mode linear over the height z/H; none at the foundation."""
    return [FloorMode(period, MODE_AT_TOP * height_ratio)] if height_ratio else []


def storey_modes(*, storeys: int, kind: BuildingKind, height_ratio: float, period: float) -> list[FloorMode]:
    """The modes of a uniform building up to 33 Hz, at least the first; none at the foundation.

    Args:
        storeys: equal masses at equal heights.
        kind: "shear": equal storeys that shear; "cantilever": bending of one stiffness.
        height_ratio: z/H of one of its floors, see `is_a_floor`; period: the longest [s].
    """
    floor = round(height_ratio * storeys)
    if floor == 0:
        return []
    level = np.arange(1.0, storeys + 1.0)
    lower, upper = np.minimum.outer(level, level), np.maximum.outer(level, level)
    flexibility = lower if kind == "shear" else lower**2 * (3.0 * upper - lower) / 6.0
    squares, shapes = eigh(flexibility)  # of the periods, up to a factor; masses are one
    squares, shapes = squares[::-1], shapes[:, ::-1]
    periods = period * np.sqrt(squares / squares[0])
    shares = shapes.sum(axis=0) * shapes[floor - 1]
    kept = periods * HIGHEST_HZ >= 1.0
    kept[0] = True
    return [FloorMode(*mode) for mode in zip(periods[kept].tolist(), shares[kept].tolist(), strict=True)]


def is_a_floor(storeys: int, height_ratio: float) -> bool:
    """Whether z/H is that of a floor, or of the foundation."""
    return abs(height_ratio - nearest_floor(storeys, height_ratio)) * storeys <= BETWEEN_FLOORS


def nearest_floor(storeys: int, height_ratio: float) -> float:
    """z/H of the floor nearest to a height."""
    return round(height_ratio * storeys) / storeys


def floor_motion(
    ground: GroundMotion, modes: Sequence[FloorMode], *, damping_ratio: float = 0.05
) -> GroundMotion:
    """The motion of a floor of a building under a motion of its ground.

    Args:
        modes: of the building, at the floor, the slowest first; damping_ratio: of each.

    Raises:
        ValueError: a period or damping ratio that no building has.
    """
    if not modes:
        return ground
    slowest, fastest = modes[0].period, modes[-1].period
    if not SHORTEST_PERIOD_S <= slowest <= 20.0:
        raise ValueError(
            f"the period of the building must lie between {SHORTEST_PERIOD_S:g} and 20 s, got {slowest:g} s"
        )
    if not LEAST_DAMPING <= damping_ratio <= MOST_DAMPING:
        raise ValueError(
            f"the damping ratio of the building must lie between {LEAST_DAMPING} and {MOST_DAMPING}, "
            f"got {damping_ratio:g}"
        )
    wanted = min(slowest / SAMPLES_PER_PERIOD, fastest / SAMPLES_OF_FASTEST)
    step = ground.step / math.ceil(ground.step / wanted)  # so that no sample of the ground is left out
    ringing = -math.log(SWUNG_OUT) * slowest / (2.0 * math.pi * damping_ratio)
    longer = np.zeros(math.ceil(ringing / step))

    def extended(component: FloatArray) -> FloatArray:
        return np.concatenate([sampled_at(step, ground.step, component), longer])

    def swung(component: FloatArray) -> FloatArray:
        base = extended(component)
        floor = (1.0 - sum(mode.share for mode in modes)) * base
        for mode in modes:
            floor += (
                mode.share * oscillator_response(step, base, mode.period, damping_ratio).acceleration_m_s2
            )
        return floor - ZeroEnd(times=np.arange(floor.size, dtype=np.float64) * step).baseline(floor)

    return replace(
        ground,
        step=step,
        horizontal=swung(ground.horizontal),
        vertical=None if ground.vertical is None else extended(ground.vertical),
        second=None if ground.second is None else swung(ground.second),
    )
