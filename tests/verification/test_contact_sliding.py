"""Sticking and sliding of a stepped block against closed forms of the rigid slider.

The block stands on two elastic corners; its stick is elastic. What the closed forms of a rigid slider leave
out is of the order of the time in which the stick springs reverse, and falls with their stiffness.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, Rig, piecewise_motion, rig

from contact.interface.laws import REGULARISED
from contact.interface.solver import FloatArray
from contact.motion.base_motion import HarmonicMotion, PulseMotion
from contact.reference.closed_forms_sliding import incline_acceleration, pulse_slip, steady_stroke
from contact.stepping.integrator import advance_compiled
from contact.stepping.ledger import BASE_WORK, CONTACT_DAMPING, FRICTION, IMBALANCE
from contact.stepping.state import ROW_CENTRE_X
from fem.case.case import load_case
from fem.model.model import build_model

#: the single box of the seed paper; 158 Hz is the penalty that a case chooses for it
BOX = Block(height=1.0, mass=2500.0, bounce_frequency=158.0, mu_static=0.4, mu_kinetic=0.2)
AMPLITUDE = 0.05  #: of the floor [m]


def constant_pull(acceleration: float) -> PulseMotion:
    return PulseMotion(shape="rectangular", acceleration=acceleration, pulse=100.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_block_slides_down_an_incline_with_the_acceleration_of_the_schoolbook(sign):
    # In the frame of a 30 degree incline: gravity g cos 30, and a floor that accelerates by g sin 30.
    angle = math.pi / 6.0
    block = replace(BOX, height=0.5, gravity=GRAVITY * math.cos(angle))
    run = rig(block, motion=constant_pull(-sign * GRAVITY * math.sin(angle))).advance(1.0)
    time, velocity = run.time, run.slip_velocity
    run.advance(2.0)
    found = (run.slip_velocity - velocity) / (run.time - time)
    expected = incline_acceleration(angle=angle, mu_kinetic=0.2, gravity=GRAVITY)
    assert expected == pytest.approx(3.20586, abs=5e-6)
    assert found == pytest.approx(sign * expected, rel=1e-6)


def test_a_push_stops_where_friction_has_eaten_its_energy():
    run = rig(BOX, stance=BOX.standing().sliding(1.0)).advance(2.0)
    # Static friction does not matter: it never stands still before the end.
    assert run.slip[-1] == pytest.approx(1.0 / (2.0 * 0.2 * GRAVITY), rel=2e-3)
    assert run.run.ledger[FRICTION] == pytest.approx(0.5 * BOX.mass, rel=2e-3)
    assert run.run.ledger[BASE_WORK] == 0.0
    assert abs(run.slip_velocity) < 1e-9


def test_slip_leaves_out_the_elastic_stick():
    # A corner moves by its slip and the elongation of its spring, mu_k N/k; a low block: both carry alike.
    block = replace(BOX, height=0.05, bounce_frequency=20.0)
    run = rig(block, motion=constant_pull(0.6 * GRAVITY)).advance(0.5)
    state = run.run.old
    stick = float(state.stick.mean())
    assert abs(stick) == pytest.approx(0.2 * block.mass * GRAVITY / block.base_stiffness, rel=0.01)
    moved = float((state.point[:, 0] - block.point[:, 0]).mean())
    assert moved - float(run.clock.slip) == pytest.approx(stick, rel=0.02)


def test_friction_heat_is_kinetic_friction_times_the_path():
    block = replace(BOX, mu_static=0.2)
    motion = HarmonicMotion(amplitude=AMPLITUDE, angular_frequency=12.0, duration=10.0)
    run = rig(block, motion=motion).advance(5.0)
    assert run.track.slip_travel > 0.5
    expected = 0.2 * block.mass * GRAVITY * run.track.slip_travel
    assert run.run.ledger[FRICTION] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("mu_static", [0.2, 0.4])
def test_a_rectangular_pulse_leaves_the_slip_of_newmark(mu_static):
    # V^2/(2 mu g) (1 - mu g/a0); the floor goes on with V, the block catches up.
    block = replace(BOX, height=0.5, mu_static=mu_static)
    motion = PulseMotion(shape="rectangular", acceleration=6.0, pulse=0.25)
    run = rig(block, motion=motion, breaks=np.array([0.25])).advance(3.0)
    expected = pulse_slip(peak=6.0, duration=0.25, mu_static=mu_static, mu_kinetic=0.2, gravity=GRAVITY)
    assert run.slip[-1] == pytest.approx(expected, rel=2e-3)


def steady(run: Rig, period: float) -> FloatArray:
    """Slip over the last cycle [m]."""
    return run.slip[-round(period / run.run.history.interval) - 1 :]


def shaken(block: Block, angular_frequency: float, cycles: float, **options) -> Rig:
    period = 2.0 * math.pi / angular_frequency
    motion = HarmonicMotion(amplitude=AMPLITUDE, angular_frequency=angular_frequency, duration=1e3)
    return rig(block, motion=motion, sampled=period / 200.0, samples=8000, **options).advance(cycles * period)


# Slip per half cycle over A; equal friction coefficients: continuous below kappa = 0.53703, two stops above.
STROKES = {0.2: 1.898741, 0.5: 1.237982, 0.7: 0.432494}


@pytest.mark.parametrize(("friction_ratio", "printed"), STROKES.items())
def test_steady_strokes_of_a_slider_with_one_coefficient(friction_ratio, printed):
    assert steady_stroke(friction_ratio=friction_ratio, static_ratio=1.0) == pytest.approx(printed, abs=5e-7)
    omega = math.sqrt(0.2 * GRAVITY / (friction_ratio * AMPLITUDE))
    run = shaken(replace(BOX, mu_static=0.2), omega, 20.0)
    stroke = np.ptp(steady(run, 2.0 * math.pi / omega)) / AMPLITUDE
    assert stroke == pytest.approx(printed, rel=5e-3)


def test_the_error_of_a_stroke_falls_with_the_stiffness_of_the_stick():
    # Elongations fall as 1/k; the time in which a reversing block takes them up falls as their root.
    omega = math.sqrt(0.2 * GRAVITY / (0.5 * AMPLITUDE))
    errors = []
    for frequency in (50.0, 158.0, 500.0):
        block = replace(BOX, mu_static=0.2, bounce_frequency=frequency)
        run = shaken(block, omega, 15.0, energy_scale=0.1, largest_step=2e-3)
        errors.append(abs(np.ptp(steady(run, 2.0 * math.pi / omega)) / AMPLITUDE - STROKES[0.5]))
    assert errors[1] <= 0.45 * errors[0]
    assert errors[2] <= 0.45 * errors[1]


def slider(**options) -> tuple[float, float, float]:
    """Steady stroke, largest slip of all, and slip after ten cycles of the box under 10 rad/s [m]."""
    run = shaken(BOX, 10.0, 15.0, **options)
    return float(np.ptp(steady(run, 0.2 * math.pi))), float(run.track.max_slip), float(run.slip[2000])


# Event-driven integration at 1e-12: 78.745, 79.144 and +19.893 mm; within 0.5 % of the stroke.
EXACT = np.array([78.745e-3, 79.144e-3, 19.893e-3])
HALF_PERCENT = 0.005 * 78.745e-3


def test_stroke_of_a_slider_with_two_coefficients():
    assert slider()[0] == pytest.approx(EXACT[0], abs=HALF_PERCENT)


def test_largest_and_later_slip_of_a_slider_with_two_coefficients():
    """The first break-loose sets the middle of all later strokes."""
    assert slider(energy_scale=0.1, largest_step=1e-3) == pytest.approx(EXACT, abs=HALF_PERCENT)


def test_the_shipped_case_of_a_sliding_box():
    case = load_case("sliding").with_values({"solver.model": "rigid", "output.fields_s": 0.0})
    run = build_model(case)
    while run.run.clock[0].time < 10.0:  # it pauses when its samples want to be taken away
        run.run.clock[0].samples_drained = run.run.clock[0].samples
        assert advance_compiled(run.body, run.run, 10.0) == 0
    assert float(run.run.track[0].max_slip) == pytest.approx(EXACT[1], abs=HALF_PERCENT)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("share", "stairs"), [(0.5, 1), (0.9, 1), (0.98, 200), (0.999, 200)])
def test_a_stuck_block_does_not_creep(share, stairs, sign):
    """A floor that pulls one way for 20 s, below the limit of friction: elastic, and then nothing.

    Switched on at once, a pull above 0.96 of the limit makes the stick springs swing over it; so the last
    ones are raised within 2 s.
    """
    knots = [2.0 * i / stairs for i in range(stairs)]
    pulls = [sign * share * 0.4 * GRAVITY * (i + 1) / stairs for i in range(stairs)]
    run = rig(BOX, motion=piecewise_motion(knots, pulls), breaks=np.array(knots[1:])).advance(20.0)
    leaning = run.run.history.columns[: run.clock.samples, ROW_CENTRE_X]
    after = run.times > 3.0
    # a micrometre is 1e7 times what the rounding of the floor's 700 m leaves
    assert np.ptp(run.slip[after]) <= 1e-12
    assert np.ptp(leaning[after]) <= 1e-11
    assert abs(run.slip[-1]) < 1e-5


@pytest.mark.parametrize("block", [BOX, Block(mu_kinetic=0.2)], ids=["box", "stack"])
def test_a_fifth_of_g_one_way_for_twenty_seconds_slips_by_nothing(block):
    run = rig(block, motion=constant_pull(0.2 * GRAVITY)).advance(20.0)
    assert run.track.max_slip < 1e-5
    assert np.ptp(run.slip[run.times > 1.0]) == 0.0
    assert run.run.ledger[FRICTION] + run.run.ledger[CONTACT_DAMPING] <= 1e-3 * block.reference_energy
    assert abs(run.run.ledger[IMBALANCE]) <= 1e-5 * block.reference_energy


def test_above_the_limit_it_slides():
    run = rig(BOX, motion=constant_pull(1.02 * 0.4 * GRAVITY)).advance(1.0)
    assert run.slip_velocity == pytest.approx(-(1.02 * 0.4 - 0.2) * GRAVITY, rel=0.1)


def test_friction_regularised_in_velocity_creeps_at_the_stated_speed():
    # v = v_reg atanh(load over limit): 0.55 mm a second at half the limit and 1 mm/s.
    block = replace(BOX, mu_kinetic=0.4, friction=REGULARISED)
    run = rig(block, motion=constant_pull(0.5 * 0.4 * GRAVITY)).advance(5.0)
    expected = -1e-3 * math.atanh(0.5)
    assert run.slip_velocity == pytest.approx(expected, rel=1e-4)
    assert run.slip[-1] == pytest.approx(5.0 * expected, rel=0.02)


def test_a_slip_distance_for_weakening_shortens_the_stroke_and_nothing_else():
    # While it weakens the floor takes more of the block along: the strokes shrink, a little.
    strokes = [shaken(replace(BOX, weakening=w), 10.0, 12.0).track.max_slip for w in (0.0, 1e-5, 1e-4)]
    assert strokes[0] > strokes[1] > strokes[2] > 0.5 * strokes[0]
