"""Which motion begins, and what the planar block does then: closed forms and known numbers."""

import itertools

import numpy as np
import pytest

from contact.reference.closed_forms_initiation import (
    edge_opening_acceleration,
    initiation_mode,
    rocking_friction,
)
from contact.reference.floor_acceleration import rectangular_pulse, sine_floor
from contact.reference.planar_block import PlanarBlock, simulate_planar_block
from contact.reference.planar_equations import rock
from contact.reference.planar_motion import PlanarMode
from contact.reference.rigid_block import RigidBlock

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
GRAVITY = 9.81


@pytest.mark.parametrize("slenderness", [0.8, 1.0, 1.5, 3.64, 8.0])
@pytest.mark.parametrize("surplus", [1.0, 1.2, 2.0, 5.0])
def test_friction_to_begin_rocking_is_that_of_the_equations_of_motion(slenderness, surplus):
    ratio = surplus / slenderness
    block = RigidBlock.homogeneous(width=1.0, height=slenderness)
    contact = rock(block, 1, 0.0, 0.0, -ratio * GRAVITY)
    assert abs(contact.friction) / contact.normal == pytest.approx(
        rocking_friction(ratio, slenderness), rel=1e-12
    )


def initiation_grid():
    """Slenderness, acceleration and friction away from every boundary of the prediction."""
    for lam, ratio, mu_static, share in itertools.product(
        (0.9, 1.5, 2.5, 3.64, 6.0, 10.0),
        (0.08, 0.2, 0.35, 0.6, 1.3),
        (0.05, 0.15, 0.2, 0.3, 0.5, 0.8),
        (0.5, 1.0),
    ):
        mu_kinetic = share * mu_static
        boundaries = [(ratio, 1.0 / lam), (mu_kinetic, 1.0 / lam)]
        if ratio > 1.0 / lam:
            boundaries.append((mu_static, rocking_friction(ratio, lam)))
        else:
            boundaries.append((ratio, mu_static))
        if all(abs(value / limit - 1.0) > 0.05 for value, limit in boundaries):
            yield lam, ratio, mu_static, mu_kinetic


def test_initiation_modes_on_a_grid():
    # Shenton (1996), with mu_k below mu_s; all as predicted, every mode present.
    seen = dict.fromkeys((PlanarMode.REST, PlanarMode.SLIDE, PlanarMode.ROCK, PlanarMode.SLIDE_ROCK), 0)
    for lam, ratio, mu_static, mu_kinetic in initiation_grid():
        expected = initiation_mode(
            acceleration_ratio=ratio, slenderness=lam, mu_static=mu_static, mu_kinetic=mu_kinetic
        )
        body = RigidBlock.homogeneous(width=1.0, height=lam)
        block = PlanarBlock(body=body, mu_static=mu_static, mu_kinetic=mu_kinetic)
        for sign in (1.0, -1.0):
            floor = rectangular_pulse(peak=sign * ratio * GRAVITY, duration=0.1, delay=0.05)
            motion = simulate_planar_block(block, floor, duration=0.06)
            assert motion.first_motion is expected, (lam, ratio, mu_static, mu_kinetic)
            at_end = motion.at(np.array([0.06]))
            moved = {
                PlanarMode.REST: (False, False),
                PlanarMode.SLIDE: (True, False),
                PlanarMode.ROCK: (False, True),
                PlanarMode.SLIDE_ROCK: (True, True),
            }[expected]
            assert (-sign * at_end.slip[0] > 0.0, -sign * at_end.rotation[0] > 0.0) == moved
        seen[expected] += 1
    assert sum(seen.values()) >= 75
    assert min(seen.values()) >= 10


def test_initiation_modes_of_the_reference():
    # lam = 3.64: rest up to 1/lam; rock from mu_c on; slides with mu_k < 1/lam < mu_s < mu_c.
    def mode(ratio, mu_static, mu_kinetic):
        return initiation_mode(
            acceleration_ratio=ratio, slenderness=3.64, mu_static=mu_static, mu_kinetic=mu_kinetic
        )

    need = rocking_friction(0.4, 3.64)
    assert need == pytest.approx(
        ((3.64**2 + 4.0) * 0.4 + 3 * 3.64) / ((4 * 3.64**2 + 1) + 3 * 3.64 * 0.4), rel=1e-14
    )
    assert mode(0.27, 0.4, 0.2) is PlanarMode.REST
    assert mode(0.27, 0.2, 0.2) is PlanarMode.SLIDE
    assert mode(0.4, 1.01 * need, 0.2) is PlanarMode.ROCK
    assert 0.99 * need > 1.0 / 3.64
    assert mode(0.4, 0.99 * need, 0.2) is PlanarMode.SLIDE
    assert mode(0.4, 0.99 * need, 0.99 * need) is PlanarMode.SLIDE_ROCK


def test_edge_of_an_elastic_bed_opens_when_its_pressure_vanishes():
    # g a/(3c): uniform springs under the base, rotation and settlement from two equilibrium equations.
    acceleration = edge_opening_acceleration(STACK)
    x = (np.arange(20000) + 0.5) / 20000 * 1.1 - 0.55
    moment_arm = acceleration / GRAVITY * STACK.centroid_height  # of the resultant, towards the loaded side
    pressure = 1.0 + moment_arm * x / np.mean(x**2)
    assert pressure.mean() == pytest.approx(1.0)
    assert pressure.min() == pytest.approx(0.0, abs=1e-4)
    assert acceleration == pytest.approx(GRAVITY * 1.1 / (3.0 * 4.0), rel=1e-14)


def test_stack_with_finite_friction_at_0_1_m_and_8_rad_s():
    # Largest rotation 0.100303 rad (the second turning point; the first is 0.0355) and slip 81.1 mm at 2.5 s
    # (computed, independent), mu 0.3 both.
    block = PlanarBlock(body=STACK, mu_static=0.3, mu_kinetic=0.3)
    motion = simulate_planar_block(block, sine_floor(amplitude=0.1, angular_frequency=8.0), duration=2.5)
    assert motion.largest_rotation == pytest.approx(0.100303, abs=5e-7)
    assert motion.peaks[1][1] == pytest.approx(-0.100303, abs=5e-7)
    assert motion.at(np.array([2.5])).slip[0] == pytest.approx(81.1e-3, abs=5e-5)
    assert motion.outcome is PlanarMode.SLIDE_ROCK


def test_stack_under_the_plateau_value_rocks_without_slip():
    # Peak 4.0 m/s2 at 6.928 rad/s, mu 0.4/0.2: 0.399 al in 8 s without slip (computed, independent).
    block = PlanarBlock(body=STACK, mu_static=0.4, mu_kinetic=0.2)
    floor = sine_floor(amplitude=4.0 / 6.928**2, angular_frequency=6.928)
    motion = simulate_planar_block(block, floor, duration=8.0)
    assert motion.outcome is PlanarMode.ROCK
    assert motion.largest_rotation / STACK.slenderness_angle == pytest.approx(0.399, abs=5e-4)
    assert np.abs(motion.at(np.linspace(0.0, 8.0, 101)).slip).max() == 0.0


def test_stack_under_its_stated_motion_stays_at_rest():
    # x = 50 mm sin(6.928 t), moving with the floor: 2.40 < 2.698 < 3.924 m/s2.
    block = PlanarBlock(body=STACK, mu_static=0.4, mu_kinetic=0.2)
    floor = sine_floor(amplitude=0.05, angular_frequency=6.928)
    assert simulate_planar_block(block, floor, duration=10.0).outcome is PlanarMode.REST


def test_stack_at_rest_on_a_floor_that_jerks():
    # 50 mm, start at rest, mu 0.4/0.4: the jerk rocks it to 0.2505 al (computed, independent).
    # These four digits belong to 6.93 rad/s; at 6.928 rad/s it is 0.2504.
    block = PlanarBlock(body=STACK, mu_static=0.4, mu_kinetic=0.4)
    for omega, ratio in ((6.93, 0.2505), (6.928, 0.2504)):
        floor = sine_floor(amplitude=0.05, angular_frequency=omega)
        motion = simulate_planar_block(block, floor, duration=20.0, slip_velocity=-0.05 * omega)
        assert motion.largest_rotation / STACK.slenderness_angle == pytest.approx(ratio, abs=5e-5)
