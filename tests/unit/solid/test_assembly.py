"""Plane-stress laws, matrices and forces against closed forms and differences; the outline as edges and lines."""

from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse.linalg
from meshes import edge_load, force_and_energy, internal_force, mapped_mesh, tangent

from fem.solid import elasticity
from fem.solid.assembly import assemble
from fem.solid.edges import chained, outline_edges

E, NU = 2.1e11, 0.3
STEEL, PAIR = {"youngs_modulus": E, "poisson_ratio": NU}, elasticity.plane_stress_lame(E, NU)
ORDERS = pytest.mark.parametrize("order", [1, 2])


def quad_mesh(x, z):
    """Lines at x and z; points by rows, cells counter-clockwise, 0.5 m thick, of 120 kg per m2 of elevation."""
    s, t = np.linspace(0.0, 1.0, len(x)), np.linspace(0.0, 1.0, len(z))

    def place(u, v):
        return np.interp(u, s, x), np.interp(v, t, z)

    return mapped_mesh(len(x) - 1, len(z) - 1, place, thickness=0.5, density=240.0)


def distorted_mesh(columns=4, rows=5, width=1.1, height=4.0):
    mesh = quad_mesh(np.linspace(-width / 2, width / 2, columns + 1), np.linspace(0.0, height, rows + 1))
    x, z = mesh.points.T
    inner = (np.abs(x) < 0.49 * width) & (z > 0.01 * height) & (z < 0.99 * height)
    cell = np.array([width / columns, height / rows])
    draw = np.random.default_rng(3)
    mesh.points[inner] += 0.25 * cell * draw.uniform(-1.0, 1.0, (inner.sum(), 2))
    mesh.thickness[:] = draw.uniform(0.01, 1.0, len(mesh.quads))
    mesh.areal_density[:] = draw.uniform(50.0, 500.0, len(mesh.quads))
    return mesh


def rotation(angle):
    """Rotation > 0 tilts toward +x, that is clockwise."""
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def rigid_displacement(nodes, angle, shift=(0.0, 0.0)):
    return nodes @ rotation(angle).T - nodes + np.asarray(shift)


def strained_and_turned(elements, strain=1e-3, angle=0.7, seed=5):
    draw = np.random.default_rng(seed)
    spacing = np.ptp(elements.nodes) / len(elements.nodes) ** 0.5
    noise = strain * spacing * draw.uniform(-1.0, 1.0, elements.nodes.shape)
    return rigid_displacement(elements.nodes, angle) + noise


@ORDERS
def test_nodes_begin_with_the_points_and_cells_follow_vtk(order):
    mesh = distorted_mesh()
    elements = assemble(mesh, order=order, **STEEL)
    assert np.array_equal(elements.nodes[: len(mesh.points)], mesh.points)
    assert np.array_equal(elements.cells[:, :4], mesh.quads)
    if order == 2:  # VTK biquadratic quad: middles of edges 01, 12, 23, 30, then the centre
        corners = elements.nodes[elements.cells[:, :4]]
        edges = elements.nodes[elements.cells[:, 4:8]]
        assert edges == pytest.approx(0.5 * (corners + np.roll(corners, -1, axis=1)), abs=1e-14)
        assert elements.nodes[elements.cells[:, 8]] == pytest.approx(corners.mean(axis=1), abs=1e-14)


@ORDERS
def test_mass_centroid_and_inertia_of_a_block_are_exact(order):
    mesh = quad_mesh(np.array([-0.55, -0.1, 0.55]), np.array([0.0, 1.0, 4.0]))
    elements = assemble(mesh, order=order, **STEEL)
    mass, (x, z) = 120.0 * 1.1 * 4.0, elements.nodes.T
    ones = np.ones(len(x))
    assert ones @ elements.mass @ ones == pytest.approx(mass, rel=1e-14)
    assert ones @ elements.mass @ z == pytest.approx(mass * 2.0, rel=1e-14)
    polar = x @ elements.mass @ x + (z - 2.0) @ elements.mass @ (z - 2.0)
    assert polar == pytest.approx(mass * (1.1**2 + 4.0**2) / 12.0, rel=1e-13)


@ORDERS
def test_stiffness_is_the_tangent_at_rest_and_leaves_three_rigid_motions_free(order):
    elements = assemble(distorted_mesh(2, 3), order=order, **STEEL)
    stiffness = elements.stiffness.toarray()
    scale = np.abs(stiffness).max()
    assert np.abs(stiffness - stiffness.T).max() < 1e-14 * scale
    assert np.abs(tangent(elements, np.zeros_like(elements.nodes)) - elements.stiffness).max() < 1e-14 * scale
    values = np.linalg.eigvalsh(stiffness)
    assert np.abs(values[:3]).max() < 1e-12 * values[-1]
    assert values[3] > 1e-7 * values[-1]  # no hourglass


@ORDERS
@pytest.mark.parametrize("strain", [1e-4, 1e-1])
def test_internal_force_is_the_derivative_of_the_strain_energy(order, strain):
    elements = assemble(distorted_mesh(2, 3), order=order, **STEEL)
    displacement = strained_and_turned(elements, strain)
    direction = np.random.default_rng(1).standard_normal(displacement.shape)
    force = internal_force(elements, displacement)
    step = 1e-3 * strain
    ahead, behind = (force_and_energy(elements, displacement + s * step * direction)[1] for s in (1, -1))
    scale = np.linalg.norm(force) * np.linalg.norm(direction)
    assert abs((ahead - behind) / (2 * step) - np.sum(force * direction)) < 1e-5 * scale


@ORDERS
def test_internal_force_of_a_free_body_has_no_resultant_and_no_moment(order):
    elements = assemble(distorted_mesh(), order=order, **STEEL)
    displacement = strained_and_turned(elements, strain=0.02)
    force, place = internal_force(elements, displacement), elements.nodes + displacement
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()
    moments = place[:, 1] * force[:, 0] - place[:, 0] * force[:, 1]
    assert abs(moments.sum()) < 1e-12 * np.abs(moments).sum()


@ORDERS
def test_thickness_belongs_to_each_cell(order):
    # A bar of two thicknesses in series, nu = 0: end displacement F (L1/(E t1 h) + L2/(E t2 h)).
    mesh = quad_mesh(np.array([0.0, 1.0, 3.0]), np.array([0.0, 0.5]))
    mesh.thickness[:] = np.array([0.1, 0.02])
    elements = assemble(mesh, order=order, youngs_modulus=1e9, poisson_ratio=0.0)
    load = edge_load(elements, lambda x, z: x > 2.999, lambda x, z: (1e3, 0.0))
    held = np.zeros_like(elements.nodes, dtype=bool)
    held[elements.nodes[:, 0] < 1e-9, 0] = True
    held[elements.base_nodes[0], 1] = True
    free = np.flatnonzero(~held.ravel())
    displacement = np.zeros(elements.unknowns)
    reduced = elements.stiffness[free][:, free].tocsc()
    displacement[free] = scipy.sparse.linalg.spsolve(reduced, load.ravel()[free])
    end = displacement.reshape(-1, 2)[elements.nodes[:, 0] > 2.999, 0]
    assert end == pytest.approx(1e3 * (1.0 / (1e9 * 0.1) + 2.0 / (1e9 * 0.02)), rel=1e-11)


def test_nodal_stress_of_pure_bending_is_exact_for_quadratic_cells():
    # u = (k x z, -k (x^2 + nu z^2)/2) has sigma_xx = E k z and nothing else, to first order in k.
    elements = assemble(quad_mesh(np.linspace(0, 2, 5), np.linspace(-0.5, 0.5, 3)), order=2, **STEEL)
    (x, z), k = elements.nodes.T, 1e-9
    stress = elements.nodal_stress(np.stack([k * x * z, -0.5 * k * (x * x + NU * z * z)], axis=1))
    assert stress[:, 0] == pytest.approx(E * k * z, abs=1e-7 * E * k)
    assert np.abs(stress[:, 1:]).max() < 1e-7 * E * k


@ORDERS
def test_stress_of_a_thick_wall_is_not_smeared_into_the_sheet(order):
    # A wall between two sheets, pulled twice as hard in the sheets: its nodes show the wall's stress alone.
    mesh = quad_mesh(np.array([-1.0, -0.1, 0.1, 1.0]), np.array([0.0, 1.0]))
    mesh.thickness[:] = np.array([0.016, 1.1, 0.016])
    elements = assemble(mesh, order=order, youngs_modulus=1e11, poisson_ratio=0.0)
    x = elements.nodes[:, 0]
    pull = 1e-8 * np.where(np.abs(x) <= 0.1, x, 2.0 * x - 0.1 * np.sign(x))
    stress = elements.nodal_von_mises(np.stack([pull, 0.0 * pull], axis=1))
    assert stress == pytest.approx(np.where(np.abs(x) < 0.1 + 1e-9, 1e3, 2e3), rel=1e-6)


def test_the_outline_is_the_outer_edges_and_the_joints():
    # Two boxes of one cell each, one on the other.
    points = np.array([[x, z] for z in (0.0, 0.5, 1.0, 1.5, 2.0) for x in (0.0, 0.5, 1.0)])
    lowest = np.array([0, 2, 8, 6, 1, 5, 7, 3, 4])
    for kinds, length in (([0, 0], 6.0), ([0, 1], 7.0)):
        edges = outline_edges(np.array([lowest, lowest + 6]), np.array(kinds))
        assert np.linalg.norm(np.diff(points[edges], axis=1)[:, 0], axis=1).sum() == pytest.approx(length)
    lines = chained(edges)
    drawn = sorted(tuple(sorted(pair)) for line in lines for pair in pairwise(line))
    assert drawn == sorted(tuple(sorted(pair)) for pair in edges.tolist())
    assert len(lines) <= 2


def test_plane_stress_pair_gives_hookes_law_of_a_thin_sheet():
    # Pulled along x and free across: stress E eps along, none across.
    strain = np.array([1e-4, -NU * 1e-4, 0.0])
    assert elasticity.second_stress(strain, PAIR) == pytest.approx([E * 1e-4, 0.0, 0.0], rel=1e-14, abs=1e-7)
    # Sheared: stress G gamma, the tensor's component being gamma/2.
    shear = elasticity.second_stress(np.array([0.0, 0.0, 0.5e-4]), PAIR)
    assert shear == pytest.approx([0.0, 0.0, E / (2 * (1 + NU)) * 1e-4], rel=1e-14)


@pytest.mark.parametrize(
    ("modulus", "ratio", "message"),
    [(value, NU, "Young's modulus") for value in (0.0, -1.0, np.nan, np.inf)]
    + [(E, value, "Poisson's ratio") for value in (-1.0, 0.51, np.nan)],
)
def test_impossible_elastic_constants_are_refused(modulus, ratio, message):
    with pytest.raises(ValueError, match=message):
        elasticity.plane_stress_lame(modulus, ratio)


def test_strain_of_a_stretch_under_rotation_is_that_of_the_stretch():
    # (s^2 - 1)/2 along the stretched axis of the body, whatever the rotation.
    gradient = rotation(1.2) @ np.diag([1.1, 0.95]) - np.eye(2)
    assert elasticity.green_strain(gradient) == pytest.approx([0.105, -0.04875, 0.0], abs=1e-15)


def test_true_stress_turns_with_the_body():
    # Objectivity: sigma(Q F) = Q sigma(F) Q^T.
    gradient, Q = np.array([[0.02, 0.01], [0.03, -0.03]]), rotation(0.8)
    xx, zz, xz = elasticity.cauchy_stress(gradient, PAIR)
    expected = Q @ np.array([[xx, xz], [xz, zz]]) @ Q.T
    turned = elasticity.cauchy_stress(Q @ (np.eye(2) + gradient) - np.eye(2), PAIR)
    assert turned == pytest.approx([expected[0, 0], expected[1, 1], expected[0, 1]], rel=1e-12)


def test_true_stress_carries_the_force_of_a_pulled_bar_on_its_narrowed_section():
    # Pulled to 1.1: E_xx = 0.105, S_xx = E E_xx, force per old section S_xx * 1.1. Across and through the
    # thickness alike the bar shrinks to sqrt(1 - 2 nu E_xx).
    across = np.sqrt(1 - 2 * NU * 0.105)
    stress = elasticity.cauchy_stress(np.diag([0.1, across - 1.0]), PAIR)
    assert stress[0] == pytest.approx(E * 0.105 * 1.1 / across**2, rel=1e-12)
    assert np.abs(stress[1:]).max() < 1e-12 * E
