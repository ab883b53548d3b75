"""Section 7 of the paper as arithmetic: its printed numbers with g = 10, and with g = 9.81.

A printed number has half a unit of its last digit as tolerance; one that the paper calls "app." has ten per cent.
"""

import math
from collections.abc import Sequence

from fem.batch.runner import Row
from fem.model.static_checks import StaticChecks
from fem.paper.cases import PLATEAU, RIGID
from fem.paper.claims import ClaimTable, Comparison, Evidence, at_least, at_most, claim, equal, table
from fem.paper.experiments import Experiments
from fem.verification.statics import BOX_HEIGHT, BOX_MASS, WIDTH, paper_checks

#: EN 1998-1:2004, Tables 3.2 and 3.3: S, T_C and T_D of the rows that the paper mixes
GROUND_D_TYPE_1 = (1.35, 0.8, 2.0)
GROUND_C_TYPE_2 = (1.5, 0.25, 1.2)


def _just_sticks(checks: StaticChecks, gravity: float) -> Comparison:
    what = f"code base shear over stiction limit, g = {gravity:g} m/s²"
    return at_most(what, round(checks.code.sliding.utilisation, 12), 1.0, inside=gravity == 10.0)


def _following(printed: Sequence[Comparison]) -> str:
    holding = sum(one.holds for one in printed)
    return f"{holding} of {len(printed)} printed numbers follow with g = 10 m/s²"


def _side_by_side(title: str, ten: StaticChecks, full: StaticChecks) -> ClaimTable:
    def values(checks: StaticChecks) -> dict[str, float]:
        return {
            "stiction limit, Eq. 14 [kN]": checks.sliding_limit_static / 1e3,
            "sliding limit, Eq. 16 [kN]": checks.sliding_limit_kinetic / 1e3,
            "restoring moment, Eq. 15 [kNm]": checks.restoring_moment / 1e3,
            "plateau base shear, Eq. 17 [kN]": checks.code.sliding.demand / 1e3,
            "tilting moment, Eq. 18 [kNm]": checks.code.overturning.demand / 1e3,
            "period, Eq. 3 [s]": checks.period_eq3,
            "utilisation of stiction [-]": checks.code.sliding.utilisation,
            "utilisation of tilting [-]": checks.code.overturning.utilisation,
            "frequency parameter p [1/s]": checks.frequency_parameter,
            "Housner's restitution [-]": checks.housner_restitution,
        }

    second = values(full)
    return table(
        f"{title}; the mass is kept",
        "quantity | g = 10 m/s² | g = 9.81 m/s²",
        [(name, value, second[name]) for name, value in values(ten).items()],
    )


@claim(
    "7, Eqs. 14-19",
    "F_lim = 10 kN, M_R = -13,8 kNm, 5 kN, F_b = 10 kN, M_T = 5 kNm, T = 1,98 s",
    bounds="g = 10 m/s²",
)
def numbers_one_box(experiments: Experiments) -> Evidence:
    """Recomputed by the static rules of the program, with g = 10 and 9.81 m/s²."""
    checks, full = (paper_checks(boxes=1, gravity=gravity) for gravity in (10.0, 9.81))
    density = BOX_MASS / (WIDTH * WIDTH * BOX_HEIGHT)
    printed = (
        equal("virtual density", density, 2066.0, 0.5, "kg/m³"),
        equal("Eq. 14, stiction limit", checks.sliding_limit_static / 1e3, 10.0, 0.5, "kN"),
        equal("Eq. 15, restoring moment", checks.restoring_moment / 1e3, 13.8, 0.05 + 1e-9, "kNm"),
        equal("Eq. 16, sliding limit", checks.sliding_limit_kinetic / 1e3, 5.0, 0.5, "kN"),
        equal("Eq. 17, plateau base shear", checks.code.sliding.demand / 1e3, 10.0, 0.5, "kN"),
        equal("Eq. 18, tilting moment", checks.code.overturning.demand / 1e3, 5.0, 0.5, "kNm"),
        equal("Eq. 19, period", checks.period_eq3, 1.98, 0.005, "s"),
    )
    yield from printed
    yield _just_sticks(checks, 10.0)
    yield _just_sticks(full, 9.81)
    yield (
        f"{_following(printed)}. The base shear is {checks.code.sliding.utilisation:.3f} of the "
        f"stiction limit with it and {full.code.sliding.utilisation:.3f} with 9.81, where more than 1 is "
        '"slides" by the paper\'s own static rule, not "just sticks".'
    )
    yield _side_by_side("1 box", checks, full)


@claim("7", "F_lim = 40 kN; M_R = -55,0 kNm; F_b = 40 kN; M_T = 80 kNm; T = 3,30 s", bounds="g = 10 m/s²")
def numbers_four_boxes(experiments: Experiments) -> Evidence:
    """Recomputed by the static rules of the program, with g = 10 and 9.81 m/s²."""
    checks, full = (paper_checks(boxes=4, gravity=gravity) for gravity in (10.0, 9.81))
    printed = (
        equal("stiction limit", checks.sliding_limit_static / 1e3, 40.0, 0.5, "kN"),
        equal("restoring moment", checks.restoring_moment / 1e3, 55.0, 0.05, "kNm"),
        equal("plateau base shear", checks.code.sliding.demand / 1e3, 40.0, 0.5, "kN"),
        equal("tilting moment", checks.code.overturning.demand / 1e3, 80.0, 0.5, "kNm"),
        equal("period", checks.period_eq3, 3.30, 0.005, "s"),
    )
    yield from printed
    yield _just_sticks(checks, 10.0)
    yield _just_sticks(full, 9.81)
    yield (
        f"{_following(printed)}. With 9.81 the utilisation of stiction is "
        f"{full.code.sliding.utilisation:.3f} and that of tilting {full.code.overturning.utilisation:.3f}; "
        "above 1 the static rule predicts sliding, or tilting."
    )
    yield _side_by_side("4 boxes", checks, full)


@claim("7", "a/2 = 600 mm")
def half_width(experiments: Experiments) -> Evidence:
    """Half of the width that the paper gives."""
    half = 0.5 * WIDTH * 1e3
    yield equal("a/2 of a container 1.100 mm wide", half, 600.0, 5.0, "mm")
    yield f"a/2 is {half:.0f} mm; in print it is {600.0 / half - 1.0:.0%} more."


def _ground_displacement(ground: tuple[float, float, float]) -> float:
    """Design ground displacement [mm]; EN 1998-1:2004, Eq. (3.12), with the paper's a_g and S."""
    _, control, end = ground
    return 0.025 * 1.6 * 1.5 * control * end * 1e3


LONG, SHORT = _ground_displacement(GROUND_D_TYPE_1), _ground_displacement(GROUND_C_TYPE_2)  # mm


def _ratios(rows: Sequence[Row]) -> str:
    return ", ".join(f"{row['rotation_ratio']:.2g}" for row in rows)


@claim(
    "7",
    "a harmonic base acceleration of 2,4 m/s² corresponding to ... an amplitude of app. 50 mm",
    bounds=f"between {SHORT:.0f} mm and {LONG:.0f} mm, depending on the ground",
)
def amplitude_50_mm(experiments: Experiments) -> Evidence:
    """Compared with the design ground displacement of the code; the stack runs with the amplitudes of both grounds at
    the stated and at the plateau acceleration."""
    cases = [
        PLATEAU.but(
            RIGID,
            peak=peak,
            frequency=float(f"{math.sqrt(peak / amplitude):.5g}"),
            what=f"stack, {peak:g} m/s² at {1e3 * amplitude:.0f} mm",
        )
        for amplitude in (0.001 * SHORT, 0.05, 0.001 * LONG)
        for peak in (2.4, 4.0)
    ]
    rows = experiments.rows(cases)
    against = "A against Eq. 3.12 with"
    yield at_least("A, from below", 50.0, SHORT, "mm")
    yield at_most("A, from above", 50.0, LONG, "mm")
    yield equal(f"{against} T_C = 0.8 s, T_D = 2 s", 50.0, LONG, 0.1 * LONG, "mm", inside=False)
    yield equal(f"{against} T_C = 0.25 s, T_D = 1.2 s", 50.0, SHORT, 0.1 * SHORT, "mm", inside=False)
    yield (
        f"EN 1998-1:2004, Eq. 3.12, d_g = 0.025 a_g S T_C T_D, gives {LONG:.0f} mm with the paper's "
        f"T_C = 0.8 s (ground D, type 1) and {SHORT:.0f} mm with the row that its S = 1.5 belongs to "
        "(ground C, type 2, T_C = 0.25 s): S and T_C belong to two different grounds. With the smaller, "
        "the paper's and the larger amplitude the stack rotates by "
        f"{_ratios(rows[::2])} of beta at 2.4 m/s² and by {_ratios(rows[1::2])} at 4.0 m/s²."
    )
    yield from cases
    yield table(
        "Effect of the amplitude (rigid stack)",
        "run | outcome | rotation ratio [-]",
        [(case.what, row["outcome"], row["rotation_ratio"]) for case, row in zip(cases, rows, strict=True)],
    )
