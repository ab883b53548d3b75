"""`size` from its request to its folder: `assess` at one value after another, each until it is decided.

Rows are logged as they are ready, so that an interrupted computation continues where it was.
"""

import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Unpack

from fem.results.folder import ResultFolder
from fem.results.kinds import SIZE
from fem.run.expected import expected_words
from fem.runtime.identity import command_line
from fem.runtime.own_files import remove_tree
from fem.seismic.ground_motion import GroundMotion
from fem.site.copies import copy_files, inputs_of, texts_of
from fem.site.figures import draw_size
from fem.site.preview import forecast
from fem.site.request import SiteRequest
from fem.site.result import SiteAnswer
from fem.site.run import RUNS, answered, set_of, site_hash, write_floors
from fem.site.runs import COLUMNS
from fem.site.size import SizeAxis, SizeResult, at, followers, next_values, size_asked, size_result, so_far
from fem.site.stages import Stages
from fem.study.driver import INTERRUPTED, Study, StudyOptions, hash_of, run_study
from fem.study.runner import Runner
from fem.study.table import table_text

FIGURE = "figures/size.svg"
WORKING = ".motions"  #: of the sets, as long as they are computed
BYTES_OF_SETS = 50_000_000  #: of motions, as long as they are computed
MOVING = ("site", "building", "floor_spectrum", "motions")  #: tables whose values have motions of their own


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
    ground = Stages.of(request, folder, allow_outside=allow_outside).ground
    ends = ("--from", f"{axis.values[0]:g}", "--to", f"{axis.values[-1]:g}", "--count", str(len(axis.values)))
    command = command_line("size", request.origin.place, "--over", axis.key, *ends)
    begun = size_asked(axis, followers(request, axis.key), command)
    study = Study(
        kind=SIZE,
        request=hash_of([site_hash(request, ground), repr(axis)]),
        result=SizeResult,
        begun=begun,
        compute=partial(_compute, request, axis, begun, allow_outside),
        texts=texts_of(request, SIZE),
        size=BYTES_OF_SETS,
    )
    return run_study(study, folder, **options)


def _compute(
    request: SiteRequest,
    axis: SizeAxis,
    begun: SizeResult,
    allow_outside: bool,
    place: ResultFolder,
    runner: Runner,
) -> SizeResult:
    """Verify one value after another, as long as there are any to be tried."""
    began, working = time.perf_counter(), place.path / WORKING
    tried: dict[float, Stages] = {}
    answers: dict[float, SiteAnswer] = {}
    made: dict[Path, dict[str, GroundMotion]] = {}
    copy_files(request, place.path)
    try:
        while values := next_values(axis, answers):
            tried |= {
                value: stages_at(request, axis, value, working, made, allow_outside=allow_outside)
                for value in values
            }
            each = [forecast(tried[value], runner.jobs, scan=False) for value in values]
            what = f"{len(values)} value{'s' * (len(values) > 1)}, up to {sum(one.most for one in each)} runs"
            loads = [tried[value].load for value in values]
            seconds = sum(
                load * (one.seconds + one.deciding_seconds) for load, one in zip(loads, each, strict=True)
            )
            runner.reporter.message(f"{what}: {expected_words(seconds, runner.jobs)}")
            for value in values:
                runner.reporter.message(so_far(axis, answers, value))
                stages = tried[value]
                answer = answered(stages, set_of(stages), runner, place.path / RUNS, value)
                if answer is None:
                    left = f"{len(answers)} values are decided, {len(tried) - len(answers)} are not"
                    return replace(begun, status=INTERRUPTED, missing=left)
                answers[value] = answer
    finally:
        remove_tree(working)
    place.check()
    result = size_result(axis, answers, begun)
    # by value, and in the order of each verification, whatever the order in which runs ended
    rows = (
        (value, *stages.rows.rows[key].values())
        for value, stages in sorted(tried.items())
        for key in stages.rows.in_order()
    )
    place.write(RUNS, table_text({"value": float} | COLUMNS, rows))
    place.write(FIGURE, draw_size(result, inputs_of(request)))
    return replace(result, wall_s=time.perf_counter() - began)


def stages_at(
    request: SiteRequest,
    axis: SizeAxis,
    value: float,
    working: Path,
    made: dict[Path, dict[str, GroundMotion]],
    *,
    allow_outside: bool = False,
) -> Stages:
    """The runs at a value; values that do not change the motions share their folder.

    Args:
        working: holds the folders; made: the motions in each, by stem, to which those of this value are added.
    """
    stages = Stages.of(at(request, axis, value), working, allow_outside=allow_outside)
    moves = axis.key.partition(".")[0] in MOVING
    folder = working / f"{value if moves else stages.longest:.9g}"
    motions = made.setdefault(folder, {})
    motions |= stages.motions
    stages = replace(stages, folder=folder, motions=motions)
    write_floors(stages, ground=True)
    return stages
