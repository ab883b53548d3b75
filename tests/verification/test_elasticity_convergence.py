"""Manufactured solution at finite strain and rotation: observed orders of the total-Lagrangian elements.

Roache, Verification and Validation in Computational Science and Engineering (1998), chapter 3. The source
term is written here from the textbook law, by differences of its own stress; nothing of the program is used.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from fem.assembly import assemble

E, NU, THICKNESS = 5.0, 0.3, 0.4


def exact(x, z):
    """Displacement: turned by 0.4 rad, with strains of some per cent that vary over the body."""
    turned = (np.cos(0.4) - 1) * x + np.sin(0.4) * z, -np.sin(0.4) * x + (np.cos(0.4) - 1) * z
    return np.array(
        [
            turned[0] + 0.03 * np.sin(2.0 * x + 0.5) * np.cos(1.5 * z),
            turned[1] + 0.04 * np.cos(1.2 * x - 0.3) * np.sin(2.2 * z + 0.2),
        ]
    )


def exact_gradient(x, z):
    return np.array(
        [
            [
                np.cos(0.4) - 1 + 0.06 * np.cos(2.0 * x + 0.5) * np.cos(1.5 * z),
                np.sin(0.4) - 0.045 * np.sin(2.0 * x + 0.5) * np.sin(1.5 * z),
            ],
            [
                -np.sin(0.4) - 0.048 * np.sin(1.2 * x - 0.3) * np.sin(2.2 * z + 0.2),
                np.cos(0.4) - 1 + 0.088 * np.cos(1.2 * x - 0.3) * np.cos(2.2 * z + 0.2),
            ],
        ]
    )


def textbook_first_stress(x, z):
    """P = F S, S by Hooke's law of plane stress from E = (F^T F - I)/2."""
    (a, b), (c, d) = exact_gradient(x, z) + np.eye(2).reshape(2, 2, *(1,) * np.ndim(x))
    xx, zz, xz = 0.5 * (a * a + c * c - 1), 0.5 * (b * b + d * d - 1), 0.5 * (a * b + c * d)
    sxx, szz, sxz = (E / (1 - NU**2) * (xx + NU * zz), E / (1 - NU**2) * (zz + NU * xx), E / (1 + NU) * xz)
    return np.array([[a * sxx + b * sxz, a * sxz + b * szz], [c * sxx + d * sxz, c * sxz + d * szz]])


def source(x, z):
    """Load per area of elevation that makes `exact` an equilibrium: -t Div P, differences of fourth order."""
    h = 1e-3
    dx = [textbook_first_stress(x + k * h, z)[:, 0] for k in (-2, -1, 1, 2)]
    dz = [textbook_first_stress(x, z + k * h)[:, 1] for k in (-2, -1, 1, 2)]
    return -THICKNESS * sum((d[0] - 8 * d[1] + 8 * d[2] - d[3]) / (12 * h) for d in (dx, dz))


def curved_block(cells):
    """`cells` x `cells` quads between two curved sides, none of them a parallelogram."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, cells + 1), np.linspace(0.0, 1.0, cells + 1))
    x = s * (1.0 + 0.3 * t) + 0.08 * np.sin(np.pi * t) * np.sin(np.pi * s)
    z = t * (1.2 - 0.2 * s) + 0.08 * np.sin(np.pi * t) * np.sin(2 * np.pi * s)
    i, j = np.meshgrid(np.arange(cells), np.arange(cells))
    corner = (j * (cells + 1) + i).ravel()
    quads = np.stack([corner, corner + 1, corner + cells + 2, corner + cells + 1], axis=1)
    full = np.ones(len(quads))
    return SimpleNamespace(
        points=np.stack([x.ravel(), z.ravel()], axis=1),
        quads=quads,
        region=0 * quads[:, 0],
        thickness=THICKNESS * full,
        areal_density=full,
    )


def manufactured_error(order, cells):
    elements = assemble(curved_block(cells), youngs_modulus=E, poisson_ratio=NU, order=order)
    x, z = elements.nodes.T
    held = elements.edge_load(lambda x, z: x > -np.inf, lambda x, z: (1.0, 0.0))[:, 0] > 0.0  # all round
    inside, free = ~held, np.flatnonzero(~np.repeat(held, 2))
    load = elements.area_load(source).ravel()[free]
    displacement = exact(x, z).T.copy()
    for _ in range(12):
        residual = elements.internal_force(displacement).ravel()[free] - load
        if np.abs(residual).max() < 1e-13 * E * THICKNESS:
            break
        correction = spsolve(elements.tangent(displacement)[free][:, free], residual)
        displacement[inside] -= correction.reshape(-1, 2)
    else:
        pytest.fail("Newton's method did not converge")
    return elements.l2_distance(displacement, exact)


def test_source_term_belongs_to_the_exact_field():
    # The gradient above against differences of the displacement above: else a slip could hide.
    x, z, h = np.array([0.3, 0.9]), np.array([0.2, 0.7]), 1e-5
    along_x = (exact(x + h, z) - exact(x - h, z)) / (2 * h)
    along_z = (exact(x, z + h) - exact(x, z - h)) / (2 * h)
    assert exact_gradient(x, z) == pytest.approx(np.stack([along_x, along_z], axis=1), abs=1e-9)


@pytest.mark.parametrize(("order", "cells"), [(1, (4, 8, 16, 32)), (2, (3, 6, 12, 24))])
def test_displacement_converges_with_one_order_more_than_the_element_has(order, cells):
    errors = [manufactured_error(order, n) for n in cells]
    orders = -np.diff(np.log(errors)) / np.diff(np.log(cells))
    assert orders[-1] == pytest.approx(order + 1, abs=0.05)
    assert np.all(orders > order + 0.8)
