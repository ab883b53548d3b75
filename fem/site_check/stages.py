"""The runs of a verification stage by stage: each is asked for when the one before is there."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from fem.seismic.action import MotionTarget
from fem.seismic.artificial import artificial_motions
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.two_directions import largest_slip, slip_in_two_directions
from fem.site_check.answer import Beside, MotionSlips
from fem.site_check.file import SiteRequest
from fem.site_check.motion_results import write_csv_files
from fem.site_check.motions import motion_target, on_floor
from fem.site_check.result import ConfirmedRun, SiteBody, TwoDirections
from fem.site_check.rule import RuleFound, governing_groups, groups_of
from fem.site_check.runs import FURTHER, HAZARD, REPETITIONS, SCAN, SET, RunKey, RunPlan, RunRows, motion_stem
from fem.site_check.screening import Screening
from fem.site_check.yearly import annual_rates, hazard_motions, hazard_runs, rocking_most
from fem.study.runner import Runner
from fem.study.workers import hand_out

#: numbers of the artificial motions beyond the set begin behind those of any set
FIRST_FURTHER, FIRST_OF_HAZARD = 10_000, 100_000
FURTHER_PASSES = 15  #: in which those are matched: they are many, and nobody compares one with the target
#: why the slip in two directions is not known
ON_A_SLOPE = (
    "Slip under both horizontal components at once is not computed on a sloping floor: how far it slides there is not "
    "known."
)
NO_SECOND = (
    "The motions have no second horizontal component: how far it slides under both at once is not known (records: the "
    "third file of each)."
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Stages:
    """The runs of one request, and what is known of them."""

    request: SiteRequest
    plan: RunPlan
    screening: Screening
    floors: Mapping[float | None, Sequence[GroundMotion]]  #: by building period
    longest: float  #: period of the band [s]
    target: MotionTarget  #: of the motions
    folder: Path  #: that holds the motions
    rows: RunRows = field(default_factory=RunRows)

    @classmethod
    def of(
        cls,
        request: SiteRequest,
        floors: Mapping[float | None, Sequence[GroundMotion]],
        *,
        longest: float,
        folder: Path,
        made: dict[str, GroundMotion] | None = None,
    ) -> "Stages":
        """For a request and the motions of its set, by building period.

        Args:
            request: what is asked.
            floors: the motions of the set.
            longest: period of the band [s].
            folder: that holds the motions.
            made: the motions that are in the folder already, by stem; further ones are added.

        Raises:
            CaseError, MeshError: a container cannot be built.
        """
        any_floor = next(iter(floors.values()))
        plan = RunPlan(
            request=request,
            motions=len(any_floor),
            vertical=any_floor[0].vertical is not None,
            periods=tuple(floors),
        )
        screening = Screening.of(request, {} if made is None else made)
        for period, floor in floors.items():
            for number, motion in enumerate(floor, start=1):
                screening.motions[motion_stem(number, period)] = motion
        return cls(
            request=request,
            plan=plan,
            screening=screening,
            floors=floors,
            longest=longest,
            target=motion_target(request, any_floor, longest),
            folder=folder,
        )

    def of_the_answer(self, runner: Runner, *, quick: bool = False) -> Iterator[Sequence[RunKey]]:
        """The set, its repetitions and the further motions: all that the answer rests on but the deciding runs.

        Args:
            runner: lets its workers make the further motions.
            quick: none of these, unless the container rests in the whole set, where they cost next to nothing.
        """
        yield self._left(self.plan.of_set())
        groups = governing_groups(groups_of(self.rows.of(self.plan.of_set())))
        yield self._left(self.plan.repeated(groups))
        if quick and not self.rests:
            return
        further = self.plan.of_further(groups, self.request.motions.further)
        self._make(runner, [key for key in further if key.stem not in self.screening.motions])
        if not runner.stop():
            yield self._left(further)

    @property
    def rests(self) -> bool:
        """Whether no run of the set need be computed."""
        return all(self.screening.at_rest(key) for key in self.plan.of_set())

    def most_runs(self, *, quick: bool = False, scan: bool = True) -> tuple[int, int]:
        """Runs of the set that must be computed, and of all stages at most, without the deciding ones.

        Args:
            quick: the set and its repetitions alone.
            scan: with the set at other factors, and the levels of the rate per year.
        """

        def left(keys: Sequence[RunKey]) -> int:
            return sum(not self.screening.at_rest(key) for key in keys)

        own = left(self.plan.of_set())
        masses = len({variant.mass for variant in self.request.variants})
        of_a_group = self.plan.motions * len(self.plan.signs)
        of_a_mass = len(self.plan.of_set()) // (of_a_group * masses)  # groups, of which two govern
        pairs = min(2, of_a_mass) * masses if own else 0
        most = own + pairs * of_a_group * len(REPETITIONS)
        if quick:
            return own, most
        most += pairs * self.request.motions.further * len(self.plan.signs)
        if scan:
            most += hazard_motions(self.request)
            most += sum(left(self.plan.scanned(factor)) for factor in self.plan.factors)
        return own, most

    def of_the_margin(self) -> Iterator[Sequence[RunKey]]:
        """The set at other factors, up to the first at which a run overturns, and between.

        For a container that rests in the whole set, up to the first at which the rule fails: that is far enough.
        """
        before = SET, 1.0
        for factor in self.plan.factors:
            if factor > 1.0:
                own = (run for key, run in self.rows.runs.items() if (key.stage, key.factor) == before)
                tally = RuleFound.of(groups_of(own))
                if tally.overturned + tally.invalid or (self.rests and tally.fails(self.request.limits)):
                    break
                before = SCAN, factor
            yield self._left(self.plan.scanned(factor))
        yield self._left(self.plan.refined(self.rows.runs))

    @property
    def first_movement(self) -> float | None:
        """Factor on the motions at which a rigid body first uplifts or slips; None where that is not known."""
        factors = [self.screening.moves_at(key) for key in self.plan.of_set()]
        return None if None in factors else min(factor for factor in factors if factor is not None)

    def of_the_hazard(self, runner: Runner, bodies: Sequence[SiteBody]) -> Iterator[Sequence[RunKey]]:
        """Motions at several levels, where a hazard was given."""
        own = self.rows.of(self.plan.of_set())
        if self.request.hazard is None or runner.stop() or not own:
            return
        groups = groups_of(own)
        floor = self.floors[rocking_most(groups, bodies).first.building_period_s]
        keys = hazard_runs(groups, bodies, floor, self.request.hazard.motions)
        self._make(runner, keys)
        if not runner.stop():
            yield self._left(keys)

    def beside(
        self,
        confirmed: Sequence[ConfirmedRun],
        wind: float | None,
        bodies: Sequence[SiteBody] = (),
        peak_velocity: float = 0.0,
    ) -> Beside:
        """What the answer rests on beside the runs.

        Args:
            bodies: of all containers, and peak_velocity: mean of the set on the ground [m/s]; for the hazard.
            confirmed: the deciding runs, repeated.
            wind: the largest utilisation under wind; None: it was not asked for.
        """
        slid = self._two_directions()
        return Beside(
            confirmed=confirmed,
            wind=wind,
            two_directions=slid,
            slips_of_further=self._slips_of_further(),
            in_plane_only=self._in_plane_only,
            hazard=annual_rates(
                self.request, self.rows.in_order(), self.screening.motions, bodies, slid, peak_velocity
            ),
            still=sum(key.stage == SET for key in self.rows.still),
            moves_at=self.first_movement,
        )

    @property
    def _in_plane_only(self) -> str:
        """Why the slip in two directions, which was asked for, is not known, in words; empty: it is."""
        if not self.request.motions.second_component:
            return ""
        if self.request.container.floor.slope_percent:
            return ON_A_SLOPE
        lacking = any(motion.second is None for floor in self.floors.values() for motion in floor)
        return NO_SECOND if lacking else ""

    def _two_directions(self) -> TwoDirections | None:
        """How far the container slides in both directions if it does not rock; None where that is not known.

        On a sloping floor it is not: a body that has no preferred direction would also creep downhill.
        """
        box, pairs = self.request.container, self.request.frictions
        if box.floor.slope_percent:
            return None
        gravity = box.gravity_m_s2
        slips = {
            period: slip_in_two_directions(motions, pairs, gravity=gravity)
            for period, motions in self.floors.items()
        }
        known = {period: slip for period, slip in slips.items() if slip is not None}
        if not known:
            return None
        worst = max(known, key=lambda period: known[period].largest)
        longest, first = max(known.values(), key=lambda slip: slip.mean), known[worst]
        pair = first.mu_static, first.mu_kinetic

        def largest(factor: float) -> float:
            return max(
                largest_slip(motion.scaled(factor), pair, gravity=gravity) for motion in self.floors[worst]
            )

        def too_far(factor: float) -> bool:
            return largest(factor) > self.request.limits.slip_m

        tried = sorted({1.0, *(key.factor for key in self.rows.runs if key.stage in (SET, SCAN))})
        alike = [first.largest, *map(largest, REPETITIONS)]
        return TwoDirections(
            slip_mean_m=longest.mean,
            slip_largest_m=first.largest,
            slip_mean_in_plane_m=longest.mean_in_plane,
            mu_static=first.mu_static,
            mu_kinetic=first.mu_kinetic,
            motion=first.motion,
            building_period_s=worst,
            margin_factor=next(filter(too_far, tried), None),
            slip_range_m=(min(alike), max(alike)),
        )

    def _slips_of_further(self) -> MotionSlips:
        """How far the container slides in both directions under each further motion; empty where that is not known."""
        box = self.request.container
        if box.floor.slope_percent or not self.request.motions.second_component:
            return {}
        slips: dict[tuple[int, float | None, float, float], float] = {}
        for key in self.rows.runs:
            what = key.motion, key.building_period_s, key.mu_static, key.mu_kinetic
            if key.stage == FURTHER and what not in slips:
                motion = self.screening.motions[key.stem]
                slips[what] = largest_slip(motion, what[2:], gravity=box.gravity_m_s2)
        return slips

    def _left(self, keys: Sequence[RunKey]) -> list[RunKey]:
        """Those that must be computed, by their motions; those at rest by the rigid bound are noted."""
        left = []
        for key in self.rows.missing(keys):
            if self.screening.at_rest(key):
                self.rows.rest(key)
            else:
                left.append(key)
        return sorted(left, key=lambda key: (key.factor, key.stem, key.vertical_sign))

    def _make(self, runner: Runner, keys: Sequence[RunKey]) -> None:
        """Let the workers make the further motions of these runs, with their files."""
        for period in dict.fromkeys(key.building_period_s for key in keys):
            numbers = sorted({key.motion for key in keys if key.building_period_s == period})
            stage = keys[0].stage
            make = partial(
                further_motions,
                self.request,
                self.target,
                self.plan.vertical,
                self.longest,
                period,
                stage,
                self.folder,
            )
            pools = runner.workers_of(self.request.heading.model, len(keys))
            for chunk, made in hand_out(numbers, make, pools, at_a_time=4, stop=runner.stop):
                for number, motion in zip(chunk, made, strict=True):
                    self.screening.motions[motion_stem(number, period, stage)] = motion


def further_motions(
    request: SiteRequest,
    target: MotionTarget,
    vertical: bool,
    longest: float,
    period: float | None,
    stage: str,
    folder: Path,
    numbers: Sequence[int],
) -> list[GroundMotion]:
    """Artificial motions beyond the set, on the floor of a building of this period or on the ground (None).

    Their files are written in the folder.
    """
    table, made = request.motions, []
    first = FIRST_OF_HAZARD if stage == HAZARD else FIRST_FURTHER
    for number in numbers:
        (motion,) = artificial_motions(
            target,
            count=1,
            seed=table.seed,
            stationary=table.stationary_s,
            longest=longest,
            vertical=vertical,
            second=table.second_component,
            first=first + number,
            passes=FURTHER_PASSES,
        )
        moved = on_floor(request.building, motion, period)
        write_csv_files(folder, replace(moved, second=None), motion_stem(number, period, stage))
        made.append(moved)
    return made
