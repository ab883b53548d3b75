import numpy as np
import pytest
from floors import rectangular_pulse, still_floor
from rigid_slider import RigidSlider, simulate_sliding

GRAVITY = 9.81
HALF = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)


def test_a_push_stops_after_the_distance_that_friction_allows():
    motion = simulate_sliding(HALF, still_floor(), duration=2.0, slip_velocity=1.5)
    assert motion.largest_slip == pytest.approx(1.5**2 / (2.0 * 0.2 * GRAVITY), rel=1e-12)
    assert motion.intervals[0].end == pytest.approx(1.5 / (0.2 * GRAVITY), rel=1e-12)
    assert [interval.direction for interval in motion.intervals] == [1, 0]


def test_sticking_holds_between_kinetic_and_static_limit_but_sliding_goes_on_there():
    # 0.3 g lies between mu_k g and mu_s g: at rest it sticks, pushed the same way it accelerates.
    floor = rectangular_pulse(peak=-0.3 * GRAVITY, duration=5.0)
    assert simulate_sliding(HALF, floor, duration=5.0).largest_slip == 0.0
    pushed = simulate_sliding(HALF, floor, duration=1.0, slip_velocity=0.1)
    assert pushed.at(np.array([1.0]))[1][0] == pytest.approx(0.1 + 0.1 * GRAVITY, rel=1e-12)
