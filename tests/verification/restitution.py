"""Restitution of an impact: a property of the support, and Housner's number for corners and a stiff container.

Measured by the peaks around the first impact, as the square root of the ratio of the potential energies. The
reference is e = 1 - (M R^2/I_O)(1 - cos 2 al), Housner, BSSA 53 (1963). Claimed for corners, c/a of 1.5 and more,
and an elastic frequency f1 far above the bounce frequency f_c; a shell of thin plates is outside. A flat base has no
closed form; its reference is `block_on_springs`.
"""

import itertools
import math
from functools import partial

import numpy as np
from block_on_springs import evenly_spaced, next_turning_point
from evidence.findings import Convergence, analytic, computed
from floors import one_sine_pulse
from runs import GRAVITY, SOLID, STACK, Keys, pulse, run
from verification.checks import MESH, Findings, check
from verification.rocking import turning_points

from contact.interface.penalty import contact_frequency
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from fem.case.case import Case
from fem.model.container import discretise

RIGID_TOLERANCE, SOLID_TOLERANCE = 5e-3, 1e-2
DENSITY = 2066.0  #: [kg/m3]
STACKED = 4.0 / 1.1  #: slenderness of the stack
COMPARED = "velocity ratio at the first impact"
housner = partial(analytic, source="1 - 1.5 sin^2 al, Housner 1963")


@check("restitution", "slendernesses")
def slendernesses() -> Findings:
    """Rigid blocks on corners."""
    known = {1.5: 0.5385, 2.0: 0.7, 2.5: 0.7931, 3.6364: 0.8945, 4.0: 0.91176, 10.0: 0.98515}
    for lam, exact in known.items():
        case, ratio = f"rigid block, c/a = {lam:g}", run(block(lam)).restitution
        yield housner(case, COMPARED, ratio, exact, absolute=RIGID_TOLERANCE)


@check("restitution", "the error of a soft floor")
def penalty_limit() -> Findings:
    """The error of the rigid block's restitution falls with the penalty."""
    exact = 1.0 - 1.5 / (1.0 + (4.0 / 1.1) ** 2)
    factors = (1.0 / 3.0, 1.0, 3.0, 9.0)
    ratios = {1.0 / factor: run(block(4.0 / 1.1), stiffer=factor).restitution for factor in factors}
    errors = {size: abs(value - exact) for size, value in ratios.items()}
    yield housner(
        "rigid stack, penalty from a third to nine times the default",
        "velocity ratio at nine times; order in 1/penalty",
        ratios[1.0 / 9.0],
        exact,
        absolute=RIGID_TOLERANCE,
        convergence=Convergence("default penalty/penalty", errors, order=1.0, within=0.25),
    )


@check("restitution", "penalties, steps, meshes")
def variations() -> Findings:
    """Two penalties, two steps, two meshes, three slendernesses: the worst of each."""
    stiff = SOLID | {"container.youngs_modulus_Pa": 4e12}
    models: dict[str, tuple[Keys, float]] = {
        "rigid": ({}, RIGID_TOLERANCE),
        "stiff solid, 20 modes": (stiff, SOLID_TOLERANCE),
    }
    for lam, (name, (values, tolerance)) in itertools.product((2.0, 2.5, 3.6364), models.items()):
        sizes = {size: values | {"solver.element_size_m": size} for size in (0.2, 0.1)}
        containers = {size: discretise(block(lam, keys)) for size, keys in sizes.items()}
        ratios = {}
        for penalty, step, size in itertools.product((1.0, 3.0), ("auto", 1e-3), sizes):
            case = block(lam, sizes[size] | {"solver.step_s": step})
            ratio = run(case, None, containers[size], penalty).restitution
            ratios[f"penalty x {penalty:g}, step {step}, h = {size} m"] = ratio
        exact = 1.0 - 1.5 / (1.0 + lam**2)
        worst, value = max(ratios.items(), key=lambda item: abs(item[1] - exact))
        yield housner(
            f"{name}, c/a = {lam:g}, worst of 8: {worst}", COMPARED, value, exact, absolute=tolerance
        )


@check("restitution", "stiffness of the container")
def stiffness_of_the_container() -> Findings:
    """Solid stacks from f1/f_c = 7 up: the limit of what is claimed."""
    for modulus in (4.3e11, 8.5e11, 2.1e12):
        elastic = {"container.youngs_modulus_Pa": modulus, "solver.element_size_m": 0.1}
        done = run(block(3.6364, SOLID | elastic))
        bounce = contact_frequency(done.model.container.mesh.mass, done.model.base_stiffness)
        case = f"solid stack, 20 modes, f1/f_c = {done.model.spectra[0][0] / bounce:.1f}"
        yield housner(case, COMPARED, done.restitution, 0.8945, absolute=SOLID_TOLERANCE)


@check("restitution", "centroids and columns", inputs=MESH)
def centroids_and_columns() -> Findings:
    """Boxes filled below and above their middle, two boxes and eight, and a column 1:20: as Housner's."""
    for centroid in (0.25, 0.35, 0.5, 0.65):
        filled = {"container.centroid_m": centroid, "container.section": "shell", "container.wall_m": 0.008}
        done = run(boxes(4, filled))
        case, exact = f"four boxes, centroids at {centroid} m of 1.0 m", done.block.housner_restitution
        source = "1 - (M R^2/I_O)(1 - cos 2 al), Housner 1963"
        yield analytic(case, COMPARED, done.restitution, exact, source=source, absolute=RIGID_TOLERANCE)
    for count in (2, 8):
        exact = 1.0 - 1.5 / (1.0 + (count / 1.1) ** 2)
        yield housner(
            f"{count} boxes", COMPARED, run(boxes(count)).restitution, exact, absolute=RIGID_TOLERANCE
        )
    ratio = run(block(20.0, {"solver.duration_s": 6.0})).restitution
    yield housner("column, c/a = 20", COMPARED, ratio, 1.0 - 1.5 / 401.0, absolute=1e-3)


@check("restitution", "tolerances and steps of time stepping")
def tolerances_and_steps() -> Findings:
    """Restitution depends on neither the tolerance of the energy balance nor the largest step."""
    for kind in ("corners", "flat"):
        keys = {"support.kind": kind, "solver.element_size_m": 0.1}
        settings = (
            {"solver.energy_tolerance": tolerance, "solver.step_s": step}
            for tolerance, step in itertools.product((0.01, 1.0, 10.0), (1e-4, 1e-2))
        )
        ratios = [run(block(STACKED, keys | setting)).restitution for setting in settings]
        case, compared = (
            f"rigid stack on {kind}, tolerance 0.01 to 10, steps of 0.1 to 10 ms",
            f"{COMPARED}, largest minus least",
        )
        spread, source = max(ratios) - min(ratios), "a property of the support"
        yield analytic(case, compared, spread, source=source, absolute=1e-3)


@check("restitution", "a stated restitution")
def stated() -> Findings:
    """`contact.restitution_over_housner` in free rocking from large and small swings."""
    stated_ratios = {2.0: (0.67, 0.9, 1.15), STACKED: (0.67, 0.96, 1.05), 10.0: (0.67, 0.96, 1.01)}
    for lam, ratios in stated_ratios.items():
        for ratio, share in itertools.product(ratios, (0.5, 0.2, 0.07)):
            start = {"initial.rotation_rad": share * math.atan(1.0 / lam)}
            done = run(block(lam, start | {"contact.restitution_over_housner": ratio}))
            case = f"rigid block, c/a = {lam:.3g}, released from {share:g} of the slenderness angle"
            compared, source = f"{COMPARED}, {ratio:g} of Housner's asked for", "as asked for in the case"
            exact = ratio * (1.0 - 1.5 / (1.0 + lam**2))
            yield analytic(case, compared, done.restitution, exact, source=source, absolute=RIGID_TOLERANCE)


@check("restitution", "a stated restitution under a pulse", inputs=MESH)
def stated_under_a_pulse() -> Findings:
    """Largest rotation of the stack under one sine, with less and more restitution, on both floors."""
    slab = {"floor.preset": "concrete C25/30", "floor.corner_patch_m": [0.008, 1.1]}
    floors: dict[str, Keys] = {"rigid floor": {}, "slab": slab}
    for (name, floor), peak, ratio in itertools.product(floors.items(), (3.8, 4.0), (0.9, 0.96, 1.03)):
        keys = pulse(peak, 1.0, "sine") | {"contact.mu_static": 3.0, "solver.duration_s": 6.0} | floor
        done = run(STACK.with_values(keys | {"contact.restitution_over_housner": ratio}))
        block = done.block  # about the points where it turns: on the end of its wall inside the edge
        restitution, pulsed = ratio * block.housner_restitution, one_sine_pulse(peak=peak, duration=1.0)
        reference = simulate_rocking(block, pulsed, duration=6.0, restitution=restitution)
        case = f"stack, {name}, pulse of 1 s and {peak:g} m/s2, {ratio:g} of Housner's restitution"
        compared, source = (
            "largest rotation over the slenderness angle",
            "event-driven block with that restitution",
        )
        found = (float(done.track.max_rotation), reference.largest_rotation)
        ratios = (rotation / block.slenderness_angle for rotation in found)
        yield analytic(case, compared, *ratios, source=source, relative=0.03)


@check(
    "restitution",
    "a bed of springs",
    quick=False,
    inputs=f"{MESH} So do the stiffness and the dashpots of the springs.",
)
def bed_of_springs() -> Findings:
    """A flat base keeps more than Housner's: as a rigid block on springs that shares no code, by two turning points."""
    beds: tuple[tuple[str, Keys, tuple[float, ...]], ...] = (
        ("corners", {}, (0.05,)),
        ("flat", {}, (0.1, 0.05, 0.02)),
        ("flat", {"contact.damping_ratio": 0.5}, (0.05,)),
        ("flat", {"contact.normal_penalty_Pa_m": 1e9}, (0.05,)),
        ("flat", {"contact.normal_penalty_Pa_m": 1e10}, (0.05,)),
        ("flat", {"contact.normal_penalty_Pa_m": 1e11}, (0.05,)),
    )
    for kind, values, sizes in beds:
        keys = {"support.kind": kind, "output.history_s": 1e-3} | values
        runs = {size: run(block(STACKED, keys | {"solver.element_size_m": size})) for size in sizes}
        done = runs[0.05]
        contact, width = done.model.run.problem.contact, 2.0 * done.block.half_width
        turned = next_turning_point(
            done.block,
            places=np.array([-0.5, 0.5]) * width if kind == "corners" else evenly_spaced(width, 111),
            stiffness=float(contact.normal_stiffness.sum()) / done.model.container.mesh.mass,
            relaxation_time=float(contact.relaxation_time[0]),
            rotation=0.5 * done.block.slenderness_angle,
            duration=done.model.duration,
        )
        exact = velocity_ratio(done.block, turned)
        changed = "".join(f", {key.split('.')[1]} = {value:g}" for key, value in values.items())
        for size, done in runs.items():
            yield computed(
                f"rigid stack on {kind}{changed}, elements of {size} m",
                "velocity ratio by the turning points before and after the first impact",
                velocity_ratio(done.block, turning_points(done.history)[0]),
                exact,
                source="rigid block on springs, 2 for corners and 111 for a flat base",
                absolute=2e-3,
            )


def velocity_ratio(block: RigidBlock, rotation: float) -> float:
    """Velocity ratio of the first impact, by potential energies, from the turning point after it [rad]."""
    angle = block.slenderness_angle
    energy, left = (math.cos(angle - turned) - math.cos(angle) for turned in (0.5 * angle, rotation))
    return math.sqrt(left / energy)


def boxes(count: int, values: Keys | None = None) -> Case:
    """Boxes of 1.1 x 1.0 m on top of each other, released as `block`."""
    box = {"container.boxes": count, "container.height_m": 1.0, "container.weight_N": 24525.0}
    return block(
        count / 1.1, box | {"solver.duration_s": 4.0, "solver.element_size_m": 0.25} | (values or {})
    )


def block(slenderness: float, values: Keys | None = None) -> Case:
    """A block of 1.1 m x slenderness at half its slenderness angle, until its second turning point."""
    height = 1.1 * slenderness
    tilted = {
        "container.height_m": height,
        "container.weight_N": DENSITY * GRAVITY * 1.1 * 1.1 * height,
        "initial.rotation_rad": 0.5 * math.atan(1.0 / slenderness),
        "solver.duration_s": 2.5,
        "contact.mu_static": 3.0,
    }
    return STACK.with_values(tilted | (values or {}))
