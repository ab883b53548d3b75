"""The time stepper of rigid boxes in `moreau` by itself, before anything is compared with it."""

import math

import numpy as np
import pytest
from floors import half_sine_pulse, sine_floor
from moreau import Boxes, move_boxes, slide_and_rock
from rigid_slider import RigidSlider, simulate_sliding
from runs import BLOCK
from two_blocks import StackedBlock, TwoBlockStack, simulate_two_blocks

from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.planar_block import PlanarBlock, simulate_planar_block

pytestmark = pytest.mark.slow  # as what is compared with it
ONE = Boxes([1.1], [4.0], [10e3])
OMEGA = 6.928  # of the default motion [rad/s]
STEP = 5e-4


def shaken(peak, duration, step=STEP):
    """A floor peak/Omega^2 sin(Omega t): accelerations at the middles of steps."""
    return -peak * np.sin(OMEGA * step * (np.arange(round(duration / step)) + 0.5))


def sampled(floor: FloorAcceleration, duration, step):
    return np.array([floor.function(step * (k + 0.5)) for k in range(round(duration / step))])


def test_one_box_rocks_as_the_event_driven_block():
    found = move_boxes(ONE, shaken(4.0, 6.0), step=STEP, mu_static=0.4)
    floor = sine_floor(amplitude=4.0 / OMEGA**2, angular_frequency=OMEGA)
    exact = simulate_planar_block(
        PlanarBlock(body=BLOCK, mu_static=0.4, mu_kinetic=0.4), floor, duration=6.0
    ).largest_rotation
    assert exact / BLOCK.slenderness_angle == pytest.approx(0.3992, abs=1e-4)
    assert found.max_rotation[0] == pytest.approx(exact, rel=2e-3)
    assert found.max_slip[0] < 2e-5


def test_one_box_slides_as_the_event_driven_slider():
    floor = sine_floor(amplitude=6.0 / OMEGA**2, angular_frequency=OMEGA)
    squat = Boxes([4.0], [1.0], [10e3])
    fine = 0.25 * STEP
    found = move_boxes(squat, shaken(6.0, 5.0, fine), step=fine, mu_static=0.4, mu_kinetic=0.2)
    slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=9.81)
    slip = simulate_sliding(slider, floor, duration=5.0).at(found.times)[0]
    assert found.slip[:, 0] == pytest.approx(slip, abs=1e-3 * np.abs(slip).max())


def test_the_kernel_for_one_box_does_the_same():
    mus, peaks = ((0.4, 0.4), (0.4, 0.2), (0.2, 0.2), (0.4, 0.4)), np.array([4.0, 4.0, 4.0, 12.0])
    block, found = np.tile([0.55, 2.0, 10e3 / ONE.inertia[0]], (4, 1)), np.zeros((4, 3))
    amplitude, frequency = peaks / OMEGA**2, np.full(4, OMEGA)
    slide_and_rock(block, np.array(mus), 9.81, amplitude, frequency, False, STEP, 12000, found)
    for (mu_static, mu_kinetic), (rotation, slip, _) in zip(mus[:3], found, strict=False):
        general = move_boxes(ONE, shaken(4.0, 6.0), step=STEP, mu_static=mu_static, mu_kinetic=mu_kinetic)
        assert rotation == pytest.approx(general.max_rotation[0], abs=2e-5)
        assert slip == pytest.approx(general.max_slip[0], abs=2e-5)
    general = move_boxes(ONE, shaken(4.0, 6.0), step=STEP, mu_static=0.4)
    assert found[0, 0] == pytest.approx(general.max_rotation[0], rel=1e-6)
    assert found[:, 2].tolist() == [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize("box", [(1.1, 2.0), (0.7, 2.0), (1.4, 0.9)])
def test_two_boxes_pass_from_pattern_to_pattern_as_the_event_driven_ones(box):
    lower = StackedBlock.homogeneous(width=1.1, height=2.0, mass=5000.0)
    upper = StackedBlock.homogeneous(width=box[0], height=box[1], mass=3000.0)
    stack = TwoBlockStack(lower=lower, upper=upper, gravity=9.81)
    floor, errors = half_sine_pulse(peak=9.81, duration=0.15), []
    exact = simulate_two_blocks(stack, floor, duration=1.0)
    assert len(exact.impacts) >= 1
    boxes = Boxes([1.1, box[0]], [2.0, box[1]], [5000.0, 3000.0])
    for step in (1e-3, 2.5e-4):
        found = move_boxes(
            boxes, sampled(floor, 1.0, step), step=step, mu_static=3.0, every=round(0.01 / step)
        )
        assert found.max_slip.max() < 1e-5  # nothing slides
        errors.append(np.abs(found.place[:, :, 2] - exact.at(found.times)[:, [0, 2]]).max())
    assert errors[1] < 0.5 * errors[0] < 5e-3


def test_a_box_is_pulled_from_under_another_one_and_that_falls():
    # frictionless joint: the upper box stays where it is; beyond half a width it tips into the gap beside
    two = Boxes([1.0, 1.0], [1.0, 1.0], [1000.0, 1000.0])
    pull = np.where(np.arange(2000) < 500, 3.0, 0.0)
    found = move_boxes(two, pull, step=1e-3, mu_static=np.array([0.9, 0.0]), every=1)
    gone = 0.5 * 3.0 * 0.3**2
    assert found.place[300, 0, 0] == pytest.approx(0.0, abs=1e-9)
    assert found.slip[300, 1] == pytest.approx(-gone, rel=1e-3)
    assert found.fell_box == 1
    assert math.isfinite(found.fell_at)
