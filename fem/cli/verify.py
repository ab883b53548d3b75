"""`verify`: compute the verification checks and compare every row with its reference."""

import importlib
import sys
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fem.cli.console import AsJson, Quiet, flag
from fem.results.run_folder import naming_what_cannot_be_written, to_json, write_atomically

FAILED = 3
FOLDER = Path("outputs") / "verify"


def verify(
    *,
    quick: Annotated[bool, flag("Leave out what takes long: two minutes.")] = False,
    room: Annotated[tuple[str, ...], flag("Only this topic; may be repeated.")] = (),
    out: Annotated[Path, Parameter(help="Folder of verify.json and verify.html.")] = FOLDER,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Compute every case that a number of this program rests on, and compare it with its reference.

    Ends with 3 if one row fails. The table goes to verify.json as well, and with plots to verify.html.
    """
    suite = importlib.import_module("fem.verification.suite")
    pages = importlib.import_module("fem.verification.page")
    suite.chosen_checks(quick=quick, topics=room)  # refuses an unknown topic before a folder is made

    def report(number: int, count: int, check: Any) -> None:
        if not quiet:
            print(f"[{number}/{count}] {check.topic}: {check.title}", file=sys.stderr, flush=True)

    with naming_what_cannot_be_written(out, "ask again, or elsewhere with --out DIR"):
        out.mkdir(parents=True, exist_ok=True)
    result = suite.run_suite(quick=quick, topics=room, before=report)
    document = to_json(result.to_dict())
    with naming_what_cannot_be_written(out, "ask again, or elsewhere with --out DIR"):
        write_atomically(out / "verify.json", document)
        write_atomically(out / "verify.html", pages.page(result))
    if as_json:
        print(document.rstrip())
    else:
        print("\n".join(pages.table_lines(result)))
        print(f"{out / 'verify.html'} shows the convergence plots")
    return 0 if result.failures == 0 else FAILED
