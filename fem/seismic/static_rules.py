"""Static rules: the peak, the plateau, or the code's force on an element, as a static force at the mass centre.

Overturning is a h/((g - a_v) b) with the height h of the mass centre and the half width b, sliding is
a/(mu (g - a_v)) with static friction. EN 1998-1:2004, 4.4.2.4 (1)P asks for the equilibrium.
"""

import math
from dataclasses import replace

from fem.seismic.body import FloorAction, LooseBody
from fem.seismic.method import MethodQuantity, MethodRow, derived

#: shares of the horizontal and vertical peak: by itself, two of EN 1998-1:2004, 4.3.3.5.2, and both at once, more than
#: that clause asks for
COMBINATIONS = ((1.0, 0.0), (1.0, 0.3), (1.0, 1.0), (0.3, 1.0))
ACROSS = 0.3  #: share of the other horizontal component, EN 1998-1:2004, 4.3.3.5.1 (3)
ELEMENT_BEHAVIOUR_FACTOR = 1.0  #: q_a: no row of table 4.4 is for an unanchored body

PEAK = derived("EN 1998-1:2004, 4.4.2.4 (1)P, with the peak as a static force")
COMBINED = derived("EN 1998-1:2004, 4.4.2.4 (1)P and 4.3.3.5.2, with the peak as a static force")
DIRECTIONS = derived("EN 1998-1:2004, 4.4.2.4 (1)P and 4.3.3.5.1, with the peak as a static force")
#: no clause gives a loose body the plateau and the behaviour factor of a building
PLATEAU = derived("EN 1998-1:2004, 4.4.2.4 (1)P, 4.3.3.2.2 and 3.2.2.5 (4)P, Eq. (3.14)")
ELEMENT = "EN 1998-1:2004, 4.3.5.2, Eqs. (4.24) and (4.25)"


def peak_rows(body: LooseBody, action: FloorAction, *, horizontal: float, vertical: float) -> list[MethodRow]:
    """The peaks of the floor, times shares of the two components, as static forces."""
    return _rows(
        f"static rule, {horizontal:g} horizontal, {vertical:g} vertical",
        body,
        "λ a",
        acceleration=horizontal * action.peak,
        put_in=f"{horizontal:g} × {action.peak:.4g}",
        lift=vertical * action.vertical_peak,
        lift_put_in=f"{vertical:g} × {action.vertical_peak:.4g}",
        source=COMBINED if 0.3 in (horizontal, vertical) else PEAK,
        validity="at rest before uplift or slip; treats the instantaneous peak as a sustained force",
    )


def both_directions_rows(body: LooseBody, action: FloorAction) -> list[MethodRow]:
    """The peak along the width and 30 % of it along the depth, at once, without the vertical component.

    A rigid box on a rectangular base tilts about one edge or the other: the components do not add up there. In friction
    they do, as vectors.
    """
    block, across = body.block, 0.5 * body.depth
    resultant = math.hypot(1.0, ACROSS) * action.peak
    edges = {"width": (1.0, block.half_width), "depth": (ACROSS, across)}
    share, half = max(edges.values(), key=lambda edge: edge[0] / edge[1])
    overturning, sliding = _rows(
        f"static rule, 1 along and {ACROSS:g} across",
        body,
        "λ a",
        acceleration=share * action.peak,
        put_in=f"{share:g} × {action.peak:.4g}",
        source=DIRECTIONS,
        validity="rest before uplift or slip; each edge of the base by itself, friction under the vector of both",
    )
    capacity = block.gravity * half / block.centroid_height
    return [
        replace(
            overturning,
            numbers=f"{share:g} × {action.peak:.4g} ≤ {block.gravity:g} × {half:.4g} / {block.centroid_height:.4g}",
            capacity=capacity,
            says=_says(overturning.demand, capacity, "stands", "uplifts"),
        ),
        replace(
            sliding,
            formula="a √(1² + 0.3²) ≤ g μ_s",
            numbers=f"{action.peak:.4g} × √(1 + {ACROSS:g}²) ≤ {block.gravity:g} × {body.mu_static:.4g}",
            demand=resultant,
            says=_says(resultant, sliding.capacity, "does not slide", "slides"),
        ),
    ]


def plateau_rows(
    body: LooseBody, action: FloorAction, *, behaviour_factor: float, height_ratio: float = 0.0
) -> list[MethodRow]:
    """The plateau of the design spectrum of the ground, 2.5 a_g S/q, without the vertical component.

    On the floor of a building, `height_ratio` above 0, it is out of its range: it is no action of that floor.
    """
    rows = _rows(
        f"plateau of the design spectrum, q = {behaviour_factor:g}",
        body,
        "2.5 a_g S/q",
        acceleration=2.5 * action.ground_peak / behaviour_factor,
        put_in=f"2.5 × {action.ground_peak:.4g} / {behaviour_factor:g}",
        source=PLATEAU,
        validity="elastic buildings on the ground; an unanchored body has no period and no behaviour factor",
    )
    if height_ratio > 0.0:
        rows = [
            replace(row, beyond="that of the ground; the container stands on a floor above it")
            for row in rows
        ]
    return rows


def floor_factor(height_ratio: float, period_ratio: float) -> float:
    """Acceleration of an element over a_g S, EN 1998-1:2004, 4.3.5.2, Eq. (4.25) [-].

    Args:
        height_ratio: z/H, of the floor over the building's height above the foundation.
        period_ratio: T_a/T_1, of the element over that of the building.
    """
    return max(3.0 * (1.0 + height_ratio) / (1.0 + (1.0 - period_ratio) ** 2) - 0.5, 1.0)


def element_rows(
    body: LooseBody, action: FloorAction, *, height_ratio: float, period_ratio: float
) -> list[MethodRow]:
    """The force on a non-structural element, with q_a = 1."""
    factor = floor_factor(height_ratio, period_ratio)
    return _rows(
        f"element on a floor, z/H = {height_ratio:g}, T_a/T_1 = {period_ratio:g}",
        body,
        "a_g S max(3 (1 + z/H)/(1 + (1 − T_a/T_1)²) − 0.5, 1)/q_a",
        acceleration=factor * action.ground_peak / ELEMENT_BEHAVIOUR_FACTOR,
        put_in=f"{action.ground_peak:.4g} × {factor:.4g} / {ELEMENT_BEHAVIOUR_FACTOR:g}",
        source=ELEMENT,
        validity="non-structural elements; not for elements of a particularly dangerous nature, which need a "
        "model of the building (4.3.5.1 (2)P); no q_a for an unanchored body: 1",
    )


def _rows(
    name: str,
    body: LooseBody,
    symbol: str,
    *,
    acceleration: float,
    put_in: str,
    source: str,
    validity: str,
    lift: float = 0.0,
    lift_put_in: str = "",
) -> list[MethodRow]:
    """Overturning and sliding under a static acceleration [m/s2], `lift` reducing gravity."""
    block = body.block
    gravity, less, less_put_in = max(block.gravity - lift, 0.0), "g", f"{block.gravity:g}"
    if lift_put_in:
        less, less_put_in = "(g − m a_v)", f"({block.gravity:g} − {lift_put_in})"
    sides = f"{block.half_width:.4g} / {block.centroid_height:.4g}"
    return [
        MethodRow(
            name=name,
            quantity=quantity,
            formula=f"{symbol} ≤ {less} {resistance}",
            numbers=f"{put_in} ≤ {less_put_in} × {numbers}",
            demand=acceleration,
            capacity=gravity * share,
            unit="m/s²",
            says=_says(acceleration, gravity * share, *words),
            source=source,
            validity=validity,
        )
        for quantity, resistance, numbers, share, words in (
            (MethodQuantity.OVERTURNING, "b/h", sides, body.slenderness, ("stands", "uplifts")),
            (
                MethodQuantity.SLIDING,
                "μ_s",
                f"{body.mu_static:.4g}",
                body.mu_static,
                ("does not slide", "slides"),
            ),
        )
    ]


def _says(demand: float, capacity: float, within: str, beyond: str) -> str:
    return within if demand <= capacity and math.isfinite(demand) else beyond
