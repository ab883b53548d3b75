"""The figures of a run in words, each with its range over the band and with what belongs to it."""

from collections.abc import Sequence

from fem.results.figures import FIGURES, SLIPPED, TURNED, Place
from fem.results.run_result import Band, JointDemand, Numerics, RunResult, StaticResult, Verdict
from fem.run.words import sentence
from fem.runtime.units import FEW, KILONEWTONS, Reach, figures_of

IMPACT = "impact, not for design unless the floor is known"
#: note for a floor that crushes, whose strength and stiffness nothing has varied
UNTRIED = "impact; the band tries other floors (--band)"


def in_words(result: RunResult, key: str) -> str:
    """A figure of the verdict for the summary; empty where there is none."""
    verdict, numerics, figure = result.verdict or Verdict(), result.numerics or Numerics(), FIGURES[key]
    return sentence(
        "figure.txt.j2",
        key=key,
        figure=figure,
        verdict=verdict,
        of_band=of_band,
        reach_of=reach_of,
        largest_rotation=largest_rotation(verdict),
        largest_ratio=of_band(verdict, TURNED),
        housner=(result.static or StaticResult()).housner_restitution,
        cutoff=numerics[figure.cutoff] if figure.cutoff else None,
        window=numerics[figure.window] if figure.window else None,
        plastic_corner=plastic_corner(verdict),
        impact_note=impact_note(verdict),
    )


def of_band(verdict: Verdict, key: str) -> str:
    """A figure of the verdict with its range, without one in two figures; empty where there is none."""
    figure, reach = FIGURES[key], reach_of(verdict, key)
    few = FEW if reach is None and Place.BAND in figure.places and not figure.unit.whole else None
    return figure.unit.text(getattr(verdict, key), reach, figures=few)


def reach_of(verdict: Verdict, key: str) -> Reach | None:
    """The range of a figure of the verdict over its band."""
    reach: Reach | None = getattr(verdict.band or Band(), key)
    return reach


def impact_note(verdict: Verdict) -> str:
    """The caution after a force or stress that an impact decides; empty if the band has varied the floor."""
    if not verdict.impacts or (crushes(verdict) and verdict.band is not None):
        return ""
    return f"; {UNTRIED if crushes(verdict) else IMPACT}"


def crushes(verdict: Verdict) -> bool:
    """True if the floor of the run crushes."""
    return verdict.max_indentation_m is not None


def largest_slip(verdict: Verdict) -> str:
    """The largest slip with its range."""
    return of_band(verdict, SLIPPED)


def largest_rotation(verdict: Verdict) -> str:
    """The largest rotation alone, with the figures that the range of its ratio leaves."""
    figure = FIGURES["max_rotation_rad"]
    reach = reach_of(verdict, TURNED)
    figures = FEW if reach is None else figures_of(reach, figure.unit.figures)
    return figure.unit.text(verdict.max_rotation_rad, figures=figures)


def plastic_corner(verdict: Verdict) -> str:
    """The work that a corner yielding as a whole would absorb; empty if its capacity is not known."""
    capacity, force, work = verdict.corner_capacity_N, verdict.max_corner_force_N, verdict.plastic_work_J
    if capacity is None or force is None or work is None:
        return ""
    yields = f"the steel above a corner yields at {KILONEWTONS.text(capacity, figures=3)}"
    if work == 0.0:
        return f"{yields}, more than the largest corner force, so a rigid-plastic corner would take no work"
    return f"{yields}, less than the largest corner force: as a whole it would yield"


def largest_bolt_forces(joints: Sequence[JointDemand]) -> tuple[float, float]:
    """Largest tension along an edge, of all joints and both sides, and largest shear [N]."""
    tension = max(max(joint.bolt_tension_left_N, joint.bolt_tension_right_N) for joint in joints)
    return tension, max(joint.bolt_shear_N for joint in joints)


def bolt_forces(result: RunResult) -> str:
    """The largest of all joints."""
    if not result.joints:
        return ""
    verdict = result.verdict or Verdict()
    pairs = zip(largest_bolt_forces(result.joints), ("bolt_tension_N", "bolt_shear_N"), strict=True)
    reaches = ((value, FIGURES[key], reach_of(verdict, key)) for value, key in pairs)
    words = ", ".join(
        figure.unit.text(value, reach, figures=FEW if reach is None else None)
        for value, figure, reach in reaches
    )
    return f"{words}{impact_note(verdict)}"
