"""What `verify`, `validate` and `study` share: checks of a clone's `tests`, computed into a document and a page."""

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fem.case.validation import CaseError
from fem.cli.console import ELSEWHERE_OUT
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import require_writable, writing_into
from fem.results.files import to_json, write_atomically

FAILED = 3
TESTS = Path(__file__).parents[2] / "tests"  #: beside the program in a clone
PATHS = (TESTS, TESTS / "rigs")  #: where its modules are found, as by pytest


def from_clone(name: str) -> Any:
    """A module of the clone's tests: the one door from the program to them.

    Raises:
        CaseError: the program is installed without them.
    """
    if not (TESTS / "evidence").is_dir():
        raise CaseError(
            "the checks are in the folder tests of a clone, and not in the installed program; "
            "clone the project, `python -m pip install -e .` there, and call the command again"
        )
    sys.path[:0] = [str(path) for path in PATHS if str(path) not in sys.path]
    return importlib.import_module(name)


def compute_into(out: Path, name: str, compute: Callable[[], Any], pages: Any, *, as_json: bool) -> int:
    """Write NAME.json and NAME.html, print the document or the table; the exit code, 3 where a finding fails."""
    require_writable(out, ELSEWHERE_OUT, BYTES_BESIDE)
    with writing_into(out, ELSEWHERE_OUT):
        out.mkdir(parents=True, exist_ok=True)
    result = compute()
    document, page = to_json(result.to_dict()), out / f"{name}.html"
    with writing_into(out, ELSEWHERE_OUT):
        write_atomically(out / f"{name}.json", document)
        write_atomically(page, pages.page_of(result))
    print(document.rstrip() if as_json else "\n".join([*pages.lines_of(result), f"{page} {pages.SHOWS}"]))
    return FAILED if result.failures else 0


def paper_report(folder: Path, **options: Any) -> str:
    """The page of a checked paper, by the clone's tests.

    Raises:
        CaseError: the program is installed without them.
    """
    return str(from_clone("paper.page").paper_report(folder, **options))
