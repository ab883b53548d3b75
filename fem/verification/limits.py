"""Limits: rigid container, stiff floor, many modes, full model; and the seed's stack under its floor motions.

The event-driven references share no code with the stepping. Tilts and slips of a container that ought to rest are
those of its springs.
"""

import math
from typing import Any

import numpy as np

from contact.reference.floor_acceleration import still_floor
from contact.reference.rocking import simulate_rocking
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.verification.rows import Check, Convergence, Row, as_floats
from fem.verification.runs import SOLID, STACK, Finished, run

SLENDERNESS = math.atan2(1.1, 4.0)
RELEASED = {"initial.rotation_rad": 0.5 * SLENDERNESS, "solver.duration_s": 0.65, "output.history_s": 0.01}
SHELL = SOLID | {"container.wall_m": 0.008, "container.section": "shell"}


def rigid_container() -> list[Row]:
    """The stiffer the container on the same floor, the nearer to the rigid model: like 1/E."""
    penalty = build_model(STACK.with_values(RELEASED)).penalty
    keys = RELEASED | {"contact.normal_penalty_Pa_m": penalty, "solver.step_s": 5e-4}
    rigid = run(STACK, keys).history["rotation_rad"]
    moduli = (1e10, 3e10, 1e11, 3e11)
    errors = [
        _largest(
            run(STACK, keys | SOLID | {"container.youngs_modulus_Pa": e}).history["rotation_rad"] - rigid
        )
        for e in moduli
    ]
    return [
        Row(
            case="solid stack, 20 modes, let go from 0.5 al, up to the impact",
            compared="rotation, largest difference to the rigid model over al, at E = 3e11 Pa; order in 1/E",
            value=errors[-1],
            reference=0.0,
            kind="computed",
            source="rigid model on the same floor",
            tolerance=1e-4,
            convergence=Convergence(
                against="1/E [1/Pa]",
                sizes=as_floats([1.0 / e for e in moduli]),
                errors=as_floats(errors),
                expected=1.0,
                tolerance=0.15,
            ),
        )
    ]


def stiff_floor() -> list[Row]:
    """The stiffer the floor, the nearer the rigid model to the analytic block: like 1/penalty."""
    factors = (0.1, 0.3, 1.0, 3.0)
    default = build_model(STACK).penalty
    errors = []
    for factor in factors:
        keys = RELEASED | {"contact.normal_penalty_Pa_m": factor * default, "solver.step_s": 5e-4}
        done = run(STACK, keys)
        exact = simulate_rocking(
            done.block, still_floor(), duration=0.66, rotation=0.5 * SLENDERNESS, stop_at_impact=True
        )
        errors.append(_largest(done.history["rotation_rad"] - exact.at(done.history["time_s"])[0]))
    return [
        Row(
            case="rigid stack let go from 0.5 al, up to the impact",
            compared="rotation, largest difference to the analytic block over al, at 3 x the default penalty",
            value=errors[-1],
            reference=0.0,
            kind="computed",
            source="event-driven block",
            tolerance=1e-4,
            convergence=Convergence(
                against="default penalty/penalty",
                sizes=as_floats([1.0 / factor for factor in factors]),
                errors=as_floats(errors),
                expected=1.0,
                tolerance=0.25,
            ),
        )
    ]


def many_modes() -> list[Row]:
    """A shell through its first impact, the more elastic modes the nearer to very many."""
    counts = (0, 4, 8, 16, 32, 64)
    keys = SHELL | RELEASED | {"solver.step_s": 2.5e-4, "solver.duration_s": 1.3}
    reference, *found = (
        run(STACK, keys | {"solver.elastic_modes": count}).history["rotation_rad"] for count in (160, *counts)
    )
    errors = [_largest(rotation - reference) for rotation in found]
    return [
        Row(
            case="shell stack of 8 mm let go from 0.5 al, through its first impact, 64 modes",
            compared="rotation, largest difference to 160 modes over al; order in 1/(modes + 4)",
            value=errors[-1],
            reference=0.0,
            kind="computed",
            source="160 modes",
            tolerance=1e-3,
            convergence=Convergence(
                against="1/(modes + the 4 attachment modes)",
                sizes=as_floats([1.0 / (count + 4) for count in counts]),
                errors=as_floats(errors),
                expected=1.0,
                tolerance=0.2,
                at_least=True,
            ),
        )
    ]


def full_model() -> list[Row]:
    """Every node free to move: first impact and velocity ratio, against the exact ones and the reduced model."""
    keys = {
        "initial.rotation_rad": 0.5 * SLENDERNESS,
        "container.youngs_modulus_Pa": 2.1e12,
        "solver.duration_s": 1.75,
        "solver.element_size_m": 0.5,
        "solver.order": 2,
    }
    full, reduced = (run(STACK, keys | {"solver.model": model}) for model in ("full", "reduced"))
    before = full.history["time_s"] < 0.69
    difference = full.history["rotation_rad"] - reduced.history["rotation_rad"]
    case = "stiff solid stack, full model, from 0.5 al"
    return [
        Row(
            case=case,
            compared="first impact [s]",
            value=float(full.track.first_impact),
            reference=0.700737,
            kind="analytic",
            source="quarter period, exact",
            tolerance=3e-3,
            relative=True,
        ),
        Row(
            case=case,
            compared="velocity ratio at the first impact",
            value=_peaks(full),
            reference=0.8945,
            kind="analytic",
            source="Housner 1963",
            tolerance=1e-2,
        ),
        Row(
            case=case,
            compared="velocity ratio less that of the reduced model",
            value=_peaks(full) - _peaks(reduced),
            reference=0.0,
            kind="computed",
            source="reduced model, 20 modes",
            tolerance=1e-2,
        ),
        Row(
            case=case,
            compared="rotation before the impact, largest difference to the reduced model over al",
            value=_largest(difference[before]),
            reference=0.0,
            kind="computed",
            source="reduced model, 20 modes",
            tolerance=1e-3,
        ),
    ]


def stated_motion() -> list[Row]:
    """The stack under 50 mm at 6.928 rad/s, below uplift: it stays at rest for ten cycles."""
    rows = []
    models: dict[str, dict[str, Any]] = {
        "rigid": {},
        "solid, 20 modes": SOLID,
        "shell of 8 mm, 20 modes": SHELL,
    }
    for name, values in models.items():
        done = run(
            STACK,
            _floor(0.05, 6.928)
            | {"contact.mu_static": 0.4, "contact.mu_kinetic": 0.2, "solver.duration_s": 9.07}
            | values,
        )
        for compared, value, limit in (
            ("largest slip [m]", float(done.track.max_slip), 1e-5),
            ("largest tilt [rad]", float(done.track.max_rotation), 1e-4),
        ):
            rows.append(
                Row(
                    case=f"stack ({name}) under 50 mm at 6.928 rad/s, mu 0.4/0.2",
                    compared=compared,
                    value=value,
                    reference=0.0,
                    kind="analytic",
                    source="2.40 < 2.698 (uplift) < 3.924 m/s2 (slip)",
                    tolerance=limit,
                )
            )
    return rows


def plateau() -> list[Row]:
    """The stack at the plateau's 4.0 m/s2: rocks without slip and stands, at three penalties."""
    default = build_model(STACK).penalty
    rows = []
    for factor in (1.0 / 3.0, 1.0, 3.0):
        done = run(
            STACK,
            _floor(4.0 / 6.928**2, 6.928)
            | {
                "contact.mu_static": 0.4,
                "contact.mu_kinetic": 0.2,
                "contact.normal_penalty_Pa_m": factor * default,
                "solver.duration_s": 8.0,
            },
        )
        case = f"rigid stack, peak 4.0 m/s2 at 6.928 rad/s, mu 0.4/0.2, penalty x {factor:.3g}"
        rows.append(
            Row(
                case=case,
                compared="largest rotation in 8 s over al",
                value=float(done.track.max_rotation) / SLENDERNESS,
                reference=0.399,
                kind="computed",
                source="event-driven planar block; 0.38 to 0.43 for e of 0.85 to 0.96",
                tolerance=0.01,
            )
        )
        rows.append(
            Row(
                case=case,
                compared="rocks without slip and stands (1)",
                value=float(done.outcome == "rock" and done.status == "completed"),
                reference=1.0,
                kind="computed",
                source="event-driven planar block",
                tolerance=0.0,
                note=f"slip {1e6 * float(done.track.max_slip):.3g} um",
            )
        )
    return rows


def jerk() -> list[Row]:
    """The floor starts with a jerk under a stack at rest, mu 0.4/0.4."""
    rows = []
    for omega, reference in ((6.93, 0.2505), (6.928, 0.25040)):
        done = run(
            STACK,
            _floor(0.05, omega)
            | {"contact.mu_static": 0.4, "motion.start": "rest", "solver.duration_s": 20.0},
        )
        rows.append(
            Row(
                case=f"rigid stack at rest, 50 mm at {omega} rad/s from t = 0, mu 0.4/0.4",
                compared="largest rotation over al",
                value=float(done.track.max_rotation) / SLENDERNESS,
                reference=reference,
                kind="computed",
                source="event-driven planar block",
                tolerance=0.01,
                relative=True,
                note="0.2505 belongs to 6.93 rad/s" if omega == 6.93 else "",
            )
        )
    return rows


def slide_rocking() -> list[Row]:
    """The stack under 0.1 m at 8 rad/s on friction 0.3: it rocks and slides."""
    done = run(STACK, _floor(0.1, 8.0) | {"contact.mu_static": 0.3, "solver.duration_s": 2.5})
    case = "rigid stack, A = 0.1 m, Omega = 8 rad/s, mu 0.3"
    return [
        Row(
            case=case,
            compared="largest rotation [rad]",
            value=float(done.track.max_rotation),
            reference=0.100303,
            kind="computed",
            source="event-driven planar block",
            tolerance=0.02,
            relative=True,
            note="the second turning point, -0.100303 rad at 0.986 s; the first is 0.0355 rad",
        ),
        Row(
            case=case,
            compared="slip after 2.5 s [m]",
            value=float(done.history["slip_m"][-1]),
            reference=81.1e-3,
            kind="computed",
            source="event-driven planar block",
            tolerance=0.02,
            relative=True,
        ),
    ]


def _floor(amplitude: float, omega: float) -> dict[str, Any]:
    return {
        "motion.kind": "harmonic",
        "motion.amplitude_m": amplitude,
        "motion.angular_frequency_rad_s": omega,
    }


def _largest(difference: FloatArray) -> float:
    return float(np.abs(difference).max()) / SLENDERNESS


def _peaks(done: Finished) -> float:
    return float(done.track.restitution_by_peaks)


CHECKS = (
    Check(name="limit of a rigid container", rows=rigid_container),
    Check(name="limit of a stiff floor", rows=stiff_floor),
    Check(name="limit of many modes", rows=many_modes),
    Check(name="rest under the stated motion", rows=stated_motion),
    Check(name="the plateau's acceleration", rows=plateau),
    Check(name="a floor that starts with a jerk", rows=jerk),
    Check(name="slide-rocking", rows=slide_rocking),
    Check(name="full model", rows=full_model, quick=False),
)
