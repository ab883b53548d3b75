"""The Newmark family with steps that change; the energy ledger of what slides, rings and rocks.

Its order where nothing switches is a row of `verify`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, Rig, rig
from closed_forms import damped_drop_restitution
from evidence.findings import Convergence
from verification.time_stepping import oscillator_error

from contact.motion.base_motion import HarmonicMotion, PulseMotion
from contact.stepping.ledger import BASE_WORK, CONTACT_DAMPING, FRICTION, IMBALANCE, MATERIAL_DAMPING
from contact.stepping.scheme import generalised_alpha, newmark

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


SCHEMES = {f"rho {radius:g}": generalised_alpha(radius) for radius in (0.0, 0.3, 0.5, 0.8, 1.0)}
SCHEMES["average acceleration"] = newmark(0.25, 0.5)


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_steps_that_change_all_the_time_keep_the_second_order(scheme):
    # The scheme's acceleration lags; were it not shifted when the step changes, the order would fall to one.
    errors = {}
    for h in 1e-2 / 2.0 ** np.arange(4):
        pattern = np.tile([0.9, 0.3, 0.5, 0.7], round(1.0 / (2.4 * h)) + 4)
        errors[h] = oscillator_error(scheme, h, 1.0, np.cumsum(pattern) * h)
    orders = Convergence("step [s]", errors, order=2.0, within=0.1)
    assert orders.passed, orders


@pytest.mark.parametrize("heave_ratio", [0.05, 0.1, 0.2, 0.5])
def test_the_steps_of_the_control_resolve_a_damped_landing(heave_ratio):
    # The whole mass on one corner has sqrt 2 less than the heave ratio: k is then half, c is half.
    ratio, speed = heave_ratio / math.sqrt(2.0), 0.5
    block = Block(height=1.0, mass=2500.0, gravity=0.0, bounce_frequency=20.0, damping_ratio=ratio)
    falling = {"centre": (0.0, 0.501), "velocity": (0.0, -speed), "force": np.zeros((2, 2))}
    state = rig(block, stance=replace(Block(height=1.0).standing(), **falling)).advance(0.1).run.old
    assert (state.point[:, 1] > 0.0).all()  # it has left the floor
    assert abs(state.position[2]) < 1e-12
    assert state.velocity[1] / speed == pytest.approx(damped_drop_restitution(heave_ratio), abs=0.01)


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
