"""Uplift follows what bears and where the mass is: on a weak floor a container turns inside the edge of what touches.

By hand: the stack weighs W = 98.1 kN and stands on castings of c = 0.1 m; the floor is plastic under c W/F of them.
"""

import numpy as np
import pytest
from cases import named_case
from floors import half_sine_pulse, one_sine_pulse
from runs import pulse

from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from fem.model.container import changed_container, discretise
from fem.model.model import build_model
from fem.run.simulation import run_without_history

WEIGHT, LENGTH, EDGE = 98.1e3, 0.1, 0.55
STRENGTH = 5e6  #: of asphalt [Pa]
ASPHALT = {"solver.model": "rigid", "contact.mu_static": 2.0, "contact.mu_kinetic": 2.0}
ASPHALT |= {"floor.kind": "slab", "floor.preset": "asphalt", "output.fields_s": 0.0}


def on_asphalt(times, **values):
    """The stack where the floor under a corner carries so many times its weight."""
    strength = max(STRENGTH, times * WEIGHT / LENGTH)  # the patch is at most 1 m deep
    floor = {
        "bearing_strength_Pa": strength,
        "corner_patch_m": [LENGTH, times * WEIGHT / (strength * LENGTH)],
    }
    given = {f"floor.{key}": value for key, value in floor.items()}
    return named_case("seed_stack_plateau", ASPHALT | given | values)


def turns_at(times):
    """Half the width between the points about which it turns [m]."""
    model = build_model(on_asphalt(times))
    bears = np.ptp(model.run.old.point[:, 0])
    assert bears == pytest.approx(model.static.width, rel=1e-9)
    return 0.5 * bears


@pytest.mark.parametrize("times", [1.25, 2.0, 3.9, 4.5, 5.5, 9.0])
def test_it_turns_in_the_middle_of_what_carries_it(times):
    assert turns_at(times) == pytest.approx(EDGE - 0.5 * LENGTH / times, rel=1e-9)


def test_it_turns_about_the_edge_of_a_firm_floor_and_nothing_jumps_between():
    # up to 2.75 mm, a quarter of a per cent of the width, nothing of it is taken, and from twice that on all
    assert turns_at(18.2) == turns_at(40.0) == EDGE
    inside = [EDGE - turns_at(times) for times in (9.0, 9.1, 12.0, 18.1)]
    assert inside[2] == pytest.approx(0.05 / 12.0 * (0.05 / 12.0 / 0.00275 - 1.0), rel=1e-9)
    assert inside[0] == pytest.approx(0.05 / 9.0, rel=1e-9)
    assert inside[1] == pytest.approx(inside[0], rel=0.03)
    assert 0.0 < inside[3] < 1e-4


@pytest.mark.parametrize(
    ("bears", "share", "falls"),
    [(363.0, 0.94, False), (363.0, 1.03, True), (785.0, 0.9, False), (785.0, 1.0, True)],
)
def test_the_points_of_a_flat_base_find_by_themselves_where_it_turns(bears, share, falls):
    # half the base, 0.55 x 1.1 m, bears 363 kN: it turns 74 mm inside the edge, by half of 0.55 x 98.1/363; on a firm
    # floor of 8 times the weight 34 mm, 3 % of the width
    flat = {"support.kind": "flat", "support.casting_m": None, "container.corner_post_N": None}
    soft = {
        "floor.preset": "compacted gravel",
        "floor.bearing_strength_Pa": 1e3 * bears / (0.55 * 1.1),
        "floor.corner_patch_m": None,
    }
    uplift = 9.81 * (EDGE - 0.25 * 1.1 * 98.1 / bears) / 2.0
    push = pulse(share * uplift, 6.0, "half-sine") | {"solver.duration_s": 6.0}
    case = named_case("seed_stack_plateau", ASPHALT | flat | soft | push)
    model = build_model(case)
    assert model.static.uplift_acceleration == pytest.approx(uplift)
    verdict, error = run_without_history(model, None)
    assert error is None and (verdict.rotation_ratio > 1.0) == falls


def block(times):
    """The event-driven block whose corners are where the stack turns."""
    static = build_model(on_asphalt(times)).static
    half = EDGE - 0.5 * LENGTH / times
    inertia = 1.0 + static.inertia * 9.81 / (WEIGHT * (half**2 + 2.0**2))
    return RigidBlock(half_width=half, centroid_height=2.0, gravity=9.81, inertia_ratio=inertia)


@pytest.mark.parametrize(
    ("times", "shape", "seconds", "peak"),
    [
        (1.25, "half-sine", 0.5, 4.5),  # about the edge: 25 % less
        (2.0, "half-sine", 0.5, 4.5),
        *((times, "sine", 1.0, peak) for times in (3.0, 3.9, 4.2, 4.5, 4.9, 5.5) for peak in (3.4, 3.8)),
        *((times, "sine", 1.0, 3.8) for times in (12.0, 20.0)),
    ],
)
def test_it_rocks_as_an_event_driven_block_of_that_width(times, shape, seconds, peak):
    duration = 0.9 if shape == "half-sine" else 6.0  # the corners of the weakest do not survive an impact
    case = on_asphalt(times, **pulse(peak, seconds, shape), **{"solver.duration_s": duration})
    verdict, error = run_without_history(build_model(case), None)
    assert error is None and verdict.valid
    floor = half_sine_pulse if shape == "half-sine" else one_sine_pulse
    expected = simulate_rocking(block(times), floor(peak=peak, duration=seconds), duration=duration)
    assert verdict.max_rotation_rad == pytest.approx(expected.largest_rotation, rel=0.05)


@pytest.mark.parametrize(("peak", "outcome"), [(3.6, "invalid"), (3.8, "overturned")])
def test_a_fall_before_the_floor_is_destroyed_is_a_fall(peak, outcome):
    # 6.5 mm deep as it passes its slenderness angle, and no deeper; where it stands it falls back on that floor, 24 mm.
    case = on_asphalt(1.5, **pulse(peak, 1.0, "sine"))
    verdict, error = run_without_history(build_model(case), None)
    assert error is None and verdict.outcome == outcome
    expected = simulate_rocking(block(1.5), one_sine_pulse(peak=peak, duration=1.0), duration=20.0)
    assert (expected.largest_rotation > 1.5) == (outcome == "overturned")


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
