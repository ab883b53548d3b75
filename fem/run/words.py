"""The words of a run: templates of `fem/html/templates` that read like what is said, and figures with their ranges.

A blank line ends a text; other white space counts as one space. Behind a line that ends in a tag, whose newline is not
set, it takes two. A figure of the verdict stands with its range over the band, and with what belongs to it.
"""

import re
from collections.abc import Sequence
from typing import Any

from fem.case.tables.unknown_inputs import in_words
from fem.html.page import text_of
from fem.results.figures import FIGURES, TURNED, Place
from fem.results.outcome import SLIDING, Outcome
from fem.results.run_result import Band, JointDemand, Numerics, RunResult, StaticResult, Verdict
from fem.runtime import units
from fem.runtime.units import FEW, KILONEWTONS, Reach, figures_of

IMPACT = "impact, not for design unless the floor is known"
#: note for a floor that crushes, whose strength and stiffness nothing has varied
UNTRIED = "impact; the band tries other floors (--band)"


def _parts(text: str) -> list[str]:
    return [words for part in re.split(r"\n\s*\n", text) if (words := " ".join(part.split()))]


#: what every template may name; `listed` joins the texts of a macro
NAMED: dict[str, Any] = {
    "units": units,
    "in_words": in_words,
    "Outcome": Outcome,
    "SLIDING": SLIDING,
    "listed": lambda text: "; ".join(_parts(text)),
}


def paragraphs(template: str, macro: str = "", **shown: Any) -> list[str]:
    """The texts of a template, or of one of its macros, that are not empty."""
    return _parts(text_of(template, macro, **NAMED, **shown))


def sentence(template: str, macro: str = "", **shown: Any) -> str:
    """All that a template or one of its macros says; empty where it says nothing."""
    return " ".join(paragraphs(template, macro, **shown))


def rows(template: str, macro: str = "", **shown: Any) -> list[tuple[str, str]]:
    """Name and value of each row of a template, or of one of its macros: `name | value`; none without a value."""
    pairs = (text.partition("|") for text in paragraphs(template, macro, **shown))
    return [(name.strip(), value.strip()) for name, _, value in pairs if value.strip()]


def figure_in_words(result: RunResult, key: str) -> str:
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
    """The caution after a force or stress that an impact decides; empty if the band has varied a floor that crushes."""
    crushes = verdict.max_indentation_m is not None
    if not verdict.impacts or (crushes and verdict.band is not None):
        return ""
    return f"; {UNTRIED if crushes else IMPACT}"


def largest_rotation(verdict: Verdict) -> str:
    """The largest rotation alone, with the figures that the range of its ratio leaves."""
    unit, reach = FIGURES["max_rotation_rad"].unit, reach_of(verdict, TURNED)
    return unit.text(
        verdict.max_rotation_rad, figures=FEW if reach is None else figures_of(reach, unit.figures)
    )


def plastic_corner(verdict: Verdict) -> str:
    """The work that a corner yielding as a whole would absorb; empty if its capacity is not known."""
    capacity, force, work = verdict.corner_capacity_N, verdict.max_corner_force_N, verdict.plastic_work_J
    if capacity is None or force is None or work is None:
        return ""
    yields = f"the steel above a corner yields at {KILONEWTONS.text(capacity, figures=3)}"
    if work == 0.0 and max(reach_of(verdict, "max_corner_force_N") or (0.0,)) > capacity:
        return f"{yields}, less than the largest corner force of a variation: there it would yield as a whole"
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
    verdict, said = result.verdict or Verdict(), []
    for value, key in zip(
        largest_bolt_forces(result.joints), ("bolt_tension_N", "bolt_shear_N"), strict=True
    ):
        reach = reach_of(verdict, key)
        said.append(FIGURES[key].unit.text(value, reach, figures=FEW if reach is None else None))
    return f"{', '.join(said)}{impact_note(verdict)}"
