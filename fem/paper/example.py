"""Section 7 of the paper, its verdicts on one box and on four: which mode, and how far within the limit cycle."""

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
    RIGID,
    SHELL,
    STACK,
    STATED_PEAK,
    UPLIFT,
    PaperCase,
)
from fem.paper.claims import Evidence, at_least, at_most, claim, table
from fem.paper.experiments import Experiments, capped_ratio, stands
from fem.paper.figures import PlottedLine, draw_curves

SLIDING = 1e-4 * 1.1  # m, what counts as sliding


@claim(
    "7, one box",
    "In this example, the body will just remain in the sticking mode and will not tilt",
    bounds="under the stated motion, and up to half a per cent below the plateau value with g = 10",
)
def box_just_sticks(experiments: Experiments) -> Evidence:
    """Rigid box under the stated motion and the plateau value, g = 10 and 9.81 m/s²."""
    box = BOX.but(RIGID)
    below = [
        box.but(what="box, stated motion, g = 9.81"),
        box.but(G_TEN, what="box, stated motion, g = 10"),
        box.but(G_TEN, peak=3.98, frequency=ANGULAR_FREQUENCY, what="box, 3.98 m/s², g = 10"),
    ]
    plateau = {
        "motion.peak_acceleration_m_s2": PLATEAU_PEAK,
        "motion.angular_frequency_rad_s": ANGULAR_FREQUENCY,
    }
    at_plateau = [
        box.but(G_TEN, plateau, what="box, plateau value, g = 10 (utilisation 1.000)"),
        box.but(plateau, what="box, plateau value, g = 9.81 (utilisation 1.019)"),
    ]
    cases = [*below, *at_plateau]
    rows = experiments.rows(cases)
    for case, row in zip(cases, rows, strict=True):
        slip, tilts = 1e3 * row["max_slip_m"], row["first_uplift_s"] is not None
        yield at_most(f"slip, {case.what}", slip, 1e3 * SLIDING, "mm", inside=case in below)
        yield at_most(f"tilts, {case.what}", tilts, 0.0)
    yield (
        f"The box tilts in {sum(row['first_uplift_s'] is not None for row in rows)} of {len(rows)} runs. At the "
        f"plateau value the utilisation of stiction is {PLATEAU_PEAK / (0.4 * 10.0):.3f} with g = 10, where "
        f"rounding decides: the run slides by up to {1e3 * rows[3]['max_slip_m']:.1f} mm. With 9.81 it is "
        f"{PLATEAU_PEAK / (0.4 * GRAVITY):.3f}, and the slip {1e3 * rows[4]['max_slip_m']:.1f} mm."
    )
    yield from cases
    yield experiments.band(
        cases[0].but(duration=10.0),
        quantity="slip under the stated motion",
        unit="m",
        value=lambda row: row["max_slip_m"],
        criterion="rest",
        holds=lambda row: row["outcome"] == "rest",
    )


@claim(
    "7, four boxes",
    "In this example, the body will just remain in the sticking mode and will tilt (plateau value, 4.0 m/s²)",
    bounds="the rigid body",
)
def stack_tilts_at_plateau(experiments: Experiments) -> Evidence:
    """The stack with the floor reaching the plateau value, rigid and shell, g = 10 and 9.81 m/s²."""
    rigid = [
        PLATEAU.but(RIGID, G_TEN, what="rigid stack, plateau value, g = 10"),
        PLATEAU.but(RIGID, what="rigid stack, plateau value, g = 9.81"),
    ]
    shell = [
        PLATEAU.but(SHELL, G_TEN, what="shell, plateau value, g = 10"),
        PLATEAU.but(SHELL, what="shell, plateau value, g = 9.81"),
    ]
    return _tilts_and_sticks(
        experiments,
        rigid,
        shell,
        reading=(
            f"{_outcomes(experiments, [*rigid, *shell])}. With g = 9.81 the static check of sliding "
            f"has a utilisation of {PLATEAU_PEAK / (0.4 * GRAVITY):.3f}; it assumes a base shear of m a(t), which "
            'holds only until the stack rocks. "Will tilt" is not "falls": see the column overturned.'
        ),
        band_of=PLATEAU.but(duration=10.0),
    )


@claim(
    "7, four boxes",
    "In this example, the body will just remain in the sticking mode and will tilt (stated motion, 2.4 m/s²)",
)
def stack_tilts_as_stated(experiments: Experiments) -> Evidence:
    """The stack under 50 mm at 6.928 rad/s, rigid and shell, started moving and with a jerk."""
    jerk = STACK.but(RIGID, {"motion.start": "rest"})
    jerked = jerk.but(what="rigid stack, the floor jerks at t = 0, mu_k = mu_s/2")
    cases = [
        STACK.but(RIGID, G_TEN, what="rigid stack, stated motion, g = 10"),
        STACK.but(RIGID, what="rigid stack, stated motion, g = 9.81"),
        STACK.but(SHELL, what="shell, stated motion, g = 9.81"),
        jerk.but(mu_kinetic=0.4, what="rigid stack, the floor jerks at t = 0, mu_k = mu_s"),
    ]
    return _tilts_and_sticks(
        experiments,
        cases,
        reading=(
            f"The motion that the paper states reaches {STATED_PEAK:g} m/s², against g a/c = {UPLIFT:.2f} m/s²; the "
            f"80 kNm are those of the plateau value, an amplified response. {_outcomes(experiments, cases)}. If the "
            "container does not move with the "
            f"floor at t = 0, the floor starts with a velocity step of {0.05 * ANGULAR_FREQUENCY:.2f} m/s, which "
            f"causes the motion that follows; with mu_k = 0.2 instead: {_outcomes(experiments, [jerked])}."
        ),
        band_of=STACK.but(duration=10.0),
    )


def _outcomes(experiments: Experiments, cases: Sequence[PaperCase]) -> str:
    """The result of each run, in words."""
    return "; ".join(
        f"{case.what}: {row['outcome']}, rotation ratio {row['rotation_ratio']:.3g}, slip "
        f"{1e3 * row['max_slip_m']:.3g} mm"
        for case, row in zip(cases, experiments.rows(cases), strict=True)
    )


def _tilts_and_sticks(
    experiments: Experiments,
    inside: Sequence[PaperCase],
    outside: Sequence[PaperCase] = (),
    *,
    reading: str,
    band_of: PaperCase,
) -> Evidence:
    cases = [*inside, *outside]
    lines = []
    for case, row in zip(cases, experiments.rows(cases), strict=True):
        ratio, slip = row["rotation_ratio"], 1e3 * row["max_slip_m"]
        yield at_least(f"rotation ratio, {case.what}", ratio, 0.01, inside=case in inside)
        yield at_most(f"slip, {case.what}", slip, 1e3 * SLIDING, "mm", inside=case in inside)
        lines.append((case.what, row["outcome"], ratio, slip, not stands(row)))
    yield reading
    yield from cases
    yield table("What the stack does", "run | outcome | rotation ratio [-] | slip [mm] | overturned", lines)
    yield experiments.band(
        band_of,
        quantity="rotation ratio",
        criterion="it tilts (0.01 and more) and does not slide",
        holds=lambda row: row["outcome"] == "rock",
    )


@claim(
    "7",
    "50 mm is << a/2. Regardless of sticking or slipping the tilting of the body will remain well "
    "within the limit cycle. Thus, Lyapunov stability is given",
    bounds="at the paper's frequency, where the stack does not move at all",
)
def within_the_limit_cycle(experiments: Experiments) -> Evidence:
    """50 mm at the paper's frequency and from 4 to 40 rad/s, slipping and sticking: rotation, growth, decay without
    drive."""
    frequencies = [float(f"{w:.4g}") for w in np.geomspace(4.0, 40.0, 25)]
    curves = []
    at_paper: list[float] = []
    growths: list[float] = []
    died: list[bool] = []
    for name, values in (("slipping, mu 0.4/0.2", {}), ("sticking, mu 1.0", NO_SLIDING)):
        base = STACK.but(FOR_MAPS, values)
        group = [
            base.but(frequency=frequency, duration=20.0, what=f"stack, {name}, 50 mm at {frequency:g} rad/s")
            for frequency in frequencies
        ]
        rows = experiments.rows(group, also_failed=True)
        ratios = [capped_ratio(row) for row in rows]
        worst = int(np.nanargmax(ratios))
        standing = [ratio if stands(row) else -1.0 for ratio, row in zip(ratios, rows, strict=True)]
        widest = group[int(np.nanargmax(standing))]
        ended = widest.but(cycles=20.0, duration=30.0, what=f"{widest.what}, 20 cycles, then rest")
        yield group[worst]
        yield ended
        at_paper.append(float(experiments.row(base)["rotation_ratio"]))
        growths.append(_growth(experiments, widest))
        died.append(bool(experiments.row(ended)["restored"]))
        curves.append(PlottedLine(x=frequencies, y=ratios, label=name, style="o-"))
        overturned = sum(not stands(row) for row in rows)
        growth = f"{name}: rotation in the last 5 s over that before, widest that stands"
        decay = f"{name}: without drive the motion dies out, widest that stands"
        yield at_most(f"{name}: rotation ratio at the paper's 6.928 rad/s", at_paper[-1], 0.5)
        yield at_most(f"{name}: largest rotation ratio from 4 to 40 rad/s", ratios[worst], 0.5, inside=False)
        yield at_most(f"{name}: frequencies at which it overturns", overturned, 0.0, inside=False)
        yield at_most(growth, growths[-1], 1.05, inside=False)
        yield at_least(decay, died[-1], 1.0, inside=False)
    yield (
        f"At 6.928 rad/s 50 mm are {0.05 * ANGULAR_FREQUENCY**2:.2f} m/s² against g a/c = {UPLIFT:.2f} m/s²: the "
        f"rotation there is {max(at_paper):.2g} of beta. At other frequencies the same 50 mm turn the stack to "
        f"{max(float(np.nanmax(line.y)) for line in curves):.2f} of beta (1: overturned), which the ratio of "
        f"50 mm to a/2 does not show. In the last 5 s the largest motion that stands reaches {max(growths):.2f} of "
        f"its rotation before, and {sum(died)} of {len(died)} such motions die out after the drive ends."
    )
    yield draw_curves(
        "within-the-limit-cycle",
        "Largest rotation over beta (1: overturned) of the rigid stack under 50 mm, over frequency.",
        curves,
        x_label="angular frequency [rad/s]",
        y_label="rotation ratio [-]",
        log_x=True,
    )
    yield experiments.band(
        STACK.but(duration=10.0),
        quantity="rotation ratio at the paper's frequency",
        criterion="at most half of beta",
        holds=lambda row: stands(row) and row["rotation_ratio"] <= 0.5,
    )


def _growth(experiments: Experiments, case: PaperCase) -> float:
    """Largest rotation of the last 5 s of a run over the largest before."""
    history = experiments.run(case.but(interval=0.02)).history
    time, rotation = history["time_s"], np.abs(history["rotation_rad"])
    late = time >= time[-1] - 5.0
    return float(rotation[late].max() / rotation[~late].max())
