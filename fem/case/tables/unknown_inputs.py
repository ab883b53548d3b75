"""The inputs that a case may not know, and their table [uncertainty]: where each stands, when it matters, its range.

Where the case says nothing in its table [uncertainty], a range follows the case: static friction, and how far and in
which way friction falls from it; the mass centre, the width on which the base bears, the slope of the floor; the
stiffness of a rigid floor within a factor of nine downwards (the point of a corner) and three upwards (a casting),
stiffness and strength of a slab and damping within a factor of two either way; what of a base touches, where nobody
said that it has feet or castings; and a harmonic motion begins in one of several ways. `../keys.md` has the sources.

Friction between loose boxes is not that of the floor: other surfaces meet there. Where [joints] does not give it, a
case takes the floor's, and the joints have ranges of their own: `mu_static` within a factor of two unless it is given,
its fall as on the floor.
"""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any, Literal

from pydantic import Field, Strict

from contact.reference.rigid_block import RigidBlock
from fem.case.tables import input_ranges as keys
from fem.case.tables import quantities as q
from fem.case.tables.boxes import least_weakening
from fem.case.tables.duration import longest_time
from fem.case.tables.input_ranges import (
    HELD,
    Ends,
    InputRange,
    UnknownChoice,
    UnknownNumber,
    Value,
    own_value,
    short,
)
from fem.case.tables.motion_tables import LEAST_RAMP
from fem.case.tables.problem import refused
from fem.case.tables.table import CaseTable, case_key, optional_key

SOFTEST, STIFFEST = 1.0 / 9.0, 3.0  #: contact stiffness over that of the case
DAMPING = (0.5, 2.0)  #: contact and material damping over those of the case
FILL_DAMPINGS = (0.25, 2.5)  #: damping of the fill over that of the case: 0.05 to 0.5 of a granular one
SLAB = (0.5, 2.0)  #: Young's modulus and bearing strength of a slab over those of the case
JOINTS = (0.5, 2.0)  #: static friction between loose boxes over that of the case, where this has the floor's
JOINTS_DASHPOTS = (0.1, 2.0)  #: damping ratio between loose boxes, as far as the case has none beyond
STATIC = (0.9, 1.1)  #: static friction over that of the case
LEAST_KINETIC = 0.5  #: kinetic friction over the static, at least
CENTROID = (0.98, 1.02)  #: height of the mass centre over that of the case
THIRDS = (1.0 / 3.0 + 1e-9, 2.0 / 3.0 - 1e-9)  #: of the height of a solid box
BESIDE = 0.01  #: of the mass centre from the axis, over the width
EFFECTIVE_WIDTH = 0.97  #: over that of the case, at least
SLOPE_PERCENT = 0.5  #: more or less than that of the case
CAMBERS = (0.5, 2.0)  #: camber of a base over that of the case
#: camber of a base that is given as level: no base and no floor is [m]; a share of it is tried, too
LEVEL_CAMBER_M, BETWEEN_CAMBERS = 0.002, 0.25
ROCKING_DAMPING = (0.02, 0.1)  #: damping of small rocking on it, as far as the case has none beyond
LOSS = (0.8, 1.5)  #: loss at an impact, 1 - e, over that of the case where its restitution is given
RESTITUTIONS = (0.95, 1.06)  #: over Housner's, of sharp corners whose restitution is not given
#: of the loss of Housner's impact of a homogeneous block, what the largest of these leaves at least: the mass of a
#: container lies otherwise, and its draws move it
LOSS_LEFT = 0.3
WEAKENING_M, STRIBECK_M_S = 5e-3, 0.3  #: largest slip and velocity over which friction falls
WEAKENINGS_BETWEEN_M = (1e-3, 3e-3)  #: a stack that rings changes from sliding to rocking there
RAMP_CYCLES = 2.0
#: of stops, ties and sides over those of the case
GAPS, LINK_STIFFNESS, LINK_FRICTION = (0.8, 1.2), (0.5, 2.0), (0.5, 2.0)
MOVES = 1e-9  #: cosine of the phase of a floor that starts at rest
SHORT_LENGTH_M = 0.1  #: told in mm


def _falls(case: Any) -> bool:
    """Whether friction on the floor falls, by a law that says how."""
    return case.contact.sticks and case.contact.mu_kinetic < case.contact.mu_static


def _may_fall(case: Any) -> bool:
    return case.contact.sticks and (_falls(case) or case.uncertainty.mu_kinetic not in HELD)


def _joints_fall(case: Any) -> bool:
    """Whether friction between loose boxes falls, by a law that says how."""
    own = case.joint_friction
    return case.contact.sticks and case.container.is_loose and own["mu_kinetic"] < own["mu_static"]


def _joints_may_fall(case: Any) -> bool:
    varied = case.uncertainty.joints_mu_kinetic not in HELD
    return case.contact.sticks and case.container.is_loose and (_joints_fall(case) or varied)


def _other_start(case: Any) -> Value | None:
    """With the floor or at rest, where the floor of a harmonic motion begins with a jerk."""
    motion = case.motion
    if motion.kind != "harmonic" or motion.ramp_cycles != 0.0 or abs(math.cos(motion.phase_rad)) <= MOVES:
        return None
    return "rest" if motion.start == "moving" else "moving"


def _other_ramp(case: Any) -> Value | None:
    """Of a harmonic motion: none, or of two cycles, half of the motion at most."""
    motion = case.motion
    if motion.kind != "harmonic":
        return None
    if motion.ramp_cycles != 0.0:
        return 0.0
    ramp = min(RAMP_CYCLES, short(0.5 * (motion.cycles or longest_time(case) / motion.period) * (1.0 - 1e-9)))
    return ramp if ramp == 0.0 or ramp >= LEAST_RAMP else None


def _other_sign(case: Any, key: str) -> Value | None:
    """The other sign of a record or a pulse by its key, where left and right of the container or beside it differ."""
    motion, box, beside = case.motion, case.container, (case.links, case.neighbour, case.floor.slope_percent)
    axes = (stacked.axis for stacked in case.stack)
    lopsided = any((case.initial.is_pushed, box.eccentricity_m, box.mesh_file, *beside, *axes))
    of_a_table = "scale" if motion.scale_to_m_s2 is None else "scale_to_m_s2"
    used = {"table": of_a_table, "pulse": "peak_acceleration_m_s2"}.get(motion.kind)
    own = getattr(motion, key) if key == used and lopsided else None
    return -own if own else None


def _joints_mu_static(case: Any, own: float) -> Ends:
    if case.joints.mu_static is not None:
        return own, own
    return JOINTS[0] * own, min(q.FRICTION.most or math.inf, JOINTS[1] * own)


def _least_in_row(case: Any) -> float:
    """The least slip over which friction may fall under every container of the row [m]."""
    return max(map(least_weakening, case.row or (case,)))


def _reaching(low: float, high: float) -> Callable[[Any, float], Ends]:
    """Both ends, or the case's own value where it lies beyond."""
    return lambda case, own: (min(low, own), max(high, own))


def _shares(*shares: float) -> Callable[[float, float], tuple[float, ...]]:
    """Values at these shares of the way from the lower to the upper end."""
    return lambda low, high: tuple(short(low + share * (high - low)) for share in shares)


def _may_be_cambered(case: Any) -> bool:
    """Whether the base is cambered, or level and could be: of one body, with points enough to roll."""
    if case.support.camber_m > 0.0:
        return True
    fine = case.solver.element_size_m <= 0.25 * case.stack[0].width
    given = case.contact.restitution_over_housner is not None
    box = case.container
    whole = not box.is_loose and box.mesh_file is None and case.solver.model != "full"
    return whole and not given and (case.support.kind == "feet" or (case.support.kind == "flat" and fine))


def _cambers(case: Any, own: float) -> Ends:
    """At most a base of a radius twice as high as the mass centre."""
    box, low, high = case.stack[0], CAMBERS[0] * own, CAMBERS[1] * own if own > 0.0 else LEVEL_CAMBER_M
    high = min(high, q.CAMBER.most or math.inf)
    height = sum(stacked.mass * (stacked.bottom + stacked.centroid) for stacked in case.stack) / case.mass
    return low, max(own, min(high, short((case.support.effective_width * box.width) ** 2 / (16.0 * height))))


def _blocks(case: Any) -> list[RigidBlock]:
    """The homogeneous blocks whose impacts stand for those of a case, without neighbours that have their own case."""
    blocks = []
    for number, alone in enumerate(case.row or (case,)):
        if number and case.neighbour[number - 1].case is not None:
            continue
        box = alone.container
        height = 0.5 * (box.total_height - box.height_m) + box.centroid_m
        blocks.append(
            RigidBlock(half_width=0.5 * box.width_m, centroid_height=height, gravity=alone.gravity_m_s2)
        )
    return blocks + blocks_on_joints(case)


def blocks_on_joints(case: Any) -> list[RigidBlock]:
    """What stands on each joint of a loose stack, as blocks."""
    blocks = []
    for j in range(1, case.container.bodies):
        above, gravity = case.stack[j:], case.gravity_m_s2
        height = sum(box.mass * (box.bottom + box.centroid) for box in above) / sum(box.mass for box in above)
        height -= above[0].bottom
        blocks.append(RigidBlock(half_width=0.5 * above[0].width, centroid_height=height, gravity=gravity))
    return blocks


def _has_impacts(case: Any) -> bool:
    """Whether an impact exchanges the pivot as Housner's does, or leaves a restitution that is given.

    A block so squat that Housner's restitution is not positive stays on its base after an impact.
    """
    given = case.contact.restitution_over_housner is not None
    sharp = case.support.kind == "corners" and not case.rolls
    return (given or sharp) and max(block.housner_restitution for block in _blocks(case)) > 0.0


def _restitutions(case: Any, ratio: float) -> Ends:
    """By the loss at an impact of a homogeneous block where it is given; else a part of that loss is always left."""
    block = max(_blocks(case), key=lambda block: block.housner_restitution)
    limits, housner, (low, high) = q.RESTITUTION, block.housner_restitution, RESTITUTIONS
    if case.contact.restitution_over_housner is not None:
        low, high = ((1.0 - share * (1.0 - ratio * housner)) / housner for share in (LOSS[1], LOSS[0]))
    else:
        high = min(high, (1.0 - LOSS_LEFT * (1.0 - housner)) / housner)
        if case.casting_length is not None:  # it may land on their inner edges
            high = max(high, block.restitution_on_plates(case.casting_length) / housner)
        high = min(high, 0.999 / housner)
    least, most = limits.least or 0.0, limits.most or math.inf
    return short(min(max(low, least), most)), short(min(max(high, least), most))


def _kinetic(own: float, static: float) -> Ends:
    return short(min(own, LEAST_KINETIC * static)), static


def _heights(case: Any, own: float) -> Ends:
    """Of a solid box not beyond the thirds of its height: its density is linear in height and nowhere negative."""
    (low, high), box = (share * own for share in CENTROID), case.container
    if box.section == "solid":
        low, high = max(low, THIRDS[0] * box.height_m), min(high, THIRDS[1] * box.height_m)
    return short(min(low, own)), short(max(high, own))


def _around(own: float, distance: float) -> Ends:
    return short(own - distance), short(own + distance)


def _has_columns(case: Any) -> bool:
    """Whether every box has two columns of elements, which a mass centre beside the axis needs."""
    widest = case.solver.element_size_m
    stacks = (alone.stack for alone in case.row or (case,))
    return all(box.wall is not None or widest < box.width for stack in stacks for box in stack)


def other_patch(case: Any, kind: str) -> list[float] | None:
    """What bears under one corner where the base touches otherwise, of a slab; None where nobody can say."""
    depth, wall = case.container.depth_m, case.container.wall_m
    return (
        [0.5 * case.container.width_m, depth] if kind == "flat" else None if wall is None else [wall, depth]
    )


def _other_support(case: Any) -> Value | None:
    """Corners and flat stand for one another; feet, castings and the boxes of a loose stack stay."""
    kind = {"corners": "flat", "flat": "corners"}.get(case.support.kind)
    if kind is None or case.rolls or case.container.is_loose or case.container.box is not None:
        return None
    if case.neighbour or case.container.is_round:
        return None
    if case.floor.is_slab:
        stated = case.floor.corner_patch_m
        castings = stated is not None and stated[1] < 0.99 * case.container.depth_m
        castings = castings or case.support.casting_m is not None
        if castings or other_patch(case, kind) is None:
            return None
    return kind


Number, Choice = UnknownNumber, UnknownChoice
#: every input that may vary, those first that decide most often
# fmt: off
UNKNOWN: tuple[UnknownNumber | UnknownChoice, ...] = (
    Number(keys.MU_KINETIC, "mu_kinetic", "kinetic friction", q.FRICTION,
           lambda case, own: _kinetic(own, case.contact.mu_static), power=1.0, between=_shares(0.5)),
    Number(keys.MU_STATIC, "mu_static", "static friction", q.FRICTION, STATIC, power=1.0),
    Number(keys.WEAKENING, "weakening_m", "slip over which friction falls", q.WEAKENING,
           _reaching(0.0, WEAKENING_M), matters=_may_fall, power=3.0, between=lambda low, high: WEAKENINGS_BETWEEN_M,
           alone=_falls, tried_from=_least_in_row),
    Number(keys.STRIBECK, "stribeck_velocity_m_s", "speed at which friction has fallen", q.STRIBECK_VELOCITY,
           _reaching(0.0, STRIBECK_M_S), matters=lambda case: _may_fall(case) or _joints_may_fall(case), power=2.0,
           alone=lambda case: _falls(case) or _joints_fall(case)),
    Number(keys.JOINTS_MU_STATIC, "joints_mu_static", "static friction of the joints", q.FRICTION, _joints_mu_static,
           matters=lambda case: case.container.is_loose),
    Number(keys.JOINTS_MU_KINETIC, "joints_mu_kinetic", "kinetic friction of the joints", q.FRICTION,
           lambda case, own: _kinetic(own, case.joint_friction["mu_static"]),
           matters=lambda case: case.container.is_loose, power=1.0, between=_shares(0.5)),
    Number("joints.weakening_m", "joints_weakening_m", "slip over which friction of the joints falls", q.WEAKENING,
           _reaching(0.0, WEAKENING_M), matters=_joints_may_fall, power=3.0,
           between=lambda low, high: WEAKENINGS_BETWEEN_M, alone=_joints_fall,
           tried_from=_least_in_row),
    Number(keys.JOINTS_DASHPOT, "joints_damping_ratio", "damping of the joints", q.CONTACT_DAMPING,
           _reaching(*JOINTS_DASHPOTS), matters=lambda case: case.container.is_loose),
    Number(keys.CAMBER, "camber_m", "camber of the base", q.CAMBER, _cambers, matters=_may_be_cambered,
           between=lambda low, high: () if low > 0.0 else (short(BETWEEN_CAMBERS * high),),
           varies=lambda case: case.support.camber_m > 0.0),
    Number(keys.ROCKING, "rocking_damping_ratio", "damping of rocking", q.ROCKING_DAMPING,
           _reaching(*ROCKING_DAMPING), matters=lambda case: case.rolls),
    Choice(keys.SUPPORT, "support", "contact of the base", _other_support, drawn=False),
    Number(keys.CENTROID, "centroid_m", "height of the mass centre", q.LENGTH, _heights,
           matters=lambda case: case.container.box is None and case.container.mesh_file is None, power=1.0),
    Number("container.eccentricity_m", "eccentricity_m", "offset of the mass centre", q.OFFSET,
           lambda case, own: _around(own, BESIDE * case.container.width_m), matters=_has_columns, power=1.0),
    Number("support.effective_width", "effective_width", "bearing width of the base", q.EFFECTIVE_WIDTH,
           (EFFECTIVE_WIDTH, 1.0), matters=lambda case: case.solver.model != "full", power=1.0),
    Number(keys.SLOPE, "slope_percent", "slope of the floor", q.SLOPE, power=1.0,
           ends=lambda case, own: (max(q.SLOPE.least or 0.0, own - SLOPE_PERCENT),
                                   min(q.SLOPE.most or 0.0, own + SLOPE_PERCENT))),
    Number("vertical.phase_rad", "vertical_phase_rad", "phase of the vertical motion", q.PHASE,
           lambda case, own: _around(own, math.pi),
           matters=lambda case: case.motion.kind == case.vertical.kind == "harmonic", power=1.0,
           between=_shares(0.25, 0.75), same=lambda value: short(math.pi - (math.pi - value) % (2.0 * math.pi))),
    Number(keys.PHASE, "phase_rad", "phase of the motion", q.PHASE, lambda case, own: (own, own),
           matters=lambda case: case.motion.kind == "harmonic", power=1.0, between=_shares(0.25, 0.5, 0.75)),
    *(Choice(f"motion.{key}", "sign", "sign of the motion", partial(_other_sign, key=key))
      for key in ("scale", "scale_to_m_s2", "peak_acceleration_m_s2")),
    Choice("vertical.scale", "vertical_sign", "sign of the vertical motion", unless_stated=False,
           other=lambda case: -case.vertical.scale if case.vertical.kind in ("table", "pulse") else None),
    Choice(keys.START, "start", "start", _other_start, unless_stated=False),
    Choice(keys.RAMP, "ramp", "ramp of the motion", _other_ramp),
    Number("stop.gap_m", "stop_gap_m", "gap of the stops", q.GAP, GAPS, power=1.0),
    Number("stop.stiffness_N_m", "stop_stiffness_N_m", "stiffness of the stops", q.LINK_STIFFNESS, LINK_STIFFNESS),
    Number("stop.mu", "stop_mu", "friction on the stops", q.FRICTION, LINK_FRICTION, power=1.0),
    Number("tie.slack_m", "tie_slack_m", "slack of the ties", q.GAP, GAPS, power=1.0),
    Number("tie.stiffness_N_m", "tie_stiffness_N_m", "stiffness of the ties", q.LINK_STIFFNESS, LINK_STIFFNESS),
    Number("neighbour.gap_m", "neighbour_gap_m", "gap to the neighbours", q.GAP, GAPS, power=1.0),
    Number("neighbour.stiffness_N_m", "neighbour_stiffness_N_m", "stiffness of the sides", q.LINK_STIFFNESS,
           LINK_STIFFNESS),
    Number("neighbour.mu", "neighbour_mu", "friction between the sides", q.FRICTION, LINK_FRICTION, power=1.0),
    Number(keys.PENALTY, "normal_penalty_Pa_m", "stiffness of the contact", q.PENALTY, (SOFTEST, STIFFEST)),
    Number("floor.bearing_strength_Pa", "bearing_strength_Pa", "strength of the floor", q.BEARING_STRENGTH, SLAB),
    Number(keys.MODULUS, "floor_youngs_modulus_Pa", "stiffness of the floor", q.FLOOR_STIFFNESS, SLAB),
    Number(keys.DASHPOT, "damping_ratio", "damping of the contact", q.CONTACT_DAMPING, DAMPING),
    Number(keys.RESTITUTION, "restitution_over_housner", "rebound over Housner's", q.RESTITUTION, _restitutions,
           matters=_has_impacts, power=1.0),
    Number("container.damping_ratio", "material_damping_ratio", "damping of the container", q.MATERIAL_DAMPING, DAMPING,
           matters=lambda case: case.solver.model != "rigid"),
    Number("container.fill_damping_ratio", "fill_damping_ratio", "damping of the fill", q.MATERIAL_DAMPING,
           FILL_DAMPINGS, matters=lambda case: case.solver.model != "rigid" and case.container.is_filled_shell),
)
# fmt: on
INPUTS = (*(unknown.key for unknown in UNKNOWN), keys.TOLERANCE)
WORDS = {unknown.key: unknown.words for unknown in UNKNOWN} | {
    keys.TOLERANCE: "energy tolerance of the steps"
}
SIGN = "sign of "
CHOICES = {"flat": "on its whole face", "corners": "on its corners alone"}
CHOICES |= {"rest": "at rest", "moving": "with the moving floor"}
QUANTITIES = {unknown.key: unknown.quantity for unknown in UNKNOWN if isinstance(unknown, UnknownNumber)}

#: a range [low, high], or that the value of the case is known
Unknown = Annotated[list[float], Field(min_length=2, max_length=2)] | Literal["held", "known"] | None
Tried = bool | Literal["held", "known"] | None  #: whether the other is tried


class UncertaintyTable(CaseTable):
    """What is not known of the inputs: [low, high], or "held" as given. The band of a run covers it."""

    mu_static: Unknown = optional_key(
        "of static friction; default: 0.9 to 1.1 times; mu_kinetic keeps its share", [0.3, 0.4]
    )
    mu_kinetic: Unknown = optional_key(
        "of kinetic friction; default: half of mu_static to all of it", [0.2, 0.4]
    )
    joints_mu_static: Unknown = optional_key(
        "loose joints: of static friction; default: half to twice where [joints] leaves it out", [0.2, 0.8]
    )
    joints_mu_kinetic: Unknown = optional_key(
        "loose joints: of kinetic friction; default: half of mu_static to all of it", [0.2, 0.4]
    )
    joints_weakening_m: Unknown = optional_key(
        "loose joints: default: 0, or 1e-4 of the width to 5 mm", [0.0, 0.005]
    )
    joints_damping_ratio: Unknown = optional_key("loose joints: default: 0.1 to 2, and as given", [0.1, 2.0])
    camber_m: Unknown = optional_key(
        "of the support; default: half to twice, of a level base flat or on feet 0 to 2 mm", [0.0, 0.002]
    )
    rocking_damping_ratio: Unknown = optional_key(
        "of the support, where it is cambered; default: 0.02 to 0.1, and as given", [0.02, 0.1]
    )
    weakening_m: Unknown = optional_key(
        "of the contact; default: 0, or 1e-4 of the width to 5 mm", [0.0, 0.005]
    )
    stribeck_velocity_m_s: Unknown = optional_key("of the contact; default: 0 to 0.3 m/s", [0.0, 0.3])
    normal_penalty_Pa_m: Unknown = optional_key(
        "of the contact; default: a ninth to three times", [1e9, 3e10]
    )
    bearing_strength_Pa: Unknown = optional_key(
        "of the floor, slab only; default: half to twice", [25e6, 1e8]
    )
    floor_youngs_modulus_Pa: Unknown = optional_key(
        "of the floor, slab only; default: half to twice", [1.5e10, 6e10]
    )
    damping_ratio: Unknown = optional_key("of the contact; default: half to twice", [1.0, 4.0])
    restitution_over_housner: Unknown = optional_key(
        "of the contact, where it is given; default: a loss 1 - e of 0.8 to 1.5 times", [0.9, 1.0]
    )
    material_damping_ratio: Unknown = optional_key("of the container; default: half to twice", [0.01, 0.04])
    fill_damping_ratio: Unknown = optional_key(
        "of the container; default: a quarter to two and a half times", [0.05, 0.5]
    )
    stop_gap_m: Unknown = optional_key(
        "of the stops, where they differ the largest, and all in proportion; default: 0.8 to 1.2 times",
        [0.04, 0.06],
    )
    stop_stiffness_N_m: Unknown = optional_key("of the stops, likewise; default: half to twice", [5e7, 2e8])
    stop_mu: Unknown = optional_key("friction on the stops, likewise; default: half to twice", [0.1, 0.4])
    tie_slack_m: Unknown = optional_key("of the ties, likewise; default: 0.8 to 1.2 times", [0.0, 0.01])
    tie_stiffness_N_m: Unknown = optional_key("of the ties, likewise; default: half to twice", [5e5, 2e6])
    neighbour_gap_m: Unknown = optional_key(
        "between the neighbours, likewise; default: 0.8 to 1.2 times", [0.08, 0.12]
    )
    neighbour_stiffness_N_m: Unknown = optional_key(
        "of the sides, likewise; default: half to twice", [5e7, 2e8]
    )
    neighbour_mu: Unknown = optional_key(
        "friction between the sides, likewise; default: half to twice", [0.1, 0.4]
    )
    centroid_m: Unknown = optional_key(
        "height of the mass centre in a box; default: 0.98 to 1.02 times", [0.45, 0.55]
    )
    eccentricity_m: Unknown = optional_key(
        "of the mass centre; default: a hundredth of the width to both sides", [-0.01, 0.01]
    )
    effective_width: Unknown = optional_key("of the base; default: 0.97 to 1 times", [0.97, 1.0])
    slope_percent: Unknown = optional_key(
        "of the floor; default: half a per cent less to half a per cent more", [-0.5, 0.5]
    )
    vertical_phase_rad: Unknown = optional_key(
        "of a vertical harmonic beside a horizontal one; default: the whole turn", [0.0, 3.14]
    )
    phase_rad: Unknown = optional_key("harmonic: of the motion; default: held", [0.0, 3.14])
    sign: Tried = optional_key(
        "record or pulse: whether it may come from the other side; default: true where left and right differ",
        True,
    )
    vertical_sign: Tried = optional_key(
        "record or pulse: true tries the vertical motion with the other sign; default: false", True
    )
    support: Tried = optional_key(
        "corners and flat: whether the base may touch as the other does; default: true", True
    )
    start: Tried = optional_key(
        "harmonic: true tries the other motion.start, a jump of the floor's velocity; default: false", True
    )
    ramp: Tried = optional_key(
        "harmonic: whether a ramp of two cycles may begin it, or none; default: true", True
    )
    draws: Annotated[int, Strict(), q.DRAWS] = case_key("runs in which all of these are drawn at once", 32)

    rules = tuple(
        refused(f"uncertainty.{unknown.name}", unknown.refusal)
        for unknown in UNKNOWN
        if isinstance(unknown, UnknownNumber)
    )


def in_words(values: Mapping[str, Value]) -> str:
    """Values of inputs by dotted key, for people: "kinetic friction 0.3, camber of the base 0.5 mm"."""
    return ", ".join(
        f"{WORDS[key].removeprefix(SIGN)} reversed"
        if is_sign(key)
        else f"{WORDS.get(key, key)} {value_in_words(key, value)}"
        for key, value in values.items()
    )


def is_sign(key: str) -> bool:
    """Whether it is varied by its sign alone."""
    return WORDS.get(key, "").startswith(SIGN)


def value_in_words(key: str, value: Value) -> str:
    """A value of an input with its unit, short lengths in mm and pressures in MPa."""
    unit = QUANTITIES[key].unit if key in QUANTITIES else ""
    if isinstance(value, str):
        return CHOICES.get(value, value)
    name, factor = {"m": ("mm", 1e3), "Pa": ("MPa", 1e-6)}.get(unit, (unit, 1.0))
    if name == "mm" and abs(value) >= SHORT_LENGTH_M:
        name, factor = unit, 1.0
    return q.with_unit(float(f"{factor * value:.4g}"), name)


def excluded_values(case: Any) -> list[str]:
    """What is wrong with stated ranges that do not hold the value of the case; one sentence each."""
    reasons = []
    for unknown in UNKNOWN:
        stated = getattr(case.uncertainty, unknown.name)
        own = own_value(case, unknown.key, None) if isinstance(stated, list) else None
        if isinstance(own, float) and not stated[0] - 1e-9 <= own <= stated[1] * (1.0 + 1e-9) + 1e-9:
            reasons.append(
                f"[uncertainty] {unknown.name} = {stated} excludes the value of the case, {unknown.key} = {own:g}; "
                "widen the range, or change the value"
            )
    return reasons


def ranges_of(case: Any, penalty: float | None) -> tuple[InputRange, ...]:
    """The ranges of all unknown inputs that make a difference, in the order of `INPUTS` and without the numerics.

    Args:
        case: with its table [uncertainty].
        penalty: normal stiffness of its contact, chosen where the case says "auto" [Pa/m]; None: leave it out.
    """
    ranges = (unknown.range_in(case, penalty) for unknown in UNKNOWN)
    return tuple(span for span in ranges if span is not None and span.ends)
