"""Stops and ties: restitution, impulse and energy of hits, work balance of straps.

The references are closed forms and a quadrature; none of them steps.
"""

import math

import numba
import numpy as np
import pytest
from runs import SOLID, STACK, Finished, harmonic, pulse, run

from contact.interface.penalty import damping_ratio_of, restitution_of
from contact.stepping.ledger import BASE_WORK, FRICTION, IMBALANCE
from fem.case.case import Case

MASS, WIDTH, MIDDLE = 1e4, 1.1, 2.0
GRAVITY, SPEED = 9.81, 0.5
#: a container that slides without friction toward +x
SLIDER = STACK.with_values(
    {"contact.mu_static": 0.0, "initial.velocity_m_s": SPEED, "solver.duration_s": 0.6}
)
#: held by friction, so that it rocks
HELD = STACK.with_values({"contact.mu_static": 3.0})
STRAP = {"from": "left", "height_m": 0.0, "slack_m": 0.0, "stiffness_N_m": 1e6}


SETTLED = 0.02  #: after a landing, of its springs [s]


@numba.njit(cache=True)
def fall_back(half_width, middle, mass, tilt, floor, mu, wall, step, duration, gravity=9.81):
    """When the other corner of a rigid block at a wall lands [s], and the largest rotation after that [rad].

    Semi-implicit Euler, far below every period, of the springs, dashpots and friction of the program at three points.
    The wall stands where the block touches it as it lies flat, so that corner and top strike at once: no sequence of
    impacts says what follows, only the stiffness of both. At the start the block is at rest on its right corner,
    tilted to the right. Of a point of the floor, and of the smooth wall: stiffness [N/m] and dashpot over spring [s];
    the tangential ones of the floor are as the normal ones.
    """
    inertia = mass * (half_width**2 + middle**2) / 3.0
    px, pz = np.array([-half_width, half_width, -half_width]), np.array([-middle, -middle, middle])
    x = half_width - (half_width * math.cos(tilt) - middle * math.sin(tilt))
    z = middle * math.cos(tilt) + half_width * math.sin(tilt) - mass * gravity / floor[0]
    turn, u, w, spin, stick = tilt, 0.0, 0.0, 0.0, np.zeros(2)
    landed, rebound = math.inf, 0.0
    for k in range(int(duration / step)):
        cosine, sine = math.cos(turn), math.sin(turn)
        force_x, force_z, moment = 0.0, -mass * gravity, 0.0
        for i in range(3):
            rx, rz = cosine * px[i] + sine * pz[i], cosine * pz[i] - sine * px[i]
            vx, vz = u + spin * rz, w - spin * rx
            depth = -(z + rz) if i < 2 else -(x + rx + half_width)
            if depth <= 0.0:
                if i < 2:
                    stick[i] = 0.0
                continue
            if i == 2:
                across, normal = max(wall[0] * (depth - wall[1] * vx), 0.0), 0.0
            else:
                normal, before = max(floor[0] * (depth - floor[1] * vz), 0.0), stick[i]
                stick[i] += step * vx
                across = -floor[0] * (stick[i] + floor[1] * vx)
                if abs(across) > mu * normal:
                    across = math.copysign(mu * normal, across)
                    rest = -across / floor[0]
                    stick[i] = rest + (before - rest) * math.exp(-step / floor[1])
                if i == 0:
                    landed = min(landed, k * step)
            force_x += across
            force_z += normal
            moment += rz * across - rx * normal
        u += step * force_x / mass
        w += step * force_z / mass
        spin += step * moment / inertia
        x += step * u
        z += step * w
        turn += step * spin
        if k * step > landed + SETTLED:
            rebound = max(rebound, turn)
    return landed, rebound


def with_links(case: Case, *, stop: tuple[dict, ...] = (), tie: tuple[dict, ...] = ()) -> Case:
    return case.with_values({"stop": list(stop), "tie": list(tie)})


def velocity_at_end(found: Finished) -> float:
    return float(found.model.run.old.pose[4])


def test_restitution_and_damping_ratio_belong_to_each_other():
    for ratio in (0.01, 0.3, 0.999, 1.0, 1.001, 3.0, 10.0):
        assert damping_ratio_of(restitution_of(ratio)) == pytest.approx(ratio, rel=1e-6)
    step, position, velocity = 1e-5, 0.0, 1.0  # of a mass of 1 on a spring of 1
    while 2.0 * 0.4 * velocity + position >= 0.0:
        velocity -= step * (2.0 * 0.4 * velocity + position)
        position += step * velocity
    assert restitution_of(0.4) == pytest.approx(-velocity, rel=1e-3)


def test_a_plastic_wall_stops_one_sided_rocking_in_its_first_landing():
    tilt = 0.1
    wall = {"side": "left", "height_m": 4.0, "gap_m": 0.0, "stiffness_N_m": 1e8, "damping_ratio": 10.0}
    start = {"initial.rotation_rad": tilt, "solver.duration_s": 3.0}
    found = run(with_links(HELD.with_values(start), stop=(wall,)))
    block = found.block
    angle, p = block.slenderness_angle, block.frequency_parameter
    # half of theta'^2 is p^2 (cos(angle - tilt) - cos(angle - theta)); theta = tilt - u^2 takes the root away
    u = (np.arange(200_000) + 0.5) * math.sqrt(tilt) / 200_000
    fall = np.cos(angle - tilt) - np.cos(angle - tilt + u**2)
    quarter = float(np.mean(2.0 * u / np.sqrt(2.0 * p**2 * fall))) * math.sqrt(tilt)
    assert found.track.first_impact == pytest.approx(quarter, rel=1e-3)
    assert found.model.run.links[0].hits == 1
    landed = found.history["time_s"] > quarter + 0.05
    assert np.abs(found.history["rotation_rad"][landed]).max() < 1e-3 * angle
    free = run(HELD, start)
    assert np.abs(free.history["rotation_rad"][landed]).max() > 0.3 * tilt


@pytest.mark.parametrize("restitution", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("height", [3.0, 4.0])
def test_a_container_that_rocks_into_a_wall_leaves_its_corner_and_is_struck_as_a_free_body(
    height, restitution
):
    gap, inertia = 0.1, MASS * (0.55**2 + MIDDLE**2) / 3.0
    tilt = math.asin(gap / height)
    arm = height * math.cos(tilt) - MIDDLE * math.cos(tilt) - 0.55 * math.sin(tilt)
    mass = 1.0 / (1.0 / MASS + arm**2 / inertia)  # of the point that is struck
    ratio = damping_ratio_of(restitution) * math.sqrt(mass / MASS)
    wall = {"side": "right", "height_m": height, "gap_m": gap, "stiffness_N_m": 1e9, "damping_ratio": ratio}
    keys = {"initial.angular_velocity_rad_s": 0.6, "solver.duration_s": 0.1, "output.history_s": 2e-4}
    found = run(with_links(HELD.with_values(keys), stop=(wall,)))
    history = found.history
    pushed = np.flatnonzero(history["stop_1_force_N"] > 0.0)
    rate = history["angular_velocity_rad_s"][[pushed[0] - 1, pushed[-1] + 1]]
    impulse = (1.0 + restitution) * mass * rate[0] * height * math.cos(tilt)
    assert rate[1] - rate[0] == pytest.approx(-impulse * arm / inertia, rel=2e-3)
    assert history["uplift_m"][pushed[-1] + 1] > 0.0


@pytest.mark.parametrize("restitution", [0.3, 0.6, 0.9])
def test_a_wall_without_a_gap_is_struck_as_the_other_corner_lands_and_returns_what_both_springs_leave(
    restitution,
):
    tilt = 0.1
    wall = {"side": "left", "height_m": 4.0, "gap_m": 0.0, "stiffness_N_m": 1e9, "restitution": restitution}
    start = {"initial.rotation_rad": tilt, "solver.duration_s": 1.5}
    found = run(with_links(HELD.with_values(start), stop=(wall,)))
    contact = found.model.run.problem.contact
    floor, against = zip(contact.normal_stiffness[1:], contact.relaxation_time[1:], strict=True)
    landed, rebound = fall_back(0.55, MIDDLE, MASS, tilt, floor, 3.0, against, 2e-6, 1.5)
    assert found.track.first_impact == pytest.approx(landed, rel=1e-3)
    later = found.history["time_s"] > landed + SETTLED
    assert found.history["rotation_rad"][later].max() == pytest.approx(rebound, rel=0.03)


@pytest.mark.parametrize(("stiffness", "slack"), [(1e5, 0.0), (1e6, 0.0), (1e6, 0.02), (3e6, 0.01)])
def test_a_strap_takes_the_work_of_the_rotation_that_it_stops(stiffness, slack):
    rate = 0.3
    strap = {**STRAP, "stiffness_N_m": stiffness, "slack_m": slack}
    moving = HELD.with_values({"initial.angular_velocity_rad_s": rate, "solver.duration_s": 0.5})
    found = run(with_links(moving, tie=(strap,)))
    block = found.block
    rotation = np.linspace(0.0, 0.1, 1_000_001)
    lifted = np.cos(block.slenderness_angle - rotation) - math.cos(block.slenderness_angle)
    stretch = np.maximum(WIDTH * np.sin(rotation) - slack, 0.0)
    stored = MASS * GRAVITY * block.radius * lifted + 0.5 * stiffness * stretch**2
    kinetic = 0.5 * MASS * GRAVITY * block.radius / block.frequency_parameter**2 * rate**2
    reached = float(rotation[np.searchsorted(stored, kinetic)])
    assert found.track.max_rotation == pytest.approx(reached, rel=1e-3)
    force = stiffness * (WIDTH * math.sin(reached) - slack)
    assert found.model.run.links[0].max_force == pytest.approx(force, rel=5e-3)


def test_a_strap_that_breaks_takes_the_energy_of_its_strength_and_stays_broken():
    strap = {**STRAP, "slack_m": 0.02, "strength_N": 1e4, "stiffness_N_m": 1e6}
    moving = HELD.with_values({"initial.angular_velocity_rad_s": 0.3, "solver.duration_s": 4.0})
    found = run(with_links(moving, tie=(strap,)), {"output.history_s": 1e-3})
    record, history = found.model.run.links[0], found.history
    assert 0.0 < record.broken_at < 0.5
    assert record.max_force == pytest.approx(1e4, rel=1e-9)
    # until the turning point the only other losses are those of the corner's dashpot
    turned = int(np.argmax(history["rotation_rad"]))
    before = np.searchsorted(history["time_s"], record.broken_at) - 1
    taken = history["contact_damping_J"][turned] - history["contact_damping_J"][before]
    assert taken == pytest.approx(0.5 * 1e4**2 / 1e6, rel=0.01)
    broken = history["time_s"] > record.broken_at + 2e-3
    assert not history["tie_1_force_N"][broken].any()
    assert record.hits == 1


def test_a_tie_to_a_wall_holds_what_slides_away_and_returns_its_energy():
    tie = {"from": "left", "to": "wall", "height_m": MIDDLE, "slack_m": 0.1, "stiffness_N_m": 1e6}
    found = run(with_links(SLIDER, tie=(tie,)), {"solver.duration_s": 1.0})
    record = found.model.run.links[0]
    assert record.hits == 1
    assert record.max_force == pytest.approx(SPEED * math.sqrt(MASS * 1e6), rel=1e-3)
    assert found.history["slip_m"].max() == pytest.approx(0.1 + SPEED * math.sqrt(MASS / 1e6), rel=1e-3)
    assert velocity_at_end(found) == pytest.approx(-SPEED, rel=1e-3)
    other = run(with_links(SLIDER, tie=({**tie, "from": "right"},)))
    assert other.model.run.links[0].max_force == 0.0  # toward its wall it is slack
    assert velocity_at_end(other) == pytest.approx(SPEED, rel=1e-9)


def test_wedges_on_both_sides_carry_a_container_along_and_their_work_is_that_of_the_floor():
    wedges = tuple(
        {"side": side, "height_m": MIDDLE, "gap_m": 0.0, "stiffness_N_m": 1e8} for side in ("left", "right")
    )
    still = {"initial.velocity_m_s": 0.0, "solver.duration_s": 4.0, **harmonic(0.1, 6.0)}
    still |= {"motion.start": "rest", "motion.ramp_cycles": 1.0}
    found = run(with_links(SLIDER.with_values(still), stop=wedges))
    reference = found.model.run.problem.control.reference_energy
    assert np.abs(found.history["centre_x_m"]).max() < 3.0 * 0.1 * 36.0 * MASS / 1e8
    assert found.model.run.ledger[FRICTION] == pytest.approx(0.0, abs=1e-9)
    assert abs(found.model.run.ledger[IMBALANCE]) < 1e-3 * reference
    history = found.history
    gained = history["kinetic_J"] + history["contact_damping_J"] - history["base_work_J"]
    assert np.abs(gained).max() < 0.01 * history["kinetic_J"].max()
    assert found.model.run.ledger[BASE_WORK] != 0.0


def test_friction_on_a_face_slows_what_falls_along_it():
    # The floor falls away faster than gravity and pushes with a wall: in its frame the container rises.
    press, drop, mu, time = 5.0, 15.0, 0.4, 0.15
    wall = {"side": "left", "height_m": MIDDLE, "gap_m": 0.0, "stiffness_N_m": 1e8, "mu": mu}
    falling = {key.replace("motion", "vertical"): value for key, value in pulse(-drop, 1.0).items()}
    falling |= pulse(press, 1.0) | {"vertical.delay_s": 0.05, "initial.velocity_m_s": 0.0}
    falling |= {"solver.duration_s": 0.05 + time}
    heights = []
    for one in (mu, 0.0):
        found = run(with_links(SLIDER, stop=({**wall, "mu": one},)), falling)
        heights.append(found.history["centre_z_m"][-1] - MIDDLE)
    assert heights[1] == pytest.approx(0.5 * (drop - GRAVITY) * time**2, rel=0.01)
    assert heights[0] == pytest.approx(0.5 * (drop - GRAVITY - mu * press) * time**2, rel=0.02)


@pytest.mark.parametrize("model", ["reduced", pytest.param("full", marks=pytest.mark.slow)])
def test_stiff_containers_hang_on_a_tie_to_a_wall_as_the_rigid_one_does(model):
    tie = {"from": "left", "to": "wall", "height_m": 3.0, "slack_m": 0.02, "stiffness_N_m": 5e5}
    start = {"initial.angular_velocity_rad_s": 0.4, "solver.duration_s": 0.6}
    stiff = SOLID | {"container.youngs_modulus_Pa": 1e13, "solver.element_size_m": 0.5, "solver.order": 1}
    case = with_links(HELD.with_values(start | stiff), tie=({**tie, "damping_ratio": 0.1},))
    rigid, elastic = (run(case, {"solver.model": one}) for one in ("rigid", model))
    first, other = (found.model.run.links[0] for found in (rigid, elastic))
    assert first.max_force > 2e4
    assert other.max_force == pytest.approx(first.max_force, rel=2e-3)
    assert other.largest_closing_velocity == pytest.approx(first.largest_closing_velocity, rel=2e-3)
    largest = rigid.history["rotation_rad"].max()
    assert elastic.history["rotation_rad"] == pytest.approx(rigid.history["rotation_rad"], abs=0.01 * largest)
