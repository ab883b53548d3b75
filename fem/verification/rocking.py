"""Rocking without sliding: the rigid and the stiff elastic container against the exact rocking block.

The block of `contact.reference.rocking` is integrated by scipy between events and shares no code with the stepping.
The stack
is 1.1 x 4.0 m, homogeneous, on two corners, released from half its slenderness angle where nothing else is said.
Housner, BSSA 53 (1963).
"""

import math

import numpy as np

from contact.reference.closed_forms_rocking import (
    SymmetricOrbit,
    holding_acceleration,
    impact_friction_need,
    peak_after_impacts,
    quarter_period,
    symmetric_orbit_slender,
)
from contact.reference.floor_acceleration import FloorAcceleration, sine_floor
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from fem.results.history import History
from fem.verification.rows import Check, Row
from fem.verification.runs import GRAVITY, SOLID, STACK, Finished, run

SLENDERNESS = math.atan2(1.1, 4.0)
RELEASED = {"initial.rotation_rad": 0.5 * SLENDERNESS}
#: stiff enough against its floor to count as rigid: f1/f_c = 16
STIFF_SOLID = SOLID | {"container.youngs_modulus_Pa": 2.1e12}
HOUSNER = "Housner 1963"


def first_impacts() -> list[Row]:
    """Time from release to the first impact."""
    rows = []
    for share in (0.1, 0.25, 0.75, 0.9):
        rotation = share * SLENDERNESS
        done = run(STACK, {"initial.rotation_rad": rotation, "solver.duration_s": 2.0})
        rows.append(_impact_row(f"rigid stack from {share} al", done, quarter_period(done.block, rotation)))
    for name, values in (("rigid stack", {}), ("stiff solid stack, 20 modes", STIFF_SOLID)):
        done = run(STACK, RELEASED | {"solver.duration_s": 2.0} | values)
        rows.append(_impact_row(f"{name} from 0.5 al", done, 0.700737))
    return rows


def free_decay() -> list[Row]:
    """Turning points of free rocking, cos(al - theta_n) - cos al = e^(2n) [cos(al - theta_0) - cos al]."""
    rows = []
    for name, values in (("rigid stack", {}), ("stiff solid stack, 20 modes", STIFF_SOLID)):
        done = run(STACK, RELEASED | {"solver.duration_s": 8.0, "output.history_s": 0.001} | values)
        found = turning_points(done.history)
        block = done.block
        rows.append(
            Row(
                case=f"{name} from 0.5 al",
                compared="first peak after the first impact [rad]",
                value=found[0],
                reference=0.098783,
                kind="analytic",
                source="energy relation with Housner's e",
                tolerance=0.01,
                relative=True,
            )
        )
        exact = [
            peak_after_impacts(block, 0.5 * SLENDERNESS, n, block.housner_restitution) for n in range(1, 7)
        ]
        worst = int(np.argmax([abs(a / b - 1.0) for a, b in zip(found, exact, strict=False)]))
        rows.append(
            Row(
                case=f"{name} from 0.5 al",
                compared=f"peaks 1 to 6, the worst ({worst + 1}) [rad]",
                value=found[worst],
                reference=exact[worst],
                kind="analytic",
                source="energy relation with Housner's e",
                tolerance=0.03,
                relative=True,
                note="the error of e adds up from impact to impact: 0.0003 of 0.8945 are 0.1 % of each peak",
            )
        )
    return rows


def equation_of_motion() -> list[Row]:
    """Rotation under a moving floor, before any impact."""
    rows = []
    for name, factor, omega, until in (("grows", 1.5, 1.88337, 1.2), ("comes back", 1.2, 6.928, 0.35)):
        amplitude = factor * GRAVITY * 1.1 / 4.0 / omega**2
        done = run(
            STACK,
            {
                "motion.kind": "harmonic",
                "motion.amplitude_m": amplitude,
                "motion.angular_frequency_rad_s": omega,
                "contact.mu_static": 2.0,
                "solver.duration_s": until,
            },
        )
        floor = sine_floor(amplitude=amplitude, angular_frequency=omega)
        rows.append(
            Row(
                case=f"rigid stack under {factor} g tan al at {omega} rad/s, which {name}",
                compared="rotation up to the first impact, largest difference over al",
                value=difference_of_rotation(done, floor),
                reference=0.0,
                kind="computed",
                source="event-driven block: theta'' = -p^2 [sin(s al - theta) + (a_g/g) cos(s al - theta)]",
                tolerance=1e-3,
            )
        )
    return rows


def tilt_statics() -> list[Row]:
    """Floor acceleration that holds the tilted block: between one that lifts it on and one that lets it back."""
    rows = []
    for share in (0.2, 0.7):
        rotation = share * SLENDERNESS
        hold = holding_acceleration(RigidBlock.homogeneous(width=1.1, height=4.0), rotation)
        accelerations = (0.98 * hold, 1.02 * hold)
        speeds = []
        for acceleration in accelerations:
            done = run(
                STACK,
                {
                    "initial.rotation_rad": rotation,
                    "motion.kind": "pulse",
                    "motion.shape": "rectangular",
                    "motion.peak_acceleration_m_s2": -acceleration,
                    "motion.pulse_s": 1.0,
                    "contact.mu_static": 2.0,
                    "solver.duration_s": 0.1,
                },
            )
            speeds.append(float(np.ptp(done.history["rotation_rad"][[0, -1]])) * _sign(done.history))
        slope = (speeds[1] - speeds[0]) / (accelerations[1] - accelerations[0])
        rows.append(
            Row(
                case=f"rigid stack held at {share} al",
                compared="floor acceleration under which it neither rises nor falls [m/s2]",
                value=accelerations[0] - speeds[0] / slope,
                reference=hold,
                kind="analytic",
                source="g tan(al - theta)",
                tolerance=2e-3,
                relative=True,
            )
        )
    return rows


def friction_at_impact() -> list[Row]:
    """Impulses of the first impact: their ratio is the friction that keeps it from sliding."""
    need = impact_friction_need(RigidBlock.homogeneous(width=1.1, height=4.0))
    source = "Housner's impact: 3 tan al/(4 + tan^2 al) = 0.2024"
    done = run(STACK, RELEASED | {"solver.duration_s": 0.9, "output.history_s": 0.001})
    impact = float(done.track.first_impact)
    along, up = (_velocity_jump(done.history, name, impact) for name in ("centre_x_m", "centre_z_m"))
    rows = [
        Row(
            case="rigid stack from 0.5 al, ample friction",
            compared="horizontal over vertical impulse of the first impact",
            value=abs(along) / up,
            reference=0.2024,
            kind="analytic",
            source=source,
            tolerance=0.01,
            relative=True,
        )
    ]
    for factor, slides in ((1.5, False), (0.9, True)):
        done = run(
            STACK,
            RELEASED
            | {"contact.mu_static": factor * need, "solver.duration_s": 0.75, "output.history_s": 0.001},
        )
        impact = float(done.track.first_impact)
        ends = np.interp([impact - 0.002, impact + 0.02], done.history["time_s"], done.history["slip_m"])
        slip = abs(float(ends[1] - ends[0]))
        rows.append(
            Row(
                case=f"rigid stack from 0.5 al, friction {factor} of what an impact needs",
                compared="slides at the impact (1) or does not (0)",
                value=float(slip > 1e-5),
                reference=float(slides),
                kind="analytic",
                source=source,
                tolerance=0.0,
                note=f"slip {1e6 * slip:.3g} um; between 1 and 1.3 times the need a compliant contact slips a little, "
                "at every penalty: its tangential force is not in step with the normal one",
            )
        )
    return rows


def steady_orbit() -> list[Row]:
    """The steady symmetric orbit: the slender closed form, and the run against the exact block."""
    orbit = symmetric_orbit_slender(acceleration_ratio=3.0, frequency_ratio=3.0, restitution=0.9)
    source = "slender closed form, e = 0.9, w = 3, a = 3"
    rows = [*_needle_on_orbit(orbit, source)]
    # Housner's e is 0.9 at sin^2 al = 1/15.
    width = math.tan(math.asin(math.sqrt(1.0 / 15.0))) * 4.0
    block = RigidBlock.homogeneous(width=width, height=4.0)
    angle, rate = block.slenderness_angle, block.frequency_parameter
    omega = 3.0 * rate
    amplitude, cycle = 3.0 * GRAVITY * angle / omega**2, 2.0 * math.pi / omega
    speed = orbit.post_impact_speed * angle * rate
    floor = sine_floor(amplitude=amplitude, angular_frequency=omega, phase=orbit.impact_phase)
    reference = simulate_rocking(block, floor, duration=40.0 * cycle, angular_velocity=speed)
    done = run(
        STACK,
        {
            "container.width_m": width,
            "container.weight_N": 98100.0 * width / 1.1,
            "contact.mu_static": 3.0,
            "motion.kind": "harmonic",
            "motion.amplitude_m": amplitude,
            "motion.angular_frequency_rad_s": omega,
            "motion.phase_rad": orbit.impact_phase,
            "initial.angular_velocity_rad_s": speed,
            "solver.duration_s": 40.0 * cycle,
            "output.history_s": 0.001,
        },
    )
    late = done.history["time_s"] > 38.0 * cycle
    exact = max(abs(peak.rotation) for peak in reference.peaks if peak.time > 38.0 * cycle)
    rows.append(
        Row(
            case="rigid block of 4 m with e = 0.9 under a = 3, w = 3, after 38 cycles",
            compared="steady peak over al",
            value=float(np.abs(done.history["rotation_rad"][late]).max()) / angle,
            reference=exact / angle,
            kind="computed",
            source="event-driven block",
            tolerance=5e-3,
            relative=True,
            note="the slender form, 0.421204, is the limit al -> 0; here al = 0.261",
        )
    )
    return rows


def turning_points(history: History) -> list[float]:
    """|rotation| at the turning points after the start, by parabolas through the samples [rad]."""
    rotation = np.abs(history["rotation_rad"])
    inner = rotation[1:-1]
    at = 1 + np.flatnonzero((inner > rotation[:-2]) & (inner >= rotation[2:]) & (inner > 1e-4))
    left, middle, right = rotation[at - 1], rotation[at], rotation[at + 1]
    return (middle + 0.125 * (right - left) ** 2 / (2.0 * middle - left - right)).tolist()


def difference_of_rotation(done: Finished, floor: FloorAcceleration, until: float = math.inf) -> float:
    """Largest difference to the event-driven block up to its first impact or `until` [s], over al."""
    times = done.history["time_s"]
    initial = done.model.case.initial
    exact = simulate_rocking(
        done.block,
        floor,
        duration=float(times[-1]),
        rotation=initial.rotation_rad,
        angular_velocity=initial.angular_velocity_rad_s,
    )
    end = min(until, exact.impacts[0].time if exact.impacts else math.inf)
    before = times < end
    difference = done.history["rotation_rad"][before] - exact.at(times[before])[0]
    return float(np.abs(difference).max()) / done.block.slenderness_angle


def _impact_row(case: str, done: Finished, exact: float) -> Row:
    return Row(
        case=case,
        compared="first impact [s]",
        value=float(done.track.first_impact),
        reference=exact,
        kind="analytic",
        source="quarter period, exact (elliptic integral)",
        tolerance=3e-3,
        relative=True,
    )


def _sign(history: History) -> float:
    rotation = history["rotation_rad"]
    return 1.0 if rotation[-1] > rotation[0] else -1.0


def _velocity_jump(history: History, column: str, instant: float) -> float:
    """Jump of the velocity at an instant, between straight lines through the velocities around it [m/s]."""
    times, place = history["time_s"], history[column]
    middle, velocity = 0.5 * (times[1:] + times[:-1]), np.diff(place) / np.diff(times)
    sides = []
    for low, high in ((-0.05, -0.003), (0.03, 0.1)):
        chosen = (middle > instant + low) & (middle < instant + high)
        sides.append(np.polyval(np.polyfit(middle[chosen] - instant, velocity[chosen], 2), 0.0))
    return float(sides[1] - sides[0])


def _needle_on_orbit(orbit: SymmetricOrbit, source: str) -> list[Row]:
    """The event-driven needle, started on the slender orbit: its speed after ten cycles, and its peak."""
    needle = RigidBlock.homogeneous(width=2e-3, height=1.0)
    angle, rate = needle.slenderness_angle, needle.frequency_parameter
    omega = 3.0 * rate
    floor = sine_floor(
        amplitude=3.0 * GRAVITY * angle / omega**2, angular_frequency=omega, phase=orbit.impact_phase
    )
    motion = simulate_rocking(
        needle,
        floor,
        duration=20.0 * math.pi / omega,
        angular_velocity=orbit.post_impact_speed * angle * rate,
        restitution=0.9,
    )
    found = {
        "speed after an impact over al p": (
            abs(motion.impacts[-1].velocity_after) / (angle * rate),
            1.302075,
        ),
        "peak over al": (abs(motion.peaks[-1].rotation) / angle, 0.421204),
    }
    return [
        Row(
            case="event-driven needle on the symmetric orbit, ten cycles",
            compared=compared,
            value=value,
            reference=exact,
            kind="analytic",
            source=source,
            tolerance=1e-4,
            relative=True,
        )
        for compared, (value, exact) in found.items()
    ]


CHECKS = (
    Check(name="first impact after release", rows=first_impacts),
    Check(name="decay of free rocking", rows=free_decay),
    Check(name="equation of motion on a moving floor", rows=equation_of_motion),
    Check(name="tilt statics", rows=tilt_statics),
    Check(name="friction at an impact", rows=friction_at_impact),
    Check(name="steady orbit", rows=steady_orbit),
)
