"""The energy ledger closes to second order of the step where nothing switches, and audits what does."""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, Rig, rig

from contact.motion.base_motion import HarmonicMotion
from contact.stepping.ledger import BASE_WORK, CONTACT_DAMPING, FRICTION, IMBALANCE, MATERIAL_DAMPING
from contact.stepping.scheme import Scheme, generalised_alpha, newmark

SCHEMES = {
    "rho 0": generalised_alpha(0.0),
    "rho 0.5": generalised_alpha(0.5),
    "rho 0.8": generalised_alpha(0.8),
}
SHAPE = np.array([[[1.0], [0.5]], [[-1.0], [0.5]]]) / 100.0


def largest_imbalance(run: Rig) -> float:
    return max(abs(float(run.clock.least_imbalance)), abs(float(run.clock.most_imbalance)))


def observed_order(steps: np.ndarray, errors: list[float]) -> float:
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def bouncing(scheme: Scheme, step: float, damping_ratio: float, turning: float = 0.3) -> Rig:
    """A block that bounces and rolls on its two springs without ever opening one, from consistent forces."""
    block = Block(height=1.0, mass=2500.0, bounce_frequency=10.0, damping_ratio=damping_ratio, mu_static=50.0)
    settled = block.standing()
    speed = 0.3 * GRAVITY / (2.0 * math.pi * block.bounce_frequency)
    springs = block.contact().normal_stiffness
    force = settled.force.copy()
    force[:, 1] += springs * block.relaxation_time * np.array([1.0 - turning, 1.0 + turning]) * speed
    stance = replace(settled, velocity=(0.0, -speed), angular_velocity=turning * speed / 0.55, force=force)
    force[:, 0] = springs * block.relaxation_time * stance.angular_velocity * 0.5
    run = rig(block, stance=stance, scheme=scheme, largest_step=step, fixed_step=True, sampled=1e3)
    run.run.old.stick[:] = 0.0  # the tangential dashpots work at first, their springs do not
    run.advance(0.5)
    assert run.track.first_opening == math.inf
    assert run.joint.slip_travel == 0.0
    return run


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
@pytest.mark.parametrize("damping_ratio", [0.0, 0.3])
def test_the_ledger_closes_to_second_order_on_closed_springs(scheme, damping_ratio):
    steps = 8e-4 / 2.0 ** np.arange(4)
    errors = [largest_imbalance(bouncing(scheme, h, damping_ratio)) for h in steps]
    assert observed_order(steps, errors) >= 1.9


def test_average_acceleration_keeps_the_energy_of_springs_to_rounding():
    run = bouncing(newmark(0.25, 0.5), 8e-4, 0.0, turning=0.0)
    assert largest_imbalance(run) <= 1e-14 * run.clock.steps * run.run.old.energy.sum()


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
