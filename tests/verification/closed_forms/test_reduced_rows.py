"""Reduced containers in a row: the rigid row as limit, the compliance where a side is struck, hits, mirror images.

The meshes are coarse: what is compared has the same mesh, or none.
"""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from contact.stepping.body import VELOCITY_X
from contact.stepping.ledger import IMBALANCE, MATERIAL_DAMPING
from fem.assessment.verdict import audit
from fem.case.case import Case
from fem.evidence.verification.runs import STACK, Finished, harmonic, pulse, run
from fem.model.container import discretise
from fem.model.model import build_model
from fem.model.recovery import recovery_of
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.solid.reduction import static_response
from fem.solid.sides import nodes_at
from fem.study.containers import ContainerCache

HEIGHT, WIDTH, SPEED = 4.0, 1.1, 0.5
BESIDE = {"side": "right", "gap_m": 0.01, "stiffness_N_m": 1e8, "damping_ratio": 0.5}
LOW = {**BESIDE, "boxes": 3}
SHELL = STACK.with_values(
    {
        "container.boxes": 4,
        "container.height_m": 1.0,
        "container.weight_N": 24525.0,
        "container.section": "shell",
        "container.wall_m": 0.008,
        "container.youngs_modulus_Pa": 2.1e11,
        "solver.model": "reduced",
        "solver.element_size_m": 0.25,
        "solver.order": 1,
        "solver.elastic_modes": 8,
        "contact.mu_static": 3.0,
        "solver.duration_s": 1.7,
        **pulse(4.5, 0.4),
    }
)


def in_a_row(case: Case, *neighbours: dict, **links: list[dict]) -> Case:
    return case.with_values({"neighbour": list(neighbours), **links})


def stresses(found: Finished) -> tuple[float, ...]:
    largest = recovery_of(found.model).largest_of_steps(found.model.run.strained)
    assert largest is not None
    return largest


def test_stiff_containers_move_as_the_rigid_row():
    solid = SHELL.with_values(
        {
            "container.section": "solid",
            "container.youngs_modulus_Pa": 1e13,
            "contact.normal_penalty_Pa_m": 2e9,
        }
    )
    stiff, rigid = (run(in_a_row(solid, LOW), {"solver.model": model}) for model in ("reduced", "rigid"))
    early = rigid.history["time_s"] < 1.0
    for column in ("rotation_rad", "neighbour_1_rotation_rad"):
        largest = np.abs(rigid.history[column]).max()
        assert stiff.history[column][early] == pytest.approx(rigid.history[column][early], abs=0.01 * largest)
    first, other = (one.model.run.links[0] for one in (stiff, rigid))
    assert first.hits == other.hits > 0
    assert first.largest_closing_velocity == pytest.approx(other.largest_closing_velocity, rel=5e-3)


def test_a_side_that_is_struck_has_the_compliance_of_its_shell_there():
    case = in_a_row(SHELL.with_values({"support.effective_width": 0.98}), LOW)
    model = build_model(case)
    boxes, faces = model.body.body.boxes, model.body.faces
    height = float(LOW["boxes"])
    container = model.container.row[0]
    node = nodes_at(np.array([[0.5 * WIDTH, height]]), container.elements.nodes)
    expected = static_response(container.elements, node).compliance
    corner = boxes.shape[0]  # bottom left, bottom right, top left, top right
    struck = corner[1] + height / HEIGHT * (corner[3] - corner[1])
    assert container.elements.nodes[node[0], 1] == pytest.approx(height, abs=1e-9)
    assert np.einsum("im,m,jm->ij", struck, 1.0 / boxes.stiffness[0], struck) == pytest.approx(
        expected, rel=1e-6, abs=1e-6 * np.abs(expected).max()
    )
    # over the floor they are those of the container alone
    alone = model.equilibrium.row[0].body.shape
    share = faces.place[:2, 0, None, None]
    assert (1.0 - share) * corner[0] + share * corner[1] == pytest.approx(alone, abs=1e-12)


def test_a_gap_that_is_not_used_up_changes_no_bit_and_leaves_each_as_alone():
    wide, wider = (run(in_a_row(SHELL, {**BESIDE, "gap_m": gap})) for gap in (0.5, 7.0))
    for column in ("rotation_rad", "slip_m", "strain_J", "neighbour_1_rotation_rad", "imbalance_J"):
        assert wide.history[column].tobytes() == wider.history[column].tobytes()
    alone = run(SHELL)
    largest = np.abs(alone.history["rotation_rad"]).max()
    early = alone.history["time_s"] < 0.8  # up to the first landing
    assert wide.history["rotation_rad"][early] == pytest.approx(
        alone.history["rotation_rad"][early], abs=2e-3 * largest
    )
    assert stresses(wide)[0] == pytest.approx(stresses(wide)[1], rel=1e-9)
    assert stresses(wide)[0] == pytest.approx(stresses(alone)[0], rel=0.1)


#: one box that slides without friction against another
SLIDER = SHELL.with_values(
    {
        "motion.kind": "none",
        "container.boxes": 1,
        "contact.mu_static": 0.0,
        "container.centroid_m": 0.5,
        "initial.velocity_m_s": SPEED,
        "solver.duration_s": 0.15,
    }
)
STRUCK = {"side": "right", "gap_m": 0.01, "stiffness_N_m": 1e8, "restitution": 1.0, "mass_kg": 5000.0}


def test_a_hit_keeps_the_momentum_and_its_energy_is_accounted_for():
    found = run(in_a_row(SLIDER, STRUCK))
    ledger, mass = found.model.run.ledger, SLIDER.mass
    moving = found.model.run.old.boxes[:, VELOCITY_X]
    assert found.model.run.links[0].hits > 0
    assert mass * moving[0] + STRUCK["mass_kg"] * moving[1] == pytest.approx(mass * SPEED, rel=1e-6)
    assert 0.0 < moving[1] - moving[0] < SPEED  # vibration takes the rest
    assert abs(ledger[IMBALANCE]) < 2e-3 * 0.5 * mass * SPEED**2
    assert audit(found.model) is None


def test_what_a_wall_takes_from_a_row_is_its_impulse():
    wall = {"side": "right", "height_m": 0.5, "gap_m": 0.005, "stiffness_N_m": 1e8, "restitution": 1.0}
    found = run(in_a_row(SLIDER, STRUCK, stop=[wall]), {"output.history_s": 2e-5, "solver.duration_s": 0.06})
    mass, moving = SLIDER.mass, found.model.run.old.boxes[:, VELOCITY_X]
    between, before = found.model.run.links
    assert between.hits > 0 and before.hits > 0
    impulse = float(np.trapezoid(found.history["stop_1_force_N"], found.history["time_s"]))
    assert impulse > 0.5 * mass * SPEED
    left = mass * moving[0] + STRUCK["mass_kg"] * moving[1]
    assert mass * SPEED - left == pytest.approx(impulse, rel=2e-3)
    assert abs(found.model.run.ledger[IMBALANCE]) < 2e-3 * 0.5 * mass * SPEED**2


def test_walls_and_ties_that_a_row_does_not_reach_change_no_bit_wherever_they_are():
    def held(gap: float, height: float, stiffness: float) -> Finished:
        link = {"height_m": height, "stiffness_N_m": stiffness}
        walls = [{**link, "side": side, "gap_m": gap} for side in ("left", "right")]
        ties = [{**link, "from": "left", "slack_m": gap}]
        return run(in_a_row(SHELL, LOW, stop=walls, tie=ties))

    near, far = held(3.0, 1.0, 1e8), held(7.0, 1.0, 1e6)
    assert near.model.run.links[0].hits > 0
    for column in ("rotation_rad", "slip_m", "strain_J", "neighbour_1_rotation_rad", "imbalance_J"):
        assert near.history[column].tobytes() == far.history[column].tobytes()


def test_the_stress_of_a_blow_is_recorded_for_each_and_converges_with_the_modes():
    still, softer, harder, finer = (
        run(in_a_row(SLIDER, {**STRUCK, "stiffness_N_m": stiffness}), changes)
        for stiffness, changes in (
            (1e8, {"initial.velocity_m_s": 0.0}),
            (1e7, {}),
            (1e8, {}),
            (1e8, {"solver.elastic_modes": 20}),
        )
    )
    assert stresses(softer)[1] > 1.4 * stresses(still)[1]
    assert stresses(harder)[1] > 1.5 * stresses(softer)[1]
    assert stresses(finer) == pytest.approx(stresses(harder), rel=0.05)
    assert finer.model.run.links[0].max_force == pytest.approx(harder.model.run.links[0].max_force, rel=0.02)


def test_the_stress_of_a_weaker_blow_soon_after_another_is_recorded_too():
    # both within the window of which the most strained step is kept
    weaker = {**STRUCK, "restitution": 0.3, "gap_m": 0.005}
    found = run(in_a_row(SLIDER, weaker, weaker), {"solver.duration_s": 0.05})
    still = run(in_a_row(SLIDER, weaker, weaker), {"initial.velocity_m_s": 0.0, "solver.duration_s": 0.05})
    assert list(found.model.run.links.hits) == [1, 1]
    assert stresses(found)[2] > 2.0 * stresses(still)[2]


def test_the_ledger_of_a_reduced_row_closes():
    blow = run(in_a_row(SHELL, LOW))
    assert blow.model.run.links[0].hits > 0 and audit(blow.model) is None
    assert blow.model.run.ledger[MATERIAL_DAMPING] > 0.0


def test_the_mirrored_row_moves_as_the_mirror_image_and_the_order_does_not_matter():
    shaken = SHELL.with_values({**harmonic(0.12, 6.0), "contact.mu_static": 0.4, "solver.duration_s": 0.6})
    pair = ({**LOW, "mu": 0.3}, {**BESIDE, "side": "left", "gap_m": 0.02})
    # a wall at one end, and a tie on the container
    wall = {**BESIDE, "height_m": 2.5, "mu": 0.3}
    tie = {"from": "left", "height_m": 2.0, "stiffness_N_m": 1e6}

    def mirrored(rows: Sequence[dict]) -> list[dict]:
        other = {"left": "right", "right": "left"}
        return [{key: other.get(value, value) for key, value in one.items()} for one in rows]

    one = run(in_a_row(shaken, *pair, stop=[wall], tie=[tie]))
    other = run(in_a_row(shaken, *pair[::-1], stop=[wall], tie=[tie]))
    image = run(
        in_a_row(shaken, *mirrored(pair), stop=mirrored([wall]), tie=mirrored([tie])),
        {"motion.phase_rad": math.pi},
    )
    assert one.model.run.links.hits.max() > 0 and one.model.run.links.max_force.min() > 0.0
    early = one.history["time_s"] < 0.5
    assert one.history["stop_1_force_N"][early].max() > 1e4 < image.history["stop_1_force_N"][early].max()
    for column in ("rotation_rad", "slip_m", "neighbour_1_rotation_rad", "neighbour_2_x_m"):
        assert image.history[column][early] == pytest.approx(-one.history[column][early], abs=1e-7)
    assert other.history["neighbour_2_rotation_rad"][early] == pytest.approx(
        one.history["neighbour_1_rotation_rad"][early], abs=1e-7
    )


def test_of_two_equal_containers_it_does_not_matter_which_is_the_one_of_the_case():
    shaken = SHELL.with_values({**harmonic(0.12, 6.0), "contact.mu_static": 0.4, "solver.duration_s": 0.6})
    left, right = (run(in_a_row(shaken, {**BESIDE, "side": side})) for side in ("right", "left"))
    early = left.history["time_s"] < 0.5
    for column in ("rotation_rad", "slip_m"):
        assert right.history[f"neighbour_1_{column}"][early] == pytest.approx(
            left.history[column][early], abs=1e-7
        )


def test_a_row_shares_what_is_equal_and_no_more():
    row = discretise(in_a_row(SHELL, BESIDE, {**LOW, "side": "left"})).row
    assert row[0] is not row[1]  # struck at another height on its left
    same = discretise(in_a_row(SHELL, BESIDE)).row
    assert same[0] is same[1]


def test_containers_with_other_gaps_are_not_reduced_again():
    cache = ContainerCache()
    near, far = (cache.container_of(in_a_row(SHELL, {**LOW, "gap_m": gap})) for gap in (0.0, 0.3))
    assert all(one is other for one, other in zip(near.row, far.row, strict=True))
    assert np.ptp(far.elements.nodes[:, 0]) == pytest.approx(2 * WIDTH + 0.3, abs=1e-9)


@pytest.mark.parametrize("eccentricity", [0.0, 0.05])
def test_gaps_are_those_at_rest_of_shells_that_bulge_and_lean(eccentricity):
    # before the moment of the weight over the lean, which the equilibrium leaves out, moves the top: 10 nm in 20 ms
    still = SHELL.with_values(
        {"motion.kind": "none", "container.eccentricity_m": eccentricity, "solver.duration_s": 0.002}
    )
    for gap in (0.0, 1e-3):
        found = run(in_a_row(still, {**LOW, "gap_m": gap}))
        record = found.model.run.links[0]
        assert record.least_gap == pytest.approx(gap, abs=1e-9)
        assert record.max_force < 1.0


@pytest.mark.parametrize("model", ["rigid", "reduced"])
def test_the_fields_hold_every_container_of_the_row_where_its_history_has_it(model):
    case = in_a_row(SHELL, LOW, {**BESIDE, "side": "left"}).with_values(
        {"solver.model": model, "solver.duration_s": 0.6, "output.history_s": 0.1, "output.fields_s": 0.1}
    )
    built, frames = build_model(case), []
    recovery = recovery_of(built)
    recorder = Recorder(built, recovery, frame_sink=frames.append)
    simulate(built, recorder)
    history = recorder.history()
    assert len(frames) == 7
    for number, nodes in enumerate(built.container.box_nodes):
        name = f"neighbour_{number}_" if number else ""
        places = recovery.elements.nodes[nodes]
        for column, frame in enumerate(frames):
            turned = history[f"{name}rotation_rad"][column]
            moved = places + frame.displacement[nodes]
            left, right = moved[places[:, 1] == 0.0][[0, -1]]
            assert math.atan2(left[1] - right[1], right[0] - left[0]) == pytest.approx(turned, abs=2e-4)
            assert (frame.von_mises is not None) == (model == "reduced")
        assert np.abs(history[f"{name}rotation_rad"]).max() > 0.01
    assert np.ptp(places[:, 0]) == pytest.approx(WIDTH, abs=1e-9)
