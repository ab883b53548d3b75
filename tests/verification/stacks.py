"""Loose stacks: against a slider, a bolted stack and two rigid blocks that are followed from event to event.

The two blocks (`two_blocks`) do not slide, and their impacts are plastic, everywhere at once: the limit of stiff, well
damped contact. So their rows refine the penalty.
"""

import math
from typing import NamedTuple

import numpy as np
import runs
from evidence.findings import Convergence, analytic, computed
from floors import half_sine_pulse, sine_floor
from rigid_slider import RigidSlider, simulate_sliding
from two_blocks import Pattern, StackedBlock, TwoBlockMotion, TwoBlockStack, energy, simulate_two_blocks
from verification.checks import PROGRAM, Findings, check

from fem.results.history import History

OMEGA = 6.928  #: of the motions of the paper [rad/s]
TWO_TALL: runs.Keys = {"container.boxes": 2, "container.height_m": 2.0, "container.weight_N": 49050.0}
TWO_LOW: runs.Keys = {"container.boxes": 2, "container.height_m": 1.0, "container.weight_N": 24525.0}
LOOSE: runs.Keys = {"container.joints": "loose"}
#: nothing slides
ROUGH: runs.Keys = {"contact.mu_static": 5.0, "contact.mu_kinetic": 5.0}
TALL, SLENDER = {"height_m": 2.0, "mass_kg": 5000.0}, {"width_m": 0.7, "height_m": 2.0, "mass_kg": 3000.0}
#: a narrow heavy block with a low centre, beside the axis of a wide one
BESIDE = (
    {"width_m": 1.4, "height_m": 0.9, "mass_kg": 1500.0},
    {"width_m": 0.6, "height_m": 1.5, "mass_kg": 900.0, "offset_m": 0.2},
)
BLOCKS = "event-driven blocks, plastic impacts"


class BoxPair(NamedTuple):
    """Two boxes that differ, under a half-sine pulse."""

    boxes: tuple[runs.Keys, runs.Keys]
    peak: float = runs.GRAVITY  #: [m/s2]
    length: float = 0.15  #: of the pulse [s]
    duration: float = 1.0  #: [s]

    def run(self, **values: float) -> runs.Finished:
        """The run; keys as `contact__normal_penalty_Pa_m`."""
        keys = {key.replace("__", "."): value for key, value in values.items()}
        motion = runs.pulse(self.peak, self.length, "half-sine")
        settings = {"container.box": list(self.boxes), "solver.duration_s": self.duration}
        return runs.run(runs.STACK, LOOSE | ROUGH | motion | settings | {"output.history_s": 0.001} | keys)

    @property
    def exact(self) -> TwoBlockMotion:
        """The same by events."""
        sizes = ((box.get("width_m", 1.1), box["height_m"], box["mass_kg"]) for box in self.boxes)
        lower, upper = (StackedBlock.homogeneous(width=w, height=h, mass=m) for w, h, m in sizes)
        offset = self.boxes[1].get("offset_m", 0.0)
        stack = TwoBlockStack(lower=lower, upper=upper, gravity=runs.GRAVITY, offset=offset)
        floor = half_sine_pulse(peak=self.peak, duration=self.length)
        return simulate_two_blocks(stack, floor, duration=self.duration)


@check("stacks", "slider at a joint")
def slider_at_joint() -> Findings:
    """The upper of two boxes on a lower one that the floor holds."""
    two = LOOSE | ROUGH | TWO_LOW
    edge = math.sqrt(2.0 * 0.55 / 3.0)
    settings = runs.pulse(3.0, 2.0) | {"solver.duration_s": 2.0, "output.history_s": 0.001}
    done = runs.run(runs.STACK, two | settings | {"joints.mu_static": 0.0})
    times, slip = done.history["time_s"], done.history["box_2_slip_m"]
    before = times < 0.99 * edge
    case = "box on a box that is pulled away under it at 3 m/s2, no friction between"
    yield analytic(
        case,
        "slip less that of a box that stays where it is, largest difference up to the edge [m]",
        np.abs(slip[before] + 1.5 * times[before] ** 2).max(),
        source="a t^2/2",
        absolute=1e-4,
    )
    rotation = np.abs(done.history["box_2_rotation_rad"])
    tilted = times[rotation > 0.01]
    fallen = done.status == "overturned"
    yield analytic(case, "ends as fallen (1)", fallen, True, source="statics", absolute=0.0)
    turned, height = float(rotation[-1]), float(done.history["box_2_z_m"][-1])
    yield analytic(
        case,
        "height of the lowest corner of the fallen box at the end [m]",
        height - 0.5 * math.cos(turned) - 0.55 * math.sin(turned),
        source="it has met the floor; within the fall of 1 ms",
        absolute=0.02,
    )
    compared, source = (
        "turns by 0.01 rad not before its mass centre passes the edge [s]",
        "statics, 0 to 0.15 s later",
    )
    first = float(tilted[0]) if tilted.size else math.nan
    yield analytic(case, compared, first, edge, source=source, absolute=0.15)
    floor = sine_floor(amplitude=4.0 / OMEGA**2, angular_frequency=OMEGA)
    for static, kinetic in ((0.2, 0.2), (0.3, 0.2), (0.35, 0.2)):
        friction = {"joints.mu_static": static, "joints.mu_kinetic": kinetic}
        motion = runs.harmonic(4.0 / OMEGA**2, OMEGA) | {"solver.duration_s": 3.0}
        done = runs.run(runs.STACK, two | motion | friction)
        slider = RigidSlider(mu_static=static, mu_kinetic=kinetic, gravity=runs.GRAVITY)
        exact = simulate_sliding(slider, floor, duration=3.0).at(done.history["time_s"])[0]
        yield computed(
            f"box on a box that does not slide, friction {static}/{kinetic} between, harmonic floor",
            "slip, largest difference over the largest slip",
            np.abs(done.history["box_2_slip_m"] - exact).max() / np.abs(exact).max(),
            source="event-driven slider",
            absolute=0.015,
            note="the lower box swings on its springs whenever the friction on it turns round",
        )


@check("stacks", "rough joints", inputs=PROGRAM)
def rough_joints() -> Findings:
    """Joints that neither slide nor open: the bolted stack, through its impacts."""
    motion = runs.harmonic(4.0 / OMEGA**2, OMEGA) | {"contact.mu_static": 1.0, "output.history_s": 0.005}
    stiff = runs.SOLID | {"container.youngs_modulus_Pa": 1e12}
    for name, values, duration in (("rigid", {}, 6.0), ("solid of 1e12 Pa, 20 modes", stiff, 2.0)):
        keys = TWO_TALL | motion | values | {"solver.duration_s": duration}
        bolted = runs.run(runs.STACK, keys).history["rotation_rad"]
        loose = runs.run(runs.STACK, keys | LOOSE | {"joints.mu_static": 2.0}).history["rotation_rad"]
        yield computed(
            f"two boxes, friction 2 between, 4 m/s2 at 6.928 rad/s for {duration:g} s, {name}",
            "rotation of the lowest box, largest difference over the slenderness angle",
            np.abs(loose - bolted).max() / runs.SLENDERNESS,
            source="bolted stack",
            absolute=1e-3,
        )


STARTS = {
    Pattern.AS_ONE: BoxPair((TALL, TALL), duration=0.3),
    Pattern.UPPER_ALONE: BoxPair(BESIDE, duration=0.3),
    Pattern.SAME_WAY: BoxPair((TALL, SLENDER), duration=0.3),
    Pattern.OPPOSITE_WAYS: BoxPair((TALL, TALL), peak=4.0 * runs.GRAVITY, length=0.3, duration=0.24),
}


@check("stacks", "start of the four patterns")
def four_patterns() -> Findings:
    """When each pattern starts under a pulse, by the angle of the interface that opens then."""
    for pattern, pair in STARTS.items():
        exact, history = pair.exact, pair.run(contact__normal_penalty_Pa_m=1e11).history
        case = f"{exact.patterns[-1].value}: {pair.peak / runs.GRAVITY:g} g for {pair.length} s"
        times = history["time_s"]
        states = exact.at(times)
        turned = rotations(history)
        opening = 0 if pattern is Pattern.AS_ONE else 1  # of the angles of both interfaces
        of_run, of_blocks = (
            np.abs(np.diff(rotation, axis=1, prepend=0.0))[:, opening]
            for rotation in (turned, states[:, [0, 2]])
        )
        compared = "time at which the interface has opened by 1 mrad [s]"
        opened = crossing(times, of_run), crossing(times, of_blocks)
        yield computed(case, compared, *opened, source=BLOCKS, absolute=1e-3)
        compared, apart = "rotations, largest difference [rad]", np.nanmax(np.abs(turned - states[:, [0, 2]]))
        yield computed(case, compared, apart, source=BLOCKS, absolute=1e-3)


@check("stacks", "impacts of two boxes")
def impacts() -> Findings:
    """All four patterns and the impacts between them, on stiffer and stiffer contact."""
    for name, boxes in (("slender on tall", (TALL, SLENDER)), ("tall beside the axis of a low one", BESIDE)):
        pair = BoxPair(boxes)
        exact, errors = pair.exact, {}
        for penalty in (1e9, 1e10, 1e11):
            history = pair.run(contact__normal_penalty_Pa_m=penalty).history
            states = exact.at(history["time_s"])[:, [0, 2]]
            errors[1.0 / penalty] = np.abs(rotations(history) - states).max() / np.abs(states).max()
        seen = ", ".join(pattern.value for pattern in exact.patterns)
        yield computed(
            f"{name}: {seen}; {len(exact.impacts)} impacts",
            "rotations, largest difference over the largest rotation",
            source=BLOCKS,
            absolute=0.02,
            convergence=Convergence("1/penalty [m/Pa]", errors, order=0.75, within=0.35),
        )


@check(
    "stacks",
    "momentum, energy and mirror image",
    inputs="The forces of the floor are those of the run, the mirror image is another one.",
)
def balance() -> Findings:
    """What the impacts of two boxes keep and lose."""
    pair = BoxPair((TALL, SLENDER))
    exact, case = pair.exact, "slender on tall, 1 g for 0.15 s"
    # every 10 us, since forces at an impact jump
    fine = {"output__history_s": 1e-5, "solver__step_s": 2e-4, "solver__duration_s": 0.5}
    history = pair.run(contact__normal_penalty_Pa_m=3e8, **fine).history
    times, masses = history["time_s"], (5000.0, 3000.0)
    first, last = np.searchsorted(times, (0.4, 0.49))  # the floor moves steadily, and an impact is within
    for name, force, weight, columns in (
        ("horizontal", "shear_force_N", 0.0, ("centre_x_m", "box_2_x_m")),
        ("vertical", "normal_force_N", sum(masses) * runs.GRAVITY, ("centre_z_m", "box_2_z_m")),
    ):
        places = zip(masses, columns, strict=True)
        momentum = np.sum([mass * np.gradient(history[column], times) for mass, column in places], axis=0)
        yield analytic(
            f"{case}, from 0.4 to 0.49 s with an impact",
            f"{name} momentum gained by both boxes [Ns]",
            momentum[last] - momentum[first],
            np.trapezoid(history[force][first : last + 1] - weight, times[first : last + 1]),
            source="impulse of the floor and of the weight",
            relative=0.01,
        )
    history = pair.run(contact__normal_penalty_Pa_m=1e11).history
    lost = history["friction_J"] + history["contact_damping_J"]
    # from the end of the pulse on; the floor moves steadily
    since, energies = np.searchsorted(history["time_s"], 0.15), []
    for time in (0.15, 1.0):  # relative to the floor [J]
        piece = next(piece for piece in exact.pieces if piece.end >= time)
        energies.append(energy(exact.stack, exact.footings[piece.regime], piece.interpolant(time)))
    what = f"{case}, {len(exact.impacts)} impacts", "energy lost after the pulse [J]"
    taken = lost[-1] - lost[since], energies[0] - energies[1]
    yield computed(*what, *taken, source=BLOCKS, relative=0.02)
    low, tall = BESIDE
    mirrored = (low, tall | {"offset_m": -tall["offset_m"]})
    sides = [
        rotations(BoxPair(boxes, peak=sign * runs.GRAVITY).run().history)
        for sign, boxes in ((1.0, BESIDE), (-1.0, mirrored))
    ]
    yield analytic(
        "tall beside the axis of a low one, and its mirror image",
        "rotations, sum over the largest",
        np.abs(sides[0] + sides[1]).max() / np.abs(sides[0]).max(),
        source="symmetry",
        absolute=1e-4,
        note="nine impacts: what the iterations leave grows",
    )


@check("stacks", "ten boxes at rest")
def ten_boxes() -> Findings:
    """A stack of ten boxes settles and stays."""
    ten = {"container.boxes": 10, "container.height_m": 1.0, "container.weight_N": 24525.0}
    for name, values in (("rigid", {}), ("solid, 20 modes", runs.SOLID)):
        done = runs.run(runs.STACK, ten | LOOSE | values | {"solver.duration_s": 2.0})
        joints = done.model.run.joints
        yield analytic(
            f"ten loose boxes of 1.1 x 1 m, {name}, floor at rest for 2 s",
            "largest rotation [rad], slip or opening [m]",
            max(float(np.abs(joints[name]).max()) for name in ("max_rotation", "max_slip", "max_opening")),
            source="statics",
            absolute=1e-8,
        )


def rotations(history: History) -> np.ndarray:
    """Rotations of two boxes, shape (n, 2) [rad]."""
    return np.stack([history["rotation_rad"], history["box_2_rotation_rad"]], axis=1)


def crossing(times: np.ndarray, angle: np.ndarray, level: float = 1e-3) -> float:
    """When an angle exceeds a level for the first time [s]; nan if it does not."""
    above = np.flatnonzero(angle > level)
    if not above.size or not above[0]:
        return math.nan
    k = above[0]
    return float(np.interp(level, angle[k - 1 : k + 1], times[k - 1 : k + 1]))
