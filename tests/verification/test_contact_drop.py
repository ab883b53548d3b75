"""A block that lands flat on its floor: one degree of freedom, known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import Block, Rig, rig

from contact.reference.closed_forms_rocking import damped_drop_restitution, drop_force

SPEED = 0.5  #: of the approach [m/s]


def falling(block: Block, gap: float, speed: float, **options) -> Rig:
    """Above the floor by `gap` [m], coming down, the floor not yet touched."""
    settled = Block(height=block.height).standing()
    stance = replace(
        settled,
        centre=(0.0, 0.5 * block.height + gap),
        rotation=0.0,
        velocity=(0.0, -speed),
        force=np.zeros((2, 2)),
    )
    return rig(block, stance=stance, **options)


def rebound(heave_ratio: float, **options) -> float:
    """Speed of the rebound over that of the approach, without gravity."""
    # The whole mass on one corner has sqrt 2 less than the heave ratio: k is then half, c is half.
    block = Block(
        height=1.0,
        mass=2500.0,
        gravity=0.0,
        bounce_frequency=20.0,
        damping_ratio=heave_ratio / math.sqrt(2.0),
    )
    run = falling(block, 1e-3, SPEED, **options).advance(0.1)
    assert (run.run.old.point[:, 1] > 0.0).all()  # it has left the floor
    assert abs(run.run.old.position[2]) < 1e-12
    return float(run.run.old.velocity[1]) / SPEED


@pytest.mark.parametrize("heave_ratio", [0.05, 0.1, 0.2, 0.5])
def test_the_steps_of_the_control_resolve_a_damped_landing(heave_ratio):
    assert rebound(heave_ratio) == pytest.approx(damped_drop_restitution(heave_ratio), abs=0.01)


def test_the_steps_of_the_control_find_the_largest_force():
    block = Block(height=1.0, mass=2500.0, bounce_frequency=50.0, damping_ratio=0.0)
    expected = drop_force(mass=2500.0, stiffness=block.base_stiffness, speed=1.0, gravity=9.81)
    run = falling(block, 0.0, 1.0).advance(0.03)
    assert 2.0 * run.track.peak_corner_force == pytest.approx(expected, rel=2e-3)
    assert run.run.ledger[2:4] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_an_undamped_drop_keeps_bouncing_to_the_same_height():
    # Free flight of 0.5 m/s, landing, and again: speeds at three landings, energy kept by small steps.
    block = Block(height=1.0, mass=2500.0, bounce_frequency=50.0, damping_ratio=0.0)
    run = falling(block, 0.0, SPEED, energy_scale=0.01).advance(0.5)
    kinetic = 0.5 * block.mass * SPEED**2
    assert run.run.ledger[:4] == pytest.approx(np.zeros(4), abs=1e-9 * kinetic)
    assert abs(run.run.ledger[4]) <= 1e-3 * kinetic


def test_contact_forces_never_pull_in_a_landing_that_rocks():
    block = Block(height=1.0, mass=2500.0)
    stance = replace(
        block.standing(), centre=(0.0, 0.6), rotation=0.1, angular_velocity=-1.0, force=np.zeros((2, 2))
    )
    run = rig(block, stance=stance, sampled=1e-3).advance(3.0)
    assert run.force[:, :, 1].max() > block.mass * 9.81
    assert run.force[:, :, 1].min() >= 0.0
    assert (np.abs(run.force[:, :, 0]) <= 0.4 * run.force[:, :, 1] + 1e-6).all()
