"""Changes of outcome along an axis: all of them are found and closed in on, islands kept."""

import numpy as np
import pytest

from fem.run.bracket import changes_of, least_width, values_to_try

SCAN = [1.0, 2.0, 3.0, 4.0, 5.0]


def refine_changes(values, outcomes, judge, *, resolution=0.01, inner=3):
    """Every change of outcome, as a sweep locates those of a line of cells."""
    known, least = dict(zip(values, outcomes, strict=True)), least_width(values, resolution)
    while tried := values_to_try(known, resolution=resolution, inner=inner, least=least):
        known |= dict(zip(tried, judge(tried), strict=True))
    return changes_of(known)


def islands(values):
    """Overturns in (1.3, 2.2) and beyond 4.61: a safe island lies between."""
    return ["overturned" if 1.3 < v < 2.2 or v > 4.61 else "standing" for v in values]


def test_every_change_is_closed_in_on():
    changes = refine_changes(SCAN, islands(SCAN), islands, resolution=1e-3)
    assert [(c.below, c.above) for c in changes] == [
        ("standing", "overturned"),
        ("overturned", "standing"),
        ("standing", "overturned"),
    ]
    for change, exact in zip(changes, (1.3, 2.2, 4.61), strict=True):
        assert change.low <= exact <= change.high
        assert change.high - change.low <= 1e-3 * change.high


def test_an_island_inside_a_bracket_is_kept():
    # Between 1 and 2 alone: overturned beyond 1.2, standing again in (1.45, 1.55), as the values tried within show.
    def judge(values):
        return ["overturned" if v > 1.2 and not 1.45 < v < 1.55 else "standing" for v in values]

    changes = refine_changes([1.0, 2.0], judge([1.0, 2.0]), judge, resolution=0.01, inner=3)
    assert [c.value for c in changes] == pytest.approx([1.2, 1.45, 1.55], abs=0.02)


@pytest.mark.parametrize("last_standing", [0.0, -1e-9])
def test_a_change_at_zero_is_closed_in_on_and_left(last_standing):
    # No share of a value is narrow enough there: the step of the scan decides.
    def judge(values):
        return ["overturned" if v > last_standing else "standing" for v in values]

    scan = [-0.2, -0.1, 0.0, 0.1, 0.2]
    (change,) = refine_changes(scan, judge(scan), judge, resolution=0.01)
    assert change.low <= last_standing <= change.high
    assert change.high - change.low <= 0.001


def test_a_resolution_finer_than_numbers_ends_between_two_neighbours():
    def judge(values):
        return ["overturned" if v > np.pi else "standing" for v in values]

    (change,) = refine_changes(SCAN, judge(SCAN), judge, resolution=1e-300)
    assert change.high == np.nextafter(change.low, np.inf)
