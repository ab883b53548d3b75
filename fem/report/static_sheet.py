"""The static calculation of a report: every line a formula, its numbers, the result, the clause.

With a pocket calculator, the numbers printed give the printed result to its last figure but one. The formulas are those
of `fem.model.static_checks`. Weights in kN, moments in kNm, lengths in m.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from markupsafe import Markup

from fem.case.case import Case
from fem.html.units import formula_markup, number, short
from fem.model.static_checks import (
    CLAUSE_APPLICABLE,
    CLAUSE_OVERTURNING,
    CLAUSE_SLIDING,
    LIMIT_PERIOD,
    ActionCheck,
    CodeChecks,
    StaticChecks,
)
from fem.run.described import rule_says

PAPER = "Knoedel and Hrabowski"


class SheetRow(NamedTuple):
    """One step of the calculation, with places for the numbers, which `_Printed` formats."""

    name: str
    formula: str  #: left side, equals sign, right side; an index after an underscore
    numbers: str  #: the right side with numbers; a calculator's language with × · √ ²
    value: str  #: which of the numbers it gives
    unit: str
    source: str = ""


WEIGHT = SheetRow("weight with fill", "G = n G_box", "{n:s4} × {G_box:s6}", "G", "kN")
MASS = SheetRow("mass", "m = G/g", "{G} / {g:s4}", "m", "t")
HEIGHT = SheetRow(
    *("height of the mass centre", "z_c = (n − 1) c/2 + z_box", "({n:s4} − 1) × {c:s4} / 2 + {z_box:s4}"),
    *("z_c", "m", "c, height of a box; the last, of the mass centre in it"),
)
ANGLE = SheetRow(
    *("slenderness angle, from the vertical", "α = arctan(a/2/z_c)", "arctan({a:s4} / 2 / {z_c})", "α", "°"),
    f"a, width of the base; 90° minus the α of {PAPER}",
)
NEARER = SheetRow(
    *("mass centre to the nearer corner, along the floor", "b = a/2 − |x_c|", "{a:s4} / 2 − {x_c}", "b", "m"),
    "a, width of the base; x_c, of the mass centre from its middle",
)
INSIDE = NEARER._replace(
    formula="b = a/2 − s − |x_c|",
    numbers="{a:s4} / 2 − {s} − {x_c}",
    source="a, width of the base; s, from its edge to where it turns; x_c, of the mass centre from its middle",
)
OFF_CENTRE = 1e-6  #: of the width, from which the mass centre is not above the middle of the base
AMPLITUDE = SheetRow(
    *("largest floor acceleration of this run", "a_max = A Ω²", "{A:5} × {Ω:5}²"),
    *("a_max", "m/s²", "x = A sin(Ωt + φ)"),
)
SHEAR = SheetRow("base shear", "F = m a_max", "{m} × {a_max}", "F", "kN")
PLATEAU = SheetRow(
    *("base shear on the plateau, q = {q:s4}", "F_b = m γ_I a_gR S 2.5/q"),
    *("{m} × {γ_I:s4} × {a_gR:s4} × {S:s4} × 2.5 / {q:s4}", "F", "kN"),
    "EN 1998-1:2004, 4.3.3.2.2 (1)P, Eq. (4.5), with 3.2.2.5 (4)P, Eq. (3.14), λ = 1",
)
SLIDING = SheetRow(
    *("utilisation, sliding", "F/(μ_s G)", "{F} / ({μ_s:s4} × {G})", "sliding", ""),
    f"{CLAUSE_SLIDING}; capacity {{F_limit}} kN",
)
ON_SLOPE = SheetRow(
    *("weight toward the floor, which slopes by θ", "G_n = G cos θ", "{G} × cos({θ}°)", "G_n", "kN"),
    "θ = arctan({slope:s4} / 100)",
)
SHEAR_ON_SLOPE = SHEAR._replace(
    formula="F = m (a_max + g sin θ)", numbers="{m} × ({a_max} + {g:s4} × sin({θ}°))"
)
LEAST_WEIGHT = SheetRow(
    *("least weight, under the vertical motion", "G_v = m (g − a_v)", "{m} × ({g:s4} − {a_v})", "G_v", "kN"),
    "a_v, largest vertical acceleration of the floor within the run",
)
OVERTURNING = SheetRow(
    *("utilisation, overturning", "F z_c/(G a/2)", "{F} × {z_c} / ({G} × {a:s4} / 2)", "overturning", ""),
    f"{CLAUSE_OVERTURNING}; {{M}} kNm against {{M_limit}} kNm",
)
PERIOD = SheetRow(
    *("rocking period, against the limit of the method", "T = 2π √(4 R/(3 g))"),
    *("2 × π × √(4 × {R} / (3 × {g:s4}))", "T", "s"),
    f"{PAPER}, Eq. (3); limit min(4 <i>T</i><sub>C</sub>, {LIMIT_PERIOD:.1f} s) with <i>T</i><sub>C</sub> = "
    f"{{T_C:s4}} s, {CLAUSE_APPLICABLE} a), Eq. (4.4)",
)
UPLIFT = SheetRow(
    *("floor acceleration of uplift", "a_up = g tan α", "{g:s4} × tan({α:5}°)", "a_up", "m/s²", "West (1885)")
)
UPLIFT_ON_SLOPE = UPLIFT._replace(
    formula="a_up = g (cos θ tan α − sin θ)", numbers="{g:s4} × (cos({θ}°) × tan({α:5}°) − sin({θ}°))"
)
UPLIFT_LEVEL = UPLIFT._replace(formula="a_up = g tan(α − θ)", numbers="{g:s4} × tan({α:5}° − {θ:5}°)")
ROCKING = (
    SheetRow("corner to mass centre", "R = √((a/2)² + z_c²)", "√(({a:s4} / 2)² + {z_c}²)", "R", "m"),
    SheetRow(
        *("inertia about a corner", "I_O = I + m R²", "{I:5} + {m:5} × {R:5}²", "I_O", "t m²"),
        "I, about the mass centre, from the mesh",
    ),
    SheetRow("frequency parameter", "p = √(G R/I_O)", "√({G} × {R} / {I_O})", "p", "1/s", "Housner (1963)"),
)
RESTITUTION = SheetRow(
    *("Housner's restitution", "e = 1 − m R²/I_O (1 − cos 2α)"),
    *("1 − {m:5} × {R:5}² / {I_O:5} × (1 − cos(2 × {α:5}°))", "e", ""),
    "Housner (1963), plastic impact of a rigid block on a corner",
)


@dataclass(frozen=True, kw_only=True)
class SheetLine:
    """One step of the calculation with its numbers, for a page."""

    name: str
    formula: Markup
    numbers: str
    value: float
    result: str  #: the value as printed
    unit: str
    source: Markup
    verdict: str  #: what the static rule says of a utilisation


class _Printed(float):
    """A number that prints itself: with four figures, with N (`:N`), or without trailing zeros (`:sN`)."""

    def __format__(self, spec: str) -> str:
        figures = int(spec.removeprefix("s") or 4)
        return short(self, figures=figures) if spec.startswith("s") else number(self, figures=figures)


Numbers = dict[str, _Printed]


def static_sheet(static: StaticChecks, case: Case) -> list[tuple[str, list[SheetLine]]]:
    """The calculation in groups: title and lines; the case is resolved."""
    numbers = _numbers(static, case)
    joints = "which move as one here" if case.container.is_loose else "bolted"
    boxes = f"n = {{n:s4}} boxes, {joints}" if case.container.boxes > 1 else "n = 1 box"
    weight, height = (WEIGHT._replace(source=boxes), MASS), [HEIGHT] * (case.container.mesh_file is None)
    if case.container.box is not None:
        g, tonnes = case.gravity_m_s2, [(1e-3 * box.mass, box) for box in case.stack]
        sum_of = " + ".join(short(1e-3 * box.mass * g, figures=6) for box in case.stack)
        weighed = WEIGHT._replace(formula="G = Σ G_i", numbers=sum_of, source="boxes from the floor up")
        weight = weighed, MASS
        moments = " + ".join(
            f"{short(mass, figures=6)} × {short(box.bottom + box.centroid, figures=6)}"
            for mass, box in tonnes
        )
        words = "z_i, of the mass centre of box i"
        sum_of = f"({moments}) / {{m:6}}"
        centre = HEIGHT._replace(formula="z_c = Σ m_i z_i/m", numbers=sum_of, source=words)
        height = [centre] if height else []
    nearer = [INSIDE if "s" in numbers else NEARER] if "b" in numbers else []
    own = numbers | _action(static.own_motion)
    swings = case.motion.kind == "harmonic" and math.isclose(
        own["a_max"], case.motion.nominal_peak or 0.0, rel_tol=1e-6
    )
    slopes = static.slope != 0.0
    largest = f"largest |acceleration| of the floor{' along itself' * slopes} within the run"
    shear = (SHEAR_ON_SLOPE if slopes else SHEAR)._replace(source="" if swings else largest)
    uplift = UPLIFT_LEVEL if case.floor.turn else UPLIFT_ON_SLOPE if slopes else UPLIFT
    credible = "credible" if static.housner_credible else "not credible, below 0.5"
    code = _code_lines(static.by_code, numbers) if static.by_code is not None else []
    return [
        ("Container", [_line(row, numbers) for row in (*weight, *height, *nearer, ANGLE)]),
        (
            "Static rule under the peak floor acceleration of this run",
            [
                *(_line(row, own) for row in ((AMPLITUDE, shear) if swings else (shear,))),
                *([_line(ON_SLOPE, own)] if slopes else []),
                *_utilisations(static.own_motion, own, "F", "G_n" if slopes else "G"),
                *_vertical_lines(static, own),
            ],
        ),
        *([("Design base shear of the code (not compared with the run)", code)] if code else []),
        (
            "What follows from the mass alone",
            [
                *(_line(row, numbers) for row in (uplift, *ROCKING)),
                _line(RESTITUTION, numbers, credible),
            ],
        ),
    ]


def _vertical_lines(static: StaticChecks, own: Numbers) -> list[SheetLine]:
    """The same rule with the least weight, where the floor moves up and down."""
    action, peak = static.own_motion_vertical, static.peak_vertical_acceleration
    if action is None or peak is None:
        return []
    least = (action.least_weight or 0.0) / 1e3
    upward = own | _action(action) | {"a_v": _Printed(peak), "G_v": _Printed(least)}
    row = LEAST_WEIGHT
    if static.slope:
        normal = row.source.replace(
            "vertical acceleration of the floor", "acceleration of the floor normal to itself"
        )
        numbers = "{m} × ({g:s4} × cos({θ}°) − {a_v})"
        row = row._replace(formula="G_v = m (g cos θ − a_v)", numbers=numbers, source=normal)
    return [_line(row, upward), *_utilisations(action, upward, "F", "G_v")]


def _code_lines(code: CodeChecks, numbers: Numbers) -> list[SheetLine]:
    """The code's base shear, and the period up to which its method applies."""
    factor, lines = code.values.behaviour_factor, []
    for q, action in {factor: code.as_given, 1.0: code.q1}.items():
        numbers_q = numbers | _action(action) | {"q": _Printed(q)}
        lines += [_line(PLATEAU, numbers_q), *_utilisations(action, numbers_q, "F_b")]
    within = "within the limit" if code.applicability.passed else "above the limit"
    return [*lines, _line(PERIOD, numbers, within)]


def _numbers(static: StaticChecks, case: Case) -> Numbers:
    """The numbers of the calculation by their symbols."""
    box, rule = case.container, case.static
    weight, mass = static.weight / 1e3, static.weight / case.gravity_m_s2 / 1e3
    numbers = {"n": box.boxes, "G": weight, "G_box": weight / box.boxes, "g": case.gravity_m_s2, "m": mass}
    numbers |= {"a": case.stack[0].width, "c": box.height_m, "z_box": box.centroid_m, "z_c": static.centroid}
    numbers |= {"α": math.degrees(static.slenderness_angle), "R": static.radius, "I": static.inertia / 1e3}
    numbers |= {"I_O": static.inertia / 1e3 + mass * static.radius**2, "p": static.frequency_parameter}
    numbers |= {"e": static.housner_restitution, "a_up": static.uplift_acceleration, "T": static.period_eq3}
    numbers |= {"μ_s": case.contact.mu_static}
    if rule is not None:
        numbers |= {"T_C": rule.corner_period_s, "S": rule.soil_factor}
        numbers |= {"γ_I": rule.importance_factor, "a_gR": rule.ground_acceleration_m_s2}
    numbers |= {"a_max": static.own_motion.sliding.demand / 1e3 / mass - static.downhill}
    numbers |= {"θ": math.degrees(static.slope), "slope": abs(case.floor.slope_percent)}
    numbers |= {"G_n": weight * math.cos(static.slope)}
    if case.motion.kind == "harmonic":
        numbers |= {"A": case.motion.amplitude, "Ω": case.motion.angular_frequency}
    nearer, width = static.centroid * math.tan(static.slenderness_angle), case.stack[0].width
    inside, beside = 0.5 * (width - static.width), 0.5 * static.width - nearer
    if inside + beside > OFF_CENTRE * width:
        numbers |= {"b": nearer, "x_c": beside if beside > OFF_CENTRE * width else 0.0}
    if inside > OFF_CENTRE * width:
        numbers["s"] = inside
    return {name: _Printed(value) for name, value in numbers.items() if value is not None}


def _action(action: ActionCheck) -> Numbers:
    sliding, overturning = action.sliding, action.overturning
    return {
        "F": _Printed(sliding.demand / 1e3),
        "F_limit": _Printed(sliding.capacity / 1e3),
        "sliding": _Printed(sliding.utilisation),
        "M": _Printed(overturning.demand / 1e3),
        "M_limit": _Printed(overturning.capacity / 1e3),
        "overturning": _Printed(overturning.utilisation),
    }


def _utilisations(action: ActionCheck, numbers: Numbers, force: str, weight: str = "G") -> list[SheetLine]:
    """Sliding, where there is friction, and overturning; `force` is the symbol of the base shear, `weight` its own."""
    return [
        _line(
            row._replace(
                formula=row.formula.replace("F", force).replace("G", weight),
                numbers=row.numbers.replace("{G}", f"{{{weight}}}"),
            ),
            numbers,
            rule_says(check, rule.utilisation),
        )
        for row, check, rule in (
            (SLIDING, "sliding", action.sliding),
            (OVERTURNING, "overturning", action.overturning),
        )
        if math.isfinite(rule.utilisation)
    ]


def _line(row: SheetRow, numbers: Numbers, verdict: str = "") -> SheetLine:
    if "b" in numbers and row.value != "b":
        row = _off_centre(row, "s" in numbers)
    value = numbers[row.value]
    return SheetLine(
        name=row.name.format(**numbers),
        formula=formula_markup(row.formula),
        numbers=row.numbers.format(**numbers),
        value=value,
        result=number(value),
        unit=row.unit,
        source=Markup(row.source).format(**numbers),
        verdict=verdict,
    )


def _off_centre(row: SheetRow, inside: bool) -> SheetRow:
    """A row with the distance b from the nearer corner in place of half the width."""
    factor = "", ""
    if row is RESTITUTION:
        factor = " a/(2 b)", " × {a:s4} / (2 × {b})"
        if inside:
            factor = " (a/2 − s)/b", " × ({a:s4} / 2 − {s}) / {b}"
    return row._replace(
        formula=row.formula.replace("(a/2)", "b").replace("a/2", "b") + factor[0],
        numbers=row.numbers.replace("({a:s4} / 2)", "{b}").replace("{a:s4} / 2", "{b}") + factor[1],
        source="" if row is ANGLE else row.source,
    )
