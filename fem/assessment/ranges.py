"""A number in words with its range over the band: the one place that writes such numbers.

Where the range is wider than a tenth, number and ends have two significant figures; more would not be known.
"""

import math
from collections.abc import Sequence

from fem.results.run_result import Band, JointDemand, Numerics, RunResult, Verdict

Reach = tuple[float, float]

WIDE = 0.1  #: width of a range over its larger end, from which two figures are enough
FEW, MANY = 2, 4  #: significant figures
IMPACT = "impact, not for design unless the floor is known"
#: .. of a floor that crushes, whose strength and stiffness nothing has varied
UNTRIED = "impact; the band tries other floors (--band)"
#: limits below which only they are shown: lengths [m], rotation ratios [-], rotations [degrees]
LEAST_LENGTH, LEAST_RATIO = 1e-5, 1e-3
LEAST_DEGREES = 0.01
RATIO_FIGURES = 3  #: of a rotation ratio whose range is narrow


def with_range(
    value: float | None,
    reach: Reach | None,
    unit: str = "",
    *,
    factor: float = 1.0,
    least: float = 0.0,
    many: int = MANY,
) -> str:
    """A number with its range and unit, such as "0.22 (0.0013 to 0.40)"; empty where there is none.

    Args:
        value: of the run; in SI.
        reach: its [low, high] over the band; None: the number alone.
        unit: as printed.
        factor: from SI to this unit.
        least: sizes below it [SI] are shown as that limit.
        many: figures of a number whose range is narrow.
    """
    if value is None:
        return ""
    figures = figures_of(reach, many)
    low, high = (in_figures(end, figures, factor, least) for end in reach or (value, value))
    shown = in_figures(value, figures, factor, least)
    words = shown if low == high else f"{shown} ({low} to {high})"
    return f"{words} {unit}".rstrip()


def signed_with_range(
    value: float | None, reach: Reach | None, unit: str, *, factor: float, least: float, many: int = MANY
) -> str:
    """A number whose sign means something: where it changes over the band, only its largest size is known."""
    if value is None or reach is None or not reach[0] < 0.0 < reach[1] or max(map(abs, reach)) <= least:
        return with_range(value, reach, unit, factor=factor, least=least, many=many)
    return f"about zero, up to {in_figures(max(map(abs, reach)), FEW, factor, least)} {unit}".rstrip()


def figures_of(reach: Reach | None, many: int = MANY) -> int:
    """Significant figures that a number of such a range has."""
    if reach is None:
        return many
    largest = max(map(abs, reach))
    return FEW if reach[1] - reach[0] > WIDE * largest else many


def in_figures(value: float, figures: int, factor: float = 1.0, least: float = 0.0) -> str:
    """A number with so many significant figures, without an exponent where it has at most six digits."""
    if 0.0 < abs(value) < least:
        return f"< {factor * least:g}"
    shown = factor * value
    if shown == 0.0:
        return "0"
    digits = figures - 1 - math.floor(math.log10(abs(float(f"{shown:.{figures - 1}e}"))))
    if not -4 <= digits - figures + 1 <= 5 and abs(shown) < 1e-4:
        return f"{shown:.{figures - 1}e}"
    words = f"{round(shown, digits):.{max(digits, 0)}f}"
    return words.rstrip("0").rstrip(".") if figures == MANY and "." in words else words


def reach_of(verdict: Verdict, name: str) -> Reach | None:
    """The range of a figure of the verdict over its band."""
    found: Reach | None = getattr(verdict.band or Band(), name)
    return found


def impact_note(verdict: Verdict) -> str:
    """What is said behind a force or stress that an impact decides; nothing where the band has tried the floor."""
    if not verdict.impacts or (crushes(verdict) and verdict.band is not None):
        return ""
    return f"; {UNTRIED if crushes(verdict) else IMPACT}"


def crushes(verdict: Verdict) -> bool:
    """Whether the run is on a floor that crushes."""
    return verdict.max_indentation_m is not None


def of_band(verdict: Verdict, name: str, unit: str, factor: float = 1.0, least: float = 0.0) -> str:
    """A figure of the verdict with its range."""
    return with_range(getattr(verdict, name), reach_of(verdict, name), unit, factor=factor, least=least)


def mean_over(value: float | None, window: float | None) -> str:
    """Of a mean over a window [s]: the instantaneous value in an impact means nothing."""
    return "" if value is None or window is None else f", mean over {1e3 * window:.2g} ms"


def largest_slip(verdict: Verdict) -> str:
    """The largest slip with its range."""
    return of_band(verdict, "max_slip_m", "mm", 1e3, LEAST_LENGTH)


def residual_slip(verdict: Verdict) -> str:
    """The slip at the end, signed, with its range."""
    reach = reach_of(verdict, "residual_slip_m")
    return signed_with_range(verdict.residual_slip_m, reach, "mm", factor=1e3, least=LEAST_LENGTH)


def corner_force(verdict: Verdict, numerics: Numerics) -> str:
    """The largest force of a corner, with its range and its window."""
    if verdict.max_corner_force_N is None:
        return ""
    force = of_band(verdict, "max_corner_force_N", "kN", 1e-3)
    return f"{force}{mean_over(verdict.max_corner_force_N, numerics.corner_force_window_s)}{impact_note(verdict)}"


def contents_acceleration(verdict: Verdict, numerics: Numerics) -> str:
    """The largest acceleration of the contents, with its range and its filter; former versions took a mean."""
    found, cutoff = of_band(verdict, "max_acceleration_m_s2", "m/s2"), numerics.contents_filter_Hz
    if not found:
        return ""
    window = mean_over(verdict.max_acceleration_m_s2, numerics.acceleration_window_s)
    return f"{found}{window if cutoff is None else f', low-pass {cutoff:g} Hz'}{impact_note(verdict)}"


def largest_stress(verdict: Verdict) -> str:
    """Beyond yield an elastic stress is no stress of the container."""
    stress, limit = of_band(verdict, "max_von_mises_Pa", "MPa", 1e-6), verdict.yield_strength_Pa
    reach = reach_of(verdict, "max_von_mises_Pa")
    if (
        verdict.max_von_mises_Pa is None
        or limit is None
        or max(reach or (0.0,)) <= limit >= verdict.max_von_mises_Pa
    ):
        return f"{stress}{impact_note(verdict)}" if stress else ""
    beyond = verdict.max_von_mises_Pa > limit
    where = "beyond yield" if beyond else "beyond yield within the band"
    plastic = f"; {words}" if beyond and (words := plastic_corner(verdict)) else ""
    return f"{where} ({1e-6 * limit:g} MPa); the shell stays elastic and has {stress}{plastic}{impact_note(verdict)}"


def plastic_corner(verdict: Verdict) -> str:
    """What a corner that yields as a whole would take of the impacts; empty where it has no capacity."""
    capacity, force, work = verdict.corner_capacity_N, verdict.max_corner_force_N, verdict.plastic_work_J
    if capacity is None or force is None or work is None:
        return ""
    yields = f"the wall over a corner yields at {in_figures(capacity, 3, 1e-3)} kN"
    if work == 0.0:
        return f"{yields}, more than the largest corner force, so a rigid-plastic corner would take no work"
    return (
        f"{yields}; a rigid-plastic corner would take {in_figures(work, 2)} J there, "
        f"{in_figures(work / capacity, 2, 1e3)} mm of crushing"
    )


def largest_bolt_forces(joints: Sequence[JointDemand]) -> tuple[float, float]:
    """Largest tension along an edge, of all joints and both sides, and largest shear [N]."""
    tension = max(max(one.bolt_tension_left_N, one.bolt_tension_right_N) for one in joints)
    return tension, max(one.bolt_shear_N for one in joints)


def bolt_forces(result: RunResult) -> str:
    """The largest of all joints."""
    if not result.joints:
        return ""
    verdict = result.verdict or Verdict()
    tension, shear = largest_bolt_forces(result.joints)
    found = (
        with_range(value, reach_of(verdict, name), "kN", factor=1e-3)
        for value, name in ((tension, "bolt_tension_N"), (shear, "bolt_shear_N"))
    )
    return f"{', '.join(found)}{impact_note(verdict)}"


def rotation_in_words(verdict: Verdict) -> str:
    """The largest rotation, and over the slenderness angle with its range."""
    if verdict.max_rotation_rad is None or verdict.rotation_ratio is None:
        return ""
    return f"{largest_rotation(verdict)}, {rotation_ratio(verdict)} of the slenderness angle"


def largest_rotation(verdict: Verdict) -> str:
    """The largest rotation alone, with the figures that the range of its ratio leaves."""
    if verdict.max_rotation_rad is None:
        return ""
    figures = figures_of(reach_of(verdict, "rotation_ratio"), RATIO_FIGURES)
    return f"{in_figures(math.degrees(verdict.max_rotation_rad), figures, least=LEAST_DEGREES)} degrees"


def largest_uplift(verdict: Verdict) -> str:
    """The largest uplift with its range."""
    return of_band(verdict, "max_uplift_m", "mm", 1e3, LEAST_LENGTH)


def indentation(verdict: Verdict) -> str:
    """The largest permanent indentation of the floor with its range."""
    return of_band(verdict, "max_indentation_m", "mm", 1e3, LEAST_LENGTH)


def rotation_ratio(verdict: Verdict) -> str:
    """The largest rotation over the slenderness angle, with its range."""
    reach = reach_of(verdict, "rotation_ratio")
    return with_range(verdict.rotation_ratio, reach, least=LEAST_RATIO, many=RATIO_FIGURES)
