"""The floating frame with elastic modes: kinematics, the condensed compliance, and the balance of a step.

The operations that the stepper compiles are called here as plain Python.
"""

import math

import numpy as np
import pytest

from contact.interface.workspace import Workspace, make_workspace
from contact.stepping.body import KINETIC, POTENTIAL, STRAIN, Ground, State, make_state
from contact.stepping.modal_body import (
    ModalBody,
    complete,
    gather_force,
    make_modal_body,
    observe,
    predict,
    release,
    respond,
)
from contact.stepping.scheme import Scheme, generalised_alpha, newmark

MASS, INERTIA, GRAVITY = 1e4, 1.434e4, 9.81
POINT = np.array([[-0.55, -2.0], [0.1, -2.0], [0.55, -2.0]])
MONITOR = np.array([[-0.55, 2.0], [0.2, 0.3]])
FREQUENCIES = np.array([700.0, 1300.0, 2600.0, 4000.0])
RATIOS = 0.02 * FREQUENCIES / FREQUENCIES[0]
STEP = 1e-3
SCHEMES = {"generalised-alpha": generalised_alpha(0.5), "newmark": newmark(0.25, 0.5)}


def make_body(modes: int = 4) -> ModalBody:
    draw = np.random.default_rng(7)
    return make_modal_body(
        mass=MASS,
        inertia=INERTIA,
        gravity=GRAVITY,
        point=POINT,
        rest=(0.0, 2.0),
        shape=draw.normal(size=(3, 2, 4))[:, :, :modes] / math.sqrt(MASS),
        frequencies=FREQUENCIES[:modes],
        damping_ratios=RATIOS[:modes],
        monitor=MONITOR,
        monitor_shape=draw.normal(size=(2, 2, 4))[:, :, :modes] / math.sqrt(MASS),
        tolerance=1e-11,
    )


def make_moving_state(body: ModalBody, rotation: float, *, seed: int = 1, speed: float = 0.3) -> State:
    """Somewhere above the floor, turned, strained and moving."""
    draw = np.random.default_rng(seed)
    state = make_state(3 + body.stiffness.size, 3, 2)
    state.position[:3] = 0.2, 2.1, rotation
    state.position[3:] = 1e-4 * math.sqrt(MASS) * draw.normal(size=body.stiffness.size)
    state.velocity[:] = speed * draw.normal(size=3 + body.stiffness.size)
    complete(body, state, 0.0, 0.0, 0.0)
    return state


def points_at(body: ModalBody, position: np.ndarray) -> np.ndarray:
    """c + R (X + Phi q), written as vectors."""
    cosine, sine = math.cos(position[2]), math.sin(position[2])
    turn = np.array([[cosine, sine], [-sine, cosine]])
    return position[:2] + (body.point + body.shape @ position[3:]) @ turn.T


def jacobian_by_differences(body: ModalBody, position: np.ndarray) -> np.ndarray:
    """Derivatives of the base points by the coordinates, shape (n, 2, n_d)."""
    columns = []
    for j in range(position.size):
        delta = np.zeros(position.size)
        delta[j] = 1e-6
        columns.append((points_at(body, position + delta) - points_at(body, position - delta)) / 2e-6)
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("rotation", [0.0, 0.4, -1.2])
def test_contact_forces_act_by_the_transposed_jacobian(rotation):
    body = make_body()
    state = make_moving_state(body, rotation)
    force = np.random.default_rng(3).normal(size=(3, 2)) * 1e4
    generalised = np.zeros(7)
    gather_force(body, force, rotation, body.arm, generalised)
    expected = np.einsum("ia,iaj->j", force, jacobian_by_differences(body, state.position))
    assert generalised == pytest.approx(expected, rel=1e-7, abs=1e-4)


def test_energies_are_those_of_a_rigid_body_and_its_oscillators():
    body = make_body()
    state = make_moving_state(body, 0.3)
    vx, vz, rate, *modal = state.velocity
    kinetic = 0.5 * MASS * (vx**2 + vz**2) + 0.5 * INERTIA * rate**2 + 0.5 * np.dot(modal, modal)
    assert state.energy[KINETIC] == pytest.approx(kinetic, rel=1e-14)
    assert state.energy[STRAIN] == pytest.approx(
        0.5 * np.sum((FREQUENCIES * state.position[3:]) ** 2), rel=1e-14
    )
    assert state.energy[POTENTIAL] == pytest.approx(MASS * GRAVITY * 2.1, rel=1e-14)


def test_internal_forces_are_the_slope_of_the_strain_energy_and_damping_takes_energy():
    body = make_body()
    state = make_moving_state(body, 0.3)
    assert state.damping[3:] == pytest.approx(2.0 * RATIOS * FREQUENCIES * state.velocity[3:], rel=1e-14)
    assert state.damping @ state.velocity > 0.0
    for j in range(3, 7):
        energies = []
        for sign in (1.0, -1.0):
            moved = make_moving_state(body, 0.3)
            moved.position[j] += sign * 1e-4
            complete(body, moved, 0.0, 0.0, 0.0)
            energies.append(moved.energy[STRAIN])
        slope = (energies[0] - energies[1]) / 2e-4
        assert state.internal[j] - state.damping[j] == pytest.approx(slope, rel=1e-8)


def test_monitored_velocities_are_the_rates_of_monitored_displacements():
    body = make_body()
    state = make_moving_state(body, 0.3)
    observe(body, state, 0.0, 0.0)
    velocity = state.monitor[:, 2:].copy()
    displacements = []
    for sign in (1.0, -1.0):
        moved = make_moving_state(body, 0.3)
        moved.position[:] += sign * 1e-6 * state.velocity
        observe(body, moved, 0.0, 0.0)
        displacements.append(moved.monitor[:, :2].copy())
    assert velocity == pytest.approx((displacements[0] - displacements[1]) / 2e-6, rel=1e-7)


def take(
    body: ModalBody, scheme: Scheme, old: State, force: np.ndarray, *, iterations: int
) -> tuple[State, Workspace, float]:
    """One step under given contact forces: predict, then release and respond so many times."""
    new, work = make_state(old.position.size, 3, 2), make_workspace(3)
    predict(body, scheme, STEP, old, new)
    work.force[:] = force
    error = math.inf
    for _ in range(iterations):
        release(body, scheme, STEP, old, new, work, Ground(0.03, 0.2, 0.0, 0.0))
        error = respond(body, scheme, STEP, old, new, work)
    complete(body, new, 0.03, 0.0, 0.0)
    return new, work, error


def predicted(work: Workspace, scheme: Scheme) -> tuple[np.ndarray, np.ndarray]:
    """Points and velocities relative to the floor that the condensed problem promises for `work.force`."""
    moved = (work.compliance @ work.force.ravel()).reshape(-1, 2)
    slope = scheme.newmark_gamma / (scheme.newmark_beta * STEP)
    return work.free + moved, work.free_velocity + slope * moved


FORCE = np.array([[2e3, 6e4], [-1e3, 4e3], [3e3, 8e4]])


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
@pytest.mark.parametrize("rotation", [0.0, 0.4, -1.2])
@pytest.mark.parametrize("modes", [0, 4])
def test_the_points_stand_where_the_condensed_problem_put_them(scheme, rotation, modes):
    body = make_body(modes)
    old = make_moving_state(body, rotation)
    new, work, error = take(body, scheme, old, FORCE, iterations=4)
    assert error <= 1.0
    point, velocity = predicted(work, scheme)
    assert new.point == pytest.approx(point, abs=body.tolerance)
    shift = 1e-7
    ahead = points_at(body, new.position + shift * new.velocity)
    behind = points_at(body, new.position - shift * new.velocity)
    actual = (ahead - behind) / (2.0 * shift) - np.array([0.2, 0.0])  # the floor moves at 0.2 m/s
    assert velocity == pytest.approx(actual, abs=1e-7)


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_a_converged_step_balances_the_averaged_equation_of_motion(scheme):
    body = make_body()
    old = make_moving_state(body, 0.4)
    gather_force(body, 0.3 * FORCE, 0.4, body.arm, old.external)
    old.acceleration[:] = np.random.default_rng(5).normal(size=7)
    new, work, _ = take(body, scheme, old, FORCE, iterations=4)
    masses = np.array([MASS, MASS, INERTIA, 1.0, 1.0, 1.0, 1.0])
    gather_force(body, work.force, new.position[2], body.arm, new.external)
    mean = (1.0 - scheme.alpha_m) * new.acceleration + scheme.alpha_m * old.acceleration
    inside = (1.0 - scheme.alpha_f) * new.internal + scheme.alpha_f * old.internal
    outside = (1.0 - scheme.alpha_f) * new.external + scheme.alpha_f * old.external
    scale = np.abs(masses * mean) + np.abs(inside) + np.abs(outside)
    assert (np.abs(masses * mean + inside - outside) <= 1e-9 * scale).all()
    # and the coordinates follow from the accelerations by Newmark's formulas
    beta, gamma = scheme.newmark_beta, scheme.newmark_gamma
    moved = STEP * old.velocity + STEP**2 * ((0.5 - beta) * old.acceleration + beta * new.acceleration)
    gained = STEP * ((1.0 - gamma) * old.acceleration + gamma * new.acceleration)
    assert new.position - old.position == pytest.approx(moved, rel=1e-9, abs=1e-15)
    assert new.velocity - old.velocity == pytest.approx(gained, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("modes", [0, 1, 4])
@pytest.mark.parametrize("rotation", [0.0, 0.9])
def test_the_compliance_is_symmetric_and_positive(modes, rotation):
    body = make_body(modes)
    _, work, _ = take(
        body, SCHEMES["generalised-alpha"], make_moving_state(body, rotation), FORCE, iterations=1
    )
    assert work.compliance == pytest.approx(work.compliance.T, abs=1e-15 * np.abs(work.compliance).max())
    eigenvalues = np.linalg.eigvalsh(work.compliance)
    assert eigenvalues[0] >= -1e-14 * eigenvalues[-1]
    assert np.sum(eigenvalues > 1e-12 * eigenvalues[-1]) == min(6, 3 + modes)
