"""What no choice of frame, side or unit may change: mirror, Galileo, scaling, spin."""

from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import Block, Rig, piecewise_motion, rig

from contact.interface.equilibrium import Stance
from contact.motion.kernel import HARMONIC, as_floor_motion
from contact.stepping.body import ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, ROTATION
from contact.stepping.integrator import advance_compiled
from fem.case.case import load_case
from fem.model.model import build_model
from fem.solid.nodal_body import advance_body

BLOCK = Block(mu_kinetic=0.2)
ACCELERATION, OMEGA = 4.0, 6.928  #: of the seed paper's plateau [m/s2], [rad/s]


def driven(block: Block, *, sign: float = 1.0, length: float = 1.0, time: float = 1.0, **options) -> Rig:
    """The stack on a harmonic floor; amplitude x length, times x time."""
    amplitude = sign * length * ACCELERATION / OMEGA**2
    motion = as_floor_motion(HARMONIC, (amplitude, OMEGA / time, 0.0, 0.0, 1e30))
    return rig(block, motion=motion, largest_step=5e-3 * time, sampled=5e-3 * time, **options).advance(
        8.0 * time
    )


def test_a_mirrored_floor_makes_the_mirrored_motion():
    right, left = driven(BLOCK), driven(BLOCK, sign=-1.0)
    assert np.abs(right.rotation).max() > 0.3 * BLOCK.slenderness_angle
    n = min(right.rotation.size, left.rotation.size)
    assert left.rotation[:n] == pytest.approx(-right.rotation[:n], abs=1e-9)
    assert left.slip[:n] == pytest.approx(-right.slip[:n], abs=1e-12)
    assert left.force[:n, ::-1] == pytest.approx(
        right.force[:n] * np.array([-1.0, 1.0]), abs=1e-6 * BLOCK.mass * BLOCK.gravity
    )


def test_lengths_times_four_and_times_times_two_change_nothing_but_the_units():
    # Under one gravity times go with the root of lengths. Powers of two: not a bit may differ.
    small = driven(BLOCK)
    tall = replace(
        BLOCK,
        width=4.0 * BLOCK.width,
        height=4.0 * BLOCK.height,
        bounce_frequency=0.5 * BLOCK.bounce_frequency,
    )
    large = driven(tall, length=4.0, time=2.0)
    assert large.clock.steps == small.clock.steps
    n = min(large.rotation.size, small.rotation.size)
    assert large.rotation[:n] == pytest.approx(small.rotation[:n], abs=1e-13)
    assert large.slip[:n] == pytest.approx(4.0 * small.slip[:n], abs=1e-13)


def test_a_case_scales_with_everything_that_is_chosen_for_it():
    # "auto" penalty, steps and tolerances included; stress goes with weight/length^2, so E does.
    small = {
        "container.section": "solid",
        "container.youngs_modulus_Pa": 2.1e11,
        "solver.model": "rigid",
        "solver.duration_s": 8.0,
        "output.history_s": 0.02,
        "output.fields_s": 0.0,
    }
    large = small | {
        "container.width_m": 4.4,
        "container.depth_m": 4.4,
        "container.height_m": 4.0,
        "container.centroid_m": 2.0,
        "container.youngs_modulus_Pa": 2.1e11 / 16.0,
        "solver.element_size_m": 0.4,
        "solver.duration_s": 16.0,
        "motion.angular_frequency_rad_s": 0.5 * OMEGA,
    }
    rotations = []
    for values, until in ((small, 8.0), (large, 16.0)):
        model = build_model(load_case("seed_stack_plateau").with_values(values))
        assert advance_compiled(model.body, model.run, until) == 0
        assert model.run.clock[0].time >= until
        rotations.append(float(model.run.track[0].max_rotation))
    assert rotations[0] > 0.3 * BLOCK.slenderness_angle
    assert rotations[1] == pytest.approx(rotations[0], rel=1e-9)


KNOTS, ACCELERATIONS = [0.1, 0.5, 0.9, 1.3], [4.5, -4.5, 4.5, 0.0]


def riding(velocity: float, *, fixed_step: bool) -> Rig:
    """The stack on a floor that coasts, is jerked to and fro, and coasts on."""
    motion = piecewise_motion(KNOTS, ACCELERATIONS, velocity=velocity, displacement=0.1 * velocity)
    step = 5e-4 if fixed_step else 5e-3
    run = rig(BLOCK, motion=motion, breaks=np.array(KNOTS), largest_step=step, fixed_step=fixed_step)
    return run.advance(3.0)


def test_a_floor_that_travels_besides_makes_the_same_motion():
    standing, riding_along = riding(0.0, fixed_step=True), riding(3.0, fixed_step=True)
    assert np.abs(standing.rotation).max() > 0.2 * BLOCK.slenderness_angle
    n = min(standing.rotation.size, riding_along.rotation.size)
    assert riding_along.rotation[:n] == pytest.approx(standing.rotation[:n], abs=1e-10)
    assert riding_along.slip[:n] == pytest.approx(standing.slip[:n], abs=1e-10)


def test_the_step_control_sees_little_of_a_floor_that_travels_besides():
    # The ledger's base work depends on the frame, and with it, slightly, the choice of steps.
    standing, riding_along = riding(0.0, fixed_step=False), riding(3.0, fixed_step=False)
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


def test_a_thrown_elastic_container_spins_without_strain_that_rotation_would_fake():
    """Total Lagrangian finite elements, turned by 1.5 rad.

    Linear strains would fake 1 - cos(rotation), of the order of 1; true ones are the centrifugal stretching,
    rho (rate x radius)^2/E, here 4e-6, and ringing: their energy is at most that of twice that strain.
    """
    rate, until = 3.0, 0.5
    case = load_case("free_rocking").with_values(
        {
            "solver.model": "full",
            "solver.element_size_m": 0.55,
            "solver.order": 1,
            "solver.step_s": 5e-4,
            "container.youngs_modulus_Pa": 2e10,
            "container.damping_ratio": 0.0,
            "output.history_s": 0.1,
            "output.fields_s": 0.0,
        }
    )
    model = build_model(case)
    body, state = model.body, model.run.old
    nodes, centroid = body.elements.nodes, body.centroid
    arm = nodes - centroid
    thrown = arm + np.array([0.0, 100.0])
    state.position[:] = thrown.ravel()
    state.velocity[:] = (rate * np.column_stack([arm[:, 1], -arm[:, 0]]) + np.array([0.5, 0.0])).ravel()
    state.force[:], state.stick[:] = 0.0, 0.0
    body.evaluate(state)
    body.start(state, 0.0)
    loose = model.run.control._replace(
        energy_floor=1.0
    )  # steps of one size: the ringing is not to be followed
    clock = model.run.clock[0]
    while clock.time < until:
        assert advance_body(body, model.run._replace(control=loose), until) == 0
        clock.samples_drained, clock.frames_drained = clock.samples, clock.frames
    time = float(model.run.clock[0].time)
    found = model.run.old
    radius = np.hypot(*arm.T).max()
    strain = case.mean_areal_density / case.container.depth_m * (rate * radius) ** 2 / 2e10
    assert strain < 5e-6
    assert found.pose[ROTATION] == pytest.approx(rate * time, abs=10.0 * strain)
    assert found.pose[ROTATION] > 1.49
    assert found.pose[ANGULAR_VELOCITY] == pytest.approx(rate, rel=10.0 * strain)
    assert found.pose[CENTRE_X] == pytest.approx(0.5 * time, abs=1e-9)
    assert found.pose[CENTRE_Z] == pytest.approx(100.0 - 0.5 * 9.81 * time**2, rel=1e-9)
    volume = 1.1 * 4.0 * 1.1
    assert found.energy[1] <= 0.5 * 2e10 * (2.0 * strain) ** 2 * volume
