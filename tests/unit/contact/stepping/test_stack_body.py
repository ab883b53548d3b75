"""A loose stack as a body of the stepping: what does not settle, its energy, scratch of its own."""

import numpy as np
import pytest
from stack_on_floor import Box, stack_rig

from contact.interface.equilibrium import SettlingError
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


def test_a_box_beyond_the_edge_of_the_one_below_does_not_settle():
    with pytest.raises(SettlingError, match="outside the face below"):
        stack_rig([Box(), Box(offset=0.56)])
    with pytest.raises(SettlingError, match="outside the face below"):
        stack_rig([Box(), Box(offset=0.3), Box(offset=0.55)])


@pytest.mark.parametrize("elastic", [None, ELASTIC], ids=["rigid", "elastic"])
def test_the_ledger_holds_all_energy(elastic):
    shaken = stack_rig([Box()] * 4, motion=SHAKE, mu=0.5, joint_mu=0.25, elastic=elastic)
    run, reference = shaken.run, shaken.whole.reference_energy

    def energy() -> float:
        return float(run.old.energy.sum()) + spring_energy(run.problem.contact, run.old.point, run.old.stick)

    start = energy()
    shaken.advance(6.0)
    gained = run.ledger[BASE_WORK] - dissipation(run.ledger) - run.ledger[IMBALANCE]
    assert energy() - start == pytest.approx(gained, abs=1e-9 * reference)
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
