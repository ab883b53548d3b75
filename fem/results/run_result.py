"""The result of a run as typed data: what `run.json` holds.

Every field has the name of its key in the file, with its SI unit. A quantity that a run did not reach, or that an
older version did not write, is None. Rotation > 0 toward +x, slip > 0 moves the container to +x.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

from fem.results.figures import (
    WHERE_GIVEN,
    BoxFigures,
    Figures,
    HeldFigures,
    LinkFigures,
    Place,
    RunFigures,
    keys_beside,
)
from fem.results.json_block import JsonBlock
from fem.results.outcome import Outcome
from fem.runtime.units import Reach

FEW_PERIODS = 5.0  #: of a harmonic motion, in which what rocks under it has not built up
WHOLE = 1.0 - 1e-9  #: share of a motion that is all of it


@dataclass(frozen=True, kw_only=True)
class ActionResult(JsonBlock):
    """The static rule under one action."""

    base_shear_N: float | None = None
    tilting_moment_Nm: float | None = None
    utilisation_sliding: float | None = None  #: demand over capacity; None without capacity
    utilisation_overturning: float | None = None
    least_weight_N: float | None = None  #: m (g - a_v), where the rule has it in place of the weight
    #: likewise, a_v over g: more than 1 lifts off
    utilisation_lifting: float | None = None

    written_where_given = frozenset({"least_weight_N", "utilisation_lifting"})


@dataclass(frozen=True, kw_only=True)
class CodeValues(JsonBlock):
    """The values of [static] that the code's rows take."""

    ground_acceleration_m_s2: float  #: a_gR
    soil_factor: float
    corner_period_s: float  #: T_C
    behaviour_factor: float
    importance_factor: float


@dataclass(frozen=True, kw_only=True)
class StaticResult(JsonBlock):
    """The static rules, and what follows from the mass alone (`fem.model.static_checks`)."""

    weight_N: float | None = None
    centroid_m: float | None = None  #: height of the mass centre above the floor
    inertia_kg_m2: float | None = None  #: about the mass centre
    slenderness_angle_rad: float | None = None
    frequency_parameter_1_s: float | None = None
    period_eq2_s: float | None = None
    period_eq3_s: float | None = None
    sliding_limit_static_N: float | None = None
    sliding_limit_kinetic_N: float | None = None
    restoring_moment_Nm: float | None = None
    uplift_acceleration_m_s2: float | None = None
    housner_restitution: float | None = None
    housner_credible: bool | None = None  #: a restitution of at least 0.5
    own_motion: ActionResult | None = None  #: peak floor acceleration of this run
    #: the same with g less the largest vertical acceleration; left out where the floor does not move up and down
    own_motion_vertical: ActionResult | None = None
    wind: ActionResult | None = None  #: characteristic wind and 0.9 of the weight; left out without [wind]
    code: ActionResult | None = None  #: behaviour factor as given; None without [static], as all that follows
    code_q1: ActionResult | None = None  #: behaviour factor 1
    method_applicable: bool | None = None  #: the lateral force method
    clause: str | None = None
    period_limit_s: float | None = None  #: up to which the method applies
    code_values: CodeValues | None = None
    downhill_m_s2: float | None = None  #: of the weight along the floor; left out where it is level

    written_where_given = frozenset({"own_motion_vertical", "downhill_m_s2", "wind"})

    @property
    def ruling(self) -> ActionResult:
        """The rows that a run is compared with: those that take the vertical motion into account, where it has one."""
        return self.own_motion_vertical or self.own_motion or ActionResult()


@dataclass(frozen=True, kw_only=True)
class MotionResult(JsonBlock):
    """The floor's motion as used, after scale and baseline (`fem.model.motion_summary`)."""

    notes: tuple[str, ...] = ()  #: doubts about a recorded motion
    kind: str | None = None  #: none | harmonic | pulse | table
    duration_s: float | None = None  #: from its beginning to its end; of a drive without end, the run's
    begin_s: float | None = None  #: of a table, where its times begin before the run
    step_s: float | None = None  #: median interval of the samples of a table
    samples: int | None = None  #: of a table
    peak_acceleration_m_s2: float | None = None  #: of the whole motion, as the following
    peak_velocity_m_s: float | None = None
    peak_displacement_m: float | None = None
    residual_velocity_m_s: float | None = None  #: of a table, at its end, as the following
    residual_displacement_m: float | None = None
    covered: float | None = None  #: share of the motion's time within the run
    peak_in_run_m_s2: float | None = None  #: largest acceleration within the run
    vertical: "MotionResult | None" = None  #: the same of the vertical motion; left out where there is none
    endless: bool | None = None  #: a harmonic motion that goes on; left out of any other

    written_where_given = frozenset({"vertical", "endless"})

    @property
    def few_periods(self) -> float | None:
        """The periods of a harmonic motion that has no end, where a run covers too few; None of any other."""
        if not self.endless or not self.duration_s or not self.peak_velocity_m_s:
            return None
        angular_frequency = (self.peak_acceleration_m_s2 or 0.0) / self.peak_velocity_m_s
        periods = self.duration_s * angular_frequency / math.tau
        return periods if periods < FEW_PERIODS else None

    @property
    def is_cut(self) -> bool:
        """Whether the run ends before its motion, or after few periods of one that has no end."""
        covered = [
            one.covered for one in (self, self.vertical) if one is not None and one.covered is not None
        ]
        return self.few_periods is not None or min(covered, default=1.0) < WHOLE


@dataclass(frozen=True, kw_only=True)
class FloorNumbers(JsonBlock):
    """What the floor amounts to (`fem.model.floor`); of a rigid one that slopes, the slope alone."""

    kind: str  #: rigid | slab
    slope_percent: float = 0.0  #: > 0: it falls toward +x
    preset: str | None = None
    youngs_modulus_Pa: float | None = None
    poisson_ratio: float | None = None
    bearing_strength_Pa: float | None = None
    #: under one corner of the elevation, along x and out of plane
    corner_patch_m: tuple[float, ...] | None = None
    corner_stiffness_N_m: float | None = None
    corner_tangential_stiffness_N_m: float | None = None
    contact_frequency_Hz: float | None = None  #: of the container on both corners
    damping_ratio: float | None = None  #: c/(2 sqrt(k m)), the whole mass on the spring of one corner
    static_indentation_m: float | None = None  #: elastic, under the weight
    corner_cap_N: float | None = None  #: largest normal force of a corner
    bearing_capacity_N: float | None = None  #: strength times patch
    #: at which the wall over the corner yields; None without such a wall
    steel_capacity_N: float | None = None
    #: how far inside its edge the container turns on a weak floor; left out of a firm one
    pivot_inset_m: float | None = None
    governs: str | None = None  #: floor | container: what gives way first
    cap_over_weight: float | None = None
    hit_rotation_ratio: float | None = None  #: from which the container falls back, for what follows
    closing_speed_m_s: float | None = None
    crushing_per_hit_m: float | None = None
    crushing_per_hit_J: float | None = None

    written_where_given = frozenset({"pivot_inset_m"})


@dataclass(frozen=True, kw_only=True)
class BoxReach(BoxFigures[Reach]):
    """What one box of a loose stack does over the band; figures are [low, high], as those of `Band`."""

    fell: int = 0  #: members in which this box fell first


@dataclass(frozen=True, kw_only=True)
class HeldResult(HeldFigures[float]):
    """What one neighbour, stop or tie did in a run of a band."""


@dataclass(frozen=True, kw_only=True)
class HeldReach(HeldFigures[Reach]):
    """The same over the band, [low, high]."""


@dataclass(frozen=True, kw_only=True)
class ChangedRun(RunFigures):
    """One run of a band."""

    change: str = ""  #: in words; empty: the run itself
    kind: str = ""  #: one | floor | pair | draw (`fem.case.uncertainty`); empty: the run itself
    values: Mapping[str, float | str] | None = None  #: the inputs that it changes, by dotted key
    normal_penalty_Pa_m: float | None = None
    damping_ratio: float | None = None  #: of the contact
    status: str  #: completed | overturned | failed | interrupted
    error: str | None = None
    links: tuple[HeldResult, ...] | None = None  #: of neighbours, stops, ties, in this order

    written_where_given = keys_beside(Place.BAND) | WHERE_GIVEN


@dataclass(frozen=True, kw_only=True)
class Band(LinkFigures[Reach], Figures[Reach]):
    """What the run does when its unknown inputs change.

    Its figures are the [low, high] of the members that stand where the run stands, or overturn where it overturns.
    """

    outcomes: tuple[Outcome, ...] = ()  #: that were found, from rest to overturned
    unsure: bool = False  #: the outcome is unsure: see `Verdict.sure`
    draws: int | None = None  #: members in which all inputs are drawn at once
    draws_overturned: int | None = None
    draws_invalid: int | None = None  #: that destroyed a corner
    left_out: tuple[str, ...] = ()  #: changes that the time did not allow
    draws_left_out: int | None = None
    boxes: tuple[BoxReach, ...] | None = None  #: of a loose stack, from the floor up
    links: tuple[HeldReach, ...] | None = None  #: of neighbours, stops, ties, in this order
    members: tuple[ChangedRun, ...] = ()  #: the run itself first

    written_where_given = keys_beside(Place.BAND) | WHERE_GIVEN


@dataclass(frozen=True, kw_only=True)
class Governing(JsonBlock):
    """The least factor of all that were tried, on the case and its variations, at which it does not stand."""

    factor: float | None = None  #: None: it stands under all that were tried
    of: str = "case"  #: whose it is: case | variations
    ending: str | None = None  #: overturned | invalid (a corner is destroyed)
    variations: int = 0  #: with all unknown inputs drawn at once, up to the end of the case itself
    variations_overturned: int = 0
    variations_destroyed: int = 0
    variations_failed: int | None = None  #: without an outcome, not counted; left out where there is none
    step: float | None = None  #: widest relative step below it: an island narrower than that may be missed

    written_where_given = frozenset({"variations_failed"})


@dataclass(frozen=True, kw_only=True)
class Margin(JsonBlock):
    """How much stronger the motion may be (`fem.run.margin`); factors on the whole motion of the run."""

    factor: float | None = None  #: of the first overturning; None: none was found
    #: the largest factor below it that was tried; None: none stood, or none fell
    stands_up_to: float | None = None
    #: least and largest factor of the first overturning over the draws and the run; `high` None: not all overturn
    low: float | None = None
    high: float | None = None
    draws: int = 0  #: in which all unknown inputs are drawn, without those that failed
    draws_standing: int = 0  #: those that stand up to `draws_tried_to`
    draws_failed: int = 0  #: or destroyed a corner
    draws_tried_to: float | None = None  #: largest factor of the draws; None without draws
    islands: tuple[tuple[float, float], ...] = ()  #: [from, to] beyond `factor` where it stands again
    least_tried: float
    largest_tried: float
    runs: int  #: with the inputs of the run, besides itself
    destroyed_from: float | None = None  #: least factor of those tried at which a corner is destroyed
    #: of a container with stops, ties or neighbours: the factor of its first overturning without, None where none was;
    #: and the largest factor tried so
    factor_without_links: float | None = None
    without_links_tried_to: float | None = None
    governing: Governing | None = None  #: None: of a former version

    written_where_given = frozenset({"destroyed_from", "factor_without_links", "without_links_tried_to"})


def to_overturn(row: bool) -> str:
    """Whose overturning the reference of the energy balance is, in words; `row`: of a row of containers."""
    return "to overturn the container of the row that takes least" if row else "to overturn"


@dataclass(frozen=True, kw_only=True)
class NeighbourResult(JsonBlock):
    """What a neighbour did, and what happened across the gap before it."""

    side: str  #: of the container: left | right
    outcome: Outcome  #: of the neighbour
    max_rotation_rad: float
    rotation_ratio: float  #: over its own slenderness angle
    max_slip_m: float  #: over the floor
    residual_slip_m: float
    max_uplift_m: float
    overturned_at_s: float | None = None  #: or when it was at rest, leaning beyond its slenderness angle
    hits: int  #: how often the gap closed
    max_force_N: float  #: across the gap
    largest_closing_velocity_m_s: float
    gap_left_m: float  #: least gap that was left


@dataclass(frozen=True, kw_only=True)
class AnalyticBlock(JsonBlock):
    """The analytic rigid block of a container under the same motion, on rigid ground."""

    outcome: Outcome | None = None  #: None: it left the floor
    rotation_ratio: float | None = None  #: up to there
    max_slip_m: float | None = None
    #: largest |T|/N of the block if it cannot slide; None where it overturns
    friction_needed: float | None = None


@dataclass(frozen=True, kw_only=True)
class Verdict(RunFigures):
    """Outcome, extremes and events of a run; of a row those of the container itself, but that any fall is its end."""

    neighbours: tuple[NeighbourResult, ...] | None = None  #: in the order of the case; None where it has none
    invalid_reason: str | None = None  #: what is destroyed, in words
    #: true: it overturned in that it is at rest where stops, ties or a neighbour alone hold it
    leans: bool | None = None
    modes: tuple[str, ...] = ()  #: states passed through
    at_rest_s: float | None = None  #: since when it is at rest, of a run that ended for it
    yield_strength_Pa: float | None = None  #: that of S235 of a steel shell; None of another container
    #: where posts stand on castings, no stress counts nearer to a corner
    stress_from_corner_m: float | None = None
    #: at which the wall over a corner yields, and the work that a rigid-plastic corner would take (`fem.model.floor`)
    corner_capacity_N: float | None = None
    plastic_work_J: float | None = None
    basis: str = "study"
    level: str | None = None  #: the gravest of what the card says (`fem.results.level.Level`)
    first_line: str | None = None  #: the first line of the card
    #: what it does, the margin that governs, how far it moves, how sure that is, the static rule: a line each
    card: tuple[str, ...] = ()
    still_turned: float | None = None  #: |rotation| over the angle, of one that rocks as its run ends
    still_sliding_m_s: float | None = None  #: of one that slides as its run ends, and comes to rest by itself
    place_m: float | None = None  #: slip beyond which it has left its place
    place_is: str | None = None  #: whose that is: limit | width | gap
    #: sure | regime unsure: it stands, or falls, in all variations, but may move otherwise | unsure; None: not tried
    sure: str | None = None
    numerically_unsure: bool = False  #: more accurate steps change whether it stands
    decided_by: tuple[str, ...] = ()  #: inputs that change the outcome, the one of the smallest change first
    band: Band | None = None
    margin: Margin | None = None
    analytic: AnalyticBlock | None = None  #: of a run by the command; None where there is no such block

    #: the forces in bolts of a run are those of its joints
    written_where_given = WHERE_GIVEN.union(
        {
            *("corner_capacity_N", "plastic_work_J", "bolt_tension_N", "bolt_shear_N"),
            *(
                "invalid_reason",
                "leans",
                "neighbours",
                "stress_from_corner_m",
                "place_m",
                "place_is",
                "still_turned",
                "still_sliding_m_s",
            ),
        }
    )

    def to_json(self) -> dict[str, Any]:
        """The block; of a loose stack with the box that fell, or null."""
        block = super().to_json()
        return block if self.boxes is None else block | {"fell_box": self.fell_box}

    def _repr_html_(self) -> str:
        """The card, for a notebook."""
        return "<br>".join(map(escape, self.card)) or escape(repr(self))


@dataclass(frozen=True, kw_only=True)
class JointDemand(JsonBlock):
    """What one joint between boxes must carry, and when it would open or slide without bolts."""

    joint: int  #: from the floor up, from 1
    height_m: float
    min_normal_N: float
    max_normal_N: float
    max_shear_N: float
    max_moment_Nm: float
    bolt_tension_left_N: float
    bolt_tension_right_N: float
    bolt_shear_N: float
    bolt_utilisation: float | None = None  #: largest tension over joints.bolt_capacity_N; None: not given
    friction_needed: float | None = None  #: None: unloaded under shear
    partly_opens_at_s: float | None = None
    opens_at_s: float | None = None
    slides_at_s: float | None = None


@dataclass(frozen=True, kw_only=True)
class Energy(JsonBlock):
    """The energy balance."""

    #: what it takes to overturn, M g R (1 - cos slenderness angle); of a row the container that takes least
    reference_J: float | None = None
    closure_error: float | None = None  #: largest |imbalance| over the reference
    friction_J: float | None = None
    contact_damping_J: float | None = None
    material_damping_J: float | None = None
    crushing_J: float | None = None  #: plastic work on the floor
    impact_J: float | None = None  #: lost by the restitution that was asked for; < 0 returned
    numerical_J: float | None = None  #: final imbalance; > 0 lost, < 0 gained
    base_work_J: float | None = None


@dataclass(frozen=True, kw_only=True)
class Numerics(JsonBlock):
    """How the run was computed."""

    unknowns: int | None = None
    contact_nodes: int | None = None
    steps: int | None = None
    rejected: int | None = None
    newton_iterations: int | None = None
    iterations: int | None = None
    simulated_s: float | None = None
    largest_step_s: float | None = None
    smallest_step_s: float | None = None
    stepping_cpu_s: float | None = None  #: without compilation, set-up and output
    normal_penalty_Pa_m: float | None = None
    contact_damping_ratio: float | None = None
    contact_frequency_Hz: float | None = None
    bounce_frequency_Hz: float | None = None  #: of the container on one corner, shell and floor in series
    bounce_container_damping_ratio: float | None = None  #: what steel and fill take of it
    #: .. and the floor, or the dashpot of the numerical penalty
    bounce_contact_damping_ratio: float | None = None
    static_penetration_m: float | None = None
    max_penetration_m: float | None = None
    elastic_frequencies_Hz: tuple[float, ...] = ()
    attachment_frequencies_Hz: tuple[float, ...] = ()
    corner_force_window_s: float | None = None
    acceleration_window_s: float | None = None  #: former versions: a mean in place of the filter
    contents_filter: str | None = None  #: kind and order
    contents_filter_Hz: float | None = None  #: its cut-off


@dataclass(frozen=True, kw_only=True)
class LinkResult(JsonBlock):
    """What a stop or a tie did."""

    side: str  #: of the container: left | right
    height_m: float  #: of its point; of a full model that of the nearest node of the mesh
    neighbour: int | None = None  #: that has its point; None: the container
    max_force_N: float  #: along its line
    hits: int  #: how often it began to hold
    largest_closing_velocity_m_s: float  #: with which it did
    gap_left_m: float | None = None  #: least gap or slack that was left; None: it is broken
    broken_at_s: float | None = None  #: None: it did not break


@dataclass(frozen=True, kw_only=True)
class RunAndBlock(JsonBlock):
    """One quantity of the run and of the analytic rigid block."""

    run: float | None = None
    block: float | None = None


@dataclass(frozen=True, kw_only=True)
class PeakPair(JsonBlock):
    """One turning point of the run and of the rigid block."""

    run_s: float
    run_rad: float
    block_s: float
    block_rad: float


@dataclass(frozen=True, kw_only=True)
class RigidCheckResult(JsonBlock):
    """The run compared with the analytic rigid block."""

    reference: str | None = None  #: None where there is no comparison; `reasons` says why
    meaningful: bool = False
    reasons: tuple[str, ...] = ()  #: why the container is not that block
    first_impact_s: RunAndBlock | None = None
    velocity_ratio: RunAndBlock | None = None  #: at the first impact
    peaks: tuple[PeakPair, ...] = ()
    largest_difference_before_impact: float | None = None  #: of rotation, over the slenderness angle

    def to_json(self) -> dict[str, Any]:
        """The block; without a reference, only why there is none."""
        block = super().to_json()
        if self.reference is None:
            return {key: block[key] for key in ("reference", "meaningful", "reasons")}
        return block


@dataclass(frozen=True, kw_only=True)
class Plane(JsonBlock):
    """The static rule in one vertical plane of a container, under the motion of its run."""

    width_m: float  #: of the base, along the motion
    utilisation_sliding: float | None = None
    utilisation_overturning: float | None = None


@dataclass(frozen=True, kw_only=True)
class Sides(JsonBlock):
    """The plane of a run and the one across it; a motion along y is taken to be as strong as that along x."""

    governing: str  #: computed: that of the run | other
    computed: Plane
    other: Plane


@dataclass(frozen=True, kw_only=True)
class RunResult(JsonBlock):
    """All of `run.json`; a block that the run has not reached is None."""

    status: str  #: completed | overturned | failed | interrupted | running
    case: str | None = None
    title: str | None = None
    overrides: tuple[str, ...] | None = None  #: changes by the command line, as `table.key=value`
    case_hash: str | None = None
    static: StaticResult | None = None
    sides: Sides | None = None  #: None of a square or round base
    motion: MotionResult | None = None
    floor: FloorNumbers | None = None  #: None: rigid and level
    versions: Mapping[str, str] | None = None
    verdict: Verdict | None = None
    joints: tuple[JointDemand, ...] | None = None  #: None for a single box
    stops: tuple[LinkResult, ...] | None = None  #: in the order of the case; None where it has none
    ties: tuple[LinkResult, ...] | None = None
    energy: Energy | None = None
    numerics: Numerics | None = None
    error: str | None = None  #: why it failed
    wall_s: float | None = None
    cpu_s: float | None = None
    compile_s: float | None = None  #: of the wall time
    warnings: tuple[str, ...] | None = None
    rigid_check: RigidCheckResult | None = None

    def to_json(self) -> dict[str, Any]:
        """The result as JSON types; blocks that are not there are left out."""
        block = super().to_json()
        kept = {"joints"} if self.verdict is not None else set()
        return {key: value for key, value in block.items() if value is not None or key in kept}
