"""The containers of a site as bodies: full and empty, in the elevations that are run, and what starts to move them.

A rigid body that neither uplifts nor slips under the whole motion need not be computed: the bound is that of
`fem.model.resting`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from fem.case.case import Case, CaseError
from fem.model.geometry import build_container
from fem.model.resting import KEPT, BodyAtRest
from fem.model.static_checks import static_checks_of
from fem.seismic.ground_motion import GroundMotion
from fem.site.request import EMPTY, SiteRequest
from fem.site.result import RunKey, SiteBody


def bodies_of(request: SiteRequest) -> tuple[SiteBody, ...]:
    """Every container that is run; raises as `body_of`."""
    return tuple(body_of(*name, case) for name, case in request.variants.items())


def body_of(mass: str, elevation: str, case: Case) -> SiteBody:
    """Mass, dimensions and rocking parameters of a container.

    Raises:
        CaseError, MeshError: it cannot be built.
    """
    try:
        mesh = build_container(case)
    except ValueError as error:
        if mass == EMPTY:
            raise CaseError(f"empty_mass_kg: {error}") from None
        raise
    static = static_checks_of(case, mesh, 0.0)
    return SiteBody(
        mass=mass,
        elevation=elevation,
        mass_kg=mesh.mass,
        centroid_m=static.centroid,
        inertia_kg_m2=static.inertia,
        support_width_m=static.width,
        width_m=case.container.width_m,
        height_m=case.container.total_height,
        depth_m=case.container.depth_m,
        gravity_m_s2=case.gravity_m_s2,
        slenderness_angle_rad=static.slenderness_angle,
        frequency_parameter_1_s=static.frequency_parameter,
        uplift_acceleration_m_s2=static.uplift_acceleration,
        housner_restitution=static.housner_restitution,
    )


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
        for name, variant in request.variants.items():
            case = variant.with_values({"solver.model": request.heading.model})
            mesh = build_container(case)
            if (body := BodyAtRest.of(case, mesh, static_checks_of(case, mesh, 0.0))) is not None:
                bodies[name] = body
        return cls(bodies=bodies, motions=motions)

    def moves_at(self, key: RunKey) -> float | None:
        """The factor on the motion of a run at which its body first moves; None where that is not known."""
        body, motion = self.bodies.get((key.mass, key.elevation)), self.motions.get(key.stem)
        if body is None or motion is None:
            return None
        what = key.mass, key.elevation, key.stem, key.vertical_sign, key.mu_static
        if what not in self.known:
            upward = 0.0 if motion.vertical is None else key.vertical_sign * motion.vertical
            self.known[what] = body.moves_at(motion.horizontal, upward, key.mu_static)
        return self.known[what]

    def used(self, key: RunKey) -> float | None:
        """The factor on the motion of a run over that at which its body first moves; None where that is not known."""
        factor = self.moves_at(key)
        return None if factor is None else key.factor / factor if factor > 0.0 else math.inf

    def at_rest(self, key: RunKey) -> bool:
        """Whether a run need not be computed."""
        used = self.used(key)
        return used is not None and used < KEPT
