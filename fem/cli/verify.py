"""`verify`: compute the verification checks and compare every row with its reference."""

import importlib
import sys
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fem.cli.console import ELSEWHERE_OUT, AsJson, Quiet, flag
from fem.results.errors import writing_into
from fem.results.files import to_json, write_atomically

FAILED = 3
FOLDER = Path("outputs") / "verify"


def verify(
    *,
    quick: Annotated[bool, flag("Leave out long checks: two minutes in all.")] = False,
    topic: Annotated[tuple[str, ...], flag("Only this topic; may be repeated.", "--topic", "--room")] = (),
    out: Annotated[Path, Parameter(help="Folder of verify.json and verify.html.")] = FOLDER,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Compute the verification checks; writes verify.json and verify.html; ends with 3 if one row fails."""
    suite = importlib.import_module("fem.evidence.verification.suite")
    pages = importlib.import_module("fem.evidence.verification.page")
    suite.chosen_checks(quick=quick, topics=topic)  # refuses an unknown topic before a folder is made

    def report(number: int, count: int, check: Any) -> None:
        if not quiet:
            print(f"[{number}/{count}] {check.topic}: {check.title}", file=sys.stderr, flush=True)

    with writing_into(out, ELSEWHERE_OUT):
        out.mkdir(parents=True, exist_ok=True)
    result = suite.run_suite(quick=quick, topics=topic, before=report)
    document = to_json(result.to_dict())
    with writing_into(out, ELSEWHERE_OUT):
        write_atomically(out / "verify.json", document)
        write_atomically(out / "verify.html", pages.page(result))
    if as_json:
        print(document.rstrip())
    else:
        print("\n".join(pages.table_lines(result)))
        print(f"{out / 'verify.html'} shows the convergence plots")
    return 0 if result.failures == 0 else FAILED
