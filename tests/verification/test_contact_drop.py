"""A block that lands flat on its floor: one degree of freedom, known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import Block, Rig, rig

from contact.reference.closed_forms_rocking import damped_drop_restitution
from contact.stepping.ledger import CRUSHING, IMBALANCE

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
    assert run.run.ledger[:-1] == pytest.approx(np.zeros(5), abs=1e-9 * kinetic)
    assert abs(run.run.ledger[IMBALANCE]) <= 1e-3 * kinetic


def landed(share: float, step: float) -> tuple[Rig, float, float]:
    """A landing without dashpot and gravity on springs k with the cap F, this share of the force of the elastic one.

    Returns:
        The run after it, the cap of both corners together [N], and the exact indentation [m]: F^2/2k comes back.
    """
    block = Block(height=1.0, mass=2500.0, gravity=0.0, bounce_frequency=50.0, damping_ratio=0.0)
    cap = share * SPEED * math.sqrt(block.base_stiffness * block.mass)
    indentation = (0.5 * block.mass * SPEED**2 - 0.5 * cap**2 / block.base_stiffness) / cap
    options = {"largest_step": step, "fixed_step": True, "sampled": step}
    return falling(replace(block, cap=0.5 * cap), 0.0, **options).advance(0.02), cap, indentation


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_a_landing_that_crushes_the_floor_leaves_the_elastic_part(share):
    run, cap, indentation = landed(share, 1e-4)
    state, ledger = run.run.old, run.run.ledger
    assert (state.point[:, 1] > 0.0).all()  # it has left the floor
    assert state.crushed == pytest.approx(np.full(2, indentation), rel=3e-4)
    assert state.velocity[1] / SPEED == pytest.approx(share, rel=3e-4)
    assert run.force[:, :, 1].max() == pytest.approx(0.5 * cap, rel=1e-9)
    assert ledger[CRUSHING] == pytest.approx(cap * indentation, rel=5e-4)
    assert abs(ledger[IMBALANCE]) <= 1e-4 * (0.5 * run.block.mass * SPEED**2)


def test_the_indentation_converges_with_the_second_order():
    # The error of one run depends on where in a step the floor begins to crush: take the mean of many.
    steps, shares, errors = 4e-4 / 2.0 ** np.arange(4), np.linspace(0.3, 0.7, 21), []
    for step in steps:
        found = [landed(share, step) for share in shares]
        errors.append(np.mean([abs(run.run.old.crushed[0] / exact - 1.0) for run, _, exact in found]))
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.25)


def test_a_cap_above_all_forces_changes_no_bit():
    block = Block(height=1.0, mass=2500.0)
    stance = replace(
        block.standing(), centre=(0.0, 0.6), rotation=0.1, angular_velocity=-1.0, force=np.zeros((2, 2))
    )
    runs = [rig(replace(block, cap=cap), stance=stance).advance(3.0).run for cap in (math.inf, 1e12)]
    assert runs[0].old.numbers.tobytes() == runs[1].old.numbers.tobytes()
    assert runs[0].ledger.tobytes() == runs[1].ledger.tobytes()
    assert not runs[1].old.crushed.any()


def test_contact_forces_never_pull_in_a_landing_that_rocks():
    block = Block(height=1.0, mass=2500.0)
    stance = replace(
        block.standing(), centre=(0.0, 0.6), rotation=0.1, angular_velocity=-1.0, force=np.zeros((2, 2))
    )
    run = rig(block, stance=stance, sampled=1e-3).advance(3.0)
    assert run.force[:, :, 1].max() > block.mass * 9.81
    assert run.force[:, :, 1].min() >= 0.0
    assert (np.abs(run.force[:, :, 0]) <= 0.4 * run.force[:, :, 1] + 1e-6).all()
