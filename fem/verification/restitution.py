"""Restitution of an impact: a property of the support, and Housner's number for corners and a stiff container.

Measured by the peaks around the first impact, as the square root of the ratio of the potential energies. The
reference is e = 1 - (M R^2/I_O)(1 - cos 2 al), Housner, BSSA 53 (1963). Claimed for corners, c/a of 1.5 and more,
and an elastic frequency f1 far above the bounce frequency f_c; a shell of thin plates is outside.
"""

import itertools
import math
from collections.abc import Iterator
from functools import partial

from contact.interface.penalty import contact_frequency
from fem.case.case import Case
from fem.model.container import Container, discretise
from fem.model.model import build_model
from fem.verification.rows import Row, analytic, check, convergence
from fem.verification.runs import GRAVITY, SOLID, STACK, Finished, Keys, finish

RIGID_TOLERANCE, SOLID_TOLERANCE = 5e-3, 1e-2
DENSITY = 2066.0  #: [kg/m3]
COMPARED = "velocity ratio at the first impact"
housner = partial(analytic, source="1 - 1.5 sin^2 al, Housner 1963")


@check("restitution", "slendernesses")
def slendernesses() -> Iterator[Row]:
    """Rigid blocks on corners."""
    known = {1.5: 0.5385, 2.0: 0.7, 2.5: 0.7931, 3.6364: 0.8945, 4.0: 0.91176, 10.0: 0.98515}
    for lam, exact in known.items():
        case, found = f"rigid block, c/a = {lam:g}", peaks(released(block(lam)))
        yield housner(case, COMPARED, found, exact, absolute=RIGID_TOLERANCE)


@check("restitution", "the error of a soft floor")
def penalty_limit() -> Iterator[Row]:
    """The error of the rigid block's restitution falls with the penalty."""
    exact = 1.0 - 1.5 / (1.0 + (4.0 / 1.1) ** 2)
    factors = (1.0 / 3.0, 1.0, 3.0, 9.0)
    found = {1.0 / factor: peaks(released(block(4.0 / 1.1), factor)) for factor in factors}
    errors = {size: abs(value - exact) for size, value in found.items()}
    yield housner(
        "rigid stack, penalty from a third to nine times the default",
        "velocity ratio at nine times; order in 1/penalty",
        found[1.0 / 9.0],
        exact,
        absolute=RIGID_TOLERANCE,
        convergence=convergence("default penalty/penalty", errors, order=1.0, within=0.25),
    )


@check("restitution", "penalties, steps, meshes")
def variations() -> Iterator[Row]:
    """Two penalties, two steps, two meshes, three slendernesses: the worst of each."""
    stiff = SOLID | {"container.youngs_modulus_Pa": 4e12}
    models: dict[str, tuple[Keys, float]] = {
        "rigid": ({}, RIGID_TOLERANCE),
        "stiff solid, 20 modes": (stiff, SOLID_TOLERANCE),
    }
    for lam, (name, (values, tolerance)) in itertools.product((2.0, 2.5, 3.6364), models.items()):
        sizes = {size: values | {"solver.element_size_m": size} for size in (0.2, 0.1)}
        containers = {size: discretise(block(lam, keys)) for size, keys in sizes.items()}
        found = {}
        for penalty, step, size in itertools.product((1.0, 3.0), ("auto", 1e-3), sizes):
            case = block(lam, sizes[size] | {"solver.step_s": step})
            ratio = peaks(released(case, penalty, containers[size]))
            found[f"penalty x {penalty:g}, step {step}, h = {size} m"] = ratio
        exact = 1.0 - 1.5 / (1.0 + lam**2)
        worst, value = max(found.items(), key=lambda item: abs(item[1] - exact))
        yield housner(
            f"{name}, c/a = {lam:g}, worst of 8: {worst}", COMPARED, value, exact, absolute=tolerance
        )


@check("restitution", "stiffness of the container")
def stiffness_of_the_container() -> Iterator[Row]:
    """Solid stacks from f1/f_c = 7 up: the limit of what is claimed."""
    for modulus in (4.3e11, 8.5e11, 2.1e12):
        elastic = {"container.youngs_modulus_Pa": modulus, "solver.element_size_m": 0.1}
        done = released(block(3.6364, SOLID | elastic))
        bounce = contact_frequency(done.model.container.mesh.mass, done.model.base_stiffness)
        case = f"solid stack, 20 modes, f1/f_c = {done.model.frequencies[0] / bounce:.1f}"
        yield housner(case, COMPARED, peaks(done), 0.8945, absolute=SOLID_TOLERANCE)


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


def released(case: Case, stiffer: float = 1.0, container: Container | None = None) -> Finished:
    """The run of a block; `stiffer` multiplies its default penalty."""
    model = build_model(case, container)
    if stiffer != 1.0:
        penalty = {"contact.normal_penalty_Pa_m": stiffer * model.penalty}
        model = build_model(case.with_values(penalty), model.container)
    return finish(model)


def peaks(done: Finished) -> float:
    """Velocity ratio of the first impact, by the peaks around it."""
    return float(done.track.restitution)
