"""The law of friction: when it holds, how it creeps where it is regularised in velocity, what heat it makes.

A rigid box of 1.1 x 1.0 m on two corners; Coulomb, with an elastic stick unless said.
"""

import math

import numpy as np

from contact.reference.closed_forms_sliding import incline_acceleration
from contact.stepping.ledger import FRICTION
from fem.verification.rows import Check, Row
from fem.verification.runs import BOX, GRAVITY, SOLID, run
from fem.verification.sliding import OMEGA, PERIOD, STROKE_TOLERANCE, harmonic


def stick_limit() -> list[Row]:
    """Amplitude from which the box slides, by bisection: A Omega^2 = mu_s g."""

    def slides(peak: float) -> bool:
        values = harmonic(peak / OMEGA**2, OMEGA) | {
            "contact.mu_static": 0.4,
            "contact.mu_kinetic": 0.2,
            "solver.duration_s": 2.0 * PERIOD,
        }
        return run(BOX, values).outcome == "slide"

    low, high = 3.0, 5.0
    if slides(low) or not slides(high):
        low, high = math.nan, math.nan
    while high - low > 1e-4 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if slides(middle) else (middle, high)
    return [
        Row(
            case="rigid box, mu 0.4/0.2, Omega = 10 rad/s",
            compared="floor acceleration from which it slides [m/s2]",
            value=0.5 * (low + high),
            reference=0.4 * GRAVITY,
            kind="analytic",
            source="mu_s g",
            tolerance=5e-3,
            relative=True,
            note="springs that stick make it 1 + (Omega/omega_contact)^2 times smaller",
        )
    ]


def incline() -> list[Row]:
    """Down a slope of 30 degrees: a floor of gravity g cos, accelerating by -g sin along the slope."""
    angle = math.radians(30.0)
    done = run(
        BOX,
        {
            "gravity_m_s2": GRAVITY * math.cos(angle),
            "container.height_m": 0.5,
            "contact.mu_static": 0.2,
            "motion.kind": "pulse",
            "motion.shape": "rectangular",
            "motion.peak_acceleration_m_s2": -GRAVITY * math.sin(angle),
            "motion.pulse_s": 5.0,
            "solver.duration_s": 1.0,
        },
    )
    late = done.history["time_s"] >= 0.2
    square = np.polyfit(done.history["time_s"][late], done.history["slip_m"][late], 2)[0]
    return [
        Row(
            case="rigid plate on a slope of 30 degrees, mu 0.2",
            compared="acceleration down the slope [m/s2]",
            value=2.0 * float(square),
            reference=incline_acceleration(angle=angle, mu_kinetic=0.2, gravity=GRAVITY),
            kind="analytic",
            source="g (sin - mu cos) = 3.20586 m/s2",
            tolerance=1e-3,
            relative=True,
        )
    ]


def stuck() -> list[Row]:
    """Half of what friction holds, one way, for 20 s: no slip, and none that grows."""
    rows = []
    for name, values in (("rigid box", {}), ("solid box, 20 modes", SOLID)):
        done = run(
            BOX,
            {
                "motion.kind": "pulse",
                "motion.shape": "rectangular",
                "motion.peak_acceleration_m_s2": 0.2 * GRAVITY,
                "motion.pulse_s": 20.0,
                "contact.mu_static": 0.4,
                "solver.duration_s": 20.0,
                "output.history_s": 0.05,
            }
            | values,
        )
        slip = done.history["slip_m"]
        second_half = float(np.ptp(slip[slip.size // 2 :]))
        for compared, value, tolerance in (
            ("largest slip [m]", float(done.track.max_slip), 1e-5),
            ("slip in the second half [m]", second_half, 1e-12),
        ):
            rows.append(
                Row(
                    case=f"{name}, 0.2 g one way for 20 s, mu 0.4",
                    compared=compared,
                    value=value,
                    reference=0.0,
                    kind="analytic",
                    source="it sticks",
                    tolerance=tolerance,
                )
            )
    return rows


def creep() -> list[Row]:
    """Friction regularised in velocity creeps at v_reg atanh(s) under the share s of its limit."""
    share, velocity = 0.5, 1e-3
    done = run(
        BOX,
        {
            "contact.friction": "regularised",
            "contact.regularisation_velocity_m_s": velocity,
            "contact.mu_static": 0.4,
            "motion.kind": "pulse",
            "motion.shape": "rectangular",
            "motion.peak_acceleration_m_s2": -share * 0.4 * GRAVITY,
            "motion.pulse_s": 20.0,
            "solver.duration_s": 20.0,
        },
    )
    return [
        Row(
            case="rigid box, friction regularised in velocity, half its limit for 20 s",
            compared="creep [m]",
            value=float(done.history["slip_m"][-1]),
            reference=20.0 * velocity * math.atanh(share),
            kind="analytic",
            source="v_reg atanh(s) t",
            tolerance=STROKE_TOLERANCE,
            relative=True,
            note="the price of that law; the default one sticks",
        )
    ]


def friction_heat() -> list[Row]:
    """Heat of friction: mu_k times weight times the path, of a box given a push."""
    done = run(
        BOX,
        {
            "initial.velocity_m_s": 2.0,
            "contact.mu_static": 0.4,
            "contact.mu_kinetic": 0.2,
            "solver.duration_s": 2.0,
        },
    )
    slip, heat = float(done.track.slip_travel), float(done.model.run.ledger[FRICTION])
    return [
        Row(
            case="rigid box pushed at 2 m/s, mu 0.4/0.2",
            compared="friction heat over mu_k M g and path",
            value=heat / (0.2 * 24525.0 * slip),
            reference=1.0,
            kind="analytic",
            source="Coulomb",
            tolerance=STROKE_TOLERANCE,
        ),
        Row(
            case="rigid box pushed at 2 m/s, mu 0.4/0.2",
            compared="path [m]",
            value=slip,
            reference=2.0**2 / (2.0 * 0.2 * GRAVITY),
            kind="analytic",
            source="v^2/(2 mu_k g)",
            tolerance=STROKE_TOLERANCE,
            relative=True,
        ),
    ]


CHECKS = (
    Check(name="stick limit", rows=stick_limit),
    Check(name="incline", rows=incline),
    Check(name="sticking for long", rows=stuck),
    Check(name="creep of the regularised law", rows=creep),
    Check(name="friction heat", rows=friction_heat),
)
