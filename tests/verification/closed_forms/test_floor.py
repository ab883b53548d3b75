"""The physical floor in every model: indentations that stay, and a container at rest on a slope."""

import math

import numpy as np
import pytest
from runs import BOX, GRAVITY, STACK, pulse

from contact.stepping.body import CENTRE_X, POTENTIAL
from contact.stepping.control import most_attempts
from contact.stepping.integrator import REACHED, enter_floor_frame_compiled
from contact.stepping.ledger import BASE_WORK, CRUSHING, FRICTION, IMBALANCE
from contact.stepping.outcome import FREE, is_over
from fem.model.model import Model, build_model
from fem.run.output import Start, state_of
from fem.run.recorder import Recorder
from fem.solid.nodal_body import advance_body

MODELS = {
    "rigid": {},
    "reduced": {"solver.model": "reduced", "solver.element_size_m": 0.5},
    "full": {"solver.model": "full", "solver.element_size_m": 0.5},
}
SLAB = {"floor.kind": "slab", "floor.preset": "concrete C25/30", "floor.corner_patch_m": [0.008, 1.1]}
SLOPE = 0.08  # it falls toward +x


def stepped(model: Model, until: float) -> Model:
    run, most = model.run, most_attempts(model.run.problem.control, until)
    run.clock[0].attempt_limit = most
    while run.clock[0].time < until:
        assert run.clock[0].steps + run.clock[0].rejected < most, "it makes no progress"
        assert advance_body(model.body, run, until) == REACHED
        run.clock[0].samples_drained = run.clock[0].samples
    return model


def tilted_box(model: str, **values) -> Model:
    """A box that falls back on its corner from 0.02 rad, within a few hundredths of a second."""
    keys = {"initial.rotation_rad": 0.02, "solver.duration_s": 0.3, "output.history_s": 0.01}
    return build_model(BOX.with_values(MODELS[model] | keys | SLAB | values))


@pytest.mark.parametrize("slope", [0.0, SLOPE])
@pytest.mark.parametrize("kind", ["corners", "feet", "flat"])
@pytest.mark.parametrize("model", ["rigid", "reduced"])
def test_a_container_stands_still_on_a_slope_and_on_a_level_floor(model, kind, slope):
    keys = {"floor.slope_percent": 100.0 * slope, "support.kind": kind, "solver.element_size_m": 0.275}
    standing = build_model(STACK.with_values(MODELS[model] | keys | {"contact.mu_static": 0.1}))
    run, mass = standing.run, standing.run.problem.control.mass
    weight, angle = mass * GRAVITY, math.atan(slope)
    tangential, normal = run.old.force.sum(axis=0)
    assert normal == pytest.approx(weight * math.cos(angle), rel=1e-9)
    assert tangential == pytest.approx(-weight * math.sin(angle), abs=1e-9 * weight)  # it holds uphill
    # the resultant passes through the mass centre: towards the lower corner
    assert run.old.force[:, 1] @ run.old.point[:, 0] / normal == pytest.approx(2.0 * slope, abs=1e-3)
    forces, position = run.old.force.copy(), run.old.position[:3].copy()
    stepped(standing, 1.0)
    assert run.joints[0].slip_travel == 0.0 and run.track[0].modes == 1  # at rest
    sinks = weight / standing.base_stiffness
    assert run.joints[0].max_slip <= 1e-5 * sinks  # to the tolerance of a point
    assert run.old.force == pytest.approx(forces, abs=1e-3 * weight)
    assert np.abs(run.ledger).max() <= 1e-7 * run.problem.control.reference_energy
    if slope == 0.0:
        assert run.old.force[:, 1] == pytest.approx(forces[::-1, 1], rel=1e-6)
        assert np.abs(run.old.position[:3] - position).max() <= 1e-6 * sinks
        assert run.clock[0].rejected == 0


def test_the_full_model_slides_down_a_slope_as_the_closed_form_says():
    # mu below the slope: g (sin - mu cos)
    keys = {"floor.slope_percent": 100.0 * SLOPE, "contact.mu_static": 0.05, "contact.mu_kinetic": 0.05}
    model = build_model(BOX.with_values(MODELS["full"] | keys))
    before = float(model.run.old.energy[POTENTIAL])
    stepped(model, 0.2)
    angle, run = math.atan(SLOPE), model.run
    expected = 0.5 * GRAVITY * (math.sin(angle) - 0.05 * math.cos(angle)) * run.clock[0].time ** 2
    assert run.joints[0].slip == pytest.approx(expected, rel=5e-3)
    lost = model.run.problem.control.mass * GRAVITY * math.sin(angle) * run.old.pose[CENTRE_X]
    assert run.old.energy[POTENTIAL] - before == pytest.approx(-lost, rel=1e-3)
    assert abs(run.ledger[IMBALANCE]) <= 1e-3 * run.ledger[FRICTION]


def test_a_floor_that_carries_a_container_along_a_slope_does_no_work_on_it():
    # At constant velocity friction balances gravity: neither does the height change, nor anything else.
    keys = {"floor.slope_percent": 100.0 * SLOPE, "floor.motion_along": "floor", "motion.start": "moving"}
    model = build_model(STACK.with_values(pulse(1.0, 0.2) | keys | {"contact.mu_static": 0.3}))
    before = float(model.run.old.energy[POTENTIAL])
    stepped(model, 1.0)
    energy, ledger = model.run.old.energy, model.run.ledger
    kinetic = 0.5 * model.run.problem.control.mass * float(model.run.floor[0, 1]) ** 2
    assert energy[POTENTIAL] == pytest.approx(before, abs=1e-3 * kinetic)
    assert ledger[BASE_WORK] == pytest.approx(kinetic, rel=1e-2)


@pytest.mark.parametrize("downhill", [True, False])
def test_a_container_comes_to_rest_where_it_has_slid(downhill):
    keys = {"floor.slope_percent": 5.0, "contact.mu_static": 0.1, "solver.duration_s": 3.0}
    model = build_model(BOX.with_values(pulse(-3.0 if downhill else 3.0, 0.1) | keys))
    run = model.run
    over = 0.0
    while not over and run.clock[0].time < 3.0:
        stepped(model, float(run.clock[0].time) + 0.05)
        over = float(run.clock[0].time) * is_over.py_func(run, FREE)
    assert (run.joints[0].slip > 0.0) == downhill
    assert run.joints[0].max_slip > 0.01
    assert 0.0 < over < 1.5


def test_a_horizontal_motion_slips_where_the_closed_form_says():
    # a = g (mu cos - sin)/(cos + mu sin): 0.3912 g for mu 0.45 and 5 %, and 0.3995 g along the floor
    for along, limit in (("horizontal", 0.3912), ("floor", 0.3995)):
        keys = {"floor.slope_percent": 5.0, "floor.motion_along": along, "contact.mu_static": 0.45}
        keys |= {"container.height_m": 0.5, "solver.duration_s": 0.5}
        pulses = (pulse(-share * limit * GRAVITY, 0.2) for share in (0.996, 1.004))
        below, above = (stepped(build_model(BOX.with_values(one | keys)), 0.4) for one in pulses)
        assert below.run.joints[0].slip_travel < 1e-5 < 1e-4 < above.run.joints[0].slip_travel, along


@pytest.mark.parametrize(("along", "slip"), [("horizontal", 0.0425), ("floor", 0.0289)])
def test_a_horizontal_motion_on_a_slope_takes_weight_off_it(along, slip):
    # braking at 0.42 g within 0.05 s, for 0.5 s, on a bed that falls 5 % forward; a point mass by explicit steps
    times, braking = np.array([0.0, 0.05, 0.55, 0.6]), 0.42 * GRAVITY * np.array([0.0, 1.0, 1.0, 0.0])
    cosine, sine = math.cos(math.atan(0.05)), math.sin(math.atan(0.05))
    a = np.interp(np.arange(0.0, 3.0, 1e-5), times, braking, right=0.0)
    turned = along == "horizontal"
    pushed = GRAVITY * sine + a * (cosine if turned else 1.0)
    held = 0.45 * (GRAVITY * cosine - a * (sine if turned else 0.0))
    velocity = exact = 0.0
    for gain in 1e-5 * (pushed - held):
        velocity = max(velocity + gain, 0.0)
        exact += 1e-5 * velocity
    assert exact == pytest.approx(slip, abs=1e-4)
    keys = {"floor.slope_percent": 5.0, "floor.motion_along": along, "contact.mu_static": 0.45}
    keys |= {"solver.duration_s": 1.2, "motion.gaps": "bridge"}
    done = stepped(build_model(BOX.with_motion(times, -braking).with_values(keys)), 1.0)
    assert done.run.joints[0].max_slip == pytest.approx(exact, rel=0.01)


def test_a_vertical_motion_on_a_slope_is_turned_too():
    # g and the floor's acceleration are both vertical: it slides as under g + a on a floor at rest
    keys = {"floor.slope_percent": 20.0, "contact.mu_static": 0.1, "contact.mu_kinetic": 0.1}
    keys |= {"vertical.kind": "pulse", "vertical.shape": "rectangular", "vertical.pulse_s": 0.5}
    keys |= {"vertical.peak_acceleration_m_s2": 3.0, "motion.kind": "none", "solver.duration_s": 0.5}
    run = stepped(build_model(BOX.with_values(keys | {"container.height_m": 0.5})), 0.4).run
    angle = math.atan(0.2)
    expected = 0.5 * (GRAVITY + 3.0) * (math.sin(angle) - 0.1 * math.cos(angle)) * run.clock[0].time ** 2
    assert run.joints[0].slip == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("model", MODELS)
def test_every_model_crushes_the_floor_alike(model):
    run = stepped(tilted_box(model), 0.12).run
    rigid = stepped(tilted_box("rigid"), 0.12).run
    assert run.old.crushed[0] > 1e-5
    assert run.old.crushed[0] == pytest.approx(rigid.old.crushed[0], rel=0.05)
    cap, growth, deep = run.problem.contact.cap, run.problem.contact.cap_growth, run.old.crushed
    assert growth[0] == pytest.approx(1.0 / 1.1 / 0.008)  # of the edge of one box
    assert run.ledger[CRUSHING] == pytest.approx(cap @ (deep * (1.0 + 0.5 * growth * deep)), rel=2e-2)
    assert (run.old.force[:, 1] <= cap * (1.0 + growth * deep) * (1.0 + 1e-9)).all()


@pytest.mark.parametrize("model", MODELS)
def test_a_state_that_is_kept_has_its_indentations_to_the_byte(model):
    whole, first, second = (tilted_box(model) for _ in range(3))
    for one in (whole, first):
        stepped(one, 0.1)
    assert first.run.old.crushed.max() > 0.0
    Start(arrays=state_of(first, Recorder(first))).restore(second, Recorder(second))
    for one in (whole, second):
        stepped(one, 0.12)
    assert second.run.old.numbers.tobytes() == whole.run.old.numbers.tobytes()
    assert second.run.ledger.tobytes() == whole.run.ledger.tobytes()


def test_indentations_are_kept_where_the_frame_of_the_floor_is_entered():
    model = stepped(tilted_box("rigid"), 0.12)
    point = model.run.old.point.copy()
    enter_floor_frame_compiled(model.body, model.run, 0.0, 0.0)
    assert model.run.old.point == pytest.approx(point, abs=1e-15)
