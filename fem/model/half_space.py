"""Stiffness and radiation damping of a rigid rectangular patch on an elastic half-space.

Static stiffness after Pais and Kausel, "Approximate formulas for dynamic stiffnesses of rigid foundations", Soil Dyn.
Earthq. Eng. 7 (1988) 213; dashpot after Gazetas, Foundation Engineering Handbook (1991), ch. 15.
The floor is homogeneous, and deep and wide against the patch; the patch is flat, level and rigid.

Validity: against a rigid ellipse of the same area and proportions (exact; Johnson, Contact Mechanics, 1985, 3.5) the
vertical stiffness is 4 % high for a square, within 5 % up to sides of 1:20, and 18 % low at 1:138, an edge of 8 mm x
1.1 m. A slab of finite thickness is softer by its bending; two patches apart are stiffer than one of their area.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class HalfSpace:
    """An elastic half-space."""

    youngs_modulus: float  #: [Pa]
    poisson_ratio: float

    @property
    def shear_modulus(self) -> float:
        """G = E/(2 (1 + nu)) [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    def vertical_stiffness(self, length: float, width: float) -> float:
        """Of a patch with these sides [m]: G B/(1 - nu) (3.1 (L/B)^0.75 + 1.6), L >= B half the sides [N/m]."""
        half_long, half_short = _halves(length, width)
        shape = 3.1 * (half_long / half_short) ** 0.75 + 1.6
        return self.shear_modulus * half_short / (1.0 - self.poisson_ratio) * shape

    def horizontal_stiffness(self, along: float, across: float) -> float:
        """Of a patch moved along its first side [N/m]; the sides in m.

        G B/(2 - nu) (6.8 (L/B)^0.65 + 2.4) along the longer side, .. + 0.8 L/B + 1.6) along the shorter one.
        """
        half_long, half_short = _halves(along, across)
        ratio = half_long / half_short
        shape = 6.8 * ratio**0.65 + (2.4 if along >= across else 0.8 * ratio + 1.6)
        return self.shear_modulus * half_short / (2.0 - self.poisson_ratio) * shape

    def rocking_stiffness(self, along: float, across: float) -> float:
        """Of a patch turned in the plane of its first side [Nm/rad]; the sides in m.

        G B^3/(1 - nu) (3.73 (L/B)^2.4 + 0.27) along the longer side, .. 3.2 L/B + 0.8) along the shorter one.
        """
        half_long, half_short = _halves(along, across)
        ratio = half_long / half_short
        shape = 3.73 * ratio**2.4 + 0.27 if along >= across else 3.2 * ratio + 0.8
        return self.shear_modulus * half_short**3 / (1.0 - self.poisson_ratio) * shape

    def vertical_dashpot(self, area: float, density: float) -> float:
        """Waves that a patch [m2] sends down, rho V_La A, V_La = 3.4 V_s/(pi (1 - nu)) Lysmer's velocity [N s/m].

        The limit of high frequencies, and a lower bound for elongated patches at low ones (Gazetas, Fig. 15.18).
        """
        shear_velocity = math.sqrt(self.shear_modulus / density)
        return density * 3.4 * shear_velocity / (math.pi * (1.0 - self.poisson_ratio)) * area


def _halves(along: float, across: float) -> tuple[float, float]:
    """Half the longer and half the shorter side [m]."""
    return 0.5 * max(along, across), 0.5 * min(along, across)
