"""Two rules beside the static ones: Housner's velocity for a body that rocks, Newmark's block for one that slides."""

import math

from fem.seismic.body import FloorAction, LooseBody
from fem.seismic.method import MethodQuantity, MethodRow, derived, length_in_words

SMALL_RATIO = 0.17  #: of yield to peak acceleration, below which Newmark's slip is its bound


def housner_row(body: LooseBody, action: FloorAction) -> MethodRow:
    """Spectral velocity at which about half of random motions overturn a slender body."""
    block, velocity = body.block, action.spectral_velocity
    capacity = block.slenderness_angle * block.gravity / block.frequency_parameter
    return MethodRow(
        name="Housner, spectral velocity",
        quantity=MethodQuantity.OVERTURNING,
        formula="S_v ≤ α g/p",
        numbers=f"{velocity:.4g} ≤ {block.slenderness_angle:.4g} × {block.gravity:g} / {block.frequency_parameter:.4g}",
        demand=velocity,
        capacity=capacity,
        unit="m/s",
        says=f"{'less' if velocity < capacity else 'more'} than half of such motions overturn it",
        source=derived("Housner (1963)"),
        validity="slender body, random motion with a constant velocity spectrum; about 50 % overturn at 1: no limit "
        "state",
        median=True,
        beyond="on a floor: its spectrum of velocity is not constant" if action.in_building else "",
    )


def newmark_slip(ratio: float, peak: float, velocity: float) -> float:
    """Newmark (1965): V^2/(2 a_y) (1 - r)/r; the bound 6 V^2/(2 a_y) below r = 0.17 [m].

    Args:
        ratio: r = a_y/a_max, a_y = mu_k g; peak: a_max [m/s2]; velocity: V, the peak [m/s].
    """
    length = velocity**2 / (2.0 * ratio * peak)
    return 6.0 * length if ratio < SMALL_RATIO else length * (1.0 - ratio) / ratio


def newmark_row(body: LooseBody, slip_limit: float, action: FloorAction) -> MethodRow:
    """The slip of a sliding block by the peaks of the motion, against the slip that is allowed [m].

    Made for slip in one direction, on a slope; on a level floor slip goes both ways.
    """
    ratio = body.mu_kinetic * body.block.gravity / action.peak if action.peak > 0.0 else math.inf
    slides = ratio < 1.0 and action.peak_velocity > 0.0
    slip = newmark_slip(ratio, action.peak, action.peak_velocity) if slides else 0.0
    return MethodRow(
        name="Newmark (1965)",
        quantity=MethodQuantity.SLIP,
        formula="V²/(2 a_y) (1 − r)/r; 6 V²/(2 a_y) for r < 0.17",
        numbers=f"r = {body.mu_kinetic:.4g} × {body.block.gravity:g} / {action.peak:.4g} = {ratio:.4g}, "
        f"A = {action.peak:.4g} m/s², V = {action.peak_velocity:.4g} m/s",
        demand=slip,
        capacity=slip_limit,
        unit="m",
        says=f"slides {length_in_words(slip)}" if slides else "does not slide",
        source="Newmark (1965)",
        validity="upper bound; slip in one direction on a slope, one friction coefficient",
        beyond="on a floor: it was made of ground motions" if action.in_building else "",
    )
