"""Limits of the models: rigid container, stiff floor, many modes, full model; the paper's stack on its floors.

The event-driven references share no code with the stepping. Tilts and slips of a container that should rest are
those of its springs.
"""

import math
from itertools import product

import numpy as np
from evidence.findings import Convergence, analytic, computed
from floors import sine_floor, still_floor
from runs import BLOCK, FRICTION, SLENDERNESS, SOLID, STACK, TILTED, Keys, harmonic, run
from verification.checks import MESH, PROGRAM, Findings, check

from contact.reference.planar_block import PlanarBlock, PlanarMode, simulate_planar_block
from contact.reference.rocking import simulate_rocking
from fem.model.model import build_model
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray

RELEASED = TILTED | {"solver.duration_s": 0.65, "output.history_s": 0.01}
SHELL = SOLID | {"container.wall_m": 0.008, "container.section": "shell"}
PLANAR_BLOCK = "event-driven planar block"


@check("limits", "limit of a rigid container", inputs=PROGRAM)
def rigid_container() -> Findings:
    """The stiffer the container on the same floor, the nearer to the rigid model: like 1/E."""
    penalty = build_model(STACK.with_values(RELEASED)).penalty
    keys = RELEASED | {"contact.normal_penalty_Pa_m": penalty, "solver.step_s": 5e-4}
    rigid = rotation(keys)
    errors = {
        1.0 / modulus: largest(rotation(keys | SOLID | {"container.youngs_modulus_Pa": modulus}) - rigid)
        for modulus in (1e10, 3e10, 1e11, 3e11)
    }
    orders = Convergence("1/E [1/Pa]", errors, order=1.0, within=0.15)
    yield computed(
        "solid stack, 20 modes, released at half its slenderness angle, up to the impact",
        "rotation, largest difference from the rigid model over the slenderness angle, at E = 3e11 Pa; order in 1/E",
        source="rigid model on the same floor",
        absolute=1e-4,
        convergence=orders,
    )


@check("limits", "limit of a stiff floor", inputs=MESH)
def stiff_floor() -> Findings:
    """The stiffer the floor, the nearer the rigid model to the analytic block: like 1/penalty."""
    errors = {}
    for factor in (0.1, 0.3, 1.0, 3.0):
        done = run(STACK, RELEASED | {"solver.step_s": 5e-4}, stiffer=factor)
        exact = simulate_rocking(
            done.block, still_floor(), duration=0.66, rotation=0.5 * SLENDERNESS, stop_at_impact=True
        )
        difference = done.history["rotation_rad"] - exact.at(done.history["time_s"])[0]
        errors[1.0 / factor] = largest(difference)
    orders = Convergence("default penalty/penalty", errors, order=1.0, within=0.25)
    yield computed(
        "rigid stack released at half its slenderness angle, up to the impact",
        "rotation, largest difference from the analytic block over the slenderness angle, at 3 x the default penalty",
        source="event-driven block",
        absolute=1e-4,
        convergence=orders,
    )


@check("limits", "limit of many modes", inputs=PROGRAM)
def many_modes() -> Findings:
    """A shell through its first impact: the more elastic modes, the nearer to very many."""
    keys = SHELL | RELEASED | {"solver.step_s": 2.5e-4, "solver.duration_s": 1.3}
    reference = rotation(keys | {"solver.elastic_modes": 160})
    errors = {
        1.0 / (count + 4): largest(rotation(keys | {"solver.elastic_modes": count}) - reference)
        for count in (0, 4, 8, 16, 32, 64)
    }
    against = "1/(modes + the 4 attachment modes)"
    orders = Convergence(against, errors, order=1.0, within=0.2, at_least=True)
    yield computed(
        "shell stack of 8 mm released at half its slenderness angle, through its first impact, 64 modes",
        "rotation, largest difference from 160 modes over the slenderness angle; order in 1/(modes + 4)",
        source="160 modes",
        absolute=1e-3,
        convergence=orders,
    )


@check("limits", "rest under the stated motion", inputs="The tolerance of slip is of the model's stiffness.")
def stated_motion() -> Findings:
    """The stack under 50 mm at 6.928 rad/s, below uplift: it stays at rest for ten cycles."""
    models: dict[str, Keys] = {"rigid": {}, "solid, 20 modes": SOLID, "shell of 8 mm, 20 modes": SHELL}
    source = "2.40 < 2.698 (uplift) < 3.924 m/s2 (slip)"
    for name, values in models.items():
        done = run(STACK, harmonic(0.05, 6.928) | FRICTION | {"solver.duration_s": 9.07} | values)
        case = f"stack ({name}) under 50 mm at 6.928 rad/s, mu 0.4/0.2"
        slip, tilt = done.joint.max_slip, done.track.max_rotation
        # the base moves as far as the spring of a corner that carries the whole weight gives way
        stick = 0.4 * done.model.static.weight / (0.5 * done.model.base_stiffness)
        yield analytic(case, "largest slip [m]", slip, source=source, absolute=stick)
        yield analytic(case, "largest tilt [rad]", tilt, source=source, absolute=1e-4)


@check("limits", "the plateau's acceleration")
def plateau() -> Findings:
    """The stack at the plateau's 4.0 m/s2: rocks without slip and stands, at three penalties."""
    source = f"{PLANAR_BLOCK}; 0.38 to 0.43 for e of 0.85 to 0.96"
    for factor in (1.0 / 3.0, 1.0, 3.0):
        keys = harmonic(4.0 / 6.928**2, 6.928) | FRICTION | {"solver.duration_s": 8.0}
        done = run(STACK, keys, stiffer=factor)
        case = f"rigid stack, peak 4.0 m/s2 at 6.928 rad/s, mu 0.4/0.2, penalty x {factor:.3g}"
        compared = "largest rotation in 8 s over the slenderness angle"
        turned = float(done.track.max_rotation) / SLENDERNESS
        yield computed(case, compared, turned, 0.399, source=source, absolute=0.01)
        compared, stands = "rocks without slip and stands (1)", done.status == "completed"
        note = f"slip {1e6 * float(done.joint.max_slip):.3g} um"
        rocks = done.outcome == Outcome.ROCK and stands
        yield computed(case, compared, rocks, 1.0, source=PLANAR_BLOCK, absolute=0.0, note=note)


@check("limits", "a floor that starts with a jerk")
def jerk() -> Findings:
    """The floor starts with a jerk under a stack at rest, mu 0.4/0.4."""
    settings = {"contact.mu_static": 0.4, "motion.start": "rest", "solver.duration_s": 20.0}
    for omega, exact, note in ((6.93, 0.2505, "the reference is for 6.93 rad/s"), (6.928, 0.25040, "")):
        turned = float(run(STACK, harmonic(0.05, omega) | settings).track.max_rotation) / SLENDERNESS
        case = f"rigid stack at rest, 50 mm at {omega} rad/s from t = 0, mu 0.4/0.4"
        compared = "largest rotation over the slenderness angle"
        yield computed(case, compared, turned, exact, source=PLANAR_BLOCK, relative=0.01, note=note)


@check("limits", "slide-rocking")
def slide_rocking() -> Findings:
    """The stack under 0.1 m at 8 rad/s on friction 0.3: it rocks and slides."""
    done = run(STACK, harmonic(0.1, 8.0) | {"contact.mu_static": 0.3, "solver.duration_s": 2.5})
    case, rotated = "rigid stack, A = 0.1 m, Omega = 8 rad/s, mu 0.3", done.track.max_rotation
    note = "the second turning point, -0.100303 rad at 0.986 s; the first is 0.0355 rad"
    compared, slip = "largest rotation [rad]", done.history["slip_m"][-1]
    yield computed(case, compared, rotated, 0.100303, source=PLANAR_BLOCK, relative=0.02, note=note)
    yield computed(case, "slip after 2.5 s [m]", slip, 81.1e-3, source=PLANAR_BLOCK, relative=0.02)


@check(
    "limits",
    "full model",
    quick=False,
    inputs="First impact and restitution: nothing; the other references are runs of the reduced model.",
)
def full_model() -> Findings:
    """Every node free to move: first impact and velocity ratio, against exact values and the reduced model."""
    keys = TILTED | {
        "container.youngs_modulus_Pa": 2.1e12,
        "solver.duration_s": 1.75,
        "solver.element_size_m": 0.5,
        "solver.order": 2,
    }
    full, reduced = (run(STACK, keys | {"solver.model": model}) for model in ("full", "reduced"))
    before = full.history["time_s"] < 0.69
    difference = full.history["rotation_rad"] - reduced.history["rotation_rad"]
    ratio, other = (done.restitution for done in (full, reduced))
    case = "stiff solid stack, full model, released at half its slenderness angle"
    source = "reduced model, 20 modes"
    impact = full.track.first_impact
    yield analytic(case, "first impact [s]", impact, 0.700737, source="quarter period, exact", relative=3e-3)
    compared = "velocity ratio at the first impact"
    yield analytic(case, compared, ratio, 0.8945, source="Housner 1963", absolute=1e-2)
    compared = "velocity ratio minus that of the reduced model"
    yield computed(case, compared, ratio - other, source=source, absolute=1e-2)
    compared = (
        "rotation before the impact, largest difference from the reduced model over the slenderness angle"
    )
    yield computed(case, compared, largest(difference[before]), source=source, absolute=1e-3)


@check("limits", "a shell refined", quick=False, inputs=PROGRAM)
def refined_shell() -> Findings:
    """The default motion of the stack, a shell: it depends on no number of the discretisation.

    Its friction does not fall: with mu_k below mu_s the regime after an impact is chance.
    """
    motion = harmonic(4.0 / 6.928**2, 6.928) | SHELL | {"contact.mu_static": 0.4, "solver.duration_s": 12.0}
    fine: Keys = {"element_size_m": 0.1, "elastic_modes": 100, "energy_tolerance": 0.1, "step_s": 2e-4}

    def largest_of(solver: Keys) -> float:
        keys = {f"solver.{key}": value for key, value in solver.items()}
        return float(run(STACK, motion | keys).track.max_rotation) / SLENDERNESS

    exact = largest_of(fine)
    variations: dict[str, tuple[Keys, ...]] = {
        "elements of 0.1 and 0.3 m": ({"element_size_m": 0.1}, {"element_size_m": 0.3}),
        "linear elements of 0.05 m": ({"order": 1, "element_size_m": 0.05},),
        "4 and 100 modes": ({"elastic_modes": 4}, {"elastic_modes": 100}),
        "tolerance 0.01 and 10": ({"energy_tolerance": 0.01}, {"energy_tolerance": 10.0}),
        "steps of 0.05 and 1 ms": ({"step_s": 5e-5}, {"step_s": 1e-3}),
        "spectral radius 0, 0.8 and 0.9": tuple({"spectral_radius": radius} for radius in (0.0, 0.8, 0.9)),
    }
    for name, changes in variations.items():
        yield computed(
            f"shell stack of 8 mm, peak 4.0 m/s2 at 6.928 rad/s, mu 0.4/0.4, {name}",
            "largest rotation in 12 s over the slenderness angle, the farther from the reference",
            max((largest_of(change) for change in changes), key=lambda ratio: abs(ratio - exact)),
            exact,
            source="elements of 0.1 m, 100 modes, tolerance 0.1, steps of 0.2 ms",
            relative=0.01,
        )


@check("limits", "friction that decides")
def friction_decides() -> Findings:
    """A strong fast floor: with mu_k = mu_s/2 the stack slides and stands, with mu_k = mu_s it overturns."""
    floor = sine_floor(amplitude=10.3333 / 36.0, angular_frequency=6.0)
    motion = harmonic(10.3333 / 36.0, 6.0) | {"contact.mu_static": 0.4, "solver.duration_s": 20.0}
    sliding = PlanarBlock(body=BLOCK, mu_static=0.4, mu_kinetic=0.2)
    exact = simulate_planar_block(sliding, floor, duration=20.0).largest_rotation / SLENDERNESS
    ratios = {}
    for factor in (1.0 / 3.0, 1.0, 3.0):
        done = run(STACK, motion | {"contact.mu_kinetic": 0.2}, stiffer=factor)
        ratios[1.0 / factor] = float(done.track.max_rotation) / SLENDERNESS
    errors = {size: abs(value - exact) for size, value in ratios.items()}
    case = "rigid stack, peak 10.333 m/s2 at 6 rad/s, mu 0.4/0.2"
    compared = "largest rotation in 20 s over the slenderness angle, at 3 x the default penalty"
    orders = Convergence("default penalty/penalty", errors, order=1.0, within=0.25)
    both = ratios[1.0 / 3.0], exact
    yield computed(case, compared, *both, source=PLANAR_BLOCK, relative=0.02, convergence=orders)
    gripping = PlanarBlock(body=BLOCK, mu_static=0.4, mu_kinetic=0.4)
    over = simulate_planar_block(gripping, floor, duration=20.0)
    done = run(STACK, motion)
    found = done.times[-1] if done.status == "overturned" else math.inf
    falls = over.end if over.outcome is PlanarMode.OVERTURNED else math.nan
    what = "rigid stack, peak 10.333 m/s2 at 6 rad/s, mu 0.4/0.4", "lies on its side at [s]"
    yield computed(*what, found, falls, source=PLANAR_BLOCK, relative=0.01)


@check("limits", "a start at rest", quick=False)
def start_at_rest() -> Findings:
    """Floors that find the stack at rest: it slides first, and may rock only where its slip turns round."""
    block = PlanarBlock(body=BLOCK, mu_static=0.4, mu_kinetic=0.2)
    friction = {"contact.mu_static": 0.4, "contact.mu_kinetic": 0.2, "motion.start": "rest"}
    different = 0
    for omega, peak in product((1.7, 2.4, 3.4, 4.9, 7.0), (4.4, 5.3, 6.4, 7.9, 9.7)):
        amplitude = peak / omega**2
        done = run(STACK, harmonic(amplitude, omega) | friction | {"solver.duration_s": 20.0})
        floor = sine_floor(amplitude=amplitude, angular_frequency=omega)
        exact = simulate_planar_block(block, floor, duration=20.0, slip_velocity=-amplitude * omega)
        different += (done.outcome == Outcome.OVERTURNED) != (exact.outcome is PlanarMode.OVERTURNED)
    case = "rigid stack, 1.7 to 7 rad/s, 4.4 to 9.7 m/s2, mu 0.4/0.2, at rest at t = 0"
    compared = "runs of 25 in which it stands and the reference overturns, or the reverse"
    note = "one may be so close to a change of outcome that the penalty decides"
    yield computed(case, compared, different, source=PLANAR_BLOCK, absolute=1, note=note)


@check("limits", "full model through an impact", quick=False, inputs=PROGRAM)
def full_model_through_an_impact() -> Findings:
    """Every node of the shell free to move, through its first impact: the same motion as with 20 modes.

    With small steps: with those of `solver.energy_tolerance` = 1 the slip, where mu_k is 0.2, scatters by 1 mm if the
    motion is changed by 1e-9.
    """
    motion = harmonic(4.0 / 6.928**2, 6.928) | SHELL | {"contact.mu_static": 0.4, "solver.duration_s": 1.0}
    motion |= {"solver.energy_tolerance": 0.2}
    for kinetic in (0.4, 0.2):
        full, reduced = (
            run(STACK, motion | {"contact.mu_kinetic": kinetic, "solver.model": model})
            for model in ("full", "reduced")
        )
        case = f"shell stack of 8 mm, peak 4.0 m/s2 at 6.928 rad/s, mu 0.4/{kinetic}, 1.0 s"
        source, impact = "reduced model, 20 modes", "first impact [s]"
        first, other = (float(done.track.first_impact) for done in (full, reduced))
        yield computed(case, impact, first, other, source=source, relative=1e-3)
        difference = largest(full.history["rotation_rad"] - reduced.history["rotation_rad"])
        compared = "rotation, largest difference from the reduced model over the slenderness angle"
        yield computed(case, compared, difference, source=source, absolute=2e-3)
        difference = float(np.abs(full.history["slip_m"] - reduced.history["slip_m"]).max())
        compared = "slip, largest difference from the reduced model [m]"
        yield computed(case, compared, difference, source=source, absolute=1e-3)


def rotation(keys: Keys) -> FloatArray:
    """Rotation of the stack at the samples [rad]."""
    return run(STACK, keys).history["rotation_rad"]


def largest(difference: FloatArray) -> float:
    """Largest |difference| of rotations over the slenderness angle."""
    return float(np.abs(difference).max()) / SLENDERNESS
