import math

import numpy as np
import pytest
from floors import sine_floor, still_floor
from rigid_slider import RigidSlider, simulate_sliding
from scipy.optimize import brentq

from contact.reference.floor_acceleration import Acceleration, FloorAcceleration
from contact.reference.planar_block import PlanarBlock, simulate_planar_block
from contact.reference.planar_equations import energy
from contact.reference.planar_motion import PlanarMode
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
BOX = RigidBlock.homogeneous(width=1.1, height=1.0)


def test_with_friction_to_spare_it_is_the_rocking_block():
    floor = sine_floor(amplitude=0.1, angular_frequency=8.0)
    planar = simulate_planar_block(
        PlanarBlock(body=STACK, mu_static=5.0, mu_kinetic=5.0), floor, duration=8.0
    )
    rocking = simulate_rocking(STACK, floor, duration=8.0)
    times = np.linspace(0.0, 8.0, 201)
    assert planar.outcome is PlanarMode.ROCK
    assert len(planar.impacts) == len(rocking.impacts) > 10
    assert planar.at(times).rotation == pytest.approx(rocking.at(times)[0], abs=1e-10)
    assert planar.at(times).slip.tolist() == [0.0] * 201


def test_a_squat_block_is_the_slider():
    floor = sine_floor(amplitude=0.05, angular_frequency=10.0)
    planar = simulate_planar_block(PlanarBlock(body=BOX, mu_static=0.4, mu_kinetic=0.2), floor, duration=5.0)
    slider = simulate_sliding(RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=9.81), floor, duration=5.0)
    times = np.linspace(0.0, 5.0, 201)
    assert planar.outcome is PlanarMode.SLIDE
    assert planar.largest_rotation == 0.0
    assert planar.at(times).slip == pytest.approx(slider.at(times)[0], abs=1e-12)


def test_free_rocking_slides_at_the_impact_when_friction_is_below_the_need():
    # 0.2024 for the stack; the energy never grows, whatever slides.
    block = PlanarBlock(body=STACK, mu_static=0.2, mu_kinetic=0.2)
    motion = simulate_planar_block(block, still_floor(), duration=3.0, rotation=0.02)
    assert motion.impacts[0].slides
    assert motion.outcome is PlanarMode.SLIDE_ROCK
    levels = [
        energy(STACK, motion.states[piece.regime].side, piece.interpolant(t))
        for piece in motion.pieces
        for t in (piece.start, piece.end)
    ]
    # velocities are integrated to 1e-12 a step, energy to a few times that
    assert np.diff(levels).max() <= 1e-11 * levels[0]
    assert levels[-1] < 0.5 * levels[0]


def test_endless_impacts_end_in_rest_or_in_sliding():
    still = simulate_planar_block(
        PlanarBlock(body=STACK, mu_static=0.4, mu_kinetic=0.4), still_floor(), duration=20.0, rotation=0.1
    )
    assert still.transitions[-1].state.mode is PlanarMode.REST
    # pushed along on slippery ground, it stops rocking before it stops sliding
    pushed = simulate_planar_block(
        PlanarBlock(body=BOX, mu_static=0.1, mu_kinetic=0.1),
        still_floor(),
        duration=5.0,
        rotation=0.02,
        slip_velocity=2.0,
    )
    names = [transition.state.mode for transition in pushed.transitions]
    assert names[-2:] == [PlanarMode.SLIDE, PlanarMode.REST]


def test_a_block_too_slender_to_slide_upright_trips():
    # mu_k above B/H: pushed along, it turns about its leading corner.
    block = PlanarBlock(body=STACK, mu_static=0.4, mu_kinetic=0.4)
    motion = simulate_planar_block(block, still_floor(), duration=0.05, slip_velocity=0.5)
    assert motion.transitions[0].state.mode is PlanarMode.SLIDE_ROCK
    assert motion.at(np.array([0.05])).rotation[0] > 0.0


def test_a_jump_of_the_floor_that_exceeds_friction_for_an_instant_is_not_missed():
    # The stick limit of a rocking block is passed by a millionth at the jump, and is met again at once.
    block = PlanarBlock(body=STACK, mu_static=0.4, mu_kinetic=0.4)
    calm = simulate_planar_block(block, still_floor(), duration=0.05, rotation=0.1)
    values, state = calm.pieces[-1].interpolant(0.05), calm.states[-1]

    def margin(peak):
        return block.stick_margin(block.contact(state, values, Acceleration(peak)))

    limit = brentq(margin, 0.0, 20.0, xtol=1e-14)
    times = (0.0, 0.05, 0.1)
    for factor, slips in ((1.0 + 1e-6, True), (1.0 - 1e-6, False)):

        def acceleration(time, peak=factor * limit):
            return peak * (2.0 - time / 0.05) if 0.05 <= time < 0.1 else 0.0

        floor = FloorAcceleration(function=acceleration, break_times=times, longest_step=math.inf)
        motion = simulate_planar_block(block, floor, duration=0.1, rotation=0.1)
        assert (motion.transitions[1:2] != ()) is slips
        if slips:
            assert motion.transitions[1].reason == "slips"
            assert motion.transitions[1].time == 0.05


def test_overturning_ends_the_motion():
    block = PlanarBlock(body=STACK, mu_static=1.0, mu_kinetic=1.0)
    motion = simulate_planar_block(block, still_floor(), duration=20.0, rotation=-0.3)
    assert motion.outcome is PlanarMode.OVERTURNED
    assert motion.end < 20.0
    assert motion.largest_rotation == pytest.approx(0.5 * math.pi, abs=1e-12)


def test_free_flight_is_reported_and_not_followed():
    # Turning at 6 rad/s, the centroid would need a pull: g < R w^2 cos(al).
    block = PlanarBlock(body=STACK, mu_static=1.0, mu_kinetic=1.0)
    motion = simulate_planar_block(block, still_floor(), duration=1.0, rotation=0.01, angular_velocity=6.0)
    assert motion.outcome is PlanarMode.OUTSIDE
    assert motion.end == 0.0
    assert np.isnan(motion.at(np.array([0.5])).rotation[0])
    assert motion.at(np.array([0.5])).modes == (None,)


def test_nonsense_is_refused():
    with pytest.raises(ValueError, match="mu_kinetic must not exceed mu_static"):
        PlanarBlock(body=STACK, mu_static=0.2, mu_kinetic=0.3)
    block = PlanarBlock(body=STACK, mu_static=0.3, mu_kinetic=0.3)
    with pytest.raises(ValueError, match="duration"):
        simulate_planar_block(block, still_floor(), duration=math.inf)
    with pytest.raises(ValueError, match="90 degrees"):
        simulate_planar_block(block, still_floor(), duration=1.0, rotation=-1.6)
