"""A mesh whose boxes have their mass centres beside their axes."""

import pytest

from mesh.container import build_container_mesh, with_mass_beside
from mesh.errors import MeshError
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section

GEOMETRY = ContainerGeometry(width=1.1, height=1.0, depth=1.1, boxes=3, section=Section.SHELL, wall=0.008)
FILL = MassFill(mass=2500.0, centroid_height=0.45, wall_density=7850.0)


@pytest.mark.parametrize("distance", [0.011, -0.03])
def test_mass_and_height_of_the_centre_stay_and_the_centre_moves_by_the_distance(distance):
    mesh = build_container_mesh(GEOMETRY, FILL, element_size=0.1)
    moved = with_mass_beside(mesh, distance)
    assert moved.centroid[0] == pytest.approx(distance, rel=1e-12)
    assert moved.centroid[1] == pytest.approx(mesh.centroid[1], rel=1e-12)
    assert moved.mass == pytest.approx(mesh.mass, rel=1e-12)
    # of second order in the distance: of a linear density about the new centre
    assert moved.inertia == pytest.approx(mesh.inertia - mesh.mass * distance**2, rel=1e-3)


def test_a_centre_that_leaves_the_box_is_refused():
    mesh = build_container_mesh(GEOMETRY, FILL, element_size=0.1)
    with pytest.raises(MeshError, match=r"cannot lie 0.4 m beside the axis"):
        with_mass_beside(mesh, 0.4)
