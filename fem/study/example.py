"""Section 7 of the paper, its verdicts on one box and on four: which mode, and how far within the limit cycle."""

import math

import numpy as np

from fem.study.drawings import Line, drawing
from fem.study.laboratory import RIGID, Laboratory, Row
from fem.study.setups import ANGULAR_FREQUENCY, BOX, FOR_MAPS, G_TEN, PLATEAU, STACK, harmonic
from fem.study.statements import Comparison, Finding, Setup, Statement, Table

NO_SLIDING = {"contact.mu_static": 1.0, "contact.mu_kinetic": 1.0}
SLIDING = 1e-4 * 1.1  # m, what counts as sliding


def box_sticks(laboratory: Laboratory) -> Finding:
    """One box: it just sticks and does not tilt."""
    plateau = harmonic(4.0, ANGULAR_FREQUENCY)
    cases = (
        (BOX.but(RIGID, "box, stated motion, g = 9.81"), True),
        (BOX.but({**RIGID, **G_TEN}, "box, stated motion, g = 10"), True),
        (BOX.but({**RIGID, **G_TEN, **harmonic(3.98, ANGULAR_FREQUENCY)}, "box, 3.98 m/s², g = 10"), True),
        (BOX.but({**RIGID, **G_TEN, **plateau}, "box, plateau value, g = 10 (utilisation 1.000)"), False),
        (BOX.but({**RIGID, **plateau}, "box, plateau value, g = 9.81 (utilisation 1.019)"), False),
    )
    rows = laboratory.rows([setup for setup, _ in cases])
    comparisons = []
    for (setup, inside), row in zip(cases, rows, strict=True):
        comparisons += [
            _at_most(f"slip, {setup.what}", 1e3 * row["max_slip_m"], 1e3 * SLIDING, "mm", inside=inside),
            _none(f"tilts, {setup.what}", row["first_uplift_s"] is not None),
        ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="under the stated motion, and up to half a per cent below the plateau value with g = 10",
        reading=(
            'The box does not tilt. "Just sticks" has no margin: at the plateau value the utilisation of stiction '
            f"is 1.000 with g = 10, and the box slides by up to {1e3 * rows[3]['max_slip_m']:.0f} mm as "
            f"rounding exceeds it; with 9.81 by {1e3 * rows[4]['max_slip_m']:.0f} mm. Neither is of any "
            "danger to it."
        ),
        setups=tuple(setup for setup, _ in cases),
        band=laboratory.band(
            cases[0][0].but({"solver.duration_s": 10.0}),
            quantity="slip under the stated motion",
            unit="m",
            value=lambda row: row["max_slip_m"],
            criterion="rest",
            holds=lambda row: row["outcome"] == "rest",
        ),
    )


def stack_tilts_at_plateau(laboratory: Laboratory) -> Finding:
    """Four boxes under the plateau value: they stick and tilt."""
    cases = (
        (PLATEAU.but({**RIGID, **G_TEN}, "rigid stack, plateau value, g = 10"), True),
        (PLATEAU.but(RIGID, "rigid stack, plateau value, g = 9.81"), True),
        (PLATEAU.but({"solver.model": "reduced", **G_TEN}, "shell, plateau value, g = 10"), False),
        (PLATEAU.but({"solver.model": "reduced"}, "shell, plateau value, g = 9.81"), False),
    )
    return _tilts_and_sticks(
        laboratory,
        cases,
        bounds="the rigid body",
        reading=(
            "The rigid stack tilts as the paper says and does not slide, even with g = 9.81, where its "
            "static check of sliding fails: once it rocks, its base is not pushed with m a(t) any more. "
            "It rocks and stands; the paper's "
            '"will tilt" must not be read as "falls". The shell loses its grip at an impact and slides as well.'
        ),
        band_of=PLATEAU.but({"solver.duration_s": 10.0}),
    )


def stack_tilts_as_stated(laboratory: Laboratory) -> Finding:
    """Four boxes under the stated motion of 2.4 m/s2."""
    cases = (
        (STACK.but({**RIGID, **G_TEN}, "rigid stack, stated motion, g = 10"), True),
        (STACK.but(RIGID, "rigid stack, stated motion, g = 9.81"), True),
        (STACK.but({"solver.model": "reduced"}, "shell, stated motion, g = 9.81"), True),
        (
            STACK.but(
                {**RIGID, "motion.start": "rest", "contact.mu_kinetic": 0.4},
                "rigid stack, the floor jerks at t = 0, mu_k = mu_s",
            ),
            True,
        ),
    )
    return _tilts_and_sticks(
        laboratory,
        cases,
        bounds="",
        reading=(
            "Under the motion that the paper states, 50 mm and 2.4 m/s², the stack does not tilt: 2.4 is "
            "below g a/c = 2.70 m/s². The 80 kNm are those of the plateau value, an amplified response, "
            "not of this motion. Only if the floor starts with a jerk of 0.35 m/s under a container at "
            "rest does it rock, by that jerk, and only if friction does not give way meanwhile (with mu_k "
            "= 0.2 it slides 23 mm instead)."
        ),
        band_of=STACK.but({"solver.duration_s": 10.0}),
    )


def _tilts_and_sticks(
    laboratory: Laboratory,
    cases: tuple[tuple[Setup, bool], ...],
    *,
    bounds: str,
    reading: str,
    band_of: Setup,
) -> Finding:
    rows = laboratory.rows([setup for setup, _ in cases])
    comparisons = []
    for (setup, inside), row in zip(cases, rows, strict=True):
        comparisons += [
            Comparison(
                what=f"rotation ratio, {setup.what}",
                measured=float(row["rotation_ratio"]),
                relation=">=",
                limit=0.01,
                unit="-",
                inside=inside,
            ),
            _at_most(f"slip, {setup.what}", 1e3 * row["max_slip_m"], 1e3 * SLIDING, "mm", inside=inside),
        ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds=bounds,
        reading=reading,
        setups=tuple(setup for setup, _ in cases),
        tables=(
            Table(
                caption="What the stack does",
                columns=("run", "outcome", "rotation ratio [-]", "slip [mm]", "overturned"),
                rows=tuple(
                    (
                        setup.what,
                        row["outcome"],
                        row["rotation_ratio"],
                        1e3 * row["max_slip_m"],
                        row["outcome"] == "overturned",
                    )
                    for (setup, _), row in zip(cases, rows, strict=True)
                ),
            ),
        ),
        band=laboratory.band(
            band_of,
            quantity="rotation ratio",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="it tilts (0.01 and more) and does not slide",
            holds=_rocks_alone,
        ),
    )


def _rocks_alone(row: Row) -> bool:
    return bool(row["outcome"] == "rock")


def within_the_limit_cycle(laboratory: Laboratory) -> Finding:
    """50 mm whatever the frequency: how far the stack turns, whether it diverges, whether it dies out."""
    frequencies = [float(f"{w:.4g}") for w in np.geomspace(4.0, 40.0, 25)]
    curves, comparisons, setups = [], [], []
    for name, values in (("slipping, mu 0.4/0.2", {}), ("sticking, mu 1.0", NO_SLIDING)):
        group = [
            STACK.but(
                {
                    **FOR_MAPS,
                    **values,
                    "motion.angular_frequency_rad_s": frequency,
                    "solver.duration_s": 20.0,
                },
                f"stack, {name}, 50 mm at {frequency:g} rad/s",
            )
            for frequency in frequencies
        ]
        rows = laboratory.rows(group)
        ratios = [
            math.nan if row["status"] == "failed" else min(float(row["rotation_ratio"]), 1.0) for row in rows
        ]
        worst = int(np.nanargmax(ratios))
        standing = [
            one if row["outcome"] != "overturned" else -1.0 for one, row in zip(ratios, rows, strict=True)
        ]
        widest = group[int(np.nanargmax(standing))]
        setups.append(group[worst])
        curves.append(Line(x=frequencies, y=ratios, label=name, style="o-"))
        comparisons += [
            Comparison(
                what=f"{name}: rotation ratio at the paper's 6.928 rad/s",
                measured=float(laboratory.rows([STACK.but({**FOR_MAPS, **values})])[0]["rotation_ratio"]),
                relation="<=",
                limit=0.5,
                unit="-",
            ),
            Comparison(
                what=f"{name}: largest rotation ratio from 4 to 40 rad/s",
                measured=ratios[worst],
                relation="<=",
                limit=0.5,
                unit="-",
                inside=False,
            ),
            Comparison(
                what=f"{name}: frequencies at which it overturns",
                measured=float(sum(row["outcome"] == "overturned" for row in rows)),
                relation="<=",
                limit=0.0,
                unit="-",
                inside=False,
            ),
            Comparison(
                what=f"{name}: rotation in the last 5 s over that before, widest that stands",
                measured=_growth(laboratory, widest),
                relation="<=",
                limit=1.05,
                unit="-",
                inside=False,
            ),
        ]
        ended = widest.but(
            {"motion.cycles": 20.0, "solver.duration_s": 30.0}, f"{widest.what}, 20 cycles, then rest"
        )
        row = laboratory.rows([ended])[0]
        comparisons.append(
            _some(
                f"{name}: without drive the motion dies out, widest that stands",
                float(bool(row["restored"])),
                inside=False,
            )
        )
        setups.append(ended)
    return Finding(
        comparisons=tuple(comparisons),
        bounds="at the paper's frequency, where the stack does not move at all",
        reading=(
            "At 6.928 rad/s 50 mm are 2.4 m/s²: nothing moves, and the statement is empty. At other "
            "frequencies the same 50 mm turn the stack to "
            f"{max(float(np.nanmax(line.y)) for line in curves):.2f} of beta (1: overturned): 50 mm "
            "against a/2 says nothing of that. What does not overturn keeps its amplitude, and dies out "
            "without drive."
        ),
        setups=tuple(setups),
        drawings=(
            drawing(
                "within-the-limit-cycle",
                "Largest rotation over beta (1: overturned) of the rigid stack under 50 mm, over frequency.",
                curves,
                x_label="angular frequency [rad/s]",
                y_label="rotation ratio [-]",
                log_x=True,
            ),
        ),
        band=laboratory.band(
            STACK.but({"solver.duration_s": 10.0}),
            quantity="rotation ratio at the paper's frequency",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="at most half of beta",
            holds=lambda row: row["outcome"] != "overturned" and row["rotation_ratio"] <= 0.5,
        ),
    )


def _growth(laboratory: Laboratory, setup: Setup) -> float:
    """Largest rotation of the last 5 s of a run over the largest before."""
    history = laboratory.record(setup.but({"output.history_s": 0.02})).history
    time, rotation = history["time_s"], np.abs(history["rotation_rad"])
    late = time >= time[-1] - 5.0
    return float(rotation[late].max() / rotation[~late].max())


def _at_most(what: str, measured: float, limit: float, unit: str, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=measured, relation="<=", limit=limit, unit=unit, inside=inside)


def _none(what: str, found: bool) -> Comparison:
    return Comparison(what=what, measured=float(found), relation="<=", limit=0.0, unit="-")


def _some(what: str, count: float, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=float(count), relation=">=", limit=1.0, unit="-", inside=inside)


STATEMENTS = (
    Statement(
        name="box-just-sticks",
        section="7, one box",
        quote="In this example, the body will just remain in the sticking mode and will not tilt",
        tried="Rigid box under the stated motion and the plateau value, g = 10 and 9.81 m/s².",
        examine=box_sticks,
        seconds=6.0,
    ),
    Statement(
        name="stack-tilts-at-plateau",
        section="7, four boxes",
        quote=(
            "In this example, the body will just remain in the sticking mode and will tilt (plateau "
            "value, 4.0 m/s²)"
        ),
        tried="The stack with the floor reaching the plateau value, rigid and shell, g = 10 and 9.81 m/s².",
        examine=stack_tilts_at_plateau,
        seconds=8.0,
    ),
    Statement(
        name="stack-tilts-as-stated",
        section="7, four boxes",
        quote=(
            "In this example, the body will just remain in the sticking mode and will tilt (stated "
            "motion, 2.4 m/s²)"
        ),
        tried="The stack under 50 mm at 6.928 rad/s, rigid and shell, started moving and with a jerk.",
        examine=stack_tilts_as_stated,
        seconds=8.0,
    ),
    Statement(
        name="within-the-limit-cycle",
        section="7",
        quote=(
            "50 mm is << a/2. Regardless of sticking or slipping the tilting of the body will remain well "
            "within the limit cycle. Thus, Lyapunov stability is given"
        ),
        tried=(
            "50 mm at the paper's frequency and from 4 to 40 rad/s, slipping and sticking: rotation, "
            "growth, decay without drive."
        ),
        examine=within_the_limit_cycle,
        seconds=15.0,
    ),
)
