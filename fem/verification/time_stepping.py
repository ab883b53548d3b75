"""The time stepping: orders, spectral radius, period error, closure of the energy ledger.

Newmark (1959); Chung and Hulbert, J. Appl. Mech. 60 (1993) 371. Theory is evaluated here from the published
equations, not from the stepper.
"""

import math
from collections.abc import Iterator

import numpy as np

from contact.stepping.modal_body import ModalBody, make_modal_body
from contact.stepping.scheme import Scheme, generalised_alpha, newmark
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.verification.bodies import free_run
from fem.verification.manufactured import moving_body_error
from fem.verification.rows import Row, analytic, check, convergence
from fem.verification.runs import SOLID, STACK, Keys, finish, with_steps_of

TRAPEZOIDAL = "trapezoidal rule"
SCHEMES = {
    "generalised-alpha 0": generalised_alpha(0.0),
    "generalised-alpha 0.5": generalised_alpha(0.5),
    "generalised-alpha 0.8": generalised_alpha(0.8),
    TRAPEZOIDAL: newmark(0.25, 0.5),
}
CHUNG_HULBERT = "Chung and Hulbert 1993"
OMEGA, DAMPING = 2.0 * math.pi, 0.05  #: of the oscillator


@check("time", "order on a linear oscillator")
def linear_order() -> Iterator[Row]:
    """Order 2 on a damped oscillator, in position and velocity."""
    end = 1.3
    for name, scheme in SCHEMES.items():
        errors = {end / count: oscillator_error(scheme, end / count, end) for count in (40, 80, 160, 320)}
        orders = convergence("step/period", errors, order=2.0, within=0.1)
        yield analytic(
            f"damped oscillator, {name}",
            "error after 1.3 periods over the amplitude",
            orders.finest,
            0.0,
            source="exact solution",
            absolute=2e-3,
            convergence=orders,
        )


@check("time", "order at large rotation")
def large_rotation_order() -> Iterator[Row]:
    """Order 2 on a body that rotates by more than a radian while strained, with a manufactured source."""
    for name in ("generalised-alpha 0.5", TRAPEZOIDAL):
        errors = {0.5 / n: moving_body_error(SCHEMES[name], 0.5 / n) for n in (20, 40, 80, 160)}
        orders = convergence("step [s]", errors, order=2.0, within=0.1)
        yield analytic(
            f"full model, manufactured motion through 1.4 rad, {name}",
            "error of the nodes at 0.5 s over the size of the body",
            orders.finest,
            0.0,
            source="manufactured solution, exact in space",
            absolute=1e-3,
            convergence=orders,
        )


@check("time", "spectral radius")
def spectral_radii() -> Iterator[Row]:
    """Largest eigenvalue of a step at (almost) infinite frequency, from steps of the stepper."""
    note = "three equal eigenvalues meet at infinity: at 1e5 they differ by a cube root of rounding"
    compared = "spectral radius at omega h = 1e5"
    for radius in (0.0, 0.5, 0.8, 1.0):
        found = np.abs(np.linalg.eigvals(amplification(generalised_alpha(radius), 1e5))).max()
        case = f"generalised-alpha {radius}"
        yield analytic(case, compared, found, radius, source=CHUNG_HULBERT, absolute=0.02, note=note)


@check("time", "period error")
def period_errors() -> Iterator[Row]:
    """Elongation of the period at omega h = 0.3, from the eigenvalues of a step."""
    compared = "elongation of the period at omega h = 0.3"
    for name, scheme in SCHEMES.items():
        found = elongation(amplification(scheme, 0.3), 0.3)
        exact, source = elongation(published_amplification(scheme, 0.3), 0.3), CHUNG_HULBERT
        if name == TRAPEZOIDAL:
            exact, source = 0.15 / math.atan(0.15) - 1.0, "omega h/(2 arctan(omega h/2)) - 1"
        yield analytic(name, compared, found, exact, source=source, relative=1e-6)


@check("time", "energy closure")
def energy_closure() -> Iterator[Row]:
    """The energy balance closes with the square of the step if nothing opens, slides or strikes."""
    trembling = {"initial.velocity_m_s": 1e-3, "contact.damping_ratio": 0.0, "solver.duration_s": 0.1}
    kinetic = 0.5 * 1e4 * 1e-6
    models: dict[str, Keys] = {"rigid stack": {}, "solid stack, 20 modes": SOLID}
    for name, values in models.items():
        errors: dict[float, float] = {}
        for step in (2e-4, 1e-4, 5e-5, 2.5e-5):
            model = build_model(STACK.with_values(values | trembling))
            clock = finish(with_steps_of(model, step)).model.run.clock[0]
            errors[step] = max(-float(clock.least_imbalance), float(clock.most_imbalance)) / kinetic
        orders = convergence("step [s]", errors, order=2.0, within=0.15, at_least=True)
        yield analytic(
            f"{name} trembling on closed springs, generalised-alpha 0.5",
            "largest energy balance error over the first kinetic energy",
            orders.finest,
            0.0,
            source="energy balance; the scheme's own dissipation is of order 3",
            convergence=orders,
        )


def oscillator(omega: float, damping_ratio: float) -> ModalBody:
    """A body without weight, one elastic mode."""
    return make_modal_body(
        mass=1.0,
        inertia=1.0,
        gravity=0.0,
        point=np.array([[-0.5, 0.0], [0.5, 0.0]]),
        rest=(0.0, 1.0),
        shape=np.zeros((2, 2, 1)),
        frequencies=np.array([omega]),
        damping_ratios=np.array([damping_ratio]),
        tolerance=1e-12,
    )


def oscillator_error(scheme: Scheme, step: float, end: float) -> float:
    """Error of position and velocity over the amplitude after a time, from an amplitude of one."""
    flight = free_run(
        oscillator(OMEGA, DAMPING), step=step, scheme=scheme, modal_position=np.ones(1), until=end
    ).advance(end)
    t, rate, decay = flight.time, OMEGA * math.sqrt(1.0 - DAMPING**2), DAMPING * OMEGA
    envelope = math.exp(-decay * t)
    position = envelope * (math.cos(rate * t) + decay / rate * math.sin(rate * t))
    velocity = -envelope * OMEGA**2 / rate * math.sin(rate * t)
    state = flight.state
    return math.hypot(float(state.position[3]) - position, (float(state.velocity[3]) - velocity) / OMEGA)


def amplification(scheme: Scheme, sampled_frequency: float) -> FloatArray:
    """What one step of the stepper makes of position, velocity and acceleration of an oscillator, h = 1."""
    columns = []
    for unit in np.eye(3):
        flight = free_run(oscillator(sampled_frequency, 0.0), step=1.0, scheme=scheme)
        state = flight.state
        state.position[3], state.velocity[3], state.acceleration[3] = unit
        state.internal[3] = sampled_frequency**2 * unit[0]
        flight.run.clock[0].basis_step = 1.0
        flight.advance(1.0)
        columns.append([state.position[3], state.velocity[3], state.acceleration[3]])
    return np.array(columns).T


def published_amplification(scheme: Scheme, sampled_frequency: float) -> FloatArray:
    """The same from the published equations: three linear equations for the new values, h = 1."""
    beta, gamma, alpha_m, alpha_f = scheme
    square = sampled_frequency**2
    new = np.array([[1.0, 0.0, -beta], [0.0, 1.0, -gamma], [(1.0 - alpha_f) * square, 0.0, 1.0 - alpha_m]])
    old = np.array([[1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1.0 - gamma], [-alpha_f * square, 0.0, -alpha_m]])
    return np.linalg.solve(new, old)


def elongation(matrix: FloatArray, sampled_frequency: float) -> float:
    """Elongation of the period by the oscillating eigenvalue of a step's matrix [-]."""
    values = np.linalg.eigvals(matrix)
    return float(sampled_frequency / abs(np.angle(values[np.argmax(np.imag(values))])) - 1.0)
