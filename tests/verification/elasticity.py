"""The elements: patch tests, rigid rotation, published benchmarks, manufactured solutions, a column.

Cook, J. Struct. Div. ASCE 100 (1974) 1851. NAFEMS, The Standard NAFEMS Benchmarks, TNSB Rev. 3 (1990), tests
LE1 and FV32. Elastica: Mattiasson, Int. J. Numer. Meth. Eng. 17 (1981) 145, elliptic integrals. Manufactured
solutions: `verification.manufactured`.
"""

import math
from collections.abc import Sequence

import numpy as np
from evidence.findings import Convergence, analytic, computed, printed
from meshes import edge_load, force_and_energy, internal_force, mapped_mesh, tangent
from scipy.sparse.linalg import eigsh, spsolve
from verification.checks import Findings, check
from verification.manufactured import NewtonError, dynamic_error, static_error

from fem.runtime.arrays import BoolArray, FloatArray, IntArray
from fem.solid.assembly import FiniteElements, assemble
from fem.solid.elasticity import cauchy_stress, plane_stress_lame
from fem.solid.modes import elastic_modes

E, NU = 2.1e11, 0.3
MANUFACTURED = "manufactured solution"
NAFEMS = "NAFEMS TNSB Rev. 3 (1990)"


@check(
    "elasticity",
    "patch tests",
    inputs="The stress expected is of the program's law at one point; its elements are checked against it.",
)
def patch_tests() -> Findings:
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
            residual = internal_force(elements, displacement).ravel()[free]
            correction = spsolve(tangent(elements, displacement)[free][:, free], residual)
            displacement[inside] -= correction.reshape(-1, 2)
        error = np.abs(elements.nodal_stress(displacement) - expected).max() / np.abs(expected).max()
        case = f"patch test, distorted quads of order {order}, strains of 4 %, rotated by 0.5 rad"
        compared = "stress, largest error over the largest stress"
        yield analytic(case, compared, error, source="homogeneous state", absolute=1e-12)


@check("elasticity", "rigid rotation", inputs="The energy of linear strain is of the program's stiffness.")
def rigid_rotation() -> Findings:
    """A rotation by 0.3 rad stores no strain energy; linear strain would."""
    for order in (1, 2):
        elements = distorted_block(order)
        rotated = elements.nodes @ turn(0.3).T - elements.nodes
        linear = 0.5 * float(rotated.ravel() @ (elements.stiffness @ rotated.ravel()))
        ratio = force_and_energy(elements, rotated)[1] / linear
        case = f"rigid rotation by 0.3 rad, order {order}"
        compared = "strain energy over that of linear strain"
        yield analytic(case, compared, ratio, source="objectivity", absolute=1e-10)


@check("elasticity", "Cook's membrane")
def cook() -> Findings:
    """Cook's membrane: the bilinear values, and the limit."""
    source = "bilinear quads integrated exactly, two decimals"
    for cells, reference in ((2, 11.80), (4, 18.29), (8, 22.08), (16, 23.43)):
        case, bilinear = f"Cook's membrane, {cells} x {cells} bilinear", cook_deflection(1, cells)
        yield computed(case, "u_z at (48, 52)", bilinear, reference, source=source, absolute=0.005)
    limit = 23.965
    deflections = {1.0 / cells: cook_deflection(2, cells) for cells in (8, 16, 32)}
    errors = {size: abs(limit - value) for size, value in deflections.items()}
    yield computed(
        "Cook's membrane, 32 x 32 quadratic",
        "u_z at (48, 52)",
        deflections[1.0 / 32],
        limit,
        source="converged value; the order is that of the corner's singularity",
        absolute=0.005,
        convergence=Convergence("h/side", errors, order=1.0, within=0.1, at_least=True),
    )


@check("elasticity", "NAFEMS benchmarks")
def nafems() -> Findings:
    """NAFEMS LE1 and FV32."""
    case = "NAFEMS LE1, elliptic membrane, 32 x 32 quadratic"
    yield printed(case, "sigma_zz at D [Pa]", le1_stress(), 92.7e6, source=NAFEMS, absolute=0.05e6)
    case = "NAFEMS FV32, tapered membrane, 20 x 10 quadratic"
    references = (44.623, 130.03, 162.70, 246.05, 379.90, 391.44)
    mesh = mapped_mesh(
        20, 10, lambda s, t: (10.0 * s, (2.0 * t - 1.0) * (2.5 - 2.0 * s)), thickness=0.05, density=8000.0
    )
    elements = assemble(mesh, youngs_modulus=200e9, poisson_ratio=0.3, order=2)
    clamped = elements.nodes[:, 0] < 1e-9
    free = free_unknowns(clamped, clamped)
    stiffness, mass = (matrix[free][:, free] for matrix in (elements.stiffness, elements.vector_mass))
    squares = eigsh(stiffness, k=6, M=mass, sigma=0.0, v0=np.ones(len(free)), return_eigenvectors=False)
    values = np.sqrt(np.sort(squares)) / (2.0 * np.pi)
    for number, (value, reference) in enumerate(zip(values, references, strict=True), start=1):
        yield printed(case, f"frequency {number} [Hz]", value, reference, source=NAFEMS, relative=1e-3)


@check("elasticity", "elastica")
def elastica() -> Findings:
    """Cantilever under an end load, extrapolated from two thicknesses to none."""
    exact = {1.0: (0.301721, 0.056433), 2.0: (0.493457, 0.160642), 5.0: (0.713792, 0.387628)}
    thick, thin = (elastica_tip(list(exact), slenderness) for slenderness in (25.0, 50.0))
    limits = (4.0 * thin - thick) / 3.0
    names = ("deflection of the tip over L", "shortening over L")
    for limit, (load, references) in zip(limits, exact.items(), strict=True):
        case = f"elastica, P L^2/(E I) = {load:g}"
        for name, value, reference in zip(names, limit, references, strict=True):
            yield analytic(case, name, value, reference, source="elliptic integrals", relative=1e-5)


@check("elasticity", "free square")
def free_square() -> Findings:
    """Frequencies of the free square."""
    case = "free-free unit square, nu = 0.3, 24 x 24 quadratic"
    exact = (2.43265, 2.59096, 2.59096, 2.75536, 3.13163)
    mesh = mapped_mesh(24, 24, lambda s, t: (s, t), thickness=0.2, density=3.0)
    elements = assemble(mesh, youngs_modulus=12.0, poisson_ratio=0.3, order=2)
    values = elastic_modes(elements, 5).angular_frequencies * np.sqrt(3.0 / 12.0)
    for mode, (value, reference) in enumerate(zip(values, exact, strict=True), start=1):
        compared = f"omega L sqrt(rho/E), mode {mode}"
        yield computed(case, compared, value, reference, source="converged value", absolute=2e-5)


@check("elasticity", "column under its weight")
def column() -> Findings:
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
        displacement = linear_solution(elements, weight, free_unknowns(corner, base))
        case, shortening = f"column under its weight, elements of order {order}", -displacement[:, 1].min()
        yield analytic(case, "shortening [m]", shortening, exact, source="rho g c^2/(2E)", relative=1e-10)


@check("elasticity", "manufactured solution, static")
def static_orders() -> Findings:
    """L2 order of the displacement, static, at finite strain and rotation on curved meshes."""
    for order, cells in ((1, (4, 8, 16)), (2, (3, 6, 12, 24))):
        errors = {1.0 / n: static_error(order, n) for n in cells}
        orders = Convergence("h/side", errors, order=order + 1.0, within=0.1)
        case, compared = f"{MANUFACTURED}, static, elements of order {order}", "L2 error of the displacement"
        yield analytic(case, compared, source=MANUFACTURED, convergence=orders)


@check("elasticity", "manufactured solution, dynamic", quick=False)
def dynamic_orders() -> Findings:
    """L2 order of the displacement of a body that rotates, is strained and flies; the step is refined as well."""
    for order, counts in ((1, {4: 20, 8: 40, 16: 80}), (2, {2: 20, 4: 57, 8: 160})):
        errors = {1.0 / n: dynamic_error(order, n, 0.3 / steps) for n, steps in counts.items()}
        orders = Convergence("h/side", errors, order=order + 1.0, within=0.1)
        yield analytic(
            f"{MANUFACTURED}, dynamic, elements of order {order}, generalised-alpha 0.5",
            "L2 error of the displacement at 0.3 s",
            source=MANUFACTURED,
            convergence=orders,
            note="the step is refined like h, and like h^1.5 for order 2",
        )


def distorted_block(order: int) -> FiniteElements:
    """A block of 1.1 x 4 m whose inner points are moved at random by up to 0.3 of a cell."""
    mesh = mapped_mesh(4, 6, lambda s, t: (1.1 * (s - 0.5), 4.0 * t), thickness=0.3, density=333.0)
    x, z = mesh.points.T
    inner = (np.abs(x) < 0.549) & (z > 1e-9) & (z < 4.0 - 1e-9)
    cell = np.array([1.1 / 4, 4.0 / 6])
    mesh.points[inner] += 0.3 * cell * np.random.default_rng(7).uniform(-1.0, 1.0, (int(inner.sum()), 2))
    return assemble(mesh, youngs_modulus=E, poisson_ratio=NU, order=order)


def turn(angle: float) -> FloatArray:
    """Rotation matrix, positive toward +x."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, sine], [-sine, cosine]])


def cook_deflection(order: int, cells: int) -> float:
    """Tapered panel clamped at the left, unit shear force on the right edge: u_z at its middle, (48, 52)."""
    mesh = mapped_mesh(cells, cells, lambda s, t: (48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)))
    elements = assemble(mesh, youngs_modulus=1.0, poisson_ratio=1.0 / 3.0, order=order)
    load = edge_load(elements, lambda x, z: x > 47.999, lambda x, z: (0.0, 1.0 / 16.0))
    clamped = elements.nodes[:, 0] < 1e-9
    solution = linear_solution(elements, load, free_unknowns(clamped, clamped))
    return float(solution[node_at(elements, 48.0, 52.0), 1])


def le1_stress() -> float:
    """Quarter of an elliptic plate with an elliptic hole, 10 MPa outward: sigma_zz at D = (2, 0) [Pa]."""

    def ellipse(s: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        # s from the hole to the outer edge, t from the x axis to the z axis
        inner, outer = (2.0, 1.0), (3.25, 2.75)
        angle = 0.5 * np.pi * t
        along, up = (inner[i] + s * (outer[i] - inner[i]) for i in range(2))
        return along * np.cos(angle), up * np.sin(angle)

    def pressure(x: FloatArray, z: FloatArray) -> FloatArray:
        normal = np.array([x / 3.25**2, z / 2.75**2])
        # 1e-3 of the load keeps the finite-strain terms of the stress below the digits compared
        return 1e-3 * 10e6 * 0.1 * normal / np.hypot(*normal)

    mesh = mapped_mesh(32, 32, ellipse, thickness=0.1)
    elements = assemble(mesh, youngs_modulus=210e9, poisson_ratio=0.3, order=2)
    x, z = elements.nodes.T

    def outer(x: FloatArray, z: FloatArray) -> BoolArray:
        return (x > 1e-9) & (z > 1e-9) & ((x / 3.25) ** 2 + (z / 2.75) ** 2 > 0.9)

    load = edge_load(elements, outer, pressure)
    free = free_unknowns(np.abs(x) < 1e-9, np.abs(z) < 1e-9)
    stress = elements.nodal_stress(linear_solution(elements, load, free))
    return float(1e3 * stress[node_at(elements, 2.0, 0.0), 1])


def elastica_tip(load_ratios: Sequence[float], slenderness: float) -> FloatArray:
    """Tip of a cantilever of unit length under a dead end load: (down, shortening) at each P L^2/(E I)."""
    height = 1.0 / slenderness
    mesh = mapped_mesh(80, 2, lambda s, t: (s, height * (t - 0.5)))
    elements = assemble(mesh, youngs_modulus=1.0, poisson_ratio=0.0, order=2)
    bending_stiffness = height**3 / 12.0
    unit = edge_load(elements, lambda x, z: x > 1.0 - 1e-9, lambda x, z: (0.0, -1.0 / height))
    clamped = elements.nodes[:, 0] < 1e-9
    free = free_unknowns(clamped, clamped)
    tip = node_at(elements, 1.0, 0.0)
    displacement, tips = np.zeros(elements.unknowns), []
    for ratio in np.arange(0.25, max(load_ratios) + 0.01, 0.25):
        load = ratio * bending_stiffness * unit.ravel()
        for _ in range(30):
            state = displacement.reshape(-1, 2)
            residual = (internal_force(elements, state).ravel() - load)[free]
            correction = spsolve(tangent(elements, state)[free][:, free], residual)
            displacement[free] -= correction
            if np.abs(correction).max() < 1e-9:  # of the length
                break
        else:
            raise NewtonError(f"elastica: no equilibrium at P L^2/(E I) = {ratio}")
        if ratio in load_ratios:
            tips.append((-displacement[2 * tip + 1], -displacement[2 * tip]))
    return np.array(tips)


def free_unknowns(held_x: BoolArray, held_z: BoolArray) -> IntArray:
    """Unknowns of the nodes that are not held, x and z interleaved."""
    return np.flatnonzero(~np.stack([held_x, held_z], axis=1).ravel())


def linear_solution(elements: FiniteElements, load: FloatArray, free: IntArray) -> FloatArray:
    """Displacement (n, 2) of linear statics, zero where it is held."""
    displacement = np.zeros(elements.unknowns)
    displacement[free] = spsolve(elements.stiffness[free][:, free], load.ravel()[free])
    return displacement.reshape(-1, 2)


def node_at(elements: FiniteElements, x: float, z: float) -> int:
    """The node at a place."""
    distance = np.hypot(*(elements.nodes - (x, z)).T)
    if not distance.min() < 1e-9:
        raise ValueError(f"no node at x = {x}, z = {z}; the nearest is {distance.min():.3g} away")
    return int(np.argmin(distance))
