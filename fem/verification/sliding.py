"""Sliding without rocking: a rigid box on Coulomb friction against the rigid slider.

The slider of `contact.reference.sliding` is event-driven, sticks truly and shares no code with the stepping; the box
sticks by stiff springs. The box is 1.1 x 1.0 m on two corners. Den Hartog, Trans. ASME APM-53-9 (1931); Westermo and
Udwadia, Earthquake Engng Struct. Dyn. 11 (1983); Newmark, Geotechnique 15 (1965).
"""

import math
from itertools import groupby
from typing import Any

import numpy as np

from contact.reference.closed_forms_sliding import never_stops_ratio, pulse_slip, steady_stroke
from contact.reference.floor_acceleration import sine_floor
from contact.reference.sliding import RigidSlider, simulate_sliding
from fem.model.model import build_model
from fem.verification.rows import Check, Row
from fem.verification.runs import BOX, GRAVITY, SOLID, Finished, run

AMPLITUDE, OMEGA = 0.1, 10.0
PERIOD = 2.0 * math.pi / OMEGA
STROKE_TOLERANCE = 5e-3
LARGEST = 79.144e-3  #: slip of the seed's box under 50 mm at 10 rad/s [m]
STIFFER = 10.0  #: times the default penalty, where the time of the springs would show
#: over the period: a spring that turns over at a reversal takes a few thousandths of it
SHORTEST_STOP = 5e-3


def harmonic(amplitude: float, omega: float, **values: Any) -> dict[str, Any]:
    """Keys of a harmonic floor."""
    return {
        "motion.kind": "harmonic",
        "motion.amplitude_m": amplitude,
        "motion.angular_frequency_rad_s": omega,
    } | values


#: the box of the seed on a floor of 50 mm at 10 rad/s
SEED = harmonic(0.05, 10.0) | {"contact.mu_static": 0.4, "contact.mu_kinetic": 0.2}


def friction_of(kappa: float, static_ratio: float = 1.0) -> dict[str, Any]:
    """Coefficients with mu_k g = kappa A Omega^2 and mu_s = static_ratio mu_k."""
    kinetic = kappa * AMPLITUDE * OMEGA**2 / GRAVITY
    return {"contact.mu_static": static_ratio * kinetic, "contact.mu_kinetic": kinetic}


def steady_strokes() -> list[Row]:
    """Steady slip from peak to peak under a harmonic floor, one coefficient of friction."""
    rows = []
    for kappa, stroke in ((0.2, 1.898741), (0.5, 1.237982), (0.7, 0.432494)):
        cycles = 30
        done = run(
            BOX,
            harmonic(AMPLITUDE, OMEGA)
            | friction_of(kappa)
            | {"solver.duration_s": cycles * PERIOD, "output.history_s": PERIOD / 400},
        )
        rows.append(
            Row(
                case=f"rigid box, mu g/(A Omega^2) = {kappa}",
                compared="steady slip, peak to peak, over A",
                value=stroke_of(done, PERIOD) / AMPLITUDE,
                reference=stroke,
                kind="analytic",
                source="2 sqrt(1 - (pi kappa/2)^2), or two stops a cycle",
                tolerance=STROKE_TOLERANCE,
                relative=True,
            )
        )
    return rows


def seed_slider() -> list[Row]:
    """Steady stroke of the box with 0.4/0.2 on a floor of 50 mm at 10 rad/s: rigid, and elastic."""
    models: dict[str, dict[str, Any]] = {
        "rigid box": {},
        "stiff solid box, 20 modes": SOLID | {"container.youngs_modulus_Pa": 2.1e12},
    }
    return [
        Row(
            case=f"{name}, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2",
            compared="steady slip, peak to peak [m]",
            value=stroke_of(run(BOX, SEED | values | {"solver.duration_s": 20.0}), PERIOD),
            reference=78.745e-3,
            kind="computed",
            source="event-driven slider",
            tolerance=STROKE_TOLERANCE,
            relative=True,
        )
        for name, values in models.items()
    ]


def seed_slider_position() -> list[Row]:
    """Where that box is: at its farthest, after ten periods, and at every instant of them."""
    soft, stiff = (
        run(
            BOX,
            SEED
            | {
                "contact.normal_penalty_Pa_m": factor * build_model(BOX).penalty,
                "solver.duration_s": 10.0 * PERIOD,
                "output.history_s": PERIOD / 100,
            },
        )
        for factor in (1.0, STIFFER)
    )
    times = stiff.history["time_s"]
    slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)
    floor = sine_floor(amplitude=0.05, angular_frequency=10.0)
    exact = simulate_sliding(slider, floor, duration=float(times[-1])).at(times)[0]
    largest = [float(np.abs(done.history["slip_m"] - exact).max()) for done in (soft, stiff)]
    ends = [float(done.history["slip_m"][-1]) for done in (soft, stiff)]
    case = f"rigid box, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2, penalty x {STIFFER:g}"
    reason = (
        ": the case lies 0.2 % from the limit of sliding without stops, where the springs' own time counts"
    )
    return [
        Row(
            case=case,
            compared="largest slip [m]",
            value=float(stiff.track.max_slip),
            reference=LARGEST,
            kind="computed",
            source="event-driven slider",
            tolerance=STROKE_TOLERANCE,
            relative=True,
            note=at_the_default_penalty(float(soft.track.max_slip), LARGEST) + reason,
        ),
        Row(
            case=case,
            compared="slip after ten periods over the largest",
            value=ends[1] / LARGEST,
            reference=19.893e-3 / LARGEST,
            kind="computed",
            source="event-driven slider, 19.893 of 79.144 mm",
            tolerance=STROKE_TOLERANCE,
            note=at_the_default_penalty(ends[0], 19.893e-3, LARGEST) + reason,
        ),
        Row(
            case=case,
            compared="slip in ten periods, largest difference over the largest slip",
            value=largest[1] / LARGEST,
            reference=0.0,
            kind="computed",
            source="event-driven slider",
            tolerance=STROKE_TOLERANCE,
            note=at_the_default_penalty(largest[0], 0.0, LARGEST) + reason,
        ),
    ]


def sliding_without_stops() -> list[Row]:
    """Friction ratio up to which the slider never stops: what it does on either side of it."""
    rows = []
    for static_ratio, printed in ((1.0, 0.53703), (2.0, 0.39322)):
        limit = never_stops_ratio(static_ratio)
        below, above = (near_the_limit(factor * limit, static_ratio) for factor in (0.95, 1.05))
        stops = [longest_stop(done, 36.0 * PERIOD) > SHORTEST_STOP * PERIOD for done in (below, above)]
        rows.append(
            Row(
                case=f"rigid box, mu_s = {static_ratio:g} mu_k",
                compared="friction ratio up to which it never stops, if 0.95 of it does not stop and 1.05 does",
                value=limit if stops == [False, True] else math.nan,
                reference=printed,
                kind="analytic",
                source="1/sqrt((mu_s/mu_k)^2 + pi^2/4)",
                tolerance=5e-6,
            )
        )
        exact = steady_stroke(friction_ratio=1.05 * limit, static_ratio=static_ratio)
        stiff = near_the_limit(1.05 * limit, static_ratio, stiffer=STIFFER)
        rows.append(
            Row(
                case=f"rigid box, mu_s = {static_ratio:g} mu_k, 1.05 of that friction ratio, penalty x {STIFFER:g}",
                compared="steady slip, peak to peak, over A",
                value=stroke_of(stiff, PERIOD) / AMPLITUDE,
                reference=exact,
                kind="analytic",
                source="two stops a cycle, each of 2 % of it",
                tolerance=STROKE_TOLERANCE,
                relative=True,
                note=at_the_default_penalty(stroke_of(above, PERIOD) / AMPLITUDE, exact)
                + ": stops as short as the springs take to turn over are not resolved",
            )
        )
    return rows


def near_the_limit(kappa: float, static_ratio: float, stiffer: float = 1.0) -> Finished:
    """Forty cycles of the box at a friction ratio, on `stiffer` times the default penalty."""
    keys = harmonic(AMPLITUDE, OMEGA) | friction_of(kappa, static_ratio)
    return run(
        BOX,
        keys
        | {
            "contact.normal_penalty_Pa_m": stiffer * build_model(BOX).penalty,
            "solver.duration_s": 40.0 * PERIOD,
            "output.history_s": PERIOD / 1000,
        },
    )


def at_the_default_penalty(value: float, exact: float, scale: float | None = None) -> str:
    """What the default penalty makes of it, for a note."""
    return f"{100.0 * abs(value - exact) / (scale or abs(exact)):.2g} % at the default penalty"


def pulses() -> list[Row]:
    """Slip after a rectangular pulse, one way."""
    rows = []
    for kinetic in (0.4, 0.2):
        done = run(
            BOX,
            {
                "motion.kind": "pulse",
                "motion.shape": "rectangular",
                "motion.peak_acceleration_m_s2": 8.0,
                "motion.pulse_s": 0.3,
                "contact.mu_static": 0.4,
                "contact.mu_kinetic": kinetic,
                "solver.duration_s": 2.0,
            },
        )
        rows.append(
            Row(
                case=f"rigid box, 8 m/s2 for 0.3 s, mu 0.4/{kinetic}",
                compared="slip that remains [m]",
                value=float(done.history["slip_m"][-1]),
                reference=pulse_slip(
                    peak=8.0, duration=0.3, mu_static=0.4, mu_kinetic=kinetic, gravity=GRAVITY
                ),
                kind="analytic",
                source="V^2/(2 mu g) (1 - mu g/a0)",
                tolerance=STROKE_TOLERANCE,
                relative=True,
            )
        )
    return rows


def longest_stop(done: Finished, since: float) -> float:
    """Longest stretch without sliding after an instant [s]."""
    late = done.history["time_s"] > since
    modes = [mode for mode, chosen in zip(done.history.modes, late, strict=True) if chosen]
    stops = [len(list(same)) for mode, same in groupby(modes) if mode == "rest"]
    return max(stops, default=0) * done.model.case.output.history_s


def stroke_of(done: Finished, period: float) -> float:
    """Slip from peak to peak over the last period [m]."""
    times, slip = done.history["time_s"], done.history["slip_m"]
    return float(np.ptp(slip[times >= times[-1] - period * (1.0 + 1e-9)]))


CHECKS = (
    Check(name="steady strokes", rows=steady_strokes),
    Check(name="sliding without stops", rows=sliding_without_stops),
    Check(name="the seed's box on a fast floor", rows=seed_slider),
    Check(name="where the seed's box is", rows=seed_slider_position),
    Check(name="rectangular pulse", rows=pulses),
)
