"""A block that lands flat on its floor: one degree of freedom, known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import Block, Rig, rig
from closed_forms_rocking import damped_drop_restitution

from contact.stepping.ledger import IMBALANCE

SPEED = 0.5  #: of the approach [m/s]


def falling(block: Block, gap: float, **options) -> Rig:
    """Above the floor by `gap` [m], coming down."""
    centre = (0.0, 0.5 * block.height + gap)
    stance = replace(
        Block(height=block.height).standing(), centre=centre, velocity=(0.0, -SPEED), force=np.zeros((2, 2))
    )
    return rig(block, stance=stance, **options)


@pytest.mark.parametrize("heave_ratio", [0.05, 0.1, 0.2, 0.5])
def test_the_steps_of_the_control_resolve_a_damped_landing(heave_ratio):
    # The whole mass on one corner has sqrt 2 less than the heave ratio: k is then half, c is half.
    ratio = heave_ratio / math.sqrt(2.0)
    block = Block(height=1.0, mass=2500.0, gravity=0.0, bounce_frequency=20.0, damping_ratio=ratio)
    state = falling(block, 1e-3).advance(0.1).run.old
    assert (state.point[:, 1] > 0.0).all()  # it has left the floor
    assert abs(state.position[2]) < 1e-12
    assert state.velocity[1] / SPEED == pytest.approx(damped_drop_restitution(heave_ratio), abs=0.01)


def test_an_undamped_drop_keeps_bouncing_to_the_same_height():
    block = Block(height=1.0, mass=2500.0, bounce_frequency=50.0, damping_ratio=0.0)
    run = falling(block, 0.0, energy_scale=0.01).advance(0.5)
    kinetic = 0.5 * block.mass * SPEED**2
    assert run.run.ledger[:-1] == pytest.approx(np.zeros(6), abs=1e-9 * kinetic)
    assert abs(run.run.ledger[IMBALANCE]) <= 1e-3 * kinetic


@pytest.mark.parametrize("growth", [0.0, 200.0])
def test_a_landing_crushes_until_a_cap_that_grows_has_taken_its_energy(growth):
    # m v^2/2 = 2 F d (1 + g d/2) for the two corners; the springs below store 0.2 J of the 312.5
    block = Block(
        height=1.0,
        mass=2500.0,
        gravity=0.0,
        bounce_frequency=200.0,
        damping_ratio=0.3,
        cap=20e3,
        cap_growth=growth,
    )
    share = 0.25 * block.mass * SPEED**2 / block.cap
    depth = 2.0 * share / (1.0 + math.sqrt(1.0 + 2.0 * growth * share))
    assert falling(block, 1e-3).advance(0.2).run.old.crushed == pytest.approx([depth] * 2, rel=0.02)


def test_contact_forces_never_pull_in_a_landing_that_rocks():
    block = Block(height=1.0, mass=2500.0)
    stance = replace(
        block.standing(), centre=(0.0, 0.6), rotation=0.1, angular_velocity=-1.0, force=np.zeros((2, 2))
    )
    run = rig(block, stance=stance, sampled=1e-3).advance(3.0)
    assert run.force[:, :, 1].max() > block.mass * 9.81
    assert run.force[:, :, 1].min() >= 0.0
    assert (np.abs(run.force[:, :, 0]) <= 0.4 * run.force[:, :, 1] + 1e-6).all()
