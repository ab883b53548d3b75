"""The time stepping: orders, spectral radius, period error, energy closure, and invariance of the motion.

Newmark (1959); Chung and Hulbert, J. Appl. Mech. 60 (1993) 371. Theory is evaluated here from the published
equations, not from the stepper. The motion must not depend on a spin, a mirror image, scales or a constant velocity
added to the floor.
"""

import math

import numpy as np
import runs
from block_on_floor import piecewise_motion
from evidence.findings import Convergence, Finding, analytic
from meshes import graded_block
from verification.bodies import Flight, free_run, full_body
from verification.checks import PROGRAM, Findings, check
from verification.manufactured import moving_body_error

from contact.stepping.modal_body import ModalBody, make_modal_body
from contact.stepping.scheme import Scheme, generalised_alpha, newmark
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.solid.assembly import FiniteElements, assemble

TRAPEZOIDAL = "trapezoidal rule"
SCHEMES = {
    "generalised-alpha 0": generalised_alpha(0.0),
    "generalised-alpha 0.5": generalised_alpha(0.5),
    "generalised-alpha 0.8": generalised_alpha(0.8),
    TRAPEZOIDAL: newmark(0.25, 0.5),
}
CHUNG_HULBERT = "Chung and Hulbert 1993"
OMEGA, DAMPING = 2.0 * math.pi, 0.05  #: of the oscillator
SPIN = 20.0  #: of a block thrown into the air [rad/s]
#: rocks, slides and strikes for 5 s
VIOLENT = runs.harmonic(0.1, 8.0) | {"contact.mu_static": 0.3, "solver.duration_s": 5.0}


@check("time", "order on a linear oscillator")
def linear_order() -> Findings:
    """Order 2 on a damped oscillator, in position and velocity."""
    end = 1.3
    for name, scheme in SCHEMES.items():
        errors = {end / count: oscillator_error(scheme, end / count, end) for count in (40, 80, 160, 320)}
        orders = Convergence("step/period", errors, order=2.0, within=0.1)
        case, compared = f"damped oscillator, {name}", "error after 1.3 periods over the amplitude"
        yield analytic(case, compared, source="exact solution", absolute=2e-3, convergence=orders)


@check(
    "time",
    "order at large rotation",
    quick=False,
    inputs="The source of the motion is that of the program's elements: the error is that of time stepping alone.",
)
def large_rotation_order() -> Findings:
    """Order 2 on a body that rotates by more than a radian while strained, with a manufactured source."""
    for name in ("generalised-alpha 0.5", TRAPEZOIDAL):
        errors = {0.5 / n: moving_body_error(SCHEMES[name], 0.5 / n) for n in (20, 40, 80, 160)}
        orders = Convergence("step [s]", errors, order=2.0, within=0.1)
        case = f"full model, manufactured motion through 1.4 rad, {name}"
        compared = "error of the nodes at 0.5 s over the size of the body"
        source = "manufactured solution, exact in space"
        yield analytic(case, compared, source=source, absolute=1e-3, convergence=orders)


@check("time", "spectral radius")
def spectral_radii() -> Findings:
    """Largest eigenvalue of a step at (almost) infinite frequency, from steps of the stepper."""
    note = "three equal eigenvalues meet at infinity: at 1e5 they differ by a cube root of rounding"
    compared = "spectral radius at omega h = 1e5"
    for radius in (0.0, 0.5, 0.8, 1.0):
        largest = np.abs(np.linalg.eigvals(amplification(generalised_alpha(radius), 1e5))).max()
        case = f"generalised-alpha {radius}"
        yield analytic(case, compared, largest, radius, source=CHUNG_HULBERT, absolute=0.02, note=note)


@check("time", "period error")
def period_errors() -> Findings:
    """Elongation of the period at omega h = 0.3, from the eigenvalues of a step."""
    compared = "elongation of the period at omega h = 0.3"
    for name, scheme in SCHEMES.items():
        value = elongation(amplification(scheme, 0.3), 0.3)
        exact, source = elongation(published_amplification(scheme, 0.3), 0.3), CHUNG_HULBERT
        if name == TRAPEZOIDAL:
            exact, source = 0.15 / math.atan(0.15) - 1.0, "omega h/(2 arctan(omega h/2)) - 1"
        yield analytic(name, compared, value, exact, source=source, relative=1e-6)


@check("time", "energy closure")
def energy_closure() -> Findings:
    """The energy balance closes with the square of the step if nothing opens, slides or strikes."""
    vibrating = {"initial.velocity_m_s": 1e-3, "contact.damping_ratio": 0.0, "solver.duration_s": 0.1}
    kinetic = 0.5 * 1e4 * 1e-6
    for name, values in runs.STACKS.items():
        errors: dict[float, float] = {}
        for step in (2e-4, 1e-4, 5e-5, 2.5e-5):
            model = build_model(runs.STACK.with_values(values | vibrating))
            clock = runs.finish(runs.with_steps_of(model, step)).model.run.clock[0]
            errors[step] = max(-float(clock.least_imbalance), float(clock.most_imbalance)) / kinetic
        orders = Convergence("step [s]", errors, order=2.0, within=0.15, at_least=True)
        case = f"{name} vibrating on closed springs, generalised-alpha 0.5"
        compared = "largest energy balance error over the first kinetic energy"
        source = "energy balance; the scheme's own dissipation is of order 3"
        yield analytic(case, compared, source=source, convergence=orders)


@check("time", "spin", quick=False, inputs="The mass matrix is the program's.")
def spin() -> Findings:
    """A block thrown spinning: it keeps its angular momentum, and rotates evenly if it is stiff."""
    turn = 2.0 * math.pi / SPIN
    errors = {turn / count: spinning(1e8, turn / count)[0] for count in (200, 400, 800)}
    orders = Convergence("step [s]", errors, order=2.0, within=0.2)
    yield analytic(
        "block of E = 1e8 Pa thrown at 20 rad/s, full model, generalised-alpha 1",
        "angular momentum, largest relative change in one revolution",
        source="no external moment",
        absolute=1e-4,
        convergence=orders,
    )
    yield analytic(
        "block of E = 1e9 Pa thrown at 20 rad/s, full model, generalised-alpha 1",
        "rotation missing after one revolution [rad]",
        spinning(1e9, turn / 800)[1],
        source="even rotation",
        absolute=2e-3,
        note="the spin stretches the block and its inertia grows: 0.008 rad at a tenth of the stiffness",
    )


@check("time", "mirror symmetry", inputs=PROGRAM)
def mirror() -> Findings:
    """The floor's motion mirrored: the container's motion mirrored."""
    note = "sin(Omega t + pi) is -sin(Omega t) except for rounding"
    for name, values in runs.STACKS.items():
        plain, mirrored = (
            runs.run(runs.STACK, VIOLENT | values | {"motion.phase_rad": phase}) for phase in (0.0, math.pi)
        )
        case = f"{name}, slide-rocking for 5 s, floor mirrored"
        yield same_rotation(case, plain, -mirrored.history["rotation_rad"], source="symmetry", note=note)


@check("time", "scaling", inputs=PROGRAM)
def scaling() -> Findings:
    """Lengths times four, times times two: the same rotation."""
    scaled = {"container.width_m": 4.4, "container.height_m": 16.0, "container.depth_m": 4.4}
    scaled |= {"container.weight_N": 64.0 * 98100.0, "solver.element_size_m": 4.0}
    scaled |= {"motion.amplitude_m": 0.4, "motion.angular_frequency_rad_s": 4.0}
    scaled |= {"solver.duration_s": 10.0, "output.history_s": 0.01}
    plain, enlarged = runs.run(runs.STACK, VIOLENT), runs.run(runs.STACK, VIOLENT | scaled)
    case = "rigid stack, slide-rocking for 5 s, lengths x 4 and times x 2"
    yield same_rotation(case, plain, enlarged.history["rotation_rad"], source="dimensional analysis")


@check("time", "Galilean invariance", inputs=PROGRAM)
def galilei() -> Findings:
    """A constant velocity of 3 m/s added to the floor and the container: the same relative motion."""
    knots, case = [0.0, 0.25, 0.75, 1.0], runs.STACK.with_values(VIOLENT | {"solver.duration_s": 2.0})
    floors = (piecewise_motion(knots, [4.0, -4.0, 4.0, 0.0], velocity=drift) for drift in (0.0, 3.0))
    still, travelling = (
        runs.finish(runs.with_motion(runs.with_steps_of(build_model(case), 1e-5), floor, (0.25, 0.75, 1.0)))
        for floor in floors
    )
    yield same_rotation(
        "rigid stack, rocking for 2 s on a floor with 3 m/s added",
        still,
        travelling.history["rotation_rad"],
        source="Galilean invariance",
        note="fixed steps: the step control uses the work of the base, which is not invariant",
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


def oscillator_error(scheme: Scheme, step: float, end: float, ends: FloatArray | None = None) -> float:
    """Error of position and velocity over the amplitude after a time, from an amplitude of one.

    `ends` are instants at which a step must end [s]; None: the end alone.
    """
    flight = free_run(
        oscillator(OMEGA, DAMPING),
        step=step,
        scheme=scheme,
        modal_position=1.0,
        ends=end if ends is None else ends,
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


def elongation(matrix: FloatArray, sampled_frequency: float) -> float:
    """Elongation of the period by the oscillating eigenvalue of a step's matrix [-]."""
    values = np.linalg.eigvals(matrix)
    return float(sampled_frequency / abs(np.angle(values[np.argmax(np.imag(values))])) - 1.0)


def spinning(youngs_modulus: float, step: float) -> tuple[float, float]:
    """Largest relative change of the angular momentum in one revolution, and |rotation| at its end [rad]."""
    elements = assemble(graded_block(), youngs_modulus=youngs_modulus, poisson_ratio=0.3, order=1)
    body = full_body(elements)
    arm = elements.nodes - body.centroid
    flight = free_run(
        body,
        step=step,
        scheme=generalised_alpha(1.0),
        velocity=SPIN * np.column_stack([arm[:, 1], -arm[:, 0]]),
        height=5.0,
    )
    first, change = angular_momentum(flight, elements), 0.0
    for share in np.arange(1, 41) / 40:
        flight.advance(float(share) * 2.0 * math.pi / SPIN)
        change = max(change, abs(angular_momentum(flight, elements) / first - 1.0))
    return change, abs(float(flight.state.pose[0]))


def angular_momentum(flight: Flight, elements: FiniteElements) -> float:
    """About the mass centre, positive toward +x [kg m2/s]."""
    position, velocity = (array.reshape(-1, 2) for array in (flight.state.position, flight.state.velocity))
    momentum, arm = elements.mass @ velocity, position - flight.state.pose[2:4]
    return float(np.sum(arm[:, 1] * momentum[:, 0] - arm[:, 0] * momentum[:, 1]))


def same_rotation(
    case: str, done: runs.Finished, other: FloatArray, *, source: str, note: str = ""
) -> Finding:
    """The row of a rotation that must equal that of a run at every sample."""
    rotation, angle = done.history["rotation_rad"], done.block.slenderness_angle
    count = min(rotation.size, other.size)
    largest = np.abs(rotation).max() / angle
    compared = f"rotation, largest difference over the slenderness angle (largest rotation {largest:.2f})"
    difference = np.abs(rotation[:count] - other[:count]).max() / angle
    return analytic(case, compared, difference, source=source, absolute=1e-6, note=note)
