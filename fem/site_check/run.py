"""A verification from its file to its folder: motions and their checks, runs, answer, simplified methods, page.

Rows are logged as they are ready, so that an interrupted verification continues where it was; the result depends
neither on that nor on the number of cores.
"""

import hashlib
import platform
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Unpack

from fem.case.case import case_hash
from fem.html.page import Signature
from fem.results.disk import table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import SITE
from fem.runtime.identity import command_line, versions
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.motion_set import MotionSetCheck, check_set
from fem.site_check.answer import answer_of, governing_run, no_answer_yet
from fem.site_check.bodies import body_of
from fem.site_check.confirm import confirmed, deciding
from fem.site_check.file import SiteRequest
from fem.site_check.inputs import copy_files, inputs_of, left_elsewhere, texts_of
from fem.site_check.methods import site_methods, wind_utilisation
from fem.site_check.motion_results import (
    action_result,
    floor_result,
    set_result,
    write_csv_files,
    write_ground,
)
from fem.site_check.motions import floor_motions, ground_motions, longest_period
from fem.site_check.page.site_page import site_report
from fem.site_check.preview import forecast
from fem.site_check.result import (
    MOTIONS,
    MotionSet,
    SiteAnswer,
    SiteBody,
    SiteProvenance,
    SiteResult,
    SiteRun,
)
from fem.site_check.runs import COLUMNS, HAZARD, RunCases, RunKey, motion_stem
from fem.site_check.stages import Stages
from fem.site_check.yearly import hazard_motions
from fem.study.driver import COMPLETED, INTERRUPTED, LoggedRuns, Study, StudyOptions, hash_of, run_study
from fem.study.runner import Runner

RUNS, PAGE = "runs.csv", "report.html"
OF_A_MOTION = 75_000  #: numbers, in three files
QUICK = (
    "Left out by --quick: further motions, other factors on the motions, the deciding runs with their bands."
)
TIMES_THE_SET = 20  #: runs of all stages over those of the set


def run_site(
    request: SiteRequest,
    folder: Path,
    *,
    allow_outside: bool = False,
    quick: bool = False,
    copy_records: bool = True,
    **options: Unpack[StudyOptions],
) -> SiteResult:
    """Verify a container at a site, into a folder; raises as `run_study`, and CaseError for bad input.

    Args:
        allow_outside: take records from outside the folder of the site file.
        quick: the set and its repetitions alone; "fulfilled" then only of a container that rests.
        copy_records: copy the records that the site file names, so that the folder can be repeated by itself.
    """
    began = time.perf_counter()
    bodies = tuple(map(body_of, request.variants))
    longest = longest_period(bodies)
    ground = ground_motions(request, longest, allow_outside=allow_outside)
    floors = floor_motions(request, ground)
    stages = Stages.of(request, floors, longest=longest, folder=folder)
    files = len(ground) * (1 + len(floors)) + request.motions.further + hazard_motions(request)
    digest = hash_of([site_hash(request, ground), "quick"]) if quick else site_hash(request, ground)
    work = _Verification(
        request=request,
        stages=stages,
        bodies=bodies,
        ground=ground,
        wind=wind_utilisation(bodies, inputs_of(request)),
        digest=digest,
        quick=quick,
        copy_records=copy_records,
        began=began,
    )
    study = Study(
        kind=SITE,
        request=digest,
        result=SiteResult,
        compute=work.compute,
        texts=texts_of(request, SITE, records=copy_records),
        size=table_bytes(files, OF_A_MOTION)
        + table_bytes(TIMES_THE_SET * len(stages.plan.of_set()), len(COLUMNS)),
        subject="the verification",
        way_out="take fewer motions",
        progress=lambda place: "its runs so far",
    )
    return run_study(study, folder, **options)


def site_hash(request: SiteRequest, ground: Sequence[GroundMotion]) -> str:
    """Equal for requests that give the same result."""
    for_people = ("title", "document", "sources", "container")
    data = {key: value for key, value in request.portable.items() if key not in for_people}
    digest = hashlib.sha256()
    for motion in ground:
        for component in motion.components:
            digest.update(component.tobytes())
    if (curve := request.hazard_curve) is not None:  # of its file the request has the name alone
        digest.update(curve.measure.encode() + curve.strengths.tobytes() + curve.rates.tobytes())
    if (floor := request.floor_target) is not None:  # likewise
        points = floor.periods, floor.accelerations, floor.vertical_accelerations
        digest.update(repr(points).encode())
    return hash_of([data, case_hash(request.container), digest.hexdigest()])


@dataclass(frozen=True, kw_only=True, eq=False)
class _Verification:
    """What is asked, and its motions."""

    request: SiteRequest
    stages: Stages
    bodies: tuple[SiteBody, ...]
    ground: Sequence[GroundMotion]  #: motions of the set
    wind: float | None  #: the largest utilisation under it
    digest: str  #: of the request
    quick: bool
    copy_records: bool
    began: float  #: when it was asked for [s]

    def compute(self, place: ResultFolder, runner: Runner) -> SiteResult:
        """Write the motions, compute what is missing, and write runs and page."""
        checked = check_set(
            self.ground,
            self.stages.target,
            longest=self.stages.longest,
            second=self.request.motions.second_component or 1.0,
        )
        written = write_ground(place.path, self.ground)
        motions = set_result(self.request, checked, self.ground, written)
        copy_files(self.request, place.path, records=self.copy_records)
        if self.copy_records:
            motions = replace(motions, notes=(*motions.notes, *left_elsewhere(self.request)))
        for period, moved in self.stages.floors.items():
            for number, motion in enumerate(moved, start=1):
                if period is not None:
                    write_csv_files(place.path, motion, motion_stem(number, period))
        answer = self._answer(place, runner, motions)
        place.check()
        result = self._result(checked, motions, answer)
        if result.status == COMPLETED:
            if self.stages.rows.runs:
                place.write_text(RUNS, self.stages.rows.table())
            place.write_text(PAGE, site_report(place.path, result))
        return result

    def _answer(self, place: ResultFolder, runner: Runner, motions: MotionSet) -> SiteAnswer | None:
        """Compute the runs that are missing; None where it was interrupted."""
        again, stages, rows = [], self.stages, self.stages.rows
        left_out = QUICK if self.quick and not stages.rests else ""
        if motions.valid:
            cases = RunCases.of(self.request, place.path)
            runner.reporter.message(forecast(stages, runner.jobs, quick=self.quick).words)
            LoggedRuns(
                what="runs",
                path=place.path / RUNS,
                columns=COLUMNS,
                make=cases,
                model_of=lambda key: key.model,
                key=lambda key: key,
                note=rows.note,
            ).run(runner, self._batches(runner))
            runs = rows.in_order()
            keys = [key for key in self._deciding(runs) if key not in rows.still and not left_out]
            if not runner.stop() and keys:
                runner.reporter.message("repeating the deciding runs with the reduced model")
                again = confirmed(cases, runs, keys, runner.jobs)
        if runner.stop():
            return None
        velocity = sum(motion.pgv_m_s for motion in motions.motions) / max(len(motions.motions), 1)
        beside = replace(stages.beside(again, self.wind, self.bodies, velocity), left_out=left_out)
        for file in place.path.glob(f"{MOTIONS}/{HAZARD}_*.csv"):  # the seed gives them again
            file.unlink()
        return answer_of(self.request, motions, rows.in_order(), beside)

    def _deciding(self, runs: Mapping[RunKey, SiteRun]) -> list[RunKey]:
        own = self.stages.rows.of(self.stages.plan.of_set())
        return deciding(runs, governing_run(self.request, own))

    def _result(self, checked: MotionSetCheck, motions: MotionSet, answer: SiteAnswer | None) -> SiteResult:
        """Everything that was found; without an answer what there is, and what is missing."""
        request, inputs, rows = self.request, inputs_of(self.request), self.stages.rows
        own = rows.of(self.stages.plan.of_set())
        missing = None if answer else self._missing()
        action = action_result(request.action, checked)
        floor = floor_result(request, self.stages.floors, checked)
        document = request.document.model_dump(exclude_none=True) if request.document else None
        return SiteResult(
            status=COMPLETED if answer else INTERRUPTED,
            answer=answer.sentence if answer else None,
            missing=missing,
            title=request.heading.title,
            inputs=inputs,
            action=action,
            floor=floor,
            set=motions,
            bodies=self.bodies,
            runs=tuple(rows.in_order().values()),
            result=answer or no_answer_yet(request, motions, own, missing or ""),
            methods=site_methods(
                bodies=self.bodies,
                inputs=inputs,
                site=request.action,
                motions=motions.motions,
                periods_s=action.periods_s,
                floor=floor,
                runs=own if answer else (),
                second_component=request.motions.second_component
                if self.ground[0].second is not None
                else 0.0,
            ),
            provenance=SiteProvenance(
                command=command_line("assess", request.origin.place, *["--quick"] * self.quick),
                site_hash=self.digest,
                case_hash=case_hash(request.container),
                versions=tuple(versions().items()),
                system=f"{platform.system()} {platform.release()}, {platform.machine()}",
                wall_s=time.perf_counter() - self.began,
            ),
            document=None if document is None else Signature(**document),
        )

    def _missing(self) -> str:
        """What an interrupted verification has not come to, in words."""
        rows, plan = self.stages.rows, self.stages.plan
        wanted = plan.of_set()
        if left := len(rows.missing(wanted)):
            return f"{len(wanted) - left} of {len(wanted)} runs of the set are computed"
        return "repetitions, further motions, other factors on the motions or the deciding runs are missing"

    def _batches(self, runner: Runner) -> Iterator[Sequence[RunKey]]:
        """The runs of each stage that are missing; a stage is asked for when the one before is there."""
        yield from self.stages.of_the_answer(runner, quick=self.quick)
        if not self.quick:
            yield from self.stages.of_the_margin()
            yield from self.stages.of_the_hazard(runner, self.bodies)
