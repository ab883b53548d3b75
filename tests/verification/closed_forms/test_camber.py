"""Containers on a cambered base, against closed forms and an independent rigid block that rolls on an arc.

The block is integrated here from Lagrange's equation of one coordinate, with nothing of the program: the height of its
mass centre is that of a body that touches at x = R sin theta, and it rolls without slip.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fem
from contact.interface.equilibrium import ROUNDING_OF_CAMBER, pressed
from contact.reference.rigid_block import RigidBlock
from fem.case.case import Case, CaseError
from fem.model.model import Model, build_model

MASS, WIDTH, HEIGHT, GRAVITY = 1e4, 1.1, 4.0, 9.81
BLOCK = RigidBlock.homogeneous(width=WIDTH, height=HEIGHT, gravity=GRAVITY)
EDGE = 0.5 * WIDTH


def cambered_moment(block: RigidBlock, rotation: float, camber: float, inner: float = 0.0) -> float:
    """Restoring moment of a block on a cambered base over its weight, under slow rotation [m].

    M/W = x cos theta - z_c sin theta about the place x that touches, where the slope of the base, 2 d x/b^2, is that of
    the floor: x = b^2 sin theta/(2 d), at most b. On feet x is at least that of their inner ends, `inner`. Geometry:
    the base is raised by d (x/b)^2 from the level, d the `camber`, normal to the floor.
    """
    place = 0.5 * block.half_width**2 * math.sin(rotation) / camber
    place = min(max(place, inner), block.half_width)
    return place * math.cos(rotation) - block.centroid_height * math.sin(rotation)


def cambered_frequency(block: RigidBlock, camber: float) -> float:
    """Angular frequency of small rocking on a base that is cambered from edge to edge [rad/s].

    I theta'' + M g (R - z_c) theta = 0, R = b^2/(2 d) the radius of the base, I = I_c + M z_c^2 about the place that
    touches, I_c = I_O - M (b^2 + z_c^2).
    """
    radius = 0.5 * block.half_width**2 / camber
    about_corner = block.gravity * block.radius / block.frequency_parameter**2  # I_O/M
    inertia = about_corner - block.half_width**2
    return math.sqrt(block.gravity * (radius - block.centroid_height) / inertia)


def cambered(camber: float, *more: str) -> Case:
    """The solid stack of `free_rocking`, rigid unless said, from rest."""
    return fem.load_case("free_rocking", ["solver.model=rigid", f"support.camber_m={camber}", *more])


def rolled(camber: float, damping_ratio: float, start: float, until: float, floor=lambda t: 0.0):
    """Times [s] and rotations of the independent block under an acceleration of the floor [m/s2]."""
    radius, z = EDGE**2 / (2.0 * camber), 0.5 * HEIGHT
    # lead time of the resultant, from the damping ratio of small rocking
    lead = 2.0 * damping_ratio * (radius - z) / (radius * cambered_frequency(BLOCK, camber))

    def touch(rotation: float) -> float:
        return min(max(radius * rotation, -EDGE), EDGE)

    def rates(t, state):
        theta, rate = state
        sine, cosine = math.sin(theta), math.cos(theta)
        x, moves = touch(sine), radius * cosine if abs(radius * sine) < EDGE else 0.0
        inertia = MASS * ((WIDTH**2 + HEIGHT**2) / 12.0 + x * x + z * z)
        rise = x * cosine - z * sine  # of the mass centre, over the rotation
        bend = moves * cosine - x * sine - z * cosine
        ahead = touch(theta + lead * rate) - touch(theta)
        moment = -MASS * floor(t) * (x * sine + z * cosine) - MASS * x * moves * rate**2
        moment -= MASS * GRAVITY * rise + MASS * (GRAVITY + rate**2 * bend) * ahead
        return [rate, moment / (inertia + MASS * rise * ahead)]

    times = np.linspace(0.0, until, 2001)
    found = solve_ivp(rates, (0.0, until), [start, 0.0], rtol=1e-9, atol=1e-11, max_step=1e-3, t_eval=times)
    return times, found.y[0]


def moments(model: Model, rotations) -> np.ndarray:
    """Restoring moments over weight and half width, of a rigid container pressed down at these rotations."""
    contact, mesh = model.run.problem.contact, model.container.mesh
    n = model.container.support.index.size
    x, z = model.container.elements.nodes[model.container.nodes[:n], 0], mesh.centroid[1]
    weight, found = mesh.mass * GRAVITY, []
    for theta in rotations:
        sine, cosine = math.sin(theta), math.cos(theta)
        height = contact.camber[:n] - sine * x - cosine * z
        normal, _ = pressed(
            weight,
            height,
            np.zeros((n, n)),
            contact.normal_stiffness[:n],
            rounding=ROUNDING_OF_CAMBER,
            refusal="",
        )
        found.append(float(normal @ (cosine * x - sine * z)) / (weight * EDGE))
    return np.array(found)


@pytest.mark.parametrize("camber", [0.0005, 0.008, 0.02])
@pytest.mark.parametrize(
    "more",
    [(), ("support.kind=flat", "container.wall_m=0.008", "container.section=shell"), ("solver.order=1",)],
)
def test_the_moment_of_a_cambered_base_rises_as_its_closed_form(camber, more):
    rotations = np.linspace(1e-4, 3.0 * camber / EDGE, 101)
    exact = np.array([cambered_moment(BLOCK, theta, camber) for theta in rotations]) / EDGE
    assert exact[0] < 0.2 and exact.max() > 0.7  # uplift is gradual
    np.testing.assert_allclose(moments(build_model(cambered(camber, *more)), rotations), exact, atol=2e-5)


def test_cambered_feet_roll_from_their_inner_to_their_outer_ends():
    foot, camber = 0.15, 0.008
    rotations = np.linspace(1e-3, 3.0 * camber / EDGE, 101)
    exact = np.array([cambered_moment(BLOCK, theta, camber, EDGE - foot) for theta in rotations]) / EDGE
    model = build_model(cambered(camber, "support.kind=feet", f"support.foot_m={foot}"))
    np.testing.assert_allclose(moments(model, rotations), exact, atol=2e-5)


@pytest.mark.parametrize("model", ["rigid", "reduced", pytest.param("full", marks=pytest.mark.slow)])
def test_small_rocking_has_period_and_damping_as_given(model):
    camber, ratio, start = 0.008, 0.05, 0.003
    damped = (f"support.rocking_damping_ratio={ratio}", f"initial.rotation_rad={start}")
    solver = (f"solver.model={model}", "solver.duration_s=1.5", "solver.element_size_m=0.275")
    case = cambered(camber, *damped, *solver)
    run = fem.compute(case, band=False, margin=False)
    time, rotation = np.array(run.history["time_s"]), np.array(run.history["rotation_rad"])
    half = math.pi / (cambered_frequency(BLOCK, camber) * math.sqrt(1.0 - ratio**2))
    turning = [np.abs(rotation[np.abs(time - k * half) < 0.2 * half]).max() for k in (1, 2)]
    at = np.flatnonzero(np.diff(np.sign(rotation)))
    rate = (rotation[at + 1] - rotation[at]) / (time[at + 1] - time[at])
    assert np.diff(time[at] - rotation[at] / rate) == pytest.approx(half, rel=1.5e-3)
    decay = math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio**2))
    assert turning == pytest.approx([start * decay, start * decay**2], rel=0.01)


def test_a_base_that_rolls_without_damping_loses_nothing():
    case = cambered(0.008, "support.rocking_damping_ratio=0", "solver.duration_s=6")
    run = fem.compute(case, band=False, margin=False)
    rotation, start = np.array(run.history["rotation_rad"]), 0.5 * BLOCK.slenderness_angle
    assert np.abs(rotation[-300:]).max() > 0.999 * start  # after four half swings; sharp corners: 0.34
    assert run.verdict.impacts == 0 and run.verdict.restitution_first is None


@pytest.mark.parametrize(
    ("camber", "ratio", "peak", "pulse"),
    [(0.02, 0.1, 3.0, 0.8), (0.008, 0.05, 3.0, 1.0), (0.002, 0.02, 3.2, 0.9)],
)
def test_a_pulse_rolls_the_container_as_the_independent_block(camber, ratio, peak, pulse):
    case = cambered(
        camber,
        f"support.rocking_damping_ratio={ratio}",
        *("initial.rotation_rad=0", "motion.kind=pulse", "motion.shape=sine", "solver.duration_s=4"),
        *(f"motion.pulse_s={pulse}", f"motion.peak_acceleration_m_s2={peak}"),
    )
    run = fem.compute(case, band=False, margin=False)

    def floor(t: float) -> float:
        return peak * math.sin(2.0 * math.pi * t / pulse) if t < pulse else 0.0

    times, exact = rolled(camber, ratio, 0.0, 4.0, floor)
    found = np.interp(times, run.history["time_s"], run.history["rotation_rad"])
    assert np.abs(found).max() == pytest.approx(np.abs(exact).max(), rel=0.01)
    assert run.result["energy"]["closure_error"] < 3e-3


LOSS, FEET = "contact.restitution_over_housner=0.95", ("support.kind=feet", "support.foot_m=0.15")


@pytest.mark.parametrize(
    ("camber", "more", "says"),
    [
        (0.08, (), r"camber_m = 0.08 m: the base is an arc of 1.89 m under a mass centre at 2 m"),
        (0.008, (LOSS,), "a cambered base rolls"),
        (0.008, (*FEET, LOSS), "a cambered base rolls"),
        (0.008, ("solver.order=1", "solver.element_size_m=1.1"), "of 2 points does not roll"),
    ],
)
def test_what_makes_no_sense_on_a_cambered_base_is_refused(camber, more, says):
    with pytest.raises(CaseError, match=says):
        build_model(cambered(camber, "initial.rotation_rad=0", *more))
