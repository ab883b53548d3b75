"""The results of `assess` and `size` as typed data: what `assess.json` and `size.json` hold.

Every field has the name of its key in the file, with its SI unit. Accelerations are magnitudes.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar

from fem.html.page import Signature
from fem.results import figures
from fem.results.json_block import JsonBlock
from fem.runtime import units
from fem.runtime.units import RATIO
from fem.site.tables import LimitsTable
from fem.study.driver import StudyResult

RESULT_FILE = "assess.json"
USUAL_BEHAVIOUR_FACTOR = 1.5
#: stages of the runs, in the order of the rows
STAGES = SET, REPEATED, SCAN, REFINED, FURTHER = "set", "repeated", "scan", "refined", "further"
MOTIONS = "motions"  #: folder of the motions: motion_01_h.csv, motion_01_v.csv, ..


@dataclass(frozen=True, kw_only=True)
class SiteActionResult(JsonBlock):
    """The action of the site, at the level of the ground, and the target and mean spectra there (5 %)."""

    source: str  #: where the numbers of the spectrum stand
    reference_acceleration_m_s2: float  #: a_gR
    importance_factor: float  #: gamma_I
    element_importance_factor: float  #: gamma_a
    topographic_factor: float = 1.0  #: S_T
    ag_m_s2: float  #: gamma_I gamma_a S_T a_gR
    soil_factor: float
    ag_S_m_s2: float
    avg_m_s2: float
    vertical_ratio: float
    corner_periods_s: tuple[float, ...]
    vertical_corner_periods_s: tuple[float, ...]
    displacement_m: float  #: d_g
    periods_s: tuple[float, ...]
    target_m_s2: tuple[float, ...]
    mean_m_s2: tuple[float, ...]
    vertical_target_m_s2: tuple[float, ...] = ()
    vertical_mean_m_s2: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class FloorResult(JsonBlock):
    """The floor on which the container stands, of a building or given, and what the motions are there."""

    z_over_h: float | None = None  #: None: the motion of the floor is given, and no building is known
    building: str = ""  #: its modes, in words; of a given floor, what it was given by
    building_periods_s: tuple[float, ...] = ()  #: the one given, and varied both ways
    damping_ratio: float = 0.05  #: of the building
    peak_m_s2: float  #: of the building's period with the largest mean peak; all are means over the motions
    peak_velocity_m_s: float
    mean_m_s2: tuple[float, ...]  #: spectrum (5 %) at the periods of the action
    #: of a given floor with a vertical motion, the same; else it is that of the ground
    vertical_peak_m_s2: float | None = None
    vertical_mean_m_s2: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SetCheck(JsonBlock):
    """One requirement on the set of motions."""

    name: str
    found: float | None = None
    demanded: str  #: in words, such as "at least 2.4 m/s2"
    unit: str = ""
    fulfilled: bool
    clause: str = ""  #: empty where it is this program's own


@dataclass(frozen=True, kw_only=True)
class SiteMotion(JsonBlock):
    """One motion of the set, at the level of the ground; its curves are in the folder of the motions."""

    number: int  #: from 1
    origin: str  #: "seed 1", or the names of the record's files
    scale: float = 1.0  #: on the record, or of the whole set
    pga_m_s2: Annotated[float, figures.PGA]
    pgv_m_s: Annotated[float, figures.PGV]
    pgd_m: Annotated[float, figures.PGD]
    d5_95_s: Annotated[float, figures.DURATION]
    vertical_pga_m_s2: Annotated[float | None, figures.Shown("vertical PGA", units.ACCELERATION)] = None
    end_velocity_m_s: Annotated[float, figures.Shown("end velocity", units.VELOCITY)]
    end_displacement_m: Annotated[float, figures.Shown("end displacement", units.MILLIMETRES)]
    spectrum_m_s2: tuple[float, ...]  #: at the periods of the action
    vertical_spectrum_m_s2: tuple[float, ...] = ()
    files: tuple[str, ...]  #: in the folder of results
    sha256: tuple[str, ...]  #: of these files


@dataclass(frozen=True, kw_only=True)
class MotionSet(JsonBlock):
    """The set of motions and its checks; a set that is not valid is not used."""

    source: str  #: artificial | records | matched
    count: int
    seed: int | None = None
    stationary_s: float | None = None
    band_s: tuple[float, ...]  #: periods of the comparison with the target, shortest and longest
    mean_pga_m_s2: float
    least_ratio: float  #: of mean over target in the band
    least_ratio_period_s: float
    vertical_least_ratio: float | None = None
    vertical_least_ratio_period_s: float | None = None
    largest_correlation: float
    valid: bool
    reasons: tuple[str, ...] = ()  #: why not
    notes: tuple[str, ...] = ()  #: what the processing of its records changed
    checks: tuple[SetCheck, ...]
    motions: tuple[SiteMotion, ...]


@dataclass(frozen=True, kw_only=True)
class SiteBody(JsonBlock):
    """The container, full or empty, in one elevation."""

    mass: str  #: full | empty
    elevation: str  #: width | depth: the dimension along the motion
    mass_kg: float
    centroid_m: float
    inertia_kg_m2: float  #: polar, in the elevation, about the mass centre
    support_width_m: float  #: between the points about which it turns
    width_m: float  #: of the shell along the motion
    height_m: float
    depth_m: float  #: of the shell across the motion
    gravity_m_s2: float
    slenderness_angle_rad: float
    frequency_parameter_1_s: float
    uplift_acceleration_m_s2: float
    housner_restitution: float


@dataclass(frozen=True, kw_only=True)
class SiteKey(JsonBlock):
    """What the runs of a group have in common: the container, and on what it stands."""

    building_period_s: float | None = None  #: None: on the ground, or on a floor whose motion is given
    mu_static: float
    mu_kinetic: float
    mass: str  #: full | empty
    elevation: str = "width"  #: width | depth: the dimension along the motion

    @property
    def group(self) -> tuple[str, str, float | None, float, float]:
        """The same of all runs of a group."""
        return self.mass, self.elevation, self.building_period_s, self.mu_static, self.mu_kinetic


@dataclass(frozen=True, kw_only=True)
class RunKey(SiteKey):
    """One run: what it is made of."""

    stage: str = SET  #: what it is for
    motion: int
    vertical_sign: int  #: 1, -1; 0: no vertical component
    model: str
    factor: float = 1.0  #: on the motion

    @property
    def stem(self) -> str:
        """Of the names of the files of its motion."""
        return motion_stem(self.motion, self.building_period_s, self.stage)


def motion_stem(number: int, period: float | None, stage: str = SET) -> str:
    """Beginning of the names of the files of a motion."""
    name = f"{stage}_{number:03d}" if stage == FURTHER else f"motion_{number:02d}"
    return name if period is None else f"{name}_floor_{period:g}s"


@dataclass(frozen=True, kw_only=True)
class SiteRun(figures.RunFigures, RunKey):
    """One run, with what it found."""

    written_where_given = figures.keys_beside(figures.Place.RUNS) | figures.WHERE_GIVEN


@dataclass(frozen=True, kw_only=True)
class ByRule(JsonBlock):
    """What counts of some runs by the rule; None where one overturned or failed."""

    runs: int
    overturned: int
    invalid: int = 0  #: runs that destroyed a corner, which do not count as standing
    #: of seven and more motions the mean, of fewer the largest
    rotation_ratio: Annotated[float | None, figures.Shown("rotation ratio, by the rule", RATIO)] = None
    #: of a single motion
    rotation_ratio_largest: Annotated[float | None, figures.Shown("largest of one motion", RATIO)] = None
    #: of a single motion, the largest: a clearance is used up once
    slip_m: Annotated[float | None, figures.Shown("slip, largest", units.SHORT_MILLIMETRES)] = None
    slip_mean_m: Annotated[float | None, figures.Shown("mean", units.SHORT_MILLIMETRES)] = None


BY_RULE = figures.declared_in(ByRule)
#: the keys of [limits], with the figure that each is on, and the figure of a run that this is found from
FIGURE_OF = {
    "rotation_ratio": "rotation_ratio",
    "single_rotation_ratio": "rotation_ratio_largest",
    "slip_m": "slip_m",
}
FOUND_FROM = {key: figures.SLIPPED if key == "slip_m" else figures.TURNED for key in FIGURE_OF}


@dataclass(frozen=True, kw_only=True)
class RuleRange(JsonBlock):
    """The rule over the set and its repetitions with changes that nobody can tell apart: [low, high] of each figure."""

    rotation_ratio: tuple[float, ...] = ()
    rotation_ratio_largest: tuple[float, ...] = ()
    slip_m: tuple[float, ...] = ()
    repetitions: int = 0
    #: repetitions in which a run overturned or destroyed a corner, of which the ranges know nothing
    overturned: int = 0


@dataclass(frozen=True, kw_only=True)
class ScanPoint(ByRule):
    """What the rule finds in all motions of the set times one factor; no figure where a run of a group has none."""

    factor: float
    failed: int = 0  #: runs without an outcome, of which the margin knows nothing

    @property
    def not_standing(self) -> int:
        """Runs that overturned or destroyed a corner."""
        return self.overturned + self.invalid

    def exceeded(self, limits: LimitsTable) -> list[str]:
        """The limits that are exceeded, by their keys; where a run overturned none is known to be kept."""
        return [key for key, name in FIGURE_OF.items() if (self[name] or 0.0) > getattr(limits, key)]

    def fails(self, limits: LimitsTable) -> bool:
        """Whether the rule is not fulfilled."""
        return self.not_standing > 0 or bool(self.exceeded(limits))

    def utilisation(self, limits: LimitsTable) -> float | None:
        """The largest share of a limit; None where a run overturned or failed."""
        used = [
            None if self[name] is None else self[name] / getattr(limits, key)
            for key, name in FIGURE_OF.items()
        ]
        known = [use for use in used if use is not None]
        return max(known) if len(known) == len(used) else None


@dataclass(frozen=True, kw_only=True)
class FurtherMotions(SiteKey):
    """Motions beyond the set for one container and friction: how often, with the worse sign, it overturned."""

    motions: int
    overturned: int
    beyond_limits: int  #: overturned, or beyond a limit of a single motion, by its run or in both directions
    #: slip under both horizontal components of a body that does not rock, the largest [m]; None: not known
    slip_largest_m: float | None = None
    slid_too_far: int = 0  #: motions under which that is beyond the clearance
    interval: tuple[float, ...]  #: of the probability that it does not stand, 95 %, two-sided
    invalid: int = 0  #: motions that destroyed a corner, under which it does not count as standing
    failed: int = 0  #: motions without an outcome, which are none of `motions`


@dataclass(frozen=True, kw_only=True)
class ConfirmedRun(figures.RunFigures):
    """A deciding run, repeated with another model over its unknown inputs."""

    run: SiteRun
    model: str
    sure: str = ""  #: of the verdict: sure | regime unsure | unsure
    outcomes: tuple[str, ...] = ()  #: over the band
    rotation_ratio_range: tuple[float, ...] = ()  #: of the members of the band that end as the run does
    max_slip_m_range: tuple[float, ...] = ()
    bolt_utilisation: float | None = None  #: largest tension over joints.bolt_capacity_N; None: not given

    written_where_given = figures.keys_beside(figures.Place.KEY) | figures.WHERE_GIVEN | {"bolt_utilisation"}


@dataclass(frozen=True, kw_only=True)
class ActionAnswer(JsonBlock):
    """The answer for one action that was asked for."""

    name: str  #: earthquake | wind
    answer: str | None = None
    #: the largest over all checks; None where a run overturned, or without answer
    utilisation: float | None = None
    words: str = ""  #: what it rests on


@dataclass(frozen=True, kw_only=True)
class TwoDirections(JsonBlock):
    """Slip of a body that does not rock under both horizontal components and the vertical, of the motions of the set.

    Of each motion the worse sign of the vertical, of frictions and building periods that with which it slides furthest.
    """

    building_period_s: float | None = None  #: None: on the ground, or on a floor whose motion is given
    mu_static: float
    mu_kinetic: float
    slip_mean_m: float
    slip_largest_m: float
    slip_mean_in_plane_m: float  #: as the mean, without the second component
    slip_largest_in_plane_m: float | None = None  #: as the largest, without it
    motion: int
    #: least factor on the motions, of those tried, at which it slides too far
    margin_factor: float | None = None
    #: of the largest, over the set and its repetitions: [low, high]; empty: there are none
    slip_range_m: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SiteAnswer(ByRule):
    """The answer, under the rule that is printed with it."""

    answer: str | None = None  #: fulfilled | not fulfilled | not sure; None: there is none (yet)
    fulfilled: bool | None = None  #: None also where it is not sure
    reasons: tuple[str, ...] = ()  #: why it is not fulfilled, or not sure: sentences, the gravest first
    rule: str
    sentence: str
    still: int = 0  #: runs below uplift and slip by the rigid bound, which were not computed
    exceeded: tuple[str, ...] = ()  #: keys of the limits that the set exceeds
    governing: SiteRun | None = None
    actions: tuple[ActionAnswer, ...] = ()
    #: least factor on the motions, of those tried, at which the rule fails
    margin_factor: float | None = None
    factor_at_first_overturning: float | None = None
    #: at which a rigid body first uplifts or slips; None: not known
    factor_at_first_movement: float | None = None
    #: None: motions.second_component = 0, or not known on a sloping floor or for motions without that component
    two_directions: TwoDirections | None = None
    rule_range: RuleRange | None = None
    scan: tuple[ScanPoint, ...] = ()
    failed_between: int = 0  #: runs without an outcome at factors between those of the scan
    further: tuple[FurtherMotions, ...] = ()
    confirmed: tuple[ConfirmedRun, ...] = ()

    def is_least_tried(self, factor: float) -> bool:
        """Whether no smaller factor on the motions was tried: what happens at it may happen below it, too."""
        return bool(self.scan) and factor <= min(point.factor for point in self.scan)


#: columns of the points of `size`: the answer at a value, and why it is not fulfilled, in words
OF_ANSWER = ("answer", "fulfilled", *(field.name for field in fields(ByRule)))
POINT = {"value": float, "fails": str} | {name: figures.types_of(SiteAnswer)[name] for name in OF_ANSWER}


@dataclass(frozen=True, kw_only=True)
class SizeResult(StudyResult):
    """Which values fulfil the rule: what `size.json` holds."""

    command: str = ""
    wall_s: float | None = None
    key: str
    followers: tuple[str, ...] = ()  #: keys that took the same values
    unit: str
    low: float  #: ends of the range that was tried
    high: float
    #: the least or the largest; None where there is none in the range, or a window is asked
    value: float | None = None
    intervals: tuple[tuple[float, ...], ...] = ()  #: that fulfil it, by their outermost values tried
    sentence: str = ""
    columns_of: ClassVar[Mapping[str, Mapping[str, Any]]] = {"points": POINT}
    needed = frozenset({"value", "runs", "overturned"})
    points: tuple[Mapping[str, Any], ...] = ()  #: by rising value


@dataclass(frozen=True, kw_only=True)
class SiteMethod(JsonBlock):
    """One simplified method; `says` is its conclusion, `found` the result of the runs for the same action."""

    name: str
    quantity: str
    mass: str
    elevation: str = "width"
    formula: str
    numbers: str
    demand: float | None = None
    capacity: float | None = None
    unit: str
    utilisation: float | None = None
    says: str
    source: str
    validity: str
    #: half of such motions or bodies exceed it, so that it is not compared with the runs
    median: bool = False
    beyond: str = ""  #: why it does not hold here, and is not compared; empty: it does
    found: str = ""
    compared: str = ""  #: the method against the rule's value: agrees | conservative | not conservative
    factor: float | None = None  #: capacity over strength: on the action, at which the method is used up


@dataclass(frozen=True, kw_only=True)
class SiteInputs(JsonBlock):
    """What was asked, for the page."""

    container: str
    mu_static: tuple[float, ...]
    mu_kinetic_over_static: tuple[float, ...]
    rotation_ratio_limit: float
    single_rotation_ratio_limit: float = 0.8
    slip_limit_m: float
    wind_pressure_Pa: float | None = None
    wind_pressure_source: str = ""
    gamma_mu: float = 1.0  #: partial factor on friction in the wind rows
    #: of the plateau rows: that of [static] of the container
    behaviour_factor: float = USUAL_BEHAVIOUR_FACTOR
    model: str
    contents: str = ""  #: ordinary | toxic | explosive; empty: not stated
    #: where the inputs come from, by their tables, in the words of the user; empty: not stated
    sources: tuple[tuple[str, str], ...] = ()
    #: inputs that nobody stands for yet, in words: there is nothing to sign while there are some
    unstated: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SiteProvenance(JsonBlock):
    """What is needed to compute it again."""

    command: str
    site_hash: str
    case_hash: str
    versions: tuple[tuple[str, str], ...] = ()
    system: str = ""  #: operating system and processor
    wall_s: float | None = None
    cpu_s: float | None = None


@dataclass(frozen=True, kw_only=True)
class SiteResult(StudyResult):
    """Everything `assess` found."""

    title: str = ""
    inputs: SiteInputs
    action: SiteActionResult
    floor: FloorResult | None = None
    set: MotionSet
    bodies: tuple[SiteBody, ...]
    runs: tuple[SiteRun, ...] = ()
    result: SiteAnswer
    methods: tuple[SiteMethod, ...] = ()
    provenance: SiteProvenance
    document: Signature | None = None  #: [document] of the site file

    @property
    def to_be_signed(self) -> bool:
        """Whether all is computed, and somebody stands for every input."""
        return self.state == "finished" and not self.inputs.unstated
