"""Points, shapes and springs of stops and ties on the containers of cases."""

import numpy as np
import pytest
from runs import SOLID, STACK

from contact.stepping.links import LinkedBody
from fem.model.links import side_points
from fem.model.model import build_model

STOPS = [
    {"side": "right", "height_m": 0.13, "gap_m": 0.02, "stiffness_N_m": 1e8},
    {"side": "left", "height_m": 3.97, "gap_m": 0.03, "stiffness_N_m": 1e8},
]
TIE = {"from": "left", "height_m": 0.0, "slack_m": 0.01, "stiffness_N_m": 1e6, "strength_N": 5e4}
HELD = STACK.with_values({**SOLID, "solver.element_size_m": 0.5, "stop": STOPS, "tie": [TIE]})


@pytest.mark.parametrize("model", ["rigid", "reduced", "full"])
def test_at_rest_every_link_has_its_gap_left(model):
    state = build_model(HELD.with_values({"solver.model": model})).run.old
    assert state.point[-3:, 1] == pytest.approx([0.02, 0.03, 0.01], abs=1e-12)
    assert not state.force[-3:].any()


def test_a_reduced_container_has_its_points_where_they_are_asked_for():
    model = build_model(HELD)
    assert isinstance(model.body, LinkedBody)
    body, mesh = model.body.body, model.container.mesh
    places = body.point[-3:] + np.asarray(mesh.centroid)
    assert places == pytest.approx(np.array([[0.55, 0.13], [-0.55, 3.97], [-0.55, 0.0]]))
    # between the shapes of the nodes beside it, of the corner those of its node
    assert body.shape[-1] == pytest.approx(body.shape[0], abs=1e-15)
    nodes, shapes = model.container.elements.nodes, model.container.basis.shapes
    side = np.flatnonzero(np.abs(nodes[:, 0] - 0.55) < 1e-9)
    side = side[np.argsort(nodes[side, 1])]
    expected = [np.interp(0.13, nodes[side, 1], shapes[0, side, c]) for c in range(2)]
    assert body.shape[-3, :, 0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("model", ["rigid", "reduced", "full"])
def test_the_point_of_a_link_is_on_the_box_that_is_there_at_a_joint_on_the_lower_one(model):
    keys = {
        "solver.model": model,
        "container.boxes": 2,
        "container.height_m": 2.0,
        "container.joints": "loose",
    }
    stops = [{**STOPS[0], "height_m": height} for height in (0.5, 2.0, 2.1)]
    built = build_model(HELD.with_values({**keys, "stop": stops}))
    places = [(point.box, point.right, round(point.place, 9)) for point in side_points(built.case)]
    assert places == [(0, True, 0.25), (0, True, 1.0), (1, True, 0.05), (0, False, 0.0)]
    state = built.run.old
    assert state.point[-4:, 1] == pytest.approx([0.02, 0.02, 0.02, 0.01], abs=1e-12)
    assert not state.force[-4:].any()
    nodes = built.container.elements.nodes[built.container.nodes[-4:]]
    assert nodes[:, 0] == pytest.approx([0.55, 0.55, 0.55, -0.55])
    assert nodes[:, 1] == pytest.approx([0.5, 2.0, 2.1, 0.0], abs=0.26)
    assert built.run.joints["end"].max() == len(state.point) - 4
