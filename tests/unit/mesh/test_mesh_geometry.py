"""Container dimensions and mesh lines."""

import numpy as np
import pytest

from mesh.container import column_segments, foot_line
from mesh.errors import MeshError
from mesh.geometry import ContainerGeometry, Section

SHELL = {"width": 1.1, "height": 1.0, "depth": 1.1, "wall": 0.008}


def shell(**changes: object) -> ContainerGeometry:
    return ContainerGeometry(**(SHELL | changes))


def test_lines_stand_on_walls_and_feet_and_are_symmetric():
    lines = column_segments(shell(), 0.1, foot=0.15).lines()
    for place in (0.008, 0.15, 1.1 - 0.15, 1.1 - 0.008, 1.1):
        assert np.abs(lines - place).min() < 1e-15
    assert lines + lines[::-1] == pytest.approx(np.full(len(lines), 1.1), rel=1e-15)


@pytest.mark.parametrize("wall", [None, 0.002, 0.008, 0.1, 0.4])
def test_no_foot_makes_a_sliver(wall):
    # A sliver: a column thinner than a tenth of the wall beside it, or a thousandth of the width.
    geometry = shell(wall=wall) if wall else shell(wall=None, section=Section.SOLID)
    for foot in np.geomspace(1.1e-3, 0.55, 400):
        narrowest = np.diff(column_segments(geometry, 0.1, foot=foot).lines()).min()
        assert narrowest >= min(0.1 * (wall or foot), 1.1e-3) * (1.0 - 1e-9)
        assert abs(foot_line(geometry, 0.1, foot) - foot) <= foot / 8.0


def test_a_foot_ends_at_a_wall_or_the_middle_line_close_by():
    assert foot_line(shell(), 0.1, 0.0079) == 0.008
    assert column_segments(shell(), 0.1, 0.0079) == column_segments(shell(), 0.1)
    assert foot_line(shell(), 0.1, 0.5499) == 0.55
    assert column_segments(shell(), 0.1, 0.55).counts == (1, 5, 5, 1)


@pytest.mark.parametrize(
    ("foot", "reason"),
    [(0.0, "above 0"), (-0.1, "above 0"), (0.6, "half the width, 0.55 m"), (1e-4, "kind corners")],
)
def test_feet_that_do_not_fit_are_refused(foot, reason):
    with pytest.raises(MeshError, match=reason):
        foot_line(shell(), 0.1, foot)
