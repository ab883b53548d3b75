"""A verification from its file to its folder: motions and their checks, runs, answer, simplified methods, page.

Rows are logged as they are ready, so that an interrupted verification continues where it was; the result depends
neither on that nor on the number of cores.
"""

import hashlib
import json
import shlex
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from fem.batch.log import LoggedRuns
from fem.batch.runner import Runner
from fem.batch.workers import LocalWorkers, WorkersOf, hand_out
from fem.case.case import case_hash
from fem.results.folder import ResultFolder, open_result_folder, program_of_results
from fem.results.kinds import SITE
from fem.runtime.identity import versions
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import interruptible
from fem.runtime.threads import cores
from fem.seismic.artificial import artificial_motions
from fem.seismic.floor import floor_motion
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.motion_set import check_set
from fem.site_check.answer import answer_of, governing_run
from fem.site_check.bodies import body_of
from fem.site_check.confirm import confirmed, deciding
from fem.site_check.file import SiteRequest
from fem.site_check.methods import site_methods
from fem.site_check.motion_results import (
    action_result,
    floor_result,
    set_result,
    write_csv_files,
    write_ground,
)
from fem.site_check.motions import floor_motions, ground_motions, longest_period
from fem.site_check.result import (
    USUAL_BEHAVIOUR_FACTOR,
    ConfirmedRun,
    SiteBody,
    SiteDocument,
    SiteInputs,
    SiteProvenance,
    SiteResult,
)
from fem.site_check.runs import COLUMNS, SET, RunCases, RunKey, RunPlan, RunRows, motion_stem
from fem.site_check.site_page import site_report

RUNS, PAGE = "runs.csv", "report.html"
#: room on the disk [bytes]: one motion in three files, one run, all else
BYTES_OF_A_MOTION, BYTES_OF_A_RUN, BYTES_BESIDE = 1_500_000, 200, 5_000_000
#: numbers of the artificial motions beyond the set begin behind those of any set
FIRST_FURTHER = 10_000


def run_site(
    request: SiteRequest,
    folder: Path,
    *,
    jobs: int | None = None,
    workers_of: WorkersOf | None = None,
    resume: bool = False,
    force: bool = False,
    allow_outside: bool = False,
    reporter: Reporter | None = None,
) -> SiteResult:
    """Verify a container at a site, into a folder; a finished verification is not computed again.

    Args:
        jobs: cores to use; all by default. The result does not depend on it.
        workers_of: who computes the runs, in place of this machine's cores.
        resume: continue with the rows that are there; force: overwrite earlier results.
        allow_outside: take records from outside the folder of the site file.

    Raises:
        CaseError, FolderError: bad input.
        WorkersLostError: a worker died; what was computed is kept.
        OutputError: the disk is full, the folder was removed; what was written is kept.
    """
    reporter, began = reporter or SilentReporter(), time.perf_counter()
    bodies = tuple(map(body_of, request.variants))
    longest = longest_period([body.frequency_parameter_1_s for body in bodies])
    ground = ground_motions(request, longest, allow_outside=allow_outside)
    asked = site_hash(request, ground)
    with (
        open_result_folder(folder, SITE, asked, force=force, resume=resume) as place,
        interruptible(reporter) as stop,
        ExitStack() as stack,
    ):
        if place.finished and place.found:
            reporter.message(f"{folder} holds this verification already; --force computes it again")
            return SiteResult.from_json(place.found)
        place.refuse_unfinished("its runs so far")
        if place.resuming:
            place.require_same_program()
        floors = floor_motions(request, ground)
        plan = RunPlan(
            request=request,
            motions=len(ground),
            vertical=ground[0].vertical is not None,
            periods=tuple(floors),
        )
        files = len(ground) * (1 + len(floors)) + request.motions.further
        size = files * BYTES_OF_A_MOTION + len(plan.of_set()) * 14 * BYTES_OF_A_RUN + BYTES_BESIDE
        place.require_room(size, "the verification", "take fewer motions")
        texts = {"site.toml": request.origin.text, "container.toml": request.container.text}
        place.begin({"status": "running", "asked": asked} | program_of_results(), texts)
        work = _Work(
            request=request,
            place=place,
            plan=plan,
            bodies=bodies,
            ground=ground,
            floors=floors,
            longest=longest,
            jobs=jobs or cores(),
            runner=Runner(
                workers_of=workers_of or stack.enter_context(LocalWorkers(jobs or cores())),
                reporter=reporter,
                stop=stop,
            ),
        )
        return work.run(asked, began)


def site_hash(request: SiteRequest, ground: Sequence[GroundMotion]) -> str:
    """Equal for requests that give the same result."""
    data = {
        key: value for key, value in request.data.items() if key not in ("title", "document", "container")
    }
    digest = hashlib.sha256(json.dumps(data, sort_keys=True).encode())
    digest.update(case_hash(request.container).encode())
    for motion in ground:
        for component in motion.components:
            digest.update(component.tobytes())
    return digest.hexdigest()


@dataclass(frozen=True, kw_only=True, eq=False)
class _Work:
    """One verification under way."""

    request: SiteRequest
    place: ResultFolder
    plan: RunPlan
    bodies: tuple[SiteBody, ...]
    ground: Sequence[GroundMotion]  #: motions of the set
    floors: Mapping[float | None, Sequence[GroundMotion]]  #: by building period
    longest: float  #: period of the band [s]
    runner: Runner
    jobs: int

    def run(self, asked: str, began: float) -> SiteResult:
        """Write the motions, compute what is missing, and write the result."""
        request, place = self.request, self.place
        checked = check_set(self.ground, request.action, longest=self.longest)
        motions = set_result(request, checked, self.ground, write_ground(place.path, self.ground))
        for period, moved in self.floors.items():
            for number, motion in enumerate(moved, start=1):
                if period is not None:
                    write_csv_files(place.path, motion, motion_stem(number, period))
        rows, cases, again = RunRows(), RunCases.of(request, place.path), list[ConfirmedRun]()
        if motions.valid:
            LoggedRuns(
                what="runs",
                path=place.path / RUNS,
                columns=COLUMNS,
                make=cases,
                model_of=lambda key: key.model,
                values=rows.values,
                note=rows.note,
            ).run(self.runner, self._batches(rows))
            found = rows.in_order()
            keys = deciding(found, governing_run(request, rows.of(self.plan.of_set())))
            if not self.runner.stop() and keys:
                self.runner.reporter.message("repeating the deciding runs with the reduced model")
                again = confirmed(cases, found, keys, self.jobs)
        interrupted = self.runner.stop()
        place.check()
        found = rows.in_order()
        action = action_result(request.action, checked)
        floor = floor_result(request, self.floors, checked.periods)
        own = rows.of(self.plan.of_set())
        inputs = inputs_of(request)
        result = SiteResult(
            status="interrupted" if interrupted else "completed",
            title=request.heading.title,
            inputs=inputs,
            action=action,
            floor=floor,
            set=motions,
            bodies=self.bodies,
            runs=tuple(found.values()),
            result=answer_of(request, motions, found, again, expected=len(self.plan.of_set())),
            methods=site_methods(
                bodies=self.bodies,
                inputs=inputs,
                site=request.action,
                motions=motions.motions,
                periods_s=action.periods_s,
                floor=floor,
                runs=own,
            ),
            provenance=SiteProvenance(
                command=f"python -m fem assess {shlex.quote(request.origin.place)}",
                site_hash=asked,
                case_hash=case_hash(request.container),
                versions=tuple(versions().items()),
                wall_s=time.perf_counter() - began,
            ),
            document=SiteDocument(**request.document.model_dump(exclude_none=True))
            if request.document
            else None,
        )
        place.write_result(result.to_json() | {"asked": asked} | program_of_results())
        if not interrupted:
            if found:
                place.write_text(RUNS, rows.table())
            place.write_text(PAGE, site_report(place.path))
        return result

    def _batches(self, rows: RunRows) -> Iterator[Sequence[RunKey]]:
        """The runs of each stage that are missing; a stage is asked for when the one before is there."""
        yield rows.missing(self.plan.of_set())
        yield rows.missing(self.plan.of_scan())
        yield rows.missing(self.plan.refined(rows.found))
        yield self._further(rows)

    def _further(self, rows: RunRows) -> Sequence[RunKey]:
        """The runs of the further motions, whose files are written."""
        own = {key: run for key, run in rows.in_order().items() if key.stage == SET}
        governing = governing_run(self.request, list(own.values()))
        if governing is None or not self.request.motions.further:
            return []
        key = next(key for key, run in own.items() if run is governing)
        wanted = rows.missing(self.plan.of_further(key, self.request.motions.further))
        numbers = sorted({one.motion for one in wanted})
        make = partial(further_motions, self.request, self.plan.vertical, self.longest, key.building_period_s)
        pools = self.runner.workers_of(key.model, len(wanted))
        for chunk, made in hand_out(numbers, make, pools, at_a_time=4, stop=self.runner.stop):
            for number, motion in zip(chunk, made, strict=True):
                stem = motion_stem(number, key.building_period_s, further=True)
                write_csv_files(self.place.path, motion, stem)
        return [] if self.runner.stop() else wanted


def further_motions(
    request: SiteRequest, vertical: bool, longest: float, period: float | None, numbers: Sequence[int]
) -> list[GroundMotion]:
    """Artificial motions beyond the set, on the floor of a building of this period or on the ground (None)."""
    asked, made = request.motions, []
    for number in numbers:
        (motion,) = artificial_motions(
            request.action,
            count=1,
            seed=asked.seed,
            stationary=asked.stationary_s,
            longest=longest,
            vertical=vertical,
            first=FIRST_FURTHER + number,
        )
        if period is not None and request.building is not None:
            motion = floor_motion(
                motion,
                height_ratio=request.building.z_over_h,
                period=period,
                damping_ratio=request.building.damping_ratio,
            )
        made.append(motion)
    return made


def inputs_of(request: SiteRequest) -> SiteInputs:
    """What was asked, for the page and the simplified methods."""
    wind, static = request.wind_pressure, request.container.static
    return SiteInputs(
        container=request.heading.container,
        mu_static=tuple(request.friction.mu_static),
        mu_kinetic_over_static=tuple(request.friction.mu_kinetic_over_static),
        rotation_ratio_limit=request.limits.rotation_ratio,
        slip_limit_m=request.limits.slip_m,
        wind_pressure_Pa=wind[0] if wind else None,
        wind_pressure_source=wind[1] if wind else "",
        gamma_mu=request.wind.gamma_mu if request.wind else 1.0,
        behaviour_factor=static.behaviour_factor if static else USUAL_BEHAVIOUR_FACTOR,
        model=request.heading.model,
    )


def page_of(result: SiteResult, folder: Path) -> str:
    """The result as text."""
    action, motions, answer = result.action, result.set, result.result
    lines = [
        f"{folder.name}: {result.title}" if result.title else folder.name,
        f"  action     {action.source}; a_g S = {action.ag_S_m_s2:.3g} m/s2, a_vg = {action.avg_m_s2:.3g} m/s2",
        f"  motions    {motions.count}, {motions.source}: mean peak {motions.mean_pga_m_s2:.3g} m/s2, least mean over "
        f"target {motions.least_ratio:.2f} at {motions.least_ratio_period_s:.2g} s, largest correlation "
        f"{motions.largest_correlation:.2f}: {'valid' if motions.valid else 'not valid'}",
        f"  runs       {answer.runs}, {answer.overturned} overturned",
    ]
    if answer.scan:
        first = answer.factor_at_first_overturning
        most = max(point.factor for point in answer.scan)
        found = f"{first:.3g}" if first is not None else f"none up to {most:g}"
        lines.append(f"  factor     on the motions at the first overturning: {found}")
    if answer.further:
        further = answer.further
        low, high = (100.0 * end for end in further.interval)
        lines.append(
            f"  further    {further.overturned} of {further.motions} motions overturn it (95 %: {low:.1f} to "
            f"{high:.1f} %)"
        )
    lines += [f"  rule       {answer.rule}", f"  files      {folder}", answer.sentence]
    if result.status == "interrupted":
        lines.append("  --resume continues")
    return "\n".join(lines)
