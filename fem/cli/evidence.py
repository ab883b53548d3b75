"""`verify`, `validate` and `study`: what the folder `tests` of a clone computes, as document, page and table.

The program knows nothing else of its tests: this is the one door, and it opens where there is a clone.
"""

import importlib
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fem.case.validation import CaseError, did_you_mean
from fem.cli.console import (
    ELSEWHERE_OUT,
    EXIT_CODES,
    AsJson,
    Force,
    Jobs,
    Quiet,
    option,
    print_json,
    print_to_pdf,
)
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import require_writable, writing_into
from fem.results.json_block import to_json
from fem.runtime.own_files import make_folder, write_atomically
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say

TESTS = Path(__file__).parents[2] / "tests"  #: beside the program in a clone
FAILED = 3
OUTPUTS = Path("outputs")
STUDIES = ("seed",)
Computed = tuple[dict[str, Any], dict[str, Any]]  #: document, and drawings by name
Out = Annotated[Path | None, option("Folder of document and page; default: outputs/COMMAND.")]


def from_clone(name: str) -> Any:
    """A module of the clone's tests, by the name that it has in pytest.

    Raises:
        CaseError: the program is installed without them.
    """
    if not (TESTS / "evidence").is_dir():
        raise CaseError(
            "the checks are in the folder tests of a clone, and not in the installed program; "
            "clone the project, `python -m pip install -e .` there, and call the command again"
        )
    sys.path[:0] = [path for path in (str(TESTS), str(TESTS / "rigs")) if path not in sys.path]
    return importlib.import_module(name)


def paper_report(folder: Path, **options: Any) -> str:
    """The page of a checked paper; a CaseError as for `from_clone`."""
    return str(from_clone("paper.run").paper_report(folder, **options))


def verify(
    *,
    quick: bool = False,
    topic: Annotated[tuple[str, ...], Parameter(name=("--topic", "--room"))] = (),
    manual: bool = False,
    out: Out = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Compute the verification checks of the clone; writes verify.json, verify.html; ends with 3 if a row fails.

    Args:
        quick: Leave out long checks: half a minute once compiled, else two.
        topic: Only this topic; may be repeated.
        manual: Write manual.html, too: each requirement with its check, and print it.
    """
    suite = from_clone("verification.suite")
    # refuses an unknown topic before a folder is made
    chosen = suite.chosen_checks(quick=quick, topics=topic)

    def compute() -> Computed:
        return suite.run_suite(chosen, quick=quick, reporter=ScreenReporter(quiet=quiet)), {}

    return _written("verify", out, compute, as_json=as_json, manual=manual)


def validate(
    *, data: Path | None = None, out: Out = None, as_json: AsJson = False, quiet: Quiet = False
) -> int:
    """Predict the experiments of the clone; writes validate.json, validate.html; ends with 3 if one is missed.

    Args:
        data: Folder of shake-table tests: of the rocks, or your own.
    """
    suite = from_clone("validation.suite")
    suite.require(data)  # refused before a folder is made

    def compute() -> Computed:
        experiments = suite.run_validation(data, reporter=ScreenReporter(quiet=quiet))
        return suite.document_of(experiments), {one.name: one.figures for one in experiments}

    return _written("validate", out, compute, as_json=as_json)


def _written(
    name: str, out: Path | None, compute: Callable[[], Computed], *, as_json: bool, manual: bool = False
) -> int:
    """Write NAME.json, NAME.html and, if asked, manual.html; print the document or its table. Returns the exit code."""
    folder = out if out is not None else OUTPUTS / name
    pages = from_clone("evidence.pages")
    require_writable(folder, ELSEWHERE_OUT, BYTES_BESIDE)
    with writing_into(folder, ELSEWHERE_OUT):
        make_folder(folder)
    computed, pictures = compute()
    text = to_json(computed)
    document, page = json.loads(text), folder / f"{name}.html"
    with writing_into(folder, ELSEWHERE_OUT):
        write_atomically(folder / f"{name}.json", text)
        write_atomically(page, pages.page_of(name, document, pictures))
        if manual:
            page = folder / "manual.html"
            write_atomically(page, pages.page_of("manual", document, pictures))
    shown = f"{page} shows the tables and drawings" + (f"\n{print_to_pdf(page)}" if manual else "")
    say(text.rstrip() if as_json else "\n".join([*pages.LINES[name](document), shown]))
    return 0 if document["passed"] else FAILED


def study(
    name: str = "seed",
    /,
    *,
    out: Path | None = None,
    jobs: Jobs = None,
    only: tuple[str, ...] = (),
    force: Force = False,
    as_json: Annotated[bool, option("Print study.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Check every claim of the paper: confirmed, confirmed within stated bounds, or refuted.

    The paper is Knoedel and Hrabowski, A simple stick-slip model for the overturning stability of unanchored
    containers. The claims are in the clone. Writes study.html, one page with the run, figure and number behind each
    conclusion, and study.json. A claim that the same version of the program has decided is not checked again.

    Args:
        name: The study: seed.
        out: Folder of the results; default: outputs/study_NAME.
        only: Only this claim; may be repeated.
    """
    if name not in STUDIES:
        raise CaseError(f"no study {name!r}{did_you_mean(name, STUDIES)} (known: {', '.join(STUDIES)})")
    folder = out if out is not None else OUTPUTS / f"study_{name}"
    document = from_clone("paper.run").check_paper(folder, only=only, jobs=jobs, force=force, quiet=quiet)
    if as_json:
        print_json(to_json(document))
    else:
        say("\n".join(from_clone("evidence.pages").LINES["study"](document)))
        say(f"{folder / 'study.html'} shows the runs, figures and numbers behind them")
    return EXIT_CODES[document["status"]]
