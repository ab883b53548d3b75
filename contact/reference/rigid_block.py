"""The rigid body of the analytic references: a block that stands on two corners of a rigid floor.

Everything is per unit mass: the motion of a rigid block on a rigid floor does not depend on its mass.
Rotation is positive where it tilts the block toward +x, about the right corner.
Housner, The behavior of inverted pendulum structures during earthquakes, BSSA 53 (1963).
"""

import math
from dataclasses import dataclass
from typing import Self

#: moment of inertia of a homogeneous rectangle about a corner over mass times radius squared [-]
HOMOGENEOUS_INERTIA_RATIO = 4.0 / 3.0


@dataclass(frozen=True, kw_only=True)
class RigidBlock:
    """A rigid body with a base of two corners, symmetric about the vertical; ValueError: a number out of range."""

    half_width: float  #: B, from the centroid to a corner along x [m]
    centroid_height: float  #: H, of the centroid above the base [m]
    gravity: float  #: [m/s2]
    inertia_ratio: float = HOMOGENEOUS_INERTIA_RATIO  #: I_O/(M R^2), about a corner [-]

    def __post_init__(self) -> None:
        for name, unit in (("half_width", "m"), ("centroid_height", "m"), ("gravity", "m/s2")):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:  # also refuses nan
                raise ValueError(f"rigid block {name} must be positive and finite, got {value} {unit}")
        if not 1.0 < self.inertia_ratio < math.inf:
            raise ValueError(
                f"rigid block inertia_ratio I_O/(M R^2) must exceed 1, got {self.inertia_ratio}; "
                "a homogeneous rectangle has 4/3"
            )

    @classmethod
    def homogeneous(cls, *, width: float, height: float, gravity: float = 9.81) -> Self:
        """A homogeneous rectangle of the given outer dimensions [m]."""
        return cls(half_width=0.5 * width, centroid_height=0.5 * height, gravity=gravity)

    @property
    def slenderness_angle(self) -> float:
        """Angle between the vertical and the line corner - centroid [rad]."""
        return math.atan2(self.half_width, self.centroid_height)

    @property
    def radius(self) -> float:
        """R, distance from a corner to the centroid [m]."""
        return math.hypot(self.half_width, self.centroid_height)

    @property
    def frequency_parameter(self) -> float:
        """Housner's p = sqrt(M g R/I_O) [1/s]; sqrt(3g/(4R)) for a homogeneous rectangle."""
        return math.sqrt(self.gravity / (self.inertia_ratio * self.radius))

    @property
    def housner_restitution(self) -> float:
        """Ratio of angular velocities at a plastic impact on the new corner [-].

        Housner (1963): e = 1 - (M R^2/I_O)(1 - cos 2 al). Angular momentum about the new corner is
        conserved, and the old corner leaves the floor without impulse. Below about 0.5 the assumption that
        the whole impulse acts at a corner is not credible; with a negative value the block cannot continue
        to rock and comes to rest on its base.
        """
        return 1.0 - (1.0 - math.cos(2.0 * self.slenderness_angle)) / self.inertia_ratio

    def restitution_on_plates(self, length: float) -> float:
        """Ratio of angular velocities at an impact on flat plates, of this length inward from each corner [m].

        From its left corner the block lands on the inner edge of the right plate, at x = B - length, and rolls from
        there to the right corner. Angular momentum about the inner edge is conserved in the first, energy in the
        second: e = (J - B x)/(J + x^2) sqrt((J + x^2)/(J + B^2)), J the inertia about the middle of the base per mass.
        Without length it is Housner's.
        """
        about_corner = self.inertia_ratio * self.radius**2
        about_middle, inner = about_corner - self.half_width**2, self.half_width - length
        return (about_middle - self.half_width * inner) / math.sqrt((about_middle + inner**2) * about_corner)

    @property
    def uplift_acceleration(self) -> float:
        """Floor acceleration above which the block cannot rest on its whole base: g tan al [m/s2]."""
        return self.gravity * self.half_width / self.centroid_height

    @property
    def overturning_energy(self) -> float:
        """Energy per mass that lifts the centroid over the corner: g R (1 - cos al) [J/kg]."""
        # R - H without cancellation for a slender block
        return self.gravity * self.half_width**2 / (self.radius + self.centroid_height)
