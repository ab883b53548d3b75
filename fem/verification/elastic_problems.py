"""Published elastic benchmarks, as functions that return the quantity that was published.

Cook, J. Struct. Div. ASCE 100 (1974) 1851. NAFEMS, The Standard NAFEMS Benchmarks, TNSB Rev. 3 (1990), tests
LE1 and FV32. Elastica: Mattiasson, Int. J. Numer. Meth. Eng. 17 (1981) 145, elliptic integrals.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh, spsolve

from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.assembly import FiniteElements, assemble
from fem.solid.modes import elastic_modes
from fem.verification.manufactured import NewtonError
from fem.verification.meshes import mapped_mesh

Held = NDArray[np.bool_]


def cook_deflection(order: int, cells: int) -> float:
    """Tapered panel clamped at the left, unit shear force on the right edge: u_z at its middle, (48, 52)."""
    mesh = mapped_mesh(cells, cells, lambda s, t: (48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)))
    elements = assemble(mesh, youngs_modulus=1.0, poisson_ratio=1.0 / 3.0, order=order)
    load = elements.edge_load(lambda x, z: x > 47.999, lambda x, z: (0.0, 1.0 / 16.0))
    clamped = elements.nodes[:, 0] < 1e-9
    solution = linear_solution(elements, load, free_unknowns(held_x=clamped, held_z=clamped))
    return float(solution[node_at(elements, 48.0, 52.0), 1])


def le1_stress() -> float:
    """Quarter of an elliptic plate with an elliptic hole, 10 MPa outward: sigma_zz at D = (2, 0) [Pa]."""

    def place(s: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        # s from the hole to the outer edge, t from the x axis to the z axis
        inner, outer = (2.0, 1.0), (3.25, 2.75)
        angle = 0.5 * np.pi * t
        along, up = (inner[i] + s * (outer[i] - inner[i]) for i in range(2))
        return along * np.cos(angle), up * np.sin(angle)

    def pressure(x: FloatArray, z: FloatArray) -> FloatArray:
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
    return float(1e3 * stress[node_at(elements, 2.0, 0.0), 1])


def fv32_frequencies() -> FloatArray:
    """First six in-plane frequencies of a cantilevered tapered membrane, plane stress [Hz]."""
    mesh = mapped_mesh(
        20, 10, lambda s, t: (10.0 * s, (2.0 * t - 1.0) * (2.5 - 2.0 * s)), thickness=0.05, density=8000.0
    )
    elements = assemble(mesh, youngs_modulus=200e9, poisson_ratio=0.3, order=2)
    clamped = elements.nodes[:, 0] < 1e-9
    free = free_unknowns(held_x=clamped, held_z=clamped)
    stiffness, mass = (matrix[free][:, free] for matrix in (elements.stiffness, elements.vector_mass))
    squares = eigsh(stiffness, k=6, M=mass, sigma=0.0, v0=np.ones(len(free)), return_eigenvectors=False)
    return np.asarray(np.sqrt(np.sort(squares)) / (2.0 * np.pi))


def free_square_frequencies() -> FloatArray:
    """First five omega L sqrt(rho/E) of the free-free unit square, nu = 0.3, plane stress [-]."""
    mesh = mapped_mesh(24, 24, lambda s, t: (s, t), thickness=0.2, density=3.0)
    elements = assemble(mesh, youngs_modulus=12.0, poisson_ratio=0.3, order=2)
    return np.asarray(elastic_modes(elements, 5).angular_frequencies * np.sqrt(3.0 / 12.0))


def elastica_tip(load_ratios: Sequence[float], slenderness: float) -> FloatArray:
    """Tip of a cantilever of unit length under a dead end load: (down, shortening) at each P L^2/(E I).

    Raises:
        NewtonError: no equilibrium.
    """
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
            raise NewtonError(f"elastica: no equilibrium at P L^2/(E I) = {ratio}")
        if ratio in load_ratios:
            found.append((-displacement[2 * tip + 1], -displacement[2 * tip]))
    return np.array(found)


def free_unknowns(*, held_x: Held, held_z: Held) -> IntArray:
    """Unknowns of the nodes that are not held, interleaved."""
    return np.flatnonzero(~np.stack([held_x, held_z], axis=1).ravel())


def linear_solution(elements: FiniteElements, load: FloatArray, free: IntArray) -> FloatArray:
    """Displacement (n, 2) of linear statics, zero where it is held."""
    displacement = np.zeros(elements.unknowns)
    displacement[free] = spsolve(elements.stiffness[free][:, free], load.ravel()[free])
    return displacement.reshape(-1, 2)


def node_at(elements: FiniteElements, x: float, z: float) -> int:
    """The node at a place.

    Raises:
        ValueError: there is none.
    """
    distance = np.hypot(*(elements.nodes - (x, z)).T)
    if not distance.min() < 1e-9:
        raise ValueError(f"no node at x = {x}, z = {z}; the nearest is {distance.min():.3g} away")
    return int(np.argmin(distance))
