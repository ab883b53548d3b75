"""Long-time motion under a harmonic drive, held against the analytic block, the rigid slider and closed forms."""

import math

import numpy as np
import pytest
from closed_forms import steady_stroke, symmetric_orbit_slender
from floors import sine_floor, still_floor
from runs import STACK

from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from contact.stepping.integrator import REACHED
from fem.model.container import discretise
from fem.model.model import build_model
from fem.response.lasting import coexistences, drop_outs, frequencies_of
from fem.response.orbit import begin_drive, carry_drive, follow_periods, step_to
from fem.response.request import ResponseRequest
from fem.response.run import Task, computed, follow_point, plan_of

GRAVITY = 9.81
#: Housner's restitution is 0.9 at sin^2 al = 1/15: the orbit of Spanos and Koh that benchmarks quote
WIDTH = 4.0 * math.tan(math.asin(math.sqrt(1.0 / 15.0)))
BLOCK = RigidBlock.homogeneous(width=WIDTH, height=4.0)
BODY = {"container.width_m": WIDTH, "container.depth_m": 1.0, "container.density_kg_m3": 2000.0}
DRIVE = {"motion.kind": "harmonic", "motion.amplitude_m": 0.08, "motion.frequency_Hz": 1.0}
CASE = STACK.with_values(BODY | DRIVE | {"contact.mu_static": 3.0})


def request_of(*, first, last, count, settle=30, observe=12, **changes):
    case = CASE.with_values({key.replace("__", "."): value for key, value in changes.items()})
    return ResponseRequest(
        case=case, first_Hz=first, last_Hz=last, count=count, settle=settle, observe=observe
    )


def followed(request):
    """The point of the lowest frequency, from its start."""
    task = Task(way="up", number=0, model=request.case.solver.model)
    return follow_point(request, request.case_at(0), discretise(request.case), task)[0]


def swept(request):
    """The points of both sweeps."""
    container, before, points = discretise(request.case), None, []
    control = build_model(request.case, container).run.problem.control
    for task in plan_of(request):
        found, before = computed(request, container, task, points, before, control)
        points += found
    return points


def started(case, container):
    """The container as the case begins, at its first section."""
    lead, until = begin_drive(case, container)
    assert step_to(lead, until)[0] == REACHED
    return carry_drive(case, container, lead)


def test_the_steady_symmetric_orbit_is_the_analytic_blocks():
    # e = 0.9, Omega = 3 p, A Omega^2 = 3 g al; the slender closed form has a peak of 0.421204 al.
    angle, rate = BLOCK.slenderness_angle, BLOCK.frequency_parameter
    omega, cycle = 3.0 * rate, 2.0 * math.pi / (3.0 * rate)
    amplitude = 3.0 * GRAVITY * angle / omega**2
    orbit = symmetric_orbit_slender(acceleration_ratio=3.0, frequency_ratio=3.0, restitution=0.9)
    assert orbit.post_impact_speed == pytest.approx(1.302075, abs=1e-6)
    speed = orbit.post_impact_speed * angle * rate
    motion = {"motion__amplitude_m": amplitude, "motion__angular_frequency_rad_s": omega}
    start = {"motion__phase_rad": orbit.impact_phase, "initial__angular_velocity_rad_s": speed}
    point = followed(request_of(first=1.0 / cycle, last=1.01 / cycle, count=2, **motion, **start))
    assert (point.row.began, point.row.long_time, point.row.period_n) == ("case", "periodic", 1)
    assert point.row.scatter < 1e-3
    # A symmetric orbit: each half period is the mirror image of the one before.
    assert point.extremes[:, 1] == pytest.approx(-point.extremes[:, 2], rel=1e-3)

    floor = sine_floor(amplitude=amplitude, angular_frequency=omega, phase=orbit.impact_phase)
    turn = ((0.5 * math.pi - orbit.impact_phase) % (2.0 * math.pi)) / omega
    exact = simulate_rocking(BLOCK, floor, duration=45.0 * cycle, angular_velocity=speed)
    rotation, velocity = exact.at(turn + cycle * np.arange(31, 43))
    assert point.sections[:, 0] == pytest.approx(rotation, abs=2e-3 * angle)
    assert point.sections[:, 1] == pytest.approx(velocity, abs=4e-3 * angle * rate)
    peak = max(abs(peak.rotation) for peak in exact.peaks if peak.time > 30.0 * cycle)
    assert point.row.rotation_ratio == pytest.approx(peak / angle, rel=5e-3)


@pytest.mark.parametrize(("friction_ratio", "stroke"), [(0.2, 1.898741), (0.5, 1.237982), (0.7, 0.432494)])
def test_the_steady_slip_is_that_of_a_rigid_slider(friction_ratio, stroke):
    # Equal coefficients; benchmarks quote slip/A at mu g/(A Omega^2) = 0.2, 0.5, 0.7.
    assert steady_stroke(friction_ratio=friction_ratio, static_ratio=1.0) == pytest.approx(stroke, abs=1e-6)
    amplitude = 0.1
    frequency = math.sqrt(0.2 * GRAVITY / (friction_ratio * amplitude)) / (2.0 * math.pi)
    low = {"container__width_m": 4.0, "container__height_m": 1.0}
    friction = {"contact__mu_static": 0.2, "contact__mu_kinetic": 0.2}
    motion = {"motion__amplitude_m": amplitude, "motion__frequency_Hz": frequency}
    ends = {"first": frequency, "last": 1.01 * frequency}
    point = followed(request_of(**ends, count=2, settle=20, **low, **friction, **motion))
    assert (point.row.motion, point.row.long_time, point.row.period_n) == ("slide", "periodic", 1)
    assert point.extremes[:, 4] == pytest.approx(stroke * amplitude, rel=5e-3)
    assert point.sections[:, 3] == pytest.approx(0.0, abs=1e-3 * amplitude)
    assert point.row.stable and point.row.undriven == "dies out"
    # at the floor's turning point the slider is on its way: it goes farthest to one side
    assert 0.5 * stroke * amplitude < point.row.slip_excursion_m <= 1.001 * stroke * amplitude


def test_rest_and_rocking_coexist_below_uplift_and_rest_ends_at_uplift():
    # A Omega^2 = g tan al is where rest ends on the way up; the rocking motion is kept on the way down.
    uplift = math.sqrt(GRAVITY * math.tan(BLOCK.slenderness_angle) / 0.08) / (2.0 * math.pi)
    request = request_of(first=0.85 * uplift, last=1.25 * uplift, count=5)
    points = swept(request)
    up, down = points[:5], points[5:]
    assert [point.row.motion == "rest" for point in up] == [bool(f < uplift) for f in request.frequencies]
    assert all(point.row.motion == "rock" for point in down)
    assert all(point.row.stable for point in points)
    (both,) = coexistences(list(frequencies_of(points)))
    assert (both.from_Hz, both.frequencies) == (pytest.approx(0.85 * uplift), 2)
    assert both.to_Hz < uplift and both.motions == ("rock of period 1", "rest")
    assert list(drop_outs(points)) == []


def test_undriven_rocking_dies_out_when_the_analytic_blocks_does():
    request = request_of(first=1.0, last=1.1, count=2, motion__amplitude_m=0.1)
    point = followed(request)
    rotation, velocity = point.sections[-1, :2]
    start = {"rotation": float(rotation), "angular_velocity": float(velocity)}
    free = simulate_rocking(BLOCK, still_floor(), duration=20.0, **start)
    times = np.arange(0.0, 20.0, 1e-3)
    beyond = np.abs(free.at(times)[0]) > 0.01 * BLOCK.slenderness_angle
    exact = times[beyond][-1]
    # The last small peaks decide, each 1/e^2 times the one before: one more or less of them is 3 per cent.
    assert point.row.undriven == "dies out"
    assert point.row.undriven_s == pytest.approx(exact, rel=0.05)


def test_carrying_a_motion_on_at_the_same_frequency_changes_nothing():
    case = request_of(first=1.0, last=1.1, count=2, motion__amplitude_m=0.1).case
    container = discretise(case)
    _, orbit = follow_periods(started(case, container), 12)
    first, _ = follow_periods(started(case, container), 6)
    _, after = follow_periods(carry_drive(case, container, first), 6)
    assert orbit.status == after.status == "completed"
    assert after.sections[:, :2] == pytest.approx(orbit.sections[6:, :2], abs=1e-4)


@pytest.mark.parametrize("changed", ["motion.amplitude_m", "motion.frequency_Hz"])
def test_a_change_of_the_drive_moves_neither_floor_nor_container(changed):
    case = request_of(first=1.0, last=1.1, count=2, motion__amplitude_m=0.1).case
    container = discretise(case)
    before, _ = follow_periods(started(case, container), 3)
    other = case.with_values({changed: 0.9 * (0.1 if "amp" in changed else 1.0)})
    after = carry_drive(other, container, before)
    assert abs(before.run.floor[0, 1]) < 1e-12 and abs(after.run.floor[0, 1]) < 1e-12
    for name in ("velocity", "force", "stick", "energy"):
        assert np.array_equal(getattr(before.run.old, name), getattr(after.run.old, name)), name
    assert np.allclose(before.run.old.point, after.run.old.point, atol=0.0)
    apart = [driven.run.old.position[0] - driven.run.floor[0, 0] for driven in (before, after)]
    assert apart[0] == pytest.approx(apart[1], abs=1e-15)


def test_sections_are_taken_at_the_very_instants():
    case = request_of(first=1.0, last=1.1, count=2, motion__frequency_Hz=0.7, motion__amplitude_m=0.1).case
    driven, orbit = follow_periods(started(case, discretise(case)), 9)
    assert len(orbit.sections) == 9
    assert float(driven.run.clock.time[0]) == 9 * (2.0 * np.pi / case.motion.angular_frequency)
    assert np.array_equal(orbit.sections[-1, :2], driven.run.old.pose[:2])
