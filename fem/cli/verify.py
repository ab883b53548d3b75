"""`verify`: climb the verification ladder and say which rows hold."""

import importlib
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import AsJson, Quiet, flag
from fem.results.run_folder import naming_what_cannot_be_written, to_json, write_atomically

FAILED = 3
FOLDER = Path("outputs") / "verify"


def verify(
    *,
    quick: Annotated[bool, flag("Leave out what takes long: two minutes.")] = False,
    room: Annotated[tuple[str, ...], flag("Only this room; may be repeated.")] = (),
    out: Annotated[Path, Parameter(help="Folder of verify.json and verify.html.")] = FOLDER,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Compute every case that a number of this program rests on, and compare it with its reference.

    Ends with 3 if one row fails. The table goes to verify.json as well, and with plots to verify.html.
    """
    ladder = importlib.import_module("fem.verification.suite")
    pages = importlib.import_module("fem.verification.page")
    unknown = [name for name in room if name not in ladder.ROOMS]
    if unknown:
        raise ladder.UnknownRoomError(unknown[0])
    total = len(ladder.chosen_checks(quick=quick, rooms=room))
    done = 0

    def tell(name: str, check: str) -> None:
        nonlocal done
        done += 1
        if not quiet:
            print(f"[{done}/{total}] {name}: {check}", file=sys.stderr, flush=True)

    with naming_what_cannot_be_written(out, "ask again, or elsewhere with --out DIR"):
        out.mkdir(parents=True, exist_ok=True)
    found = ladder.climb(quick=quick, rooms=room, before=lambda name, check: tell(name, check.name))
    document = to_json(found.to_dict())
    with naming_what_cannot_be_written(out, "ask again, or elsewhere with --out DIR"):
        write_atomically(out / "verify.json", document)
        write_atomically(out / "verify.html", pages.page(found))
    if as_json:
        print(document.rstrip())
    else:
        print("\n".join(pages.table_lines(found)))
        print(f"{out / 'verify.html'} shows the convergence plots")
    return 0 if found.failures == 0 else FAILED
