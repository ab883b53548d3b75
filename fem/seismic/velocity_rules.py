"""Rules that ask for the velocity, the displacement or the energy of a motion to overturn a body.

Most are for homogeneous rectangles: their widths and heights are those of the rectangle with the same half width of
the support and the same height of the mass centre. Units inside the empirical rules are cm and cm/s2, as published.
"""

import math
from functools import partial

from scipy.special import ndtr

from fem.seismic.body import FloorAction, LooseBody
from fem.seismic.method import MethodQuantity, MethodRow, MethodSource, SourceStanding

SPREAD = 0.5  #: logarithmic standard deviation of Kaneko and Hayashi's curve
CONTENTS_SHARE = 0.790  #: of Kaneko and Hayashi's velocity, in FEMA P-58
#: of the width: displacement at which a body overturns, at two thirds of its height
ULTIMATE_SHARE = 2.0 / 3.0
ALLOWED_SHARE = 0.5  #: of that displacement

_row = partial(MethodRow, quantity=MethodQuantity.OVERTURNING)


def velocity_rows(body: LooseBody, action: FloorAction) -> list[MethodRow]:
    """Housner, velocity step, Ishiyama, Kaneko and Hayashi, contents of FEMA P-58, displacement."""
    return [
        housner_row(body, action),
        velocity_step_row(body, action),
        ishiyama_row(body, action),
        kaneko_hayashi_row(body, action),
        contents_row(body, action),
        displacement_row(body, action),
    ]


def housner_row(body: LooseBody, action: FloorAction) -> MethodRow:
    """Spectral velocity at which about half of random motions overturn a slender body."""
    block, velocity = body.block, action.spectral_velocity
    capacity = block.slenderness_angle * block.gravity / block.frequency_parameter
    return _row(
        "Housner, spectral velocity",
        "S_v ≤ α g/p",
        f"{velocity:.4g} ≤ {block.slenderness_angle:.4g} × {block.gravity:g} / {block.frequency_parameter:.4g}",
        velocity,
        capacity,
        "m/s",
        f"{'less' if velocity < capacity else 'more'} than half of such motions overturn it",
        MethodSource(work="Housner (1963)", standing=SourceStanding.DERIVED),
        "slender body, random motion with a constant velocity spectrum; about 50 % overturn at 1: no limit state",
        median=True,
        beyond="on a floor: its spectrum of velocity is not constant" if action.in_building else "",
    )


def velocity_step(body: LooseBody) -> float:
    """Step of the floor's velocity that just overturns the body, without slip [m/s].

    Angular momentum about the corner, then energy: dV = sqrt(2 g R (1 - cos alpha) I_O/(M R^2))/cos alpha.
    """
    block = body.block
    return math.sqrt(2.0 * block.overturning_energy * block.inertia_ratio) / math.cos(block.slenderness_angle)


def velocity_step_row(body: LooseBody, action: FloorAction) -> MethodRow:
    """Peak velocity against the step that overturns."""
    block, capacity = body.block, velocity_step(body)
    lift = 1.0 - math.cos(block.slenderness_angle)
    return _row(
        "velocity step (West)",
        "PGV ≤ √(2 g R (1 − cos α) I_O/(M R²))/cos α",
        f"{action.peak_velocity:.4g} ≤ √(2 × {block.gravity:g} × {block.radius:.4g} × {lift:.4g} × "
        f"{block.inertia_ratio:.4g}) / {math.cos(block.slenderness_angle):.4g}",
        action.peak_velocity,
        capacity,
        "m/s",
        "stands" if action.peak_velocity <= capacity else "overturns",
        MethodSource(work="energy and angular momentum of a block", standing=SourceStanding.DERIVED),
        "one pulse, no slip; more pulses need less",
    )


def ishiyama_row(body: LooseBody, action: FloorAction) -> MethodRow:
    """Overturning needs both an acceleration and a velocity: the smaller of the two ratios counts."""
    width, height = _rectangle_cm(body)
    needed = body.block.uplift_acceleration, 0.1 * width / math.sqrt(height)
    by_velocity = action.peak_velocity * needed[0] <= action.peak * needed[1]
    demand, capacity = (action.peak_velocity, needed[1]) if by_velocity else (action.peak, needed[0])
    return _row(
        "Ishiyama, acceleration and velocity",
        "a ≤ g B/H or v ≤ 10 B/√H (cm, cm/s)",
        f"{action.peak:.4g} m/s² to {needed[0]:.4g} m/s²; {100.0 * action.peak_velocity:.4g} cm/s to 10 × "
        f"{width:.4g} / √{height:.4g} = {100.0 * needed[1]:.4g} cm/s",
        demand,
        capacity,
        "m/s" if by_velocity else "m/s²",
        "stands" if demand <= capacity else "may overturn",
        MethodSource(work="Ishiyama (1982)", standing=SourceStanding.UNCHECKED),
        "rectangle, no slip; lower bounds, both of which must be exceeded",
    )


def kaneko_hayashi_row(body: LooseBody, action: FloorAction) -> MethodRow:
    """Median acceleration of overturning of furniture, and the share that overturns."""
    width, height = _rectangle_cm(body)
    ratio, peak, velocity = width / height, 100.0 * action.peak, 100.0 * action.peak_velocity
    frequency = peak / (2.0 * math.pi * velocity) if velocity > 0.0 else math.inf
    bound = 15.6 / math.sqrt(height) * (1.0 + ratio) ** -1.5
    if frequency <= bound:
        median, put_in = ratio * 980.0 * (1.0 + ratio), f"{ratio:.4g} × 980 × {1.0 + ratio:.4g}"
    else:
        median = 10.0 * width / math.sqrt(height) * (1.0 + ratio) ** 2.5 * 2.0 * math.pi * frequency
        put_in = f"10 × {width:.4g} / √{height:.4g} × {1.0 + ratio:.4g}^2.5 × 2π × {frequency:.4g}"
    share = float(ndtr(math.log(peak / median) / SPREAD)) if 0.0 < median < math.inf and peak > 0.0 else 0.0
    return _row(
        "Kaneko and Hayashi, furniture",
        "A_50 = 980 (B/H) (1 + B/H), F_e ≤ F_b; else 10 B/√H (1 + B/H)^2.5 2π F_e (cm, cm/s²)",
        f"{peak:.4g} ≤ {put_in} = {median:.4g} cm/s²; F_e = {frequency:.4g} Hz, F_b = {bound:.4g} Hz",
        0.01 * peak,
        0.01 * median,
        "m/s²",
        f"{100.0 * share:.2g} % overturn",
        MethodSource(work="Kaneko and Hayashi (2004)", standing=SourceStanding.UNCHECKED),
        "furniture on floors, slip included in the data; half of them overturn at 1",
        median=True,
    )


def contents_velocity(width: float, height: float) -> float:
    """Median peak velocity of the floor at which unanchored contents fall over [m/s].

    Kaneko and Hayashi's velocity 10 B/sqrt(H) (1 + B/H)^2.5 (cm, cm/s) times 0.790, which fits the medians of the nine
    bookcases and file cabinets of FEMA P-58 within 5 %.

    Args:
        width, height: of a rectangle [m].
    """
    wide, high = 100.0 * width, 100.0 * height
    return 0.01 * CONTENTS_SHARE * 10.0 * wide / math.sqrt(high) * (1.0 + wide / high) ** 2.5


def contents_row(body: LooseBody, action: FloorAction) -> MethodRow:
    """Median velocity at which bookcases and file cabinets fall over, and the share that does."""
    width, height = (0.01 * length for length in _rectangle_cm(body))
    capacity, velocity = contents_velocity(width, height), action.peak_velocity
    share = float(ndtr(math.log(velocity / capacity) / SPREAD)) if velocity > 0.0 else 0.0
    return _row(
        "FEMA P-58, unanchored contents",
        "PGV ≤ 0.79 × 10 B/√H (1 + B/H)^2.5 (cm, cm/s)",
        f"{100.0 * velocity:.4g} ≤ 0.79 × 10 × {100.0 * width:.4g} / √{100.0 * height:.4g} × "
        f"{1.0 + width / height:.4g}^2.5 = {100.0 * capacity:.4g} cm/s",
        velocity,
        capacity,
        "m/s",
        f"{100.0 * share:.2g} % overturn",
        MethodSource(work="the medians of nine contents in FEMA P-58", standing=SourceStanding.DERIVED),
        "bookcases and file cabinets 0.6 to 2.1 m high; half of them overturn at 1, with a dispersion of 0.5",
        median=True,
    )


def displacement_row(body: LooseBody, action: FloorAction) -> MethodRow:
    """Largest spectral displacement against half of the displacement that overturns."""
    width, demand = 2.0 * body.block.half_width, action.spectral_displacement
    capacity = ALLOWED_SHARE * ULTIMATE_SHARE * width
    return _row(
        "displacement rule",
        "S_d ≤ 0.5 (2/3 B)",
        f"{demand:.4g} ≤ 0.5 × 2 / 3 × {width:.4g}",
        demand,
        capacity,
        "m",
        "stands" if demand <= capacity else "may overturn",
        MethodSource(work="Al Abadi, Lam and Gad (2006)", standing=SourceStanding.UNCHECKED),
        "slender body; displacement at two thirds of the height, up to 4 s",
    )


def _rectangle_cm(body: LooseBody) -> tuple[float, float]:
    """Width and height [cm] of the rectangle on this support with this mass centre."""
    return 200.0 * body.block.half_width, 200.0 * body.block.centroid_height
