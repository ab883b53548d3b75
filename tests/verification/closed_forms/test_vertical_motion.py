"""A floor that moves up and down: gravity becomes g + a_v in every equation, for every model.

References: the exact oscillator on a shaken spring; the analytic slider; the same run under another gravity; a floor
that rises steadily, on which nothing changes; free fall.
"""

import math

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, rig
from cases import LEAST
from runs import difference, run, stack

from contact.motion.base_motion import HarmonicMotion
from fem.case.case import Case, read_case
from fem.model.model import build_model
from fem.run.simulation import run_without_history

#: pulls for longer than any run here lasts
PULL = {"vertical.kind": "pulse", "vertical.shape": "rectangular", "vertical.pulse_s": 50.0}
SHAKING = {"vertical.kind": "harmonic", "vertical.peak_acceleration_m_s2": 3.0, "vertical.frequency_Hz": 3.0}
PENALTY = {"contact.normal_penalty_Pa_m": 6e8}


def box(**changes: object) -> Case:
    """The rigid box of the paper at rest; `__` in place of the dot of a key."""
    return read_case(LEAST).with_values(
        {"solver.model": "rigid", "output.fields_s": 0.0}
        | {key.replace("__", "."): value for key, value in changes.items()}
    )


def error_of_a_shaken_block(step: float) -> float:
    """Distance of the mass centre of a block on soft springs from the exact oscillation, after 1 s [m]."""
    block = Block(bounce_frequency=3.0, damping_ratio=0.05, mu_static=1.0)
    amplitude, omega, phase = 0.02, 9.0, 0.7
    floor = HarmonicMotion(amplitude=amplitude, angular_frequency=omega, duration=9.0, phase=phase)
    after = rig(block, vertical=floor, largest_step=step, fixed_step=True, sampled=1e3).advance(1.0)
    # m u'' + c u' + k u = -m floor'', u above the settled height over the floor, u = u' = 0 at t = 0
    m, k = block.mass, block.base_stiffness
    c = k * block.relaxation_time
    pull = m * amplitude * omega**2 * np.exp(1j * (phase - 0.5 * math.pi))
    forced = pull / (k - m * omega**2 + 1j * omega * c)
    natural, decay = math.sqrt(k / m), 0.5 * c / m
    damped = math.sqrt(natural**2 - decay**2)
    start, rate = -forced.real, -(1j * omega * forced).real
    t = after.time
    free = start * math.cos(damped * t) + (rate + decay * start) / damped * math.sin(damped * t)
    u = (forced * np.exp(1j * omega * t)).real + math.exp(-decay * t) * free
    exact = 0.5 * block.height - m * GRAVITY / k + u + amplitude * math.sin(omega * t + phase)
    return abs(float(after.run.old.position[1]) - exact)


def test_a_shaken_block_converges_to_the_exact_oscillation_in_second_order():
    steps = 4e-3 / 2.0 ** np.arange(3)
    errors = [error_of_a_shaken_block(step) for step in steps]
    assert errors[0] < 1e-5  # it moves by 14 mm
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("acceleration", [pytest.param(3.0, marks=pytest.mark.slow), -4.0])
def test_a_constant_acceleration_is_another_gravity_for_the_full_model(acceleration):
    common = PENALTY | {"container.mass_kg": 2500.0, "solver.model": "full", "solver.duration_s": 4.5}
    lifted = run(stack().with_values(common | PULL | {"vertical.peak_acceleration_m_s2": acceleration}))
    heavier = run(stack().with_values(common | {"gravity_m_s2": 9.81 + acceleration}))
    assert int(lifted.track.impacts) == int(heavier.track.impacts) >= 3
    assert difference(lifted, heavier) < 0.002
    force = heavier.history["normal_force_N"]
    assert lifted.history["normal_force_N"][0] == pytest.approx(force[0], rel=1e-12)
    assert np.isclose(lifted.history["centre_z_m"], heavier.history["centre_z_m"], atol=1e-3).all()


@pytest.mark.parametrize("model", ["rigid", "reduced"])
def test_a_container_settled_on_an_accelerating_floor_stays_settled(model):
    keys = {"solver__model": model, "solver__element_size_m": 0.5, "solver__duration_s": 1.0}
    still = run(box(**keys).with_values(PULL | {"vertical.peak_acceleration_m_s2": 3.0}))
    assert still.history["normal_force_N"] == pytest.approx(2500.0 * 12.81, rel=1e-6)
    assert np.ptp(still.history["centre_z_m"]) < 1e-9


@pytest.mark.parametrize("model", ["rigid", "reduced", "full"])
def test_a_container_on_a_falling_floor_is_weightless(model):
    values = {"vertical.peak_acceleration_m_s2": -9.81, "vertical.delay_s": 0.1, "solver.duration_s": 0.5}
    case = box(solver__model=model, solver__element_size_m=0.5, output__history_s=0.005)
    fall = run(case.with_values(PULL | values))
    force, before = fall.history["normal_force_N"], fall.times <= 0.1
    assert force[before] == pytest.approx(24525.0, rel=1e-4)
    assert (force[fall.times >= 0.12] == 0.0).all()
    ledger = fall.model.run.ledger
    assert abs(ledger[-1]) < 1e-4 * fall.model.run.problem.control.reference_energy
    # it keeps its place over the floor, which has fallen by 0.8 m
    assert np.ptp(fall.history["centre_z_m"]) < 0.005


def test_nothing_changes_on_a_floor_that_rises_steadily(tmp_path):
    # Beyond its slenderness angle when time is up, so the frame changes to that of the floor as well.
    (tmp_path / "rising.csv").write_text("time_s,displacement_m\n0,0\n2,3\n4,6\n")
    rising = '\n[vertical]\nkind = "table"\nfile = "rising.csv"\nquantity = "displacement"\nunit = "m"\n'
    falling = {"initial.rotation_rad": 0.84, "solver.duration_s": 0.3}
    falling |= {"solver.model": "rigid", "output.fields_s": 0.0}
    runs = [run(read_case(text, folder=tmp_path).with_values(falling)) for text in (LEAST, LEAST + rising)]
    assert runs[0].status == runs[1].status == "overturned"
    assert float(runs[0].track.overturned_at) > 0.5
    assert difference(*runs) < 1e-9
    assert runs[1].track.max_acceleration == pytest.approx(float(runs[0].track.max_acceleration), rel=1e-6)
    assert float(runs[1].track.overturned_at) == pytest.approx(float(runs[0].track.overturned_at), abs=1e-9)
    without_history = build_model(read_case(LEAST + rising, folder=tmp_path).with_values(falling))
    verdict, error = run_without_history(without_history, None)
    assert error is None
    assert verdict.overturned_at_s == float(runs[1].track.overturned_at)


@pytest.mark.parametrize("scale", [1.0, -1.0])
def test_restitution_is_that_of_the_impact_whatever_the_floor_does(scale):
    # Heights of the turning points alone would give 0.75 and 1.11: the floor lifts and lowers what gravity pulls.
    common, slow = PENALTY | {"solver.model": "rigid"}, {"vertical.frequency_Hz": 0.8}
    upward = SHAKING | slow | {"vertical.peak_acceleration_m_s2": 4.0, "vertical.scale": scale}
    quiet, shaken = run(stack().with_values(common)), run(stack().with_values(common | upward))
    assert float(quiet.track.restitution) == pytest.approx(quiet.block.housner_restitution, abs=0.005)
    assert float(shaken.track.restitution) == pytest.approx(float(quiet.track.restitution), abs=0.005)


def test_contents_feel_the_vertical_motion():
    still = run(box(solver__duration_s=3.0).with_values(SHAKING))
    # two poles at 33 Hz let 3 Hz pass to 4e-5; at the first instant the floor has no acceleration yet
    assert float(still.track.max_acceleration) == pytest.approx(3.0, rel=2e-3)
    assert float(still.track.max_top_displacement) < 1e-5
    ratio = still.history["normal_force_N"] / 24525.0
    assert ratio.max() == pytest.approx(1.0 + 3.0 / 9.81, rel=2e-3)
    assert ratio.min() == pytest.approx(1.0 - 3.0 / 9.81, rel=2e-3)


def test_a_run_ends_at_rest_on_a_floor_that_goes_on_rising():
    pulse = PULL | {"vertical.pulse_s": 0.3, "vertical.peak_acceleration_m_s2": 2.0}
    rest = run(box(initial__rotation_rad=0.05).with_values(pulse))
    end = float(rest.model.run.clock[0].time)
    assert rest.status == "completed"
    assert rest.model.run.lift[0, 1] == pytest.approx(0.6)
    assert 0.3 < end < 0.6 * rest.model.duration


@pytest.mark.parametrize(("start", "share"), [("moving", 1.0), ("rest", 0.0)])
def test_the_start_holds_for_both_components(start, share):
    upward = {"vertical.kind": "harmonic", "vertical.amplitude_m": 0.01, "vertical.frequency_Hz": 2.0}
    along = {"motion.kind": "harmonic", "motion.amplitude_m": 0.02, "motion.frequency_Hz": 1.0}
    model = build_model(box(solver__duration_s=1.0).with_values(upward | along | {"motion.start": start}))
    speeds = share * 2.0 * math.pi * np.array([0.02, 0.02])
    assert model.run.old.velocity[:2] == pytest.approx(speeds, rel=1e-12)
    # at rest the floor moves away below it
    assert model.run.old.energy[0] == pytest.approx(0.5 * 2500.0 * (0.02 * 2.0 * math.pi) ** 2)
