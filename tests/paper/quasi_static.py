"""Sections 5.1 to 5.3: the limit conditions of sticking, sliding and tilting, Eqs. (7) to (13), one by one."""

import math
from collections.abc import Sequence

import numpy as np
from closed_forms import holding_acceleration
from evidence.findings import Finding, at_least, at_most, equal
from paper.cases import BOX, FOR_MAPS, NO_SLIDING, RIGID, SHELL, STACK, PaperCase, friction
from paper.claims import Curve, Evidence, claim, draw_curves
from paper.dimensions import ANGULAR_FREQUENCY, GRAVITY, HALF_WIDTH, UPLIFT, WIDTH
from paper.experiments import Experiments

from fem.results.outcome import SLIDING, Outcome

#: a scan around a limit: peaks over the limit, and how near the onset must be
AROUND = tuple(round(0.95 + 0.005 * n, 4) for n in range(21))
NEAR = 0.01
#: a flat bed carries on its outer 15 % when the resultant is at 0.9 of the half width
AROUND_FLAT = tuple(round(0.8 + 0.01 * n, 4) for n in range(26))
TURNING = 0.2  #: s, in which a released container shows where it goes


@claim("5.1, Eqs. 7, 8", "F_F^S(t) = m a(t) <= G mu_s")
def stiction_limit(experiments: Experiments) -> Evidence:
    """Scan of the peak acceleration around mu_s g, for four coefficients of friction, rigid box."""
    comparisons = []
    for mu in (0.2, 0.3, 0.4, 0.5):
        box = BOX.but(FOR_MAPS, friction(mu, 0.5 * mu), frequency=ANGULAR_FREQUENCY)
        peaks = [share * mu * GRAVITY for share in AROUND]
        scan = box.scan("peak", peaks, f"box, mu_s = {mu:g}, peak {{:.4g}} m/s²")
        slides = [row["outcome"] in SLIDING for row in experiments.rows(scan)]
        comparisons.append(_onset(f"onset of sliding over mu_s g, mu_s = {mu:g}", slides))
        yield _first(scan, slides)
    yield from comparisons
    yield (
        f"In a scan by {100.0 * (AROUND[1] - AROUND[0]):.1f} % the box begins to slide at {_between(comparisons)} "
        "of mu_s g."
    )
    yield experiments.band(
        BOX.but(peak=0.98 * 0.4 * GRAVITY, frequency=ANGULAR_FREQUENCY, duration=5.0),
        "slip at 0.98 mu_s g",
        "it sticks",
        lambda row: row["outcome"] == Outcome.REST,
        value=lambda row: row["max_slip_m"],
        unit="m",
    )


@claim(
    "5.2, Eq. 11", "F_F^k(t) = m a(t) <= G mu_k; compared to stiction, the accelerating base shear is reduced"
)
def kinetic_limit(experiments: Experiments) -> Evidence:
    """The shear force of a rigid box while it slides under 5.0 m/s², mu 0.4/0.2."""
    case = BOX.but(
        RIGID, frequency=10.0, duration=8.0, interval=0.002, what="box, 50 mm at 10 rad/s: 5.0 m/s²"
    )
    run = experiments.run(case)
    history, weight = run.history, run.model.static.weight
    sliding = np.array([mode == Outcome.SLIDE for mode in history.modes])
    time, shear = history["time_s"], history["shear_force_N"] / weight
    while_sliding = float(np.quantile(np.abs(history["shear_force_N"][sliding]) / weight, 0.99))
    acceleration = history["base_acceleration_m_s2"]
    floor = np.abs(acceleration).max()
    early = time <= 2.0
    yield at_most("shear force over weight while sliding, 99 % of the samples", while_sliding, 0.2 * 1.005)
    reduced = while_sliding * GRAVITY / floor
    yield at_most("largest acceleration of the sliding box over the floor's", reduced, 1.0)
    yield (
        f"While it slides the box is accelerated by up to {while_sliding * GRAVITY:.2f} m/s², against mu_k g = "
        f"{0.2 * GRAVITY:.2f} m/s² and {floor:.1f} m/s² of the floor. The acceleration in Eq. 11 is the body's, "
        "that in Eq. 8 the floor's; the paper writes both a(t)."
    )
    yield case
    yield draw_curves(
        "kinetic-limit",
        "Shear force over weight of the box, and the force that sticking would require.",
        "time [s] | force / weight [-]",
        [
            Curve(time[early], shear[early], "shear force / weight"),
            Curve(time[early], -acceleration[early] / GRAVITY, "required for sticking", "--"),
        ],
        levels={"mu_s": 0.4, "mu_k": 0.2},
    )


@claim("5.1, Eqs. 9, 10", "M_T(t) = m a(t) c/2, M_R = -G a/2", bounds="a base that stands on its two corners")
def uplift_limit(experiments: Experiments) -> Evidence:
    """Scan of the peak acceleration around g a/c for two, three and four boxes that cannot slide."""
    base = STACK.but(FOR_MAPS, NO_SLIDING, duration=5.0, frequency=ANGULAR_FREQUENCY)
    comparisons = []
    for boxes, kind in ((2, "corners"), (3, "corners"), (4, "corners"), (4, "flat")):
        shares = AROUND_FLAT if kind == "flat" else AROUND
        peaks = [share * GRAVITY * WIDTH / boxes for share in shares]
        stack = base.but(boxes=boxes, support=kind)
        scan = stack.scan("peak", peaks, f"{boxes} boxes on {kind}, peak {{:.4g}} m/s²")
        tilts = [row["first_uplift_s"] is not None for row in experiments.rows(scan)]
        what = f"onset of tilting over g a/c, {boxes} boxes on {kind}"
        comparisons.append(_onset(what, tilts, shares, inside=kind == "corners"))
        yield _first(scan, tilts)
    flat = base.but(support="flat")
    opening = [flat.but(peak=share * UPLIFT / 3.0) for share in AROUND]
    opens = [row["first_opening_s"] is not None for row in experiments.rows(opening)]
    third = _onset("first opening of an edge over g a/(3 c), 4 boxes on flat", opens)
    yield from comparisons
    yield third
    yield (
        f"On corners the stack begins to turn at {_between(comparisons[:-1])} of g a/c. A flat base on an "
        f"elastic bed opens at its edge at {third.value:.2f} of g a/(3 c) already, when the resultant of the linear "
        "pressure leaves the middle third; this is not tilting. It tilts, about a narrow strip, at "
        f"{comparisons[-1].value:.2f} g a/c."
    )
    yield experiments.band(
        STACK.but(NO_SLIDING, peak=0.97 * UPLIFT, frequency=ANGULAR_FREQUENCY, duration=5.0),
        "rotation ratio at 0.97 g a/c",
        "it does not rock (rotation ratio below 0.01)",
        lambda row: row["rotation_ratio"] < 0.01,
    )


@claim(
    "5.1",
    "Assessment of the quasi-static mode is possible only, if the center of gravity of the body is accelerated instead "
    "of the base",
    kind="remark",
)
def centre_or_base(experiments: Experiments) -> Evidence:
    """Shear force of the sticking stack over mass times floor acceleration, rigid and shell."""
    apart = []
    for model in (RIGID, SHELL):
        case = STACK.but(model, duration=5.0, what=f"stack, {model['solver.model']}, 50 mm at 6.928 rad/s")
        run = experiments.run(case)
        shear = np.abs(run.history["shear_force_N"]).max()
        floor = run.model.container.mesh.mass * np.abs(run.history["base_acceleration_m_s2"]).max()
        apart.append(abs(float(shear / floor) - 1.0))
        yield case
    no_difference = "it makes no difference" if max(apart) <= NEAR else "it makes that difference"
    yield (
        f"While the container sticks, its mean acceleration is the floor's within {apart[0]:.2%} (rigid) and "
        f"{apart[1]:.2%} (shell): {no_difference} to the quasi-static limits which of the two is accelerated."
    )


@claim(
    "5.3, Eqs. 12, 13",
    "M_T = m a c/(2 sin alpha) sin(phi + alpha), M_R = -G a/(2 cos alpha) cos(phi + alpha)",
)
def moments_of_a_tilted_body(experiments: Experiments) -> Evidence:
    """Rigid stack released at rest at three rotations on a floor that accelerates 2 % beside their balance."""
    rows = []
    block = experiments.block(STACK)
    for share in (0.2, 0.5, 0.8):
        rotation = share * block.slenderness_angle
        balance = holding_acceleration(block, rotation)
        pair = [_released(rotation, factor * balance) for factor in (0.98, 1.02)]
        back, away = (1e3 * _turn(experiments, case) for case in pair)
        yield from pair
        rows.append((back, away))
        what = f"turn in {TURNING} s at {share:g} of the slenderness angle (balance {balance:.2f} m/s²), 2 %"
        yield at_most(f"{what} below the balance of Eqs. 12, 13", back, 0.0, "mrad")
        yield at_least(f"{what} above it", away, 0.0, "mrad")
    yield (
        "The moments of Eqs. 12 and 13 balance at a(t) = g cot(phi + alpha). Two per cent below it the stack "
        f"comes back from {sum(back < 0.0 for back, _ in rows)} of {len(rows)} rotations, two per cent "
        f"above it falls from {sum(away > 0.0 for _, away in rows)}."
    )


@claim("5.3, below Eq. 13", "Note, that the restoring moments is negative for phi > beta")
def sign_beyond_balance(experiments: Experiments) -> Evidence:
    """The stack released at rest beside the slenderness angle, and the sign of Eq. 13 as printed."""
    angle = experiments.block(STACK).slenderness_angle
    alpha = 0.5 * math.pi - angle
    weight = 98100.0  # N

    def restoring(rotation: float) -> float:  # Eq. (13) as printed [kNm]
        return -weight * HALF_WIDTH / math.cos(alpha) * math.cos(rotation + alpha) / 1e3

    beyond, before = restoring(1.02 * angle), restoring(0.98 * angle)
    cases = [_released(factor * angle, 0.0) for factor in (1.02, 0.98)]
    falls, returns = (1e3 * _turn(experiments, case) for case in cases)
    yield at_most(
        f"turn in {TURNING} s, released at rest at 0.98 of the slenderness angle", returns, 0.0, "mrad"
    )
    yield at_least(
        f"turn in {TURNING} s, released at rest at 1.02 of the slenderness angle", falls, 0.0, "mrad"
    )
    yield at_least(
        "size of the restoring moment, -M_R of Eq. 13, at 0.98 of the slenderness angle", -before, 0.0, "kNm"
    )
    yield at_most(
        "size of the restoring moment, -M_R of Eq. 13, at 1.02 of the slenderness angle", -beyond, 0.0, "kNm"
    )
    yield (
        f"Released at rest, the stack turns by {returns:+.2f} mrad in {TURNING} s from 0.98 of the slenderness angle "
        f"and by {falls:+.2f} mrad from 1.02 of the slenderness angle. Only the sign is reversed in print: the "
        "sentence counts a restoring moment as positive, Eqs. 10, 13 and 15 as negative; Eq. 13 as printed is "
        f"{before:+.2f} kNm at 0.98 of the slenderness angle and {beyond:+.2f} kNm at 1.02 of the slenderness angle."
    )
    yield from cases


def _released(rotation: float, acceleration: float) -> PaperCase:
    """The stack released at rest on a floor of constant acceleration."""
    motion = {
        "motion.kind": "pulse",
        "motion.shape": "rectangular",
        # a floor that goes to the left tilts the container to the right
        "motion.peak_acceleration_m_s2": -float(f"{acceleration:.8g}"),
        "motion.pulse_s": 1.0,
    }
    return STACK.but(
        RIGID,
        NO_SLIDING,
        motion if acceleration else {"motion.kind": "none"},
        rotation=rotation,
        duration=TURNING,
        interval=0.01,
        what=f"stack released at {rotation:.4f} rad, floor at {-acceleration:.3f} m/s²",
    )


def _turn(experiments: Experiments, case: PaperCase) -> float:
    """Rotation after 0.2 s less that at the start [rad]."""
    history = experiments.run(case).history
    # beyond the balance the run continues until the container has fallen
    after = float(np.interp(TURNING, history["time_s"], history["rotation_rad"]))
    return after - float(history["rotation_rad"][0])


def _between(onsets: Sequence[Finding]) -> str:
    """The smallest and the largest of some onsets."""
    values = [onset.value for onset in onsets]
    return f"{min(values):.4f} to {max(values):.4f}"


def _first(scan: Sequence[PaperCase], seen: list[bool]) -> PaperCase:
    """The first case of a scan that shows something; the last one if none does."""
    return scan[seen.index(True)] if True in seen else scan[-1]


def _onset(
    what: str, seen: list[bool], shares: tuple[float, ...] = AROUND, *, inside: bool = True
) -> Finding:
    """Where a scan first sees something, if it sees it from there on; else nan."""
    first = seen.index(True) if True in seen else 0
    measured = 0.5 * (shares[first - 1] + shares[first]) if first and all(seen[first:]) else math.nan
    return equal(what, measured, 1.0, NEAR, inside=inside)
