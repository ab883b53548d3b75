"""A loose stack as a body of the stepping: settled start, equilibrium of the boxes, one box, scratch."""

import numpy as np
import pytest
from block_on_floor import GRAVITY
from stack_on_floor import Box, joint_force, stack_rig

from contact.interface.equilibrium import SettlingError
from contact.interface.faces import points_of_joint
from contact.motion.base_motion import HarmonicMotion
from contact.stepping.ledger import BASE_WORK, IMBALANCE, dissipation, spring_energy
from contact.stepping.loose_stack import stack_with_own_scratch
from contact.stepping.outcome import run_to_end

SHAKE = HarmonicMotion(amplitude=6.0 / 6.928**2, angular_frequency=6.928, duration=20.0)
#: two modes of a box: its corners spread, and it shears
MODES = np.zeros((4, 2, 2))
MODES[:, 0, 0], MODES[:, 1, 0] = [-0.012, 0.012, 0.008, -0.008], [-0.01, -0.01, 0.02, 0.02]
MODES[:, 0, 1] = [-0.015, -0.015, 0.02, 0.02]
ELASTIC = (MODES, np.array([180.0, 260.0]), 0.02)


@pytest.mark.parametrize("elastic", [None, ELASTIC], ids=["rigid", "elastic"])
def test_each_joint_of_a_settled_stack_carries_what_is_above_it(elastic):
    boxes = [Box(), Box(mass=4000.0, width=0.9, offset=0.1), Box(mass=1000.0, height=0.5, offset=-0.15)]
    settled = stack_rig(boxes, elastic=elastic)
    state, n = settled.run.old, len(boxes)
    for j in range(n):
        weight = GRAVITY * sum(box.mass for box in boxes[j:])
        assert joint_force(settled, j) == pytest.approx([0.0, weight], abs=3e-5 * weight)
    # about the left end of what carries it: the lever rule
    places = np.cumsum([box.offset for box in boxes])
    for j in range(n):
        points = points_of_joint(j)
        left = places[j] - 0.5 * boxes[j].width
        x = state.point[points, 0] if j == 0 else _along_floor(settled, points)
        moment = sum(GRAVITY * box.mass * (at - left) for box, at in zip(boxes[j:], places[j:], strict=True))
        assert state.force[points, 1] @ (x - left) == pytest.approx(moment, rel=3e-4)
    scale = np.tile([1.0, 1.0, 1.0, *[50.0] * settled.stack.body.modes], n)  # a mode's is per root of kg
    assert np.abs(state.acceleration / scale).max() < 1e-9 * GRAVITY


def _along_floor(settled, points):
    return settled.run.old.corner[settled.stack.faces.corner[points, 0], 0]


def test_a_box_beyond_the_edge_of_the_one_below_does_not_settle():
    with pytest.raises(SettlingError, match="outside the face below"):
        stack_rig([Box(), Box(offset=0.56)])
    with pytest.raises(SettlingError, match="outside the face below"):
        stack_rig([Box(), Box(offset=0.3), Box(offset=0.55)])


@pytest.mark.parametrize("elastic", [None, ELASTIC], ids=["rigid", "elastic"])
def test_forces_between_boxes_change_neither_momentum_nor_angular_momentum(elastic):
    """At every look in a violent motion, impacts within: on all boxes together only floor and weight act."""
    shaken = stack_rig([Box()] * 4, motion=SHAKE, mu=0.5, joint_mu=0.3, elastic=elastic)
    size, largest = 3 + shaken.stack.body.modes, 0.0
    for until in np.linspace(0.2, 4.0, 60):
        shaken.advance(until)
        state, floor = shaken.run.old, shaken.run.floor[0, 0]
        external = state.external.reshape(4, size)
        position = state.position.reshape(4, size)
        total = external[:, :2].sum(axis=0)
        on_floor = state.force[:2].sum(axis=0)
        force = np.abs(state.force).max()
        assert total == pytest.approx(on_floor, abs=1e-9 * force)
        turning = external[:, 2].sum() + position[:, 1] @ external[:, 0] - position[:, 0] @ external[:, 1]
        x = state.point[:2, 0] + floor
        moment = state.point[:2, 1] @ state.force[:2, 0] - x @ state.force[:2, 1]
        # arms are those of the last iteration, before the deformation and the rotation that it finds
        assert turning == pytest.approx(moment, abs=(1e-5 if elastic is None else 1e-4) * force)
        largest = max(largest, np.abs(position[:, 2]).max())
    assert largest > 0.05


@pytest.mark.parametrize("elastic", [None, ELASTIC], ids=["rigid", "elastic"])
def test_the_ledger_holds_all_energy(elastic):
    shaken = stack_rig([Box()] * 4, motion=SHAKE, mu=0.5, joint_mu=0.25, elastic=elastic)
    run, reference = shaken.run, shaken.whole.reference_energy

    def energy() -> float:
        return float(run.old.energy.sum()) + spring_energy(run.problem.contact, run.old.point, run.old.stick)

    start = energy()
    shaken.advance(6.0)
    assert energy() - start == pytest.approx(
        run.ledger[BASE_WORK] - dissipation(run.ledger) - run.ledger[IMBALANCE], abs=1e-9 * reference
    )
    assert shaken.joints.max_slip.max() > 0.05
    assert run.clock[0].least_imbalance > -1e-4 * reference
    assert run.clock[0].most_imbalance < 1e-2 * dissipation(run.ledger)


def test_stacks_with_scratch_of_their_own_do_not_disturb_one_another():
    one, other = (stack_rig([Box()] * 3, motion=SHAKE, joint_mu=0.3) for _ in range(2))
    run_to_end(one.stack, one.run, 3.0)
    shared = stack_with_own_scratch(one.stack)
    assert not np.shares_memory(shared.body.boxes.arm, one.stack.body.boxes.arm)
    assert not np.shares_memory(shared.faces.weight, one.stack.faces.weight)
    run_to_end(one.stack, other.run, 3.0)  # with the stack of the first
    assert one.run.old.numbers.tobytes() == other.run.old.numbers.tobytes()
