"""Friction and sliding without rocking: a rigid box of 1.1 x 1.0 m on two corners.

The law of friction: its limit, creep if it is regularised in velocity, heat. Then strokes against the rigid slider of
`rigid_slider`, which is event-driven, sticks perfectly and shares no code with the stepping; the box
sticks by stiff springs. Den Hartog, Trans. ASME APM-53-9 (1931); Westermo and Udwadia, Earthquake Engng Struct.
Dyn. 11 (1983); Newmark, Geotechnique 15 (1965).
"""

import math
from itertools import groupby, product

import numpy as np
import runs
from closed_forms import incline_acceleration, never_stops_ratio, pulse_slip, steady_stroke
from evidence.findings import Finding, analytic, computed
from floors import half_sine_pulse, sine_floor
from rigid_slider import RigidSlider, simulate_sliding
from verification.checks import Findings, check

from contact.reference.floor_acceleration import FloorAcceleration
from contact.stepping.ledger import FRICTION as FRICTION_HEAT
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray

AMPLITUDE, OMEGA = 0.1, 10.0
PERIOD = 2.0 * math.pi / OMEGA
STROKE_TOLERANCE = 5e-3
LARGEST, LAST = 79.144e-3, 19.893e-3  #: slip of the paper's box, largest and after ten periods [m]
#: 8 mm of steel
SHELL: runs.Keys = {
    "solver.model": "reduced",
    "solver.order": 2,
    "container.section": "shell",
    "container.wall_m": 0.008,
}
SUPPORTS: dict[str, runs.Keys] = {
    "corners": {"support.kind": "corners", "solver.element_size_m": 0.2},
    "feet": {"support.kind": "feet", "support.foot_m": 0.1, "solver.element_size_m": 0.2},
    "flat": {"support.kind": "flat", "solver.element_size_m": 0.1},
}
#: over the period: a spring needs a few thousandths of it to reverse
SHORTEST_STOP = 5e-3
SLIDER = "event-driven slider"
#: the box of the paper on a floor of 50 mm at 10 rad/s
PAPER_BOX = runs.harmonic(0.05, 10.0) | runs.FRICTION


@check("sliding", "stick limit")
def stick_limit() -> Findings:
    """Amplitude above which the box slides, by bisection: A Omega^2 = mu_s g."""

    def slides(peak: float) -> bool:
        values = runs.harmonic(peak / OMEGA**2, OMEGA) | runs.FRICTION | {"solver.duration_s": 2.0 * PERIOD}
        return runs.run(runs.BOX, values).outcome == Outcome.SLIDE

    case, limit = "rigid box, mu 0.4/0.2, Omega = 10 rad/s", runs.bisected(slides, 3.0, 5.0, resolution=1e-4)
    compared, exact = "floor acceleration above which it slides [m/s2]", 0.4 * runs.GRAVITY
    note = "the springs of the stick reduce it by a factor of 1 + (Omega/omega_contact)^2"
    yield analytic(case, compared, limit, exact, source="mu_s g", relative=5e-3, note=note)


@check("sliding", "incline")
def incline() -> Findings:
    """Down a slope of 30 degrees: a floor of gravity g cos, accelerating by -g sin along the slope."""
    angle = math.radians(30.0)
    slope = {
        "gravity_m_s2": runs.GRAVITY * math.cos(angle),
        "container.height_m": 0.5,
        "contact.mu_static": 0.2,
        "solver.duration_s": 1.0,
    }
    done = runs.run(runs.BOX, slope | runs.pulse(-runs.GRAVITY * math.sin(angle), 5.0))
    late = done.history["time_s"] >= 0.2
    square = np.polyfit(done.history["time_s"][late], done.history["slip_m"][late], 2)[0]
    case, compared = "rigid plate on a slope of 30 degrees, mu 0.2", "acceleration down the slope [m/s2]"
    exact = incline_acceleration(angle=angle, mu_kinetic=0.2, gravity=runs.GRAVITY)
    source = "g (sin - mu cos) = 3.20586 m/s2"
    yield analytic(case, compared, 2.0 * float(square), exact, source=source, relative=1e-3)


@check("sliding", "lasting stick")
def stuck() -> Findings:
    """Half of the friction limit, one way, for 20 s: no slip, and none that grows."""
    held = {"contact.mu_static": 0.4, "solver.duration_s": 20.0, "output.history_s": 0.05}
    models: dict[str, runs.Keys] = {"rigid box": {}, "solid box, 20 modes": runs.SOLID}
    for name, values in models.items():
        done = runs.run(runs.BOX, runs.pulse(0.2 * runs.GRAVITY, 20.0) | held | values)
        slip = done.history["slip_m"]
        case, source = f"{name}, 0.2 g one way for 20 s, mu 0.4", "below the friction limit"
        yield analytic(case, "largest slip [m]", done.joint.max_slip, source=source, absolute=1e-5)
        grown = np.ptp(slip[slip.size // 2 :])
        yield analytic(case, "slip in the second half [m]", grown, source=source, absolute=1e-12)


@check("sliding", "creep of the regularised law")
def creep() -> Findings:
    """Friction regularised in velocity creeps at v_reg atanh(s) under the share s of its limit."""
    share, velocity = 0.5, 1e-3
    regularised = {
        "contact.friction": "regularised",
        "contact.regularisation_velocity_m_s": velocity,
        "contact.mu_static": 0.4,
        "solver.duration_s": 20.0,
    }
    done = runs.run(runs.BOX, regularised | runs.pulse(-share * 0.4 * runs.GRAVITY, 20.0))
    case = "rigid box, friction regularised in velocity, half its limit for 20 s"
    crept, exact = done.history["slip_m"][-1], 20.0 * velocity * math.atanh(share)
    source, note = "v_reg atanh(s) t", "a property of this law; the default law sticks"
    within = STROKE_TOLERANCE
    yield analytic(case, "creep [m]", crept, exact, source=source, relative=within, note=note)


@check("sliding", "friction heat")
def friction_heat() -> Findings:
    """Heat of friction of a box given a push: mu_k times weight times path."""
    done = runs.run(runs.BOX, runs.FRICTION | {"initial.velocity_m_s": 2.0, "solver.duration_s": 2.0})
    slip, heat = float(done.joint.slip_travel), float(done.model.run.ledger[FRICTION_HEAT])
    case, compared = "rigid box pushed at 2 m/s, mu 0.4/0.2", "friction heat over mu_k M g and path"
    heat /= 0.2 * 24525.0 * slip
    yield analytic(case, compared, heat, 1.0, source="Coulomb", absolute=STROKE_TOLERANCE)
    path = 2.0**2 / (2.0 * 0.2 * runs.GRAVITY)
    yield analytic(case, "path [m]", slip, path, source="v^2/(2 mu_k g)", relative=STROKE_TOLERANCE)


@check("sliding", "a push on every support")
def push_on_every_support() -> Findings:
    """Path of a box and of the stack pushed at 1 m/s, on corners, feet and flat base, rigid and as a shell."""
    path = 1.0 / (2.0 * 0.2 * runs.GRAVITY)
    pushed: runs.Keys = {"contact.mu_static": 0.2, "initial.velocity_m_s": 1.0, "solver.duration_s": 1.0}
    for (name, case, tolerance), kind in product(
        (("box", runs.BOX, 1e-3), ("stack", runs.STACK, 5e-3)), SUPPORTS
    ):
        for model, values in {"rigid": {}, "shell": SHELL}.items():
            done = runs.run(case, SUPPORTS[kind] | pushed | values)
            what, slip = f"{model} {name} on {kind}, pushed at 1 m/s, mu 0.2", done.history["slip_m"][-1]
            yield analytic(what, "path [m]", slip, path, source="v^2/(2 mu g)", relative=tolerance)


@check("sliding", "half-sine pulse")
def half_sine() -> Findings:
    """Slip under half a sine of 2.65 m/s2 and 2 s, little above stiction.

    2.65 m/s2 are 0.98 of the stack's uplift: on feet and a flat base it tilts and slides further than the slider.
    """
    models: dict[str, runs.Keys] = {"rigid": {}, "shell": SHELL}
    boxes = [
        (f"{model} box on {kind}", runs.BOX, SUPPORTS[kind] | values)
        for kind, (model, values) in product(SUPPORTS, models.items())
    ]
    boxes.append(("rigid stack on corners", runs.STACK, {}))
    for mu in (0.25, 0.26):
        slider = RigidSlider(mu_static=mu, mu_kinetic=mu, gravity=runs.GRAVITY)
        exact = simulate_sliding(slider, half_sine_pulse(peak=2.65, duration=2.0), duration=3.0).largest_slip
        motion = runs.pulse(2.65, 2.0, "half-sine") | {"contact.mu_static": mu, "solver.duration_s": 3.0}
        for name, case, values in boxes:
            slip = runs.run(case, motion | values).joint.max_slip
            what, compared = f"{name}, half-sine of 2.65 m/s2 and 2 s, mu {mu}", "largest slip [m]"
            yield computed(what, compared, slip, exact, source=SLIDER, relative=STROKE_TOLERANCE)


@check("sliding", "steady strokes")
def steady_strokes() -> Findings:
    """Steady slip from peak to peak under a harmonic floor, one coefficient of friction."""
    sampling = {"solver.duration_s": 30 * PERIOD, "output.history_s": PERIOD / 400}
    source = "2 sqrt(1 - (pi kappa/2)^2), or two stops a cycle"
    for kappa, stroke in ((0.2, 1.898741), (0.5, 1.237982), (0.7, 0.432494)):
        done = runs.run(runs.BOX, runs.harmonic(AMPLITUDE, OMEGA) | friction_of(kappa) | sampling)
        case, ratio = f"rigid box, mu g/(A Omega^2) = {kappa}", stroke_of(done) / AMPLITUDE
        compared = "steady slip, peak to peak, over A"
        yield analytic(case, compared, ratio, stroke, source=source, relative=STROKE_TOLERANCE)


@check("sliding", "sliding without stops")
def sliding_without_stops() -> Findings:
    """Friction ratio up to which the slider never stops: the motion on either side of it."""
    for static_ratio, reference in ((1.0, 0.53703), (2.0, 0.39322)):
        limit = never_stops_ratio(static_ratio)
        settings = {"solver.duration_s": 40.0 * PERIOD, "output.history_s": PERIOD / 1000}
        settings |= runs.harmonic(AMPLITUDE, OMEGA)
        below, above = (
            runs.run(runs.BOX, settings | friction_of(factor * limit, static_ratio))
            for factor in (0.95, 1.05)
        )
        stops = [longest_stop(done, 36.0 * PERIOD) > SHORTEST_STOP * PERIOD for done in (below, above)]
        case = f"rigid box, mu_s = {static_ratio:g} mu_k"
        yield analytic(
            case,
            "friction ratio up to which it never stops, if 0.95 of it does not stop and 1.05 does",
            limit if stops == [False, True] else math.nan,
            reference,
            source="1/sqrt((mu_s/mu_k)^2 + pi^2/4)",
            absolute=5e-6,
        )
        yield analytic(
            f"{case}, 1.05 of that friction ratio",
            "steady slip, peak to peak, over A",
            stroke_of(above) / AMPLITUDE,
            steady_stroke(friction_ratio=1.05 * limit, static_ratio=static_ratio),
            source="two stops a cycle, each 2 % of it",
            relative=STROKE_TOLERANCE,
        )


@check("sliding", "a turn without a stop")
def turn_without_a_stop() -> Findings:
    """Friction that falls over 0.2 mm of slip: a slip that turns round without a stop keeps its kinetic friction."""
    kappa = 0.95 * never_stops_ratio(2.0)
    kinetic = kappa * AMPLITUDE * OMEGA**2 / runs.GRAVITY
    slider = RigidSlider(mu_static=2.0 * kinetic, mu_kinetic=kinetic, gravity=runs.GRAVITY)
    floor = sine_floor(amplitude=AMPLITUDE, angular_frequency=OMEGA)
    steady = simulate_sliding(slider, floor, duration=41.0 * PERIOD, slip_velocity=-AMPLITUDE * OMEGA)
    start = {
        "initial.velocity_m_s": float(steady.at(np.array([40.0 * PERIOD]))[1][0]),
        "contact.weakening_m": 2e-4,
        "solver.duration_s": 20.0 * PERIOD,
        "output.history_s": PERIOD / 400,
    }
    yield computed(
        "rigid box, mu_s = 2 mu_k over 0.2 mm, 0.95 of the friction ratio at which it never stops",
        "steady slip, peak to peak, over A",
        stroke_of(runs.run(runs.BOX, runs.harmonic(AMPLITUDE, OMEGA) | friction_of(kappa, 2.0) | start))
        / AMPLITUDE,
        steady.peak_to_peak(39.0 * PERIOD, 40.0 * PERIOD) / AMPLITUDE,
        source=f"{SLIDER} whose friction falls at once",
        relative=STROKE_TOLERANCE,
    )


@check("sliding", "friction that falls with the velocity")
def falling_friction() -> Findings:
    """Steady stroke of the paper's box where friction falls from 0.4 to 0.2 like exp(-(v/v_s)^2)."""
    for stribeck, stroke in ((0.1, 37.222e-3), (0.3, 12.522e-3)):
        changed = {"contact.stribeck_velocity_m_s": stribeck, "solver.duration_s": 20.0}
        found = stroke_of(runs.run(runs.BOX, PAPER_BOX | changed))
        case = f"rigid box, A = 0.05 m, Omega = 10 rad/s, v_s = {stribeck:g} m/s"
        compared, source = "steady slip, peak to peak [m]", "rigid slider in steps of 10 us, explicit"
        yield computed(case, compared, found, stroke, source=source, relative=STROKE_TOLERANCE)


@check("sliding", "the paper's box on a fast floor")
def paper_slider() -> Findings:
    """Steady stroke of the box with 0.4/0.2 on a floor of 50 mm at 10 rad/s: rigid, and elastic."""
    models: dict[str, runs.Keys] = {"rigid box": {}, "stiff solid box, 20 modes": runs.STIFF_SOLID}
    for name, values in models.items():
        stroke = stroke_of(runs.run(runs.BOX, PAPER_BOX | values | {"solver.duration_s": 20.0}))
        case = f"{name}, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2"
        compared = "steady slip, peak to peak [m]"
        yield computed(case, compared, stroke, 78.745e-3, source=SLIDER, relative=STROKE_TOLERANCE)


@check("sliding", "position of the paper's box")
def paper_slider_position() -> Findings:
    """Slip of that box: the largest, after ten periods, and at every instant of them."""
    sampled = {"solver.duration_s": 10.0 * PERIOD, "output.history_s": PERIOD / 100}
    done = runs.run(runs.BOX, PAPER_BOX | sampled)
    times, slip = done.history["time_s"], done.history["slip_m"]
    exact = slip_of_the_papers_slider(times)
    case = "rigid box, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2"
    largest = done.joint.max_slip
    yield computed(case, "largest slip [m]", largest, LARGEST, source=SLIDER, relative=STROKE_TOLERANCE)
    compared, source = "slip after ten periods over the largest", f"{SLIDER}, 19.893 of 79.144 mm"
    last = float(slip[-1]) / LARGEST
    yield computed(case, compared, last, LAST / LARGEST, source=source, absolute=STROKE_TOLERANCE)
    compared = "slip in ten periods, largest difference over the largest slip"
    difference = float(np.abs(slip - exact).max()) / LARGEST
    yield computed(case, compared, difference, source=SLIDER, absolute=STROKE_TOLERANCE)


@check("sliding", "a short stop")
def short_stops() -> Findings:
    """The same box, which the floor finds at rest: its first stops last 8 ms, and are 6 % from none at all.

    While it stops, its floor needs 0.94 of static friction. Springs that overshoot by 6 % end the stop at once.
    """
    stiff: runs.Keys = {"contact.normal_penalty_Pa_m": 1e11}
    bodies: dict[str, tuple[runs.Keys, float]] = {
        "rigid box": ({}, 0.004),
        "rigid box, 1e11 Pa/m": (stiff, 0.004),
        "shell, 20 modes": (SHELL, 0.03),
        "shell, 20 modes, 1e11 Pa/m": (SHELL | stiff, 0.03),
    }
    values = PAPER_BOX | {"motion.start": "rest", "solver.duration_s": 10.0 * PERIOD}
    for name, (keys, tolerance) in bodies.items():
        done = runs.run(runs.BOX, values | keys)
        least = float(done.history["slip_m"].min())
        exact = float(slip_of_the_papers_slider(done.history["time_s"], start_velocity=-0.5).min())
        case = f"{name}, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2, at rest at t = 0"
        note = "a shell swings on when it stops" if tolerance > 0.01 else ""
        yield computed(case, "least slip [m]", least, exact, source=SLIDER, relative=tolerance, note=note)


@check("sliding", "a pull below stiction")
def pull_below_stiction() -> Findings:
    """A pull switched on at once, below static friction: spring and shell swing over it, the box does not slide off."""
    bodies: dict[str, runs.Keys] = {
        "rigid box": {},
        "shell on corners": SHELL,
        "shell on its flat base": SHELL | {"support.kind": "flat"},
    }
    for name, keys in bodies.items():
        for share in (0.8, 0.98):
            values = runs.pulse(share * 0.4 * runs.GRAVITY, 0.5) | runs.FRICTION | {"solver.duration_s": 1.0}
            slip = runs.run(runs.BOX, values | keys).joint.max_slip
            case = f"{name}, {share:g} of stiction for 0.5 s, mu 0.4/0.2"
            compared, source = "largest slip over the width", "a rigid slider rests"
            yield analytic(case, compared, slip / 1.1, source=source, absolute=1e-4)


@check("sliding", "rectangular pulse")
def pulses() -> Findings:
    """Slip after a rectangular pulse, one way."""
    source = "V^2/(2 mu g) (1 - mu g/a0)"
    for kinetic in (0.4, 0.2):
        friction = {"contact.mu_static": 0.4, "contact.mu_kinetic": kinetic}
        done = runs.run(runs.BOX, runs.pulse(8.0, 0.3) | friction | {"solver.duration_s": 2.0})
        exact = pulse_slip(peak=8.0, duration=0.3, mu_static=0.4, mu_kinetic=kinetic, gravity=runs.GRAVITY)
        case, slip = f"rigid box, 8 m/s2 for 0.3 s, mu 0.4/{kinetic}", done.history["slip_m"][-1]
        yield analytic(case, "residual slip [m]", slip, exact, source=source, relative=STROKE_TOLERANCE)


def friction_of(kappa: float, static_ratio: float = 1.0) -> runs.Keys:
    """Coefficients with mu_k g = kappa A Omega^2 and mu_s = static_ratio mu_k."""
    kinetic = kappa * AMPLITUDE * OMEGA**2 / runs.GRAVITY
    return {"contact.mu_static": static_ratio * kinetic, "contact.mu_kinetic": kinetic}


def slip_of_the_papers_slider(times: FloatArray, start_velocity: float = 0.0) -> FloatArray:
    """Slip [m] of the rigid slider with 0.4/0.2 on a floor of 50 mm at 10 rad/s, times (n,) [s]."""
    slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=runs.GRAVITY)
    floor = sine_floor(amplitude=0.05, angular_frequency=10.0)
    motion = simulate_sliding(slider, floor, duration=float(times[-1]), slip_velocity=start_velocity)
    return motion.at(times)[0]


def slip_of_a_driven_box(case: str, keys: runs.Keys, floor: FloorAcceleration, gravity: float) -> Finding:
    """Slip in 5 s of a box with 0.3/0.2 on a floor of 50 mm at 10 rad/s and what the keys add, against the slider.

    Floor and gravity [m/s2] are those of the slider.
    """
    friction = {"contact.mu_static": 0.3, "contact.mu_kinetic": 0.2, "solver.duration_s": 5.0}
    done = runs.run(runs.BOX, runs.harmonic(0.05, 10.0) | friction | keys)
    slider = RigidSlider(mu_static=0.3, mu_kinetic=0.2, gravity=gravity)
    exact = simulate_sliding(slider, floor, duration=5.0).at(done.history["time_s"])[0]
    case, compared = (
        f"rigid box, mu 0.3/0.2, 5 m/s2 at 10 rad/s, {case}",
        "slip in 5 s, largest difference over the largest slip",
    )
    difference = np.abs(done.history["slip_m"] - exact).max() / np.abs(exact).max()
    return computed(case, compared, difference, source=SLIDER, absolute=1e-2)


def longest_stop(done: runs.Finished, since: float) -> float:
    """Longest interval without sliding after an instant [s]."""
    late = done.history["time_s"] > since
    modes = [mode for mode, chosen in zip(done.history.modes, late, strict=True) if chosen]
    stops = [len(list(same)) for mode, same in groupby(modes) if mode == Outcome.REST]
    return max(stops, default=0) * done.model.case.output.history_s


def stroke_of(done: runs.Finished) -> float:
    """Slip from peak to peak over the last period [m]."""
    times, slip = done.history["time_s"], done.history["slip_m"]
    return float(np.ptp(slip[times >= times[-1] - PERIOD * (1.0 + 1e-9)]))
