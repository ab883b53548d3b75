"""Rocking without sliding: closed forms against the event-driven motion, and both against known numbers."""

import math

import numpy as np
import pytest
from closed_forms_rocking import (
    damped_drop_restitution,
    holding_acceleration,
    impact_friction_need,
    peak_after_impacts,
    quarter_period,
    symmetric_orbit_slender,
)
from floors import rectangular_pulse, sine_floor, still_floor
from scipy.integrate import solve_ivp

from contact.reference.planar_block import PlanarBlock, simulate_planar_block
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
BOX = RigidBlock.homogeneous(width=1.1, height=1.0)
ODD = RigidBlock(half_width=0.3, centroid_height=1.4, gravity=3.7, inertia_ratio=1.15)
NEEDLE = RigidBlock.homogeneous(width=2e-3, height=1.0)


@pytest.mark.parametrize("block", [STACK, BOX, ODD])
@pytest.mark.parametrize("ratio", [0.001, 0.1, 0.5, 0.9, 0.999])
def test_quarter_period_is_the_time_of_the_first_impact(block, ratio):
    rotation = ratio * block.slenderness_angle
    motion = simulate_rocking(block, still_floor(), duration=20.0, rotation=rotation, stop_at_impact=True)
    assert motion.impacts[0].time == pytest.approx(quarter_period(block, rotation), rel=1e-10)


@pytest.mark.parametrize("block", [STACK, ODD])
def test_peaks_and_impact_times_of_free_rocking(block):
    start = 0.8 * block.slenderness_angle
    motion = simulate_rocking(block, still_floor(), duration=30.0, rotation=start)
    restitution, time, before = block.housner_restitution, 0.0, start
    for n in range(1, 13):
        expected = peak_after_impacts(block, start, n, restitution)
        assert abs(motion.peaks[n - 1].rotation) == pytest.approx(expected, rel=1e-9)
        time += quarter_period(block, start) if n == 1 else 2.0 * quarter_period(block, before)
        assert motion.impacts[n - 1].time == pytest.approx(time, rel=1e-10)
        before = expected


def test_friction_need_of_an_impact():
    # mu >= 3 tan al/(4 + tan^2 al): 0.2024 for the stack.
    need = impact_friction_need(STACK)
    assert need == pytest.approx(3.0 * 0.275 / (4.0 + 0.275**2), rel=1e-13)
    for mu, slips in ((1.001 * need, False), (0.999 * need, True)):
        block = PlanarBlock(body=STACK, mu_static=mu, mu_kinetic=mu)
        rotation = 0.05 * STACK.slenderness_angle  # from a larger one it may slide on its corner before
        motion = simulate_planar_block(block, still_floor(), duration=1.0, rotation=rotation)
        assert motion.impacts[0].slides is slips
    with pytest.raises(ValueError, match="lies down"):
        impact_friction_need(RigidBlock.homogeneous(width=2.0, height=1.0))


@pytest.mark.parametrize("ratio", [0.2, 0.7, 1.3])
def test_tilt_statics(ratio):
    # g tan(al - theta) holds the body at theta: a little more lifts it, with a little less it falls back.
    rotation = ratio * STACK.slenderness_angle
    hold = holding_acceleration(STACK, rotation)
    assert hold == pytest.approx(9.81 * math.tan(STACK.slenderness_angle - rotation), rel=1e-14)
    for surplus, sign in ((1e-3, 1.0), (-1e-3, -1.0)):
        floor = rectangular_pulse(peak=-hold - surplus, duration=1.0)
        motion = simulate_rocking(STACK, floor, duration=0.05, rotation=rotation)
        assert sign * motion.at(np.array([0.05]))[1][0] > 0.0


@pytest.mark.parametrize(("ratio", "frequency"), [(3.0, 3.0), (1.5, 4.0), (6.0, 8.0), (0.2, 1.0)])
def test_steady_orbit_repeats_itself(ratio, frequency):
    # Started at its impact, the needle comes back to the same speed, mirrored, half a period later.
    orbit = symmetric_orbit_slender(acceleration_ratio=ratio, frequency_ratio=frequency, restitution=0.9)
    angle, p = NEEDLE.slenderness_angle, NEEDLE.frequency_parameter
    omega = frequency * p
    floor = sine_floor(
        amplitude=ratio * 9.81 * angle / omega**2, angular_frequency=omega, phase=orbit.impact_phase
    )
    speed = orbit.post_impact_speed * angle * p
    motion = simulate_rocking(
        NEEDLE, floor, duration=1.5 * math.pi / omega, angular_velocity=speed, restitution=0.9
    )
    impact = motion.impacts[0]
    assert impact.time == pytest.approx(math.pi / omega, rel=1e-4)
    assert impact.velocity_after == pytest.approx(-speed, rel=1e-4)
    assert motion.peaks[0].rotation == pytest.approx(orbit.peak * angle, rel=1e-4)


# The seed paper's stack with peak 4.0 m/s2 at 6.928 rad/s, and the same block where friction is finite.
PLATEAU = sine_floor(amplitude=4.0 / 6.928**2, angular_frequency=6.928)


@pytest.mark.parametrize(("restitution", "ratio"), [(0.85, 0.38), (None, 0.399), (0.96, 0.43)])
def test_stack_under_the_plateau_value_rocks_and_stands(restitution, ratio):
    # Largest rotation in 8 s 0.399 al, 0.38 to 0.43 for e 0.85 to 0.96 (computed, independent).
    motion = simulate_rocking(STACK, PLATEAU, duration=8.0, restitution=restitution)
    tolerance = 5e-4 if restitution is None else 5e-3
    assert motion.largest_rotation / STACK.slenderness_angle == pytest.approx(ratio, abs=tolerance)
    assert motion.overturned_at is None


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.1, 0.2, 0.5, 0.999, 1.0, 1.001, 2.0])
def test_rebound_from_a_bed_that_does_not_pull(zeta):
    # x'' = -2 zeta x' - x, from x = 0 at unit speed, until the force k x + c v vanishes.
    def force(t, y):
        return y[0] + 2.0 * zeta * y[1]

    force.terminal, force.direction = True, -1.0
    solution = solve_ivp(
        lambda t, y: [y[1], -y[0] - 2.0 * zeta * y[1]],
        (0.0, 50.0),
        [0.0, 1.0],
        events=force,
        rtol=1e-11,
        atol=1e-13,
        method="DOP853",
        first_step=1e-6,
    )
    assert -solution.y_events[0][0][1] == pytest.approx(damped_drop_restitution(zeta), rel=1e-8)
