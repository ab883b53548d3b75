"""Two blocks without sliding: Lagrange's equations against Newton and Euler's, starts, impacts, limits."""

import math

import numpy as np
import pytest
from floors import sine_floor, still_floor
from two_blocks import (
    Footing,
    Pattern,
    StackedBlock,
    TwoBlockStack,
    contact_normals,
    energy,
    simulate_two_blocks,
)

from contact.reference.floor_acceleration import Acceleration
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

G = 9.81
BOX = StackedBlock.homogeneous(width=1.1, height=2.0, mass=5000.0)
EQUAL = TwoBlockStack(lower=BOX, upper=BOX, gravity=G)
#: a narrow heavy block with a low centre beside the axis of a wide one, and the other way round
UNEQUAL = TwoBlockStack(
    lower=StackedBlock.homogeneous(width=1.4, height=0.9, mass=1500.0),
    upper=StackedBlock(half_width=0.3, height=1.5, mass=900.0, centroid_height=0.6, inertia=160.0),
    gravity=G,
    offset=0.2,
)
TOP_HEAVY = TwoBlockStack(lower=UNEQUAL.upper, upper=UNEQUAL.lower, gravity=G, offset=-0.1)
STACKS = [EQUAL, UNEQUAL, TOP_HEAVY]


def newton_euler(stack, footing, state, floor):
    """Angular accelerations and forces at the ends of both interfaces, from six equations of motion and constraints."""
    one, two = stack.lower, stack.upper
    foot = footing.base * one.half_width
    end = stack.joint_end(footing.joint or 1)

    def at(q, x, z):
        turn = np.array([[np.cos(q[2]), np.sin(q[2])], [-np.sin(q[2]), np.cos(q[2])]])
        return np.array(q[:2]) + turn @ np.array([x, z])

    def constraints(q):
        low, high = q[:3], q[3:]
        joint = at(high, end - stack.offset, -two.centroid_height)
        rows = [
            *at(low, foot, -one.centroid_height),
            *(joint - at(low, end, one.height - one.centroid_height)),
        ]
        if footing.base == 0:
            rows.append(low[2])
        if footing.joint == 0:
            rows.append(high[2] - low[2])
        return np.array(rows)

    # coordinates and velocities from the constraints themselves
    turn = np.array([[np.cos(state[0]), np.sin(state[0])], [-np.sin(state[0]), np.cos(state[0])]])
    low = [*(np.array([foot, 0.0]) + turn @ [-foot, one.centroid_height]), state[0]]
    head = at(low, end, one.height - one.centroid_height)
    turn = np.array([[np.cos(state[2]), np.sin(state[2])], [-np.sin(state[2]), np.cos(state[2])]])
    q = np.array([*low, *(head + turn @ [stack.offset - end, two.centroid_height]), state[2]])
    h = 1e-3
    unit = np.eye(6) * h
    first = [constraints(q + e) - constraints(q - e) for e in unit]
    second = [constraints(q + 2.0 * e) - constraints(q - 2.0 * e) for e in unit]
    jacobian = ((8.0 * np.array(first) - np.array(second)) / (12.0 * h)).T
    # the velocity with the two rates that meets the constraints
    free = [0, 1, 3, 4]
    spins = np.zeros(6)
    spins[[2, 5]] = state[1], state[3]
    v = spins.copy()
    v[free] = np.linalg.lstsq(jacobian[:, free], -jacobian @ spins, rcond=None)[0]
    assert np.abs(jacobian @ v).max() < 1e-9
    c = [constraints(q + k * h * v) for k in (-2, -1, 0, 1, 2)]
    curvature = (-c[0] + 16.0 * c[1] - 30.0 * c[2] + 16.0 * c[3] - c[4]) / (12.0 * h**2)
    mass = np.diag([one.mass, one.mass, one.inertia, two.mass, two.mass, two.inertia])
    force = np.array([-floor.x, -G - floor.z, 0.0, -floor.x, -G - floor.z, 0.0]) * np.diag(mass)
    size = len(jacobian)
    whole = np.block([[mass, -jacobian.T], [jacobian, np.zeros((size, size))]])
    solved = np.linalg.solve(whole, np.concatenate([force, -curvature]))
    return solved[[2, 5]], solved[6:]


@pytest.mark.parametrize("stack", STACKS)
@pytest.mark.parametrize("base", [0, 1, -1])
@pytest.mark.parametrize("joint", [0, 1, -1])
def test_the_equations_of_every_pattern_are_those_of_newton_and_euler(stack, base, joint):
    lower = 0.11 * base, -0.4 * base
    upper = lower[0] + 0.07 * joint, lower[1] + 0.6 * joint
    state, footing, floor = np.array([*lower, *upper]), Footing(base, joint), Acceleration(2.3, -1.2)
    normal, angular = contact_normals(stack, footing, state, floor)
    expected, reactions = newton_euler(stack, footing, state, floor)
    assert angular == pytest.approx(expected, rel=1e-7, abs=1e-7)
    # normal to the lower block's face; reactions are in the axes of the floor
    on_joint = math.sin(state[0]) * reactions[2] + math.cos(state[0]) * reactions[3]
    assert normal.joint_left + normal.joint_right == pytest.approx(on_joint, rel=1e-6)
    if base:
        on_base = math.sin(state[0]) * reactions[0] + math.cos(state[0]) * reactions[1]
        assert normal.base_left + normal.base_right == pytest.approx(on_base, rel=1e-6)
        unused = normal.base_left if base == 1 else normal.base_right
        assert unused == pytest.approx(0.0, abs=1e-9 * stack.mass * G)
    if joint:
        unused = normal.joint_left if joint == 1 else normal.joint_right
        assert unused == pytest.approx(0.0, abs=1e-9 * stack.mass * G)


@pytest.mark.parametrize("stack", STACKS)
@pytest.mark.parametrize("start", [(0.0, 0.0, 0.1, 0.0), (0.05, 0.0, -0.04, 0.0), (0.04, 0.1, 0.12, 0.3)])
def test_energy_is_kept_between_impacts_and_never_gained_at_them(stack, start):
    motion = simulate_two_blocks(stack, still_floor(), duration=1.0, state=start)
    assert len(motion.impacts) >= 2
    first = energy(stack, motion.footings[0], np.array(start))
    last = first
    for piece in motion.pieces:
        footing = motion.footings[piece.regime]
        times = np.linspace(piece.start, piece.end, 5)
        found = [energy(stack, footing, piece.interpolant(t)) for t in times]
        assert np.ptp(found) < 1e-9 * first
        assert found[0] < last + 1e-9 * first
        last = found[-1]


def test_a_stack_whose_joint_stays_closed_is_one_block():
    whole = RigidBlock.homogeneous(width=1.1, height=4.0)
    floor = sine_floor(amplitude=4.0 / 6.928**2, angular_frequency=6.928)
    one = simulate_rocking(whole, floor, duration=6.0)
    two = simulate_two_blocks(EQUAL, floor, duration=6.0)
    assert two.patterns == (Pattern.AS_ONE,)
    assert two.impacts == pytest.approx([hit.time for hit in one.impacts], abs=1e-9)
    times = np.linspace(0.0, 6.0, 50)
    assert two.at(times)[:, 2] == pytest.approx(one.at(times)[0], abs=1e-9)
