"""Containers in a row: gaps in phase, momentum and energy of hits, walls, mirror images, and what must change nothing.

The references are closed forms, and a stepper of sliders with impulses that shares nothing with the program.
"""

import math

import numpy as np
import pytest
from moreau import slide_in_a_row
from runs import STACK, Finished, pulse, run

from contact.stepping.body import stands_loose
from contact.stepping.joints import holding_force
from contact.stepping.ledger import CONTACT_DAMPING, FRICTION
from contact.stepping.links import links_of
from fem.case.case import Case, CaseError
from fem.case.tables.neighbours import case_of
from fem.model.geometry import build_container
from fem.model.model import build_model
from fem.model.motion import build_motions
from fem.run.compute import chosen_values
from fem.run.verdict import verdict_of

MASS, WIDTH, SPEED, GRAVITY = 1e4, 1.1, 0.5, 9.81
BESIDE = {"side": "right", "gap_m": 0.1, "stiffness_N_m": 1e8}
#: held by friction, so that it rocks
HELD = STACK.with_values({"contact.mu_static": 3.0, "solver.duration_s": 3.0, **pulse(4.5, 0.4)})
#: slides without friction toward +x, and is too low to turn
LOW = {"container.width_m": 4.0, "container.height_m": 1.0, "contact.mu_static": 0.0}
SLIDER = STACK.with_values(
    # of blocks so low the energy to overturn is a thousand times that of a hit
    LOW | {"initial.velocity_m_s": SPEED, "solver.duration_s": 0.8, "solver.energy_tolerance": 0.1}
)


def in_a_row(case: Case, *neighbours: dict) -> Case:
    return case.with_values({"neighbour": list(neighbours)})


def velocities(found: Finished) -> np.ndarray:
    """Of all mass centres along x at the end [m/s], that of the container first."""
    return found.model.run.old.boxes[:, 4]


def test_in_phase_two_equal_containers_use_up_a_gap_as_two_leaning_faces_do():
    found = run(in_a_row(HELD, BESIDE))
    turned = found.track.max_rotation
    assert turned > 0.1
    left = (WIDTH + BESIDE["gap_m"]) * math.cos(turned) - WIDTH
    assert found.model.run.links[0].least_gap == pytest.approx(left, abs=1e-5)
    # they touch where the gap is narrower than the width times 1/cos - 1
    needed = WIDTH * (1.0 / math.cos(turned) - 1.0)
    wider, narrower = (run(in_a_row(HELD, {**BESIDE, "gap_m": share * needed})) for share in (1.02, 0.98))
    assert wider.model.run.links[0].hits == 0
    assert narrower.model.run.links[0].hits > 0


def test_a_gap_that_is_not_used_up_changes_no_bit_however_wide_it_is():
    wide = run(in_a_row(HELD, {**BESIDE, "gap_m": 0.3}))
    wider = run(in_a_row(HELD, {**BESIDE, "gap_m": 7.0, "stiffness_N_m": 1e6, "mu": 0.5}))
    for column in ("rotation_rad", "slip_m", "neighbour_1_rotation_rad", "imbalance_J"):
        assert wide.history[column].tobytes() == wider.history[column].tobytes()
    # and alone it moves alike, but for the sizes of its steps
    alone = run(HELD)
    early = alone.history["time_s"] < 1.0
    apart = wide.history["rotation_rad"][early] - alone.history["rotation_rad"][early]
    assert np.abs(apart).max() <= 5e-5
    assert wide.history["neighbour_1_rotation_rad"] == pytest.approx(wide.history["rotation_rad"], abs=1e-12)
    assert wide.history["neighbour_1_x_m"][0] == pytest.approx(WIDTH + 0.3, abs=1e-12)


def test_a_light_neighbour_of_a_large_container_moves_as_precisely_as_alone():
    light = HELD.with_values({"solver.duration_s": 4.0, **pulse(4.14, 0.55)})
    large = light.with_values({"container.width_m": 15.0})
    beside = {**BESIDE, "gap_m": 9.0, "width_m": WIDTH, "mass_kg": MASS}
    found, alone = run(in_a_row(large, beside)), run(light)
    assert found.model.run.joints[1].max_rotation == pytest.approx(alone.track.max_rotation, rel=2e-3)
    # an energy error, and what counts as rest, is compared with the one that is overturned most easily
    reference = found.model.run.problem.control.reference_energy
    assert reference == pytest.approx(alone.model.run.problem.control.reference_energy, rel=1e-12)


def test_a_container_is_restored_whatever_its_neighbour_still_does():
    low = HELD.with_values({"container.height_m": 2.0, "solver.duration_s": 1.6, **pulse(8.0, 0.2)})
    beside = {**BESIDE, "gap_m": 1.5, "height_m": 6.0, "centroid_m": 3.0, "width_m": 1.6}
    found = run(in_a_row(low, beside))
    verdict = verdict_of(found.model, found.history, None)
    assert abs(found.history["neighbour_1_rotation_rad"][-1]) > 0.02
    assert (verdict.outcome, verdict.restored) == ("rock", True)


def test_the_steps_are_short_enough_for_every_container_and_rest_is_long_enough():
    slow = HELD.with_values({"motion.kind": "none", "container.height_m": 8.0})
    row = in_a_row(slow, {**BESIDE, "height_m": 1.0, "centroid_m": 0.5})
    alone = slow.with_values(case_of(row, row.neighbour[0]))
    mine, small = (build_model(one).static.frequency_parameter for one in (slow, alone))
    control = build_model(row).run.problem.control
    assert small > 1.5 * mine
    assert control.largest_step == pytest.approx(0.01 / small, rel=1e-12)
    assert control.slowest_rocking == mine
    assert build_model(in_a_row(slow, BESIDE)).run.problem.control.largest_step > 1.2 * control.largest_step
    mesh, motions = build_container(row), build_motions(row)
    assert chosen_values(row, mesh, motions)["solver.step_s"] == control.largest_step


def test_the_corners_of_a_narrow_neighbour_are_no_wide_base_beside_a_wide_container():
    # each closes by itself: the step that begins at a closing is that of an impact
    wide = HELD.with_values({"container.width_m": 6.0, "neighbour": [{**BESIDE, "width_m": WIDTH}]})
    assert build_model(wide).run.problem.control.near < WIDTH


def test_friction_regularised_in_velocity_that_jams_a_corner_is_refused_in_a_row():
    smooth = HELD.with_values({"contact.friction": "regularised", "solver.duration_s": 1.0})
    beside = {**BESIDE, "gap_m": 3.0, "height_m": 3.0, "centroid_m": 1.5, "mass_kg": 3e4}
    with pytest.raises(CaseError, match=r'neighbour 1 can jam .* above 1\.4.*take "elastic-stick"'):
        run(in_a_row(smooth, beside))
    assert run(in_a_row(smooth, beside), {"contact.mu_static": 1.2}).status == "completed"


@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.1])
@pytest.mark.parametrize("mass", [1e4, 3e4, math.inf], ids=["equal", "heavier", "stop"])
def test_two_sliders_keep_their_momentum_and_leave_with_their_restitution(restitution, mass):
    hit, stands = {**BESIDE, "restitution": restitution}, math.isinf(mass)
    keys = {"stop": [{**hit, "height_m": 0.5}]} if stands else {"neighbour": [{**hit, "mass_kg": mass}]}
    found = run(SLIDER.with_values(keys), {"output.history_s": 2e-5})
    first, other = (found.model.run.old.pose[4], 0.0) if stands else velocities(found)
    assert stands or MASS * first + mass * other == pytest.approx(MASS * SPEED, rel=1e-6)
    assert other - first == pytest.approx(restitution * SPEED, abs=1e-3 * SPEED)
    record, reduced = found.model.run.links[0], MASS / (1.0 + MASS / mass)
    assert record.hits == 1
    assert record.largest_closing_velocity == pytest.approx(SPEED, rel=1e-6)
    lost, damped = 0.5 * reduced * SPEED**2, found.model.run.ledger[CONTACT_DAMPING]
    assert damped == pytest.approx((1.0 - restitution**2) * lost, abs=1e-3 * lost)
    force = found.history["stop_1_force_N" if stands else "neighbour_1_force_N"]
    impulse = float(np.trapezoid(force, found.history["time_s"]))
    assert impulse == pytest.approx(reduced * (1.0 + restitution) * SPEED, rel=5e-3)
    if restitution == 1.0:
        largest = SPEED * math.sqrt(reduced * BESIDE["stiffness_N_m"])
        assert record.max_force == pytest.approx(largest, rel=1e-3)


@pytest.mark.parametrize("count", [2, 5])
def test_a_chain_of_equal_sliders_passes_the_momentum_on(count):
    beside = {**BESIDE, "gap_m": 0.02, "restitution": 1.0}
    found = run(in_a_row(SLIDER, *[beside] * count))
    assert velocities(found) == pytest.approx([*[0.0] * count, SPEED], abs=2e-3 * SPEED)
    assert list(found.model.run.links.hits) == [1] * count


def test_of_what_presses_a_row_against_a_wall_friction_holds_what_the_next_does_not():
    push, mu = 5.0, 0.2
    keys = {**pulse(-push, 2.0), "initial.velocity_m_s": 0.0, "solver.duration_s": 1.0}
    low = SLIDER.with_values({**keys, "contact.mu_static": 0.4, "contact.mu_kinetic": mu})
    wall = {"side": "right", "height_m": 0.5, "gap_m": 0.02, "stiffness_N_m": 1e8}
    found = run(in_a_row(low.with_values({"stop": [wall]}), {**BESIDE, "gap_m": 0.02}))
    beside, before = (found.history[f"{name}_1_force_N"][-1] for name in ("neighbour", "stop"))
    assert mu * MASS * GRAVITY + MASS * push == pytest.approx(beside, rel=1e-6)  # both have swung back
    assert 2.0 * beside == pytest.approx(before, rel=1e-6)
    body = found.model.body
    for number in range(2):
        holding, normal = holding_force(found.model.run, number, stands_loose(body), links_of(body))
        assert holding == pytest.approx(beside - MASS * push, rel=1e-5)
        assert normal == pytest.approx(MASS * GRAVITY, rel=1e-5)


def test_friction_between_the_sides_drags_containers_that_rock_together():
    # where two equal ones lean alike, the side of one rises along that of the other, which holds it
    smooth, rough = (run(in_a_row(HELD, {**BESIDE, "gap_m": 0.0, "mu": mu})) for mu in (0.0, 0.5))
    energy = smooth.model.run.problem.control.reference_energy
    assert smooth.model.run.ledger[FRICTION] < 1e-3 * energy < 0.1 * energy < rough.model.run.ledger[FRICTION]
    assert 0.05 < rough.track.max_rotation < 0.8 * smooth.track.max_rotation


def test_one_that_comes_to_rest_leaning_on_the_next_has_overturned():
    tilted = HELD.with_values({"motion.kind": "none", "initial.rotation_rad": 0.3, "solver.duration_s": 20.0})
    heavy = {**BESIDE, "gap_m": 1.5, "width_m": 6.0}
    found = run(in_a_row(tilted, heavy))
    assert found.status == found.outcome == "overturned"
    rotation = abs(found.history["rotation_rad"][-1])
    assert found.block.slenderness_angle < rotation < 0.5 * math.pi
    upright = run(in_a_row(tilted.with_values({"initial.rotation_rad": 0.2}), heavy))
    assert upright.status == "completed"


@pytest.mark.slow
def test_two_sliders_under_pulses_end_where_impulses_leave_them():
    rng, apart = np.random.default_rng(35), []
    for _ in range(50):
        peak, length, speed = rng.uniform(2.5, 6.0), rng.uniform(0.2, 0.6), rng.uniform(-1.0, 1.0)
        mu, restitution, mass = rng.uniform(0.1, 0.25), rng.uniform(0.05, 0.9), rng.uniform(0.5, 3.0)
        keys = {"contact.mu_static": mu, "initial.velocity_m_s": speed, "solver.duration_s": 3.0}
        keys |= {**pulse(peak, length), "motion.start": "rest"}
        beside = {**BESIDE, "gap_m": 0.02, "mass_kg": mass * MASS, "restitution": restitution}
        # at 1e8 N/m a hit lasts 26 ms, in which friction and pulse shift the ends ten times as far
        beside["stiffness_N_m"] = 1e10
        found = run(in_a_row(SLIDER.with_values(keys), beside))
        masses, start = np.array([1.0, mass]), np.array([speed, 0.0])
        expected = slide_in_a_row(masses, np.array([0.02]), start, mu, restitution, (peak, length), 3.0)
        ends = np.array([found.history["slip_m"][-1], found.history["neighbour_1_slip_m"][-1]])
        apart.append(np.abs(ends - expected).max())
    assert (np.percentile(apart, [50, 90, 100]) < [3e-4, 2e-3, 1e-2]).all()
