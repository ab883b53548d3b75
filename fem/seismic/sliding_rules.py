"""Regressions of the sliding distance on a rigid floor, from the peaks of a motion.

They are for slip in one direction on a slope: r = a_y/a_max with a_y = mu_k g. On a level floor slip goes both ways.
Constants after Meehan and Vahedifard (2013); Newmark, Richards and Elms, Whitman and Liao as commonly printed.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from fem.records.units import STANDARD_GRAVITY
from fem.seismic.body import FloorAction, Limits, LooseBody
from fem.seismic.method import MethodQuantity, MethodRow, MethodSource, SourceStanding, length_in_words

#: ratio a_y/a_max, peak acceleration [m/s2], peak velocity [m/s] -> slip [m]
Regression = Callable[[float, float, float], float]


def newmark(ratio: float, peak: float, velocity: float) -> float:
    """Newmark (1965): V^2/(2 a_y) (1 - r)/r; the bound 6 V^2/(2 a_y) below r = 0.17 [m]."""
    length = velocity**2 / (2.0 * ratio * peak)
    return 6.0 * length if ratio < 0.17 else length * (1.0 - ratio) / ratio


def richards_elms(ratio: float, peak: float, velocity: float) -> float:
    """Richards and Elms (1979): 0.087 V^2/A r^-4 [m]."""
    return 0.087 * velocity**2 / peak * ratio**-4


def whitman_liao(ratio: float, peak: float, velocity: float) -> float:
    """Whitman and Liao (1985): 37 V^2/A exp(-9.4 r) [m]."""
    return 37.0 * velocity**2 / peak * math.exp(-9.4 * ratio)


def ambraseys_menu(ratio: float, _peak: float, _velocity: float) -> float:
    """Ambraseys and Menu (1988): 10^0.90 (1 - r)^2.53 r^-1.09 cm [m]."""
    return 0.01 * 10.0**0.90 * (1.0 - ratio) ** 2.53 * ratio**-1.09


def jibson(ratio: float, _peak: float, _velocity: float) -> float:
    """Jibson (2007): 10^0.215 (1 - r)^2.341 r^-1.438 cm [m]."""
    return 0.01 * 10.0**0.215 * (1.0 - ratio) ** 2.341 * ratio**-1.438


def saygili_rathje(ratio: float, peak: float, velocity: float) -> float:
    """Saygili and Rathje (2008), with PGA in g and PGV in cm/s [m]."""
    shape = -1.56 - 4.58 * ratio - 20.84 * ratio**2 + 44.75 * ratio**3 - 30.50 * ratio**4
    strength = -0.64 * math.log(peak / STANDARD_GRAVITY) + 1.55 * math.log(100.0 * velocity)
    return 0.01 * math.exp(shape + strength)


@dataclass(frozen=True, kw_only=True)
class SlidingRule:
    """One regression, as published."""

    name: str
    formula: str
    slip: Regression
    validity: str
    median: bool = False
    least_ratio: float = 0.0  #: r, from which it holds


RULES = (
    SlidingRule(
        name="Newmark (1965)",
        formula="V²/(2 a_y) (1 − r)/r; 6 V²/(2 a_y) for r < 0.17",
        slip=newmark,
        validity="upper bound",
    ),
    SlidingRule(
        name="Richards and Elms (1979)",
        formula="0.087 V²/A r^−4",
        slip=richards_elms,
        validity="r above 0.3",
        least_ratio=0.3,
    ),
    SlidingRule(
        name="Whitman and Liao (1985)",
        formula="37 V²/A exp(−9.4 r)",
        slip=whitman_liao,
        validity="mean",
        median=True,
    ),
    SlidingRule(
        name="Ambraseys and Menu (1988)",
        formula="10^0.90 (1 − r)^2.53 r^−1.09 cm",
        slip=ambraseys_menu,
        validity="median; knows r alone",
        median=True,
    ),
    SlidingRule(
        name="Jibson (2007)",
        formula="10^0.215 (1 − r)^2.341 r^−1.438 cm",
        slip=jibson,
        validity="median; knows r alone",
        median=True,
    ),
    SlidingRule(
        name="Saygili and Rathje (2008)",
        formula="exp(−1.56 − 4.58 r − 20.84 r² + 44.75 r³ − 30.50 r⁴ − 0.64 ln A + 1.55 ln V) cm",
        slip=saygili_rathje,
        validity="median; A in g, V in cm/s",
        median=True,
    ),
)


def sliding_rows(body: LooseBody, limits: Limits, action: FloorAction) -> list[MethodRow]:
    """The slip by each regression, against the slip that is allowed."""
    return [_row(rule, body, limits, action) for rule in RULES]


def _row(rule: SlidingRule, body: LooseBody, limits: Limits, action: FloorAction) -> MethodRow:
    ratio = body.mu_kinetic * body.block.gravity / action.peak if action.peak > 0.0 else math.inf
    slides = ratio < 1.0 and action.peak_velocity > 0.0
    beyond = ""
    if action.in_building:
        beyond = "on a floor: it was made of ground motions"
    elif slides and ratio < rule.least_ratio:
        beyond = f"r = {ratio:.2g}: it holds from {rule.least_ratio:g} on"
    slip = rule.slip(ratio, action.peak, action.peak_velocity) if slides else 0.0
    return MethodRow(
        name=rule.name,
        quantity=MethodQuantity.SLIP,
        formula=rule.formula,
        numbers=f"r = {body.mu_kinetic:.4g} × {body.block.gravity:g} / {action.peak:.4g} = {ratio:.4g}, "
        f"A = {action.peak:.4g} m/s², V = {action.peak_velocity:.4g} m/s",
        demand=slip,
        capacity=limits.slip,
        unit="m",
        says=f"slides {length_in_words(slip)}" if slides else "does not slide",
        source=MethodSource(work=rule.name, standing=SourceStanding.LITERATURE),
        validity=f"{rule.validity}; slip in one direction on a slope, one friction coefficient",
        median=rule.median,
        beyond=beyond,
    )
