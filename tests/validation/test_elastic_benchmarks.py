"""Published elastic benchmarks: Cook's membrane, NAFEMS LE1 and FV32, the elastica, the free square.

Cook, J. Struct. Div. ASCE 100 (1974) 1851. NAFEMS, The Standard NAFEMS Benchmarks, TNSB Rev. 3 (1990), tests
LE1 and FV32. Elastica: Mattiasson, Int. J. Numer. Meth. Eng. 17 (1981) 145, elliptic integrals.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh, spsolve

from fem.assembly import assemble
from fem.modes import elastic_modes


def mapped_mesh(columns, rows, place, *, thickness=1.0, density=1.0):
    """Quads on the image of the unit square under `place`(s, t)."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, columns + 1), np.linspace(0.0, 1.0, rows + 1))
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    corner = (j * (columns + 1) + i).ravel()
    full = np.ones(corner.size)
    return SimpleNamespace(
        points=np.stack(place(s.ravel(), t.ravel()), axis=1),
        quads=np.stack([corner, corner + 1, corner + columns + 2, corner + columns + 1], axis=1),
        region=np.zeros(corner.size, dtype=int),
        thickness=thickness * full,
        areal_density=density * thickness * full,
    )


def free_unknowns(*, held_x, held_z):
    return np.flatnonzero(~np.stack([held_x, held_z], axis=1).ravel())


def linear_solution(elements, load, free):
    displacement = np.zeros(elements.unknowns)
    displacement[free] = spsolve(elements.stiffness[free][:, free], load.ravel()[free])
    return displacement.reshape(-1, 2)


def node_at(elements, x, z):
    distance = np.hypot(*(elements.nodes - (x, z)).T)
    assert distance.min() < 1e-9
    return int(np.argmin(distance))


def cook_deflection(order, cells):
    """Tapered panel clamped at the left, unit shear force on the right edge: u_z at its middle, (48, 52)."""
    mesh = mapped_mesh(cells, cells, lambda s, t: (48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)))
    elements = assemble(mesh, youngs_modulus=1.0, poisson_ratio=1.0 / 3.0, order=order)
    load = elements.edge_load(lambda x, z: x > 47.999, lambda x, z: (0.0, 1.0 / 16.0))
    clamped = elements.nodes[:, 0] < 1e-9
    solution = linear_solution(elements, load, free_unknowns(held_x=clamped, held_z=clamped))
    return solution[node_at(elements, 48.0, 52.0), 1]


@pytest.mark.parametrize(("cells", "printed"), [(2, 11.80), (4, 18.29), (8, 22.08), (16, 23.43)])
def test_cooks_membrane_with_bilinear_quads(cells, printed):
    # Bilinear quads without locking remedies, integrated exactly; computed independently, to two decimals.
    assert cook_deflection(1, cells) == pytest.approx(printed, abs=0.005)


def test_cooks_membrane_converges_to_the_known_limit():
    # 23.965: converged value, computed independently; the error of the corners' singularity halves or better.
    deflections = np.array([cook_deflection(2, cells) for cells in (8, 16, 32)])
    assert deflections[-1] == pytest.approx(23.965, abs=0.005)
    errors = 23.965 - deflections
    assert errors[1] < 0.5 * errors[0]


def test_nafems_le1_elliptic_membrane():
    # Quarter of an elliptic plate with an elliptic hole, 10 MPa outward on the outer edge:
    # sigma_zz at D = (2, 0) is 92.7 MPa.
    def place(s, t):  # s from the hole to the outer edge, t from the x axis to the z axis
        inner, outer = (2.0, 1.0), (3.25, 2.75)
        angle = 0.5 * np.pi * t
        x, z = (np.array(wave(angle)) for wave in (np.cos, np.sin))
        return (inner[0] + s * (outer[0] - inner[0])) * x, (inner[1] + s * (outer[1] - inner[1])) * z

    def pressure(x, z):
        normal = np.array([x / 3.25**2, z / 2.75**2])
        # 1e-3 of the load keeps the finite-strain terms of the stress below the digits compared
        return 1e-3 * 10e6 * 0.1 * normal / np.hypot(*normal)

    mesh = mapped_mesh(32, 32, place, thickness=0.1)
    elements = assemble(mesh, youngs_modulus=210e9, poisson_ratio=0.3, order=2)
    x, z = elements.nodes.T
    load = elements.edge_load(
        lambda x, z: (x > 1e-9) & (z > 1e-9) & ((x / 3.25) ** 2 + (z / 2.75) ** 2 > 0.9), pressure
    )
    free = free_unknowns(held_x=np.abs(x) < 1e-9, held_z=np.abs(z) < 1e-9)
    stress = elements.nodal_stress(linear_solution(elements, load, free))
    assert 1e3 * stress[node_at(elements, 2.0, 0.0), 1] == pytest.approx(92.7e6, abs=0.05e6)


def test_nafems_fv32_cantilevered_tapered_membrane():
    # First six in-plane frequencies, plane stress; printed to five digits at most.
    printed = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44]
    mesh = mapped_mesh(
        20, 10, lambda s, t: (10.0 * s, (2.0 * t - 1.0) * (2.5 - 2.0 * s)), thickness=0.05, density=8000.0
    )
    elements = assemble(mesh, youngs_modulus=200e9, poisson_ratio=0.3, order=2)
    clamped = elements.nodes[:, 0] < 1e-9
    free = free_unknowns(held_x=clamped, held_z=clamped)
    stiffness, mass = (matrix[free][:, free] for matrix in (elements.stiffness, elements.vector_mass))
    squares = eigsh(stiffness, k=6, M=mass, sigma=0.0, v0=np.ones(len(free)), return_eigenvectors=False)
    frequencies = np.sqrt(np.sort(squares)) / (2.0 * np.pi)
    assert frequencies == pytest.approx(printed, rel=1e-3)


def test_free_square_vibrates_at_the_known_frequencies():
    # omega L sqrt(rho/E) of the free-free unit square, nu = 0.3, plane stress; computed independently.
    mesh = mapped_mesh(24, 24, lambda s, t: (s, t), thickness=0.2, density=3.0)
    elements = assemble(mesh, youngs_modulus=12.0, poisson_ratio=0.3, order=2)
    omegas = elastic_modes(elements, 5).angular_frequencies * np.sqrt(3.0 / 12.0)
    assert omegas == pytest.approx([2.43265, 2.59096, 2.59096, 2.75536, 3.13163], abs=2e-5)


def elastica_tip(load_ratios, slenderness):
    """Tip of a cantilever of unit length under a dead end load: (down, shortening) at each P L^2/(E I)."""
    height = 1.0 / slenderness
    mesh = mapped_mesh(80, 2, lambda s, t: (s, height * (t - 0.5)))
    elements = assemble(mesh, youngs_modulus=1.0, poisson_ratio=0.0, order=2)
    bending_stiffness = height**3 / 12.0
    unit = elements.edge_load(lambda x, z: x > 1.0 - 1e-9, lambda x, z: (0.0, -1.0 / height))
    clamped = elements.nodes[:, 0] < 1e-9
    free = free_unknowns(held_x=clamped, held_z=clamped)
    tip = node_at(elements, 1.0, 0.0)
    displacement, found = np.zeros(elements.unknowns), []
    for ratio in np.arange(0.25, max(load_ratios) + 0.01, 0.25):
        load = ratio * bending_stiffness * unit.ravel()
        for _ in range(30):
            state = displacement.reshape(-1, 2)
            residual = (elements.internal_force(state).ravel() - load)[free]
            correction = spsolve(elements.tangent(state)[free][:, free], residual)
            displacement[free] -= correction
            if np.abs(correction).max() < 1e-9:  # of the length
                break
        else:
            pytest.fail(f"no equilibrium at P L^2/(E I) = {ratio}")
        if ratio in load_ratios:
            found.append((-displacement[2 * tip + 1], -displacement[2 * tip]))
    return np.array(found)


def test_cantilever_under_end_load_follows_the_elastica():
    exact = np.array([[0.301721, 0.056433], [0.493457, 0.160642], [0.713792, 0.387628]])
    # A bar of finite thickness also shears and stretches, by shares of the order of (h/L)^2; two thicknesses
    # extrapolate to the elastica, which has none.
    thick, thin = (elastica_tip([1.0, 2.0, 5.0], slenderness) for slenderness in (25, 50))
    assert (thick - exact) / (thin - exact) == pytest.approx(np.full((3, 2), 4.0), abs=0.1)
    assert (4.0 * thin - thick) / 3.0 == pytest.approx(exact, rel=1e-5)
