"""A container that is crushed: so soft that its weight or its motion leaves nothing of it that could be computed.

St. Venant-Kirchhoff material pressed along one axis carries most at the stretch 1/sqrt(3), less beyond, and nothing
any more when it is flat; pressed through itself it pushes back, and comes to rest inside out. Linear elasticity
takes any compression. Neither solution has to do with a container.
"""

import math

import numpy as np

from fem.case.case import Case, CaseError
from fem.runtime.arrays import FloatArray
from fem.solid.assembly import FiniteElements
from fem.solid.reduction import StaticResponse

#: stretch at which the nominal stress (s^3 - s) E/2 of St. Venant and Kirchhoff has its least value
LEAST_STRETCH = 1.0 / math.sqrt(3.0)


def require_uncrushed(
    case: Case, elements: FiniteElements, response: StaticResponse, rotation: float, force: FloatArray
) -> None:
    """Refuse a container whose weight alone presses it beyond what its material can carry.

    Args:
        case: of the container; elements, response: its own.
        rotation: at the start [rad]; force: (n_c, 2) then on its contact nodes, along the axes of space [N].

    Raises:
        CaseError: with how far it would be pressed together.
    """
    cosine, sine = math.cos(rotation), math.sin(rotation)
    in_body = force @ np.array([[cosine, sine], [-sine, cosine]])
    displacement = np.tensordot(in_body.ravel(), response.displacement, axes=1)
    pressed = -least_principal_strain(elements.displacement_gradient(displacement))
    if pressed < 1.0 - LEAST_STRETCH:
        return
    raise CaseError(
        f"[container] youngs_modulus_Pa = {case.container.youngs_modulus_Pa:g} Pa: its own weight would press the "
        f"container together by {100.0 * pressed:.0f} % where it is strained most, and beyond "
        f"{100.0 * (1.0 - LEAST_STRETCH):.0f} % such a material gives way; take a stiffer one, thicker walls, or "
        'solver.model = "rigid"'
    )


def least_principal_strain(gradient: FloatArray) -> float:
    """Greatest compression of the linear strain (< 0) of displacement gradients, shape (2, 2, ...) [-]."""
    (xx, xz), (zx, zz) = gradient
    return float(np.min(0.5 * (xx + zz) - np.hypot(0.5 * (xx - zz), 0.5 * (xz + zx))))


def least_volume_ratio(gradient: FloatArray) -> float:
    """Smallest det(1 + H) of displacement gradients, shape (2, 2, ...); not above 0: inside out."""
    (xx, xz), (zx, zz) = gradient
    return float(np.min((1.0 + xx) * (1.0 + zz) - xz * zx))
