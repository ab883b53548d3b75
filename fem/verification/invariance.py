"""What no motion may depend on: spin without strain, mirror images, scales, a floor that travels besides.

The stack is that of `fem.verification.runs`, under a floor that makes it rock, slide and strike.
"""

import math

import numpy as np

from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion
from contact.stepping.scheme import generalised_alpha
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.solid.assembly import assemble
from fem.solid.nodal_body import FullBody
from fem.verification.bodies import Flight, body_of, free_run
from fem.verification.contact_laws import graded_block
from fem.verification.rows import Check, Convergence, Row, as_floats, order_row
from fem.verification.runs import SOLID, STACK, Finished, finish, run, with_motion, with_steps_of

SPIN = 20.0  #: of a block thrown into the air [rad/s]
#: rocks, slides and strikes for 5 s
VIOLENT = {
    "motion.kind": "harmonic",
    "motion.amplitude_m": 0.1,
    "motion.angular_frequency_rad_s": 8.0,
    "contact.mu_static": 0.3,
    "solver.duration_s": 5.0,
}


def spin() -> list[Row]:
    """A block thrown spinning: it keeps its angular momentum, and turns evenly the stiffer it is."""
    turn = 2.0 * math.pi / SPIN
    steps = [turn / count for count in (200, 400, 800)]
    errors = [_spinning(1e8, step)[0] for step in steps]
    _, left = _spinning(1e9, steps[-1])
    return [
        order_row(
            case="block of E = 1e8 Pa thrown at 20 rad/s, full model, generalised-alpha 1",
            compared="angular momentum, largest relative change in one turn",
            convergence=Convergence(
                against="step [s]",
                sizes=as_floats(steps),
                errors=as_floats(errors),
                expected=2.0,
                tolerance=0.2,
            ),
            kind="analytic",
            source="it is free",
            tolerance=1e-4,
        ),
        Row(
            case="block of E = 1e9 Pa thrown at 20 rad/s, full model, generalised-alpha 1",
            compared="rotation missing after one turn [rad]",
            value=left,
            reference=0.0,
            kind="analytic",
            source="even rotation",
            tolerance=2e-3,
            note="the spin stretches the block, whose inertia grows: 0.008 rad at a tenth of the stiffness",
        ),
    ]


def mirror() -> list[Row]:
    """The floor's motion mirrored: the container's motion mirrored."""
    rows = []
    for name, values in (("rigid stack", {}), ("solid stack, 20 modes", SOLID)):
        one, other = (run(STACK, VIOLENT | values | {"motion.phase_rad": phase}) for phase in (0.0, math.pi))
        rows.append(
            _difference_row(
                f"{name}, slide-rocking for 5 s, floor mirrored",
                one.history["rotation_rad"],
                -other.history["rotation_rad"],
                one,
                1e-6,
                "symmetry",
                note="sin(Omega t + pi) is -sin(Omega t) but for rounding",
            )
        )
    return rows


def scaling() -> list[Row]:
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
    return [
        _difference_row(
            "rigid stack, slide-rocking for 5 s, lengths x 4 and times x 2",
            one.history["rotation_rad"],
            other.history["rotation_rad"],
            one,
            1e-6,
            "dimensional analysis",
        )
    ]


def galilei() -> list[Row]:
    """A floor that travels at 3 m/s besides, with the container on it: the same motion."""
    step = 2e-5
    done = []
    for drift in (0.0, 3.0):
        model = build_model(STACK.with_values(VIOLENT | {"solver.duration_s": 2.0}))
        moving, breaks = _stepped_floor(drift)
        done.append(finish(with_motion(with_steps_of(model, step), moving, breaks)))
    return [
        _difference_row(
            "rigid stack, rocking for 2 s on a floor that travels at 3 m/s",
            done[0].history["rotation_rad"],
            done[1].history["rotation_rad"],
            done[0],
            1e-6,
            "Galilean invariance",
            note="fixed steps: the step control looks at base work, which is not invariant",
        )
    ]


def _spinning(youngs_modulus: float, step: float) -> tuple[float, float]:
    """Largest relative change of the angular momentum in one turn, and |rotation| at its end [rad]."""
    elements = assemble(graded_block(), youngs_modulus=youngs_modulus, poisson_ratio=0.3, order=1)
    body = body_of(elements)
    arm = elements.nodes - body.centroid
    flight = free_run(
        body,
        step=step,
        scheme=generalised_alpha(1.0),
        velocity=SPIN * np.column_stack([arm[:, 1], -arm[:, 0]]),
        height=5.0,
    )
    first, change = _angular_momentum(flight), 0.0
    for share in np.arange(1, 41) / 40:
        flight.advance(float(share) * 2.0 * math.pi / SPIN)
        change = max(change, abs(_angular_momentum(flight) / first - 1.0))
    return change, abs(float(flight.state.pose[0]))


def _angular_momentum(flight: Flight) -> float:
    body: FullBody = flight.body
    position, velocity = (array.reshape(-1, 2) for array in (flight.state.position, flight.state.velocity))
    momentum = body.elements.mass @ velocity
    centre = flight.state.pose[2:4]
    arm = position - centre
    return float(np.sum(arm[:, 1] * momentum[:, 0] - arm[:, 0] * momentum[:, 1]))


def _stepped_floor(drift: float) -> tuple[FloorMotion, tuple[float, ...]]:
    """Accelerations of +4, -4 and +4 m/s2 for 0.25, 0.5 and 0.25 s, on a floor that travels besides [m/s]."""
    knots = (0.0, 0.25, 0.75, 1.0)
    rows, displacement, velocity = [[0.0, drift, 0.0, 0.0]], 0.0, drift
    for acceleration, length in zip((4.0, -4.0, 4.0, 0.0), (0.25, 0.5, 0.25, 0.0), strict=True):
        rows.append([displacement, velocity, acceleration, 0.0])
        displacement += length * (velocity + 0.5 * length * acceleration)
        velocity += length * acceleration
    motion = as_floor_motion(PIECEWISE, breaks=np.array(knots), coefficients=np.array(rows))
    return motion, knots[1:]


def _difference_row(
    case: str,
    one: FloatArray,
    other: FloatArray,
    done: Finished,
    tolerance: float,
    source: str,
    note: str = "",
) -> Row:
    angle = done.block.slenderness_angle
    count = min(one.size, other.size)
    return Row(
        case=case,
        compared=f"rotation, largest difference over al (it reaches {np.abs(one).max() / angle:.2f})",
        value=float(np.abs(one[:count] - other[:count]).max()) / angle,
        reference=0.0,
        kind="analytic",
        source=source,
        tolerance=tolerance,
        note=note,
    )


CHECKS = (
    Check(name="spin", rows=spin),
    Check(name="mirror symmetry", rows=mirror),
    Check(name="scaling", rows=scaling),
    Check(name="Galilean invariance", rows=galilei),
)
