"""Four loose boxes under fifty motions: the stepper against that of `moreau`, which knows no springs and no rebound.

Both see the same motions. A single outcome may hang on an impact; what must agree are the shares of the outcomes and
the distributions. The tolerances come from sampling: a share p of n motions has the standard error sqrt(p (1 - p)/n),
and the distributions of two samples of n differ by up to 1.36 sqrt(2/n) in nineteen of twenty cases (Kolmogorov and
Smirnov). Motions in common make the differences smaller, so half of these is allowed.
"""

import math

import numpy as np
import pytest
from moreau import Boxes, move_boxes
from stack_on_floor import Box, stack_rig

from contact.motion.table import TableMotion
from contact.stepping.integrator import FAILED

pytestmark = pytest.mark.slow
MOTIONS, LENGTH, DURATION = 50, 7.0, 8.0  # -, s, s
FLOOR, JOINT = 0.5, 0.35  # friction
STEP = 1e-3  # of Moreau's scheme [s]
RESOLVED = 2e-3  # what springs and dashpots slip at impacts without being pushed over their limit [m]
SLENDERNESS = math.atan2(1.1, 4.0)


def motions():
    """Twelve sines each, of 0.4 to 2.5 Hz, that swell and fade, with peaks of 4 to 9 m/s2; the seed is fixed."""
    random = np.random.default_rng(17)
    times = np.linspace(0.0, LENGTH, 701)
    envelope = np.minimum(1.0, np.minimum(times, 0.5 * (LENGTH - times)))
    for _ in range(MOTIONS):
        frequency, phase = random.uniform(0.4, 2.5, 12), random.uniform(0.0, 2.0 * np.pi, 12)
        shape = envelope * np.sin(2.0 * np.pi * frequency[:, None] * times + phase[:, None]).sum(axis=0)
        yield times, shape / np.abs(shape).max() * random.uniform(4.0, 9.0)


def by_moreau(times, acceleration):
    """Whether a box fell, largest rotation of a box over the slenderness angle, largest slip of each [m]."""
    middles = STEP * (np.arange(round(DURATION / STEP)) + 0.5)
    boxes = Boxes([1.1] * 4, [1.0] * 4, [2500.0] * 4)
    friction = np.array([FLOOR, JOINT, JOINT, JOINT])
    found = move_boxes(boxes, np.interp(middles, times, acceleration), step=STEP, mu_static=friction)
    return [found.fell_box >= 0, found.max_rotation.max() / SLENDERNESS, *found.max_slip]


def by_the_stepper(times, acceleration):
    """The same; nan where the run failed."""
    motion = TableMotion(times=times, values=acceleration)
    rig = stack_rig([Box()] * 4, motion=motion, mu=FLOOR, joint_mu=JOINT, sampled=0.1)
    if rig.advance(DURATION) == FAILED:
        return [math.nan] * 6
    joints = rig.joints
    fell = bool(np.isfinite(joints.fell_at).any())
    return [fell, joints.max_rotation.max() / SLENDERNESS, *joints.max_slip]


@pytest.fixture(scope="module")
def figures():
    """Of every motion, by Moreau and by the stepper; shape (2, motions, 6)."""
    return np.array([[by(*motion) for motion in motions()] for by in (by_moreau, by_the_stepper)])


def distance(first, second):
    """Kolmogorov and Smirnov's: the largest difference of two distributions."""
    values = np.concatenate([first, second])
    shares = [(one[None, :] <= values[:, None]).mean(axis=1) for one in (first, second)]
    return np.abs(shares[0] - shares[1]).max()


def test_as_many_stacks_fall_and_none_fails(figures):
    assert np.isfinite(figures).all()
    share, of_stepper = figures[:, :, 0].mean(axis=1)
    assert 0.1 < share < 0.5  # motions that decide nothing would show nothing
    assert abs(of_stepper - share) <= 0.5 * math.sqrt(share * (1.0 - share) / MOTIONS)


@pytest.mark.parametrize("figure", [1, 3, 4, 5], ids=["rotation", "slip 2", "slip 3", "slip 4"])
def test_rotations_and_slips_of_those_that_stand_are_distributed_alike(figures, figure):
    standing = (figures[:, :, 0] == 0.0).all(axis=0)
    first, second = figures[:, standing, figure]
    if figure > 1:
        first, second = np.maximum(first, RESOLVED), np.maximum(second, RESOLVED)
    assert distance(first, second) <= 0.5 * 1.36 * math.sqrt(2.0 / standing.sum())
    # and motion by motion: what differs is small beside what the motions do
    assert np.corrcoef(first, second)[0, 1] > 0.9


def test_on_the_rougher_floor_nothing_slides_that_stands(figures):
    standing = (figures[:, :, 0] == 0.0).all(axis=0)
    assert figures[:, standing, 2].max() < 0.01  # a few millimetres, of tens of impacts
