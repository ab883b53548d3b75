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
from fem.batch.runner import Runner
from fem.batch.study import COMPLETED, FAILED, INTERRUPTED, StudyOptions, hash_of, run_study
from fem.batch.table import fields_of, line_of, row_of, table_of_lines
from fem.case.case import Case
from fem.case.validation import CaseError
from fem.hall.file import HallFile
from fem.hall.plan import Inventory, take_inventory
from fem.hall.result import AT_SITE, RESULT_COLUMNS, HallResult
from fem.hall.run import begun_result, study_of, written
from fem.hall.table import HallTable
from fem.results.errors import FolderError
from fem.results.figures import SLIPPED, TURNED
from fem.results.folder import ResultFolder, program_of_results
from fem.results.kinds import SITE, read_result
from fem.results.run_files import copy_data_files
from fem.runtime.progress import SilentReporter, clock_time
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
MU = "contact.mu_static"
#: tables of a case that a verification takes from its site file
OF_THE_SITE = ("motion", "vertical", "initial", "static", "solver", "output", "uncertainty", "joints")
FIGURES = ("outcome", "margin", TURNED, SLIPPED, "motions_overturned", "motions_failed")
COLUMNS = {"container": int} | {
    name: RESULT_COLUMNS[name] for name in ("status", "reason", *FIGURES, *AT_SITE)
}
NO_ANSWER = "no answer"
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
    start = base or site.container
    idle = [
        key
        for key in file.keys.values()
        if key.partition(".")[0] in OF_THE_SITE or key == "contact.mu_kinetic"
    ]
    if idle:
        raise CaseError(
            f"{file.path}: {idle[0]!r} has no effect at a site, whose file sets it; leave the column out"
        )
    # of records the contents: they may change under the same name
    ground = ground_motions(site, LAST_PERIOD_S, allow_outside=allow_outside) if site.motions.files else []
    inventory = take_inventory(
        file, partial(_look, site, start, ground), start.origin_with({}).place, strict=strict
    )
    begun = replace(
        begun_result(file, start, inventory),
        site=site.origin.place,
        model=site.heading.model,
        asked=hash_of(inventory.hashes),
        listed=hash_of(file.text),
        allow_outside=allow_outside or None,
    )
    force = options.get("force", False)
    work = _AtSite(file=file, site=site, start=start, inventory=inventory, begun=begun, force=force)
    return run_study(study_of(file, start, begun, work.compute, 0.0), folder, **options)


def request_of(site: SiteRequest, start: Case, values: Mapping[str, Any], name: str) -> SiteRequest:
    """The verification of a container.

    Raises:
        CaseError: it cannot be verified at the site.
    """
    mu = values.get(MU)
    if mu is not None and not isinstance(mu, float):
        raise CaseError(
            f"[contact] mu_static must be a number at a site, whose [friction] has the range, got {mu!r}"
        )
    return site.of_container(name, start.with_values(values) if values else start, mu)


@dataclass(frozen=True, kw_only=True, eq=False)
class _AtSite:
    """A hall at a site under way."""

    file: HallFile
    site: SiteRequest
    start: Case
    inventory: Inventory
    begun: HallResult
    force: bool  #: verify every container again
    lines: dict[int, str] = field(default_factory=dict)  #: of the log, by container

    def compute(self, results: ResultFolder, runner: Runner) -> HallResult:
        """Verify what is missing, and write the list with the answers, and its page."""
        count, path = len(self.inventory.containers), results.path / SITES
        numbers = list(range(count))
        mine = runner.share.of(numbers, numbers) if runner.share else numbers
        with closing(RowLog(path, COLUMNS, runner.reporter.warning)) as log:
            for line in log.lines:
                self.lines[int(fields_of(line)[0])] = line
            missing = [number for number in mine if number not in self.lines]
            if len(missing) > 1:
                self._say_expected(missing, runner)
            for number in missing:
                if runner.stop():
                    break
                runner.reporter.message(f"container {number + 1} of {count} at the site")
                if not (line := self._verify(number, results.path, runner)):
                    break
                log.append([line])
                self.lines[number] = line
        if len(self.lines) < count:
            if runner.share and not {*mine} - self.lines.keys():
                runner.share.waits = True
            words = f"{len(self.lines)} of {count} containers are verified"
            return replace(self.begun, status=INTERRUPTED, missing=words)
        results.check()
        results.write_text(SITES, table_of_lines(COLUMNS, (line for _, line in sorted(self.lines.items()))))
        rows = {k: row_of(COLUMNS, line) for k, line in self.lines.items()}
        for k, row in rows.items():
            page = self._folder(k) / "report.html"
            row["page"] = page.as_posix() if (results.path / page).is_file() else None
        table = HallTable(
            file=self.file,
            inventory=self.inventory,
            values=rows,
            words={k: (row["answer"] or NO_ANSWER,) * 2 for k, row in rows.items()},
            order=sorted(rows, key=lambda k: _weakness(rows[k])),
            command=lambda row, container: self._command(results.path / self._folder(container)),
        )
        status = FAILED if {row["status"] for row in rows.values()} == {FAILED} else COMPLETED
        return written(results, table, replace(self.begun, status=status, runs=count))

    def _say_expected(self, missing: Sequence[int], runner: Runner) -> None:
        """How long these containers take at most, by the first of them."""
        with suppress(CaseError, MeshError):  # its row says why it cannot be verified
            each = forecast_of(
                self._request(missing[0]), runner.jobs, allow_outside=bool(self.site.motions.files)
            )
            time = clock_time(float(f"{each.seconds * len(missing):.1g}"))
            runner.reporter.message(
                f"{len(missing)} containers with up to {each.most} runs each: at most about {time} on {runner.jobs} "
                f"core{'s' * (runner.jobs > 1)}, and the deciding runs with their bands"
            )

    def _request(self, number: int) -> SiteRequest:
        """The verification of a container."""
        row = self.inventory.of_row.index(number)
        name = self.file.rows[row].name
        return request_of(self.site, self.start, self.inventory.containers[number], name)

    def _verify(self, number: int, folder: Path, runner: Runner) -> str:
        """The line of a container; empty where it was interrupted."""
        request = self._request(number)
        folder /= self._folder(number)
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
            row: dict[str, Any] = {"container": number, "status": FAILED} | dict.fromkeys(
                ("reason", "reasons"), str(error)
            )
            return line_of(row.get(name) for name in COLUMNS)
        if result.state != "finished":
            return ""
        # for the command of the row; what is no motion is not handed on
        with suppress(CaseError):
            copy_data_files(request.container, folder)
        answer = result.result
        outcome = answer.governing.outcome if answer.governing else None
        reasons = answer.reasons or ([] if answer.answer else [answer.sentence])
        return line_of(
            [
                *(number, result.status, None if answer.answer else answer.sentence),
                *(
                    outcome,
                    answer.margin_factor,
                    answer.rotation_ratio,
                    answer.slip_m,
                    answer.overturned,
                    None,
                ),
                *(answer.answer, " ".join(reasons), answer.factor_at_first_overturning),
            ]
        )

    def _command(self, folder: Path) -> str:
        words = ["python", "-m", "fem", "assess", str(folder / "site.toml")]
        outside = self.site.motions.files or self.begun.allow_outside
        return shlex.join([*words, *(["--allow-outside"] if outside else [])])

    def _folder(self, number: int) -> Path:
        return Path(FOLDERS) / f"{number + 1:03d}-{self.inventory.hashes[number][:8]}"


def _is_of_another_program(folder: Path) -> bool:
    """Whether the folder holds a verification by another version of the program."""
    if not (folder / SITE.mark).exists():
        return False
    try:
        mark = read_result(folder / SITE.mark, SITE)
    except FolderError:  # damaged
        return True
    return any(mark.get(name) != value for name, value in program_of_results().items())


def _look(site: SiteRequest, start: Case, ground: Sequence[GroundMotion], values: Mapping[str, Any]) -> str:
    """The hash of a verification, once its bodies can be built and the wind on them is known.

    Raises:
        CaseError, MeshError: what it would be refused for.
    """
    request = request_of(site, start, values, "container")
    wind_utilisation([body_of(variant) for variant in request.variants], inputs_of(request))
    return hash_of([request.portable, site_hash(request, ground)])


def _weakness(row: Mapping[str, Any]) -> tuple[float, ...]:
    """Smaller for the worse: by the answer, then by the margin, then by rotation and slip."""
    order, margin = WORST_FIRST.index(row["answer"] or NO_ANSWER), row["margin"]
    return order, math.inf if margin is None else margin, -(row[TURNED] or 0.0), -(row[SLIPPED] or 0.0)
