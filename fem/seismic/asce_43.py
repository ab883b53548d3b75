"""Approximate sliding and rocking of an unanchored body, after Appendix A of ASCE/SEI 43-05.

The reserve-energy method of Kennedy: an oscillator whose stiffness and damping are those of the body at its largest
displacement. Only parts of the text were seen; the other formulas were derived and reproduce the limits that are
known: so the rows are marked as derived. Angles in rad.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.reference.rigid_block import RigidBlock
from fem.runtime.arrays import FloatArray
from fem.seismic.body import PERIODS, FloorAction, Limits, LooseBody, Spectrum
from fem.seismic.method import MethodQuantity, MethodRow, MethodSource, SourceStanding, length_in_words

SLIDING_DAMPING = 0.10
VERTICAL_SHARE = 0.4  #: of the vertical peak that reduces friction, and of a second horizontal component
ANGLES = 1000  #: tried between upright and the slenderness angle
DIVIDED, DIVISIONS = 60, 7  #: then the interval that holds the angle, again and again
ON_A_FLOOR = (
    "on a floor, whose nearly harmonic motion does not follow the η of Eq. (3.6) at other damping ratios"
)
SOURCE = MethodSource(work="ASCE/SEI 43-05, Appendix A", standing=SourceStanding.DERIVED)


@dataclass(frozen=True, kw_only=True)
class Slide:
    """The sliding oscillator."""

    friction: float  #: mu_e
    coefficient: float  #: c_s = 2 mu_e g [m/s2]
    period: float  #: T_es; 0 where the spectrum stays below c_s [s]

    @property
    def distance(self) -> float:
        """delta_s = c_s (T_es/2 pi)^2 [m]."""
        return self.coefficient * (self.period / (2.0 * math.pi)) ** 2


def slide(mu: float, gravity: float, action: FloorAction, *, second_component: float = 0.0) -> Slide:
    """Sliding distance: the lowest frequency at which the 10 % spectrum equals c_s = 2 mu_e g.

    Args:
        mu: coefficient of sliding friction.
        gravity: [m/s2].
        action: of the floor.
        second_component: SA_H2/SA_H1, of a second horizontal component; 0: motion in a plane.
    """
    friction = max(mu * (1.0 - VERTICAL_SHARE * action.vertical_peak / gravity), 0.0)
    coefficient = 2.0 * friction * gravity
    vector = math.sqrt(1.0 + (VERTICAL_SHARE * second_component) ** 2)

    def excess(periods: FloatArray) -> FloatArray:
        return vector * action.spectrum(periods, SLIDING_DAMPING) - coefficient

    above = np.flatnonzero(excess(PERIODS) > 0.0)
    if above.size == 0:
        return Slide(friction=friction, coefficient=coefficient, period=0.0)
    last = int(above[-1])
    if last == PERIODS.size - 1:  # still above at the longest period of the spectrum
        return Slide(friction=friction, coefficient=coefficient, period=math.inf)
    low, high = float(PERIODS[last]), float(PERIODS[last + 1])
    return Slide(friction=friction, coefficient=coefficient, period=_crossing(excess, low, high))


@dataclass(frozen=True, kw_only=True)
class RockingOscillator:
    """The rocking block as an oscillator whose period depends on the angle."""

    block: RigidBlock

    @property
    def inertia_factor(self) -> float:
        """C_I = I_O/(M h^2)."""
        return self.block.inertia_ratio * (self.block.radius / self.block.centroid_height) ** 2

    @property
    def damping(self) -> float:
        """beta_e, of the energy lost at impacts by Housner's restitution."""
        loss = -2.0 * math.log(max(self.block.housner_restitution, 1e-6))
        return loss / math.sqrt(4.0 * math.pi**2 + loss**2)

    def capacity(self, angles: FloatArray) -> FloatArray:
        """SAH_CAP, spectral acceleration that the body resists at an angle, without the vertical [m/s2]."""
        slenderness = self.block.half_width / self.block.centroid_height
        return (
            2.0
            * self.block.gravity
            * self._work(angles)
            / (np.sin(angles) + slenderness * (1.0 - np.cos(angles)))
        )

    def period(self, angles: FloatArray) -> FloatArray:
        """T_e at an angle [s]."""
        stiffness = 2.0 * self.block.gravity * self._work(angles)
        return 2.0 * math.pi * angles * np.sqrt(self.inertia_factor * self.block.centroid_height / stiffness)

    def angle(self, spectrum: Spectrum, vertical: Spectrum | None = None) -> float | None:
        """The smallest stable angle at which capacity and demand are equal; None: it overturns [rad].

        Args:
            spectrum: elastic, horizontal.
            vertical: elastic; it reduces the capacity by F_V = sqrt(1 + (b/h SA_V/SA_H)^2); None: F_V = 1.
        """
        slenderness = self.block.half_width / self.block.centroid_height

        def excess(angles: FloatArray) -> FloatArray:
            periods = self.period(angles)
            demand = spectrum(periods, self.damping)
            if vertical is not None:
                demand = np.hypot(demand, slenderness * vertical(periods, self.damping))
            return demand - self.capacity(angles)

        top = self.block.slenderness_angle
        angles = np.geomspace(1e-4 * top, top, ANGLES)
        above = excess(angles) > 0.0
        if not above.any():
            return 0.0
        falls = np.flatnonzero(above[:-1] & ~above[1:])
        if falls.size == 0:
            return None
        return _crossing(excess, float(angles[falls[0]]), float(angles[falls[0] + 1]))

    def _work(self, angles: FloatArray) -> FloatArray:
        """f_1: work to tilt the body, over m g h."""
        slenderness = self.block.half_width / self.block.centroid_height
        return np.cos(angles) + slenderness * np.sin(angles) - 1.0


def sliding_row(body: LooseBody, limits: Limits, action: FloorAction) -> MethodRow:
    """Sliding distance, under the vector spectrum where there are two components, against the slip allowed."""
    both = action.second_component
    slipped = slide(body.mu_kinetic, body.block.gravity, action, second_component=both)
    vector = math.sqrt(1.0 + (VERTICAL_SHARE * both) ** 2)
    components = f"two horizontal components, F_H = {vector:.4g}" if both else "motion in a plane"
    words = "does not slide" if slipped.period == 0.0 else f"slides {length_in_words(slipped.distance)}"
    return MethodRow(
        name="ASCE/SEI 43 approximate sliding",
        quantity=MethodQuantity.SLIP,
        formula="δ_s = c_s (T_es/2π)², c_s = 2 μ_k (1 − 0.4 a_v/g) g",
        numbers=f"c_s = 2 × {slipped.friction:.4g} × {body.block.gravity:g} = {slipped.coefficient:.4g} m/s²; "
        + ("10 % spectrum below c_s" if slipped.period == 0.0 else f"T_es = {slipped.period:.4g} s"),
        demand=slipped.distance,
        capacity=limits.slip,
        unit="m",
        says=words if math.isfinite(slipped.distance) else "slides further than the spectrum shows",
        source=SOURCE,
        validity=f"meant to be conservative; one friction coefficient, the kinetic one; {components}",
        beyond=ON_A_FLOOR if action.in_building else "",
    )


def rocking_row(body: LooseBody, limits: Limits, action: FloorAction, *, vertical: bool) -> MethodRow:
    """Largest rotation against the rotation that is allowed."""
    oscillator, alpha = RockingOscillator(block=body.block), body.block.slenderness_angle
    angle = oscillator.angle(action.spectrum, action.vertical_spectrum if vertical else None)
    starts = action.peak > body.block.uplift_acceleration
    if angle is None:
        words, put_in = "overturns", "no angle below the slenderness angle at which they are equal"
    else:
        share = f"{angle / alpha:.3g} of the slenderness angle"
        words = f"rotates {share}" if starts else f"does not uplift; once it rocks, {share}"
        period = float(oscillator.period(np.array([max(angle, 1e-9)]))[0])
        held = float(oscillator.capacity(np.array([max(angle, 1e-9)]))[0])
        put_in = (
            f"θ = {angle:.4g} rad, T_e = {period:.4g} s, β_e = {oscillator.damping:.4g}, "
            f"2 g f_1/f_2 = {held:.4g} m/s²"
        )
    return MethodRow(
        name=f"ASCE/SEI 43 approximate rocking{', with the vertical' if vertical else ''}",
        quantity=MethodQuantity.OVERTURNING,
        formula="S_a(T_e(θ), β_e) = 2 g f_1(θ)/(F_V f_2(θ))"
        if vertical
        else "S_a(T_e(θ), β_e) = 2 g f_1(θ)/f_2(θ)",
        numbers=put_in,
        demand=math.inf if angle is None else angle,
        capacity=limits.rotation * alpha,
        unit="rad",
        says=words,
        source=SOURCE,
        validity="a rocking body is no oscillator (Makris and Konstantinidis 2003); found not always conservative "
        "against time histories",
        beyond=ON_A_FLOOR if action.in_building else "",
    )


def _crossing(excess: Callable[[FloatArray], FloatArray], low: float, high: float) -> float:
    """The first argument between two at which a function falls through zero; each pass divides what is left."""
    for _ in range(DIVISIONS):
        arguments = np.linspace(low, high, DIVIDED)
        first = int(np.argmax(excess(arguments) <= 0.0))
        low, high = float(arguments[first - 1]), float(arguments[first])
    return 0.5 * (low + high)
