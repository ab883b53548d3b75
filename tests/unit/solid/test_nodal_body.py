"""The compiled half of the full model, piece by piece against dense algebra."""

import math

import numpy as np
import pytest
from meshes import force_and_energy
from scipy.sparse.linalg import spsolve

from contact.stepping.body import Ground
from fem.case.case import load_case, read_case
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.solid import nodal_kernels
from fem.solid.nodal_body import RESIDUAL_TOLERANCE

STEP = 2e-3
COARSE = ("solver.model=full", "solver.element_size_m=0.55", "output.fields_s=0")
THIN = """
schema = 1
container = { width_m = 0.04, height_m = 0.12, depth_m = 0.03, boxes = 5, density_kg_m3 = 4500.0, wall_m = 1e-4 }
contact = { mu_static = 0.0, mu_kinetic = 0.0 }
motion = { kind = "harmonic", peak_acceleration_m_s2 = 4.0, frequency_Hz = 0.5 }
solver = { model = "full", duration_s = 0.1, element_size_m = 0.12 }
"""


@pytest.fixture(scope="module")
def model():
    return build_model(load_case("seed_stack_plateau", COARSE))


def newmark_matrix(model):
    body, scheme = model.body, model.run.problem.scheme
    now, beta = 1.0 - scheme.alpha_f, scheme.newmark_beta
    inertial = (1.0 - scheme.alpha_m) / (beta * STEP**2)
    elastic = now * (1.0 + body.damping * scheme.newmark_gamma / (beta * STEP))
    return (inertial * body.elements.vector_mass + elastic * body.elements.stiffness).tocsc()


def test_substitution_solves_with_the_newmark_matrix(model):
    body = model.body
    body.prepare(model.run.problem.scheme, STEP)
    nodal, matrix = body.nodal, newmark_matrix(model)
    load = np.random.default_rng(2).normal(size=body.coordinates)
    nodal.permuted[nodal.order] = load
    nodal_kernels.substitute(nodal, nodal_kernels.slot_of(nodal, STEP))
    expected = spsolve(matrix, load)
    assert nodal.permuted[nodal.order] == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_forces_and_energy_are_those_of_the_elements_less_the_source(model):
    body, state = model.body, model.run.old
    shaken = np.random.default_rng(3)
    position = state.position + 1e-4 * shaken.normal(size=state.position.size)
    velocity = shaken.normal(size=position.size)
    body.nodal.source[:] = shaken.normal(size=body.nodal.source.shape)
    body.nodal.turn[:] = math.cos(0.3), math.sin(0.3)
    nodal_kernels.forces(body.nodal, position, velocity)
    force, energy = force_and_energy(body.elements, position.reshape(-1, 2) - body.elements.nodes)
    assert np.array_equal(body.nodal.internal, force - body.nodal.source)
    assert body.nodal.strain_energy[0] == energy
    turn = np.array([[math.cos(0.3), math.sin(0.3)], [-math.sin(0.3), math.cos(0.3)]])
    turned = (velocity.reshape(-1, 2) @ turn).ravel()
    expected = body.damping * (body.elements.stiffness @ turned).reshape(-1, 2) @ turn.T
    assert body.nodal.damping_force == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
    body.nodal.source[:] = 0.0


def test_an_iterate_that_has_run_away_is_never_taken_for_converged():
    model = build_model(load_case("seed_stack_plateau", COARSE))
    run, scheme = model.run, model.run.problem.scheme
    model.body.prepare(scheme, STEP)
    nodal, old, new, still = model.body.nodal, run.old, run.attempt.new, Ground(0.0, 0.0, 0.0, 0.0)
    nodal_kernels.predict(nodal, scheme, STEP, old, new)
    new.position[::3] = math.nan
    nodal_kernels.release(nodal, scheme, STEP, old, new, run.work, still)
    assert nodal_kernels.respond(nodal, scheme, STEP, old, new, run.work) == math.inf


def test_walls_thin_as_a_hair_do_not_keep_the_iterations_waiting_for_rounding():
    model = build_model(read_case(THIN, name="thin"))
    body, clock = model.body, model.run.clock[0]
    nodes = body.elements.nodes
    # What turning without deforming leaves is rounding: more than the tolerance of other containers would be ..
    turn = np.array([[math.cos(0.2), math.sin(0.2)], [-math.sin(0.2), math.cos(0.2)]])
    force, _ = force_and_energy(body.elements, nodes @ turn.T - nodes)
    rounding = np.abs(force).max()
    assert RESIDUAL_TOLERANCE * body.mass * body.gravity < rounding < body.nodal.tolerance
    # .. and still nothing against the weight; without a tolerance above it a step would be halved to no end.
    assert body.nodal.tolerance < 1e-3 * body.mass * body.gravity
    assert simulate(model, Recorder(model), stop=lambda: clock.rejected > 1000).status == "completed"
    assert clock.failed < 0.2 * clock.steps
