"""The slab of a case: half-space, what bears under a corner, where it crushes, and the springs of a model on it."""

import math

import numpy as np
import pytest

from contact.interface.support import choose_support
from fem.case.case import CaseError, load_case
from fem.cli.check import preview_of
from fem.model.floor import HalfSpace, slab_of
from fem.model.floor_numbers import hit_from
from fem.model.model import build_model
from fem.model.support import edge_factors

CONCRETE = HalfSpace(youngs_modulus=31e9, poisson_ratio=0.2)
COARSE = ("solver.element_size_m=0.5", "solver.order=1", "solver.model=rigid", "output.fields_s=0")
SLAB = ("floor.preset=concrete C25/30", *COARSE)
EDGE, CASTINGS = "floor.corner_patch_m=[0.008, 1.1]", "floor.corner_patch_m=[0.1, 0.2]"


def slab_with(*overrides):
    return slab_of(load_case("seed_stack", [*SLAB, *overrides]), mass=1e4)


@pytest.mark.parametrize(
    ("along", "out_of_plane", "stiffness"),
    [(0.008, 1.1, 8.1e9), (0.008, 0.008, 0.3e9), (0.1, 0.1, 3.8e9), (1.1, 1.1, 4.2e10)],
)
def test_patches_on_concrete_are_as_stiff_as_estimated(along, out_of_plane, stiffness):
    # An estimate made apart from the program: edge, point of a corner, casting and base of the stack on C25/30.
    assert CONCRETE.vertical_stiffness(along, out_of_plane) == pytest.approx(stiffness, rel=0.02)


def test_a_patch_has_one_vertical_stiffness_and_is_stiffer_across_than_along_itself():
    assert CONCRETE.vertical_stiffness(0.1, 0.4) == CONCRETE.vertical_stiffness(0.4, 0.1)
    assert CONCRETE.horizontal_stiffness(0.1, 0.4) > CONCRETE.horizontal_stiffness(0.4, 0.1)
    # A square, moved along either side: exactly 8 G r/(2 - nu) of a disc, 9 % less than that of a square of its area.
    radius = 0.1 / math.sqrt(math.pi)
    disc = 8.0 * CONCRETE.shear_modulus * radius / (2.0 - 0.2)
    assert CONCRETE.horizontal_stiffness(0.1, 0.1) == pytest.approx(disc, rel=0.05)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.2, 1.0 / 3.0])
def test_waves_leave_faster_than_shear_and_slower_than_pressure(poisson_ratio):
    below = HalfSpace(youngs_modulus=1e9, poisson_ratio=poisson_ratio)
    density, shear = 2000.0, below.shear_modulus
    pressure = shear * (2.0 - 2.0 * poisson_ratio) / (1.0 - 2.0 * poisson_ratio)
    dashpot = below.vertical_dashpot(0.5, density)
    assert 0.5 * math.sqrt(shear * density) < dashpot < 0.5 * math.sqrt(pressure * density)


def test_the_edge_of_a_wall_crushes_the_concrete_before_it_yields():
    slab = slab_with(EDGE)
    assert slab.patch == (0.008, 1.1)
    assert slab.bearing_capacity == pytest.approx(50e6 * 0.008 * 1.1)
    assert slab.steel_capacity == pytest.approx(235e6 * 0.008 * 1.1)
    assert slab.cap == slab.bearing_capacity
    assert not slab.yields_first


def test_waves_damp_a_light_container_on_gravel_more_than_the_least_ratio():
    flat = ("floor.preset=compacted gravel", "support.kind=flat")
    heavy, light = (slab_of(load_case("seed_stack", [*flat]), mass=mass) for mass in (1e4, 500.0))
    below = HalfSpace(youngs_modulus=280e6, poisson_ratio=0.35)
    waves = below.vertical_dashpot(1.1 * 1.1, 2100.0) / below.vertical_stiffness(1.1, 1.1)
    assert light.relaxation_time == pytest.approx(waves)
    assert heavy.relaxation_time == pytest.approx(0.6 * math.sqrt(1e4 / heavy.normal_stiffness))


@pytest.mark.parametrize("support", ["corners", "feet", "flat"])
def test_the_points_of_a_model_share_stiffness_and_cap_of_its_corners(support):
    model = build_model(load_case("seed_stack", [*SLAB, f"support.kind={support}"]))
    slab, contact = slab_of(model.case, model.container.mesh.mass), model.run.problem.contact
    assert contact.normal_stiffness.sum() == pytest.approx(2.0 * slab.normal_stiffness)
    assert contact.tangential_stiffness.sum() == pytest.approx(2.0 * slab.tangential_stiffness)
    assert contact.cap.sum() == pytest.approx(2.0 * slab.cap)
    lengths = model.container.support.length
    np.testing.assert_allclose(contact.cap / contact.cap[0], lengths / lengths[0])
    if support != "flat":  # its springs are stiffer near the edges
        springs = contact.normal_stiffness
        np.testing.assert_allclose(springs / springs[0], lengths / lengths[0])
    np.testing.assert_array_equal(contact.relaxation_time, slab.relaxation_time)


@pytest.mark.parametrize("start", [(), ("initial.rotation_rad=0.02",)], ids=["standing", "tilted"])
def test_a_container_that_sinks_into_the_floor_is_refused_with_the_least_patch(start):
    case = load_case("seed_stack", [*SLAB, "floor.preset=compacted gravel", EDGE, *start])
    least = (
        1.2 * case.weight / 0.5e6
    )  # all of the weight: one corner carries it where the other one lifts off
    reason = rf"bearing_strength_Pa = 500000 Pa: a corner must carry .* least patch has {least:.3g} m2, this one 0.0088"
    with pytest.raises(CaseError, match=reason):
        preview_of(case).to_json()
    with pytest.raises(CaseError, match=reason):
        build_model(case)
    enough = case.with_values({"floor.corner_patch_m": [0.4, 1.001 * least / 0.4]})
    build_model(enough)
    preview_of(enough).to_json()


def test_a_hit_on_concrete_crushes_as_much_as_estimated():
    # Estimated apart from the program: 0.35 m/s at 0.22 of the slenderness angle, 500 to 800 J, 1 to 2 mm at 0.44 MN.
    preview = preview_of(load_case("seed_stack", [*SLAB, EDGE]))
    slab = slab_of(preview.case, preview.mesh.mass)
    hit = hit_from(0.22, preview.static, slab)
    assert hit.closing_speed == pytest.approx(0.35, rel=0.03)
    assert 500.0 < hit.plastic_work < 800.0
    # The cap grows by 50 MPa x 1.1 m for each metre of width, of which the edge wins 4/1.1 for each metre of depth.
    growth = 50e6 * 1.1 * 4.0 / 1.1
    assert hit.plastic_work == pytest.approx(0.44e6 * hit.crushing + 0.5 * growth * hit.crushing**2)


def test_an_edge_wins_more_width_than_a_casting_as_it_sinks_in_and_feet_none():
    for key, widening in (
        (EDGE, 4.0 / 1.1),
        (CASTINGS, 1.0),
        ("support.kind=feet", 0.0),
        ("support.kind=flat", 0.0),
    ):
        slab = slab_with(key)
        assert slab.widening == pytest.approx(widening), key
        # what bears after 1 mm, with the strength of the floor, whatever gave way first
        wider = slab.bearing_capacity * widening * 1e-3 / slab.patch[0]
        assert slab.cap * slab.cap_growth * 1e-3 == pytest.approx(wider)
    contact = build_model(load_case("seed_stack", [*SLAB, EDGE])).run.problem.contact
    np.testing.assert_allclose(contact.cap_growth, 4.0 / 1.1 / 0.008)


@pytest.mark.parametrize(
    ("patch", "deepest"), [("[0.008, 1.1]", 0.01), ("[0.1, 0.004]", 0.004), ("[0.3, 0.3]", 0.01)]
)
def test_a_corner_is_destroyed_where_it_has_sunk_in_by_10_mm_or_by_a_side_of_its_patch(patch, deepest):
    slab = slab_with(f"floor.corner_patch_m={patch}", "floor.bearing_strength_Pa=500e6")
    assert slab.deepest == pytest.approx(deepest)


def springs_under(*values: str) -> tuple[np.ndarray, np.ndarray]:
    model = build_model(load_case("rocking", ["solver.model=rigid", "support.kind=flat", *values]))
    nodes = model.container.nodes
    return model.container.elements.nodes[nodes, 0], model.run.problem.contact.normal_stiffness


@pytest.mark.parametrize("width", [0.75, 1.1, 2.4])
@pytest.mark.parametrize(
    "mesh", [(), ("solver.order=1", "solver.element_size_m=0.3"), ("container.section=solid",)]
)
def test_a_flat_base_has_both_stiffnesses_of_the_half_space(width, mesh):
    x, springs = springs_under(f"container.width_m={width}", "container.depth_m=1.1", *mesh)
    assert springs.min() > 0.0
    assert springs.sum() == pytest.approx(CONCRETE.vertical_stiffness(width, 1.1), rel=1e-9)
    assert springs @ x**2 == pytest.approx(CONCRETE.rocking_stiffness(width, 1.1), rel=1e-9)
    assert springs == pytest.approx(springs[::-1], rel=1e-9)


@pytest.mark.parametrize(("width", "depth", "stiffer"), [(1.1, 2.2, 1.093), (2.44, 6.06, 1.170)])
def test_a_deep_base_has_the_rocking_stiffness_and_more_than_the_vertical_one(width, depth, stiffer):
    # (3.2 L/B + 0.8)/((3.1 (L/B)^0.75 + 1.6)/3) over 2.9 (Pais and Kausel)
    size = {"width_m": width, "depth_m": depth, "mass_kg": 5000}
    x, springs = springs_under(*(f"container.{name}={value}" for name, value in size.items()))
    assert springs.min() > 0.0
    assert springs @ x**2 == pytest.approx(CONCRETE.rocking_stiffness(width, depth), rel=1e-9)
    assert springs.sum() == pytest.approx(stiffer * CONCRETE.vertical_stiffness(width, depth), rel=1e-3)


def test_the_edges_of_a_weak_floor_carry_half_its_strength_at_rest():
    keys = ["solver.model=rigid", "support.kind=flat", "floor.preset=compacted gravel"]
    model = build_model(load_case("rocking", keys))
    used = model.run.old.force[:, 1] / model.run.problem.contact.cap
    assert used.max() == pytest.approx(0.5, rel=1e-3)
    assert used.min() < 0.2


def test_the_edge_springs_have_one_place_whatever_the_mesh():
    # another place of the force is another stress: it goes into the wall, or beside it into the bottom plate
    case, places = load_case("rocking", ["support.kind=flat"]), []
    for elements in (24, 32, 48, 64, 96, 128, 500):
        x = np.linspace(-0.55, 0.55, 2 * elements + 1)
        support = choose_support("flat", x, depth=1.1, order=2)
        springs = support.length * edge_factors(case, support, x)
        outer = x > 0.45
        places.append(springs[outer] @ x[outer] / springs[outer].sum())
    assert places == pytest.approx([places[-1]] * len(places), rel=0.005)
