"""Sticking and sliding of a stepped block against closed forms of the rigid slider.

The block stands on two elastic corners; its stick is elastic. What the closed forms of a rigid slider leave
out is of the order of the time in which the stick springs reverse, and falls with their stiffness.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, Rig, rig

from contact.arrays import FloatArray
from contact.motion.base_motion import HarmonicMotion, PulseMotion

#: the single box of the seed paper; 158 Hz is the penalty that a case chooses for it
BOX = Block(height=1.0, mass=2500.0, bounce_frequency=158.0, mu_static=0.4, mu_kinetic=0.2)
AMPLITUDE = 0.05  #: of the floor [m]


def constant_pull(acceleration: float) -> PulseMotion:
    return PulseMotion(shape="rectangular", acceleration=acceleration, pulse=100.0)


def test_slip_leaves_out_the_elastic_stick():
    # A corner moves by its slip and the elongation of its spring, mu_k N/k; a low block: both carry alike.
    block = replace(BOX, height=0.05, bounce_frequency=20.0)
    run = rig(block, motion=constant_pull(0.6 * GRAVITY)).advance(0.5)
    state = run.run.old
    stick = float(state.stick.mean())
    assert abs(stick) == pytest.approx(0.2 * block.mass * GRAVITY / block.base_stiffness, rel=0.01)
    moved = float((state.point[:, 0] - block.point[:, 0]).mean())
    assert moved - float(run.joint.slip) == pytest.approx(stick, rel=0.02)


def steady(run: Rig, period: float) -> FloatArray:
    """Slip over the last cycle [m]."""
    return run.slip[-round(period / run.run.buffers.history.interval) - 1 :]


def shaken(block: Block, angular_frequency: float, cycles: float, **options) -> Rig:
    period = 2.0 * math.pi / angular_frequency
    motion = HarmonicMotion(amplitude=AMPLITUDE, angular_frequency=angular_frequency, duration=1e3)
    return rig(block, motion=motion, sampled=period / 200.0, **options).advance(cycles * period)


def test_the_error_of_a_stroke_falls_with_the_stiffness_of_the_stick():
    # Rigid slider: stroke 1.237982 amplitudes.
    # Elongations fall as 1/k; the time in which a reversing block takes them up falls as their root.
    omega = math.sqrt(0.2 * GRAVITY / (0.5 * AMPLITUDE))
    errors = []
    for frequency in (50.0, 158.0, 500.0):
        block = replace(BOX, mu_static=0.2, bounce_frequency=frequency)
        run = shaken(block, omega, 15.0, energy_scale=0.1, largest_step=2e-3)
        errors.append(abs(np.ptp(steady(run, 2.0 * math.pi / omega)) / AMPLITUDE - 1.237982))
    assert errors[1] <= 0.45 * errors[0]
    assert errors[2] <= 0.45 * errors[1]


def test_a_slip_distance_for_weakening_shortens_the_stroke_and_nothing_else():
    # While it weakens the floor takes more of the block along: the strokes shrink, a little.
    strokes = [shaken(replace(BOX, weakening=w), 10.0, 12.0).joint.max_slip for w in (0.0, 1e-5, 1e-4)]
    assert strokes[0] > strokes[1] > strokes[2] > 0.5 * strokes[0]
