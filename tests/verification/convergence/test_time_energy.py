"""The energy ledger of what slides, rings and rocks; its order where nothing switches is a row of `verify`."""

import numpy as np
from block_on_floor import GRAVITY, Block, Rig, rig

from contact.motion.base_motion import HarmonicMotion
from contact.stepping.ledger import BASE_WORK, CONTACT_DAMPING, FRICTION, IMBALANCE, MATERIAL_DAMPING

SHAPE = np.array([[[1.0], [0.5]], [[-1.0], [0.5]]]) / 100.0


def largest_imbalance(run: Rig) -> float:
    return max(abs(float(run.clock.least_imbalance)), abs(float(run.clock.most_imbalance)))


def test_the_ledger_holds_every_term_of_a_ringing_sliding_block():
    """Friction, contact and material damping and base work together, at the steps the control chooses."""
    block = Block(height=1.0, mass=2500.0, bounce_frequency=158.0, mu_static=0.3, mu_kinetic=0.2)
    run = rig(
        block,
        motion=HarmonicMotion(amplitude=0.05, angular_frequency=12.0, duration=10.0),
        shape=SHAPE,
        frequencies=np.array([300.0]),
        damping_ratios=np.array([0.02]),
        amplitudes=np.array([0.05]),
    )
    before = run.run.old.energy.sum()
    run.advance(3.0)
    ledger = run.run.ledger
    assert min(ledger[[FRICTION, CONTACT_DAMPING, MATERIAL_DAMPING]]) > 0.0
    stored = run.run.old.energy.sum() - before
    springs = ledger[BASE_WORK] - ledger[1:].sum() - stored
    # what is left is the change of the contact springs' energy: at most that of a few weights on them
    assert abs(springs) <= 4.0 * (block.mass * GRAVITY) ** 2 / block.base_stiffness
    assert abs(ledger[IMBALANCE]) <= 1e-2 * ledger[[FRICTION, CONTACT_DAMPING, MATERIAL_DAMPING]].sum()


def test_the_imbalance_of_rocking_falls_with_the_tolerance():
    block = Block()
    motion = HarmonicMotion(amplitude=4.0 / 6.928**2, angular_frequency=6.928, duration=20.0)
    errors = [
        largest_imbalance(rig(block, motion=motion, energy_scale=scale).advance(8.0)) / block.reference_energy
        for scale in (1.0, 0.1, 0.01)
    ]
    assert errors[0] <= 1e-2
    assert errors[1] <= 0.5 * errors[0]
    assert errors[2] <= 0.5 * errors[1]
