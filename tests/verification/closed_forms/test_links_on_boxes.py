"""Stops and ties on loose boxes and in rows: by hand, against one body, and what must not change anything."""

import math

import numpy as np
import pytest
from runs import BOX, SOLID, STACK, Finished, harmonic, pulse, run

from contact.stepping.ledger import CONTACT_DAMPING, FRICTION
from fem.case.case import Case
from fem.results.run_result import RunResult
from fem.run.card import line
from fem.run.verdict import verdict_of

MASS, SPEED, GRAVITY = 2500.0, 0.5, 9.81  # of a box of 1.1 x 1.0 m
TWO = BOX.with_values({"container.boxes": 2, "container.joints": "loose", "contact.mu_static": 1.0})
STOP = {"side": "right", "height_m": 1.0, "gap_m": 0.1, "stiffness_N_m": 1e8}
OTHER = {"left": "right", "right": "left"}


def held(case: Case, *stops: dict, tie: tuple[dict, ...] = (), neighbour: tuple[dict, ...] = ()) -> Case:
    return case.with_values({"stop": list(stops), "tie": list(tie), "neighbour": list(neighbour)})


def mirrored(*links: dict) -> tuple[dict, ...]:
    return tuple(
        one | {key: OTHER[value] for key, value in one.items() if key in ("side", "from")} for one in links
    )


@pytest.mark.parametrize("model", ["rigid", "reduced", pytest.param("full", marks=pytest.mark.slow)])
def test_boxes_that_stick_leave_a_stop_as_one_body_does(model):
    keys = {"initial.velocity_m_s": SPEED, "contact.mu_static": 0.0, "solver.duration_s": 0.5}
    keys |= SOLID | {"solver.model": model, "solver.element_size_m": 0.5, "solver.order": 1}
    soft = {**STOP, "stiffness_N_m": 1e6, "restitution": 0.5}
    one, loose = (
        run(held(TWO.with_values({**keys, **joints}), soft), {"output.history_s": 1e-4})
        for joints in ({"container.joints": "bolted"}, {"joints.mu_static": 2.0})
    )
    for found in (one, loose):
        record = found.model.run.links[0]
        assert record.hits == 1
        assert record.largest_closing_velocity == pytest.approx(SPEED, rel=1e-3)
        impulse = float(np.trapezoid(found.history["stop_1_force_N"], found.history["time_s"]))
        assert impulse == pytest.approx(2.0 * MASS * 1.5 * SPEED, rel=0.01)
        assert found.model.run.old.pose[4] == pytest.approx(-0.5 * SPEED, rel=0.02)
    assert loose.model.run.links[0].max_force == pytest.approx(one.model.run.links[0].max_force, rel=0.02)


def test_a_stop_holds_the_upper_box_while_the_lower_one_slides_out_below():
    push, floor, joint, time = 4.0, 0.1, 0.1, 0.5
    keys = pulse(-push, 1.0) | {"contact.mu_static": floor, "joints.mu_static": joint}
    stop = {**STOP, "height_m": 1.5, "gap_m": 0.0}
    found = run(held(TWO.with_values(keys), stop), {"solver.duration_s": time})
    force = found.history["stop_1_force_N"][found.history["time_s"] > 0.2]
    assert force.mean() == pytest.approx(MASS * (push + joint * GRAVITY), rel=0.01)
    slid = 0.5 * (push - joint * GRAVITY - 2.0 * floor * GRAVITY) * time**2
    assert found.history["slip_m"][-1] == pytest.approx(slid, rel=0.02)
    assert found.history["box_2_slip_m"][-1] == pytest.approx(-slid, rel=0.02)
    assert abs(found.history["box_2_x_m"][-1]) < 1e-3
    # at the joint it is the lower box that meets it, and then both are held
    lower = run(held(TWO.with_values(keys), {**stop, "height_m": 1.0}), {"solver.duration_s": time})
    assert abs(lower.history["slip_m"][-1]) < 1e-3
    assert lower.history["box_2_slip_m"][-1] == pytest.approx(
        0.5 * (push - joint * GRAVITY) * time**2, rel=0.02
    )


def test_a_tie_holds_down_the_lower_box_and_the_upper_one_stands_on_it_by_itself():
    push, keys = 7.0, {"contact.mu_static": 3.0, "solver.duration_s": 0.5}
    case = TWO.with_values({**pulse(-push, 1.0), **keys})
    tie = {"from": "left", "height_m": 0.8, "slack_m": 0.0, "stiffness_N_m": 3e6}
    free, tied = run(case), run(held(case, tie=(tie,)))
    assert free.model.run.joints.max_rotation.min() > 0.1
    # about the right edge: both boxes push at their common mass centre, their weight and the tie hold; the push comes
    # at once, so a tie without damping carries up to twice that
    force = 2.0 * MASS * (push * 1.0 - GRAVITY * 0.55) / 1.1
    assert tied.model.run.links[0].max_force == pytest.approx(2.0 * force, rel=0.05)
    assert tied.model.run.joints.max_rotation.max() < 0.01
    assert tied.model.run.joints[1].max_opening < 1e-3  # 7 m/s2 lift no box of 1.1 x 1.0 m


SLIPPERY = {"contact.mu_static": 0.2, "contact.mu_kinetic": 0.15}
SLIPPERY |= {"joints.mu_static": 0.3, "joints.mu_kinetic": 0.25}
FOUR = TWO.with_values(SLIPPERY | {**harmonic(0.08, 8.0), "container.boxes": 4, "solver.duration_s": 3.0})
WALLS = tuple(
    {"side": side, "height_m": height, "gap_m": gap, "stiffness_N_m": 1e8, "mu": 0.3, "restitution": 0.4}
    for side, height, gap in (("right", 0.5, 0.02), ("left", 3.5, 0.03))
)
TIE = {"from": "left", "height_m": 2.0, "slack_m": 0.0, "stiffness_N_m": 1e6}
ROW = STACK.with_values(
    {**harmonic(0.12, 6.0), "contact.mu_static": 0.4, "contact.mu_kinetic": 0.3, "solver.duration_s": 3.0}
)
BESIDE = {"side": "right", "gap_m": 0.02, "stiffness_N_m": 1e8, "mu": 0.3, "height_m": 3.0, "mass_kg": 8e3}
ENDS = tuple({**one, "height_m": 2.5} for one in WALLS)


def closes(found: Finished) -> bool:
    ledger, reference = found.model.run.ledger, found.model.run.problem.control.reference_energy
    return abs(ledger[-1]) < 0.01 * (ledger[FRICTION] + ledger[CONTACT_DAMPING]) + 1e-3 * reference


@pytest.mark.parametrize(
    ("case", "links", "beside", "until"),
    # boxes that rattle soon tell rounding errors apart
    [(ROW, ENDS, (), 0.8), (FOUR, WALLS, (), 0.3), (ROW, ENDS, (BESIDE,), 0.8)],
    ids=["one", "loose boxes", "row"],
)
def test_the_mirror_image_and_another_order_hit_alike_and_the_ledger_closes(case, links, beside, until):
    one = run(held(case, *links, tie=(TIE,), neighbour=beside))
    other = run(held(case, *links[::-1], tie=(TIE,), neighbour=beside))
    image = run(
        held(case, *mirrored(*links), tie=mirrored(TIE), neighbour=mirrored(*beside)),
        {"motion.phase_rad": math.pi},
    )
    records = one.model.run.links[len(beside) :]
    assert records.hits.min() > 0
    assert records.max_force[:2].min() > 1e4
    assert closes(one)
    early = one.history["time_s"] < until
    assert one.history["stop_1_force_N"][early].max() > 1e4
    for column in ("rotation_rad", "slip_m"):
        assert image.history[column][early] == pytest.approx(-one.history[column][early], abs=1e-8)
        assert other.history[column][early] == pytest.approx(one.history[column][early], abs=1e-8)
    assert other.model.run.links[len(beside) + 1].hits == records[0].hits


@pytest.mark.parametrize(("case", "beside"), [(FOUR, ()), (ROW, (BESIDE,))], ids=["loose boxes", "row"])
def test_links_that_are_not_reached_change_no_bit_wherever_they_are(case, beside):
    far = tuple({**one, "gap_m": 3.0} for one in WALLS[:1])
    farther = tuple({**one, "gap_m": 7.0, "height_m": 2.5, "stiffness_N_m": 1e5} for one in WALLS[:1])
    free, one, other = (run(held(case, *stops, neighbour=beside)) for stops in ((), far, farther))
    assert np.abs(free.history["slip_m"]).max() > 0.001
    for column in ("rotation_rad", "slip_m", "imbalance_J"):
        assert free.history[column].tobytes() == one.history[column].tobytes()
        assert one.history[column].tobytes() == other.history[column].tobytes()


def test_a_stop_of_the_upper_box_that_breaks_takes_its_energy_and_stays_broken():
    keys = pulse(-4.0, 0.6) | {"contact.mu_static": 3.0, "joints.mu_static": 0.1, "solver.duration_s": 0.8}
    stop = {**STOP, "height_m": 1.5, "gap_m": 0.0, "stiffness_N_m": 1e6, "damping_ratio": 0.02}
    whole, weak = (
        run(held(TWO.with_values(keys), {**stop, **one}), {"output.history_s": 1e-3})
        for one in ({}, {"strength_N": 6e3})
    )
    record, history = weak.model.run.links[0], weak.history
    assert record.max_force == pytest.approx(6e3, rel=1e-6)
    assert not history["stop_1_force_N"][history["time_s"] > record.broken_at + 2e-3].any()
    assert closes(weak)
    assert history["box_2_slip_m"].max() > 0.1 > 5.0 * whole.history["box_2_slip_m"].max()


def test_a_row_of_sliders_before_a_wall_returns_the_momentum():
    low = {"container.width_m": 4.0, "container.height_m": 1.0, "contact.mu_static": 0.0}
    slider = STACK.with_values({**low, "initial.velocity_m_s": SPEED, "solver.energy_tolerance": 0.1})
    beside = {"side": "right", "gap_m": 0.05, "stiffness_N_m": 1e8, "restitution": 1.0}
    wall = {**beside, "height_m": 0.5}
    found = run(held(slider, wall, neighbour=(beside,)), {"solver.duration_s": 0.8})
    assert found.model.run.old.boxes[:, 4] == pytest.approx([-SPEED, 0.0], abs=2e-3 * SPEED)
    gap, stop = found.model.run.links
    assert (gap.hits, stop.hits) == (2, 1)
    assert stop.largest_closing_velocity == pytest.approx(SPEED, rel=2e-3)
    # no neighbour is on the other side: there it is the container itself that a stop meets
    other = run(held(slider, {**wall, "side": "left"}, neighbour=(beside,)), {"initial.velocity_m_s": -SPEED})
    assert other.model.run.links[1].hits == 1


def test_a_row_that_does_not_touch_moves_before_walls_and_on_ties_as_one_container_does():
    case = STACK.with_values({"contact.mu_static": 3.0, "solver.duration_s": 2.0, **pulse(4.5, 0.4)})
    wall = {"side": "left", "height_m": 4.0, "gap_m": 0.05, "stiffness_N_m": 1e8, "restitution": 0.4}
    tie = {"from": "right", "height_m": 0.0, "slack_m": 0.001, "stiffness_N_m": 1e6}
    far = {"side": "right", "gap_m": 5.0, "stiffness_N_m": 1e8}
    for links in ({"tie": (tie,)}, {"stops": (wall,)}):
        one, row = (
            run(held(case, *links.get("stops", ()), tie=links.get("tie", ()), neighbour=beside))
            for beside in ((), (far,))
        )
        assert row.model.run.links[-1].max_force == pytest.approx(one.model.run.links[0].max_force, rel=1e-3)
        largest = np.abs(one.history["rotation_rad"]).max()
        assert row.history["rotation_rad"] == pytest.approx(one.history["rotation_rad"], abs=0.01 * largest)


@pytest.mark.parametrize("boxes", [1, 2])
def test_what_rests_on_a_stop_beyond_its_slenderness_angle_is_said_to_lean_and_has_overturned(boxes):
    # one body that starts tilted; of two loose boxes the upper one is pushed out over the edge of the lower one
    tilted = STACK.with_values({"contact.mu_static": 3.0, "initial.rotation_rad": 0.3})
    case, stop = tilted, {**STOP, "height_m": 3.0, "gap_m": 1.4}
    if boxes == 2:
        keys = pulse(-4.0, 0.8) | {"contact.mu_static": 3.0, "joints.mu_static": 0.1}
        case, stop = TWO.with_values(keys), {**STOP, "height_m": 2.0, "gap_m": 0.75}
    found = run(held(case, stop), {"solver.duration_s": 10.0})
    verdict = verdict_of(found.model, found.history, None)
    assert (found.status, verdict.outcome, verdict.leans) == ("overturned", "overturned", True)
    assert 0.0 < np.abs(found.model.run.joints.max_rotation).max() < 0.5 * math.pi or boxes == 1
    said = line(RunResult(status=found.status, verdict=verdict), "does")
    assert ("box 2 came" in said) == (boxes == 2)
    if boxes == 1:
        upright = run(held(case, stop), {"initial.rotation_rad": 0.25, "solver.duration_s": 10.0})
        free = run(case, {"solver.duration_s": 10.0})
        assert verdict_of(upright.model, upright.history, None).outcome != "overturned"
        assert verdict_of(free.model, free.history, None).leans is None
