"""A stack of four boxes on coarse meshes, run with each model, for tests that hold the models together.

Coarse, so that the full model stays affordable: what is compared is the models on one mesh, not the mesh.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.case.case import Case, read_case
from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.results.history import History
from fem.run.recorder import Recorder
from fem.run.simulation import Ending, simulate

FloatArray = npt.NDArray[np.float64]

SLENDERNESS_ANGLE = math.atan(1.1 / 4.0)
CASE = f"""
schema = 1
[container]
width_m = 1.1
height_m = 1.0
boxes = 4
weight_N = 24525.0
section = "solid"
[support]
kind = "corners"
foot_m = 0.15
[contact]
mu_static = 1.0
[motion]
kind = "none"
[initial]
rotation_rad = {0.5 * SLENDERNESS_ANGLE!r}
[solver]
model = "reduced"
element_size_m = 0.55
duration_s = 2.4
[output]
history_s = 0.005
fields_s = 0.0
"""
SOLID: dict[str, Any] = {}
#: 20 mm of steel, two elements across a wall of 1 m: f1 is three times the contact frequency on corners
SHELL: dict[str, Any] = {"container.section": "shell", "container.wall_m": 0.02, "solver.element_size_m": 0.5}
#: the 8 mm of the shipped cases: f1 is the contact frequency
THIN_SHELL: dict[str, Any] = {
    "container.section": "shell",
    "container.wall_m": 0.008,
    "solver.element_size_m": 1.0,
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Finished:
    """A run and what it left."""

    model: Model
    history: History
    ending: Ending

    @property
    def time(self) -> FloatArray:
        return self.history["time_s"]

    @property
    def rotation_ratio(self) -> FloatArray:
        """Rotation over the slenderness angle at the samples (n,), signed."""
        return self.history["rotation_rad"] / self.model.static.slenderness_angle

    @property
    def first_impact(self) -> float:
        return float(self.model.run.track[0].first_impact)

    @property
    def velocity_ratio(self) -> float:
        """Of the first impact, from the heights of the mass centre at the peaks around it (rigid kinematics)."""
        angle = self.model.static.slenderness_angle
        rotation = self.history["rotation_rad"]
        released = float(abs(rotation[0]))
        peak = float(
            np.max(-np.sign(rotation[0]) * rotation)
        )  # on the other side, of at most two half cycles
        return math.sqrt(
            (math.cos(angle - peak) - math.cos(angle)) / (math.cos(angle - released) - math.cos(angle))
        )


def stack(**changes: Any) -> Case:
    """The case with dotted keys changed; `__` stands for the dot."""
    return read_case(CASE).with_values({key.replace("__", "."): value for key, value in changes.items()})


def run(case: Case, container: Container | None = None) -> Finished:
    """Step a case to its end; a run that fails its audit is an error of the test."""
    model = build_model(case, container)
    recorder = Recorder(model)
    ending = simulate(model, recorder)
    assert ending.status in ("completed", "overturned"), ending.error
    return Finished(model=model, history=recorder.history(), ending=ending)


def difference(one: Finished, other: Finished, *, until: float = math.inf) -> float:
    """Largest |difference| of rotation at common samples up to a time [s], over the slenderness angle."""
    count = min(len(one.history), len(other.history))
    apart = np.abs(one.rotation_ratio[:count] - other.rotation_ratio[:count])
    return float(apart[one.time[:count] < until].max())
