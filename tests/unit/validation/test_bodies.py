"""Specimens have the mass properties that were asked for."""

import pytest

from fem.case.case import read_case
from fem.evidence.validation.bodies import cross_validated, specimen
from mesh.errors import MeshError

BLOCK = read_case(
    """
    schema = 1
    [container]
    width_m = 0.1
    height_m = 0.8
    depth_m = 0.7
    mass_kg = 350.0
    [contact]
    mu_static = 1.0
    [motion]
    kind = "none"
    [solver]
    model = "rigid"
    order = 1
    element_size_m = 0.3
    """
)


@pytest.mark.parametrize(("centroid", "inertia"), [(0.3, 0.0526), (0.4, 0.06), (0.45, 0.04)])
def test_a_specimen_has_its_mass_centre_and_inertia(centroid, inertia):
    mesh = specimen(BLOCK, centroid=centroid, inertia_ratio=inertia).mesh
    assert mesh.mass == pytest.approx(350.0)
    assert mesh.centroid == pytest.approx((0.0, centroid))
    assert mesh.inertia / mesh.mass == pytest.approx(inertia)


def test_an_impossible_inertia_is_refused():
    with pytest.raises(MeshError, match="no body of"):
        specimen(BLOCK, centroid=0.4, inertia_ratio=1.0)


def test_each_test_is_predicted_by_a_fit_on_the_others():
    halves = cross_validated([1, 2, 3, 4, 5], sum)
    assert halves == [(9, [2, 4]), (6, [1, 3, 5])]
