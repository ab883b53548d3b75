"""A block that lands flat on its floor, or slides: one degree of freedom, known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, rig
from closed_forms_rocking import damped_drop_restitution

from contact.motion.base_motion import PulseMotion

SPEED = 0.5  #: of the approach [m/s]


@pytest.mark.parametrize("heave_ratio", [0.05, 0.1, 0.2, 0.5])
def test_the_steps_of_the_control_resolve_a_damped_landing(heave_ratio):
    # The whole mass on one corner has sqrt 2 less than the heave ratio: k is then half, c is half.
    ratio = heave_ratio / math.sqrt(2.0)
    block = Block(height=1.0, mass=2500.0, gravity=0.0, bounce_frequency=20.0, damping_ratio=ratio)
    falling = {"centre": (0.0, 0.501), "velocity": (0.0, -SPEED), "force": np.zeros((2, 2))}
    state = rig(block, stance=replace(Block(height=1.0).standing(), **falling)).advance(0.1).run.old
    assert (state.point[:, 1] > 0.0).all()  # it has left the floor
    assert abs(state.position[2]) < 1e-12
    assert state.velocity[1] / SPEED == pytest.approx(damped_drop_restitution(heave_ratio), abs=0.01)


def test_slip_leaves_out_the_elastic_stick():
    # A corner moves by its slip and the elongation of its spring, mu_k N/k; a low block: both carry alike.
    block = Block(height=0.05, mass=2500.0, bounce_frequency=20.0, mu_static=0.4, mu_kinetic=0.2)
    pull = PulseMotion(shape="rectangular", acceleration=0.6 * GRAVITY, pulse=100.0)
    run = rig(block, motion=pull).advance(0.5)
    state = run.run.old
    stick = float(state.stick.mean())
    assert abs(stick) == pytest.approx(0.2 * block.mass * GRAVITY / block.base_stiffness, rel=0.01)
    moved = float((state.point[:, 0] - block.point[:, 0]).mean())
    assert moved - float(run.joint.slip) == pytest.approx(stick, rel=0.02)
