"""The animation of a report: what of a frame is rigid motion, and of which body."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from meshes import PlainMesh

from fem.report.animation import animation_of, bodies_of
from fem.results.fields import Fields, FrameFields, FrameKeeper
from fem.solid.assembly import assemble

STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "order": 1}
#: a wide box, and a smaller one 0.1 m to the right on it, of two cells each
BOXES = ((-0.6, 0.6, 0.0, 1.0), (-0.3, 0.5, 1.0, 1.5))
POSES = ((0.02, 0.01, 0.5), (0.3, 0.15, 1.4))  # rotation, centre relative to the floor


def two_boxes(*, joined: bool = False):
    """Two boxes that share no node, numbered as such."""
    points, quads = [], []
    for left, right, bottom, top in BOXES:
        middle, first = 0.5 * (left + right), len(points)
        points += [[x, z] for z in (bottom, top) for x in (left, middle, right)]
        quads += [[first + k, first + k + 1, first + k + 4, first + k + 3] for k in (0, 1)]
    mesh = PlainMesh(
        points=np.array(points),
        quads=np.array(quads),
        region=np.full(4, 3),
        box=np.zeros(4, dtype=int) if joined else np.array([0, 0, 1, 1]),
        thickness=np.ones(4),
        areal_density=np.ones(4),
    )
    return assemble(mesh, **STEEL)


def model_of(elements, *, loose: bool):
    """As much of a model as is asked for; it stands on the corners of the wide box."""
    nodes = np.array([0, 2])
    return SimpleNamespace(
        container=SimpleNamespace(
            elements=elements, nodes=nodes, support=SimpleNamespace(index=nodes), row=()
        ),
        case=SimpleNamespace(
            container=SimpleNamespace(is_loose=loose), solver=SimpleNamespace(model="reduced")
        ),
        contact_areas=np.ones(2),
    )


def frames_of(elements, *, floor: float = 0.2, stretch: float = 0.0) -> Fields:
    """One frame: each box turned and moved on its own; the upper box `stretch` longer over its length."""
    moved = elements.nodes.copy()
    for box, (rotation, x, z) in enumerate(POSES):
        own = np.unique(elements.cells[np.arange(4) // 2 == box])
        arm = elements.nodes[own] - elements.nodes[own].mean(axis=0)
        arm[:, 0] *= 1.0 + stretch * box
        cosine, sine = math.cos(rotation), math.sin(rotation)
        moved[own] = arm @ np.array([[cosine, -sine], [sine, cosine]]) + [floor + x, z]
    keeper = FrameKeeper(
        points=elements.nodes, cells=elements.cells, region=elements.region, box=1 + elements.box
    )
    keeper.keep(
        FrameFields(
            time=1.0,
            displacement=moved - elements.nodes,
            velocity=np.zeros_like(moved),
            von_mises=None,
            contact_pressure=np.zeros(len(moved)),
            floor_displacement=floor,
        )
    )
    return keeper.fields


def test_each_box_of_a_loose_stack_has_its_own_rotation_and_centre():
    elements = two_boxes()
    shown = animation_of(model_of(elements, loose=True), frames_of(elements))
    (frame,) = shown.frames
    assert frame.rotation == pytest.approx([rotation for rotation, *_ in POSES], abs=1e-6)
    assert frame.centre == pytest.approx(np.array([[0.2 + x, z] for _, x, z in POSES]), abs=1e-6)
    assert np.abs(frame.elastic).max() < 1e-6
    assert shown.rests.tolist() == [[a, c, b, d] for a, b, c, d in BOXES]


def test_what_is_left_of_a_box_is_its_deformation():
    elements = two_boxes()
    (frame,) = animation_of(model_of(elements, loose=True), frames_of(elements, stretch=0.01)).frames
    upper = frame.elastic[elements.nodes[:, 1] >= 1.0][3:]  # behind the top of the wide box
    assert np.abs(upper[:, 0]).max() == pytest.approx(0.01 * 0.4, rel=1e-4)
    assert np.abs(frame.elastic[:6]).max() < 1e-6


def test_a_bolted_stack_is_one_body():
    elements = two_boxes(joined=True)
    (body,) = bodies_of(elements, loose=False)
    assert body.share.sum() == pytest.approx(1.0) and len(body.nodes) == 12
    # 1.2 m2 at 0.5 m and 0.4 m2 at 1.25 m, 0.1 m to the right
    assert body.centre == pytest.approx([0.4 * 0.1 / 1.6, (0.6 + 0.5) / 1.6])


def test_the_corners_of_a_box_are_those_of_its_lower_and_its_upper_side():
    elements = two_boxes()
    shown = animation_of(model_of(elements, loose=True), frames_of(elements))
    corners = shown.points[shown.corners[1]] + shown.centroid[1]  # the centroid is rounded
    assert corners == pytest.approx(np.array([[-0.3, 1.0], [0.5, 1.0], [-0.3, 1.5], [0.5, 1.5]]), abs=1e-15)
