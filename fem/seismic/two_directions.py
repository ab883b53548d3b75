"""Slip of a body that does not rock, under both horizontal components of a motion at once: a friction circle.

Friction resists along the path, whatever its direction, so a second component takes away what resists the first.
Rocking is not in it: a body that rocks or turns about its vertical axis slides otherwise. The motion is that of
`contact.stepping.plane_slider`, exact to 0.1 um for accelerations that are linear between samples.
"""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from contact.stepping.plane_slider import slide_over
from fem.runtime.arrays import FloatArray
from fem.seismic.ground_motion import GroundMotion

GRAVITY = 9.81


def slide_in_plane(
    time_s: FloatArray,
    ax_m_s2: FloatArray,
    ay_m_s2: FloatArray,
    vertical_m_s2: FloatArray | None = None,
    *,
    mu_static: float,
    mu_kinetic: float | None = None,
    gravity_m_s2: float = GRAVITY,
) -> FloatArray:
    """Displacement of a sliding body over its floor, shape (n, 2) [m]; at first both have one velocity.

    Args:
        time_s: of the samples, increasing, shape (n,).
        ax_m_s2, ay_m_s2: acceleration of the floor along x and y, linear between samples, shape (n,).
        vertical_m_s2: upward, shape (n,); None: none. A floor that falls with more than g leaves the body, which flies
            and lands without rebound.
        mu_static, mu_kinetic: friction; kinetic is static unless given. Equal in all directions.
        gravity_m_s2: [m/s2].

    Raises:
        ValueError: lengths that differ, fewer than two samples, times that do not increase, numbers that are not
            finite, mu_static not positive, mu_kinetic negative or above it, gravity not positive.
    """
    kinetic = mu_static if mu_kinetic is None else mu_kinetic
    slip, _ = _slid(time_s, ax_m_s2, ay_m_s2, vertical_m_s2, (mu_static, kinetic), gravity_m_s2)
    return slip


def largest_slips(
    motions: Sequence[GroundMotion], frictions: Iterable[tuple[float, float]], *, gravity: float = GRAVITY
) -> dict[tuple[float, float], FloatArray]:
    """By pairs of static and kinetic friction, `largest_slip` under each of n motions, shape (n,) [m]."""
    return {
        pair: np.array([largest_slip(motion, pair, gravity=gravity) for motion in motions])
        for pair in frictions
    }


def largest_slip(motion: GroundMotion, friction: tuple[float, float], *, gravity: float = GRAVITY) -> float:
    """Largest distance from where the body stood, with the worse sign of the vertical [m].

    Args:
        motion: of the floor; without a second horizontal component the body slides along the first.
        friction: static and kinetic.
        gravity: [m/s2].
    """
    second = np.zeros_like(motion.horizontal) if motion.second is None else motion.second
    ups = [None] if motion.vertical is None else [motion.vertical, -motion.vertical]
    largest = 0.0
    for up in ups:
        slip, velocity = _slid(motion.times, motion.horizontal, second, up, friction, gravity)
        speed = math.hypot(*velocity)
        # after the last sample the floor moves on at constant velocity, and the body stops on a straight line
        rest = slip[-1] + velocity * speed / (2.0 * friction[1] * gravity) if speed > 0.0 else slip[-1]
        largest = max(largest, float(np.hypot(slip[:, 0], slip[:, 1]).max()), math.hypot(*rest))
    return largest


def _slid(
    times: FloatArray,
    x: FloatArray,
    y: FloatArray,
    up: FloatArray | None,
    friction: tuple[float, float],
    gravity: float,
) -> tuple[FloatArray, FloatArray]:
    """Displacements (n, 2) [m] and the last velocity (2,) [m/s] over the floor."""
    samples = np.array(times, dtype=np.float64)
    rows = [np.array(row, dtype=np.float64) for row in (x, y, np.zeros_like(samples) if up is None else up)]
    if samples.ndim != 1 or samples.size < 2 or any(row.shape != samples.shape for row in rows):
        shapes = ", ".join(str(row.shape) for row in (samples, *rows))
        raise ValueError(
            f"times and accelerations must be columns of one length, two samples or more, got {shapes}"
        )
    if not all(np.isfinite(row).all() for row in (samples, *rows)):
        raise ValueError("times and accelerations must be finite numbers")
    if not (np.diff(samples) > 0.0).all():
        raise ValueError("times must increase from sample to sample")
    if not 0.0 < friction[0] < math.inf:
        raise ValueError(f"mu_static must be positive and finite, got {friction[0]}")
    if not 0.0 <= friction[1] <= friction[0]:
        raise ValueError(
            f"mu_kinetic must lie between 0 and mu_static = {friction[0]:g}, got {friction[1]:g}"
        )
    if not 0.0 < gravity < math.inf:
        raise ValueError(f"gravity must be positive and finite, got {gravity} m/s2")
    slip, velocity = np.zeros((samples.size, 2)), np.zeros(2)
    slide_over(
        samples, np.array(rows), (float(friction[0]), float(friction[1])), float(gravity), slip, velocity
    )
    return slip, velocity
