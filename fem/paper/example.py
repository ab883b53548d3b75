"""Section 7 of the paper, its verdicts on one box and on four: which mode, and how far within the limit cycle."""

import math
from collections.abc import Sequence

import numpy as np

from fem.paper.cases import (
    ANGULAR_FREQUENCY,
    BOX,
    FOR_MAPS,
    G_TEN,
    GRAVITY,
    NO_SLIDING,
    PLATEAU,
    PLATEAU_PEAK,
    STACK,
    STATED_PEAK,
    UPLIFT,
    harmonic,
)
from fem.paper.claims import Comparison, Finding, Setup, Statement, Table
from fem.paper.experiments import RIGID, Laboratory, Row
from fem.paper.figures import Line, drawing

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
            f"The box tilts in {sum(row['first_uplift_s'] is not None for row in rows)} of {len(rows)} runs. At the "
            f"plateau value the utilisation of stiction is {PLATEAU_PEAK / (0.4 * 10.0):.3f} with g = 10, where "
            f"rounding decides: the run slides by up to {1e3 * rows[3]['max_slip_m']:.1f} mm. With 9.81 it is "
            f"{PLATEAU_PEAK / (0.4 * GRAVITY):.3f}, and the slip {1e3 * rows[4]['max_slip_m']:.1f} mm."
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
            f"{_outcomes(laboratory, [setup for setup, _ in cases])}. With g = 9.81 the static check of sliding "
            f"has a utilisation of {PLATEAU_PEAK / (0.4 * GRAVITY):.3f}; it takes the base to be pushed with m "
            'a(t), which holds only until the stack rocks. "Will tilt" is not "falls": see the column overturned.'
        ),
        band_of=PLATEAU.but({"solver.duration_s": 10.0}),
    )


def stack_tilts_as_stated(laboratory: Laboratory) -> Finding:
    """Four boxes under the stated motion of 2.4 m/s2."""
    jerked = STACK.but(
        {**RIGID, "motion.start": "rest"}, "rigid stack, the floor jerks at t = 0, mu_k = mu_s/2"
    )
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
            f"The motion that the paper states reaches {STATED_PEAK:g} m/s², against g a/c = {UPLIFT:.2f} m/s²; the "
            "80 kNm are those of the plateau value, an amplified response. "
            f"{_outcomes(laboratory, [setup for setup, _ in cases])}. Where the container does not move with the "
            f"floor at t = 0, the floor starts with a jerk of {0.05 * ANGULAR_FREQUENCY:.2f} m/s, and what follows "
            f"belongs to that jerk; with mu_k = 0.2 instead: {_outcomes(laboratory, [jerked])}."
        ),
        band_of=STACK.but({"solver.duration_s": 10.0}),
    )


def _outcomes(laboratory: Laboratory, setups: Sequence[Setup]) -> str:
    """What each run came to, in words."""
    return "; ".join(
        f"{setup.what}: {row['outcome']}, rotation ratio {row['rotation_ratio']:.3g}, slip "
        f"{1e3 * row['max_slip_m']:.3g} mm"
        for setup, row in zip(setups, laboratory.rows(setups), strict=True)
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
    at_paper: list[float] = []
    growths: list[float] = []
    died: list[bool] = []
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
        rows = laboratory.attempts(group)
        ratios = [
            math.nan if row["status"] == "failed" else min(float(row["rotation_ratio"]), 1.0) for row in rows
        ]
        worst = int(np.nanargmax(ratios))
        standing = [
            one if row["outcome"] != "overturned" else -1.0 for one, row in zip(ratios, rows, strict=True)
        ]
        widest = group[int(np.nanargmax(standing))]
        setups.append(group[worst])
        at_paper.append(float(laboratory.rows([STACK.but({**FOR_MAPS, **values})])[0]["rotation_ratio"]))
        growths.append(_growth(laboratory, widest))
        curves.append(Line(x=frequencies, y=ratios, label=name, style="o-"))
        comparisons += [
            Comparison(
                what=f"{name}: rotation ratio at the paper's 6.928 rad/s",
                measured=at_paper[-1],
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
                measured=growths[-1],
                relation="<=",
                limit=1.05,
                unit="-",
                inside=False,
            ),
        ]
        ended = widest.but(
            {"motion.cycles": 20.0, "solver.duration_s": 30.0}, f"{widest.what}, 20 cycles, then rest"
        )
        died.append(bool(laboratory.rows([ended])[0]["restored"]))
        comparisons.append(
            _some(
                f"{name}: without drive the motion dies out, widest that stands",
                float(died[-1]),
                inside=False,
            )
        )
        setups.append(ended)
    return Finding(
        comparisons=tuple(comparisons),
        bounds="at the paper's frequency, where the stack does not move at all",
        reading=(
            f"At 6.928 rad/s 50 mm are {0.05 * ANGULAR_FREQUENCY**2:.2f} m/s² against g a/c = {UPLIFT:.2f} m/s²: the "
            f"rotation there is {max(at_paper):.2g} of beta. At other frequencies the same 50 mm turn the stack to "
            f"{max(float(np.nanmax(line.y)) for line in curves):.2f} of beta (1: overturned), which 50 mm against "
            f"a/2 cannot tell. In its last 5 s the widest motion that stands reaches {max(growths):.2f} of what it "
            f"reached before, and {sum(died)} of {len(died)} such motions have died out after their drive."
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
        seconds=5.0,
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
        seconds=2.0,
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
    ),
)
