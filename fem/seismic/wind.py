"""Wind on an unanchored stack: EN 1991-1-4 with the partial factors of EN 1990 for equilibrium.

The wind acts along the width on a face of depth times height. Wind and earthquake are not combined: psi_2 of wind is 0
(EN 1990:2002, table A1.1 with Eq. (6.12b)).
"""

import math
from typing import Any

import numpy as np

from fem.seismic.body import LooseBody, MethodQuantity, MethodRow

AIR_DENSITY = 1.25  #: [kg/m3]
STABILISING, DESTABILISING = 0.9, 1.5  #: of permanent weight and of wind, EN 1990, table A1.2(A), EQU
LOW = 15.0  #: height up to which c_s c_d = 1, EN 1991-1-4, 6.2 (1) a) [m]
#: category -> roughness length z_0 and least height z_min [m], EN 1991-1-4, table 4.1
TERRAIN = {"0": (0.003, 1.0), "I": (0.01, 1.0), "II": (0.05, 2.0), "III": (0.3, 5.0), "IV": (1.0, 10.0)}
#: force coefficient of a rectangle over depth along the wind to width across it, EN 1991-1-4, figure 7.23
DEPTH_RATIOS = (0.1, 0.2, 0.6, 0.7, 1.0, 2.0, 5.0, 10.0)
FORCE_COEFFICIENTS = (2.0, 2.0, 2.35, 2.4, 2.1, 1.65, 1.0, 0.9)
#: of a cylinder, the largest of EN 1991-1-4, figure 7.28: rough surfaces and small Reynolds numbers
ROUND_COEFFICIENT = 1.2
#: end-effect factor of a solid face over the effective slenderness, EN 1991-1-4, figure 7.36
SLENDERNESSES, END_EFFECTS = (1.0, 10.0, 70.0), (0.60, 0.698, 0.918)
GERMAN_HEIGHTS = (10.0, 18.0, 25.0)  #: Germany: heights [m] up to which the simplified pressures hold
#: (zone, place) -> pressures at those heights [Pa]
GERMAN_PRESSURES = {
    (1, "inland"): (500.0, 650.0, 750.0),
    (2, "inland"): (650.0, 800.0, 900.0),
    (2, "coast"): (850.0, 1000.0, 1100.0),
    (3, "inland"): (800.0, 950.0, 1100.0),
    (3, "coast"): (1050.0, 1200.0, 1300.0),
    (4, "inland"): (950.0, 1150.0, 1300.0),
    (4, "coast"): (1250.0, 1400.0, 1550.0),
    (4, "North Sea islands"): (1400.0,),
}
COMBINATION = "Wind and earthquake are not combined: psi_2 of wind is 0 (EN 1990:2002, table A1.1)."
SOURCE = "EN 1991-1-4:2005, 7.6, with EN 1990:2002, table A1.2(A), EQU"


def terrain_pressure(*, category: str, basic_velocity: float, height: float) -> float:
    """Peak velocity pressure [Pa], EN 1991-1-4, 4.3 to 4.5, with flat ground and k_I = 1.

    Args:
        category: of the terrain, "0" to "IV".
        basic_velocity: v_b [m/s].
        height: above the ground [m].

    Raises:
        ValueError: an unknown category.
    """
    if category not in TERRAIN:
        raise ValueError(f"terrain category must be one of {', '.join(TERRAIN)}, got {category!r}")
    roughness, least = TERRAIN[category]
    logarithm = math.log(max(height, least) / roughness)
    mean_velocity = 0.19 * (roughness / 0.05) ** 0.07 * logarithm * basic_velocity
    return (1.0 + 7.0 / logarithm) * 0.5 * AIR_DENSITY * mean_velocity**2


def german_pressure(*, zone: int, place: str, height: float) -> float:
    """Simplified peak velocity pressure up to 25 m [Pa], as manufacturers print it for DIN EN 1991-1-4/NA.

    Args:
        zone: of the wind, 1 to 4.
        place: "inland", "coast" (zone 2 and 3: Baltic coast and islands; zone 4: coasts and Baltic islands)
            or "North Sea islands".
        height: of the building or body above the ground [m].

    Raises:
        ValueError: no such zone and place, or higher than the pressures hold.
    """
    pressures = GERMAN_PRESSURES.get((zone, place))
    if pressures is None:
        raise ValueError(f"no simplified wind pressure for zone {zone}, {place!r}")
    for limit, pressure in zip(GERMAN_HEIGHTS, pressures, strict=False):
        if height <= limit:
            return pressure
    highest = GERMAN_HEIGHTS[len(pressures) - 1]
    raise ValueError(f"the simplified wind pressures hold up to {highest:g} m there, got {height:g} m")


def pressure_of(wind: Any, height: float) -> tuple[float, str]:
    """Peak velocity pressure of a table [wind] at a height [m]: [Pa], and where it comes from.

    Raises:
        ValueError: the simplified pressures do not hold there.
    """
    if wind.terrain is not None:
        velocity = wind.basic_velocity_m_s or 0.0
        pressure = terrain_pressure(category=wind.terrain, basic_velocity=velocity, height=height)
        return pressure, f"EN 1991-1-4:2005, terrain {wind.terrain}, v_b = {velocity:g} m/s"
    if wind.german_zone is not None:
        pressure = german_pressure(zone=wind.german_zone, place=wind.german_place, height=height)
        return pressure, f"simplified German pressure, zone {wind.german_zone}, {wind.german_place}"
    return wind.peak_velocity_pressure_Pa or 0.0, "given"


def wind_force(body: LooseBody, pressure: float) -> tuple[float, float, float]:
    """Wind along the width on a sharp-edged prism or an upright cylinder, EN 1991-1-4, 7.6 and 7.9, up to 15 m high.

    Returns:
        Force coefficient c_f, area of the face [m2], and the characteristic force at mid height [N].

    Raises:
        ValueError: higher than 15 m, where c_s c_d = 1 does not hold.
    """
    if body.height > LOW:
        raise ValueError(f"the wind row is for bodies up to {LOW:g} m, got {body.height:g} m")
    ratio, slenderness = body.width / body.depth, min(2.0 * body.height / body.depth, 70.0)
    base = float(np.interp(math.log(ratio), np.log(DEPTH_RATIOS), FORCE_COEFFICIENTS))
    if body.round:
        base = ROUND_COEFFICIENT
    end = np.interp(math.log(slenderness), np.log(SLENDERNESSES), END_EFFECTS)
    coefficient, area = float(base * end), body.depth * body.height
    return coefficient, area, coefficient * area * pressure


def wind_rows(body: LooseBody, pressure: float, *, gamma_mu: float = 1.0) -> list[MethodRow]:
    """Overturning and sliding of a body under wind: pass the empty stack.

    Args:
        pressure: q_p [Pa].
        gamma_mu: partial factor on friction; the rule of equilibrium has none, 1.3 is usual for scaffolds.
    """
    coefficient, area, characteristic = wind_force(body, pressure)
    force, weight, half = DESTABILISING * characteristic, STABILISING * body.weight, body.block.half_width
    put_in = f"1.5 × {coefficient:.4g} × {pressure:.4g} × {area:.4g}"
    edges = "a cylinder, the largest c_f,0" if body.round else "sharp edges"
    validity = f"{edges}, up to 15 m; characteristic wind; not combined with the earthquake"
    moment, sliding = 0.5 * force * body.height, weight * body.mu_static / gamma_mu
    return [
        MethodRow(
            name="wind",
            quantity=MethodQuantity.OVERTURNING,
            formula="1.5 c_f q_p A H/2 ≤ 0.9 G b",
            numbers=f"{put_in} × {body.height:.4g} / 2 ≤ 0.9 × {body.weight:.5g} × {half:.4g}",
            demand=moment,
            capacity=weight * half,
            unit="N m",
            says="stands" if moment <= weight * half else "overturns",
            source=SOURCE,
            validity=validity,
        ),
        MethodRow(
            name="wind",
            quantity=MethodQuantity.SLIDING,
            formula="1.5 c_f q_p A ≤ 0.9 G μ_s/γ_μ",
            numbers=f"{put_in} ≤ 0.9 × {body.weight:.5g} × {body.mu_static:.4g} / {gamma_mu:g}",
            demand=force,
            capacity=sliding,
            unit="N",
            says="does not slide" if force <= sliding else "slides",
            source=SOURCE,
            validity=f"{validity}; γ_μ = {gamma_mu:g} is this program's input, 1.3 is usual for scaffolds",
        ),
    ]
