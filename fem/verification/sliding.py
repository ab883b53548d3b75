"""Sliding without rocking: a rigid box on Coulomb friction against the rigid slider.

The slider of `contact.sliding` is event-driven, sticks truly and shares no code with the stepping; the box sticks
by stiff springs. The box is 1.1 x 1.0 m on two corners. Den Hartog, Trans. ASME APM-53-9 (1931); Westermo and
Udwadia, Earthquake Engng Struct. Dyn. 11 (1983); Newmark, Geotechnique 15 (1965).
"""

import math
from itertools import groupby
from typing import Any

import numpy as np

from contact.closed_forms_sliding import never_stops_ratio, pulse_slip, steady_stroke
from contact.floor_acceleration import sine_floor
from contact.sliding import RigidSlider, simulate_sliding
from fem.verification.rows import Check, Row
from fem.verification.runs import BOX, GRAVITY, SOLID, Finished, run

AMPLITUDE, OMEGA = 0.1, 10.0
PERIOD = 2.0 * math.pi / OMEGA
STROKE_TOLERANCE = 5e-3
LARGEST = 79.144e-3  #: slip of the seed's box under 50 mm at 10 rad/s [m]
#: over the period: a spring that turns over at a reversal takes a few thousandths of it
SHORTEST_STOP = 5e-3


def harmonic(amplitude: float, omega: float, **values: Any) -> dict[str, Any]:
    """Keys of a harmonic floor."""
    return {
        "motion.kind": "harmonic",
        "motion.amplitude_m": amplitude,
        "motion.angular_frequency_rad_s": omega,
    } | values


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
    """The box with 0.4/0.2 on a floor of 50 mm at 10 rad/s: rigid, and elastic."""
    rows = []
    for name, values in (
        ("rigid box", {}),
        ("stiff solid box, 20 modes", SOLID | {"container.youngs_modulus_Pa": 2.1e12}),
    ):
        done = run(
            BOX,
            harmonic(0.05, 10.0)
            | {"contact.mu_static": 0.4, "contact.mu_kinetic": 0.2, "solver.duration_s": 20.0}
            | values,
        )
        at_ten = float(np.interp(10.0 * PERIOD, done.history["time_s"], done.history["slip_m"]))
        for compared, value, reference in (
            (
                "steady slip, peak to peak, over the largest",
                stroke_of(done, PERIOD) / LARGEST,
                78.745 / 79.144,
            ),
            ("largest slip over what it should be", float(done.track.max_slip) / LARGEST, 1.0),
            ("slip after ten periods over the largest", at_ten / LARGEST, 19.893 / 79.144),
        ):
            rows.append(
                Row(
                    case=f"{name}, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2",
                    compared=compared,
                    value=value,
                    reference=reference,
                    kind="computed",
                    source="event-driven slider, 78.745, 79.144 and 19.893 mm",
                    tolerance=STROKE_TOLERANCE,
                )
            )
    return rows


def sliding_without_stops() -> list[Row]:
    """Friction ratio up to which the slider never stops: what it does on either side of it."""
    rows = []
    for static_ratio, printed in ((1.0, 0.53703), (2.0, 0.39322)):
        limit = never_stops_ratio(static_ratio)
        wrong, stroke, exact = 0, math.nan, math.nan
        for factor, stops in ((0.95, False), (1.05, True)):
            keys = friction_of(factor * limit, static_ratio)
            done = run(
                BOX,
                harmonic(AMPLITUDE, OMEGA)
                | keys
                | {"solver.duration_s": 40.0 * PERIOD, "output.history_s": PERIOD / 1000},
            )
            wrong += (longest_stop(done, 36.0 * PERIOD) > SHORTEST_STOP * PERIOD) is not stops
            stroke = stroke_of(done, PERIOD) / AMPLITUDE
            exact = steady_stroke(friction_ratio=factor * limit, static_ratio=static_ratio)
        rows.append(
            Row(
                case=f"rigid box, mu_s = {static_ratio:g} mu_k",
                compared="friction ratio up to which it never stops, if 0.95 of it does not stop and 1.05 does",
                value=limit if wrong == 0 else math.nan,
                reference=printed,
                kind="analytic",
                source="1/sqrt((mu_s/mu_k)^2 + pi^2/4)",
                tolerance=5e-6,
            )
        )
        rows.append(
            Row(
                case=f"rigid box, mu_s = {static_ratio:g} mu_k, 1.05 of that friction ratio",
                compared="steady slip, peak to peak, over A",
                value=stroke,
                reference=exact,
                kind="analytic",
                source="two stops a cycle, each of 2 % of it",
                tolerance=STROKE_TOLERANCE,
                relative=True,
            )
        )
    return rows


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


def whole_history() -> list[Row]:
    """Slip at every instant against the event-driven slider."""
    done = run(
        BOX,
        harmonic(0.05, 10.0)
        | {"contact.mu_static": 0.4, "contact.mu_kinetic": 0.2, "solver.duration_s": 5.0},
    )
    slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)
    floor = sine_floor(amplitude=0.05, angular_frequency=10.0)
    times = done.history["time_s"]
    exact = simulate_sliding(slider, floor, duration=float(times[-1])).at(times)[0]
    return [
        Row(
            case="rigid box, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2, 5 s",
            compared="slip, largest difference over the largest slip",
            value=float(np.abs(done.history["slip_m"] - exact).max()) / LARGEST,
            reference=0.0,
            kind="computed",
            source="event-driven slider",
            tolerance=STROKE_TOLERANCE,
        )
    ]


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
    Check(name="slip at every instant", rows=whole_history),
    Check(name="rectangular pulse", rows=pulses),
)
