"""The Newmark family with generalised-alpha averaging, and interpolation within a step.

    u1 = u + h v + h^2 [(1/2 - beta) a + beta a1],   v1 = v + h [(1 - gamma) a + gamma a1]
    M [(1 - alpha_m) a1 + alpha_m a] + (1 - alpha_f) f(u1, v1) + alpha_f f(u, v) = 0

with f the sum of internal minus external forces. Newmark (1959); Chung and Hulbert, J. Appl. Mech. 60
(1993) 371: second order, unconditionally stable, spectral radius at infinite frequency as given.
"""

from typing import NamedTuple

from contact.jit import compiled
from contact.structs import struct


@struct
class Scheme(NamedTuple):
    """Coefficients of one member of the family [-]."""

    newmark_beta: float
    newmark_gamma: float
    alpha_m: float
    alpha_f: float


def generalised_alpha(spectral_radius: float) -> Scheme:
    """Chung and Hulbert's choice for a spectral radius at infinite frequency in [0, 1], else a ValueError."""
    if not 0.0 <= spectral_radius <= 1.0:
        raise ValueError(f"spectral_radius must lie in [0, 1], got {spectral_radius}")
    alpha_m = (2.0 * spectral_radius - 1.0) / (spectral_radius + 1.0)
    alpha_f = spectral_radius / (spectral_radius + 1.0)
    return Scheme(
        newmark_beta=0.25 * (1.0 - alpha_m + alpha_f) ** 2,
        newmark_gamma=0.5 - alpha_m + alpha_f,
        alpha_m=alpha_m,
        alpha_f=alpha_f,
    )


def newmark(newmark_beta: float, newmark_gamma: float) -> Scheme:
    """The family without averaging; ValueError where it is not unconditionally stable (2 beta >= gamma >= 1/2)."""
    if not 2.0 * newmark_beta >= newmark_gamma >= 0.5:
        raise ValueError(
            f"newmark_beta and newmark_gamma must satisfy 2 beta >= gamma >= 1/2, got {newmark_beta}, {newmark_gamma}"
        )
    return Scheme(newmark_beta=newmark_beta, newmark_gamma=newmark_gamma, alpha_m=0.0, alpha_f=0.0)


@compiled
def hermite(share: float, step: float, value: float, rate: float, value_new: float, rate_new: float) -> float:
    """Cubic through values and rates at both ends of a step, at `share` of it."""
    s = share
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * value
        + s * (1.0 - s) ** 2 * step * rate
        + s * s * (3.0 - 2.0 * s) * value_new
        - s * s * (1.0 - s) * step * rate_new
    )
