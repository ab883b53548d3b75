"""The static rules that a run is compared with, and what follows from the mass alone.

Equilibrium of a rigid container on its corners, after sections 4 and 5 of Knoedel and Hrabowski, "A simple
stick-slip model for the overturning stability of unanchored containers" (the paper), with the lateral force
method of EN 1998-1:2004, 4.3.3.2. The container stands on z = 0; weights, forces and moments are magnitudes.
Angles are measured from the vertical: the `slenderness_angle` is the complement of the paper's alpha. Where the
mass centre is not above the middle of the base, the nearer corner counts.

A static rule may be compared with a run only under the floor acceleration of that run (`own_motion`). Where the floor
moves up and down as well, the same rule with the least weight m (g - a_v) stands beside it (`own_motion_vertical`).
The design base shear of the code (`code`, and `code_q1` with behaviour factor 1) is the amplified and
reduced response of an elastic building: another question, in rows of its own, where a case gives [static].
"""

import math
from dataclasses import dataclass, replace

from contact.reference.rigid_block import RigidBlock
from fem.case.case import Case, CaseError
from fem.case.tables.run_tables import StaticTable
from fem.case.validation import told_as
from fem.model.floor import pivot_share
from fem.results.run_result import ActionResult, CodeValues, StaticResult
from fem.runtime.units import finite
from fem.seismic.body import LooseBody, utilisation
from fem.seismic.wind import STABILISING, pressure_of, wind_rows
from mesh.container import ContainerMesh

LIMIT_PERIOD = 2.0  # s, EN 1998-1:2004, 4.3.3.2.1 (2) a), Eq. (4.4)
CREDIBLE_RESTITUTION = 0.5
ROUNDING = 1e-9  #: of the width, within which the mass centre is above the middle of the base
CLAUSE_APPLICABLE = "EN 1998-1:2004, 4.3.3.2.1 (2)"
CLAUSE_SLIDING = "EN 1998-1:2004, 4.4.2.4 (1)P, sliding"
CLAUSE_OVERTURNING = "EN 1998-1:2004, 4.4.2.4 (1)P, overturning"


@dataclass(frozen=True, kw_only=True)
class CheckResult:
    """Demand against capacity in one unit, under one clause."""

    demand: float
    capacity: float
    unit: str
    clause: str

    @property
    def utilisation(self) -> float:
        """See `fem.seismic.body.utilisation`."""
        return utilisation(self.demand, self.capacity)

    @property
    def passed(self) -> bool:
        """Whether the demand is at most the capacity."""
        return self.demand <= self.capacity


def slenderness_angle(*, width: float, centroid: float) -> float:
    """Angle between the vertical and the line from a corner to the mass centre [rad].

    Housner, Bull. Seism. Soc. Am. 53 (1963) 403; pi/2 minus the paper's alpha (section 2).
    """
    return math.atan2(0.5 * width, centroid)


def period_eq2(*, width: float, radius: float, gravity: float, initial_rotation: float) -> float:
    """Rocking period of a point mass, T = 8 sqrt(phi_0 r^2/(a g)) [s]. Paper, Eq. (2), after Klotter.

    It depends on the rotation phi_0 [rad] from which the block is released; the sign plays no part.
    """
    return 8.0 * math.sqrt(abs(initial_rotation) * radius**2 / (width * gravity))


def period_eq3(*, radius: float, gravity: float) -> float:
    """Period of a hanging bar of length 2 r, T = 2 pi sqrt(4 r/(3 g)) [s]. Paper, Eq. (3)."""
    return 2.0 * math.pi * math.sqrt(4.0 * radius / (3.0 * gravity))


def plateau_base_shear(
    *,
    mass: float,
    ground_acceleration: float,
    soil_factor: float,
    behaviour_factor: float,
    importance_factor: float,
) -> float:
    """Base shear on the plateau of the design spectrum, m gamma_I a_gR S 2.5/q [N].

    EN 1998-1:2004, 4.3.3.2.2 (1)P with 3.2.2.5 (4)P, Eqs. (4.5) and (3.14), lambda = 1; a_g = gamma_I
    a_gR by 3.2.1 (3). Paper, Eq. (17). Accelerations in m/s2, mass in kg.
    """
    return mass * importance_factor * ground_acceleration * soil_factor * 2.5 / behaviour_factor


@dataclass(frozen=True, kw_only=True)
class ActionCheck:
    """The static rule under one action."""

    sliding: CheckResult  #: base shear against static friction [N]
    overturning: CheckResult  #: tilting against restoring moment [Nm]
    least_weight: float | None = None  #: in place of the weight, under a vertical motion [N]

    def to_result(self) -> ActionResult:
        """Demands and utilisations; a utilisation without capacity is None."""
        return ActionResult(
            base_shear_N=self.sliding.demand,
            tilting_moment_Nm=self.overturning.demand,
            utilisation_sliding=finite(self.sliding.utilisation),
            utilisation_overturning=finite(self.overturning.utilisation),
            least_weight_N=self.least_weight,
        )


@dataclass(frozen=True, kw_only=True)
class CodeChecks:
    """The lateral force method with the values of a case."""

    values: StaticTable
    as_given: ActionCheck  #: under the code's base shear
    q1: ActionCheck  #: under the code's base shear with behaviour factor 1
    applicability: CheckResult  #: of the method: period against min(4 T_C, 2.0 s) [s]


@dataclass(frozen=True, kw_only=True)
class StaticChecks:
    """Results of the static rules for one container, and what follows from its mass alone."""

    width: float  #: between the points about which it turns [m]
    weight: float  #: G, of all boxes with fill [N]
    gravity: float  #: g [m/s2]
    centroid: float  #: z_c, height of the mass centre above the floor [m]
    inertia: float  #: I, polar in the plane about the mass centre [kg m2]
    radius: float  #: R, corner to mass centre [m]. Paper, section 2
    slenderness_angle: float  #: al, from the vertical [rad]
    frequency_parameter: float  #: sqrt(M g R/I_O), I_O = I + M R^2 about the corner [1/s]. Housner (1963)
    period_eq2: float  #: of a point mass, at the initial rotation or half the slenderness angle [s]
    period_eq3: float  #: of a hanging bar [s]
    sliding_limit_static: float  #: mu_static G cos(slope) [N]. Paper, Eq. (8)
    sliding_limit_kinetic: float  #: mu_kinetic G cos(slope) [N]. Paper, Eq. (11)
    #: of the weight about a corner before it turns, G cos(slope) a/2 [Nm]. Paper, Eq. (10)
    restoring_moment: float
    #: of the floor, uphill on a slope: g tan(al - slope), horizontally [m/s2]. Paper, Eqs. (9) and (10); West (1885)
    uplift_acceleration: float
    slip_acceleration: float  #: of the floor, at which it slips [m/s2]
    #: ratio of the angular velocities after and before an impact, 1 - (M R^2/I_O)(1 - cos 2 al) [-]; angular momentum
    #: about the new corner is kept, Housner (1963). Negative for a squat block: it would not rise on the other corner
    housner_restitution: float
    own_motion: ActionCheck  #: under the peak floor acceleration of this run
    #: the same, with the weight m (g - a_v) under the largest vertical acceleration; None where there is none
    own_motion_vertical: ActionCheck | None
    peak_vertical_acceleration: float | None  #: of the floor in this run [m/s2]
    by_code: CodeChecks | None  #: None where the case has no [static]
    slope: float = 0.0  #: size of the angle of the floor with the horizontal [rad]
    #: on a level floor, with 0.9 of the weight; None where the case has no [wind]
    wind: ActionCheck | None = None

    @property
    def overturning_energy(self) -> float:
        """What it takes to turn it onto its corner without haste, G R (1 - cos al) [J]."""
        return self.weight * self.radius * (1.0 - math.cos(self.slenderness_angle))

    @property
    def code(self) -> ActionCheck:
        """Under the code's base shear; raises ValueError where the case has no [static]."""
        if self.by_code is None:
            raise ValueError("the case has no table [static]")
        return self.by_code.as_given

    @property
    def downhill(self) -> float:
        """Of the weight along the floor, g sin(slope): it adds to the acceleration of the floor [m/s2]."""
        return self.gravity * math.sin(self.slope)

    @property
    def ruling(self) -> ActionCheck:
        """What a run is compared with: the rule that takes its vertical motion into account, where it has one."""
        return self.own_motion_vertical or self.own_motion

    @property
    def housner_credible(self) -> bool:
        """Whether the impact model of the rigid block is credible: a restitution of at least 0.5."""
        return self.housner_restitution >= CREDIBLE_RESTITUTION

    def to_result(self) -> StaticResult:
        """The checks as the result of a run holds them."""
        upward, peak = self.own_motion_vertical, self.peak_vertical_acceleration or 0.0
        result = StaticResult(
            weight_N=self.weight,
            centroid_m=self.centroid,
            inertia_kg_m2=self.inertia,
            slenderness_angle_rad=self.slenderness_angle,
            frequency_parameter_1_s=self.frequency_parameter,
            period_eq2_s=self.period_eq2,
            period_eq3_s=self.period_eq3,
            sliding_limit_static_N=self.sliding_limit_static,
            sliding_limit_kinetic_N=self.sliding_limit_kinetic,
            restoring_moment_Nm=self.restoring_moment,
            uplift_acceleration_m_s2=self.uplift_acceleration,
            housner_restitution=self.housner_restitution,
            housner_credible=self.housner_credible,
            own_motion=self.own_motion.to_result(),
            own_motion_vertical=None
            if upward is None
            else replace(
                upward.to_result(), utilisation_lifting=peak / (self.gravity * math.cos(self.slope))
            ),
            downhill_m_s2=self.downhill or None,
            wind=None if self.wind is None else self.wind.to_result(),
        )
        if self.by_code is None:
            return result
        return replace(
            result,
            code=self.by_code.as_given.to_result(),
            code_q1=self.by_code.q1.to_result(),
            method_applicable=self.by_code.applicability.passed,
            clause=self.by_code.applicability.clause,
            period_limit_s=self.by_code.applicability.capacity,
            code_values=CodeValues(**self.by_code.values.model_dump()),
        )


def static_checks(
    *,
    mass: float,
    centroid: float,
    inertia: float,
    width: float,
    beside: float = 0.0,
    gravity: float,
    mu_static: float,
    mu_kinetic: float,
    peak_floor_acceleration: float,
    peak_vertical_acceleration: float | None = None,
    code: StaticTable | None = None,
    initial_rotation: float = 0.0,
    slope: float = 0.0,
    horizontal: bool = False,
) -> StaticChecks:
    """All static checks of one container under one motion.

    Args:
        mass: M of all boxes with fill [kg].
        centroid: z_c above the floor [m]; inertia: polar about the mass centre [kg m2].
        width: a, of the base between the points about which it turns [m].
        beside: distance of the mass centre from the middle of the base, to either side [m]. All values are those of
            the nearer corner, about which it tilts first; the restitution is that of the impact there.
        peak_floor_acceleration, peak_vertical_acceleration: largest of the floor in this run [m/s2]; None: it has none.
        code: values of the lateral force method; None: it is left out.
        initial_rotation: phi_0 of Eq. (2) [rad]; where it is 0, half the slenderness angle is taken, as an
            ordinary rotation of a rocking container.
        slope: of the floor [rad]. The rule under the run's own peak takes the motion uphill, to which the weight adds
            its part along the floor; the code's rows are those of a level floor.
        horizontal: the floor's acceleration is, and not along the slope: uphill it takes weight off the floor.

    The rocking period that is compared with the limit of the lateral force method is that of Eq. (3), as
    in the paper's section 4.2.
    """
    nearer = 0.5 * width - beside  # corner to mass centre, along x
    weight, arm = mass * gravity, math.hypot(nearer, centroid)
    angle = slenderness_angle(width=2.0 * nearer, centroid=centroid)
    about_corner = inertia + mass * arm**2
    friction, restoring = mu_static * weight, weight * nearer
    period = period_eq3(radius=arm, gravity=gravity)
    slope = abs(slope)
    toward, downhill = math.cos(slope), gravity * math.sin(slope)
    lean = math.sin(slope) if horizontal else 0.0

    def moves_from(tangent: float) -> float:
        """The acceleration of the floor at which what holds with this tangent no longer does [m/s2]."""
        return (toward * gravity * tangent - downhill) / ((toward if horizontal else 1.0) + lean * tangent)

    def under(base_shear: float, least_weight: float | None = None, share: float = 1.0) -> ActionCheck:
        moment = base_shear * centroid  # paper, Eq. (9)
        share = share if least_weight is None else least_weight / weight
        return ActionCheck(
            sliding=CheckResult(
                demand=base_shear, capacity=share * friction, unit="N", clause=CLAUSE_SLIDING
            ),
            overturning=CheckResult(
                demand=moment, capacity=share * restoring, unit="Nm", clause=CLAUSE_OVERTURNING
            ),
            least_weight=least_weight,
        )

    by_code = None
    if code is not None:
        as_given, q1 = (
            under(
                plateau_base_shear(
                    mass=mass,
                    ground_acceleration=code.ground_acceleration_m_s2,
                    soil_factor=code.soil_factor,
                    behaviour_factor=factor,
                    importance_factor=code.importance_factor,
                )
            )
            for factor in (code.behaviour_factor, 1.0)
        )
        limit = min(4.0 * code.corner_period_s, LIMIT_PERIOD)
        applicability = CheckResult(demand=period, capacity=limit, unit="s", clause=CLAUSE_APPLICABLE)
        by_code = CodeChecks(values=code, as_given=as_given, q1=q1, applicability=applicability)
    return StaticChecks(
        width=width,
        weight=weight,
        gravity=gravity,
        centroid=centroid,
        inertia=inertia,
        radius=arm,
        slenderness_angle=angle,
        frequency_parameter=math.sqrt(mass * gravity * arm / about_corner),
        period_eq2=period_eq2(
            width=2.0 * nearer, radius=arm, gravity=gravity, initial_rotation=initial_rotation or 0.5 * angle
        ),
        period_eq3=period,
        sliding_limit_static=toward * friction,
        sliding_limit_kinetic=toward * mu_kinetic * weight,
        restoring_moment=toward * restoring,
        uplift_acceleration=moves_from(math.tan(angle)),
        slip_acceleration=moves_from(mu_static),
        # Of the same angular momentum: 1 - M nearer width/I_O; the last factor is 1 with the mass centre in the middle.
        housner_restitution=1.0
        - mass * arm**2 / about_corner * (1.0 - math.cos(2.0 * angle)) * (width / (2.0 * nearer)),
        own_motion=under(mass * (peak_floor_acceleration + downhill), share=toward),
        own_motion_vertical=None
        if peak_vertical_acceleration is None
        else under(
            mass * (peak_floor_acceleration + downhill),
            mass * max(toward * gravity - peak_vertical_acceleration, 0.0),
        ),
        peak_vertical_acceleration=peak_vertical_acceleration,
        by_code=by_code,
        slope=slope,
    )


def static_checks_of(
    case: Case,
    mesh: ContainerMesh,
    peak_floor_acceleration: float,
    peak_vertical_acceleration: float | None = None,
) -> StaticChecks:
    """Static checks of a case's container on its mesh, under the peak accelerations of its own floor [m/s2]."""
    static = static_checks(
        mass=mesh.mass,
        centroid=mesh.centroid[1],
        inertia=mesh.inertia,
        width=pivot_share(case, mesh) * mesh.width,
        beside=distance_beside(mesh),
        gravity=case.gravity_m_s2,
        mu_static=case.contact.mu_static,
        mu_kinetic=case.contact.mu_kinetic,
        peak_floor_acceleration=peak_floor_acceleration,
        peak_vertical_acceleration=peak_vertical_acceleration,
        code=case.static,
        initial_rotation=case.initial.rotation_rad,
        slope=case.floor.slope,
        horizontal=case.floor.turn != 0.0,
    )
    held = case.links or case.neighbour or case.initial.rotation_rad or distance_beside(mesh)
    if case.floor.slope and not held and static.uplift_acceleration <= 0.0:
        raise CaseError(
            f"[floor] slope_percent = {case.floor.slope_percent:g}: nothing stands there: the mass centre is beyond "
            f"the lower edge from {100.0 * math.tan(static.slenderness_angle):.3g} % on"
        )
    return static if case.wind is None else replace(static, wind=wind_check(case, mesh, static))


def wind_check(case: Case, mesh: ContainerMesh, static: StaticChecks) -> ActionCheck:
    """Sliding and overturning of a container as it is under its [wind].

    CaseError: it is higher than the rule or the pressure holds for.
    """
    half, height = static.radius * math.sin(static.slenderness_angle), static.centroid
    body = LooseBody(
        block=RigidBlock(
            half_width=half,
            centroid_height=height,
            gravity=static.gravity,
            inertia_ratio=1.0 + static.inertia / (mesh.mass * static.radius**2),
        ),
        width=mesh.width,
        height=mesh.height,
        depth=case.container.depth_m,
        mass=mesh.mass,
        mu_static=case.contact.mu_static,
        mu_kinetic=case.contact.mu_kinetic,
        round=case.container.is_round,
    )
    with told_as("[wind] ", "; leave the table out"):
        pressure, _ = pressure_of(case.wind, mesh.height)
        tilts, slides = wind_rows(body, pressure, gamma_mu=case.wind.gamma_mu if case.wind else 1.0)
    overturning, sliding = (
        CheckResult(
            demand=row.demand, capacity=row.capacity, unit=row.unit.replace(" ", ""), clause=row.source
        )
        for row in (tilts, slides)
    )
    return ActionCheck(sliding=sliding, overturning=overturning, least_weight=STABILISING * static.weight)


def distance_beside(mesh: ContainerMesh) -> float:
    """Distance of the mass centre from the middle of the base [m]; 0 within rounding."""
    beside = abs(mesh.centroid[0])
    return beside if beside > ROUNDING * mesh.width else 0.0
