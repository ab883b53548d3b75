"""A block on a travelling floor, and one thrown: what `python -m fem verify` does not check of invariance."""

import numpy as np
import pytest
from block_on_floor import Block, Rig, piecewise_motion, rig

from contact.interface.equilibrium import Stance

BLOCK = Block(mu_kinetic=0.2)
KNOTS, ACCELERATIONS = [0.1, 0.5, 0.9, 1.3], [4.5, -4.5, 4.5, 0.0]


def riding(velocity: float) -> Rig:
    """The stack on a floor that coasts, is jerked forth and back, and coasts on."""
    motion = piecewise_motion(KNOTS, ACCELERATIONS, velocity=velocity, displacement=0.1 * velocity)
    return rig(BLOCK, motion=motion, breaks=np.array(KNOTS)).advance(3.0)


def test_the_step_control_sees_little_of_a_floor_that_travels_besides():
    # The ledger's base work depends on the frame, and with it, slightly, the choice of steps.
    standing, riding_along = riding(0.0), riding(3.0)
    assert np.abs(standing.rotation).max() > 0.2 * BLOCK.slenderness_angle
    n = min(standing.rotation.size, riding_along.rotation.size)
    difference = np.abs(riding_along.rotation[:n] - standing.rotation[:n]).max()
    assert difference <= 1e-3 * BLOCK.slenderness_angle


def test_a_thrown_rigid_block_spins_and_falls_as_it_was_thrown():
    thrown = Stance(
        centre=(0.0, 100.0), rotation=0.1, velocity=(1.5, 4.0), angular_velocity=0.7, force=np.zeros((2, 2))
    )
    run = rig(Block(), stance=thrown).advance(1.5)
    x, z, rotation = run.run.old.position
    assert rotation == pytest.approx(0.1 + 0.7 * run.time, rel=1e-12)
    assert x == pytest.approx(1.5 * run.time, rel=1e-12)
    assert z == pytest.approx(100.0 + 4.0 * run.time - 0.5 * 9.81 * run.time**2, rel=1e-12)
    assert run.run.ledger == pytest.approx(np.zeros(5), abs=1e-9 * run.block.mass)
