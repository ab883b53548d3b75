"""What the floor amounts to, in words for `check`, the summary and the page."""

from fem.results.run_result import FloorNumbers
from fem.runtime.units import FEW, MANY, in_figures

KILONEWTON = ("kN", 1e-3)
LEAST = 0.1  #: of a number in a unit, before a smaller unit is taken


def floor_rows(floor: FloorNumbers | None) -> list[tuple[str, str]]:
    """Name and value in everyday units; empty for a rigid, level floor."""
    if floor is None:
        return []
    rows = [("slab", _material(floor)), ("corner", _springs(floor)), ("crushes at", _cap(floor))]
    rows.append(("turns about", _pivot(floor)))
    if floor.slope_percent:
        side = "right (+x)" if floor.slope_percent > 0.0 else "left (-x)"
        rows.append(("slope", f"{abs(floor.slope_percent):g} %, it falls to the {side}"))
    rows.append(("one impact", _hit(floor)))
    return [(name, value) for name, value in rows if value]


def drawn_level(slope_percent: float) -> str:
    """The note beside a drawing of a sloping floor, which is drawn level; empty for a level floor."""
    if not slope_percent:
        return ""
    return f"the floor falls {abs(slope_percent):g} % to the {'right' if slope_percent > 0.0 else 'left'}, drawn level"


def _material(floor: FloorNumbers) -> str:
    modulus, strength = floor.youngs_modulus_Pa, floor.bearing_strength_Pa
    if modulus is None or strength is None:
        return ""
    name = f"{floor.preset}: " if floor.preset else ""
    return (
        f"{name}E = {_in_units(modulus, ('GPa', 1e-9), ('MPa', 1e-6))}, nu = {floor.poisson_ratio:g}, strength "
        f"{_in_units(strength, ('MPa', 1e-6), ('kPa', 1e-3))}"
    )


def _springs(floor: FloorNumbers) -> str:
    stiffness, sinks, bounces = (
        floor.corner_stiffness_N_m,
        floor.static_indentation_m,
        floor.contact_frequency_Hz,
    )
    if floor.corner_patch_m is None or stiffness is None or sinks is None or bounces is None:
        return ""
    patch = " x ".join(f"{side:g}" for side in floor.corner_patch_m)
    return (
        f"{patch} m: {_in_units(stiffness, ('kN/mm', 1e-6))}, contact frequency {_in_units(bounces, ('Hz', 1.0))}, "
        f"sinks in by {_in_units(sinks, ('mm', 1e3), ('um', 1e6))} at rest"
    )


def _cap(floor: FloorNumbers) -> str:
    cap, times, bearing = floor.corner_cap_N, floor.cap_over_weight, floor.bearing_capacity_N
    if cap is None or times is None or bearing is None:
        return ""
    other = ""
    if floor.governs == "container":
        other = f", where the steel above it yields; the floor bears {_in_units(bearing, KILONEWTON)}"
    elif floor.steel_capacity_N is not None:
        other = f"; the steel above it yields at {_in_units(floor.steel_capacity_N, KILONEWTON)}"
    return f"{_in_units(cap, KILONEWTON)} a corner at its surface, {in_figures(times, FEW)} times the weight{other}"


def _pivot(floor: FloorNumbers) -> str:
    inset = floor.pivot_inset_m
    if not inset:
        return ""
    where = _in_units(inset, ("mm", 1e3))
    return f"points {where} inside the edges of what touches: under the edge itself the floor gives way"


def _hit(floor: FloorNumbers) -> str:
    ratio, speed, crushing = floor.hit_rotation_ratio, floor.closing_speed_m_s, floor.crushing_per_hit_m
    if ratio is None or speed is None or crushing is None:
        return ""
    gives = "crush the corner" if crushing else "crush nothing"
    return f"back from {ratio:g} of the slenderness angle it would strike at {in_figures(speed, FEW)} m/s and {gives}"


def _in_units(value: float, *units: tuple[str, float]) -> str:
    """Four figures in the first of the units, largest first, in which the number is not small."""
    name, factor = next(((name, factor) for name, factor in units if value * factor >= LEAST), units[-1])
    return f"{in_figures(value, MANY, factor)} {name}"
