"""A stack of four boxes on coarse meshes, for tests that compare the models with each other.

Coarse, so that the full model stays affordable: the models are compared on one mesh.
"""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from runs import STACK, Finished

from fem.case.case import Case

FloatArray = npt.NDArray[np.float64]

SLENDERNESS_ANGLE = math.atan(1.1 / 4.0)
CASE = STACK.with_values(
    {
        "container.height_m": 1.0,
        "container.boxes": 4,
        "container.weight_N": 24525.0,
        "support.foot_m": 0.15,
        "initial.rotation_rad": 0.5 * SLENDERNESS_ANGLE,
        "solver.model": "reduced",
        "solver.order": 2,
        "solver.element_size_m": 0.55,
        "solver.duration_s": 2.4,
    }
)
SECTIONS: dict[str, dict[str, Any]] = {
    "solid": {},
    # 20 mm of steel, two elements across a wall of 1 m: f1 is three times the contact frequency on corners
    "shell": {"container.section": "shell", "container.wall_m": 0.02, "solver.element_size_m": 0.5},
    # the 8 mm of the shipped cases: f1 is the contact frequency
    "thin shell": {"container.section": "shell", "container.wall_m": 0.008, "solver.element_size_m": 1.0},
}


def stack(section: str = "solid", **changes: Any) -> Case:
    """The stack of a section, with dotted keys changed; `__` in place of the dot."""
    changed = {key.replace("__", "."): value for key, value in changes.items()}
    return CASE.with_values(SECTIONS[section] | changed)


def times(run: Finished) -> FloatArray:
    """Of the samples [s]."""
    return run.history["time_s"]


def first_impact(run: Finished) -> float:
    """[s]"""
    return float(run.track.first_impact)


def velocity_ratio(run: Finished) -> float:
    """Of the first impact, from the heights of the mass centre at the peaks around it (rigid kinematics)."""
    rotation, angle = run.history["rotation_rad"], run.model.static.slenderness_angle
    released = abs(float(rotation[0]))
    peak = float(np.max(-np.sign(rotation[0]) * rotation))  # on the other side, of at most two half cycles
    return math.sqrt(
        (math.cos(angle - peak) - math.cos(angle)) / (math.cos(angle - released) - math.cos(angle))
    )


def difference(one: Finished, other: Finished, *, until: float = math.inf) -> float:
    """Largest |difference| of rotation at common samples up to a time [s], over the slenderness angle."""
    count = min(len(one.history.modes), len(other.history.modes))
    apart = np.abs(one.history["rotation_rad"][:count] - other.history["rotation_rad"][:count])
    return float(apart[times(one)[:count] < until].max()) / one.model.static.slenderness_angle
