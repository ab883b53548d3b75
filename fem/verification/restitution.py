"""Restitution of an impact: a property of the support, and Housner's number for corners and a stiff container.

Measured by the peaks around the first impact, as the square root of the ratio of the potential energies. The
reference is e = 1 - (M R^2/I_O)(1 - cos 2 al), Housner, BSSA 53 (1963). Claimed for corners, c/a of 1.5 and more,
and an elastic frequency f1 far above the bounce frequency f_c; a shell of thin plates is outside.
"""

import itertools
import math
from collections.abc import Mapping
from typing import Any

from contact.interface.penalty import contact_frequency
from fem.model.model import build_model
from fem.verification.rows import Check, Convergence, Row, as_floats
from fem.verification.runs import GRAVITY, SOLID, STACK, Finished, run

HOUSNER = "1 - 1.5 sin^2 al, Housner 1963"
RIGID_TOLERANCE, SOLID_TOLERANCE = 5e-3, 1e-2
DENSITY = 2066.0  #: [kg/m3]


def released(slenderness: float, values: Mapping[str, Any] | None = None, stiffer: float = 1.0) -> Finished:
    """A block of 1.1 m x slenderness let go from half its slenderness angle, to its second turning point.

    `stiffer` multiplies the default penalty.
    """
    height = 1.1 * slenderness
    keys: dict[str, Any] = {
        "container.height_m": height,
        "container.weight_N": DENSITY * GRAVITY * 1.1 * 1.1 * height,
        "initial.rotation_rad": 0.5 * math.atan(1.0 / slenderness),
        "solver.duration_s": 2.5,
        "contact.mu_static": 3.0,
    } | dict(values or {})
    if stiffer != 1.0:
        keys["contact.normal_penalty_Pa_m"] = stiffer * build_model(STACK.with_values(keys)).penalty
    return run(STACK, keys)


def slendernesses() -> list[Row]:
    """Rigid blocks on corners."""
    known = {1.5: 0.5385, 2.0: 0.7, 2.5: 0.7931, 3.6364: 0.8945, 4.0: 0.91176, 10.0: 0.98515}
    return [
        _row(f"rigid block, c/a = {lam:g}", _peaks(released(lam)), reference, RIGID_TOLERANCE)
        for lam, reference in known.items()
    ]


def variations() -> list[Row]:
    """Two penalties, two steps, two meshes, three slendernesses: the worst of each."""
    rows = []
    stiff = SOLID | {"container.youngs_modulus_Pa": 4e12}
    for lam, model in itertools.product((2.0, 2.5, 3.6364), ("rigid", "stiff solid, 20 modes")):
        rigid = model == "rigid"
        found: dict[str, float] = {}
        for penalty, step, size in itertools.product((1.0, 3.0), ("auto", 1e-3), (0.2, 0.1)):
            keys = ({} if rigid else stiff) | {"solver.step_s": step, "solver.element_size_m": size}
            found[f"penalty x {penalty:g}, step {step}, h = {size} m"] = _peaks(released(lam, keys, penalty))
        reference = 1.0 - 1.5 / (1.0 + lam**2)
        worst = max(found, key=lambda name: abs(found[name] - reference))
        rows.append(
            _row(
                f"{model}, c/a = {lam:g}, worst of 8: {worst}",
                found[worst],
                reference,
                RIGID_TOLERANCE if rigid else SOLID_TOLERANCE,
            )
        )
    return rows


def stiffness_of_the_container() -> list[Row]:
    """Solid stacks from f1/f_c = 7 up: the limit of what is claimed."""
    rows = []
    for modulus in (4.3e11, 8.5e11, 2.1e12):
        done = released(
            3.6364, SOLID | {"container.youngs_modulus_Pa": modulus, "solver.element_size_m": 0.1}
        )
        ratio = done.model.frequencies[0] / contact_frequency(
            done.model.container.mesh.mass, done.model.base_stiffness
        )
        rows.append(
            _row(f"solid stack, 20 modes, f1/f_c = {ratio:.1f}", _peaks(done), 0.8945, SOLID_TOLERANCE)
        )
    return rows


def penalty_limit() -> list[Row]:
    """The error of the rigid block's restitution falls with the penalty."""
    factors = (1.0 / 3.0, 1.0, 3.0, 9.0)
    found = [_peaks(released(4.0 / 1.1, stiffer=factor)) for factor in factors]
    exact = 1.0 - 1.5 / (1.0 + (4.0 / 1.1) ** 2)
    return [
        Row(
            case="rigid stack, penalty from a third to nine times the default",
            compared="velocity ratio at nine times; order in 1/penalty",
            value=found[-1],
            reference=exact,
            kind="analytic",
            source=HOUSNER,
            tolerance=RIGID_TOLERANCE,
            convergence=Convergence(
                against="default penalty/penalty",
                sizes=as_floats([1.0 / factor for factor in factors]),
                errors=as_floats([abs(value - exact) for value in found]),
                expected=1.0,
                tolerance=0.25,
            ),
        )
    ]


def _peaks(done: Finished) -> float:
    return float(done.track.restitution_by_peaks)


def _row(case: str, value: float, reference: float, tolerance: float) -> Row:
    return Row(
        case=case,
        compared="velocity ratio at the first impact",
        value=value,
        reference=reference,
        kind="analytic",
        source=HOUSNER,
        tolerance=tolerance,
    )


CHECKS = (
    Check(name="slendernesses", rows=slendernesses),
    Check(name="the error of a soft floor", rows=penalty_limit),
    Check(name="penalties, steps, meshes", rows=variations),
    Check(name="stiffness of the container", rows=stiffness_of_the_container),
)
