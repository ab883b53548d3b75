"""Sliding without rocking: a rigid box on Coulomb friction against the rigid slider.

The slider of `contact.reference.sliding` is event-driven, sticks perfectly and shares no code with the stepping; the
box sticks by stiff springs. The box is 1.1 x 1.0 m on two corners. Den Hartog, Trans. ASME APM-53-9 (1931); Westermo
and Udwadia, Earthquake Engng Struct. Dyn. 11 (1983); Newmark, Geotechnique 15 (1965).
"""

import math
from collections.abc import Iterator
from itertools import groupby

import numpy as np

from contact.reference.closed_forms_sliding import never_stops_ratio, pulse_slip, steady_stroke
from contact.reference.floor_acceleration import sine_floor
from contact.reference.sliding import RigidSlider, simulate_sliding
from fem.model.model import build_model
from fem.verification.rows import Row, analytic, check, computed
from fem.verification.runs import BOX, FRICTION, GRAVITY, STIFF_SOLID, Finished, Keys, harmonic, pulse, run

AMPLITUDE, OMEGA = 0.1, 10.0
PERIOD = 2.0 * math.pi / OMEGA
STROKE_TOLERANCE = 5e-3
LARGEST, LAST = 79.144e-3, 19.893e-3  #: slip of the paper's box, largest and after ten periods [m]
STIFFER = 10.0  #: times the default penalty, where the response time of the springs would show
#: over the period: a spring needs a few thousandths of it to reverse
SHORTEST_STOP = 5e-3
SLIDER = "event-driven slider"
#: the box of the paper on a floor of 50 mm at 10 rad/s
PAPER_BOX = harmonic(0.05, 10.0) | FRICTION


@check("sliding", "steady strokes")
def steady_strokes() -> Iterator[Row]:
    """Steady slip from peak to peak under a harmonic floor, one coefficient of friction."""
    sampling = {"solver.duration_s": 30 * PERIOD, "output.history_s": PERIOD / 400}
    source = "2 sqrt(1 - (pi kappa/2)^2), or two stops a cycle"
    for kappa, stroke in ((0.2, 1.898741), (0.5, 1.237982), (0.7, 0.432494)):
        done = run(BOX, harmonic(AMPLITUDE, OMEGA) | friction_of(kappa) | sampling)
        case, found = f"rigid box, mu g/(A Omega^2) = {kappa}", stroke_of(done) / AMPLITUDE
        compared = "steady slip, peak to peak, over A"
        yield analytic(case, compared, found, stroke, source=source, relative=STROKE_TOLERANCE)


@check("sliding", "sliding without stops")
def sliding_without_stops() -> Iterator[Row]:
    """Friction ratio up to which the slider never stops: the motion on either side of it."""
    for static_ratio, reference in ((1.0, 0.53703), (2.0, 0.39322)):
        limit = never_stops_ratio(static_ratio)
        below, above = (near_the_limit(factor * limit, static_ratio) for factor in (0.95, 1.05))
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
        exact = steady_stroke(friction_ratio=1.05 * limit, static_ratio=static_ratio)
        stiff = near_the_limit(1.05 * limit, static_ratio, stiffer=STIFFER)
        soft = abs(stroke_of(above) / AMPLITUDE - exact) / exact
        yield analytic(
            f"{case}, 1.05 of that friction ratio, penalty x {STIFFER:g}",
            "steady slip, peak to peak, over A",
            stroke_of(stiff) / AMPLITUDE,
            exact,
            source="two stops a cycle, each 2 % of it",
            relative=STROKE_TOLERANCE,
            note=f"{100.0 * soft:.2g} % at the default penalty: stops as short as the response time of the springs "
            "are not resolved",
        )


@check("sliding", "the paper's box on a fast floor")
def paper_slider() -> Iterator[Row]:
    """Steady stroke of the box with 0.4/0.2 on a floor of 50 mm at 10 rad/s: rigid, and elastic."""
    models: dict[str, Keys] = {"rigid box": {}, "stiff solid box, 20 modes": STIFF_SOLID}
    for name, values in models.items():
        found = stroke_of(run(BOX, PAPER_BOX | values | {"solver.duration_s": 20.0}))
        case = f"{name}, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2"
        compared = "steady slip, peak to peak [m]"
        yield computed(case, compared, found, 78.745e-3, source=SLIDER, relative=STROKE_TOLERANCE)


@check("sliding", "position of the paper's box")
def paper_slider_position() -> Iterator[Row]:
    """Slip of that box: the largest, after ten periods, and at every instant of them."""
    soft, stiff = (
        run(
            BOX,
            PAPER_BOX
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
    case = f"rigid box, A = 0.05 m, Omega = 10 rad/s, mu 0.4/0.2, penalty x {STIFFER:g}"

    def note(error: float) -> str:
        return (
            f"{100.0 * error / LARGEST:.2g} % at the default penalty: the case is 0.2 % from the limit of sliding "
            "without stops, where the response time of the springs matters"
        )

    yield computed(
        case,
        "largest slip [m]",
        stiff.track.max_slip,
        LARGEST,
        source=SLIDER,
        relative=STROKE_TOLERANCE,
        note=note(abs(soft.track.max_slip - LARGEST)),
    )
    yield computed(
        case,
        "slip after ten periods over the largest",
        stiff.history["slip_m"][-1] / LARGEST,
        LAST / LARGEST,
        source=f"{SLIDER}, 19.893 of 79.144 mm",
        absolute=STROKE_TOLERANCE,
        note=note(abs(soft.history["slip_m"][-1] - LAST)),
    )
    yield computed(
        case,
        "slip in ten periods, largest difference over the largest slip",
        np.abs(stiff.history["slip_m"] - exact).max() / LARGEST,
        0.0,
        source=SLIDER,
        absolute=STROKE_TOLERANCE,
        note=note(np.abs(soft.history["slip_m"] - exact).max()),
    )


@check("sliding", "rectangular pulse")
def pulses() -> Iterator[Row]:
    """Slip after a rectangular pulse, one way."""
    source = "V^2/(2 mu g) (1 - mu g/a0)"
    for kinetic in (0.4, 0.2):
        friction = {"contact.mu_static": 0.4, "contact.mu_kinetic": kinetic}
        done = run(BOX, pulse(8.0, 0.3) | friction | {"solver.duration_s": 2.0})
        exact = pulse_slip(peak=8.0, duration=0.3, mu_static=0.4, mu_kinetic=kinetic, gravity=GRAVITY)
        case, found = f"rigid box, 8 m/s2 for 0.3 s, mu 0.4/{kinetic}", done.history["slip_m"][-1]
        yield analytic(case, "residual slip [m]", found, exact, source=source, relative=STROKE_TOLERANCE)


def friction_of(kappa: float, static_ratio: float = 1.0) -> Keys:
    """Coefficients with mu_k g = kappa A Omega^2 and mu_s = static_ratio mu_k."""
    kinetic = kappa * AMPLITUDE * OMEGA**2 / GRAVITY
    return {"contact.mu_static": static_ratio * kinetic, "contact.mu_kinetic": kinetic}


def near_the_limit(kappa: float, static_ratio: float, stiffer: float = 1.0) -> Finished:
    """Forty cycles of the box at a friction ratio, on `stiffer` times the default penalty."""
    settings = {
        "contact.normal_penalty_Pa_m": stiffer * build_model(BOX).penalty,
        "solver.duration_s": 40.0 * PERIOD,
        "output.history_s": PERIOD / 1000,
    }
    return run(BOX, harmonic(AMPLITUDE, OMEGA) | friction_of(kappa, static_ratio) | settings)


def longest_stop(done: Finished, since: float) -> float:
    """Longest interval without sliding after an instant [s]."""
    late = done.history["time_s"] > since
    modes = [mode for mode, chosen in zip(done.history.modes, late, strict=True) if chosen]
    stops = [len(list(same)) for mode, same in groupby(modes) if mode == "rest"]
    return max(stops, default=0) * done.model.case.output.history_s


def stroke_of(done: Finished) -> float:
    """Slip from peak to peak over the last period [m]."""
    times, slip = done.history["time_s"], done.history["slip_m"]
    return float(np.ptp(slip[times >= times[-1] - PERIOD * (1.0 + 1e-9)]))
