"""Uplift of a container that bears on less than its width, or has its mass centre beside its axis: the block's."""

import pytest
from cases import named_case
from runs import pulse

from fem.model.container import changed_container, discretise
from fem.model.model import build_model
from fem.run.simulation import run_without_history

RIGID = {"solver.model": "rigid", "floor.kind": "rigid", "contact.mu_static": 2.0, "output.fields_s": 0.0}
WEAK_FLOOR = {
    "floor.kind": "slab",
    "floor.preset": "concrete C25/30",
    "floor.bearing_strength_Pa": 5e6,
    "floor.corner_patch_m": [0.1, 0.25],
}
#: half the width over the height of the mass centre, of the stack
SLENDERNESS = 0.55 / 2.0


def rocks(values: dict, share: float, toward: float) -> bool:
    """Whether the stack rocks under a pulse of a share of the uplift acceleration of such a block."""
    pushed = pulse(share * 9.81 * toward, 0.3) | {"solver.duration_s": 0.3}
    case = named_case("seed_stack_plateau", RIGID | pushed | values)
    own = case.with_values({"container.eccentricity_m": 0.0, "container.centroid_m": 0.5})
    model = build_model(case, changed_container(case, discretise(own), own))
    verdict, error = run_without_history(model, None)
    assert error is None
    return verdict.rotation_ratio > 0.01


@pytest.mark.parametrize(
    ("values", "slenderness"),
    [
        ({}, SLENDERNESS),
        ({"support.effective_width": 0.9}, 0.9 * SLENDERNESS),
        # a floor that accelerates to the right turns it about its left corner, which is farther away
        ({"container.eccentricity_m": 0.05}, (0.55 + 0.05) / 2.0),
        ({"container.eccentricity_m": -0.05}, (0.55 - 0.05) / 2.0),
        ({"container.centroid_m": 0.55}, 0.55 / 2.05),
        # the floor bears 125 kN under a corner and the stack weighs 98.1: plastic under 78.5 of 100 mm, from the edge
        (WEAK_FLOOR, (0.55 - 0.5 * 0.1 * 98.1 / 125.0) / 2.0),
    ],
)
def test_uplift_follows_the_width_that_bears_and_the_mass_centre(values, slenderness):
    assert not rocks(values, 0.99, slenderness)
    assert rocks(values, 1.06, slenderness)
