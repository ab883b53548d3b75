"""The elements: patch tests, rigid rotation, published benchmarks, manufactured solutions, a column.

Sources of the printed numbers: `fem.verification.elastic_problems` and `fem.verification.manufactured`.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from scipy.sparse.linalg import spsolve

from fem.runtime.arrays import FloatArray
from fem.solid.assembly import FiniteElements, assemble
from fem.solid.elasticity import cauchy_stress, plane_stress_lame
from fem.verification.elastic_problems import (
    cook_deflection,
    elastica_tip,
    free_square_frequencies,
    free_unknowns,
    fv32_frequencies,
    le1_stress,
    linear_solution,
)
from fem.verification.manufactured import dynamic_error, static_error
from fem.verification.meshes import mapped_mesh
from fem.verification.rows import Convergence, Row, analytic, check, computed, convergence, printed

E, NU = 2.1e11, 0.3
MANUFACTURED = "manufactured solution"
NAFEMS = "NAFEMS TNSB Rev. 3 (1990)"


@check("elasticity", "patch tests")
def patch_tests() -> Iterator[Row]:
    """A homogeneous state, prescribed on the whole boundary, at finite strain and rotation: reproduced exactly."""
    gradient = turn(0.5) @ np.array([[1.03, 0.02], [-0.01, 0.96]]) - np.eye(2)
    expected = cauchy_stress(gradient, plane_stress_lame(E, NU))
    for order in (1, 2):
        elements = distorted_block(order)
        x, z = elements.nodes.T
        inside = (np.abs(x) < 0.55 - 1e-9) & (z > 1e-9) & (z < 4.0 - 1e-9)
        free = np.flatnonzero(np.repeat(inside, 2))
        displacement = elements.nodes @ gradient.T
        displacement[inside] += 1e-3 * np.random.default_rng(2).uniform(-1.0, 1.0, displacement[inside].shape)
        for _ in range(8):
            residual = elements.internal_force(displacement).ravel()[free]
            correction = spsolve(elements.tangent(displacement)[free][:, free], residual)
            displacement[inside] -= correction.reshape(-1, 2)
        error = np.abs(elements.nodal_stress(displacement) - expected).max() / np.abs(expected).max()
        yield analytic(
            f"patch test, distorted quads of order {order}, strains of 4 %, rotated by 0.5 rad",
            "stress, largest error over the largest stress",
            error,
            0.0,
            source="homogeneous state",
            absolute=1e-12,
        )


@check("elasticity", "rigid rotation")
def rigid_rotation() -> Iterator[Row]:
    """A rotation by 0.3 rad stores no strain energy; linear strain would."""
    for order in (1, 2):
        elements = distorted_block(order)
        rotated = elements.nodes @ turn(0.3).T - elements.nodes
        linear = 0.5 * float(rotated.ravel() @ (elements.stiffness @ rotated.ravel()))
        case, compared = (
            f"rigid rotation by 0.3 rad, order {order}",
            "strain energy over that of linear strain",
        )
        found = elements.strain_energy(rotated) / linear
        yield analytic(case, compared, found, 0.0, source="objectivity", absolute=1e-10)


@check("elasticity", "Cook's membrane")
def cook() -> Iterator[Row]:
    """Cook's membrane: the bilinear values, and the limit."""
    source = "bilinear quads integrated exactly, two decimals"
    for cells, reference in ((2, 11.80), (4, 18.29), (8, 22.08), (16, 23.43)):
        case, bilinear = f"Cook's membrane, {cells} x {cells} bilinear", cook_deflection(1, cells)
        yield computed(case, "u_z at (48, 52)", bilinear, reference, source=source, absolute=0.005)
    limit = 23.965
    found = {1.0 / cells: cook_deflection(2, cells) for cells in (8, 16, 32)}
    errors = {size: abs(limit - value) for size, value in found.items()}
    yield computed(
        "Cook's membrane, 32 x 32 quadratic",
        "u_z at (48, 52)",
        found[1.0 / 32],
        limit,
        source="converged value; the order is that of the corner's singularity",
        absolute=0.005,
        convergence=convergence("h/side", errors, order=1.0, within=0.1, at_least=True),
    )


@check("elasticity", "NAFEMS benchmarks")
def nafems() -> Iterator[Row]:
    """NAFEMS LE1 and FV32."""
    case = "NAFEMS LE1, elliptic membrane, 32 x 32 quadratic"
    yield printed(case, "sigma_zz at D [Pa]", le1_stress(), 92.7e6, source=NAFEMS, absolute=0.05e6)
    case = "NAFEMS FV32, tapered membrane, 20 x 10 quadratic"
    references = (44.623, 130.03, 162.70, 246.05, 379.90, 391.44)
    for number, (found, reference) in enumerate(zip(fv32_frequencies(), references, strict=True), start=1):
        yield printed(case, f"frequency {number} [Hz]", found, reference, source=NAFEMS, relative=1e-3)


@check("elasticity", "elastica")
def elastica() -> Iterator[Row]:
    """Cantilever under an end load, extrapolated from two thicknesses to none."""
    exact = {1.0: (0.301721, 0.056433), 2.0: (0.493457, 0.160642), 5.0: (0.713792, 0.387628)}
    thick, thin = (elastica_tip(list(exact), slenderness) for slenderness in (25.0, 50.0))
    limits = (4.0 * thin - thick) / 3.0
    names = ("deflection of the tip over L", "shortening over L")
    for limit, (load, references) in zip(limits, exact.items(), strict=True):
        case = f"elastica, P L^2/(E I) = {load:g}"
        for name, found, reference in zip(names, limit, references, strict=True):
            yield analytic(case, name, found, reference, source="elliptic integrals", relative=1e-5)


@check("elasticity", "free square")
def free_square() -> Iterator[Row]:
    """Frequencies of the free square."""
    case = "free-free unit square, nu = 0.3, 24 x 24 quadratic"
    exact = (2.43265, 2.59096, 2.59096, 2.75536, 3.13163)
    for mode, (found, reference) in enumerate(zip(free_square_frequencies(), exact, strict=True), start=1):
        compared = f"omega L sqrt(rho/E), mode {mode}"
        yield computed(case, compared, found, reference, source="converged value", absolute=2e-5)


@check("elasticity", "column under its weight")
def column() -> Iterator[Row]:
    """A column under its own weight, nu = 0: rho g c^2/(2E)."""
    density, gravity, height, modulus = 333.0, 9.81, 4.0, 1e9
    mesh = mapped_mesh(2, 8, lambda s, t: (1.1 * (s - 0.5), height * t), thickness=0.3, density=density)
    exact = density * gravity * height**2 / (2.0 * modulus)
    for order in (1, 2):
        elements = assemble(mesh, youngs_modulus=modulus, poisson_ratio=0.0, order=order)
        weight = np.zeros_like(elements.nodes)
        weight[:, 1] = -gravity * elements.mass.sum(axis=1)
        nodes = np.arange(len(elements.nodes))
        base, corner = np.isin(nodes, elements.base_nodes), nodes == elements.base_nodes[0]
        displacement = linear_solution(elements, weight, free_unknowns(held_x=corner, held_z=base))
        case, found = f"column under its weight, elements of order {order}", -displacement[:, 1].min()
        yield analytic(case, "shortening [m]", found, exact, source="rho g c^2/(2E)", relative=1e-10)


@check("elasticity", "manufactured solution, static")
def static_orders() -> Iterator[Row]:
    """L2 order of the displacement, static, at finite strain and rotation on curved meshes."""
    for order, cells in ((1, (4, 8, 16)), (2, (3, 6, 12, 24))):
        orders = in_space({1.0 / n: static_error(order, n) for n in cells}, order)
        yield analytic(
            f"{MANUFACTURED}, static, elements of order {order}",
            "L2 error of the displacement",
            orders.finest,
            0.0,
            source=MANUFACTURED,
            convergence=orders,
        )


@check("elasticity", "manufactured solution, dynamic", quick=False)
def dynamic_orders() -> Iterator[Row]:
    """L2 order of the displacement of a body that rotates, is strained and flies; the step is refined as well."""
    for order, counts in ((1, {4: 20, 8: 40, 16: 80}), (2, {2: 20, 4: 57, 8: 160})):
        orders = in_space(
            {1.0 / n: dynamic_error(order, n, 0.3 / steps) for n, steps in counts.items()}, order
        )
        yield analytic(
            f"{MANUFACTURED}, dynamic, elements of order {order}, generalised-alpha 0.5",
            "L2 error of the displacement at 0.3 s",
            orders.finest,
            0.0,
            source=MANUFACTURED,
            convergence=orders,
            note="the step is refined like h, and like h^1.5 for order 2",
        )


def distorted_block(order: int) -> FiniteElements:
    """A block of 1.1 x 4 m whose inner points are moved at random by up to 0.3 of a cell."""
    mesh = mapped_mesh(4, 6, lambda s, t: (1.1 * (s - 0.5), 4.0 * t), thickness=0.3, density=333.0)
    points = mesh.points.copy()
    x, z = points.T
    inner = (np.abs(x) < 0.549) & (z > 1e-9) & (z < 4.0 - 1e-9)
    cell = np.array([1.1 / 4, 4.0 / 6])
    points[inner] += 0.3 * cell * np.random.default_rng(7).uniform(-1.0, 1.0, (int(inner.sum()), 2))
    return assemble(replace(mesh, points=points), youngs_modulus=E, poisson_ratio=NU, order=order)


def turn(angle: float) -> FloatArray:
    """Rotation matrix, positive toward +x."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, sine], [-sine, cosine]])


def in_space(errors: Mapping[float, float], element_order: int) -> Convergence:
    """L2 errors by element size over the side: one order more than the elements have."""
    return convergence("h/side", errors, order=element_order + 1.0, within=0.1)
