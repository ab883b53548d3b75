"""A verification from its file to its folder: motions and their checks, runs, answer, simplified methods, page.

Rows are logged as they are ready, so that an interrupted verification continues where it was; the result depends
neither on that nor on the number of cores.
"""

import hashlib
import importlib
import platform
import time
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path, PurePath
from typing import Unpack

from fem.case.case import Case, CaseError, case_hash
from fem.case.data_files import place_of, split_channel
from fem.case.toml import toml_document, toml_value
from fem.html.page import Signature
from fem.results.disk import table_bytes
from fem.results.figures import SLIPPED, TURNED, Place
from fem.results.folder import ResultFolder
from fem.results.kinds import SITE, ResultKind
from fem.results.outcome import ENDINGS
from fem.results.run_files import copy_data_files, require_free_name
from fem.results.run_result import Band
from fem.run.words import largest_bolt_forces
from fem.runtime.identity import command_line, versions
from fem.runtime.own_files import copy_file, place_in
from fem.runtime.user_files import real_path
from fem.seismic.action import spectrum_text
from fem.seismic.ground_motion import GroundMotion
from fem.site.answer import FULFILLED, NOT_FULFILLED, answer_of, no_answer_yet
from fem.site.methods import site_methods
from fem.site.motions import (
    action_result,
    floor_result,
    set_result,
    write_csv_files,
    write_ground,
)
from fem.site.preview import forecast
from fem.site.request import SiteRequest
from fem.site.result import (
    SET,
    ConfirmedRun,
    MotionSet,
    RunKey,
    SiteAnswer,
    SiteMotion,
    SiteProvenance,
    SiteResult,
    SiteRun,
    motion_stem,
)
from fem.site.rule import governing_run
from fem.site.runs import COLUMNS, CONFIRMING, KEYS, cases_of, cells_of
from fem.site.stages import MOST_LOAD, Stages
from fem.study.driver import COMPLETED, INTERRUPTED, LoggedRuns, Study, StudyOptions, hash_of, run_study
from fem.study.runner import NamedStages, Runner, compute_many
from fem.study.table import line_of, row_of, table_text

RUNS, PAGE = "runs.csv", "report.html"
OF_A_MOTION = 75_000  #: numbers, in three files
QUICK = (
    "Left out by --quick: further motions, other factors on the motions, the deciding runs with their bands."
)
FURTHER_ONES, OTHER_FACTORS = "further motions", "the set at other factors"
DECIDING = "the deciding runs with their bands"
CONTAINER = "container.toml"
RECORDS = "records"  #: folder in the results of the records that the site file names
MOST_COPIED = 20_000_000  #: of a record [bytes]; a larger one stays where it is
TIMES_THE_SET = 20  #: runs of all stages over those of the set


def run_site(
    request: SiteRequest,
    folder: Path,
    *,
    allow_outside: bool = False,
    quick: bool = False,
    **options: Unpack[StudyOptions],
) -> SiteResult:
    """Verify a container at a site, into a folder; raises as `run_study`, and CaseError for bad input.

    Args:
        allow_outside: take records from outside the folder of the site file.
        quick: the set and its repetitions alone; "fulfilled" then only of a container that rests.
    """
    stages = Stages.of(request, folder, allow_outside=allow_outside, quick=quick)
    files = len(stages.ground) * (1 + len(stages.floors)) + request.motions.further
    study = Study(
        kind=SITE,
        request=digest_of(stages),
        result=SiteResult,
        compute=partial(_compute, stages),
        texts=texts_of(request, SITE),
        size=table_bytes(files, OF_A_MOTION)
        + table_bytes(TIMES_THE_SET * len(stages.of_set()), len(COLUMNS)),
    )
    return run_study(study, folder, **options)


def site_hash(request: SiteRequest, ground: Sequence[GroundMotion]) -> str:
    """Equal for requests that give the same result."""
    for_people = ("title", "document", "sources", "container")
    data = {key: value for key, value in request.data.items() if key not in for_people}
    if files := [[Path(name).name for name in pair] for pair in request.motions.files or ()]:
        data["motions"] = {**data["motions"], "files": files}  # by their names alone, wherever these lie
    digest = hashlib.sha256()
    for motion in ground:
        for component in motion.components:
            digest.update(component.tobytes())
    if (floor := request.floor_target) is not None:  # of its file the request has the name alone
        points = floor.periods, floor.accelerations, floor.vertical_accelerations
        digest.update(repr(points).encode())
    return hash_of([data, case_hash(request.container), digest.hexdigest()])


def digest_of(stages: Stages) -> str:
    """Equal for requests that give the same result; of --quick another than of the whole."""
    digest = site_hash(stages.request, stages.ground)
    return hash_of([digest, "quick"]) if stages.quick else digest


def set_of(stages: Stages, described: Sequence[SiteMotion] = ()) -> MotionSet:
    """The set of motions and its checks."""
    return set_result(stages.request, stages.checked, stages.ground, described)


def _compute(stages: Stages, place: ResultFolder, runner: Runner) -> SiteResult:
    """Write the motions, compute what is missing, and write runs and page."""
    motions = set_of(stages, write_ground(place.path, stages.ground))
    copy_files(stages.request, place.path)
    motions = replace(motions, notes=(*motions.notes, *left_elsewhere(stages.request)))
    write_floors(stages)
    if motions.valid:
        runner.reporter.message(forecast(stages, runner.jobs).words(stages.load))
    answer = answered(stages, motions, runner, place.path / RUNS)
    place.check()
    result = _result(stages, motions, answer)
    if result.status == COMPLETED:
        if stages.runs:
            rows = (stages.rows[key].values() for key in stages.in_order())
            place.write(RUNS, table_text(COLUMNS, rows))
        page = importlib.import_module("fem.site.page")  # late, for it loads matplotlib
        place.write(PAGE, page.site_report(place.path, result))
    return result


def write_floors(stages: Stages, *, ground: bool = False) -> None:
    """Write the motions of the floors of a building, and `ground`: those without one, for the runs."""
    for period, moved in stages.floors.items():
        for number, motion in enumerate(moved, start=1):
            if ground or period is not None:
                write_csv_files(stages.folder, motion, motion_stem(number, period))


def answered(
    stages: Stages, motions: MotionSet, runner: Runner, log: Path, value: float | None = None
) -> SiteAnswer | None:
    """Compute the runs that are missing; None where it was interrupted.

    A `value` of the key that `size` varies stands in the first column of its log. It is decided without a margin, and
    without what comes after the first that speaks against it.
    """
    request = stages.request
    again: list[ConfirmedRun] = []
    left_out = QUICK if stages.quick and not stages.rests else ""
    varied = {} if value is None else {"value": float}

    def now() -> SiteAnswer:
        beside = stages.beside()
        return answer_of(request, motions, stages.in_order(), confirmed=again, left_out=left_out, **beside)

    scans = not (stages.quick or varied)
    names = ["the set", "its repetitions", *[FURTHER_ONES] * stages.has_further]
    names += [OTHER_FACTORS] * scans + [DECIDING] * (not left_out)
    told = NamedStages(names, runner.reporter)
    stage = ""  #: whose runs follow
    left = 0  #: runs of the set at other factors that may still be asked for

    def batches() -> Iterator[Sequence[RunKey]]:
        nonlocal stage, left
        for name, keys in zip(names, stages.of_the_answer(runner), strict=False):
            stage = name
            yield keys
            if varied and now().answer == NOT_FULFILLED:
                return
        if scans:
            stage, left = "", stages.most_scanned
            told.begin(OTHER_FACTORS, left, up_to=True)
            yield from stages.of_the_margin()

    def begin(what: str, count: int) -> None:
        nonlocal left
        if stage:
            told.begin(stage, count)
        left = max(left - count, 0)

    def note(line: str) -> None:
        row = row_of(varied | COLUMNS, line)
        row.pop("value", None)
        stages.add(row)

    if motions.valid:
        cases, since = cases_of(request, stages.folder), time.perf_counter()
        LoggedRuns(
            what="runs",
            path=log,
            columns=varied | COLUMNS,
            make=cases,
            model_of=lambda key: key.model,
            key=lambda key: (value, *cells_of(key)) if varied else cells_of(key),
            ids=len(KEYS) + len(varied),
            of=f"{line_of([value])}," if varied else "",
            note=note,
            told=begin,
            more=lambda count: left,
        ).run(runner, batches())
        if not (runner.stop() or left_out) and not (varied and now().answer != FULFILLED):
            runs, own = stages.in_order(), stages.found(stages.of_set())
            governing = governing_run(request.limits, own)
            if keys := [key for key in deciding(runs, governing) if key not in stages.still]:
                one = forecast(stages, runner.jobs, scan=scans)
                load = (time.perf_counter() - since) * one.most / (one.seconds * max(len(stages.rows), 1))
                told.begin(DECIDING, len(keys), seconds=min(max(load, 1.0), MOST_LOAD) * one.deciding_seconds)
                again = confirmed(cases, runs, keys, runner.jobs)
    return None if runner.stop() else now()


def _result(stages: Stages, motions: MotionSet, answer: SiteAnswer | None) -> SiteResult:
    """Everything that was found; without an answer what there is, and what is missing."""
    request, missing = stages.request, None
    wanted = stages.of_set()
    own = stages.found(wanted)
    if answer is None:
        missing = (
            "repetitions, further motions, other factors on the motions or the deciding runs are missing"
        )
        if len(own) < len(wanted):
            missing = f"{len(own)} of {len(wanted)} runs of the set are computed"
    action = action_result(request.action, stages.checked)
    floor = floor_result(request, stages.floors, stages.checked)
    document = request.document.model_dump(exclude_none=True) if request.document else None
    return SiteResult(
        status=COMPLETED if answer else INTERRUPTED,
        answer=answer.sentence if answer else None,
        missing=missing,
        title=request.heading.title,
        inputs=request.inputs,
        action=action,
        floor=floor,
        set=motions,
        bodies=stages.bodies,
        runs=tuple(stages.in_order().values()),
        result=answer or no_answer_yet(request.limits, motions, own, missing or ""),
        methods=site_methods(
            bodies=stages.bodies,
            inputs=request.inputs,
            limits=request.limits,
            site=request.action,
            motions=motions.motions,
            periods_s=action.periods_s,
            floor=floor,
            runs=own if answer else (),
        ),
        provenance=SiteProvenance(
            command=command_line("assess", request.origin.place, *["--quick"] * stages.quick),
            site_hash=digest_of(stages),
            case_hash=case_hash(request.container),
            versions=tuple(versions().items()),
            system=f"{platform.system()} {platform.release()}, {platform.machine()}",
            wall_s=time.perf_counter() - stages.began,
        ),
        document=None if document is None else Signature(**document),
    )


def deciding(runs: Mapping[RunKey, SiteRun], governing: SiteRun | None) -> list[RunKey]:
    """The runs that decide: one that overturned, else that of the largest rotation; and that of the largest slip."""
    own = {key: run for key, run in runs.items() if key.stage == SET and run.outcome is not None}
    if governing is None or not own:
        return []
    stood = {key: run for key, run in own.items() if run.outcome not in ENDINGS}
    keys = [next(key for key, run in own.items() if run is governing)] if len(stood) < len(own) else []
    figures = (TURNED, SLIPPED)[len(keys) :] if stood else ()
    keys += [max(stood, key=lambda key: stood[key][figure] or 0.0) for figure in figures]
    return list(dict.fromkeys(keys))


def confirmed(
    cases: Callable[[RunKey], Case], runs: Mapping[RunKey, SiteRun], keys: list[RunKey], jobs: int | None
) -> list[ConfirmedRun]:
    """These runs with the reduced model, each with its band unless it rests far below the static limits.

    None where a signal stops them; the caller asks that.

    Raises:
        CaseError, MeshError: one of them cannot be computed.
    """
    results: list[ConfirmedRun] = []
    try:
        repeated = [cases(replace(key, model=CONFIRMING)) for key in keys]
        again = compute_many(repeated, jobs, progress=False, margin=False, inner_forces=False)
    except KeyboardInterrupt:
        return results
    for key, run in zip(keys, again, strict=True):
        verdict, joints = run.verdict, run.typed_result.joints or ()
        band = verdict.band or Band()
        tension, shear = largest_bolt_forces(joints) if joints else (None, None)
        used = [joint.bolt_utilisation for joint in joints if joint.bolt_utilisation is not None]
        results.append(
            ConfirmedRun(
                run=runs[key],
                model=CONFIRMING,
                outcome=verdict.outcome,
                **verdict.figures(Place.KEY),
                bolt_tension_N=tension,
                bolt_shear_N=shear,
                bolt_utilisation=max(used, default=None),
                sure=verdict.sure or "",
                outcomes=band.outcomes,
                rotation_ratio_range=band.rotation_ratio or (),
                max_slip_m_range=band.max_slip_m or (),
            )
        )
    return results


def texts_of(request: SiteRequest, kind: ResultKind) -> dict[str, str]:
    """The site file, its container, and the file of points that it names, by their names in a folder of results.

    The site file names what lies beside it there, so that it can be repeated from there alone.

    Raises:
        CaseError: the file of points is named like a result, which would replace it.
        ValueError: it cannot be read.
    """
    own = {"site.toml": _beside_its_files(request), CONTAINER: request.container.text}
    if (floor := request.floor_spectrum) is None or floor.file is None:
        return own
    require_free_name(place_of("floor_spectrum.file"), PurePath(floor.file), kind, own)
    return own | {floor.file: spectrum_text(request.origin.folder / floor.file)}


def copy_files(request: SiteRequest, folder: Path) -> None:
    """Copy the mesh of the container, and the records, to where the copies of their files name them."""
    for path, place in _records(request).values():
        if not Path(place).is_absolute():
            target = place_in(folder, place)
            if real_path(target) != real_path(path):
                copy_file(path, target)
    with suppress(CaseError):  # the motion of the container, which is not used here, may be none
        copy_data_files(request.container, folder)


def left_elsewhere(request: SiteRequest) -> list[str]:
    """The records that are too large to be copied, in a sentence each with what tells their content."""
    return [
        f"{place} is larger than {MOST_COPIED / 1e6:g} MB and is not copied into the results; SHA-256 "
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}; to repeat it from there needs --allow-outside"
        for path, place in dict.fromkeys(_records(request).values())
        if Path(place).is_absolute()
    ]


def _records(request: SiteRequest) -> dict[str, tuple[Path, str]]:
    """The records by their names in the site file: where each is, and its place in the results; if large, on disk."""
    places: dict[str, tuple[Path, str]] = {}
    taken: dict[str, Path] = {}
    for name in chain(*(request.motions.files or [])):
        path, _ = split_channel(request.origin.folder, name)
        if path.stat().st_size > MOST_COPIED:
            places[name] = path, str(real_path(path))
            continue
        own = path.name
        while taken.setdefault(own, path) != path:  # of another folder
            own = f"other-{own}"
        places[name] = path, f"{RECORDS}/{own}"
    return places


def _beside_its_files(request: SiteRequest) -> str:
    """The site file with the names of the copies beside it; with its comments, where these names alone change."""
    names = {request.heading.container: CONTAINER}
    wanted = {**request.data, "container": CONTAINER}
    if request.motions.files:
        for name, (_, place) in _records(request).items():
            channel = split_channel(request.origin.folder, name)[1]
            names[name] = f"{place}#{channel}" if channel else place
        files = [[names[name] for name in motion] for motion in request.motions.files]
        wanted["motions"] = {**request.data["motions"], "files": files}
    text = request.origin.text
    for name, own in names.items():
        text = text.replace(toml_value(name), toml_value(own)).replace(f"'{name}'", toml_value(own))
    with suppress(tomllib.TOMLDecodeError):
        if tomllib.loads(text) == wanted:
            return text
    return toml_document(wanted)
