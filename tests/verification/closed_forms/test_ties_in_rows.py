"""Ties between containers of a row: what one end loses the other gets, over the distance of both ends."""

import math

import numpy as np
import pytest
from runs import SOLID, STACK, Finished, harmonic, pulse, run

from contact.interface.penalty import restitution_of
from contact.stepping.ledger import CONTACT_DAMPING, FRICTION
from fem.case.case import Case

MASS, WIDTH, HEIGHT, SPEED, GRAVITY = 1e4, 1.1, 4.0, 0.5, 9.81
OTHER = {"left": "right", "right": "left"}
BESIDE = {"side": "left", "gap_m": 0.2, "stiffness_N_m": 1e8}
TIE = {"from": "left", "to": "neighbour", "height_m": 0.5, "stiffness_N_m": 1e6}
#: held by friction, so that it rocks
HELD = STACK.with_values({"contact.mu_static": 3.0, "solver.duration_s": 1.0})
#: slides without friction toward +x, and is too low to turn
SLIDER = STACK.with_values(
    {
        "container.width_m": 4.0,
        "container.height_m": 1.0,
        "contact.mu_static": 0.0,
        "initial.velocity_m_s": SPEED,
        "solver.duration_s": 0.8,
        "solver.energy_tolerance": 0.1,
    }
)


def tied(case: Case, *ties: dict, beside: tuple[dict, ...] = (BESIDE,)) -> Case:
    return case.with_values({"neighbour": list(beside), "tie": list(ties)})


def ends(found: Finished, tie: dict, width: float = WIDTH, height: float = HEIGHT) -> np.ndarray:
    """Distance of both ends of a tie from the container to its neighbour, by the poses of the history [m]."""
    history, outward = found.history, -1.0 if tie["from"] == "left" else 1.0
    points = []
    for name, side, at in (
        ("", outward, tie["height_m"]),
        ("neighbour_1_", -outward, tie.get("to_height_m", tie["height_m"])),
    ):
        turn = history[f"{name}rotation_rad"]
        x, z = (history[f"{name}{k}"] for k in (("x_m", "z_m") if name else ("centre_x_m", "centre_z_m")))
        along, up = 0.5 * side * width, at - 0.5 * height
        cosine, sine = np.cos(turn), np.sin(turn)
        points.append(np.array([x + cosine * along + sine * up, z - sine * along + cosine * up]))
    return np.hypot(*(points[1] - points[0]))


@pytest.mark.parametrize("ratio", [0.0, 0.3])
@pytest.mark.parametrize("mass", [1e4, 3e4])
def test_what_is_tied_keeps_its_momentum_and_gets_the_energy_that_no_dashpot_takes(mass, ratio):
    tie = {**TIE, "slack_m": 0.05, "damping_ratio": ratio}
    found = run(tied(SLIDER, tie, beside=({**BESIDE, "mass_kg": mass},)), {"output.history_s": 1e-4})
    first, other = found.model.run.old.boxes[:, 4]
    reduced, restitution = MASS * mass / (MASS + mass), restitution_of(ratio)
    assert MASS * first + mass * other == pytest.approx(MASS * SPEED, rel=1e-9)
    assert other - first == pytest.approx(restitution * SPEED, abs=1e-3 * SPEED)
    record, ledger = found.model.run.links[-1], found.model.run.ledger
    assert (record.hits, record.largest_closing_velocity) == (1, pytest.approx(SPEED, rel=1e-6))
    lost = (1.0 - restitution**2) * 0.5 * reduced * SPEED**2
    assert ledger[CONTACT_DAMPING] == pytest.approx(lost, abs=1e-3 * 0.5 * reduced * SPEED**2)
    impulse = float(np.trapezoid(found.history["tie_1_force_N"], found.history["time_s"]))
    assert impulse == pytest.approx(reduced * (1.0 + restitution) * SPEED, rel=5e-3)
    if ratio == 0.0:
        assert record.max_force == pytest.approx(SPEED * math.sqrt(reduced * 1e6), rel=1e-3)


@pytest.mark.parametrize("there", [2.5, 3.5])
def test_a_tie_pulls_by_the_distance_of_its_ends_wherever_they_move(there):
    tie = {**TIE, "height_m": 3.5, "to_height_m": there, "stiffness_N_m": 2e5, "slack_m": 0.01}
    moving = HELD.with_values({"initial.angular_velocity_rad_s": 0.5, "output.history_s": 2e-3})
    found = run(tied(moving, tie))
    history = found.history
    assert np.abs(history["neighbour_1_rotation_rad"]).max() > 0.01 and history["rotation_rad"].max() > 0.02
    length = math.hypot(0.2, 3.5 - there)
    expected = 2e5 * np.maximum(ends(found, tie) - length - 0.01, 0.0)
    assert expected.max() > 5e3
    assert history["tie_1_force_N"] == pytest.approx(expected, abs=1e-3 * expected.max())
    # forces of both ends and of the floor change the momentum of both
    ledger, reference = found.model.run.ledger, found.model.run.problem.control.reference_energy
    assert abs(ledger[-1]) < 0.01 * (ledger[FRICTION] + ledger[CONTACT_DAMPING]) + 1e-3 * reference


def test_equal_containers_that_slide_in_phase_leave_a_taut_tie_without_force():
    sliding = STACK.with_values(
        {
            **harmonic(0.1, 6.0),
            "container.height_m": 2.0,
            "contact.mu_static": 0.2,
            "contact.mu_kinetic": 0.15,
            "solver.duration_s": 3.0,
        }
    )
    found = run(tied(sliding, {**TIE, "height_m": 1.5}))
    assert np.ptp(found.history["slip_m"]) > 0.05
    assert found.model.run.links[-1].max_force < 1e-7 * MASS * GRAVITY


def test_without_stiffness_or_strength_a_row_moves_as_untied():
    shaken = HELD.with_values({**pulse(4.5, 0.4), "solver.duration_s": 1.5})
    beside = ({**BESIDE, "height_m": 3.0, "centroid_m": 1.5},)
    free = run(tied(shaken, beside=beside))
    largest = np.abs(free.history["rotation_rad"]).max()
    assert largest > 0.05
    for weak in ({"stiffness_N_m": 1.0}, {"strength_N": 1.0}):
        found = run(tied(shaken, {**TIE, "height_m": 3.0, **weak}, beside=beside))
        for column in ("rotation_rad", "neighbour_1_rotation_rad"):
            assert found.history[column] == pytest.approx(free.history[column], abs=1e-3 * largest)


def test_a_tie_that_cannot_stretch_keeps_its_ends_at_their_distance():
    tie = {**TIE, "height_m": 4.0, "to_height_m": 3.0, "stiffness_N_m": 1e10}
    moving = HELD.with_values({"initial.angular_velocity_rad_s": 0.3, "solver.duration_s": 0.4})
    found = run(tied(moving, tie))
    length = ends(found, tie)
    assert np.ptp(found.history["rotation_rad"]) > 0.01
    assert length.max() == pytest.approx(math.hypot(0.2, 1.0), abs=1e-4)
    assert np.ptp(found.history["neighbour_1_rotation_rad"]) > 0.01


def test_a_heavy_neighbour_holds_a_tie_as_a_wall_does():
    keys = {"container.weight_N": 4e3, "container.width_m": 1.0, "container.depth_m": 4.0}
    light = SLIDER.with_values(keys)
    heavy = {**BESIDE, "gap_m": 1.0, "width_m": 15.0, "mass_kg": 1e6}
    tie = {**TIE, "slack_m": 0.05}
    beside = run(tied(light, tie, beside=(heavy,)))
    before = run(light.with_values({"tie": [{**tie, "to": "wall"}]}))
    assert beside.model.run.old.boxes[0, 4] == pytest.approx(before.model.run.old.pose[4], abs=5e-3 * SPEED)
    assert beside.model.run.links[-1].max_force == pytest.approx(
        before.model.run.links[0].max_force, rel=2e-3
    )


def test_a_tie_between_containers_that_breaks_takes_its_energy_and_stays_broken():
    tie = {**TIE, "slack_m": 0.05, "strength_N": 1e4}
    found = run(tied(SLIDER, tie), {"output.history_s": 1e-3})
    record, history = found.model.run.links[-1], found.history
    assert record.max_force == pytest.approx(1e4, rel=1e-5)
    assert 0.1 < record.broken_at < 0.2
    assert not history["tie_1_force_N"][history["time_s"] > record.broken_at + 2e-3].any()
    assert found.model.run.ledger[CONTACT_DAMPING] == pytest.approx(0.5 * 1e4**2 / 1e6, rel=0.01)
    first, other = found.model.run.old.boxes[:, 4]
    assert MASS * (first + other) == pytest.approx(MASS * SPEED, rel=1e-9)
    left = 0.5 * MASS * SPEED**2 - 0.5 * 1e4**2 / 1e6
    assert 0.5 * MASS * (first**2 + other**2) == pytest.approx(left, rel=1e-3)


SHAKEN = STACK.with_values(
    {**harmonic(0.12, 6.0), "contact.mu_static": 0.4, "contact.mu_kinetic": 0.3, "solver.duration_s": 2.0}
)
PAIR = (
    {**BESIDE, "side": "right", "gap_m": 0.02, "mu": 0.3, "height_m": 3.0, "mass_kg": 8e3},
    {**BESIDE, "gap_m": 0.03, "width_m": 1.5, "restitution": 0.4},
)
TIES = (
    {**TIE, "from": "right", "height_m": 2.5, "to_height_m": 1.0},
    {**TIE, "neighbour": 2, "from": "right", "height_m": 3.0, "to_height_m": 3.5, "slack_m": 0.01},
)


def mirrored(*rows: dict) -> tuple[dict, ...]:
    return tuple(
        {key: OTHER[value] if key in ("side", "from") else value for key, value in row.items()}
        for row in rows
    )


def test_the_mirror_image_another_order_and_the_other_end_of_ties_between_containers_move_alike():
    right = run(tied(SHAKEN, *TIES, beside=PAIR))
    left = run(tied(SHAKEN, *mirrored(*TIES), beside=mirrored(*PAIR)), {"motion.phase_rad": math.pi})
    # the same straps, from their other ends
    back = (
        {**TIE, "from": "left", "height_m": 3.5, "to_height_m": 3.0, "slack_m": 0.01},
        {**TIE, "neighbour": 1, "from": "left", "height_m": 1.0, "to_height_m": 2.5},
    )
    other = run(tied(SHAKEN, *back, beside=PAIR))
    early = right.history["time_s"] < 1.0
    assert right.history["tie_1_force_N"][early].max() > 1e4 < right.history["tie_2_force_N"][early].max()
    for column in ("rotation_rad", "slip_m", "neighbour_1_rotation_rad", "neighbour_2_slip_m"):
        assert left.history[column][early] == pytest.approx(-right.history[column][early], abs=1e-8)
        assert other.history[column][early] == pytest.approx(right.history[column][early], abs=1e-8)
    assert other.model.run.links.hits[2] == right.model.run.links.hits[3] > 0


def test_ties_between_containers_that_stay_slack_change_no_bit_whatever_they_are():
    slack = [
        run(tied(SHAKEN, {**TIE, "slack_m": slack, "stiffness_N_m": k, "height_m": at}, beside=PAIR))
        for slack, k, at in ((3.0, 1e6, 0.5), (7.0, 1.0, 2.0))
    ]
    assert np.abs(slack[0].history["slip_m"]).max() > 0.01
    for column in ("rotation_rad", "slip_m", "neighbour_1_rotation_rad", "imbalance_J"):
        assert slack[0].history[column].tobytes() == slack[1].history[column].tobytes()


def test_stiff_containers_are_tied_as_rigid_ones_are():
    keys = SOLID | {"solver.element_size_m": 0.5, "solver.order": 1, "container.youngs_modulus_Pa": 1e13}
    tie = {**TIE, "height_m": 3.0, "to_height_m": 2.0}
    moving = HELD.with_values({"initial.angular_velocity_rad_s": 0.4, "solver.duration_s": 0.6, **keys})
    rigid, reduced = (run(tied(moving, tie), {"solver.model": model}) for model in ("rigid", "reduced"))
    assert rigid.model.run.links[-1].max_force > 1e4
    assert reduced.model.run.links[-1].max_force == pytest.approx(
        rigid.model.run.links[-1].max_force, rel=0.01
    )
    for column in ("rotation_rad", "neighbour_1_rotation_rad"):
        largest = np.abs(rigid.history[column]).max()
        assert reduced.history[column] == pytest.approx(rigid.history[column], abs=0.02 * largest)
