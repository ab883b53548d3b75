"""`size` from its request to its folder: `assess` at one value after another, each until it is decided.

Rows are logged as they are ready, so that an interrupted computation continues where it was.
"""

import shutil
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Unpack

from fem.batch.runner import Runner
from fem.batch.study import INTERRUPTED, Study, StudyOptions, hash_of, run_study
from fem.batch.table import table_text
from fem.results.folder import ResultFolder
from fem.results.kinds import SIZE
from fem.run.expected import expected_words
from fem.runtime.identity import command_line
from fem.seismic.ground_motion import GroundMotion
from fem.site.copies import copy_files, inputs_of, texts_of
from fem.site.figures import draw_size
from fem.site.motion_results import set_result
from fem.site.preview import forecast
from fem.site.request import SiteRequest
from fem.site.result import SiteAnswer
from fem.site.run import RUNS, Verification, site_hash
from fem.site.runs import COLUMNS
from fem.site.size import SizeAxis, SizeResult, at, followers, next_values, size_asked, size_result, so_far

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
    ground = Verification.of(request, folder, allow_outside=allow_outside).ground
    begun = size_asked(axis, followers(request, axis.key), _command(request, axis))
    sizing = _Sizing(request=request, axis=axis, begun=begun, allow_outside=allow_outside)
    study = Study(
        kind=SIZE,
        request=hash_of([site_hash(request, ground), repr(axis)]),
        result=SizeResult,
        begun=begun,
        compute=sizing.compute,
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
    tried: dict[float, Verification] = field(default_factory=dict)
    answers: dict[float, SiteAnswer] = field(default_factory=dict)
    #: the motions in each folder, by stem
    made: dict[Path, dict[str, GroundMotion]] = field(default_factory=dict)

    def compute(self, place: ResultFolder, runner: Runner) -> SizeResult:
        """Verify one value after another, as long as there are any to be tried."""
        began = time.perf_counter()
        copy_files(self.request, place.path)
        try:
            while values := next_values(self.axis, self.answers):
                self._prepare(values, place.path / WORKING, runner)
                for value in values:
                    runner.reporter.message(so_far(self.axis, self.answers, value))
                    work = self.tried[value]
                    motions = set_result(work.request, work.checked, work.ground, ())
                    answer = work.answer(motions, runner, place.path / RUNS, value)
                    if answer is None:
                        left = f"{len(self.answers)} values are decided, {len(self.tried) - len(self.answers)} are not"
                        return replace(self.begun, status=INTERRUPTED, missing=left)
                    self.answers[value] = answer
        finally:
            shutil.rmtree(place.path / WORKING, ignore_errors=True)
        place.check()
        result = size_result(self.axis, self.answers, self.begun)
        place.write_text(RUNS, self._table())
        place.write_text(FIGURE, draw_size(result, inputs_of(self.request)))
        return replace(result, wall_s=time.perf_counter() - began)

    def _prepare(self, values: Sequence[float], working: Path, runner: Runner) -> None:
        """Make the sets of some values, and tell how long these take at most."""
        for value in values:
            self.tried[value] = self._verification(value, working)
        each = [forecast(self.tried[value].stages, runner.jobs, scan=False) for value in values]
        seconds = sum(one.seconds + one.deciding_seconds for one in each)
        what = f"{len(values)} value{'s' * (len(values) > 1)}, up to {sum(one.most for one in each)} runs"
        runner.reporter.message(f"{what}: {expected_words(seconds, runner.jobs)}")

    def _verification(self, value: float, working: Path) -> Verification:
        """That at a value; values that do not change the motions share their folder."""
        request = at(self.request, self.axis, value)
        work = Verification.of(request, working, allow_outside=self.allow_outside)
        moves = self.axis.key.partition(".")[0] in MOVING
        folder = working / f"{value if moves else work.stages.longest:.9g}"
        made, own = self.made.setdefault(folder, {}), work.stages.screening
        made |= own.motions
        screening = replace(own, motions=made)
        work = replace(work, stages=replace(work.stages, folder=folder, screening=screening))
        work.write_floors(ground=True)
        return work

    def _table(self) -> str:
        """`runs.csv`: by value, and in the order of each verification, whatever the order in which runs ended."""
        rows = (
            (value, *work.stages.rows.rows[key].values())
            for value, work in sorted(self.tried.items())
            for key in work.stages.rows.in_order()
        )
        return table_text({"value": float} | COLUMNS, rows)


def _command(request: SiteRequest, axis: SizeAxis) -> str:
    first, last = axis.values[0], axis.values[-1]
    ends = ("--from", f"{first:g}", "--to", f"{last:g}", "--count", str(len(axis.values)))
    return command_line("size", request.origin.place, "--over", axis.key, *ends)
