"""The simplified methods: static rules, Housner's velocity, Newmark's block; and the factor that each allows.

Static rules take the peak, the plateau, or the code's force on an element as a static force at the mass centre.
Overturning is a h/((g - a_v) b) with the height h of the mass centre and the half width b, sliding is
a/(mu (g - a_v)) with static friction. EN 1998-1:2004, 4.4.2.4 (1)P asks for the equilibrium.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from fem.seismic.body import FloorAction, LooseBody, MethodQuantity, MethodRow, derived, length_in_words

#: shares of the horizontal and vertical peak: by itself, two of EN 1998-1:2004, 4.3.3.5.2, and both at once, more than
#: that clause asks for
COMBINATIONS = ((1.0, 0.0), (1.0, 0.3), (1.0, 1.0), (0.3, 1.0))
ACROSS = 0.3  #: share of the other horizontal component, EN 1998-1:2004, 4.3.3.5.1 (3)
ELEMENT_BEHAVIOUR_FACTOR = 1.0  #: q_a: no row of table 4.4 is for an unanchored body
SMALL_RATIO = 0.17  #: of yield to peak acceleration, below which Newmark's slip is its bound
SMALLEST_FACTOR, LARGEST_FACTOR = 0.01, 100.0  #: factors on the action between which a capacity is looked for
BISECTIONS = 30
#: a method, or methods that share their numbers, for one body: action of its floor -> rows
Method = Callable[[FloorAction], Sequence[MethodRow]]

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
    return _rows(
        f"plateau of the design spectrum, q = {behaviour_factor:g}",
        body,
        "2.5 a_g S/q",
        acceleration=2.5 * action.ground_peak / behaviour_factor,
        put_in=f"2.5 × {action.ground_peak:.4g} / {behaviour_factor:g}",
        source=PLATEAU,
        validity="elastic buildings on the ground; an unanchored body has no period and no behaviour factor",
        beyond="that of the ground; the container stands on a floor above it" if height_ratio > 0.0 else "",
    )


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
    beyond: str = "",
) -> list[MethodRow]:
    """Overturning and sliding under a static acceleration [m/s2], `lift` reducing gravity."""
    block = body.block
    gravity, less, less_put_in = max(block.gravity - lift, 0.0), "g", f"{block.gravity:g}"
    if lift_put_in:
        less, less_put_in = "(g − m a_v)", f"({block.gravity:g} − {lift_put_in})"
    stands = f"{block.half_width:.4g} / {block.centroid_height:.4g}", body.slenderness, ("stands", "uplifts")
    keeps = f"{body.mu_static:.4g}", body.mu_static, ("does not slide", "slides")
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
            beyond=beyond,
        )
        for quantity, resistance, (numbers, share, words) in (
            (MethodQuantity.OVERTURNING, "b/h", stands),
            (MethodQuantity.SLIDING, "μ_s", keeps),
        )
    ]


def _says(demand: float, capacity: float, within: str, beyond: str) -> str:
    return within if demand <= capacity and math.isfinite(demand) else beyond


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


def methods_of(
    body: LooseBody, slip_limit: float, *, behaviour_factor: float, height_ratio: float | None = 0.0
) -> list[Method]:
    """Every method but the wind, for one body on one floor.

    Args:
        slip_limit: the clearance [m].
        behaviour_factor: q of the plateau of the design spectrum; q = 1 stands beside it.
        height_ratio: z/H of the floor in its building; 0: on the ground; None: the motion of the floor is given, which
            no formula for elements on floors may raise again, and to which the plateau of the ground says nothing.
    """
    methods: list[Method] = [
        partial(peak_rows, body, horizontal=horizontal, vertical=vertical)
        for horizontal, vertical in COMBINATIONS
    ]
    methods.append(partial(both_directions_rows, body))
    if height_ratio is not None:
        methods += [
            partial(element_rows, body, height_ratio=height_ratio, period_ratio=period_ratio)
            for period_ratio in ((0.0, 1.0) if height_ratio else (0.0,))
        ]
        methods += [
            partial(plateau_rows, body, behaviour_factor=q, height_ratio=height_ratio)
            for q in sorted({behaviour_factor, 1.0})[::-1]
        ]
    return [*methods, lambda action: [housner_row(body, action), newmark_row(body, slip_limit, action)]]


def rows_with_factors(methods: Sequence[Method], action: FloorAction) -> list[tuple[MethodRow, float]]:
    """The rows of all methods, each with the factor on the action at which its utilisation reaches 1.

    A method that is fulfilled under a motion is fulfilled under a weaker one, so bisection finds it. The factor is
    `SMALLEST_FACTOR` where a method is used up by less, `LARGEST_FACTOR` where not by that.
    """
    return [(row, _factor(method, k, action)) for method in methods for k, row in enumerate(method(action))]


def _factor(method: Method, row: int, action: FloorAction) -> float:
    def fulfilled(factor: float) -> bool:
        return method(action.scaled(factor))[row].fulfilled

    low, high = SMALLEST_FACTOR, LARGEST_FACTOR
    if not fulfilled(low):
        return low
    if fulfilled(high):
        return high
    for _ in range(BISECTIONS):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if fulfilled(middle) else (low, middle)
    return (low * high) ** 0.5
