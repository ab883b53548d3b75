"""The springs of a flat base on a half-space: its vertical and its rocking stiffness."""

import numpy as np
import pytest

from contact.interface.support import choose_support
from fem.case.case import load_case
from fem.model.half_space import HalfSpace
from fem.model.model import build_model
from fem.model.support import edge_factors

CONCRETE = HalfSpace(youngs_modulus=31e9, poisson_ratio=0.2)


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
    model = build_model(
        load_case("rocking", ["solver.model=rigid", "support.kind=flat", "floor.preset=compacted gravel"])
    )
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
