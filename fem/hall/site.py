"""A hall at a site: every container verified as by `assess`, each in a folder of its own with its page.

The verifications follow one another, each on all cores. What is kept of a finished one is a line of a log.
"""

import math
import shlex
from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

from fem.batch.log import RowLog
from fem.batch.runner import Row, Runner
from fem.batch.study import FAILED, INTERRUPTED, StudyOptions, hash_of, run_study
from fem.batch.table import line_of, row_of, table_of_rows
from fem.case.case import Case
from fem.case.validation import CaseError
from fem.hall.file import HallFile, HallRow
from fem.hall.plan import Inventory, take_inventory
from fem.hall.result import AT_SITE, RESULT_COLUMNS, HallResult
from fem.hall.run import begun_result, study_of, written
from fem.hall.table import NO_ANSWER, with_table
from fem.results.errors import FolderError
from fem.results.figures import SLIPPED, TURNED
from fem.results.folder import ResultFolder, program_of_results
from fem.results.kinds import SITE, read_result
from fem.results.run_files import copy_data_files
from fem.run.expected import expected_words
from fem.runtime.progress import SilentReporter
from fem.seismic.action import LAST_PERIOD_S
from fem.seismic.ground_motion import GroundMotion
from fem.site_check.bodies import body_of
from fem.site_check.file import SiteRequest
from fem.site_check.inputs import inputs_of
from fem.site_check.methods import wind_utilisation
from fem.site_check.motions import ground_motions
from fem.site_check.preview import forecast_of
from fem.site_check.run import run_site, site_hash
from mesh.errors import MeshError

SITES, FOLDERS = "sites.csv", "sites"
ASSESS = ("python", "-m", "fem", "assess")
#: tables of a case that a verification takes from its site file
OF_THE_SITE = ("motion", "vertical", "initial", "static", "solver", "output", "uncertainty", "joints")
FIGURES = ("outcome", "margin", TURNED, SLIPPED, "motions_overturned", "motions_failed")
COLUMNS = {"container": int} | {
    name: RESULT_COLUMNS[name] for name in ("status", "reason", *FIGURES, *AT_SITE)
}
WORST_FIRST = ("not fulfilled", NO_ANSWER, "not sure", "fulfilled")


def run_hall_at_site(
    file: HallFile,
    site: SiteRequest,
    base: Case | None,
    folder: Path,
    *,
    strict: bool = False,
    allow_outside: bool = False,
    **options: Unpack[StudyOptions],
) -> HallResult:
    """Verify every container of a list at a site, into a folder; raises as `run_study`, and CaseError for bad input.

    Args:
        file: the list.
        site: the action, the motions, the limits.
        base: the case that the rows change; None: the container of the site.
        folder: of the results.
        strict: refuse the list for one bad row.
        allow_outside: take records from outside the folder of the site file.
        options: of every study.
    """
    for key in file.keys:
        if key.partition(".")[0] in OF_THE_SITE or key == "contact.mu_kinetic":
            raise CaseError(
                f"{file.path}: {key!r} has no effect at a site, whose file sets it; leave the column out"
            )
    work = _AtSite(
        site=site,
        start=base or site.container,
        # of records the contents: they may change under the same name
        ground=ground_motions(site, LAST_PERIOD_S, allow_outside=allow_outside) if site.motions.files else [],
        outside=allow_outside or bool(site.motions.files),
        force=options.get("force", False),
    )
    inventory = take_inventory(file, work.start, work.look, strict=strict)
    begun = begun_result(
        inventory,
        site=site.origin.place,
        model=site.heading.model,
        asked=hash_of(inventory.hashes),
        listed=hash_of(file.text),
        allow_outside=allow_outside or None,
    )
    study = study_of(inventory, begun, partial(work.compute, inventory, begun), 0.0)
    return run_study(study, folder, **options)


@dataclass(frozen=True, kw_only=True, eq=False)
class _AtSite:
    """A hall at a site under way."""

    site: SiteRequest
    start: Case  #: that the rows change
    ground: Sequence[GroundMotion]  #: records of the site
    outside: bool  #: records may lie outside the folder of the site file
    force: bool  #: verify every container again
    rows: dict[int, Row] = field(default_factory=dict)  #: of the log, by container

    def request(self, values: Mapping[str, Any], name: str) -> SiteRequest:
        """The verification of a container.

        Raises:
            CaseError: it cannot be verified at the site.
        """
        mu = values.get("contact.mu_static")
        if mu is not None and not isinstance(mu, float):
            raise CaseError(
                f"[contact] mu_static must be a number at a site, whose [friction] has the range, got {mu!r}"
            )
        return self.site.of_container(name, self.start.with_values(values) if values else self.start, mu)

    def look(self, values: Mapping[str, Any]) -> str:
        """The hash of a verification, once its bodies can be built and the wind on them is known.

        Raises:
            CaseError, MeshError: what it would be refused for.
        """
        request = self.request(values, "container")
        wind_utilisation([body_of(variant) for variant in request.variants], inputs_of(request))
        return hash_of([request.portable, site_hash(request, self.ground)])

    def compute(
        self, inventory: Inventory, begun: HallResult, results: ResultFolder, runner: Runner
    ) -> HallResult:
        """Verify what is missing, and write the list with the answers, and its page."""
        numbers = range(len(inventory.containers))
        mine = runner.share.of(numbers, numbers) if runner.share else [*numbers]
        names = {row.container: row.name for row in reversed(inventory.rows)}
        folders = [Path(FOLDERS) / f"{k + 1:03d}-{inventory.hashes[k][:8]}" for k in numbers]
        with closing(RowLog(results.path / SITES, COLUMNS, runner.reporter.warning)) as log:
            for line in log.lines:
                self._note(line)
            missing = [number for number in mine if number not in self.rows]
            requests = (self.request(inventory.containers[k], names[k]) for k in missing)
            for done, (number, request) in enumerate(zip(missing, requests, strict=True)):
                if runner.stop():
                    break
                if done == 0 and len(missing) > 1:
                    self._say_expected(len(missing), request, runner)
                runner.reporter.message(f"container {number + 1} of {len(numbers)} at the site")
                if (row := self._verified(request, results.path / folders[number], runner)) is None:
                    break
                line = line_of((number, *(row.get(name) for name in [*COLUMNS][1:])))
                log.append([line])
                self._note(line)
        if len(self.rows) < len(numbers):
            if runner.share and not {*mine} - self.rows.keys():
                runner.share.waits = True
            words = f"{len(self.rows)} of {len(numbers)} containers are verified"
            return replace(begun, status=INTERRUPTED, missing=words)
        results.check()
        rows = [self.rows[number] for number in numbers]
        results.write_text(SITES, table_of_rows(COLUMNS, rows))
        pages = [folder / "report.html" for folder in folders]
        by_container = {
            number: {**row, "page": page.as_posix() if (results.path / page).is_file() else None}
            for number, row, page in zip(numbers, rows, pages, strict=True)
        }
        flags = ["--allow-outside"] * self.outside

        def command(row: HallRow, number: int) -> str:
            return shlex.join([*ASSESS, str(results.path / folders[number] / "site.toml"), *flags])

        order = sorted(numbers, key=lambda number: _weakness(by_container[number]))
        begun = replace(begun, runs=len(numbers))
        return written(results, with_table(begun, inventory, by_container, order, command))

    def _note(self, line: str) -> None:
        """Add a line of the log."""
        row = row_of(COLUMNS, line)
        self.rows[row["container"]] = row

    def _say_expected(self, count: int, request: SiteRequest, runner: Runner) -> None:
        """How long so many containers take at most, by the first of them."""
        with suppress(CaseError, MeshError):  # its row says why it cannot be verified
            each = forecast_of(request, runner.jobs, allow_outside=bool(request.motions.files))
            runner.reporter.message(
                f"{count} containers with up to {each.most} runs each: at most "
                f"{expected_words(each.seconds * count, runner.jobs)}, and the deciding runs with their bands"
            )

    def _verified(self, request: SiteRequest, folder: Path, runner: Runner) -> Row | None:
        """The row of a container; None where it was interrupted."""
        try:
            result = run_site(
                request,
                folder,
                allow_outside=bool(request.motions.files),  # as the site names them they are looked at
                jobs=runner.jobs,
                workers_of=runner.workers_of,
                resume=True,
                force=self.force or _is_of_another_program(folder),
                reporter=SilentReporter(),
                copy_records=False,  # of every container the same: the site file names them where they are
            )
        except (CaseError, MeshError) as error:
            return {"status": FAILED, "reason": str(error), "reasons": str(error)}
        if result.state != "finished":
            return None
        # for the command of the row; what is no motion is not handed on
        with suppress(CaseError):
            copy_data_files(request.container, folder)
        answer = result.result
        return {
            "status": result.status,
            "reason": None if answer.answer else answer.sentence,
            "outcome": answer.governing.outcome if answer.governing else None,
            "margin": answer.margin_factor,
            TURNED: answer.rotation_ratio,
            SLIPPED: answer.slip_m,
            "motions_overturned": answer.overturned,
            "answer": answer.answer,
            "reasons": " ".join(answer.reasons or ([] if answer.answer else [answer.sentence])),
            "factor_at_first_overturning": answer.factor_at_first_overturning,
        }


def _is_of_another_program(folder: Path) -> bool:
    """Whether the folder holds a verification by another version of the program."""
    if not (folder / SITE.mark).exists():
        return False
    try:
        mark = read_result(folder / SITE.mark, SITE)
    except FolderError:  # damaged
        return True
    return any(mark.get(name) != value for name, value in program_of_results().items())


def _weakness(row: Mapping[str, Any]) -> tuple[float, ...]:
    """Smaller for the worse: by the answer, then by the margin, then by rotation and slip."""
    order, margin = WORST_FIRST.index(row["answer"] or NO_ANSWER), row["margin"]
    return order, math.inf if margin is None else margin, -(row[TURNED] or 0.0), -(row[SLIPPED] or 0.0)
