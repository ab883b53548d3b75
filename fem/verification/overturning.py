"""Overturning in the first swing, and which motion begins: where the runs change from one outcome to another.

Thresholds are bracketed by runs and bisected; overturning with an impact before it does not count, for there
safe islands lie above the threshold. Housner (1963), Makris and Roussos (2000), Zhang and Makris (2001); initiation
of motion by Shenton (1996).
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion
from contact.reference.closed_forms_overturning import (
    half_sine_threshold_slender,
    initiation_mode,
    one_sine_threshold_slender,
    rectangular_pulse_duration,
    rocking_friction,
    sustained_sine_threshold_slender,
    velocity_step_threshold,
)
from contact.reference.floor_acceleration import FloorAcceleration, half_sine_pulse, one_sine_pulse
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import first_swing_threshold
from fem.model.container import Container, discretise
from fem.model.model import build_model
from fem.verification.rows import Check, Row, count_row
from fem.verification.runs import GRAVITY, SOLID, STACK, Finished, finish, run, with_motion

BLOCK = RigidBlock.homogeneous(width=1.1, height=4.0)
RATE, UPLIFT = BLOCK.frequency_parameter, BLOCK.uplift_acceleration
#: a floor that holds the corner whatever comes
ROUGH = {"contact.mu_static": 5.0, "solver.duration_s": 12.0, "output.history_s": 0.05}
MODELS: dict[str, tuple[dict[str, Any], float]] = {
    "rigid": ({}, 0.01),
    "stiff solid, 20 modes": (SOLID | {"container.youngs_modulus_Pa": 2.1e12}, 0.02),
}
LEAST_POINTS = 75  #: of the grid of first motions
RESOLUTION = 5e-4  #: of a threshold found by bisection

Keys = Callable[[float], Mapping[str, Any]]


def sine_of(frequency_ratio: float) -> Keys:
    """Keys of a harmonic floor of a peak acceleration, Omega = frequency_ratio x p."""
    return lambda peak: {
        "motion.kind": "harmonic",
        "motion.peak_acceleration_m_s2": peak,
        "motion.angular_frequency_rad_s": frequency_ratio * RATE,
    }


def pulse_of(shape: str, length: float) -> Keys:
    """Keys of a pulse of a peak acceleration."""
    return lambda peak: {
        "motion.kind": "pulse",
        "motion.shape": shape,
        "motion.peak_acceleration_m_s2": peak,
        "motion.pulse_s": length,
    }


def sustained_sine() -> list[Row]:
    """A harmonic floor that goes on: slender sqrt(1 + w^2), and the stack's own exact values."""
    rows = []
    for w, exact in ((1.0, 1.41347), (6.0, 6.21218)):
        slender = sustained_sine_threshold_slender(w)
        rows += _threshold_rows(
            f"harmonic floor, w = {w:g}", sine_of(w), exact, f"event-driven block; slender {slender:.5f}"
        )
    return rows


def pulses() -> list[Row]:
    """Half a sine and a whole one."""
    rows = []
    for shape, w, form in (
        ("half-sine", 3.0, half_sine_threshold_slender),
        ("sine", 3.0, one_sine_threshold_slender),
    ):
        length = (math.pi if shape == "half-sine" else 2.0 * math.pi) / (w * RATE)
        slender = form(w)
        exact = first_swing_threshold(
            BLOCK,
            _floor_of(shape, length),
            low=0.9 * slender * UPLIFT,
            high=1.15 * slender * UPLIFT,
            duration=20.0,
            relative_tolerance=1e-6,
        )
        source = f"event-driven block; slender {slender:.5f}"
        rows += _threshold_rows(f"{shape} pulse, w = {w:g}", pulse_of(shape, length), exact / UPLIFT, source)
    return rows


def rectangular() -> list[Row]:
    """Shortest rectangular pulse of twice the uplift acceleration that overturns."""
    exact = rectangular_pulse_duration(BLOCK, 2.0 * UPLIFT)
    rows = []
    for name, (values, tolerance) in MODELS.items():
        found = bisected(lambda length: pulse_of("rectangular", length)(2.0 * UPLIFT), exact, values)
        rows.append(
            Row(
                case=f"{name}: rectangular pulse of 2 g tan al",
                compared="shortest that overturns without impact [s]",
                value=found,
                reference=exact,
                kind="analytic",
                source="work of the pulse = g R (1 - cos al); exact quadrature",
                tolerance=tolerance,
                relative=True,
            )
        )
    return rows


def velocity_step() -> list[Row]:
    """Sudden floor velocity that overturns; here the container gets it, against the floor."""
    exact = velocity_step_threshold(BLOCK)
    rows = []
    for name, (values, tolerance) in MODELS.items():
        found = bisected(lambda speed: {"motion.kind": "none", "initial.velocity_m_s": -speed}, exact, values)
        rows.append(
            Row(
                case=f"{name}: floor suddenly at a velocity",
                compared="least velocity that overturns without impact [m/s]",
                value=found,
                reference=exact,
                kind="analytic",
                source="kinetic energy of the kick = M g R (1 - cos al)",
                tolerance=tolerance,
                relative=True,
            )
        )
    return rows


def initiation_grid() -> Iterator[tuple[float, float, float, float]]:
    """Slenderness, acceleration over g, mu_s, mu_k, at least 5 % away from every boundary of the prediction."""
    for lam, ratio, mu_static, share in itertools.product(
        (1.5, 2.5, 3.64, 6.0), (0.12, 0.2, 0.35, 0.6, 1.0), (0.1, 0.15, 0.3, 0.5, 0.8), (0.5, 1.0)
    ):
        mu_kinetic = share * mu_static
        boundaries = [(ratio, 1.0 / lam), (mu_kinetic, 1.0 / lam)]
        if ratio > 1.0 / lam:
            boundaries.append((mu_static, rocking_friction(ratio, lam)))
        else:
            boundaries.append((ratio, mu_static))
        if all(abs(value / limit - 1.0) > 0.05 for value, limit in boundaries):
            yield lam, ratio, mu_static, mu_kinetic


def initiation() -> list[Row]:
    """First motion of a resting block on an accelerating floor, all over a grid."""
    seen: dict[str, int] = {}
    wrong: list[str] = []
    containers: dict[float, Container] = {}
    for lam, ratio, mu_static, mu_kinetic in initiation_grid():
        expected = initiation_mode(
            acceleration_ratio=ratio, slenderness=lam, mu_static=mu_static, mu_kinetic=mu_kinetic
        ).value
        found = first_motion(lam, ratio, mu_static, mu_kinetic, containers)
        seen[expected] = seen.get(expected, 0) + 1
        if found != expected:
            wrong.append(f"c/a {lam}, {ratio} g, mu {mu_static}/{mu_kinetic}: {found}, not {expected}")
    points = sum(seen.values())
    counts = ", ".join(f"{count} {mode}" for mode, count in sorted(seen.items()))
    note = (
        "below the acceleration of uplift it grows over 50 ms, above it comes at once: a jump makes the shear on "
        "springs overshoot by a quarter, and what rests by statics may then slide"
    )
    return [
        count_row(
            case=f"rigid blocks on a grid of {points} points ({counts})",
            compared="first motions that are not as predicted",
            wrong=len(wrong) + max(0, LEAST_POINTS - points),
            kind="analytic",
            source="Shenton 1996, extended to mu_k below mu_s",
            note="; ".join([note, *wrong[:4]]),
        )
    ]


def first_motion(
    lam: float, ratio: float, mu_static: float, mu_kinetic: float, containers: dict[float, Container]
) -> str:
    """What a block of 1 m x lam m does at first under a floor acceleration of ratio x g."""
    case = STACK.with_values(
        {
            "container.width_m": 1.0,
            "container.depth_m": 1.0,
            "container.height_m": lam,
            "container.weight_N": 20000.0 * lam,
            "contact.mu_static": mu_static,
            "contact.mu_kinetic": mu_kinetic,
            "solver.duration_s": 0.15,
            "output.history_s": 0.01,
        }
    )
    if lam not in containers:
        containers[lam] = discretise(case)
    growth = 0.05 if ratio <= 1.0 / lam else 0.0
    motion = growing_then_steady(ratio * GRAVITY, growth)
    done = finish(with_motion(build_model(case, containers[lam]), motion, (0.05, 0.05 + growth)))
    slides = float(done.track.max_slip) > 1e-4
    rocks = float(done.track.max_rocking) > 1e-3 * done.model.static.slenderness_angle
    return {
        (False, False): "rest",
        (True, False): "slide",
        (False, True): "rock",
        (True, True): "slide-rock",
    }[slides, rocks]


def growing_then_steady(acceleration: float, growth: float) -> FloorMotion:
    """At rest for 0.05 s, then an acceleration that grows for a while [s], or comes at once, and stays [m/s2]."""
    jerk = acceleration / growth if growth > 0.0 else 0.0
    knots = np.array([0.05, 0.05 + growth]) if growth > 0.0 else np.array([0.05])
    coefficients = np.zeros((knots.size + 1, 4))
    coefficients[1] = 0.0, 0.0, 0.0 if growth > 0.0 else acceleration, jerk
    if growth > 0.0:
        coefficients[2] = jerk * growth**3 / 6.0, 0.5 * jerk * growth**2, acceleration, 0.0
    return as_floor_motion(PIECEWISE, breaks=knots, coefficients=coefficients)


def bisected(keys: Keys, expected: float, values: Mapping[str, Any], span: float = 0.06) -> float:
    """Least parameter that overturns the stack without an impact, near `expected`; nan if it is not near."""
    low, high = expected * (1.0 - span), expected * (1.0 + span)
    container = discretise(STACK.with_values({**ROUGH, **values}))

    def overturns(parameter: float) -> bool:
        return falls_at_once(run(STACK, {**ROUGH, **values, **keys(parameter)}, container))

    if overturns(low) or not overturns(high):
        return math.nan
    while high - low > RESOLUTION * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if overturns(middle) else (middle, high)
    return 0.5 * (low + high)


def falls_at_once(done: Finished) -> bool:
    """Whether it overturned without an impact."""
    return done.status == "overturned" and int(done.track.impacts) == 0


def _threshold_rows(case: str, keys: Keys, exact: float, source: str) -> list[Row]:
    return [
        Row(
            case=f"{name}: {case}",
            compared="peak acceleration over g tan al from which it overturns without impact",
            value=bisected(keys, exact * UPLIFT, values) / UPLIFT,
            reference=exact,
            kind="computed",
            source=source,
            tolerance=tolerance,
            relative=True,
        )
        for name, (values, tolerance) in MODELS.items()
    ]


def _floor_of(shape: str, length: float) -> Callable[[float], FloorAcceleration]:
    pulse = half_sine_pulse if shape == "half-sine" else one_sine_pulse
    return lambda peak: pulse(peak=-peak, duration=length)


CHECKS = (
    Check(name="initiation of motion", rows=initiation),
    Check(name="overturning by a harmonic floor", rows=sustained_sine),
    Check(name="overturning by pulses", rows=pulses),
    Check(name="overturning by a rectangular pulse", rows=rectangular),
    Check(name="overturning by a velocity step", rows=velocity_step),
)
