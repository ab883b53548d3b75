"""`verify`: compute the verification checks and compare every row with its reference."""

import sys
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fem.cli.console import AsJson, Quiet, flag
from fem.cli.evidence import compute_into, from_clone
from fem.run.expected import say_expected
from fem.runtime.progress import ScreenReporter

FOLDER = Path("outputs") / "verify"
QUICK_S, ALL_S = 30.0, 100.0  #: on one core


def verify(
    *,
    quick: Annotated[bool, flag("Leave out long checks: half a minute once compiled, else two.")] = False,
    topic: Annotated[tuple[str, ...], flag("Only this topic; may be repeated.", "--topic", "--room")] = (),
    out: Annotated[Path, Parameter(help="Folder of verify.json and verify.html.")] = FOLDER,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Compute the verification checks; writes verify.json and verify.html; ends with 3 if one row fails."""
    suite = from_clone("verification.suite")
    pages = from_clone("verification.page")
    # refuses an unknown topic before a folder is made
    chosen = suite.chosen_checks(quick=quick, topics=topic)

    def report(number: int, count: int, check: Any) -> None:
        if not quiet:
            print(f"[{number}/{count}] {check.topic}: {check.title}", file=sys.stderr, flush=True)

    if not quiet:
        share = len(chosen) / len(suite.chosen_checks(quick=quick, topics=()))
        seconds = share * (QUICK_S if quick else ALL_S)
        say_expected(ScreenReporter(), "the checks, once kernels are compiled", seconds)
    return compute_into(
        out,
        "verify",
        partial(suite.run_suite, quick=quick, topics=topic, before=report),
        pages,
        as_json=as_json,
    )
