"""`study`: every claim of the paper (Knoedel and Hrabowski), checked."""

import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fem.case.case import CaseError
from fem.case.validation import did_you_mean
from fem.cli.console import EXIT_CODES, Jobs, Quiet, flag, print_json
from fem.cli.evidence import from_clone
from fem.results.files import to_json
from fem.run.expected import say_expected
from fem.runtime.progress import ScreenReporter
from fem.runtime.threads import cores

STUDIES = ("seed",)
OF_A_CLAIM_S = 3.3  #: processor time, on average [s]


def study(
    name: str = "seed",
    /,
    *,
    out: Annotated[Path | None, Parameter(help="Folder of the results; default: outputs/study_NAME.")] = None,
    jobs: Jobs = None,
    only: Annotated[tuple[str, ...], flag("Only this claim; may be repeated.")] = (),
    force: Annotated[bool, flag("Recompute and overwrite existing results.")] = False,
    as_json: Annotated[bool, flag("Print study.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Check every claim of the paper: confirmed, confirmed within stated bounds, or refuted.

    The paper is Knoedel and Hrabowski, A simple stick-slip model for the overturning stability of unanchored
    containers. Writes study.html, one page with the run, figure and number behind each conclusion, and study.json.
    A claim that the same version of the program has decided is not checked again.

    Parameters
    ----------
    name:
        The study: seed.
    """
    if name not in STUDIES:
        raise CaseError(f"no study {_unknown(name, STUDIES)}")
    every = from_clone("paper.index").all_claims()
    known = [claim.name for claim in every]
    if unknown := [claim for claim in only if claim not in known]:
        raise CaseError(f"--only: no such claim {_unknown(unknown[0], known)}")
    chosen = [claim for claim in every if not only or claim.name in only]
    folder = out if out is not None else Path("outputs") / f"study_{name}"
    document = _checked(folder, chosen, jobs=jobs, force=force, quiet=quiet)
    if as_json:
        print_json(to_json(document))
    else:
        page = from_clone("paper.page")
        print("\n".join(page.lines_of(document)))
        print(f"{folder / 'study.html'} shows the runs, figures and numbers behind them")
    return EXIT_CODES[document["status"]]


def _checked(
    folder: Path, claims: Sequence[Any], *, jobs: int | None, force: bool, quiet: bool
) -> dict[str, Any]:
    """Check the claims, and report each with its runs."""
    experiments = from_clone("paper.experiments")
    paper = from_clone("paper.run")
    signals = importlib.import_module("fem.runtime.signals")
    compilation = importlib.import_module("fem.runtime.compilation")
    reporter = ScreenReporter(quiet=quiet)
    workers = jobs or cores()
    say_expected(reporter, f"{len(claims)} claims", OF_A_CLAIM_S * len(claims) / workers, workers)
    in_place = not quiet and sys.stderr.isatty()

    def progress(done: int, total: int) -> None:
        if in_place:
            end = "\r" if done < total else "\r" + " " * 40 + "\r"
            print(f"    {done} of {total} runs", end=end, file=sys.stderr, flush=True)

    with signals.interruptible(reporter) as stop, compilation.compilation_announced(reporter.message):
        runs = experiments.Experiments(jobs=jobs, progress=progress, stop=stop)
        document: dict[str, Any] = paper.check_claims(
            folder, runs, claims=claims, force=force, report=reporter.message
        )
    return document


def _unknown(name: str, known: Sequence[str]) -> str:
    near = did_you_mean(name, known)
    return f"{name!r}{f'; {near}' if near else ''} (known: {', '.join(known)})"
