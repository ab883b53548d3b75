"""Runs that need not be computed: a rigid body that neither uplifts nor slips under the whole motion.

At an instant a rigid body keeps its place where a_h + g sin(slope) is below c (g cos(slope) + a_v), c being the tangent
of its slenderness angle or its static friction, whichever is smaller. A motion times a factor f therefore moves nothing
before f = g (c cos(slope) - sin(slope))/max(|a_h| - c a_v), with the maximum over time.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from fem.case.case import Case
from fem.model.floor_numbers import floor_result
from fem.model.geometry import build_container
from fem.model.static_checks import StaticChecks, static_checks_of
from fem.seismic.ground_motion import GroundMotion
from fem.site_check.file import SiteRequest
from fem.site_check.runs import RunKey
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

    def moves_at(self, motion: GroundMotion, sign: int, mu_static: float) -> float:
        """The factor on a motion at which the body first uplifts or slips; infinite where none does."""
        least = min(self.slenderness, mu_static)
        kept = self.gravity * (least * math.cos(self.slope) - math.sin(self.slope))
        lifted = 0.0 if motion.vertical is None else sign * motion.vertical
        strongest = float(np.max(np.abs(motion.horizontal) - least * lifted))
        return max(kept, 0.0) / strongest if strongest > 0.0 else math.inf


def gives_way(case: Case, mesh: ContainerMesh, static: StaticChecks) -> bool:
    """Whether a container tilts on a slab by more than `SOFT` before a side of it lifts off."""
    floor = floor_result(case, mesh, static)
    sinks = None if floor is None else floor.static_indentation_m
    return sinks is not None and 2.0 * sinks > SOFT * static.width * static.slenderness_angle


@dataclass(frozen=True, kw_only=True, eq=False)
class Screening:
    """Which runs of a request are at rest without being computed."""

    #: by weight and elevation; none of a container that rolls on a cambered base, that is not run as a rigid one, or
    #: below which the floor gives way
    bodies: Mapping[tuple[str, str], BodyAtRest]
    motions: dict[str, GroundMotion]  #: by the stems of their files
    known: dict[tuple[str, str, str, int, float], float] = field(default_factory=dict)

    @classmethod
    def of(cls, request: SiteRequest, motions: dict[str, GroundMotion]) -> Self:
        """For the containers of a request.

        Raises:
            CaseError, MeshError: one cannot be built.
        """
        bodies = {}
        for one in request.variants:
            if request.heading.model != "rigid" or one.case.support.rolls:
                continue
            mesh = build_container(one.case)
            static = static_checks_of(one.case, mesh, 0.0)
            if gives_way(one.case, mesh, static):
                continue
            bodies[one.mass, one.elevation] = BodyAtRest(
                gravity=static.gravity,
                slenderness=math.tan(static.slenderness_angle),
                slope=static.slope,
            )
        return cls(bodies=bodies, motions=motions)

    def moves_at(self, key: RunKey) -> float | None:
        """The factor on the motion of a run at which its body first moves; None where that is not known."""
        body, motion = self.bodies.get((key.mass, key.elevation)), self.motions.get(key.stem)
        if body is None or motion is None:
            return None
        what = key.mass, key.elevation, key.stem, key.vertical_sign, key.mu_static
        if what not in self.known:
            self.known[what] = body.moves_at(motion, key.vertical_sign, key.mu_static)
        return self.known[what]

    def used(self, key: RunKey) -> float | None:
        """The factor on the motion of a run over that at which its body first moves; None where that is not known."""
        factor = self.moves_at(key)
        return None if factor is None else key.factor / factor if factor > 0.0 else math.inf

    def at_rest(self, key: RunKey) -> bool:
        """Whether a run need not be computed."""
        used = self.used(key)
        return used is not None and used < KEPT
