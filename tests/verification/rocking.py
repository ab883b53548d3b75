"""Rocking without sliding: the rigid and the stiff elastic container against the exact rocking block.

The block of `contact.reference.rocking` is integrated by scipy between events and shares no code with the stepping.
The stack is 1.1 x 4.0 m, homogeneous, on two corners, released from half its slenderness angle unless stated
otherwise. Housner, BSSA 53 (1963).
"""

import math

import numpy as np
import runs
from closed_forms import (
    holding_acceleration,
    impact_friction_need,
    peak_after_impacts,
    quarter_period,
    symmetric_orbit_slender,
)
from evidence.findings import analytic, computed
from floors import sine_floor
from verification.checks import MESH, Findings, check

from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from fem.results.history import History

MODELS: dict[str, runs.Keys] = {"rigid stack": {}, "stiff solid stack, 20 modes": runs.STIFF_SOLID}


@check("rocking", "first impact after release", inputs=MESH)
def first_impacts() -> Findings:
    """Time from release to the first impact."""
    source = "quarter period, exact (elliptic integral)"
    for share in (0.1, 0.25, 0.75, 0.9):
        rotation = share * runs.SLENDERNESS
        done = runs.run(runs.STACK, {"initial.rotation_rad": rotation, "solver.duration_s": 2.0})
        exact, impact = quarter_period(done.block, rotation), done.track.first_impact
        case = f"rigid stack released at {share} of its slenderness angle"
        yield analytic(case, "first impact [s]", impact, exact, source=source, relative=3e-3)
    for name, values in MODELS.items():
        impact = runs.run(runs.STACK, runs.TILTED | {"solver.duration_s": 2.0} | values).track.first_impact
        case = f"{name} released at half its slenderness angle"
        yield analytic(case, "first impact [s]", impact, 0.700737, source=source, relative=3e-3)


@check("rocking", "decay of free rocking", inputs=MESH)
def free_decay() -> Findings:
    """Turning points of free rocking, cos(al - theta_n) - cos al = e^(2n) [cos(al - theta_0) - cos al]."""
    source = "energy relation with Housner's e"
    note = "the error of e adds up from impact to impact: 0.0003 of 0.8945 is 0.1 % of each peak"
    for name, values in MODELS.items():
        sampled = {"solver.duration_s": 8.0, "output.history_s": 0.001}
        done = runs.run(runs.STACK, runs.TILTED | sampled | values)
        peaks, block = turning_points(done.history), done.block
        case = f"{name} released at half its slenderness angle"
        compared = "first peak after the first impact [rad]"
        yield analytic(case, compared, peaks[0], 0.098783, source=source, relative=0.01)
        start, restitution = 0.5 * runs.SLENDERNESS, block.housner_restitution
        exact = [peak_after_impacts(block, start, n, restitution) for n in range(1, 7)]
        worst = int(np.argmax([abs(a / b - 1.0) for a, b in zip(peaks, exact, strict=False)]))
        compared = f"the worst of peaks 1 to 6 ({worst + 1}) [rad]"
        yield analytic(case, compared, peaks[worst], exact[worst], source=source, relative=0.03, note=note)


@check("rocking", "equation of motion on a moving floor", inputs=MESH)
def equation_of_motion() -> Findings:
    """Rotation under a moving floor, before any impact."""
    for name, factor, omega, until in (("grows", 1.5, 1.88337, 1.2), ("returns", 1.2, 6.928, 0.35)):
        amplitude = factor * runs.GRAVITY * 1.1 / 4.0 / omega**2
        rough = {"contact.mu_static": 2.0, "solver.duration_s": until}
        done = runs.run(runs.STACK, runs.harmonic(amplitude, omega) | rough)
        floor = sine_floor(amplitude=amplitude, angular_frequency=omega)
        yield computed(
            f"rigid stack under {factor} g tan al at {omega} rad/s, whose rotation {name}",
            "rotation up to the first impact, largest difference over the slenderness angle",
            difference_of_rotation(done, floor),
            source="event-driven block: theta'' = -p^2 [sin(s al - theta) + (a_g/g) cos(s al - theta)]",
            absolute=1e-3,
        )


@check("rocking", "tilt statics")
def tilt_statics() -> Findings:
    """Floor acceleration that holds the tilted block: between one that lifts it further and one that lets it fall."""
    for share in (0.2, 0.7):
        rotation = share * runs.SLENDERNESS
        hold = holding_acceleration(runs.BLOCK, rotation)
        tilted = {"initial.rotation_rad": rotation, "contact.mu_static": 2.0, "solver.duration_s": 0.1}
        accelerations, speeds = (0.98 * hold, 1.02 * hold), []
        for acceleration in accelerations:
            turned = runs.run(runs.STACK, tilted | runs.pulse(-acceleration, 1.0)).history["rotation_rad"]
            speeds.append(float(turned[-1] - turned[0]))
        slope = (speeds[1] - speeds[0]) / (accelerations[1] - accelerations[0])
        case = f"rigid stack held at {share} of its slenderness angle"
        balance = accelerations[0] - speeds[0] / slope
        compared = "floor acceleration under which it neither rises nor falls [m/s2]"
        yield analytic(case, compared, balance, hold, source="g tan(al - theta)", relative=2e-3)


@check("rocking", "friction at an impact")
def friction_at_impact() -> Findings:
    """Impulses of the first impact: their ratio is the friction that keeps it from sliding."""
    source = "Housner's impact: 3 tan al/(4 + tan^2 al) = 0.2024"
    done = runs.run(runs.STACK, runs.TILTED | {"solver.duration_s": 0.9, "output.history_s": 0.001})
    impact = float(done.track.first_impact)
    along, up = (velocity_jump(done.history, name, impact) for name in ("centre_x_m", "centre_z_m"))
    case = "rigid stack released at half its slenderness angle, ample friction"
    compared = "horizontal over vertical impulse of the first impact"
    yield analytic(case, compared, abs(along) / up, 0.2024, source=source, relative=0.01)
    for factor, slides in ((1.5, False), (0.9, True)):
        friction = {"contact.mu_static": factor * impact_friction_need(runs.BLOCK)}
        sampled = {"solver.duration_s": 0.75, "output.history_s": 0.001}
        done = runs.run(runs.STACK, runs.TILTED | friction | sampled)
        impact = float(done.track.first_impact)
        ends = np.interp([impact - 0.002, impact + 0.02], done.history["time_s"], done.history["slip_m"])
        slip = abs(float(ends[1] - ends[0]))
        case = f"rigid stack released at half its slenderness angle, friction {factor} times what an impact needs"
        compared = "slides at the impact (1) or does not (0)"
        note = (
            f"slip {1e6 * slip:.3g} um; between 1 and 1.3 times the need a compliant contact slips a little, at every "
            "penalty: its tangential force is not in phase with the normal one"
        )
        yield analytic(case, compared, slip > 1e-5, slides, source=source, absolute=0.0, note=note)


@check("rocking", "steady orbit")
def steady_orbit() -> Findings:
    """The steady symmetric orbit: the slender closed form, and the run against the exact block."""
    orbit = symmetric_orbit_slender(acceleration_ratio=3.0, frequency_ratio=3.0, restitution=0.9)

    def floor_under(block: RigidBlock) -> tuple[float, float, float, FloorAcceleration]:
        """Amplitude [m], frequency [rad/s], post-impact angular velocity [rad/s], the floor."""
        angle, rate = block.slenderness_angle, block.frequency_parameter
        omega = 3.0 * rate
        amplitude = 3.0 * runs.GRAVITY * angle / omega**2
        floor = sine_floor(amplitude=amplitude, angular_frequency=omega, phase=orbit.impact_phase)
        return amplitude, omega, orbit.post_impact_speed * angle * rate, floor

    needle = RigidBlock.homogeneous(width=2e-3, height=1.0)
    _, omega, speed, floor = floor_under(needle)
    motion = simulate_rocking(
        needle, floor, duration=20.0 * math.pi / omega, angular_velocity=speed, restitution=0.9
    )
    angle, rate = needle.slenderness_angle, needle.frequency_parameter
    after, peak = abs(motion.impacts[-1].velocity_after) / (angle * rate), motion.peaks[-1].rotation
    case = "event-driven needle on the symmetric orbit, ten cycles"
    source = "slender closed form, e = 0.9, w = 3, a = 3"
    yield analytic(case, "speed after an impact over al p", after, 1.302075, source=source, relative=1e-4)
    compared = "peak over the slenderness angle"
    yield analytic(case, compared, abs(peak) / angle, 0.421204, source=source, relative=1e-4)

    # Housner's e is 0.9 at sin^2 al = 1/15.
    width = math.tan(math.asin(math.sqrt(1.0 / 15.0))) * 4.0
    block = RigidBlock.homogeneous(width=width, height=4.0)
    angle = block.slenderness_angle
    amplitude, omega, speed, floor = floor_under(block)
    cycle = 2.0 * math.pi / omega
    reference = simulate_rocking(block, floor, duration=40.0 * cycle, angular_velocity=speed)
    keys = {"container.width_m": width, "container.weight_N": 98100.0 * width / 1.1, "contact.mu_static": 3.0}
    keys |= {"motion.phase_rad": orbit.impact_phase, "initial.angular_velocity_rad_s": speed}
    keys |= {"solver.duration_s": 40.0 * cycle, "output.history_s": 0.001}
    history = runs.run(runs.STACK, runs.harmonic(amplitude, omega) | keys).history
    late = history["time_s"] > 38.0 * cycle
    yield computed(
        "rigid block of 4 m with e = 0.9 under a = 3, w = 3, after 38 cycles",
        "steady peak over the slenderness angle",
        np.abs(history["rotation_rad"][late]).max() / angle,
        max(abs(peak.rotation) for peak in reference.peaks if peak.time > 38.0 * cycle) / angle,
        source="event-driven block",
        relative=5e-3,
        note="the slender form, 0.421204, is the limit al -> 0; here al = 0.261",
    )


def turning_points(history: History) -> list[float]:
    """|rotation| at the turning points after the start, by parabolas through the samples [rad]."""
    rotation = np.abs(history["rotation_rad"])
    inner = rotation[1:-1]
    at = 1 + np.flatnonzero((inner > rotation[:-2]) & (inner >= rotation[2:]) & (inner > 1e-4))
    left, middle, right = rotation[at - 1], rotation[at], rotation[at + 1]
    return (middle + 0.125 * (right - left) ** 2 / (2.0 * middle - left - right)).tolist()


def difference_of_rotation(done: runs.Finished, floor: FloorAcceleration) -> float:
    """Largest difference from the event-driven block up to its first impact, over the slenderness angle."""
    times = done.history["time_s"]
    initial = done.model.case.initial
    exact = simulate_rocking(
        done.block,
        floor,
        duration=float(times[-1]),
        rotation=initial.rotation_rad,
        angular_velocity=initial.angular_velocity_rad_s,
    )
    before = times < (exact.impacts[0].time if exact.impacts else math.inf)
    difference = done.history["rotation_rad"][before] - exact.at(times[before])[0]
    return float(np.abs(difference).max()) / done.block.slenderness_angle


def velocity_jump(history: History, column: str, instant: float) -> float:
    """Jump of the velocity at an instant, between straight lines through the velocities around it [m/s]."""
    times, position = history["time_s"], history[column]
    middle, velocity = 0.5 * (times[1:] + times[:-1]), np.diff(position) / np.diff(times)
    sides = []
    for low, high in ((-0.05, -0.003), (0.03, 0.1)):
        chosen = (middle > instant + low) & (middle < instant + high)
        sides.append(np.polyval(np.polyfit(middle[chosen] - instant, velocity[chosen], 2), 0.0))
    return float(sides[1] - sides[0])
