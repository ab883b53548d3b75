"""Overturning in the first swing, and which motion begins: where the outcome of the runs changes.

Thresholds are bracketed by runs and bisected. Overturning after an impact does not count, since outcomes above that
threshold alternate. Housner (1963), Makris and Roussos (2000), Zhang and Makris (2001); initiation of motion by
Shenton (1996).
"""

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial

import closed_forms
import numpy as np
import runs
from closed_forms import first_swing_threshold
from evidence.findings import analytic, computed
from floors import half_sine_pulse, one_sine_pulse
from verification.checks import Findings, check

from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion
from contact.reference.floor_acceleration import FloorAcceleration
from fem.model.container import Container, discretise
from fem.model.model import build_model
from fem.results.outcome import Outcome

RATE, UPLIFT = runs.BLOCK.frequency_parameter, runs.BLOCK.uplift_acceleration
#: the corner does not slide under any motion
ROUGH: runs.Keys = {"contact.mu_static": 5.0, "solver.duration_s": 12.0, "output.history_s": 0.05}
#: name -> keys, tolerance
MODELS: dict[str, tuple[runs.Keys, float]] = {
    "rigid": ({}, 0.01),
    "stiff solid, 20 modes": (runs.STIFF_SOLID, 0.02),
}
LEAST_POINTS = 75  #: of the grid of first motions
RESOLUTION = 5e-4  #: of a threshold found by bisection
SPAN = 0.06  #: of the bracket around the expected threshold
PEAK = "peak acceleration over g tan al above which it overturns without impact"


@check("overturning", "initiation of motion")
def initiation() -> Findings:
    """First motion of a resting block on an accelerating floor, over a grid of parameters."""
    seen: Counter[str] = Counter()
    wrong: list[str] = []
    containers: dict[float, Container] = {}
    for lam, ratio, mu_static, mu_kinetic in initiation_grid():
        expected = closed_forms.initiation_mode(
            acceleration_ratio=ratio, slenderness=lam, mu_static=mu_static, mu_kinetic=mu_kinetic
        ).value
        first = first_motion(lam, ratio, mu_static, mu_kinetic, containers)
        seen[expected] += 1
        if first != expected:
            wrong.append(f"c/a {lam}, {ratio} g, mu {mu_static}/{mu_kinetic}: {first}, not {expected}")
    counts = ", ".join(f"{count} {mode}" for mode, count in sorted(seen.items()))
    note = (
        "the floor's acceleration grows over 50 ms if it is below that of uplift, else it is sudden: a jump makes the "
        "shear on the springs overshoot by a quarter, and a block that rests by statics may slide"
    )
    yield analytic(
        f"rigid blocks on a grid of {seen.total()} points ({counts})",
        "number of first motions that differ from the prediction",
        len(wrong) + max(0, LEAST_POINTS - seen.total()),
        source="Shenton 1996, extended to mu_k below mu_s",
        absolute=0.0,
        note="; ".join([note, *wrong[:4]]),
    )


@check("overturning", "overturning by a harmonic floor")
def sustained_sine() -> Findings:
    """A harmonic floor without end: slender sqrt(1 + w^2), and the stack's own exact values."""
    for w, exact in ((1.0, 1.41347), (6.0, 6.21218)):
        source = f"event-driven block; slender {closed_forms.sustained_sine_threshold_slender(w):.5f}"
        for name, (values, tolerance) in MODELS.items():
            peak = threshold(partial(sine, w=w), exact * UPLIFT, values) / UPLIFT
            case = f"{name}: harmonic floor, w = {w:g}"
            yield computed(case, PEAK, peak, exact, source=source, relative=tolerance)


@check("overturning", "overturning by pulses")
def pulses() -> Findings:
    """Half a sine and a whole one."""
    w = 3.0
    for shape, angle, slender, acceleration in (
        ("half-sine", math.pi, closed_forms.half_sine_threshold_slender(w), half_sine_pulse),
        ("sine", 2.0 * math.pi, closed_forms.one_sine_threshold_slender(w), one_sine_pulse),
    ):
        length = angle / (w * RATE)

        def toward_minus_x(
            peak: float, pulse: Callable[..., FloorAcceleration] = acceleration, length: float = length
        ) -> FloorAcceleration:  # which tilts the block toward +x
            return pulse(peak=-peak, duration=length)

        low, high = 0.9 * slender * UPLIFT, 1.15 * slender * UPLIFT
        peak = first_swing_threshold(
            runs.BLOCK, toward_minus_x, low=low, high=high, duration=20.0, relative_tolerance=1e-6
        )
        exact = peak / UPLIFT
        source = f"event-driven block; slender {slender:.5f}"
        for name, (values, tolerance) in MODELS.items():
            keys = partial(runs.pulse, length=length, shape=shape)
            peak = threshold(keys, exact * UPLIFT, values) / UPLIFT
            case = f"{name}: {shape} pulse, w = {w:g}"
            yield computed(case, PEAK, peak, exact, source=source, relative=tolerance)


@check("overturning", "overturning by a rectangular pulse")
def rectangular() -> Findings:
    """Shortest rectangular pulse of twice the uplift acceleration that overturns."""
    exact = closed_forms.rectangular_pulse_duration(runs.BLOCK, 2.0 * UPLIFT)
    compared = "shortest length that overturns without impact [s]"
    source = "work of the pulse = g R (1 - cos al); exact quadrature"
    for name, (values, tolerance) in MODELS.items():
        shortest = threshold(lambda length: runs.pulse(2.0 * UPLIFT, length), exact, values)
        case = f"{name}: rectangular pulse of 2 g tan al"
        yield analytic(case, compared, shortest, exact, source=source, relative=tolerance)


@check("overturning", "overturning by a velocity step")
def velocity_step() -> Findings:
    """Sudden floor velocity that overturns; here the container gets it, relative to the floor."""
    exact = closed_forms.velocity_step_threshold(runs.BLOCK)
    compared = "least velocity that overturns without impact [m/s]"
    source = "kinetic energy of the kick = M g R (1 - cos al)"
    for name, (values, tolerance) in MODELS.items():
        least = threshold(
            lambda speed: {"motion.kind": "none", "initial.velocity_m_s": -speed}, exact, values
        )
        case = f"{name}: sudden floor velocity"
        yield analytic(case, compared, least, exact, source=source, relative=tolerance)


def sine(peak: float, w: float) -> runs.Keys:
    """Keys of a harmonic floor of a peak acceleration [m/s2], Omega = w p."""
    return {
        "motion.kind": "harmonic",
        "motion.peak_acceleration_m_s2": peak,
        "motion.angular_frequency_rad_s": w * RATE,
    }


def initiation_grid() -> Iterator[tuple[float, float, float, float]]:
    """Slenderness, acceleration over g, mu_s, mu_k, at least 5 % away from every boundary of the prediction."""
    for lam, ratio, mu_static, share in itertools.product(
        (1.5, 2.5, 3.64, 6.0), (0.12, 0.2, 0.35, 0.6, 1.0), (0.1, 0.15, 0.3, 0.5, 0.8), (0.5, 1.0)
    ):
        mu_kinetic = share * mu_static
        boundaries = [(ratio, 1.0 / lam), (mu_kinetic, 1.0 / lam)]
        if ratio > 1.0 / lam:
            boundaries.append((mu_static, closed_forms.rocking_friction(ratio, lam)))
        else:
            boundaries.append((ratio, mu_static))
        if all(abs(value / limit - 1.0) > 0.05 for value, limit in boundaries):
            yield lam, ratio, mu_static, mu_kinetic


def first_motion(
    lam: float, ratio: float, mu_static: float, mu_kinetic: float, containers: dict[float, Container]
) -> str:
    """What a block of 1 m x lam m does at first under a floor acceleration of ratio x g."""
    keys: runs.Keys = {"container.width_m": 1.0, "container.depth_m": 1.0}
    keys |= {"container.height_m": lam, "container.weight_N": 20000.0 * lam}
    keys |= {"contact.mu_static": mu_static, "contact.mu_kinetic": mu_kinetic}
    case = runs.STACK.with_values(keys | {"solver.duration_s": 0.15, "output.history_s": 0.01})
    if lam not in containers:
        containers[lam] = discretise(case)
    growth = 0.05 if ratio <= 1.0 / lam else 0.0
    motion = growing_then_steady(ratio * runs.GRAVITY, growth)
    done = runs.finish(runs.with_motion(build_model(case, containers[lam]), motion, (0.05, 0.05 + growth)))
    slides = float(done.joint.max_slip) > 1e-4
    rocks = float(done.track.max_rocking) > 1e-3 * done.model.static.slenderness_angle
    return Outcome.of(slides=slides, rocks=rocks)


def growing_then_steady(acceleration: float, growth: float) -> FloorMotion:
    """At rest for 0.05 s, then an acceleration that grows for a while [s], or comes at once, and stays [m/s2]."""
    jerk = acceleration / growth if growth > 0.0 else 0.0
    knots = np.array([0.05, 0.05 + growth]) if growth > 0.0 else np.array([0.05])
    coefficients = np.zeros((knots.size + 1, 4))
    coefficients[1] = 0.0, 0.0, 0.0 if growth > 0.0 else acceleration, jerk
    if growth > 0.0:
        coefficients[2] = jerk * growth**3 / 6.0, 0.5 * jerk * growth**2, acceleration, 0.0
    return as_floor_motion(PIECEWISE, breaks=knots, coefficients=coefficients)


def threshold(keys: Callable[[float], runs.Keys], expected: float, values: runs.Keys) -> float:
    """Least parameter that overturns the stack without an impact, near `expected`; nan if it is not near."""
    container = discretise(runs.STACK.with_values(ROUGH | values))

    def overturns(parameter: float) -> bool:
        done = runs.run(runs.STACK, ROUGH | values | keys(parameter), container)
        return done.status == "overturned" and int(done.track.impacts) == 0

    return runs.bisected(overturns, expected * (1.0 - SPAN), expected * (1.0 + SPAN), resolution=RESOLUTION)
