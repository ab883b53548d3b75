"""The restitution asked of the impacts: a factor on the angular momentum about the corner that lands, and its energy.

By hand: a block that leaves the floor with the energy E meets it with E, an impact leaves (r e)^2 E, e Housner's, and r
has taken (1 - r^2) e^2 E of that. In motion: the event-driven block of `contact.reference.rocking`.
Then the block on springs that the restitution of a flat base is compared with, by limits known without it.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_on_floor import Block, Rig, rig
from block_on_springs import evenly_spaced, next_turning_point
from closed_forms import peak_after_impacts
from runs import BLOCK, STACK, pulse, run, stack
from stack_on_floor import Box, stack_rig

from contact.motion.base_motion import PulseMotion
from contact.motion.kernel import UNIFORM, as_floor_motion
from contact.stepping.body import ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, VELOCITY_X, VELOCITY_Z
from contact.stepping.ledger import BASE_WORK, FRICTION, IMBALANCE, IMPACTS
from contact.stepping.outcome import advance_compiled
from fem.case.case import CaseError
from fem.model.model import build_model

HELD = Block(mu_static=3.0, mu_kinetic=3.0)
RISE = 0.35  #: angular velocity with which a block leaves the floor: to 0.4 of its slenderness angle [rad/s]


def leaving(block: Block, rate: float = RISE, **options) -> Rig:
    """A block that turns about the right corner (> 0) or the left one, upright at t = 0."""
    return rig(block, stance=block.standing().turning(rate, block.point), **options)


def energy_of(block: Block, rate: float = RISE) -> float:
    """Of a rotation about a corner [J]."""
    return 0.5 * (block.inertia + block.mass * block.rigid.radius**2) * rate**2


@pytest.mark.parametrize("share", [0.8, 0.95, 1.05])
def test_every_impact_loses_its_share_of_the_energy_of_rocking(share):
    block = replace(HELD, impact_share=share)
    moving, left = leaving(block), (share * block.rigid.housner_restitution) ** 2
    for impacts in (1, 2, 3):
        while moving.track.impacts < impacts or moving.run.joints.landed[0] != 0:
            assert moving.time < 60.0, "no impact"
            moving.advance(moving.time + 0.01)
        lost = sum((1.0 / share**2 - 1.0) * left**k for k in range(1, impacts + 1)) * energy_of(block)
        assert moving.run.ledger[IMPACTS] == pytest.approx(lost, rel=5e-3)
    assert abs(moving.run.ledger[IMBALANCE]) <= 2e-3 * energy_of(block)


@pytest.mark.parametrize("damping_ratio", [0.05, 0.3, 2.0])
def test_corners_that_bounce_lose_it_once_for_each_landing(damping_ratio):
    block = replace(HELD, damping_ratio=damping_ratio)
    own, asked = (
        leaving(replace(block, impact_share=share)).advance(2.0).track.restitution for share in (1.0, 0.9)
    )
    # not exactly: gravity has more or less time to act while the block bounces
    assert asked / own == pytest.approx(0.9, abs=3e-3 if damping_ratio >= 0.3 else 0.02)


def test_a_corner_that_chatters_or_a_block_that_comes_to_lie_loses_nothing():
    squat = replace(HELD, width=1.5, height=1.0, mass=2500.0, impact_share=0.8)
    assert squat.rigid.housner_restitution < 0.0
    later = PulseMotion(shape="sine", acceleration=20.0, pulse=0.3, delay=1.0)
    moving = leaving(squat, 0.5, motion=later).advance(1.0)
    assert moving.track.impacts > 0
    moving.advance(1.1)
    assert moving.track.max_uplift > 0.0
    assert moving.run.ledger[IMPACTS] == 0.0
    dropped = replace(HELD.standing(), centre=(0.0, 2.02), force=np.zeros((2, 2)))
    block = replace(HELD, damping_ratio=0.02, impact_share=0.8)
    assert rig(block, stance=dropped).advance(1.0).run.ledger[IMPACTS] == 0.0


def test_a_floor_that_carries_the_block_along_changes_the_work_but_not_the_loss():
    block = replace(HELD, impact_share=0.9)
    at_rest = leaving(block).advance(2.0)
    carried = leaving(block, motion=as_floor_motion(UNIFORM, (0.0, 0.0, 3.0))).advance(2.0)
    assert carried.rotation == pytest.approx(at_rest.rotation, abs=3e-5)
    assert carried.run.ledger[IMPACTS] == pytest.approx(at_rest.run.ledger[IMPACTS], rel=1e-3)
    # the floor gives what the momentum along x gains: of the frame, not of the block
    momentum = block.mass * (carried.run.old.pose[VELOCITY_X] - 3.0 - RISE * 2.0)
    assert carried.run.ledger[BASE_WORK] == pytest.approx(3.0 * momentum, rel=1e-3)
    assert abs(carried.run.ledger[IMBALANCE]) <= 2e-3 * energy_of(block)


def test_neither_slip_nor_vibration_is_changed():
    # The same steps with and without it, up to the exchange: then the velocities differ by a turn about the corner that
    # has landed.
    shape = np.zeros((2, 2, 1))
    shape[:, 1, 0] = 1e-3
    elastic = {"shape": shape, "frequencies": np.array([300.0]), "damping_ratios": np.array([0.02])}
    block = replace(Block(), mu_static=0.05, mu_kinetic=0.05)
    plain, asked = (leaving(replace(block, impact_share=share), **elastic) for share in (1.0, 0.9))
    while asked.run.ledger[IMPACTS] == 0.0:
        assert asked.clock.steps + asked.clock.rejected < 100_000, "no impact"
        for one in (plain, asked):
            one.clock.attempt_limit = one.clock.steps + one.clock.rejected + 1
            advance_compiled(one.body, one.run, math.inf)
    assert plain.time == asked.time
    assert plain.run.ledger[FRICTION] > 0.0
    before, after = plain.run.old, asked.run.old
    lost = before.pose - after.pose
    turn = lost[ANGULAR_VELOCITY]
    corner = before.point[0]  # it turned back onto the left corner
    arm = before.pose[[CENTRE_X, CENTRE_Z]] - corner
    assert lost[[VELOCITY_X, VELOCITY_Z]] == pytest.approx([turn * arm[1], -turn * arm[0]], rel=1e-9)
    assert after.velocity[3] == before.velocity[3] != 0.0
    assert after.drift[0, 0] == pytest.approx(before.drift[0, 0], abs=1e-12)
    inertia = block.inertia + block.mass * arm @ arm
    spun = block.inertia * before.pose[ANGULAR_VELOCITY] + block.mass * (
        arm[1] * before.pose[VELOCITY_X] - arm[0] * before.pose[VELOCITY_Z]
    )
    assert turn == pytest.approx(0.1 * spun / inertia, rel=1e-9)
    assert asked.run.ledger[IMPACTS] == pytest.approx(0.19 * spun**2 / (2.0 * inertia), rel=1e-9)
    assert before.energy.sum() - after.energy.sum() == pytest.approx(asked.run.ledger[IMPACTS], rel=1e-9)


@pytest.mark.parametrize("section", ["shell", "solid"])
@pytest.mark.parametrize("kind", ["corners", "feet", "flat"])
def test_elastic_containers_keep_the_same_share_of_what_their_impact_leaves(section, kind):
    models = ["reduced", "full"] if (kind, section) == ("corners", "solid") else ["reduced"]
    for model in models:
        own, asked = (
            run(stack(section, support__kind=kind, solver__model=model, **more)).restitution
            for more in ({}, {"contact__restitution_over_housner": 0.95})
        )
        assert asked / own == pytest.approx(0.95, abs=4e-3)


def test_loose_boxes_that_rock_as_one_lose_as_the_bolted_stack():
    motion = PulseMotion(shape="sine", acceleration=3.8, pulse=1.0)
    boxes = stack_rig([Box()] * 4, motion=motion, mu=3.0, joint_mu=3.0)
    boxes.joints["impact_share"] = 0.9
    whole = rig(replace(boxes.whole, impact_share=0.9), motion=motion).advance(3.0)
    boxes.advance(3.0)
    assert boxes.run.ledger[IMPACTS] == pytest.approx(whole.run.ledger[IMPACTS], rel=0.05)
    difference = boxes.columns[:600, 0] - whole.rotation[:600]
    assert np.abs(difference).max() <= 5e-3 * whole.block.slenderness_angle
    assert abs(boxes.run.ledger[IMBALANCE]) <= 1e-2 * boxes.run.ledger[IMPACTS]


def test_a_box_that_rocks_on_one_that_stands_loses_as_on_the_floor():
    motion, largest = PulseMotion(shape="sine", acceleration=3.8, pulse=1.0), []
    for share in (0.9, 1.05):
        wide, high = Box(width=4.0, mass=1e5), Box(height=4.0, mass=1e4)
        boxes = stack_rig([wide, high], motion=motion, mu=3.0, joint_mu=3.0)
        boxes.joints["impact_share"] = share
        boxes.advance(3.0)
        alone = rig(replace(HELD, impact_share=share), motion=motion).advance(3.0)
        assert boxes.run.ledger[IMPACTS] == pytest.approx(alone.run.ledger[IMPACTS], rel=5e-3)
        rotation, angle = boxes.box(1, 0), alone.block.slenderness_angle
        # the wide box gives way: 1.1 % without the share
        assert np.abs(rotation[:600] - alone.rotation[:600]).max() <= 0.02 * angle
        assert abs(boxes.run.ledger[IMBALANCE]) <= 1e-2 * abs(boxes.run.ledger[IMPACTS]) + 10.0
        largest.append(np.abs(rotation).max())
    assert largest[0] < 0.8 * largest[1]


def test_boxes_that_land_on_boxes_that_rock_lose_nothing_there():
    boxes = stack_rig([Box()] * 4, motion=PulseMotion(shape="sine", acceleration=6.0, pulse=0.5), mu=3.0)
    boxes.joints["impact_share"][1:] = 0.9
    boxes.advance(3.0)
    assert boxes.joints.max_opening[1] > 5e-3
    assert boxes.run.ledger[IMPACTS] == 0.0


@pytest.mark.parametrize("side", ["right", "left"])
def test_every_container_of_a_row_loses_as_it_does_alone(side):
    held = {"contact.mu_static": 3.0, "contact.restitution_over_housner": 0.9, "solver.duration_s": 3.0}
    larger = {"side": side, "gap_m": 3.0, "stiffness_N_m": 1e8}
    larger |= {"width_m": 1.3, "height_m": 5.0, "mass_kg": 2e4}
    case = STACK.with_values({"neighbour": [larger], **held, **pulse(3.8, 1.0, "sine")})
    row, alone = run(case), [run(one) for one in case.row]
    lost = [one.model.run.ledger[IMPACTS] for one in alone]
    assert min(lost) > 1e3
    assert row.model.run.ledger[IMPACTS] == pytest.approx(sum(lost), rel=1e-3)
    for name, one in zip(("rotation_rad", "neighbour_1_rotation_rad"), alone, strict=True):
        assert row.history[name] == pytest.approx(
            one.history["rotation_rad"], abs=5e-3 * one.block.slenderness_angle
        )


def test_impacts_that_would_leave_more_than_there_was_are_refused_with_the_most():
    keys = {"contact.restitution_over_housner": 1.2}
    with pytest.raises(CaseError, match="more than there was") as error:
        build_model(STACK.with_values(keys))
    most = 1.0 / BLOCK.housner_restitution
    assert float(str(error.value).rsplit(" ", 1)[1]) == pytest.approx(most, rel=1e-3)


CORNERS = np.array([-0.55, 0.55])
RELEASED = 0.5 * BLOCK.slenderness_angle


def turned(places, *, side=1.0):
    return next_turning_point(
        BLOCK, places=places, stiffness=5e6, relaxation_time=7e-3, rotation=side * RELEASED, duration=2.0
    )


def test_on_two_stiff_corners_the_block_on_springs_is_housners():
    exact = peak_after_impacts(BLOCK, RELEASED, 1, BLOCK.housner_restitution)
    assert turned(CORNERS) == pytest.approx(exact, rel=5e-3)


def test_on_a_bed_of_springs_a_block_keeps_more_and_knows_no_side():
    bed = turned(evenly_spaced(1.1, 45))
    assert 1.1 * turned(CORNERS) < bed < RELEASED
    assert turned(evenly_spaced(1.1, 45), side=-1.0) == pytest.approx(bed, rel=1e-3)
