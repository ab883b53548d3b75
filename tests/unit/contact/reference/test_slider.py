import math

import numpy as np
import pytest
from floors import rectangular_pulse, still_floor
from rigid_slider import RigidSlider, simulate_sliding

from contact.reference.floor_acceleration import FloorAcceleration

GRAVITY = 9.81
HALF = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)


def test_a_push_stops_after_the_distance_that_friction_allows():
    motion = simulate_sliding(HALF, still_floor(), duration=2.0, slip_velocity=1.5)
    assert motion.residual_slip == pytest.approx(1.5**2 / (2.0 * 0.2 * GRAVITY), rel=1e-12)
    assert motion.intervals[0].end == pytest.approx(1.5 / (0.2 * GRAVITY), rel=1e-12)
    assert [interval.direction for interval in motion.intervals] == [1, 0]


def test_sticking_holds_between_kinetic_and_static_limit_but_sliding_goes_on_there():
    # 0.3 g lies between mu_k g and mu_s g: at rest it sticks, pushed the same way it accelerates.
    floor = rectangular_pulse(peak=-0.3 * GRAVITY, duration=5.0)
    assert simulate_sliding(HALF, floor, duration=5.0).largest_slip == 0.0
    pushed = simulate_sliding(HALF, floor, duration=1.0, slip_velocity=0.1)
    assert pushed.at(np.array([1.0]))[1][0] == pytest.approx(0.1 + 0.1 * GRAVITY, rel=1e-12)


def test_intervals_fill_the_time_and_strokes_add_up():
    times, values = np.arange(0.0, 3.0, 0.02), 9.0 * np.sin(1.3 * np.arange(150) ** 1.2)
    floor = FloorAcceleration(
        function=lambda t: float(np.interp(t, times, values, right=0.0)),
        break_times=tuple(times.tolist()),
        longest_step=math.inf,
    )
    motion = simulate_sliding(HALF, floor, duration=4.0)
    ends = [interval.end for interval in motion.intervals]
    starts = [interval.start for interval in motion.intervals]
    assert starts[0] == 0.0
    assert ends[-1] == 4.0
    assert starts[1:] == ends[:-1]
    assert len(motion.strokes) > 5
    assert sum(motion.strokes) == pytest.approx(motion.residual_slip, abs=1e-13)
    _, velocity = motion.at(np.linspace(0.0, 4.0, 4001))
    sticking = [i for i in motion.intervals if i.direction == 0]
    for interval in sticking:
        assert motion.at(np.linspace(interval.start, interval.end, 5))[1].tolist() == [0.0] * 5
    assert np.abs(velocity).max() > 0.1
