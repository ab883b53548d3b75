"""What moves a rigid body that rests on its floor: the bound below which it neither uplifts nor slips.

At an instant it keeps its place where a_h + g sin(slope) is below c (g cos(slope) + a_v), c being the tangent of its
slenderness angle or its static friction, whichever is smaller. A motion times a factor f therefore moves nothing
before f = g (c cos(slope) - sin(slope))/max(|a_h| - c a_v), with the maximum over time.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from contact.motion.base_motion import BaseMotion, NoMotion, TableMotion
from fem.case.case import Case
from fem.model.floor_numbers import floor_result
from fem.model.static_checks import StaticChecks
from fem.runtime.arrays import FloatArray
from mesh.container import ContainerMesh

#: of the factor at which it first moves: up to there the contact of a run, which gives way a little, moves nothing
KEPT = 0.9
#: tilt over the slenderness angle at which one side carries the weight, beyond which a slab gives way too much. At 0.89
#: of the factor, under pulses of 0.1 to 3 s, the stack of four turns by at most 0.0003 of its slenderness angle on
#: concrete (tilt 2e-5), 0.005 on asphalt (2e-4 to 6e-4), 0.04 on gravel (2e-3 to 3e-3)
SOFT = 1e-3


@dataclass(frozen=True, kw_only=True)
class BodyAtRest:
    """What keeps a container in its place."""

    gravity: float  #: [m/s2]
    slenderness: float  #: tangent of the slenderness angle, of the nearer corner
    slope: float  #: of the floor [rad]

    @classmethod
    def of(cls, case: Case, mesh: ContainerMesh, static: StaticChecks) -> Self | None:
        """That of one rigid body on corners; None of anything else, and where its floor gives way."""
        alone = case.bodies == 1 and not (case.links or case.neighbour or case.rolls)
        if case.solver.model != "rigid" or not alone:
            return None
        floor = floor_result(case, mesh, static)
        sinks = None if floor is None else floor.static_indentation_m
        if sinks is not None and 2.0 * sinks > SOFT * static.width * static.slenderness_angle:
            return None
        slenderness = math.tan(static.slenderness_angle)
        return cls(gravity=static.gravity, slenderness=slenderness, slope=static.slope)

    def moves_at(self, horizontal: FloatArray, upward: FloatArray | float, mu_static: float) -> float:
        """The factor on a motion (n,) at which the body first uplifts or slips; infinite where none does."""
        kept, pushing = self._pushed(horizontal, upward, mu_static)
        strongest = float(np.max(pushing))
        return kept / strongest if strongest > 0.0 else math.inf

    def quiet_from(
        self, times: FloatArray, horizontal: FloatArray, upward: FloatArray | float, mu_static: float
    ) -> float:
        """Time after which a motion, sampled at these times (n,), stays below `KEPT` of what moves the body [s]."""
        kept, pushing = self._pushed(horizontal, upward, mu_static)
        moving = np.flatnonzero(pushing >= KEPT * kept)
        return float(times[min(moving[-1] + 1, times.size - 1)]) if moving.size else 0.0

    def _pushed(
        self, horizontal: FloatArray, upward: FloatArray | float, mu_static: float
    ) -> tuple[float, FloatArray]:
        """What keeps the body in its place [m/s2], and what of a motion pushes it, shape (n,) [m/s2]."""
        least = min(self.slenderness, mu_static)
        kept = self.gravity * (least * math.cos(self.slope) - math.sin(self.slope))
        return max(kept, 0.0), np.abs(horizontal) - least * upward


def still_from(
    case: Case, mesh: ContainerMesh, static: StaticChecks, motion: BaseMotion, vertical: BaseMotion
) -> float:
    """Time from which on what is left of a record cannot move a container at rest [s]; infinite where not known."""
    if not isinstance(motion, TableMotion) or not isinstance(vertical, TableMotion | NoMotion):
        return math.inf
    body = BodyAtRest.of(case, mesh, static)
    if body is None:
        return math.inf
    times, horizontal, upward = motion.times, motion.accelerations, np.zeros(1)
    if isinstance(vertical, TableMotion):
        upward = vertical.accelerations
        if not np.array_equal(times, vertical.times):
            times = np.union1d(times, vertical.times)
            horizontal, upward = (component.evaluate(times)[2] for component in (motion, vertical))
    return body.quiet_from(times, horizontal, upward, case.contact.mu_static)
