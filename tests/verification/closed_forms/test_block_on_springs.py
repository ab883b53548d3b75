"""The block on springs that the restitution of a flat base is compared with, by limits known without it."""

import numpy as np
import pytest
from block_on_springs import evenly_spaced, next_turning_point
from closed_forms import peak_after_impacts
from runs import BLOCK

CORNERS = np.array([-0.55, 0.55])
RELEASED = 0.5 * BLOCK.slenderness_angle


def turned(places, *, side=1.0):
    return next_turning_point(
        BLOCK, places=places, stiffness=5e6, relaxation_time=7e-3, rotation=side * RELEASED, duration=2.0
    )


def test_on_two_stiff_corners_it_is_housners_block():
    exact = peak_after_impacts(BLOCK, RELEASED, 1, BLOCK.housner_restitution)
    assert turned(CORNERS) == pytest.approx(exact, rel=5e-3)


def test_it_keeps_more_on_a_bed_and_knows_no_side():
    bed = turned(evenly_spaced(1.1, 45))
    assert 1.1 * turned(CORNERS) < bed < RELEASED
    assert turned(evenly_spaced(1.1, 45), side=-1.0) == pytest.approx(bed, rel=1e-3)
