"""Section 7 of the paper as arithmetic: its printed numbers with g = 10, and with g = 9.81.

A printed number carries half a unit of its last digit as tolerance; one that the paper calls "app." carries
ten per cent.
"""

import math
from collections.abc import Sequence

from fem.model.static_checks import StaticChecks
from fem.paper.cases import PLATEAU
from fem.paper.claims import Comparison, Finding, Statement, Table
from fem.paper.experiments import RIGID, Laboratory, Row
from fem.verification.statics import BOX_HEIGHT, BOX_MASS, WIDTH, paper_checks

#: EN 1998-1:2004, Tables 3.2 and 3.3: S, T_C and T_D of the rows that the paper mixes
GROUND_D_TYPE_1 = (1.35, 0.8, 2.0)
GROUND_C_TYPE_2 = (1.5, 0.25, 1.2)


def _printed(what: str, measured: float, limit: float, unit: str, tolerance: float) -> Comparison:
    return Comparison(what=what, measured=measured, relation="=", limit=limit, unit=unit, tolerance=tolerance)


def _just_sticks(checks: StaticChecks, gravity: float, *, inside: bool) -> Comparison:
    return Comparison(
        what=f"code base shear over stiction limit, g = {gravity:g} m/s²",
        measured=round(checks.code.sliding.utilisation, 12),
        relation="<=",
        limit=1.0,
        unit="-",
        inside=inside,
    )


def _following(printed: Sequence[Comparison]) -> str:
    return f"{sum(one.holds for one in printed)} of {len(printed)} printed numbers follow"


def _side_by_side(boxes: int) -> Table:
    columns = []
    for gravity in (10.0, 9.81):
        checks = paper_checks(boxes=boxes, gravity=gravity)
        columns.append(
            (
                checks.sliding_limit_static / 1e3,
                checks.sliding_limit_kinetic / 1e3,
                checks.restoring_moment / 1e3,
                checks.code.sliding.demand / 1e3,
                checks.code.overturning.demand / 1e3,
                checks.period_eq3,
                checks.code.sliding.utilisation,
                checks.code.overturning.utilisation,
                checks.frequency_parameter,
                checks.housner_restitution,
            )
        )
    names = (
        "stiction limit, Eq. 14 [kN]",
        "sliding limit, Eq. 16 [kN]",
        "restoring moment, Eq. 15 [kNm]",
        "plateau base shear, Eq. 17 [kN]",
        "tilting moment, Eq. 18 [kNm]",
        "period, Eq. 3 [s]",
        "utilisation of stiction [-]",
        "utilisation of tilting [-]",
        "frequency parameter p [1/s]",
        "Housner's restitution [-]",
    )
    return Table(
        caption=f"{boxes} box{'es' if boxes > 1 else ''}; the mass is kept",
        columns=("quantity", "g = 10 m/s²", "g = 9.81 m/s²"),
        rows=tuple((name, *pair) for name, *pair in zip(names, *columns, strict=True)),
    )


def one_box(laboratory: Laboratory) -> Finding:
    """Eqs. (14) to (19), and the density."""
    checks, honest = (paper_checks(boxes=1, gravity=gravity) for gravity in (10.0, 9.81))
    density = BOX_MASS / (WIDTH * WIDTH * BOX_HEIGHT)
    printed = (
        _printed("virtual density", density, 2066.0, "kg/m³", 0.5),
        _printed("Eq. 14, stiction limit", checks.sliding_limit_static / 1e3, 10.0, "kN", 0.5),
        _printed("Eq. 15, restoring moment", checks.restoring_moment / 1e3, 13.8, "kNm", 0.05 + 1e-9),
        _printed("Eq. 16, sliding limit", checks.sliding_limit_kinetic / 1e3, 5.0, "kN", 0.5),
        _printed("Eq. 17, plateau base shear", checks.code.sliding.demand / 1e3, 10.0, "kN", 0.5),
        _printed("Eq. 18, tilting moment", checks.code.overturning.demand / 1e3, 5.0, "kNm", 0.5),
        _printed("Eq. 19, period", checks.period_eq3, 1.98, "s", 0.005),
    )
    return Finding(
        comparisons=(
            *printed,
            _just_sticks(checks, 10.0, inside=True),
            _just_sticks(honest, 9.81, inside=False),
        ),
        bounds="g = 10 m/s²",
        reading=(
            f"{_following(printed)} with g = 10 m/s². The base shear is {checks.code.sliding.utilisation:.3f} of the "
            f"stiction limit with it and {honest.code.sliding.utilisation:.3f} with 9.81, where more than 1 is "
            '"slides" by the paper\'s own static rule, not "just sticks".'
        ),
        tables=(_side_by_side(1),),
    )


def four_boxes(laboratory: Laboratory) -> Finding:
    """The numbers of the stack."""
    checks, honest = (paper_checks(boxes=4, gravity=gravity) for gravity in (10.0, 9.81))
    printed = (
        _printed("stiction limit", checks.sliding_limit_static / 1e3, 40.0, "kN", 0.5),
        _printed("restoring moment", checks.restoring_moment / 1e3, 55.0, "kNm", 0.05),
        _printed("plateau base shear", checks.code.sliding.demand / 1e3, 40.0, "kN", 0.5),
        _printed("tilting moment", checks.code.overturning.demand / 1e3, 80.0, "kNm", 0.5),
        _printed("period", checks.period_eq3, 3.30, "s", 0.005),
    )
    return Finding(
        comparisons=(
            *printed,
            _just_sticks(checks, 10.0, inside=True),
            _just_sticks(honest, 9.81, inside=False),
        ),
        bounds="g = 10 m/s²",
        reading=(
            f"{_following(printed)} with g = 10 m/s². With 9.81 the utilisation of stiction is "
            f"{honest.code.sliding.utilisation:.3f} and that of tilting {honest.code.overturning.utilisation:.3f}; "
            "beyond 1 the static rule says that the stack does it."
        ),
        tables=(_side_by_side(4),),
    )


def _ratios(rows: Sequence[Row]) -> str:
    return ", ".join(f"{row['rotation_ratio']:.2g}" for row in rows)


def half_width(laboratory: Laboratory) -> Finding:
    """a/2 is printed as 600 mm."""
    half = 0.5 * WIDTH * 1e3
    return Finding(
        comparisons=(_printed("a/2 of a container 1.100 mm wide", half, 600.0, "mm", 5.0),),
        reading=f"a/2 is {half:.0f} mm; in print it is {600.0 / half - 1.0:.0%} more.",
    )


def design_amplitude(laboratory: Laboratory) -> Finding:
    """50 mm for 2.4 m/s2 against the design ground displacement of the code, and whether it matters."""

    def displacement(row: tuple[float, float, float]) -> float:
        _, control, end = row
        return 0.025 * 1.6 * 1.5 * control * end * 1e3

    long, short = displacement(GROUND_D_TYPE_1), displacement(GROUND_C_TYPE_2)
    setups = []
    for amplitude in (0.001 * short, 0.05, 0.001 * long):
        for peak in (2.4, 4.0):
            values = {
                "motion.peak_acceleration_m_s2": peak,
                "motion.angular_frequency_rad_s": float(f"{math.sqrt(peak / amplitude):.5g}"),
            }
            what = f"stack, {peak:g} m/s² at {1e3 * amplitude:.0f} mm"
            setups.append(PLATEAU.but({**RIGID, **values}, what))
    rows = laboratory.rows(setups)
    return Finding(
        comparisons=(
            Comparison(what="A, from below", measured=50.0, relation=">=", limit=short, unit="mm"),
            Comparison(what="A, from above", measured=50.0, relation="<=", limit=long, unit="mm"),
            Comparison(
                what="A against Eq. 3.12 with T_C = 0.8 s, T_D = 2 s",
                measured=50.0,
                relation="=",
                limit=long,
                unit="mm",
                tolerance=0.1 * long,
                inside=False,
            ),
            Comparison(
                what="A against Eq. 3.12 with T_C = 0.25 s, T_D = 1.2 s",
                measured=50.0,
                relation="=",
                limit=short,
                unit="mm",
                tolerance=0.1 * short,
                inside=False,
            ),
        ),
        bounds=f"between {short:.0f} mm and {long:.0f} mm, depending on the ground",
        reading=(
            f"EN 1998-1:2004, Eq. 3.12, d_g = 0.025 a_g S T_C T_D, gives {long:.0f} mm with the paper's "
            f"T_C = 0.8 s (ground D, type 1) and {short:.0f} mm with the row that its S = 1.5 belongs to "
            "(ground C, type 2, T_C = 0.25 s): S and T_C are of two different grounds. With the smaller, the "
            "paper's and the larger amplitude the stack turns to "
            f"{_ratios(rows[::2])} of beta at 2.4 m/s² and to {_ratios(rows[1::2])} at 4.0 m/s²."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption="What the amplitude changes (rigid stack)",
                columns=("run", "outcome", "rotation ratio [-]"),
                rows=tuple(
                    (setup.what, row["outcome"], row["rotation_ratio"])
                    for setup, row in zip(setups, rows, strict=True)
                ),
            ),
        ),
    )


STATEMENTS = (
    Statement(
        name="numbers-one-box",
        section="7, Eqs. 14-19",
        quote="F_lim = 10 kN, M_R = -13,8 kNm, 5 kN, F_b = 10 kN, M_T = 5 kNm, T = 1,98 s",
        tried="Recomputed by the static rules of the program, with g = 10 and 9.81 m/s².",
        examine=one_box,
    ),
    Statement(
        name="numbers-four-boxes",
        section="7",
        quote="F_lim = 40 kN; M_R = -55,0 kNm; F_b = 40 kN; M_T = 80 kNm; T = 3,30 s",
        tried="Recomputed by the static rules of the program, with g = 10 and 9.81 m/s².",
        examine=four_boxes,
    ),
    Statement(
        name="half-width",
        section="7",
        quote="a/2 = 600 mm",
        tried="Half of the width that the paper gives.",
        examine=half_width,
    ),
    Statement(
        name="amplitude-50-mm",
        section="7",
        quote="a harmonic base acceleration of 2,4 m/s² corresponding to ... an amplitude of app. 50 mm",
        tried=(
            "Held against the design ground displacement of the code; the stack run with the amplitudes "
            "of both grounds at the stated and at the plateau acceleration."
        ),
        examine=design_amplitude,
    ),
)
