"""Initial stances: equilibrium on unilateral springs, and the corner that does not accelerate."""

import math

import numpy as np
import pytest

from contact.interface.equilibrium import SettlingError, Stance, standing, tilted
from contact.stepping.body import make_state
from contact.stepping.modal_body import make_modal_body, place, start

MASS, GRAVITY = 1e4, 9.81
WEIGHT = MASS * GRAVITY
WIDTH, HEIGHT = 1.1, 4.0
INERTIA = MASS * (WIDTH**2 + HEIGHT**2) / 12.0
SLENDERNESS = math.atan2(WIDTH, HEIGHT)
STIFFNESS = 2.7e9
RIGID = np.zeros((4, 4))


def base(points: int, centroid_x: float = 0.0) -> np.ndarray:
    """Base points relative to the mass centre."""
    x = np.linspace(-0.5, 0.5, points) * WIDTH - centroid_x
    return np.column_stack([x, np.full(points, -0.5 * HEIGHT)])


def random_compliance(points: int, scale: float = 0.3 / STIFFNESS) -> np.ndarray:
    local = np.random.default_rng(points).normal(size=(2 * points, 2 * points))
    return scale / points * local @ local.T


def settle(
    points: int, centroid_x: float = 0.0, compliance: np.ndarray | None = None, camber: float = 0.0
) -> tuple[Stance, np.ndarray]:
    """The stance, and the gaps of its points: rigid pose and elastic yielding, small rotation."""
    point = base(points, centroid_x)
    flexible = np.zeros((2 * points, 2 * points)) if compliance is None else compliance
    heights = camber * (2.0 * point[:, 0] / WIDTH) ** 2
    stance = standing(
        weight=WEIGHT,
        centroid=(centroid_x, 0.5 * HEIGHT),
        point=point,
        compliance=flexible,
        normal_stiffness=np.full(points, STIFFNESS),
        camber=heights,
    )
    yielding = flexible[1::2, 1::2] @ stance.force[:, 1]
    return stance, stance.centre[1] + point[:, 1] + heights - stance.rotation * point[:, 0] + yielding


@pytest.mark.parametrize("elastic", [False, True])
@pytest.mark.parametrize("centroid_x", [0.0, 0.1, -0.45])
@pytest.mark.parametrize("points", [2, 3, 7, 23])
def test_a_settled_container_is_in_equilibrium_on_springs_that_do_not_pull(points, centroid_x, elastic):
    stance, gap = settle(points, centroid_x, random_compliance(points) if elastic else None)
    tangential, normal = stance.force.T
    assert normal.sum() == pytest.approx(WEIGHT, rel=1e-12)
    assert normal @ base(points, centroid_x)[:, 0] == pytest.approx(0.0, abs=1e-12 * WEIGHT)
    assert not tangential.any()
    assert normal == pytest.approx(STIFFNESS * np.maximum(0.0, -gap), abs=1e-9 * WEIGHT)
    assert stance.velocity == (0.0, 0.0)
    assert stance.angular_velocity == 0.0


@pytest.mark.parametrize("elastic", [False, True])
@pytest.mark.parametrize("points", [12, 13, 25, 76])
def test_a_cambered_base_of_any_height_comes_to_rest(points, elastic):
    # Its points change between carrying and open in a cycle of four for one height in a hundred, if all do at once.
    compliance = random_compliance(points) if elastic else None
    for height in np.geomspace(1e-5, 5e-3, 150):
        stance, gap = settle(points, 0.0, compliance, height)
        normal = stance.force[:, 1]
        assert normal.min() >= 0.0 and normal.sum() == pytest.approx(WEIGHT, rel=1e-9)
        assert normal @ base(points)[:, 0] == pytest.approx(0.0, abs=1e-8 * WEIGHT * WIDTH)
        assert np.abs(normal - STIFFNESS * np.maximum(-gap, 0.0)).max() < 1e-6 * WEIGHT


def test_a_mass_centre_outside_the_base_finds_no_rest():
    with pytest.raises(SettlingError, match="acts outside"):
        settle(5, 0.56)


def lean(rotation: float, rate: float = 0.0, mu: float = 10.0, compliance: np.ndarray = RIGID) -> Stance:
    return tilted(
        rotation=rotation,
        angular_velocity=rate,
        mass=MASS,
        inertia=INERTIA,
        gravity=GRAVITY,
        point=base(2),
        corner_x=math.copysign(0.5 * WIDTH, rotation),
        compliance=compliance,
        normal_stiffness=np.full(2, STIFFNESS),
        camber=np.zeros(2),
        mu_static=mu,
    )


def started(stance: Stance):
    """The rigid body put into that stance, with its acceleration."""
    body = make_modal_body(mass=MASS, inertia=INERTIA, gravity=GRAVITY, point=base(2), tolerance=1e-9)
    state = make_state(3, 2, 0)
    state.force[:] = stance.force
    place(body, state, stance)
    start(body, state, 0.0, 0.0, 0.0)
    return state


@pytest.mark.parametrize("share", [0.5, -0.5, 0.01, 0.95, 1.0, -1.3])
@pytest.mark.parametrize("rate", [0.0, 0.4, -0.6])
def test_the_corner_of_a_tilted_container_does_not_accelerate(share, rate):
    rotation = share * SLENDERNESS
    corner = 1 if rotation > 0.0 else 0
    state = started(lean(rotation, rate))
    arm = state.point[corner] - state.position[:2]
    # rotation > 0 turns the arm clockwise: a point moves with the centre and by rate (arm_z, -arm_x)
    velocity = state.velocity[:2] + rate * np.array([arm[1], -arm[0]])
    acceleration = (
        state.acceleration[:2] + state.acceleration[2] * np.array([arm[1], -arm[0]]) - rate**2 * arm
    )
    assert velocity == pytest.approx([0.0, 0.0], abs=1e-12)
    assert acceleration == pytest.approx([0.0, 0.0], abs=1e-10)
    # Housner: theta'' = -p^2 sin(alpha - |theta|) sign(theta), p^2 = m g R/I_O, about the fixed corner.
    radius = 0.5 * math.hypot(WIDTH, HEIGHT)
    squared = MASS * GRAVITY * radius / (INERTIA + MASS * radius**2)
    expected = -squared * math.sin(SLENDERNESS - abs(rotation)) * math.copysign(1.0, rotation)
    assert state.acceleration[2] == pytest.approx(expected, abs=1e-10)


def test_friction_bounds_what_the_tilted_corner_may_be_asked_for():
    free = lean(0.5 * SLENDERNESS).force[1]
    asked = abs(free[0]) / free[1]
    bounded = lean(0.5 * SLENDERNESS, mu=0.5 * asked).force[1]
    assert bounded[0] == pytest.approx(0.5 * asked * bounded[1] * math.copysign(1.0, free[0]), rel=1e-12)


def test_a_corner_that_would_have_to_pull_is_refused():
    # The centripetal force of the centre over the corner exceeds the weight: about sqrt(g/R) = 2.2 rad/s.
    with pytest.raises(SettlingError, match="would have to pull"):
        lean(0.5 * SLENDERNESS, rate=4.0)


@pytest.mark.parametrize(("rate", "corner"), [(0.7, 1), (-0.7, 0)])
def test_a_container_set_turning_turns_about_the_corner_it_turns_toward(rate, corner):
    stance, _ = settle(2)
    state = started(stance.turning(rate, base(2)))
    arm = base(2)[corner]
    assert state.velocity[:2] + rate * np.array([arm[1], -arm[0]]) == pytest.approx([0.0, 0.0], abs=1e-15)
    other = base(2)[1 - corner]
    assert (state.velocity[:2] + rate * np.array([other[1], -other[0]]))[1] > 0.0  # the other side lifts
    assert state.velocity[2] == rate


def test_a_strained_corner_stands_as_deep_as_its_force_asks():
    # The elastic corner gives way under its force; the centre is lowered by as much, so that it does not hover.
    soft = np.diag([1e-9, 2e-9, 1e-9, 2e-9])
    stance = lean(0.1, compliance=soft)
    turn = np.array([[math.cos(0.1), math.sin(0.1)], [-math.sin(0.1), math.cos(0.1)]])
    strained = base(2)[1] + soft[2:, 2:] @ (stance.force[1] @ turn)
    corner = np.asarray(stance.centre) + turn @ strained
    assert corner == pytest.approx([0.5 * WIDTH, -stance.force[1, 1] / STIFFNESS], abs=1e-15)
