"""Runs that need not be computed: a rigid body that neither uplifts nor slips under the whole motion.

The bound is that of `fem.model.resting`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from fem.model.geometry import build_container
from fem.model.resting import KEPT, BodyAtRest
from fem.model.static_checks import static_checks_of
from fem.seismic.ground_motion import GroundMotion
from fem.site_check.file import SiteRequest
from fem.site_check.runs import RunKey


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
        for variant in request.variants:
            case = variant.case.with_values({"solver.model": request.heading.model})
            mesh = build_container(case)
            body = BodyAtRest.of(case, mesh, static_checks_of(case, mesh, 0.0))
            if body is not None:
                bodies[variant.mass, variant.elevation] = body
        return cls(bodies=bodies, motions=motions)

    def moves_at(self, key: RunKey) -> float | None:
        """The factor on the motion of a run at which its body first moves; None where that is not known."""
        body, motion = self.bodies.get((key.mass, key.elevation)), self.motions.get(key.stem)
        if body is None or motion is None:
            return None
        what = key.mass, key.elevation, key.stem, key.vertical_sign, key.mu_static
        if what not in self.known:
            self.known[what] = moves_at(body, motion, key.vertical_sign, key.mu_static)
        return self.known[what]

    def used(self, key: RunKey) -> float | None:
        """The factor on the motion of a run over that at which its body first moves; None where that is not known."""
        factor = self.moves_at(key)
        return None if factor is None else key.factor / factor if factor > 0.0 else math.inf

    def at_rest(self, key: RunKey) -> bool:
        """Whether a run need not be computed."""
        used = self.used(key)
        return used is not None and used < KEPT


def moves_at(body: BodyAtRest, motion: GroundMotion, sign: int, mu_static: float) -> float:
    """The factor on a motion, with this sign of its vertical, at which a body first moves; infinite where none does."""
    upward = 0.0 if motion.vertical is None else sign * motion.vertical
    return body.moves_at(motion.horizontal, upward, mu_static)
