"""The time stepping: orders, spectral radius, period error, closure of the energy ledger.

Newmark (1959); Chung and Hulbert, J. Appl. Mech. 60 (1993) 371. Where theory is quoted it is evaluated here from
the published equations, not from the stepper.
"""

import math
from typing import Any

import numpy as np

from contact.stepping.modal_body import ModalBody, make_modal_body
from contact.stepping.scheme import Scheme, generalised_alpha, newmark
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.verification.bodies import Flight, free_run
from fem.verification.manufactured import moving_body_error
from fem.verification.rows import Check, Convergence, Row, as_floats, order_row
from fem.verification.runs import SOLID, STACK, finish, with_steps_of

SCHEMES = {
    "generalised-alpha 0": generalised_alpha(0.0),
    "generalised-alpha 0.5": generalised_alpha(0.5),
    "generalised-alpha 0.8": generalised_alpha(0.8),
    "trapezoidal rule": newmark(0.25, 0.5),
}
CHUNG_HULBERT = "Chung and Hulbert 1993"


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


def linear_order() -> list[Row]:
    """Order 2 on a damped oscillator, in position and velocity."""
    omega, damping, end = 2.0 * math.pi, 0.05, 1.3
    rows = []
    for name, scheme in SCHEMES.items():
        steps = [end / count for count in (40, 80, 160, 320)]
        errors = []
        for step in steps:
            flight = free_run(
                oscillator(omega, damping), step=step, scheme=scheme, modal_position=np.ones(1), until=end
            )
            flight.advance(end)
            errors.append(_oscillator_error(flight, omega, damping))
        rows.append(
            order_row(
                case=f"damped oscillator, {name}",
                compared="error after 1.3 periods over the amplitude",
                convergence=Convergence(
                    against="step/period",
                    sizes=as_floats(steps),
                    errors=as_floats(errors),
                    expected=2.0,
                    tolerance=0.1,
                ),
                kind="analytic",
                source="exact solution",
                tolerance=2e-3,
            )
        )
    return rows


def large_rotation_order() -> list[Row]:
    """Order 2 on a body that turns by more than a radian while it is strained, with a manufactured source."""
    rows = []
    for name in ("generalised-alpha 0.5", "trapezoidal rule"):
        steps = [0.5 / count for count in (20, 40, 80, 160)]
        errors = [moving_body_error(SCHEMES[name], step) for step in steps]
        rows.append(
            order_row(
                case=f"full model, manufactured motion through 1.4 rad, {name}",
                compared="error of the nodes at 0.5 s over the size of the body",
                convergence=Convergence(
                    against="step [s]",
                    sizes=as_floats(steps),
                    errors=as_floats(errors),
                    expected=2.0,
                    tolerance=0.1,
                ),
                kind="analytic",
                source="manufactured solution, exact in space",
                tolerance=1e-3,
            )
        )
    return rows


def spectral_radii() -> list[Row]:
    """Largest eigenvalue of a step at (almost) infinite frequency, from steps of the stepper itself."""
    rows = []
    for radius in (0.0, 0.5, 0.8, 1.0):
        matrix = amplification(generalised_alpha(radius), 1e5)
        rows.append(
            Row(
                case=f"generalised-alpha {radius}",
                compared="spectral radius at omega h = 1e5",
                value=float(np.abs(np.linalg.eigvals(matrix)).max()),
                reference=radius,
                kind="analytic",
                source=CHUNG_HULBERT,
                tolerance=0.02,
                note="three equal eigenvalues meet at infinity: at 1e5 they are a cube root of rounding apart",
            )
        )
    return rows


def period_errors() -> list[Row]:
    """Elongation of the period at omega h = 0.3, from the eigenvalues of a step."""
    rows = []
    for name, scheme in SCHEMES.items():
        found, exact = (
            0.3 / abs(np.angle(_principal(np.linalg.eigvals(matrix)))) - 1.0
            for matrix in (amplification(scheme, 0.3), published_amplification(scheme, 0.3))
        )
        if name == "trapezoidal rule":
            exact = np.float64(0.15 / math.atan(0.15) - 1.0)
        rows.append(
            Row(
                case=name,
                compared="elongation of the period at omega h = 0.3",
                value=float(found),
                reference=float(exact),
                kind="analytic",
                source="omega h/(2 arctan(omega h/2)) - 1" if name == "trapezoidal rule" else CHUNG_HULBERT,
                tolerance=1e-6,
                relative=True,
            )
        )
    return rows


def energy_closure() -> list[Row]:
    """The ledger closes with the square of the step where nothing opens, slides or strikes."""
    rows = []
    for name, values in (("rigid stack", {}), ("solid stack, 20 modes", SOLID)):
        steps, errors = [2e-4, 1e-4, 5e-5, 2.5e-5], []
        for step in steps:
            case = STACK.with_values(
                values
                | {"initial.velocity_m_s": 1e-3, "contact.damping_ratio": 0.0, "solver.duration_s": 0.1}
            )
            model = with_steps_of(build_model(case), step)
            done = finish(model)
            clock = done.model.run.clock[0]
            errors.append(max(-float(clock.least_imbalance), float(clock.most_imbalance)))
        kinetic = 0.5 * 1e4 * 1e-6
        rows.append(
            order_row(
                case=f"{name} trembling on closed springs, generalised-alpha 0.5",
                compared="largest imbalance of the ledger over the first kinetic energy",
                convergence=Convergence(
                    against="step [s]",
                    sizes=as_floats(steps),
                    errors=as_floats([error / kinetic for error in errors]),
                    expected=2.0,
                    tolerance=0.15,
                    at_least=True,
                ),
                kind="analytic",
                source="energy balance; the scheme's own dissipation is of order 3",
            )
        )
    return rows


def amplification(scheme: Scheme, sampled_frequency: float) -> FloatArray:
    """What one step of the stepper makes of position, velocity and acceleration of an oscillator, h = 1."""
    columns = []
    for unit in np.eye(3):
        flight = free_run(oscillator(sampled_frequency, 0.0), step=1.0, scheme=scheme)
        state = flight.state
        state.position[3], state.velocity[3], state.acceleration[3] = unit
        state.internal[3] = sampled_frequency**2 * unit[0]
        flight.run.clock[0].lag_step = 1.0
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


def _principal(values: Any) -> complex:
    return complex(values[np.argmax(np.imag(values))])


def _oscillator_error(flight: Flight, omega: float, damping: float) -> float:
    rate = omega * math.sqrt(1.0 - damping**2)
    t, decay = flight.time, damping * omega
    envelope = math.exp(-decay * t)
    position = envelope * (math.cos(rate * t) + decay / rate * math.sin(rate * t))
    velocity = -envelope * omega**2 / rate * math.sin(rate * t)
    state = flight.state
    return math.hypot(float(state.position[3]) - position, (float(state.velocity[3]) - velocity) / omega)


CHECKS = (
    Check(name="order on a linear oscillator", rows=linear_order),
    Check(name="order at large rotation", rows=large_rotation_order),
    Check(name="spectral radius", rows=spectral_radii),
    Check(name="period error", rows=period_errors),
    Check(name="energy closure", rows=energy_closure),
)
