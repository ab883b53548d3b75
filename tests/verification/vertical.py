"""A floor that moves up and down: in its frame gravity is g + a_v.

A constant acceleration against another gravity, friction under both motions against the event-driven slider, rocking
under both against the event-driven block. Stack and box are those of `runs`.
"""

import math

import numpy as np
import runs
from evidence.findings import analytic, computed
from floors import sine_floor
from verification.checks import MESH, PROGRAM, Findings, check
from verification.rocking import difference_of_rotation
from verification.sliding import slip_of_a_driven_box

from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.planar_block import PlanarBlock, simulate_planar_block

OMEGA = 6.928
#: the mass and the springs of the contact do not follow gravity here
FIXED: runs.Keys = {"container.mass_kg": 1e4, "contact.normal_penalty_Pa_m": 4e9}


def vertical(keys: runs.Keys) -> runs.Keys:
    """Keys of a motion along x as those of the vertical one."""
    return {key.replace("motion.", "vertical."): value for key, value in keys.items()}


@check("vertical", "a constant vertical acceleration", inputs=PROGRAM)
def another_gravity() -> Findings:
    """A floor that accelerates upward by a is a floor at rest under gravity g + a, up to the third impact."""
    driven = FIXED | runs.harmonic(4.5 / OMEGA**2, OMEGA)
    driven |= {"solver.duration_s": 4.0, "output.history_s": 0.002}
    for name, model in runs.STACKS.items():
        for acceleration in (-3.0, 3.0):
            lifted = runs.run(runs.STACK, driven | model | vertical(runs.pulse(acceleration, 10.0)))
            heavier = runs.run(runs.STACK, driven | model | {"gravity_m_s2": runs.GRAVITY + acceleration})
            times = heavier.history["time_s"]
            until = times < third_impact(heavier)
            difference = np.abs(lifted.history["rotation_rad"] - heavier.history["rotation_rad"])[until]
            yield analytic(
                f"{name}, 4.5 m/s2 at {OMEGA} rad/s, {acceleration:+g} m/s2 upward",
                "rotation up to the third impact, largest difference over the slenderness angle",
                difference.max() / heavier.block.slenderness_angle,
                source="the same run under gravity g + a",
                absolute=2e-3,
            )


@check("vertical", "a slider under both motions")
def slider_under_both() -> Findings:
    """Slip of a box under harmonic motions along x and upward, of one and of another frequency."""
    for ratio, phase in ((1.0, 0.5 * math.pi), (2.5, 0.0)):
        upward = 5.0 / (10.0 * ratio) ** 2, 10.0 * ratio
        floor = sine_floor(amplitude=0.05, angular_frequency=10.0).with_vertical(
            sine_floor(amplitude=upward[0], angular_frequency=upward[1], phase=phase)
        )
        yield slip_of_a_driven_box(
            f"5 m/s2 upward at {10.0 * ratio:g} rad/s",
            vertical(runs.harmonic(*upward)) | {"vertical.phase_rad": phase},
            floor,
            runs.GRAVITY,
        )


@check("vertical", "a block under both motions", inputs=MESH)
def block_under_both() -> Findings:
    """Rotation of the stack under harmonic motions along x and upward: up to the first impact, and its first peaks.

    The second pair overturns it in its third swing.
    """
    for ratio, phase, peaks in ((1.0, 0.5 * math.pi, 3), (1.0, 0.0, 2), (2.0, 0.0, 3)):
        upward = 4.5 / (OMEGA * ratio) ** 2, OMEGA * ratio
        keys = runs.harmonic(5.0 / OMEGA**2, OMEGA) | vertical(runs.harmonic(*upward))
        stiff = {"contact.normal_penalty_Pa_m": 5e10, "output.history_s": 0.002, "solver.duration_s": 4.0}
        done = runs.run(runs.STACK, keys | {"vertical.phase_rad": phase} | stiff)
        floor = sine_floor(amplitude=5.0 / OMEGA**2, angular_frequency=OMEGA).with_vertical(
            sine_floor(amplitude=upward[0], angular_frequency=upward[1], phase=phase)
        )
        case = (
            f"rigid stack, mu 1, 5 m/s2 and 4.5 m/s2 upward at {ratio:g} times the frequency, {phase:.2f} rad"
        )
        difference = difference_of_rotation(done, floor)
        compared = "rotation up to the first impact, largest difference over the slenderness angle"
        yield computed(case, compared, difference, source="event-driven block", absolute=1e-3)
        difference = difference_of_peaks(done, floor, peaks)
        compared = f"first {peaks} peaks, largest difference over the slenderness angle"
        yield computed(case, compared, difference, source="event-driven planar block", absolute=1e-2)


def third_impact(done: runs.Finished) -> float:
    """When the rotation passes through zero for the third time [s]; infinite where it does not."""
    rotation, times = done.history["rotation_rad"], done.history["time_s"]
    tilted = np.abs(rotation) > 1e-3 * done.block.slenderness_angle
    signs, instants = np.sign(rotation[tilted]), times[tilted]
    turns = np.flatnonzero(signs[1:] != signs[:-1])
    return float(instants[turns[2] + 1]) if turns.size > 2 else math.inf


def difference_of_peaks(done: runs.Finished, floor: FloorAcceleration, count: int) -> float:
    """Largest difference of the largest |rotation| of the first swings from the event-driven block's, over the
    slenderness angle."""
    times, friction = done.history["time_s"], done.model.case.contact
    block = PlanarBlock(body=done.block, mu_static=friction.mu_static, mu_kinetic=friction.mu_kinetic)
    exact = simulate_planar_block(block, floor, duration=float(times[-1])).at(times).rotation
    angle = done.block.slenderness_angle
    peaks, reference = (swings(rotation, 0.01 * angle) for rotation in (done.history["rotation_rad"], exact))
    pairs = list(zip(peaks, reference, strict=False))[:count]
    return max(abs(a - b) for a, b in pairs) / angle if len(pairs) == count else math.nan


def swings(rotation: np.ndarray, least: float) -> list[float]:
    """Largest rotation of each stretch to one side that goes beyond `least`, with its sign [rad]."""
    bounds = np.flatnonzero(np.diff(np.sign(rotation)) != 0.0) + 1
    largest = [stretch[np.argmax(np.abs(stretch))] for stretch in np.split(rotation, bounds)]
    return [float(peak) for peak in largest if abs(peak) > least]
