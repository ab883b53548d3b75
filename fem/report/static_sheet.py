"""The static calculation of a report: every line a formula, the same with the numbers put in, the result, the clause.

It can be redone with a pocket calculator: the numbers put in are those printed, and give the printed result
to its last figure but one. The formulas are those of `fem.model.static_checks`; the results are the run's own.
Weights in kN, moments in kNm, lengths in m.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from fem.case.case import Case
from fem.html.units import number, short
from fem.model.static_checks import (
    CLAUSE_APPLICABLE,
    CLAUSE_OVERTURNING,
    CLAUSE_SLIDING,
    LIMIT_PERIOD,
)

PAPER = "seed paper"
CODE_SHEAR = "EN 1998-1:2004, 4.3.3.2.2 (1)P, Eq. (4.5), with 3.2.2.5 (4)P, Eq. (3.14), λ = 1"


@dataclass(frozen=True, kw_only=True)
class Line:
    """One step of the calculation."""

    name: str
    formula: Markup  #: in symbols, with what it is on the left
    numbers: str  #: the right side with numbers in it; a calculator's language with × · √ ²
    value: float  #: in `unit`
    unit: str
    source: str = ""
    verdict: str = ""  #: what the static rule says of a utilisation

    @property
    def result(self) -> str:
        """The value as printed."""
        return number(self.value)


def static_sheet(result: Mapping[str, Any], case: Case) -> list[tuple[str, list[Line]]]:
    """The calculation in groups: title and lines.

    Args:
        result: the keys of `run.json`; `static` is needed.
        case: resolved.
    """
    static = result["static"]
    return [
        ("Container", _container_lines(static, case)),
        ("Static rule under this run's own peak floor acceleration", _own_motion_lines(static, case)),
        (
            "Design base shear of the code, for the reader who has to deal with it (not compared with the run)",
            _code_lines(static, case),
        ),
        ("What follows from the mass alone", _mass_lines(static, case)),
    ]


def _container_lines(static: Mapping[str, Any], case: Case) -> list[Line]:
    box, weight = case.container, static["weight_N"] / 1e3
    count, height, centroid = box.boxes, short(box.height_m), short(box.centroid_m)
    lines = [
        Line(
            name="weight with fill",
            formula=Markup("<i>G</i> = <i>n</i> <i>G</i><sub>box</sub>"),
            numbers=f"{count} × {short(weight / count, figures=6)}",
            value=weight,
            unit="kN",
            source=f"n = {count} {'boxes, bolted' if count > 1 else 'box'}",
        ),
        Line(
            name="mass",
            formula=Markup("<i>m</i> = <i>G</i>/<i>g</i>"),
            numbers=f"{number(weight)} / {short(case.gravity_m_s2)}",
            value=weight / case.gravity_m_s2,
            unit="t",
        ),
    ]
    if box.mesh_file is None:
        lines.append(
            Line(
                name="height of the mass centre",
                formula=Markup("<i>z</i><sub>c</sub> = (<i>n</i> − 1) <i>c</i>/2 + <i>z</i><sub>box</sub>"),
                numbers=f"({count} − 1) × {height} / 2 + {centroid}",
                value=static["centroid_m"],
                unit="m",
                source="c, height of a box; the last, of the mass centre in it",
            )
        )
    lines.append(
        Line(
            name="slenderness angle, from the vertical",
            formula=Markup("<i>α</i> = arctan(<i>a</i>/2/<i>z</i><sub>c</sub>)"),
            numbers=f"arctan({short(box.width_m)} / 2 / {number(static['centroid_m'])})",
            value=math.degrees(static["slenderness_angle_rad"]),
            unit="°",
            source=f"a, width of the base; 90° minus the {PAPER}'s α",
        )
    )
    return lines


def _own_motion_lines(static: Mapping[str, Any], case: Case) -> list[Line]:
    own = static["own_motion"]
    mass = static["weight_N"] / case.gravity_m_s2
    peak = own["base_shear_N"] / mass
    lines = []
    if case.motion.kind == "harmonic" and math.isclose(
        peak, case.nominal_peak_acceleration or 0.0, rel_tol=1e-6
    ):
        amplitude, omega = case.amplitude, case.angular_frequency
        lines.append(
            Line(
                name="largest floor acceleration of this run",
                formula=Markup("<i>a</i><sub>max</sub> = <i>A</i> <i>Ω</i>²"),
                numbers=f"{number(amplitude, 1.0, 5)} × {number(omega, 1.0, 5)}²",
                value=peak,
                unit="m/s²",
                source="x = A sin(Ωt + φ)",
            )
        )
    force = own["base_shear_N"] / 1e3
    lines.append(
        Line(
            name="base shear",
            formula=Markup("<i>F</i> = <i>m</i> <i>a</i><sub>max</sub>"),
            numbers=f"{number(mass / 1e3)} × {number(peak)}",
            value=force,
            unit="kN",
            source="" if lines else "largest |acceleration| of the floor within the run",
        )
    )
    return lines + _utilisations(static, own, case, "F")


def _code_lines(static: Mapping[str, Any], case: Case) -> list[Line]:
    rule = case.static
    mass = static["weight_N"] / case.gravity_m_s2 / 1e3
    lines = []
    for key, factor in (("code", rule.behaviour_factor), ("code_q1", 1.0)):
        if key == "code_q1" and rule.behaviour_factor == 1.0:
            continue
        lines.append(
            Line(
                name=f"base shear on the plateau, q = {short(factor)}",
                formula=Markup(
                    "<i>F</i><sub>b</sub> = <i>m</i> <i>γ</i><sub>I</sub> <i>a</i><sub>gR</sub> <i>S</i> 2.5/<i>q</i>"
                ),
                numbers=(
                    f"{number(mass)} × {short(rule.importance_factor)} × {short(rule.ground_acceleration_m_s2)} × "
                    f"{short(rule.soil_factor)} × 2.5 / {short(factor)}"
                ),
                value=static[key]["base_shear_N"] / 1e3,
                unit="kN",
                source=CODE_SHEAR,
            )
        )
        lines += _utilisations(static, static[key], case, "F_b")
    arm = math.hypot(0.5 * case.container.width_m, static["centroid_m"])
    lines.append(
        Line(
            name="rocking period, against the limit of the method",
            formula=Markup("<i>T</i> = 2π √(4 <i>R</i>/(3 <i>g</i>))"),
            numbers=f"2 × π × √(4 × {number(arm)} / (3 × {short(case.gravity_m_s2)}))",
            value=static["period_eq3_s"],
            unit="s",
            source=Markup(
                "{}, Eq. (3); limit min(4 <i>T</i><sub>C</sub>, {} s) with <i>T</i><sub>C</sub> = {} s, {} a), "
                "Eq. (4.4)"
            ).format(PAPER, f"{LIMIT_PERIOD:.1f}", short(case.static.corner_period_s), CLAUSE_APPLICABLE),
            verdict="applies" if static["method_applicable"] else "does not apply",
        )
    )
    return lines


def _utilisations(
    static: Mapping[str, Any], action: Mapping[str, Any], case: Case, symbol: str
) -> list[Line]:
    weight, force = static["weight_N"] / 1e3, action["base_shear_N"] / 1e3
    limit, moment = static["sliding_limit_static_N"] / 1e3, action["tilting_moment_Nm"] / 1e3
    restoring = static["restoring_moment_Nm"] / 1e3
    F = Markup("<i>F</i><sub>b</sub>") if symbol == "F_b" else Markup("<i>F</i>")
    lines = []
    if action["utilisation_sliding"] is not None:
        lines.append(
            Line(
                name="utilisation, sliding",
                formula=F + Markup("/(<i>μ</i><sub>s</sub> <i>G</i>)"),
                numbers=f"{number(force)} / ({short(case.contact.mu_static)} × {number(weight)})",
                value=action["utilisation_sliding"],
                unit="",
                source=f"{CLAUSE_SLIDING}; capacity {number(limit)} kN",
                verdict="slides" if action["utilisation_sliding"] > 1.0 else "holds",
            )
        )
    lines.append(
        Line(
            name="utilisation, overturning",
            formula=F + Markup(" <i>z</i><sub>c</sub>/(<i>G</i> <i>a</i>/2)"),
            numbers=(
                f"{number(force)} × {number(static['centroid_m'])} / "
                f"({number(weight)} × {short(case.container.width_m)} / 2)"
            ),
            value=action["utilisation_overturning"],
            unit="",
            source=f"{CLAUSE_OVERTURNING}; {number(moment)} kNm against {number(restoring)} kNm",
            verdict="overturns" if action["utilisation_overturning"] > 1.0 else "stands",
        )
    )
    return lines


def _mass_lines(static: Mapping[str, Any], case: Case) -> list[Line]:
    arm = math.hypot(0.5 * case.container.width_m, static["centroid_m"])
    mass = static["weight_N"] / case.gravity_m_s2 / 1e3
    about_corner = static["inertia_kg_m2"] / 1e3 + mass * arm**2
    angle = number(math.degrees(static["slenderness_angle_rad"]), 1.0, 5)
    g = short(case.gravity_m_s2)
    return [
        Line(
            name="floor acceleration of uplift",
            formula=Markup("<i>a</i><sub>up</sub> = <i>g</i> tan <i>α</i>"),
            numbers=f"{g} × tan({angle}°)",
            value=static["uplift_acceleration_m_s2"],
            unit="m/s²",
            source="West (1885)",
        ),
        Line(
            name="corner to mass centre",
            formula=Markup("<i>R</i> = √((<i>a</i>/2)² + <i>z</i><sub>c</sub>²)"),
            numbers=f"√(({short(case.container.width_m)} / 2)² + {number(static['centroid_m'])}²)",
            value=arm,
            unit="m",
        ),
        Line(
            name="inertia about a corner",
            formula=Markup("<i>I</i><sub>O</sub> = <i>I</i> + <i>m</i> <i>R</i>²"),
            numbers=(
                f"{number(static['inertia_kg_m2'] / 1e3, 1.0, 5)} + "
                f"{number(mass, 1.0, 5)} × {number(arm, 1.0, 5)}²"
            ),
            value=about_corner,
            unit="t m²",
            source="I, about the mass centre, from the mesh",
        ),
        Line(
            name="frequency parameter",
            formula=Markup("<i>p</i> = √(<i>G</i> <i>R</i>/<i>I</i><sub>O</sub>)"),
            numbers=f"√({number(static['weight_N'] / 1e3)} × {number(arm)} / {number(about_corner)})",
            value=static["frequency_parameter_1_s"],
            unit="1/s",
            source="Housner (1963)",
        ),
        Line(
            name="Housner's restitution",
            formula=Markup("<i>e</i> = 1 − <i>m</i> <i>R</i>²/<i>I</i><sub>O</sub> (1 − cos 2<i>α</i>)"),
            numbers=(
                f"1 − {number(mass, 1.0, 5)} × {number(arm, 1.0, 5)}² / {number(about_corner, 1.0, 5)} × "
                f"(1 − cos(2 × {angle}°))"
            ),
            value=static["housner_restitution"],
            unit="",
            source="Housner (1963), plastic impact of a rigid block on a corner",
            verdict="credible" if static["housner_credible"] else "not credible, below 0.5",
        ),
    ]
