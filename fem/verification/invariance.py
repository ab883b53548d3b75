"""Invariance of the motion: spin without strain, mirror images, scales, a floor with a constant velocity added.

The stack is that of `fem.verification.runs`, under a floor that makes it rock, slide and strike.
"""

import math
from collections.abc import Iterator

import numpy as np

from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion
from contact.stepping.scheme import generalised_alpha
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.solid.assembly import FiniteElements, assemble
from fem.verification.bodies import Flight, free_run, full_body
from fem.verification.meshes import graded_block
from fem.verification.rows import Row, analytic, check, convergence
from fem.verification.runs import (
    SOLID,
    STACK,
    Finished,
    Keys,
    finish,
    harmonic,
    run,
    with_motion,
    with_steps_of,
)

SPIN = 20.0  #: of a block thrown into the air [rad/s]
#: rocks, slides and strikes for 5 s
VIOLENT = harmonic(0.1, 8.0) | {"contact.mu_static": 0.3, "solver.duration_s": 5.0}


@check("time", "spin")
def spin() -> Iterator[Row]:
    """A block thrown spinning: it keeps its angular momentum, and rotates evenly if it is stiff."""
    turn = 2.0 * math.pi / SPIN
    errors = {turn / count: spinning(1e8, turn / count)[0] for count in (200, 400, 800)}
    orders = convergence("step [s]", errors, order=2.0, within=0.2)
    yield analytic(
        "block of E = 1e8 Pa thrown at 20 rad/s, full model, generalised-alpha 1",
        "angular momentum, largest relative change in one revolution",
        orders.finest,
        0.0,
        source="it is free",
        absolute=1e-4,
        convergence=orders,
    )
    yield analytic(
        "block of E = 1e9 Pa thrown at 20 rad/s, full model, generalised-alpha 1",
        "rotation missing after one revolution [rad]",
        spinning(1e9, turn / 800)[1],
        0.0,
        source="even rotation",
        absolute=2e-3,
        note="the spin stretches the block and its inertia grows: 0.008 rad at a tenth of the stiffness",
    )


@check("time", "mirror symmetry")
def mirror() -> Iterator[Row]:
    """The floor's motion mirrored: the container's motion mirrored."""
    models: dict[str, Keys] = {"rigid stack": {}, "solid stack, 20 modes": SOLID}
    note = "sin(Omega t + pi) is -sin(Omega t) but for rounding"
    for name, values in models.items():
        one, other = (run(STACK, VIOLENT | values | {"motion.phase_rad": phase}) for phase in (0.0, math.pi))
        case = f"{name}, slide-rocking for 5 s, floor mirrored"
        yield same_rotation(case, one, -other.history["rotation_rad"], source="symmetry", note=note)


@check("time", "scaling")
def scaling() -> Iterator[Row]:
    """Lengths times four, times times two: the same rotation."""
    scaled = {
        "container.width_m": 4.4,
        "container.height_m": 16.0,
        "container.depth_m": 4.4,
        "container.weight_N": 64.0 * 98100.0,
        "motion.amplitude_m": 0.4,
        "motion.angular_frequency_rad_s": 4.0,
        "solver.duration_s": 10.0,
        "solver.element_size_m": 4.0,
        "output.history_s": 0.01,
    }
    one, other = run(STACK, VIOLENT), run(STACK, VIOLENT | scaled)
    case = "rigid stack, slide-rocking for 5 s, lengths x 4 and times x 2"
    yield same_rotation(case, one, other.history["rotation_rad"], source="dimensional analysis")


@check("time", "Galilean invariance")
def galilei() -> Iterator[Row]:
    """A constant velocity of 3 m/s added to the floor and the container: the same relative motion."""
    still, travelling = (
        finish(
            with_motion(
                with_steps_of(build_model(STACK.with_values(VIOLENT | {"solver.duration_s": 2.0})), 2e-5),
                *stepped_floor(drift),
            )
        )
        for drift in (0.0, 3.0)
    )
    yield same_rotation(
        "rigid stack, rocking for 2 s on a floor with 3 m/s added",
        still,
        travelling.history["rotation_rad"],
        source="Galilean invariance",
        note="fixed steps: the step control uses the work of the base, which is not invariant",
    )


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


def stepped_floor(drift: float) -> tuple[FloorMotion, tuple[float, ...]]:
    """Accelerations of +4, -4 and +4 m/s2 for 0.25, 0.5 and 0.25 s, with a constant velocity added [m/s]."""
    knots = (0.0, 0.25, 0.75, 1.0)
    rows, displacement, velocity = [[0.0, drift, 0.0, 0.0]], 0.0, drift
    for acceleration, length in zip((4.0, -4.0, 4.0, 0.0), (0.25, 0.5, 0.25, 0.0), strict=True):
        rows.append([displacement, velocity, acceleration, 0.0])
        displacement += length * (velocity + 0.5 * length * acceleration)
        velocity += length * acceleration
    motion = as_floor_motion(PIECEWISE, breaks=np.array(knots), coefficients=np.array(rows))
    return motion, knots[1:]


def same_rotation(case: str, done: Finished, other: FloatArray, *, source: str, note: str = "") -> Row:
    """The row of a rotation that must equal that of a run at every sample."""
    rotation, angle = done.history["rotation_rad"], done.block.slenderness_angle
    count = min(rotation.size, other.size)
    compared = f"rotation, largest difference over al (it reaches {np.abs(rotation).max() / angle:.2f})"
    found = np.abs(rotation[:count] - other[:count]).max() / angle
    return analytic(case, compared, found, 0.0, source=source, absolute=1e-6, note=note)
