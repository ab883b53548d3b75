"""The runs of a verification stage by stage: each is asked for when the one before is there."""

import math
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from fem.model.resting import KEPT, BodyAtRest
from fem.results.outcome import Outcome
from fem.run.sureness import values_to_try
from fem.runtime.arrays import FloatArray
from fem.seismic.action import MotionTarget
from fem.seismic.artificial import artificial_motions
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.motion_set import MotionSetCheck, check_set
from fem.seismic.two_directions import largest_slip, largest_slips
from fem.site.methods import wind_utilisation
from fem.site.motions import (
    floor_motions,
    ground_motions,
    longest_period,
    motion_target,
    on_floor,
    write_csv_files,
)
from fem.site.request import FULL, WIDTH, SiteRequest
from fem.site.result import (
    FURTHER,
    REFINED,
    REPEATED,
    SCAN,
    SET,
    STAGES,
    RunKey,
    SiteBody,
    SiteRun,
    TwoDirections,
    motion_stem,
)
from fem.site.rule import MotionSlips, RunGroup, governing_groups, groups_of, rule_of, runs_by_factor
from fem.site.runs import (
    FOUND,
    KEYS,
    NOT_COMPUTED,
    at_rest_by_the_bound,
    bodies_of,
    cells_of,
    key_of,
)
from fem.study.runner import Row, Runner

#: factors on the motions beside 1, and values tried below the first that fails and below the first that overturns
SCANNED = (0.5, 0.75, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0)
BETWEEN = 3
#: factors of the repetitions: nobody can tell such motions from those of the set, rocking can
REPETITIONS = (1.0 - 1e-4, 1.0 - 1e-5, 1.0 + 1e-6, 1.0 + 1e-5, 1.0 + 1e-4)
#: processor time from which it tells the load of the machine [s], and the most that is believed
LEAST_MEASURED_S, MOST_LOAD = 0.2, 10.0
FIRST_FURTHER = 10_000  #: numbers of the artificial motions beyond the set begin behind those of any set
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
    bodies: tuple[SiteBody, ...]  #: the containers
    ground: Sequence[GroundMotion]  #: motions of the set
    floors: Mapping[float | None, Sequence[GroundMotion]]  #: on the floor, by building period
    longest: float  #: period of the band [s]
    target: MotionTarget  #: of the motions
    wind: float | None  #: the largest utilisation under it; None: it was not asked for
    resting: Mapping[
        tuple[str, str], BodyAtRest
    ]  #: by weight and elevation, those that a bound may show at rest
    motions: dict[str, GroundMotion]  #: on the floor, and further ones, by the stems of their files
    folder: Path  #: that holds the motions
    quick: bool = False  #: the set and its repetitions alone, but of a container that rests in the whole set
    runs: dict[RunKey, SiteRun] = field(default_factory=dict)  #: so far
    rows: dict[RunKey, Row] = field(default_factory=dict)  #: of them in the log
    still: set[RunKey] = field(default_factory=set)  #: those at rest that were not computed
    #: factors at which a body first moves
    moves: dict[tuple[str, str, str, int, float], float] = field(default_factory=dict)
    began: float  #: when it was asked for [s]
    load: float  #: wall time over processor time in which the motions were made

    @classmethod
    def of(
        cls, request: SiteRequest, folder: Path, *, allow_outside: bool = False, quick: bool = False
    ) -> "Stages":
        """For a request whose runs read their motions from a folder.

        Raises:
            CaseError, MeshError: a record or a container that cannot be used.
        """
        began, used = time.perf_counter(), time.process_time()
        bodies = bodies_of(request)
        longest = longest_period(bodies)
        ground = ground_motions(request, longest, allow_outside=allow_outside)
        floors = floor_motions(request, ground)
        load = (time.perf_counter() - began) / max(time.process_time() - used, LEAST_MEASURED_S)
        motions = {
            motion_stem(number, period): motion
            for period, floor in floors.items()
            for number, motion in enumerate(floor, start=1)
        }
        return cls(
            request=request,
            bodies=bodies,
            ground=ground,
            floors=floors,
            longest=longest,
            target=motion_target(request, ground, longest),
            wind=wind_utilisation(bodies, request.inputs),
            resting=at_rest_by_the_bound(request),
            motions=motions,
            folder=folder,
            quick=quick,
            began=began,
            load=min(max(load, 1.0), MOST_LOAD),
        )

    @cached_property
    def checked(self) -> MotionSetCheck:
        """What the checks of the set found."""
        second = self.request.motions.second_component
        return check_set(self.ground, self.target, longest=self.longest, second=second or 1.0)

    def add(self, row: Row) -> None:
        """Add the row of a run."""
        key = key_of(row)
        self.runs[key] = SiteRun(**vars(key), **{name: row[name] for name in FOUND})
        self.rows[key] = row

    def in_order(self) -> dict[RunKey, SiteRun]:
        """All runs, stage by stage: not in the order in which they were ready, which depends on the cores."""

        def place(key: RunKey) -> tuple[Any, ...]:
            container = key.mass != FULL, key.elevation != WIDTH, key.building_period_s or 0.0
            friction = key.mu_static, key.mu_kinetic
            return STAGES.index(key.stage), key.factor, *container, *friction, key.motion, -key.vertical_sign

        return {key: self.runs[key] for key in sorted(self.runs, key=place)}

    def found(self, keys: Iterable[RunKey]) -> list[SiteRun]:
        """The runs of these keys, in their order, as far as they are there."""
        return [self.runs[key] for key in keys if key in self.runs]

    @property
    def signs(self) -> tuple[int, ...]:
        """Of the vertical component."""
        return (0,) if self.ground[0].vertical is None else (1, -1)

    def of_set(self) -> list[RunKey]:
        """Every motion with both signs, over weights, elevations, periods and frictions."""
        return [
            RunKey(
                motion=motion,
                vertical_sign=sign,
                mu_static=mu_static,
                mu_kinetic=mu_kinetic,
                mass=mass,
                elevation=elevation,
                building_period_s=period,
                model=self.request.heading.model,
            )
            for (mass, elevation), period in product(self.request.variants, self.floors)
            for mu_static, mu_kinetic in self.request.frictions
            for motion, sign in product(range(1, len(self.ground) + 1), self.signs)
        ]

    def scanned(self, factor: float) -> list[RunKey]:
        """All runs of the set at another factor."""
        return [replace(key, stage=SCAN, factor=factor) for key in self.of_set()]

    def refined(self) -> list[RunKey]:
        """Runs between the first factor at which a run overturns, or the rule fails, and the factor below.

        Where the rule fails, all runs of the groups that fail: it may count their mean.
        """
        by_factor = runs_by_factor(self.runs, SET, SCAN)  # by rising factor
        wanted: dict[RunKey, None] = {}

        def failing(runs: Sequence[SiteRun]) -> list[SiteRun]:
            groups = (group for group in groups_of(runs) if group.by_rule.fails(self.request.limits))
            return [run for group in groups for run in group.runs]

        def overturned(runs: Sequence[SiteRun]) -> list[SiteRun]:
            return [run for run in runs if run.outcome == Outcome.OVERTURNED]

        for runs_of in (failing, overturned):
            first = next((factor for factor, runs in by_factor.items() if runs_of(runs)), None)
            if first is not None:
                known = {factor: str(factor == first) for factor in by_factor if factor <= first}
                keys = [*map(key_of, runs_of(by_factor[first]))]
                for factor in values_to_try(known, resolution=0.0, inner=BETWEEN):
                    wanted |= dict.fromkeys(replace(key, stage=REFINED, factor=factor) for key in keys)
        return list(wanted)

    def of_further(self, groups: Iterable[RunGroup], count: int) -> list[RunKey]:
        """Further motions with both signs, for the containers and frictions of these groups."""
        return [
            replace(key_of(group.first), stage=FURTHER, motion=number, vertical_sign=sign)
            for group in groups
            for number in range(1, count + 1)
            for sign in self.signs
        ]

    def of_the_answer(self, runner: Runner) -> Iterator[Sequence[RunKey]]:
        """The set, its repetitions and the further motions: all that the answer rests on but the deciding runs.

        The workers of the runner make the further motions.
        """
        yield self._left(self.of_set())
        groups = governing_groups(groups_of(self.found(self.of_set())))
        own = [key_of(run) for group in groups for run in group.runs]
        yield self._left(
            [replace(key, stage=REPEATED, factor=factor) for factor in REPETITIONS for key in own]
        )
        if not self.has_further:
            return
        further = self.of_further(groups, self.request.motions.further)
        self._make(runner, [key for key in further if key.stem not in self.motions])
        if not runner.stop():
            yield self._left(further)

    @property
    def has_further(self) -> bool:
        """Whether further motions are computed: with `quick` only where the whole set rests, and they cost little."""
        return self.rests or not self.quick

    @property
    def rests(self) -> bool:
        """Whether no run of the set need be computed."""
        return all(self.at_rest(key) for key in self.of_set())

    def most_runs(self, *, scan: bool = True) -> tuple[int, int]:
        """Runs of the set that must be computed, and of all stages at most, without the deciding ones.

        `scan`: with the set at other factors.
        """

        def left(keys: Sequence[RunKey]) -> int:
            return sum(not self.at_rest(key) for key in keys)

        own = left(self.of_set())
        masses = len({mass for mass, _ in self.request.variants})
        of_a_group = len(self.ground) * len(self.signs)
        of_a_mass = len(self.of_set()) // (of_a_group * masses)  # groups, of which two govern
        pairs = min(2, of_a_mass) * masses if own else 0
        most = own + pairs * of_a_group * len(REPETITIONS)
        if self.quick:
            return own, most
        most += pairs * self.request.motions.further * len(self.signs)
        if scan:
            most += self.most_scanned
        return own, most

    @property
    def most_scanned(self) -> int:
        """Runs of the set at other factors that must be computed at most."""
        return sum(not self.at_rest(key) for factor in SCANNED for key in self.scanned(factor))

    def of_the_margin(self) -> Iterator[Sequence[RunKey]]:
        """The set at other factors, up to the first at which a run overturns, and between.

        For a container that rests in the whole set, up to the first at which the rule fails: that is far enough.
        """
        before = SET, 1.0
        for factor in SCANNED:
            if factor > 1.0:
                own = (run for key, run in self.runs.items() if (key.stage, key.factor) == before)
                tally = rule_of(groups_of(own))
                if tally.not_standing or (self.rests and tally.fails(self.request.limits)):
                    break
                before = SCAN, factor
            yield self._left(self.scanned(factor))
        yield self._left(self.refined())

    def moves_at(self, key: RunKey) -> float | None:
        """The factor on the motion of a run at which its body first moves; None where that is not known."""
        body, motion = self.resting.get((key.mass, key.elevation)), self.motions.get(key.stem)
        if body is None or motion is None:
            return None
        what = key.mass, key.elevation, key.stem, key.vertical_sign, key.mu_static
        if what not in self.moves:
            upward = 0.0 if motion.vertical is None else key.vertical_sign * motion.vertical
            self.moves[what] = body.moves_at(motion.horizontal, upward, key.mu_static)
        return self.moves[what]

    def used(self, key: RunKey) -> float | None:
        """The factor on the motion of a run over that at which its body first moves; None where that is not known."""
        factor = self.moves_at(key)
        return None if factor is None else key.factor / factor if factor > 0.0 else math.inf

    def at_rest(self, key: RunKey) -> bool:
        """Whether a run need not be computed."""
        used = self.used(key)
        return used is not None and used < KEPT

    @property
    def first_movement(self) -> float | None:
        """Factor on the motions at which a rigid body first uplifts or slips; None where that is not known."""
        factors = [self.moves_at(key) for key in self.of_set()]
        return None if None in factors else min(factor for factor in factors if factor is not None)

    def beside(self) -> dict[str, Any]:
        """What the answer rests on beside the runs, as `answer_of` takes it."""
        on_a_slope = self.request.container.floor.slope_percent
        unknown = ON_A_SLOPE if on_a_slope else NO_SECOND if self._lacks_second else ""
        return {
            "wind": self.wind,
            "two_directions": self._two_directions(),
            "slips_of_further": self._slips_of_further(),
            "in_plane_only": unknown if self.request.motions.second_component else "",
            "still": sum(key.stage == SET for key in self.still),
            "moves_at": self.first_movement,
        }

    @property
    def _lacks_second(self) -> bool:
        """Whether a motion has no second horizontal component."""
        return any(motion.second is None for floor in self.floors.values() for motion in floor)

    def _two_directions(self) -> TwoDirections | None:
        """How far the container slides in both directions if it does not rock; None where that is not known.

        On a sloping floor it is not: a body that has no preferred direction would also creep downhill.
        """
        gravity = self.request.container.gravity_m_s2
        if self.request.container.floor.slope_percent or self._lacks_second:
            return None
        slips = {
            (period, pair): slid
            for period, motions in self.floors.items()
            for pair, slid in largest_slips(motions, self.request.frictions, gravity=gravity).items()
        }
        longest = max(slips, key=lambda what: float(slips[what].mean()))
        worst = max(slips, key=lambda what: float(slips[what].max()))
        period, pair = worst

        def in_plane(period: float | None, pair: tuple[float, float]) -> FloatArray:
            motions = [replace(motion, second=None) for motion in self.floors[period]]
            return largest_slips(motions, [pair], gravity=gravity)[pair]

        def largest(factor: float) -> float:
            return max(
                largest_slip(motion.scaled(factor), pair, gravity=gravity) for motion in self.floors[period]
            )

        limit = self.request.limits.slip_m
        tried = sorted({1.0, *(key.factor for key in self.runs if key.stage in (SET, SCAN))})
        most = float(slips[worst].max())
        alike = [most, *map(largest, REPETITIONS)]
        return TwoDirections(
            slip_mean_m=float(slips[longest].mean()),
            slip_largest_m=most,
            slip_mean_in_plane_m=float(in_plane(*longest).mean()),
            slip_largest_in_plane_m=float(in_plane(*worst).max()),
            mu_static=pair[0],
            mu_kinetic=pair[1],
            motion=1 + int(np.argmax(slips[worst])),
            building_period_s=period,
            margin_factor=next((factor for factor in tried if largest(factor) > limit), None),
            slip_range_m=(min(alike), max(alike)),
        )

    def _slips_of_further(self) -> MotionSlips:
        """How far the container slides in both directions under each further motion; empty where that is not known."""
        box = self.request.container
        if box.floor.slope_percent or not self.request.motions.second_component:
            return {}
        slips: dict[tuple[int, float | None, float, float], float] = {}
        for key in self.runs:
            what = key.motion, key.building_period_s, key.mu_static, key.mu_kinetic
            if key.stage == FURTHER and what not in slips:
                motion = self.motions[key.stem]
                slips[what] = largest_slip(motion, what[2:], gravity=box.gravity_m_s2)
        return slips

    def _left(self, keys: Sequence[RunKey]) -> list[RunKey]:
        """Those that must be computed, by their motions; those at rest by the rigid bound are noted."""
        left = []
        for key in keys:
            if key in self.runs:
                continue
            if self.at_rest(key):
                self.still.add(key)
                cells = dict(zip(KEYS, cells_of(key), strict=True))
                found = {**dict.fromkeys(FOUND, 0.0), "outcome": Outcome.REST, "reason": NOT_COMPUTED}
                self.add(cells | found)
            else:
                left.append(key)
        return sorted(left, key=lambda key: (key.factor, key.stem, key.vertical_sign))

    def _make(self, runner: Runner, keys: Sequence[RunKey]) -> None:
        """Let the workers make the further motions of these runs, with their files."""
        for period in dict.fromkeys(key.building_period_s for key in keys):
            numbers = sorted({key.motion for key in keys if key.building_period_s == period})
            make = partial(
                further_motion,
                self.request,
                self.target,
                self.ground[0].vertical is not None,
                self.longest,
                period,
                self.folder,
            )
            asked = zip(numbers, numbers, strict=True)
            for number, motion in runner.found("further motions made", asked, make):
                if isinstance(motion, ValueError):
                    raise motion
                self.motions[motion_stem(number, period, FURTHER)] = motion


def further_motion(
    request: SiteRequest,
    target: MotionTarget,
    vertical: bool,
    longest: float,
    period: float | None,
    folder: Path,
    number: int,
) -> GroundMotion:
    """An artificial motion beyond the set, on the floor of a building of this period or on the ground (None).

    Its files are written in the folder.
    """
    table = request.motions
    (motion,) = artificial_motions(
        target,
        count=1,
        seed=table.seed,
        stationary=table.stationary_s,
        longest=longest,
        vertical=vertical,
        second=table.second_component,
        first=FIRST_FURTHER + number,
        passes=FURTHER_PASSES,
    )
    moved = on_floor(request.building, motion, period)
    write_csv_files(folder, replace(moved, second=None), motion_stem(number, period, FURTHER))
    return moved
