"""A hall at a site: every container verified as by `assess`, each in a folder of its own with its page.

The verifications follow one another, each on all cores. What is kept of a finished one is a line of a log.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

from fem.batch.log import LoggedRows
from fem.batch.runner import Row, Runner
from fem.batch.study import FAILED, INTERRUPTED, StudyOptions, hash_of, run_study
from fem.case.case import Case
from fem.case.validation import CaseError
from fem.hall.file import HallFile
from fem.hall.plan import Hall
from fem.hall.result import AT_SITE, RESULT_COLUMNS, HallResult
from fem.hall.study import study_of, written
from fem.results.figures import SLIPPED, TURNED
from fem.results.folder import ResultFolder
from fem.results.kinds import SITE
from fem.run.expected import expected_words
from fem.runtime.identity import command_line
from fem.runtime.progress import SilentReporter
from fem.seismic.action import LAST_PERIOD_S
from fem.seismic.ground_motion import GroundMotion
from fem.site.bodies import bodies_of
from fem.site.copies import inputs_of
from fem.site.methods import wind_utilisation
from fem.site.motions import ground_motions
from fem.site.preview import forecast_of
from fem.site.request import SiteRequest
from fem.site.run import run_site, site_hash
from mesh.errors import MeshError

SITES, FOLDERS = "sites.csv", "sites"
#: tables of a case that a verification takes from its site file
OF_THE_SITE = ("motion", "vertical", "initial", "static", "solver", "output", "uncertainty", "joints")
#: by column, the key of the answer
FIGURES = {"margin": "margin_factor", TURNED: "rotation_ratio", SLIPPED: "slip_m"}
FIGURES |= {"motions_overturned": "overturned", "motions_invalid": "invalid"}
COLUMNS = {"container": int} | {
    name: RESULT_COLUMNS[name] for name in ("status", "reason", "outcome", *FIGURES, *AT_SITE)
}


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
        site: the action, the motions, the limits.
        base: the case that the rows change; None: the container of the site.
        strict: refuse the list for one bad row.
        allow_outside: take records from outside the folder of the site file.
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
    )
    hall = Hall(file=file, base=work.start, containers={}).checked(work.hash_of, strict=strict)
    study = study_of(
        hall,
        partial(work.compute, hall),
        site=site.origin.place,
        model=site.heading.model,
        asked=hash_of([*hall.containers]),
        listed=hash_of(file.table.text),
        allow_outside=allow_outside or None,
    )
    return run_study(study, folder, **options)


@dataclass(frozen=True, kw_only=True, eq=False)
class _AtSite:
    """A hall at a site under way."""

    site: SiteRequest
    start: Case  #: that the rows change
    ground: Sequence[GroundMotion]  #: records of the site
    outside: bool  #: records may lie outside the folder of the site file

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

    def hash_of(self, values: Mapping[str, Any]) -> str:
        """The hash of a verification, once its bodies can be built and the wind on them is known.

        Raises:
            CaseError, MeshError: what it would be refused for.
        """
        request = self.request(values, "container")
        wind_utilisation(bodies_of(request), inputs_of(request))
        return hash_of([request.portable, site_hash(request, self.ground)])

    def compute(self, hall: Hall, begun: HallResult, results: ResultFolder, runner: Runner) -> HallResult:
        """Verify what is missing, and write the list with the answers, and its page."""
        rows, count = [*hall.containers.values()], len(hall.containers)
        folders = [Path(FOLDERS) / f"{k + 1:03d}-{digest[:8]}" for k, digest in enumerate(hall.containers)]

        def verified(left: Sequence[int]) -> Iterator[tuple[list[int], list[Row]]]:
            """The rows of these containers, one after another, until it is interrupted."""
            for done, k in enumerate(left):
                if runner.stop():
                    return
                request = self.request(rows[k].values, rows[k].name)
                if done == 0 and len(left) > 1:
                    _say_expected(len(left), request, runner)
                runner.reporter.message(f"container {k + 1} of {count} at the site")
                if (row := self._row_of(request, results.path / folders[k], runner)) is None:
                    return
                yield [k], [dict.fromkeys(COLUMNS) | row]

        sites = LoggedRows(path=results.path / SITES, columns=COLUMNS, key=lambda k: (k,), items=range(count))
        sites.compute(runner, (sites.missing() for _ in range(1)), verified)
        if left := len(sites.missing()):
            words = f"{count - left} of {count} containers are verified"
            return replace(begun, status=INTERRUPTED, missing=words)
        results.check()
        results.write_text(SITES, sites.table())
        pages = [(folder / "report.html").as_posix() for folder in folders]
        found = [
            sites.row(k) | {"page": page if (results.path / page).is_file() else None}
            for k, page in enumerate(pages)
        ]

        def command(number: int, values: Mapping[str, Any]) -> str:
            place = str(results.path / folders[number] / "site.toml")
            return command_line("assess", place, allow_outside=self.outside)

        return written(results, replace(begun, runs=count), hall, found, command)

    def _row_of(self, request: SiteRequest, folder: Path, runner: Runner) -> Row | None:
        """The row of a container; None where it was interrupted."""
        try:
            result = run_site(
                request,
                folder,
                allow_outside=bool(request.motions.files),  # as the site names them they are looked at
                jobs=runner.jobs,
                workers_of=runner.workers_of,
                resume=True,
                force=not (folder / SITE.mark).is_file(),  # --force has removed it
                reporter=SilentReporter(),
                copy_records=False,  # of every container the same: the site file names them where they are
            )
        except (CaseError, MeshError) as error:
            return {"status": FAILED, "reason": str(error), "reasons": str(error)}
        if result.state != "finished":
            return None
        answer = result.result
        return {
            "status": result.status,
            "reason": None if answer.answer else answer.sentence,
            "outcome": answer.governing.outcome if answer.governing else None,
            **{name: getattr(answer, key) for name, key in FIGURES.items()},
            "answer": answer.answer,
            "reasons": " ".join(answer.reasons or ([] if answer.answer else [answer.sentence])),
            "factor_at_first_overturning": answer.factor_at_first_overturning,
        }


def _say_expected(count: int, request: SiteRequest, runner: Runner) -> None:
    """How long so many containers take at most, by the first of them."""
    with suppress(CaseError, MeshError):  # its row says why it cannot be verified
        each = forecast_of(request, runner.jobs, allow_outside=bool(request.motions.files))
        runner.reporter.message(
            f"{count} containers with up to {each.most} runs each: at most "
            f"{expected_words(each.seconds * count, runner.jobs)}, and the deciding runs with their bands"
        )
