"""The elements: patch tests, rigid rotation, published benchmarks, manufactured solutions, a column.

Sources of the printed numbers: `fem.verification.elastic_problems` and `fem.verification.manufactured`.
"""

import math

import numpy as np
from scipy.sparse.linalg import spsolve

from fem.runtime.arrays import FloatArray
from fem.solid.assembly import assemble
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
from fem.verification.meshes import PlainMesh, mapped_mesh
from fem.verification.rows import Check, Convergence, Row, as_floats, order_row

E, NU = 2.1e11, 0.3
MANUFACTURED = "manufactured solution"


def distorted_mesh() -> PlainMesh:
    """A block of 1.1 x 4 m whose inner points are moved at random by up to 0.3 of a cell."""
    mesh = mapped_mesh(4, 6, lambda s, t: (1.1 * (s - 0.5), 4.0 * t), thickness=0.3, density=333.0)
    points = mesh.points.copy()
    x, z = points.T
    inner = (np.abs(x) < 0.549) & (z > 1e-9) & (z < 4.0 - 1e-9)
    cell = np.array([1.1 / 4, 4.0 / 6])
    points[inner] += 0.3 * cell * np.random.default_rng(7).uniform(-1.0, 1.0, (int(inner.sum()), 2))
    return PlainMesh(
        points=points,
        quads=mesh.quads,
        region=mesh.region,
        thickness=mesh.thickness,
        areal_density=mesh.areal_density,
    )


def patch_tests() -> list[Row]:
    """A homogeneous state, prescribed all round, at finite strain and rotation: reproduced exactly."""
    rows = []
    for order in (1, 2):
        elements = assemble(distorted_mesh(), youngs_modulus=E, poisson_ratio=NU, order=order)
        gradient = _turn(0.5) @ np.array([[1.03, 0.02], [-0.01, 0.96]]) - np.eye(2)
        x, z = elements.nodes.T
        inside = (np.abs(x) < 0.55 - 1e-9) & (z > 1e-9) & (z < 4.0 - 1e-9)
        free = np.flatnonzero(np.repeat(inside, 2))
        displacement = elements.nodes @ gradient.T
        displacement[inside] += 1e-3 * np.random.default_rng(2).uniform(-1.0, 1.0, displacement[inside].shape)
        for _ in range(8):
            residual = elements.internal_force(displacement).ravel()[free]
            correction = spsolve(elements.tangent(displacement)[free][:, free], residual)
            displacement[inside] -= correction.reshape(-1, 2)
        expected = cauchy_stress(gradient, plane_stress_lame(E, NU))
        error = np.abs(elements.nodal_stress(displacement) - expected).max() / np.abs(expected).max()
        rows.append(
            Row(
                case=f"patch test, distorted quads of order {order}, strains of 4 % turned by 0.5 rad",
                compared="stress, largest error over the largest stress",
                value=float(error),
                reference=0.0,
                kind="analytic",
                source="homogeneous state",
                tolerance=1e-12,
            )
        )
    return rows


def rigid_rotation() -> list[Row]:
    """A rotation by 0.3 rad stores no strain energy; linear strain would."""
    rows = []
    for order in (1, 2):
        elements = assemble(distorted_mesh(), youngs_modulus=E, poisson_ratio=NU, order=order)
        rotated = elements.nodes @ _turn(0.3).T - elements.nodes
        linear = 0.5 * float(rotated.ravel() @ (elements.stiffness @ rotated.ravel()))
        rows.append(
            Row(
                case=f"rigid rotation by 0.3 rad, order {order}",
                compared="strain energy over what linear strain makes of it",
                value=elements.strain_energy(rotated) / linear,
                reference=0.0,
                kind="analytic",
                source="objectivity",
                tolerance=1e-10,
            )
        )
    return rows


def cook() -> list[Row]:
    """Cook's membrane: the bilinear values, and the limit."""
    rows = [
        Row(
            case=f"Cook's membrane, {cells} x {cells} bilinear",
            compared="u_z at (48, 52)",
            value=cook_deflection(1, cells),
            reference=reference,
            kind="computed",
            source="bilinear quads integrated exactly, two decimals",
            tolerance=0.005,
        )
        for cells, reference in ((2, 11.80), (4, 18.29), (8, 22.08), (16, 23.43))
    ]
    cells = (8, 16, 32)
    deflections = [cook_deflection(2, n) for n in cells]
    rows.append(
        Row(
            case="Cook's membrane, 32 x 32 quadratic",
            compared="u_z at (48, 52)",
            value=deflections[-1],
            reference=23.965,
            kind="computed",
            source="converged value; the order is that of the corner's singularity",
            tolerance=0.005,
            convergence=Convergence(
                against="h/side",
                sizes=as_floats([1.0 / n for n in cells]),
                errors=as_floats([abs(23.965 - value) for value in deflections]),
                expected=1.0,
                tolerance=0.1,
                at_least=True,
            ),
        )
    )
    return rows


def nafems() -> list[Row]:
    """NAFEMS LE1 and FV32."""
    rows = [
        Row(
            case="NAFEMS LE1, elliptic membrane, 32 x 32 quadratic",
            compared="sigma_zz at D [Pa]",
            value=le1_stress(),
            reference=92.7e6,
            kind="printed",
            source="NAFEMS TNSB Rev. 3 (1990)",
            tolerance=0.05e6,
        )
    ]
    printed = (44.623, 130.03, 162.70, 246.05, 379.90, 391.44)
    for number, (found, reference) in enumerate(zip(fv32_frequencies(), printed, strict=True), start=1):
        rows.append(
            Row(
                case="NAFEMS FV32, tapered membrane, 20 x 10 quadratic",
                compared=f"frequency {number} [Hz]",
                value=float(found),
                reference=reference,
                kind="printed",
                source="NAFEMS TNSB Rev. 3 (1990)",
                tolerance=1e-3,
                relative=True,
            )
        )
    return rows


def elastica() -> list[Row]:
    """Cantilever under an end load, two thicknesses extrapolated to the line without any."""
    loads = (1.0, 2.0, 5.0)
    thick, thin = (elastica_tip(loads, slenderness) for slenderness in (25.0, 50.0))
    limit = (4.0 * thin - thick) / 3.0
    exact = ((0.301721, 0.056433), (0.493457, 0.160642), (0.713792, 0.387628))
    return [
        Row(
            case=f"elastica, P L^2/(E I) = {load:g}",
            compared=name,
            value=float(limit[i, k]),
            reference=exact[i][k],
            kind="analytic",
            source="elliptic integrals",
            tolerance=1e-5,
            relative=True,
        )
        for i, load in enumerate(loads)
        for k, name in enumerate(("deflection of the tip over L", "shortening over L"))
    ]


def free_square() -> list[Row]:
    """Frequencies of the free square."""
    exact = (2.43265, 2.59096, 2.59096, 2.75536, 3.13163)
    return [
        Row(
            case="free-free unit square, nu = 0.3, 24 x 24 quadratic",
            compared=f"omega L sqrt(rho/E), mode {number}",
            value=float(found),
            reference=reference,
            kind="computed",
            source="converged value",
            tolerance=2e-5,
        )
        for number, (found, reference) in enumerate(
            zip(free_square_frequencies(), exact, strict=True), start=1
        )
    ]


def static_orders() -> list[Row]:
    """L2 order of the displacement, static, at finite strain and rotation on curved meshes."""
    rows = []
    for order, cells in ((1, (4, 8, 16)), (2, (3, 6, 12, 24))):
        errors = [static_error(order, n) for n in cells]
        rows.append(
            order_row(
                case=f"{MANUFACTURED}, static, elements of order {order}",
                compared="L2 error of the displacement",
                convergence=_in_space(cells, errors, order),
                kind="analytic",
                source=MANUFACTURED,
            )
        )
    return rows


def dynamic_orders() -> list[Row]:
    """L2 order of the displacement of a body that turns, is strained and flies; the step is refined besides."""
    rows = []
    for order, cells, counts in ((1, (4, 8, 16), (20, 40, 80)), (2, (2, 4, 8), (20, 57, 160))):
        errors = [dynamic_error(order, n, 0.3 / count) for n, count in zip(cells, counts, strict=True)]
        rows.append(
            order_row(
                case=f"{MANUFACTURED}, dynamic, elements of order {order}, generalised-alpha 0.5",
                compared="L2 error of the displacement at 0.3 s",
                convergence=_in_space(cells, errors, order),
                kind="analytic",
                source=MANUFACTURED,
                note="step like h, and like h^1.5 for order 2",
            )
        )
    return rows


def column() -> list[Row]:
    """A column under its own weight, nu = 0: rho g c^2/(2E)."""
    rows, density, gravity, height, modulus = [], 333.0, 9.81, 4.0, 1e9
    for order in (1, 2):
        mesh = mapped_mesh(2, 8, lambda s, t: (1.1 * (s - 0.5), height * t), thickness=0.3, density=density)
        elements = assemble(mesh, youngs_modulus=modulus, poisson_ratio=0.0, order=order)
        weight = np.zeros_like(elements.nodes)
        weight[:, 1] = -gravity * elements.mass.sum(axis=1)
        base = np.zeros(len(elements.nodes), dtype=bool)
        base[elements.base_nodes] = True
        corner = np.zeros_like(base)
        corner[elements.base_nodes[0]] = True
        displacement = linear_solution(elements, weight, free_unknowns(held_x=corner, held_z=base))
        rows.append(
            Row(
                case=f"column under its weight, elements of order {order}",
                compared="shortening [m]",
                value=-float(displacement[:, 1].min()),
                reference=density * gravity * height**2 / (2.0 * modulus),
                kind="analytic",
                source="rho g c^2/(2E)",
                tolerance=1e-10,
                relative=True,
            )
        )
    return rows


def _turn(angle: float) -> FloatArray:
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, sine], [-sine, cosine]])


def _in_space(cells: tuple[int, ...], errors: list[float], order: int) -> Convergence:
    return Convergence(
        against="h/side",
        sizes=as_floats([1.0 / n for n in cells]),
        errors=as_floats(errors),
        expected=order + 1.0,
        tolerance=0.1,
    )


CHECKS = (
    Check(name="patch tests", rows=patch_tests),
    Check(name="rigid rotation", rows=rigid_rotation),
    Check(name="Cook's membrane", rows=cook),
    Check(name="NAFEMS benchmarks", rows=nafems),
    Check(name="elastica", rows=elastica),
    Check(name="free square", rows=free_square),
    Check(name="column under its weight", rows=column),
    Check(name="manufactured solution, static", rows=static_orders),
    Check(name="manufactured solution, dynamic", rows=dynamic_orders, quick=False),
)
