"""`size` from its request to its folder: the set of motions and its runs at every value that is tried.

At a value only the runs of the set are computed, not the scan of factors nor the further motions. Rows are logged as
they are ready, so that an interrupted computation continues where it was.
"""

import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple, Unpack

from fem.case.case import Case
from fem.results.folder import ResultFolder
from fem.results.kinds import SIZE
from fem.run.expected import say_expected
from fem.runtime.identity import command_line
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.motion_set import check_set
from fem.site_check.answer import FULFILLED, answer_of, governing_run
from fem.site_check.bodies import body_of
from fem.site_check.bracket import SizeAxis, SizeResult, next_values, size_asked, size_result
from fem.site_check.confirm import confirmed, deciding
from fem.site_check.file import SiteRequest
from fem.site_check.inputs import copy_files, inputs_of, texts_of
from fem.site_check.methods import wind_utilisation
from fem.site_check.motion_results import set_result, write_csv_files
from fem.site_check.motions import floor_motions, ground_motions, longest_period
from fem.site_check.page.figures import draw_size
from fem.site_check.preview import forecast
from fem.site_check.reasons import NOT_FULFILLED
from fem.site_check.result import ConfirmedRun, MotionSet, SiteAnswer
from fem.site_check.run import site_hash
from fem.site_check.runs import COLUMNS, RunCases, RunKey, RunRows, motion_stem
from fem.site_check.size_axis import at, followers
from fem.site_check.stages import Stages
from fem.study.driver import INTERRUPTED, LoggedRuns, Study, StudyOptions, hash_of, run_study
from fem.study.runner import Row, Runner
from fem.study.table import row_of, table_text

RUNS, FIGURE = "runs.csv", "figures/size.svg"
SIZE_COLUMNS = {"value": float} | COLUMNS
WORKING = ".motions"  #: of the sets, as long as they are computed
BYTES_OF_SETS = 50_000_000  #: of motions, as long as they are computed


class SizeKey(NamedTuple):
    """One run at one value."""

    value: float
    run: RunKey


@dataclass(frozen=True, kw_only=True, eq=False)
class SizeCases:
    """Makes the case of a run at a value; picklable."""

    cases: dict[float, RunCases] = field(default_factory=dict)

    def __call__(self, key: SizeKey) -> Case:
        """The case of a run.

        Raises:
            CaseError: its motion is missing.
        """
        return self.cases[key.value](key.run)


@dataclass(kw_only=True, eq=False)
class Tried:
    """The request at a value, with its set of motions."""

    request: SiteRequest
    motions: MotionSet
    stages: Stages
    wind: float | None  #: utilisation under it
    #: the deciding runs, repeated; None: not yet, or not needed
    confirmed: Sequence[ConfirmedRun] | None = None

    @property
    def rows(self) -> RunRows:
        """Of its runs."""
        return self.stages.rows

    @property
    def answer(self) -> SiteAnswer:
        """By the rule, from all runs."""
        beside = self.stages.beside(self.confirmed or (), self.wind)
        return answer_of(self.request, self.motions, self.rows.in_order(), beside)

    def confirm(self, cases: RunCases, jobs: int) -> None:
        """Repeat the deciding runs, where nothing else speaks against the value."""
        if self.confirmed is not None or self.answer.answer != FULFILLED:
            return
        runs = self.rows.in_order()
        governing = governing_run(self.request, self.rows.of(self.stages.plan.of_set()))
        keys = [key for key in deciding(runs, governing) if key not in self.rows.still]
        self.confirmed = confirmed(cases, runs, keys, jobs) if keys else ()


def run_size(
    request: SiteRequest,
    axis: SizeAxis,
    folder: Path,
    *,
    allow_outside: bool = False,
    **options: Unpack[StudyOptions],
) -> SizeResult:
    """Find which values of a key fulfil the rule, into a folder; raises as `run_site`.

    Args:
        axis: the key and the values of the scan.
        allow_outside: take records from outside the folder of the site file.
    """
    ground = _ground(request, allow_outside)
    begun = size_asked(axis, followers(request, axis.key), _command(request, axis))
    study = Study(
        kind=SIZE,
        request=hash_of([site_hash(request, ground), repr(axis)]),
        result=SizeResult,
        begun=begun,
        compute=_Sizing(request=request, axis=axis, begun=begun, allow_outside=allow_outside).compute,
        texts=texts_of(request, SIZE),
        size=BYTES_OF_SETS,
        subject="the result",
        way_out="take fewer motions",
        progress=lambda place: "its runs so far",
    )
    return run_study(study, folder, **options)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sizing:
    """A size under way."""

    request: SiteRequest
    axis: SizeAxis
    begun: SizeResult
    allow_outside: bool
    cases: SizeCases = field(default_factory=SizeCases)
    tried: dict[float, Tried] = field(default_factory=dict)
    #: rows of an earlier attempt, by value, until it is tried
    early: dict[float, list[Row]] = field(default_factory=dict)
    #: motions by the folders that hold them, which values of the container share, and by stem
    made: dict[Path, dict[str, GroundMotion]] = field(default_factory=dict)

    def compute(self, place: ResultFolder, runner: Runner) -> SizeResult:
        """Run what is missing; the values are those that fulfil the rule."""
        began = time.perf_counter()
        copy_files(self.request, place.path)
        try:
            LoggedRuns(
                what="runs",
                path=place.path / RUNS,
                columns=SIZE_COLUMNS,
                make=self.cases,
                model_of=lambda key: key.run.model,
                key=lambda key: (key.value, *key.run),
                note=self.note,
            ).run(runner, self.batches(runner, place.path / WORKING))
        finally:
            shutil.rmtree(place.path / WORKING, ignore_errors=True)
        if runner.stop():
            return replace(self.begun, status=INTERRUPTED, missing=self.missing())
        place.check()
        result = size_result(self.axis, self.answers(), self.begun)
        place.write_text(RUNS, self.table())
        place.write_text(FIGURE, draw_size(result, inputs_of(self.request)))
        return replace(result, wall_s=time.perf_counter() - began)

    def missing(self) -> str:
        """What an interrupted computation has not come to, in words."""
        scanned = [self.tried[value] for value in self.axis.values if value in self.tried]
        done = sum(not tried.rows.missing(tried.stages.plan.of_set()) for tried in scanned)
        if done < len(self.axis.values):
            return f"{done} of {len(self.axis.values)} values of the scan have the runs of the set"
        return "repetitions, deciding runs or values between those of the scan are missing"

    def batches(self, runner: Runner, working: Path) -> Iterator[Sequence[SizeKey]]:
        """The missing runs of the values to be tried next, stage by stage, as long as there are any."""
        while not runner.stop() and (values := next_values(self.axis, self.answers())):
            for value in values:
                self._try(value, working)
            self._say_expected(values, runner)
            under_way = {value: self._stages(value, runner) for value in values}
            while under_way:
                batch: list[SizeKey] = []
                for value, stages in list(under_way.items()):
                    if (keys := next(stages, None)) is None:
                        del under_way[value]
                    else:
                        batch += [SizeKey(value, key) for key in keys]
                yield batch
            for value in values:
                if not runner.stop():
                    self.tried[value].confirm(self.cases.cases[value], runner.jobs)

    def _say_expected(self, values: Sequence[float], runner: Runner) -> None:
        """How long the runs of these values take at most, without the deciding ones."""
        each = [forecast(self.tried[value].stages, runner.jobs, scan=False) for value in values]
        what = f"{len(values)} value{'s' * (len(values) > 1)}, up to {sum(value.most for value in each)} runs"
        say_expected(runner.reporter, what, sum(value.seconds for value in each), runner.jobs)

    def _stages(self, value: float, runner: Runner) -> Iterator[Sequence[RunKey]]:
        """The runs of a value, until it is known not to fulfil the rule."""
        tried = self.tried[value]
        if not tried.motions.valid:
            return
        for keys in tried.stages.of_the_answer(runner):
            yield keys
            if tried.answer.answer == NOT_FULFILLED:
                return

    def answers(self) -> dict[float, SiteAnswer]:
        """By value, as far as they were tried."""
        return {value: tried.answer for value, tried in self.tried.items()}

    def table(self) -> str:
        """`runs.csv`: by value, and in the order of each verification, whatever the order in which runs ended."""
        rows = (
            (value, *tried.rows.rows[key].values())
            for value, tried in sorted(self.tried.items())
            for key in tried.rows.in_order()
        )
        return table_text(SIZE_COLUMNS, rows)

    def note(self, line: str) -> None:
        """Add a line of the log."""
        row = row_of(SIZE_COLUMNS, line)
        value = row.pop("value")
        if (tried := self.tried.get(value)) is not None:
            tried.rows.add(row)
        else:
            self.early.setdefault(value, []).append(row)

    def _try(self, value: float, working: Path) -> None:
        """Make the motions of a value, and the cases of its runs."""
        request = at(self.request, self.axis, value)
        bodies = [body_of(variant) for variant in request.variants]
        longest = longest_period(bodies)
        ground = ground_motions(request, longest, allow_outside=self.allow_outside)
        floors = floor_motions(request, ground)
        folder = written_motions(request, floors, longest, working)
        stages = Stages.of(
            request, floors, longest=longest, folder=folder, made=self.made.setdefault(folder, {})
        )
        checked = check_set(
            ground, stages.target, longest=longest, second=request.motions.second_component or 1.0
        )
        self.tried[value] = tried = Tried(
            request=request,
            motions=set_result(request, checked, ground, ()),
            stages=stages,
            wind=wind_utilisation(bodies, inputs_of(request)),
        )
        self.cases.cases[value] = RunCases.of(request, folder)
        for row in self.early.pop(value, []):
            tried.rows.add(row)


def written_motions(
    request: SiteRequest, floors: Mapping[float | None, Sequence[GroundMotion]], longest: float, working: Path
) -> Path:
    """The folder of these motions, and of the further ones that go with them; values of the container share it."""
    table = request.motions
    # what the further motions depend on, which the set does not where it is one of records
    further = (
        request.floor_target or request.action,
        request.building,
        longest,
        table.seed,
        table.stationary_s,
        table.vertical,
        table.second_component,
    )
    digest = sha256(repr(further).encode())
    for component in (part for floor in floors.values() for motion in floor for part in motion.components):
        digest.update(component.tobytes())
    folder = working / digest.hexdigest()[:16]
    if not folder.exists():
        folder.mkdir(parents=True)
        for period, floor in floors.items():
            for number, motion in enumerate(floor, start=1):
                write_csv_files(folder, motion, motion_stem(number, period))
    return folder


def _ground(request: SiteRequest, allow_outside: bool) -> list[GroundMotion]:
    longest = longest_period([*map(body_of, request.variants)])
    return ground_motions(request, longest, allow_outside=allow_outside)


def _command(request: SiteRequest, axis: SizeAxis) -> str:
    first, last = axis.values[0], axis.values[-1]
    ends = ("--from", f"{first:g}", "--to", f"{last:g}", "--count", str(len(axis.values)))
    return command_line("size", request.origin.place, "--over", axis.key, *ends)
