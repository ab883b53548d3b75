"""Terms of the energy ledger for motions whose heat is known in closed form."""

import numpy as np
import pytest
from block_on_floor import contact_of

from contact.stepping.body import make_state
from contact.stepping.ledger import contact_losses, dissipation, spring_energy

CONTACT = contact_of(
    np.array([2e9, 3e9]),
    tangential_stiffness=np.array([1e9, 4e9]),
    relaxation_time=np.full(2, 5e-3),
    mu_static=np.full(2, 0.4),
    mu_kinetic=np.full(2, 0.2),
    force_scale=1e5,
)


def losses(
    points, forces, sticks=((0.0, 0.0), (0.0, 0.0)), slip=(0.0, 0.0), crushed=((0.0, 0.0), (0.0, 0.0))
) -> tuple[float, float, float]:
    old, new = make_state(3, 2, 0), make_state(3, 2, 0)
    for state, *parts in zip((old, new), points, forces, sticks, crushed, strict=True):
        state.point[:], state.force[:], state.stick[:], state.crushed[:] = parts
    return contact_losses(CONTACT, old, new, np.array(slip))


def test_springs_store_half_k_u_squared_where_the_point_is_closed():
    points = np.array([[0.0, -1e-5], [0.0, 2e-5]])
    sticks = np.array([3e-6, 4e-6])  # the second point is open: its stick is forgotten
    assert spring_energy(CONTACT, points, sticks) == pytest.approx(
        0.5 * 2e9 * (1e-5) ** 2 + 0.5 * 1e9 * (3e-6) ** 2, rel=1e-14
    )


def test_a_spring_alone_dissipates_nothing():
    before, after = [[0.0, -1e-5], [0.0, -2e-5]], [[0.0, -3e-5], [0.0, -1e-5]]
    forces = [[[0.0, 2e4], [0.0, 6e4]], [[0.0, 6e4], [0.0, 3e4]]]
    assert losses([before, after], forces) == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_dashpot_at_constant_speed_heats_by_c_v_squared(direction):
    speed, step = direction * 1e-2, 1e-3  # > 0 into the floor
    damping = 2e9 * 5e-3
    depths = np.array([3e-5, 3e-5 + speed * step])
    points = [[[0.0, -depth], [0.0, 1.0]] for depth in depths]
    forces = [[[0.0, 2e9 * depth + damping * speed], [0.0, 0.0]] for depth in depths]
    friction, heat, _ = losses(points, forces)
    assert friction == 0.0
    assert heat == pytest.approx(damping * speed**2 * step, rel=1e-9)


def test_a_stuck_point_heats_its_tangential_dashpot():
    speed, step = 2e-3, 1e-3
    damping = 1e9 * 5e-3
    sticks = np.array([1e-6, 1e-6 + speed * step])
    points = [[[0.0, -1e-5], [0.0, 1.0]]] * 2
    forces = [[[-1e9 * stick - damping * speed, 2e4], [0.0, 0.0]] for stick in sticks]
    friction, heat, _ = losses(points, forces, [[stick, 0.0] for stick in sticks])
    assert friction == 0.0
    assert heat == pytest.approx(damping * speed**2 * step, rel=1e-9)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_sliding_heats_by_kinetic_friction_times_path(direction):
    normal, slip = 5e4, direction * 2e-4
    tangential = -direction * 0.2 * normal
    points = [[[0.0, -normal / 2e9], [0.0, 1.0]]] * 2
    forces = [[[tangential, normal], [0.0, 0.0]]] * 2
    sticks = [[-tangential / 1e9, 0.0]] * 2
    assert losses(points, forces, sticks, (slip, 0.0)) == pytest.approx(
        (0.2 * normal * abs(slip), 0.0, 0.0), abs=1e-9
    )


def test_crushing_takes_the_area_under_force_and_indentation():
    forces = [[[7.0, 0.0], [0.0, 3e5]], [[0.0, 4e5], [-2.0, 3e5]]]
    points = [[[0.0, 1.0], [0.0, 1.0]]] * 2
    found = losses(points, forces, crushed=[[1e-3, 2e-3], [1.5e-3, 2.5e-3]])
    assert found[2] == pytest.approx(2e5 * 5e-4 + 3e5 * 5e-4, rel=1e-12)


def test_every_loss_counts_once_as_dissipation():
    assert dissipation(np.array([1e5, 1.0, 20.0, 300.0, 4000.0, 5e6])) == 4321.0
