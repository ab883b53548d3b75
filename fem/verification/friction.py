"""The law of friction: its limit, creep if it is regularised in velocity, and the heat.

A rigid box of 1.1 x 1.0 m on two corners; Coulomb with an elastic stick unless stated otherwise.
"""

import math
from collections.abc import Iterator

import numpy as np

from contact.reference.closed_forms_sliding import incline_acceleration
from contact.stepping.ledger import FRICTION as FRICTION_HEAT
from fem.verification.rows import Row, analytic, check
from fem.verification.runs import BOX, FRICTION, GRAVITY, SOLID, Keys, bisected, harmonic, pulse, run
from fem.verification.sliding import OMEGA, PERIOD, STROKE_TOLERANCE


@check("sliding", "stick limit")
def stick_limit() -> Iterator[Row]:
    """Amplitude above which the box slides, by bisection: A Omega^2 = mu_s g."""

    def slides(peak: float) -> bool:
        values = harmonic(peak / OMEGA**2, OMEGA) | FRICTION | {"solver.duration_s": 2.0 * PERIOD}
        return run(BOX, values).outcome == "slide"

    yield analytic(
        "rigid box, mu 0.4/0.2, Omega = 10 rad/s",
        "floor acceleration above which it slides [m/s2]",
        bisected(slides, 3.0, 5.0, resolution=1e-4),
        0.4 * GRAVITY,
        source="mu_s g",
        relative=5e-3,
        note="the springs of the stick reduce it by a factor of 1 + (Omega/omega_contact)^2",
    )


@check("sliding", "incline")
def incline() -> Iterator[Row]:
    """Down a slope of 30 degrees: a floor of gravity g cos, accelerating by -g sin along the slope."""
    angle = math.radians(30.0)
    slope = {
        "gravity_m_s2": GRAVITY * math.cos(angle),
        "container.height_m": 0.5,
        "contact.mu_static": 0.2,
        "solver.duration_s": 1.0,
    }
    done = run(BOX, slope | pulse(-GRAVITY * math.sin(angle), 5.0))
    late = done.history["time_s"] >= 0.2
    square = np.polyfit(done.history["time_s"][late], done.history["slip_m"][late], 2)[0]
    yield analytic(
        "rigid plate on a slope of 30 degrees, mu 0.2",
        "acceleration down the slope [m/s2]",
        2.0 * float(square),
        incline_acceleration(angle=angle, mu_kinetic=0.2, gravity=GRAVITY),
        source="g (sin - mu cos) = 3.20586 m/s2",
        relative=1e-3,
    )


@check("sliding", "lasting stick")
def stuck() -> Iterator[Row]:
    """Half of the friction limit, one way, for 20 s: no slip, and none that grows."""
    held = {"contact.mu_static": 0.4, "solver.duration_s": 20.0, "output.history_s": 0.05}
    models: dict[str, Keys] = {"rigid box": {}, "solid box, 20 modes": SOLID}
    for name, values in models.items():
        done = run(BOX, pulse(0.2 * GRAVITY, 20.0) | held | values)
        slip = done.history["slip_m"]
        case, source = f"{name}, 0.2 g one way for 20 s, mu 0.4", "it sticks"
        yield analytic(case, "largest slip [m]", done.track.max_slip, 0.0, source=source, absolute=1e-5)
        grown = np.ptp(slip[slip.size // 2 :])
        yield analytic(case, "slip in the second half [m]", grown, 0.0, source=source, absolute=1e-12)


@check("sliding", "creep of the regularised law")
def creep() -> Iterator[Row]:
    """Friction regularised in velocity creeps at v_reg atanh(s) under the share s of its limit."""
    share, velocity = 0.5, 1e-3
    regularised = {
        "contact.friction": "regularised",
        "contact.regularisation_velocity_m_s": velocity,
        "contact.mu_static": 0.4,
        "solver.duration_s": 20.0,
    }
    done = run(BOX, regularised | pulse(-share * 0.4 * GRAVITY, 20.0))
    yield analytic(
        "rigid box, friction regularised in velocity, half its limit for 20 s",
        "creep [m]",
        done.history["slip_m"][-1],
        20.0 * velocity * math.atanh(share),
        source="v_reg atanh(s) t",
        relative=STROKE_TOLERANCE,
        note="a property of this law; the default law sticks",
    )


@check("sliding", "friction heat")
def friction_heat() -> Iterator[Row]:
    """Heat of friction of a box given a push: mu_k times weight times path."""
    done = run(BOX, FRICTION | {"initial.velocity_m_s": 2.0, "solver.duration_s": 2.0})
    slip, heat = float(done.track.slip_travel), float(done.model.run.ledger[FRICTION_HEAT])
    case, compared = "rigid box pushed at 2 m/s, mu 0.4/0.2", "friction heat over mu_k M g and path"
    yield analytic(
        case, compared, heat / (0.2 * 24525.0 * slip), 1.0, source="Coulomb", absolute=STROKE_TOLERANCE
    )
    path = 2.0**2 / (2.0 * 0.2 * GRAVITY)
    yield analytic(case, "path [m]", slip, path, source="v^2/(2 mu_k g)", relative=STROKE_TOLERANCE)
