"""Links on a body: its points stand where the condensed problem put them, and forces return what was turned."""

import math

import numpy as np
import pytest

from contact.interface.workspace import Workspace, make_workspace
from contact.jit import compiled
from contact.stepping import body as interface
from contact.stepping.body import State, make_state
from contact.stepping.links import LinkedBody, make_lines
from contact.stepping.modal_body import make_modal_body
from contact.stepping.scheme import Scheme, generalised_alpha

MASS, INERTIA, STEP = 1e4, 1.434e4, 1e-3
POINT = np.array([[-0.55, -2.0], [0.55, -2.0], [0.55, -1.5], [-0.55, 1.0], [-0.55, -2.0]])
LINKS = 3
SCHEME = generalised_alpha(0.5)
FLOOR, LIFT = 0.05, 0.01


def make_body() -> LinkedBody:
    draw = np.random.default_rng(3)
    body = make_modal_body(
        mass=MASS,
        inertia=INERTIA,
        gravity=9.81,
        point=POINT,
        rest=(0.0, 2.0),
        shape=draw.normal(size=(len(POINT), 2, 2)) / math.sqrt(MASS),
        frequencies=np.array([700.0, 1300.0]),
        damping_ratios=np.array([0.02, 0.04]),
        tolerance=1e-11,
    )
    place = POINT[-LINKS:] + np.array([0.0, 2.0])
    direction = np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0]])
    return LinkedBody(body=body, line=make_lines(direction, place, np.array([0.1, 0.2, 0.03]), 1.1))


@compiled
def released(
    body: LinkedBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace, place: bool
) -> float:
    """One iteration under `work.force`; with `place`, the points that follow."""
    if place:
        error = interface.respond(body, scheme, step, old, new, work)
        interface.complete(body, new, 0.05, 0.01, 0.0)
        return float(error)
    interface.release(body, scheme, step, old, new, work, interface.Ground(0.05, 0.0, 0.01, 0.0))
    return 0.0


def moving_state(body: LinkedBody) -> State:
    state = make_state(5, len(POINT), 0)
    state.position[:] = 0.02, 2.05, 0.2, 1e-3, -2e-3
    state.velocity[:] = 0.1, -0.2, 0.3, 0.01, 0.02
    return state


def test_points_of_links_stand_where_the_condensed_problem_put_them():
    body = make_body()
    old, new, work = moving_state(body), moving_state(body), make_workspace(len(POINT))
    force = np.random.default_rng(5).normal(size=(len(POINT), 2)) * 1e3
    for _ in range(5):
        released(body, SCHEME, STEP, old, new, work, False)
        work.force[:] = force
        moved = (work.compliance @ force.ravel()).reshape(-1, 2)
        promised = work.free + moved
        new.force[:] = force
        error = released(body, SCHEME, STEP, old, new, work, True)
    assert error <= 1.0
    assert work.force == pytest.approx(force, rel=1e-14)
    assert new.force == pytest.approx(force, rel=1e-14)
    assert new.point == pytest.approx(promised, abs=1e-10)
    assert work.compliance == pytest.approx(work.compliance.T, rel=1e-12)
    # and these are the gaps: along the line from where the point would be stopped
    turn = np.array([[math.cos(new.position[2]), math.sin(new.position[2])]])
    turn = np.vstack([turn, [-turn[0, 1], turn[0, 0]]])
    place = new.position[:2] + (POINT + body.body.shape @ new.position[3:]) @ turn.T - [FLOOR, LIFT]
    assert new.point[2, 1] == pytest.approx(0.55 + 0.1 - place[2, 0], abs=1e-12)
    assert new.point[3, 1] == pytest.approx(0.55 + 0.2 + place[3, 0], abs=1e-12)
    assert new.point[4, 1] == pytest.approx(0.03 - place[4, 1], abs=1e-12)
