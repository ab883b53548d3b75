"""Sections 5.1 to 5.3: the limit conditions of sticking, sliding and tilting, Eqs. (7) to (13), one by one."""

import math
from collections.abc import Sequence

import numpy as np

from contact.reference.closed_forms_rocking import holding_acceleration
from fem.assessment.rigid_check import block_of
from fem.paper.cases import (
    ANGULAR_FREQUENCY,
    BOX,
    FOR_MAPS,
    GRAVITY,
    HALF_WIDTH,
    NO_SLIDING,
    STACK,
    WIDTH,
    harmonic,
)
from fem.paper.claims import Comparison, Finding, Setup, Statement, Table
from fem.paper.experiments import RIGID, Laboratory
from fem.paper.figures import Line, drawing

#: a scan around a limit: peaks over the limit, and how near the onset must lie
AROUND = tuple(round(0.95 + 0.005 * n, 4) for n in range(21))
NEAR = 0.01
#: a flat bed carries on its outer 15 % when the resultant is at 0.9 of the half width
AROUND_FLAT = tuple(round(0.8 + 0.01 * n, 4) for n in range(26))
TURNING = 0.2  #: s, in which a released container shows where it goes


def stiction_limit(laboratory: Laboratory) -> Finding:
    """Eq. (8): from which floor acceleration on a box slides."""
    comparisons, setups = [], []
    for friction in (0.2, 0.3, 0.4, 0.5):
        scan = [
            BOX.but(
                {
                    **FOR_MAPS,
                    "contact.mu_static": friction,
                    "contact.mu_kinetic": 0.5 * friction,
                    **harmonic(share * friction * GRAVITY, ANGULAR_FREQUENCY),
                },
                f"box, mu_s = {friction:g}, peak {share:g} of mu_s g",
            )
            for share in AROUND
        ]
        slides = [row["outcome"] in ("slide", "slide-rock") for row in laboratory.rows(scan)]
        comparisons.append(_onset(f"onset of sliding over mu_s g, mu_s = {friction:g}", slides))
        setups.append(scan[slides.index(True)] if True in slides else scan[-1])
    return Finding(
        comparisons=tuple(comparisons),
        reading=(
            f"In a scan by {100.0 * (AROUND[1] - AROUND[0]):.1f} % the box begins to slide at {_between(comparisons)} "
            "of mu_s g."
        ),
        setups=tuple(setups),
        band=laboratory.band(
            BOX.but({**harmonic(0.98 * 0.4 * GRAVITY, ANGULAR_FREQUENCY), "solver.duration_s": 5.0}),
            quantity="slip at 0.98 mu_s g",
            unit="m",
            value=lambda row: row["max_slip_m"],
            criterion="it sticks",
            holds=lambda row: row["outcome"] == "rest",
        ),
    )


def kinetic_limit(laboratory: Laboratory) -> Finding:
    """Eq. (11): what accelerates a sliding box."""
    setup = BOX.but(
        {
            **RIGID,
            "motion.angular_frequency_rad_s": 10.0,
            "solver.duration_s": 8.0,
            "output.history_s": 0.002,
        },
        "box, 50 mm at 10 rad/s: 5.0 m/s²",
    )
    record = laboratory.record(setup)
    history, weight = record.history, record.model.static.weight
    sliding = np.array([mode == "slide" for mode in history.modes])
    shear = np.abs(history["shear_force_N"]) / weight
    while_sliding = float(np.quantile(shear[sliding], 0.99))
    floor = np.abs(history["base_acceleration_m_s2"]).max()
    window = history["time_s"] <= 2.0
    return Finding(
        comparisons=(
            Comparison(
                what="shear force over weight while sliding, 99 % of the samples",
                measured=while_sliding,
                relation="<=",
                limit=0.2 * 1.005,
                unit="-",
            ),
            Comparison(
                what="largest acceleration of the sliding box over the floor's",
                measured=while_sliding * GRAVITY / floor,
                relation="<=",
                limit=1.0,
                unit="-",
            ),
        ),
        reading=(
            f"While it slides the box is accelerated by up to {while_sliding * GRAVITY:.2f} m/s², against mu_k g = "
            f"{0.2 * GRAVITY:.2f} m/s² and {floor:.1f} m/s² of the floor. The acceleration in Eq. 11 is the body's, "
            "that in Eq. 8 the floor's; the paper writes both a(t)."
        ),
        setups=(setup,),
        drawings=(
            drawing(
                "kinetic-limit",
                "Shear force over weight of the box, and what sticking would need.",
                [
                    Line(
                        x=history["time_s"][window],
                        y=history["shear_force_N"][window] / weight,
                        label="shear force / weight",
                    ),
                    Line(
                        x=history["time_s"][window],
                        y=-history["base_acceleration_m_s2"][window] / GRAVITY,
                        label="what sticking would need",
                        style="--",
                    ),
                ],
                x_label="time [s]",
                y_label="force / weight [-]",
                levels={"mu_s": 0.4, "mu_k": 0.2},
            ),
        ),
    )


def uplift_limit(laboratory: Laboratory) -> Finding:
    """Eqs. (9) and (10): from which floor acceleration on a stack turns about a corner."""
    comparisons, setups = [], []
    for boxes, kind in ((2, "corners"), (3, "corners"), (4, "corners"), (4, "flat")):
        limit = GRAVITY * WIDTH / boxes
        values = {"container.boxes": boxes, "support.kind": kind, "solver.duration_s": 5.0}
        shares = AROUND_FLAT if kind == "flat" else AROUND
        scan = [
            STACK.but(
                {**FOR_MAPS, **NO_SLIDING, **values, **harmonic(share * limit, ANGULAR_FREQUENCY)},
                f"{boxes} boxes on {kind}, peak {share:g} of g a/c",
            )
            for share in shares
        ]
        tilts = [row["first_uplift_s"] is not None for row in laboratory.rows(scan)]
        what = f"onset of tilting over g a/c, {boxes} boxes on {kind}"
        comparisons.append(_onset(what, tilts, shares, inside=kind == "corners"))
        setups.append(scan[tilts.index(True)] if True in tilts else scan[-1])
    values = {**FOR_MAPS, **NO_SLIDING, "support.kind": "flat", "solver.duration_s": 5.0}
    opening = [
        STACK.but({**values, **harmonic(share * GRAVITY * WIDTH / 12.0, ANGULAR_FREQUENCY)})
        for share in AROUND
    ]
    opens = [row["first_opening_s"] is not None for row in laboratory.rows(opening)]
    third = _onset("first opening of an edge over g a/(3 c), 4 boxes on flat", opens)
    return Finding(
        comparisons=(*comparisons, third),
        bounds="a base that stands on its two corners",
        reading=(
            f"On corners the stack begins to turn at {_between(comparisons[:-1])} of g a/c. A flat base on an "
            f"elastic bed opens at its edge at {third.measured:.2f} of g a/(3 c) already, as a linear pressure "
            "leaves the middle third, which is no sign of tilting; it turns, about a narrow strip, at "
            f"{comparisons[-1].measured:.2f} g a/c."
        ),
        setups=tuple(setups),
        band=laboratory.band(
            STACK.but(
                {
                    **NO_SLIDING,
                    **harmonic(0.97 * GRAVITY * WIDTH / 4.0, ANGULAR_FREQUENCY),
                    "solver.duration_s": 5.0,
                }
            ),
            quantity="rotation ratio at 0.97 g a/c",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="it does not rock (rotation ratio below 0.01)",
            holds=lambda row: row["rotation_ratio"] < 0.01,
        ),
    )


def centre_or_base(laboratory: Laboratory) -> Finding:
    """Section 5.1: a sticking body moves with the floor."""
    comparisons, setups = [], []
    for model in ("rigid", "reduced"):
        setup = STACK.but(
            {"solver.model": model, "solver.duration_s": 5.0}, f"stack, {model}, 50 mm at 6.928 rad/s"
        )
        record = laboratory.record(setup)
        shear = np.abs(record.history["shear_force_N"]).max()
        floor = record.model.container.mesh.mass * np.abs(record.history["base_acceleration_m_s2"]).max()
        setups.append(setup)
        comparisons.append(
            Comparison(
                what=f"|mean acceleration of the sticking body over the floor's - 1|, {model}",
                measured=abs(float(shear / floor) - 1.0),
                relation=">=",
                limit=0.05,
                unit="-",
            )
        )
    worst = max(one.measured for one in comparisons)
    return Finding(
        comparisons=tuple(comparisons),
        reading=(
            "As long as the container sticks, its mean acceleration is the floor's within "
            f"{100.0 * worst:.2g} %. By so much can it matter to the quasi-static limits whether the floor or the "
            "mass centre is accelerated; the sentence needs a difference that counts, here 5 %."
        ),
        setups=tuple(setups),
    )


def moments_of_a_tilted_body(laboratory: Laboratory) -> Finding:
    """Eqs. (12) and (13): at which constant acceleration a tilted body begins to fall, or comes back."""
    comparisons, rows = [], []
    setups: list[Setup] = []
    block = block_of(laboratory.model(STACK.but(RIGID)))
    angle = block.slenderness_angle
    for share in (0.2, 0.5, 0.8):
        balance = holding_acceleration(block, share * angle)
        back, away = (_turn(laboratory, setups, share * angle, factor * balance) for factor in (0.98, 1.02))
        rows.append((share, balance, back, away))
        comparisons += [
            _sign(
                f"turn in {TURNING} s at {share:g} of beta, 2 % below the balance of Eqs. 12, 13", back, -1.0
            ),
            _sign(f"turn in {TURNING} s at {share:g} of beta, 2 % above it", away, 1.0),
        ]
    return Finding(
        comparisons=tuple(comparisons),
        reading=(
            "The moments of Eqs. 12 and 13 balance at a(t) = g cot(phi + alpha). Two per cent below it the stack "
            f"comes back from {sum(back < 0.0 for _, _, back, _ in rows)} of {len(rows)} rotations, two per cent "
            f"above it falls from {sum(away > 0.0 for *_, away in rows)}."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption=f"Rotation after {TURNING} s less that at the start, released at rest",
                columns=(
                    "phi/beta [-]",
                    "balance [m/s²]",
                    "2 % below [mrad]",
                    "2 % above [mrad]",
                ),
                rows=tuple((share, balance, 1e3 * back, 1e3 * away) for share, balance, back, away in rows),
            ),
        ),
    )


def sign_beyond_balance(laboratory: Laboratory) -> Finding:
    """The remark below Eq. (13): the sign of the restoring moment beyond beta."""
    block = block_of(laboratory.model(STACK.but(RIGID)))
    angle = block.slenderness_angle
    alpha = 0.5 * math.pi - angle
    weight = 98100.0  # N

    def restoring(rotation: float) -> float:  # Eq. (13) as printed
        return -weight * HALF_WIDTH / math.cos(alpha) * math.cos(rotation + alpha)

    setups: list[Setup] = []
    falls, returns = (_turn(laboratory, setups, factor * angle, 0.0) for factor in (1.02, 0.98))
    return Finding(
        comparisons=(
            Comparison(
                what="M_R of Eq. 13 at 1.02 beta",
                measured=restoring(1.02 * angle) / 1e3,
                relation="<=",
                limit=0.0,
                unit="kNm",
            ),
            Comparison(
                what="-M_R of Eq. 13 at 0.98 beta",
                measured=-restoring(0.98 * angle) / 1e3,
                relation="<=",
                limit=0.0,
                unit="kNm",
            ),
        ),
        reading=(
            f"As printed, Eq. 13 is {restoring(0.98 * angle) / 1e3:+.2f} kNm at 0.98 beta and "
            f"{restoring(1.02 * angle) / 1e3:+.2f} kNm at 1.02 beta; a moment that restores is negative. Released at "
            f"rest, the stack turns by {1e3 * returns:+.2f} mrad in {TURNING} s from 0.98 beta and by "
            f"{1e3 * falls:+.2f} mrad from 1.02 beta."
        ),
        setups=tuple(setups),
    )


def _turn(laboratory: Laboratory, setups: list[Setup], rotation: float, acceleration: float) -> float:
    """Rotation after 0.2 s on a floor of constant acceleration, released at rest, less the start [rad]."""
    motion = (
        {
            "motion.kind": "pulse",
            "motion.shape": "rectangular",
            # a floor that goes to the left tilts the container to the right
            "motion.peak_acceleration_m_s2": -float(f"{acceleration:.8g}"),
            "motion.pulse_s": 1.0,
        }
        if acceleration
        else {"motion.kind": "none"}
    )
    setup = STACK.but(
        {
            **RIGID,
            **NO_SLIDING,
            **motion,
            "initial.rotation_rad": float(f"{rotation:.8g}"),
            "solver.duration_s": TURNING,
            "output.history_s": 0.01,
        },
        f"stack released at {rotation:.4f} rad, floor at {-acceleration:.3f} m/s²",
    )
    setups.append(setup)
    history = laboratory.record(setup).history
    # beyond the balance the run goes on until the container has fallen
    after = float(np.interp(TURNING, history["time_s"], history["rotation_rad"]))
    return after - float(history["rotation_rad"][0])


def _between(onsets: Sequence[Comparison]) -> str:
    """The smallest and the largest of some onsets."""
    values = [one.measured for one in onsets]
    return f"{min(values):.4f} to {max(values):.4f}"


def _sign(what: str, measured: float, sign: float) -> Comparison:
    return Comparison(
        what=what, measured=1e3 * measured, relation=">=" if sign > 0.0 else "<=", limit=0.0, unit="mrad"
    )


def _onset(
    what: str, seen: list[bool], shares: tuple[float, ...] = AROUND, *, inside: bool = True
) -> Comparison:
    """Where a scan first sees something, if it sees it from there on; else nan."""
    first = seen.index(True) if True in seen else None
    clean = first is not None and all(seen[first:])
    measured = 0.5 * (shares[first - 1] + shares[first]) if clean and first else math.nan
    return Comparison(
        what=what, measured=measured, relation="=", limit=1.0, unit="-", tolerance=NEAR, inside=inside
    )


STATEMENTS = (
    Statement(
        name="stiction-limit",
        section="5.1, Eqs. 7, 8",
        quote="F_F^S(t) = m a(t) <= G mu_s",
        tried="Scan of the peak acceleration around mu_s g, for four coefficients of friction, rigid box.",
        examine=stiction_limit,
        seconds=2.0,
    ),
    Statement(
        name="kinetic-limit",
        section="5.2, Eq. 11",
        quote="F_F^k(t) = m a(t) <= G mu_k; compared to stiction, the accelerating base shear is reduced",
        tried="The shear force of a rigid box while it slides under 5.0 m/s², mu 0.4/0.2.",
        examine=kinetic_limit,
    ),
    Statement(
        name="uplift-limit",
        section="5.1, Eqs. 9, 10",
        quote="M_T(t) = m a(t) c/2, M_R = -G a/2",
        tried="Scan of the peak acceleration around g a/c for two, three and four boxes that cannot slide.",
        examine=uplift_limit,
        seconds=5.0,
    ),
    Statement(
        name="centre-or-base",
        section="5.1",
        quote=(
            "Assessment of the quasi-static mode is possible only, if the center of gravity ... is "
            "accelerated instead of the base"
        ),
        tried="Shear force of the sticking stack over mass times floor acceleration, rigid and shell.",
        examine=centre_or_base,
    ),
    Statement(
        name="moments-of-a-tilted-body",
        section="5.3, Eqs. 12, 13",
        quote="M_T = m a c/(2 sin alpha) sin(phi + alpha), M_R = -G a/(2 cos alpha) cos(phi + alpha)",
        tried=(
            "Rigid stack released at rest at three rotations on a floor that accelerates 2 % beside their "
            "balance."
        ),
        examine=moments_of_a_tilted_body,
    ),
    Statement(
        name="sign-beyond-balance",
        section="5.3, below Eq. 13",
        quote="Note, that the restoring moments is negative for phi > beta",
        tried="The sign of Eq. 13 as printed, and the stack released at rest beside beta.",
        examine=sign_beyond_balance,
    ),
)
