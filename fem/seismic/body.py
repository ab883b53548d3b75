"""Input and result of the simplified methods: a loose body, the motion below it, and the row of a method.

Lengths in m, accelerations in m/s2, magnitudes throughout. The motion is that of the floor below the body: on
the ground that of the site, in a building that of the floor.
"""

import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, replace
from enum import StrEnum
from typing import Self

import numpy as np

from contact.reference.rigid_block import RigidBlock
from fem.runtime.arrays import FloatArray
from fem.seismic.action import LAST_PERIOD_S, SiteAction

#: periods (n,) [s] -> elastic pseudo-accelerations at 5 % damping (n,) [m/s2]
Spectrum = Callable[[FloatArray], FloatArray]
#: periods over which the largest spectral velocity is looked for [s]
PERIODS = np.geomspace(0.02, LAST_PERIOD_S, 800)


@dataclass(frozen=True, kw_only=True)
class LooseBody:
    """A rigid body that stands loose on the floor, symmetric about the vertical through its mass centre."""

    block: RigidBlock  #: half width of the support, height of the mass centre, inertia, gravity
    width: float  #: of the shell, along the motion [m]
    height: float  #: of the shell [m]
    depth: float  #: of the shell, across the motion [m]
    mass: float  #: [kg]
    mu_static: float
    mu_kinetic: float
    round: bool = False  #: an upright cylinder

    def __post_init__(self) -> None:
        for name in ("width", "height", "depth", "mass", "mu_static", "mu_kinetic"):
            if not 0.0 < getattr(self, name) < math.inf:  # also refuses nan
                raise ValueError(f"loose body {name} must be positive and finite, got {getattr(self, name)}")

    @property
    def weight(self) -> float:
        """[N]."""
        return self.mass * self.block.gravity

    @property
    def slenderness(self) -> float:
        """Half width over height of the mass centre, tan of the slenderness angle [-]."""
        return self.block.half_width / self.block.centroid_height


@dataclass(frozen=True, kw_only=True)
class FloorAction:
    """The motion of the floor below the body, and of the ground below the building, in a few numbers."""

    peak: float  #: of the floor, horizontal; on the ground gamma_a a_g S [m/s2]
    vertical_peak: float  #: of the floor; on the ground gamma_a a_vg [m/s2]
    peak_velocity: float  #: of the floor, horizontal [m/s]
    spectrum: Spectrum  #: of the floor, elastic, horizontal
    ground_peak: float  #: gamma_a a_g S of the site [m/s2]
    in_building: bool = False  #: filtered by a building, and so nearly harmonic

    def __post_init__(self) -> None:
        for name in ("peak", "vertical_peak", "peak_velocity", "ground_peak"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"action {name} must be finite and not negative, got {getattr(self, name)}")

    def scaled(self, factor: float) -> Self:
        """The same motion, times a factor."""
        return replace(
            self,
            peak=factor * self.peak,
            vertical_peak=factor * self.vertical_peak,
            peak_velocity=factor * self.peak_velocity,
            spectrum=lambda periods: factor * self.spectrum(periods),
            ground_peak=factor * self.ground_peak,
        )

    @classmethod
    def on_ground(cls, site: SiteAction, peak_velocity: float) -> Self:
        """The action of a site; EN 1998-1:2004 gives no peak velocity, take that of the motions [m/s]."""
        return cls(
            peak=site.surface_acceleration,
            vertical_peak=site.vertical_acceleration,
            peak_velocity=peak_velocity,
            spectrum=site.horizontal,
            ground_peak=site.surface_acceleration,
        )

    @property
    def spectral_velocity(self) -> float:
        """Largest pseudo-velocity, 5 % damping, up to 4 s [m/s]."""
        return float(np.max(self.spectrum(PERIODS) * PERIODS / (2.0 * math.pi)))


class MethodQuantity(StrEnum):
    """What a method is about."""

    OVERTURNING = "overturning"
    SLIDING = "sliding"  #: whether it slides at all
    SLIP = "slip"  #: how far it slides


def derived(work: str) -> str:
    """A source after which something was derived here; only a clause that was checked is cited as one."""
    return f"after {work}; derived here, not the text of a clause"


def length_in_words(length: float) -> str:
    """A length [m] in mm, or in m from 1 m on."""
    return f"{1000.0 * length:.3g} mm" if length < 1.0 else f"{length:.3g} m"


def utilisation(demand: float, capacity: float) -> float:
    """Demand over capacity [-]; infinite where a demand meets no capacity, 0 without demand."""
    if demand == 0.0:
        return 0.0
    return demand / capacity if capacity > 0.0 else math.inf


@dataclass(frozen=True)
class MethodRow:
    """One simplified method, applied."""

    name: str
    formula: str  #: symbols; an index after an underscore
    numbers: str  #: the formula with numbers
    demand: float  #: infinite where the method finds no position of rest below overturning
    capacity: float
    unit: str
    says: str
    source: str  #: standard and clause, authors with the year, or `derived` from these
    validity: str
    _: KW_ONLY
    quantity: MethodQuantity
    median: bool = False  #: what half of such motions or bodies exceed: no statement on one of them
    beyond: str = ""  #: why it does not hold here; empty: it does

    @property
    def utilisation(self) -> float:
        """See `utilisation`."""
        return utilisation(self.demand, self.capacity)

    @property
    def fulfilled(self) -> bool:
        """Whether the demand is at most the capacity."""
        return self.utilisation <= 1.0
