"""`study`: every statement of the seed paper, tried."""

import difflib
import importlib
import sys
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fem.case.case import CaseError
from fem.cli.console import EXIT_CODES, Jobs, Quiet, flag
from fem.results.run_folder import naming_what_cannot_be_written, to_json
from fem.runtime.progress import ScreenReporter

STUDIES = ("seed",)
LONG = 10.0  #: s, from which a statement is worth compiling for beforehand


def study(
    name: str = "seed",
    /,
    *,
    out: Annotated[Path | None, Parameter(help="Folder of the results; default: outputs/study_NAME.")] = None,
    jobs: Jobs = None,
    only: Annotated[tuple[str, ...], flag("Only this statement; may be repeated.")] = (),
    force: Annotated[bool, flag("Compute what is there as well.")] = False,
    as_json: Annotated[bool, flag("Print study.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Try every statement of the seed paper: confirmed, confirmed within stated bounds, or refuted.

    Writes study.html, one page with the run, figure and number behind each verdict, and study.json.
    What the same program has tried before is not tried again.

    Parameters
    ----------
    name:
        The study: seed.
    """
    if name not in STUDIES:
        raise CaseError(f"no study {name!r}{_near(name, STUDIES)} (known: {', '.join(STUDIES)})")
    catalogue = importlib.import_module("fem.paper.index")
    every = catalogue.all_statements()
    known = [statement.name for _, statement in every]
    for wanted in only:
        if wanted not in known:
            raise CaseError(
                f"--only {wanted!r}: no such statement{_near(wanted, known)} (known: {', '.join(known)})"
            )
    chosen = [pair for pair in every if not only or pair[1].name in only]
    folder = out if out is not None else Path("outputs") / f"study_{name}"
    document = _conducted(folder, chosen, jobs=jobs, force=force, quiet=quiet)
    if as_json:
        print(to_json(document).rstrip())
    else:
        page = importlib.import_module("fem.paper.page")
        print("\n".join(page.table_lines(document)))
        print(f"{folder / 'study.html'} shows the runs, figures and numbers behind them")
    return EXIT_CODES[document["status"]]


def _conducted(folder: Path, chosen: Any, *, jobs: int | None, force: bool, quiet: bool) -> dict[str, Any]:
    """Try the statements, telling of each and of its runs."""
    laboratories = importlib.import_module("fem.paper.experiments")
    conducting = importlib.import_module("fem.paper.run")
    interrupts = importlib.import_module("fem.runtime.signals")
    reporter = ScreenReporter(quiet=quiet)
    in_place = not quiet and sys.stderr.isatty()

    def progress(done: int, total: int) -> None:
        if in_place:
            end = "\r" if done < total else "\r" + " " * 40 + "\r"
            print(f"    {done} of {total} runs", end=end, file=sys.stderr, flush=True)

    with interrupts.interruptible(reporter) as stop:
        laboratory = laboratories.Laboratory(jobs=jobs, progress=progress, stop=stop)
        if any(statement.seconds > LONG for _, statement in chosen):
            laboratory.warm_up(reporter.message)
        with naming_what_cannot_be_written(folder, "the same command goes on from there"):
            found: dict[str, Any] = conducting.conduct(
                folder, laboratory, statements=chosen, force=force, tell=reporter.message
            )
    return found


def _near(name: str, known: Any) -> str:
    near = difflib.get_close_matches(name, known, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""
