"""Section 7 of the paper: its printed numbers, with g = 10 and g = 9.81, and what it concludes on one box and on four.

A printed number has half a unit of its last digit as tolerance.
"""

import math
from itertools import product

import numpy as np
from evidence.findings import Finding, at_least, at_most, equal, failures
from paper.cases import BOX, FOR_MAPS, G_TEN, NO_SLIDING, PLATEAU, RIGID, SHELL, STACK
from paper.claims import Curve, Evidence, claim, draw_curves, outcomes
from paper.dimensions import ANGULAR_FREQUENCY, GRAVITY, HALF_WIDTH, PLATEAU_PEAK, STATED_PEAK, UPLIFT
from paper.experiments import Experiments, capped_ratio, stands
from verification.statics import BOX_HEIGHT, BOX_MASS, WIDTH, paper_checks

from fem.results.outcome import Outcome

SLIDING = 1e-4 * 1.1  # m, what counts as sliding
TILTING = 0.01  # rotation ratio, what counts as tilting
#: EN 1998-1:2004, Tables 3.2 and 3.3: T_C and T_D of the rows that the paper mixes
#: design ground displacements [mm] by Eq. (3.12), with the paper's a_g and S: of ground D, type 1, and C, type 2
LONG, SHORT = (0.025 * 1.6 * 1.5 * control * end * 1e3 for control, end in ((0.8, 2.0), (0.25, 1.2)))


@claim(
    "7, one box",
    "In this example, the body will just remain in the sticking mode and will not tilt",
    bounds="under the stated motion, and up to half a per cent below the plateau value with g = 10",
)
def box_just_sticks(experiments: Experiments) -> Evidence:
    """Rigid box under the stated motion and the plateau value, g = 10 and 9.81 m/s²."""
    box = BOX.but(RIGID)
    plateau = box.but(peak=PLATEAU_PEAK, frequency=ANGULAR_FREQUENCY)
    below = [
        box.but(what="box, stated motion, g = 9.81"),
        box.but(G_TEN, what="box, stated motion, g = 10"),
        plateau.but(G_TEN, peak=3.98, what="box, 3.98 m/s², g = 10"),
    ]
    at_plateau = [
        plateau.but(G_TEN, what="box, plateau value, g = 10"),
        plateau.but(what="box, plateau value, g = 9.81"),
    ]
    cases = [*below, *at_plateau]
    rows = experiments.rows(cases)
    slips = [1e3 * row["max_slip_m"] for row in rows]
    tilts = [row["first_uplift_s"] is not None for row in rows]
    for case, slip, tilted in zip(cases, slips, tilts, strict=True):
        yield at_most(f"slip, {case.what}", slip, 1e3 * SLIDING, "mm", inside=case in below)
        yield at_most(f"tilts, {case.what}", tilted, 0.0)
    yield (
        f"The box tilts in {sum(tilts)} of {len(rows)} runs. At the plateau value the utilisation of stiction is "
        f"{PLATEAU_PEAK / (0.4 * 10.0):.3f} with g = 10, where rounding decides: the run slides by up to "
        f"{slips[3]:.1f} mm. With 9.81 it is {PLATEAU_PEAK / (0.4 * GRAVITY):.3f}, and the slip {slips[4]:.1f} mm."
    )
    yield from cases
    yield experiments.band(
        cases[0].but(duration=10.0),
        "slip under the stated motion",
        "rest",
        lambda row: row["outcome"] == Outcome.REST,
        value=lambda row: row["max_slip_m"],
        unit="m",
    )


@claim(
    "7, four boxes",
    "In this example, the body will just remain in the sticking mode and will tilt",
    bounds="the rigid body",
)
def stack_tilts_at_plateau(experiments: Experiments) -> Evidence:
    """The stack on a floor that reaches the plateau value, to which the paper's 40 kN and 80 kNm belong; rigid and
    shell, g = 10 and 9.81 m/s²."""
    cases = [
        PLATEAU.but(model, gravity, what=f"{kind}, plateau value, g = {g}")
        for kind, model in (("rigid stack", RIGID), ("shell", SHELL))
        for g, gravity in (("10", G_TEN), ("9.81", {}))
    ]
    for case, row in zip(cases, experiments.rows(cases), strict=True):
        slip, rigid = 1e3 * row["max_slip_m"], case.values["solver.model"] == "rigid"
        yield at_least(f"rotation ratio, {case.what}", row["rotation_ratio"], TILTING, inside=rigid)
        yield at_most(f"slip, {case.what}", slip, 1e3 * SLIDING, "mm", inside=rigid)
    overturned = sum(not stands(row) for row in experiments.rows(cases))
    yield (
        f"With g = 9.81 the static check of sliding has a utilisation of {PLATEAU_PEAK / (0.4 * GRAVITY):.3f}; it "
        'assumes a base shear of m a(t), which holds only until the stack rocks. "Will tilt" is not "falls": '
        f"{overturned} of {len(cases)} runs overturn."
    )
    yield from cases
    yield outcomes("What the stack does", experiments, cases)
    yield experiments.band(
        PLATEAU.but(duration=10.0),
        "rotation ratio",
        "it tilts (0.01 and more) and does not slide",
        lambda row: row["outcome"] == Outcome.ROCK,
    )


@claim("7", "This corresponds to a harmonic base acceleration of 2,4 m/s²", kind="remark")
def stack_tilts_as_stated(experiments: Experiments) -> Evidence:
    """The stack under 50 mm at 6.928 rad/s, rigid and shell, started moving and with a jerk."""
    moving = [
        STACK.but(RIGID, G_TEN, what="rigid stack, stated motion, g = 10"),
        STACK.but(RIGID, what="rigid stack, stated motion, g = 9.81"),
        STACK.but(SHELL, what="shell, stated motion, g = 9.81"),
    ]
    jerk = STACK.but(RIGID, {"motion.start": "rest"})
    jerked = [
        jerk.but(what="rigid stack, the floor jerks at t = 0, mu_k = mu_s/2"),
        jerk.but(mu_kinetic=0.4, what="rigid stack, the floor jerks at t = 0, mu_k = mu_s"),
    ]
    rows = experiments.rows([*moving, *jerked])
    tilted = sum(row["rotation_ratio"] >= TILTING for row in rows[:3])
    yield (
        'That the four boxes "will tilt" is said of F_b = 40 kN and M_T = 80 kNm, which belong to the plateau value of '
        f"{PLATEAU_PEAK:.1f} m/s². The motion that the paper states reaches {STATED_PEAK:g} m/s², against g a/c = "
        f"{UPLIFT:.2f} m/s²: under it the stack tilts in {tilted} of {len(moving)} runs. If the container does not "
        f"move with the floor at t = 0, the floor starts with a velocity step of {0.05 * ANGULAR_FREQUENCY:.2f} m/s, "
        "which causes the motion that follows."
    )
    yield from (*moving, *jerked)
    yield outcomes("What the stack does", experiments, [*moving, *jerked])
    yield experiments.band(
        STACK.but(duration=10.0), "rotation ratio", "rest", lambda row: row["outcome"] == Outcome.REST
    )


@claim(
    "7",
    "50 mm is << a/2 ... Regardless of sticking or slipping the tilting of the body will remain well "
    "within the limit cycle. Thus, Lyapunov stability is given",
    bounds="at the paper's frequency",
)
def within_the_limit_cycle(experiments: Experiments) -> Evidence:
    """50 mm at the paper's frequency and from 4 to 40 rad/s, slipping and sticking: rotation, growth, decay without
    drive."""
    frequencies = [float(f"{w:.4g}") for w in np.geomspace(4.0, 40.0, 25)]
    curves, at_paper, growths, died = [], [], [], []
    for name, values in (("slipping, mu 0.4/0.2", {}), ("sticking, mu 1.0", NO_SLIDING)):
        base = STACK.but(FOR_MAPS, values)
        group = base.but(duration=20.0).scan(
            "frequency", frequencies, f"stack, {name}, 50 mm at {{:g}} rad/s"
        )
        rows = experiments.rows(group, also_failed=True)
        ratios = [capped_ratio(row) for row in rows]
        worst = int(np.nanargmax(ratios))
        standing = [ratio if stands(row) else -1.0 for ratio, row in zip(ratios, rows, strict=True)]
        widest = group[int(np.nanargmax(standing))]
        ended = widest.but(cycles=20.0, duration=30.0, what=f"{widest.what}, 20 cycles, then rest")
        yield group[worst]
        yield ended
        at_paper.append(float(experiments.row(base)["rotation_ratio"]))
        history = experiments.run(widest.but(interval=0.02)).history
        time, rotation = history["time_s"], np.abs(history["rotation_rad"])
        late = time >= time[-1] - 5.0
        growths.append(float(rotation[late].max() / rotation[~late].max()))
        died.append(bool(experiments.row(ended)["restored"]))
        curves.append(Curve(frequencies, ratios, name, "o-"))
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
        f"rotation there is {max(at_paper):.2g} of the slenderness angle. At other frequencies the same 50 mm turn "
        f"the stack to {max(float(np.nanmax(line.y)) for line in curves):.2f} of the slenderness angle (1: "
        "overturned), which the ratio of 50 mm to a/2 does not show. In the last 5 s the largest motion that stands "
        f"reaches {max(growths):.2f} of its rotation before, and {sum(died)} of {len(died)} such motions die out "
        "after the drive ends."
    )
    yield draw_curves(
        "within-the-limit-cycle",
        "Largest rotation over the slenderness angle (1: overturned) of the rigid stack under 50 mm, over frequency.",
        "angular frequency [rad/s] | rotation ratio [-]",
        curves,
        log_x=True,
    )
    yield experiments.band(
        STACK.but(duration=10.0),
        "rotation ratio at the paper's frequency",
        "at most half of the slenderness angle",
        lambda row: stands(row) and row["rotation_ratio"] <= 0.5,
    )


@claim(
    "7, Eqs. 14-19",
    "F_lim = 10 kN, M_R = -13,8 kNm, 5 kN, F_b = 10 kN, M_T = 5 kNm, T = 1,98 s",
    bounds="g = 10 m/s²",
)
def numbers_one_box(experiments: Experiments) -> Evidence:
    """Recomputed by the static rules of the program, with g = 10 and 9.81 m/s²."""
    checks = paper_checks(boxes=1, gravity=10.0)
    density = BOX_MASS / (WIDTH * WIDTH * BOX_HEIGHT)
    yield from _recomputed(
        1,
        equal("virtual density", density, 2066.0, 0.5, "kg/m³"),
        equal("Eq. 14, stiction limit", checks.sliding_limit_static / 1e3, 10.0, 0.5, "kN"),
        equal("Eq. 15, restoring moment", checks.restoring_moment / 1e3, 13.8, 0.05 + 1e-9, "kNm"),
        equal("Eq. 16, sliding limit", checks.sliding_limit_kinetic / 1e3, 5.0, 0.5, "kN"),
        equal("Eq. 17, plateau base shear", checks.code.sliding.demand / 1e3, 10.0, 0.5, "kN"),
        equal("Eq. 18, tilting moment", checks.code.overturning.demand / 1e3, 5.0, 0.5, "kNm"),
        equal("Eq. 19, period", checks.period_eq3, 1.98, 0.005, "s"),
    )


@claim("7", "F_lim = 40 kN; M_R = -55,0 kNm; F_b = 40 kN; M_T = 80 kNm; T = 3,30 s", bounds="g = 10 m/s²")
def numbers_four_boxes(experiments: Experiments) -> Evidence:
    """Recomputed by the static rules of the program, with g = 10 and 9.81 m/s²."""
    checks = paper_checks(boxes=4, gravity=10.0)
    yield from _recomputed(
        4,
        equal("stiction limit", checks.sliding_limit_static / 1e3, 40.0, 0.5, "kN"),
        equal("restoring moment", checks.restoring_moment / 1e3, 55.0, 0.05, "kNm"),
        equal("plateau base shear", checks.code.sliding.demand / 1e3, 40.0, 0.5, "kN"),
        equal("tilting moment", checks.code.overturning.demand / 1e3, 80.0, 0.5, "kNm"),
        equal("period", checks.period_eq3, 3.30, 0.005, "s"),
    )


def _recomputed(boxes: int, *printed: Finding) -> Evidence:
    """The printed numbers, and with g = 10 and 9.81 m/s² whether the base shear is within stiction."""
    ten, full = (paper_checks(boxes=boxes, gravity=gravity) for gravity in (10.0, 9.81))
    stiction = [checks.code.sliding.utilisation for checks in (ten, full)]
    tilting = [checks.code.overturning.utilisation for checks in (ten, full)]
    yield from printed
    shear = "code base shear over stiction limit, g ="
    yield at_most(f"{shear} 10 m/s²", round(stiction[0], 12), 1.0)
    yield at_most(f"{shear} 9.81 m/s²", round(stiction[1], 12), 1.0, inside=False)
    yield (
        f"{len(printed) - failures(printed)} of {len(printed)} printed numbers follow with g = 10 m/s². With g = 10 "
        f"and 9.81 m/s² the base shear is {stiction[0]:.3f} and {stiction[1]:.3f} of the stiction limit, the tilting "
        f"moment {tilting[0]:.3f} and {tilting[1]:.3f} of the restoring one (above 1 the static rule predicts "
        f"sliding, or tilting), and the period {ten.period_eq3:.3f} and {full.period_eq3:.3f} s."
    )


@claim("7", "a/2 = 600 mm", kind="print")
def half_width(experiments: Experiments) -> Evidence:
    """Half of the width that the paper gives."""
    half = 1e3 * HALF_WIDTH
    yield equal("a/2 of a container 1.100 mm wide", half, 600.0, 5.0, "mm")
    yield (
        f"a/2 is {half:.0f} mm; in print it is {600.0 / half - 1.0:.0%} more. The sentence, 50 mm << a/2, does not "
        f"depend on it: 50 mm is {50.0 / half:.2f} of the one and {50.0 / 600.0:.2f} of the other."
    )


@claim(
    "7",
    "a harmonic base acceleration of 2,4 m/s² corresponding to ... an amplitude of app. 50 mm",
    bounds=f"between {SHORT:.0f} mm and {LONG:.0f} mm, depending on the ground",
)
def amplitude_50_mm(experiments: Experiments) -> Evidence:
    """Compared with the design ground displacement of the code; the stack runs with the amplitudes of both grounds at
    the stated and at the plateau acceleration."""
    cases = []
    for peak, amplitude in product((STATED_PEAK, PLATEAU_PEAK), (0.001 * SHORT, 0.05, 0.001 * LONG)):
        frequency = float(f"{math.sqrt(peak / amplitude):.5g}")
        what = f"stack, {peak:g} m/s² at {1e3 * amplitude:.0f} mm"
        cases.append(PLATEAU.but(RIGID, peak=peak, frequency=frequency, what=what))
    rows = experiments.rows(cases)
    stated, plateau = (
        ", ".join(f"{row['rotation_ratio']:.2g}" for row in half) for half in (rows[:3], rows[3:])
    )
    against = "A against Eq. 3.12 with"
    yield at_least("A, from below", 50.0, SHORT, "mm")
    yield at_most("A, from above", 50.0, LONG, "mm")
    yield equal(f"{against} T_C = 0.8 s, T_D = 2 s", 50.0, LONG, 0.1 * LONG, "mm", inside=False)
    yield equal(f"{against} T_C = 0.25 s, T_D = 1.2 s", 50.0, SHORT, 0.1 * SHORT, "mm", inside=False)
    yield (
        f"EN 1998-1:2004, Eq. 3.12, d_g = 0.025 a_g S T_C T_D, gives {LONG:.0f} mm with the paper's "
        f"T_C = 0.8 s (ground D, type 1) and {SHORT:.0f} mm with the row that its S = 1.5 belongs to "
        "(ground C, type 2, T_C = 0.25 s): S and T_C belong to two different grounds. With the smaller, "
        f"the paper's and the larger amplitude the stack rotates by {stated} of the slenderness angle at "
        f"{STATED_PEAK:g} m/s² and by {plateau} at {PLATEAU_PEAK:.1f} m/s²."
    )
    yield from cases
