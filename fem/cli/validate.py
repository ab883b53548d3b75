"""`validate`: predict laboratory experiments and compare with what was measured."""

import importlib
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import ELSEWHERE_OUT, AsJson, Quiet
from fem.results.errors import writing_into
from fem.results.files import to_json, write_atomically
from fem.runtime.identity import versions

MISSED = 3
FOLDER = Path("outputs") / "validate"


def validate(
    *,
    data: Annotated[Path | None, Parameter(help="Folder of the rock motions.")] = None,
    out: Annotated[Path, Parameter(help="Folder of validate.json and validate.html.")] = FOLDER,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Predict experiments; writes validate.json and validate.html; exits with 3 if one is missed."""
    suite = importlib.import_module("fem.evidence.validation.suite")
    pages = importlib.import_module("fem.evidence.validation.page")

    def report(name: str) -> None:
        if not quiet:
            print(name, file=sys.stderr, flush=True)

    result = suite.run_validation(data, before=report)
    document = to_json(result.to_dict(versions()))
    with writing_into(out, ELSEWHERE_OUT):
        out.mkdir(parents=True, exist_ok=True)
        write_atomically(out / "validate.json", document)
        write_atomically(out / "validate.html", pages.page(result))
    if as_json:
        print(document.rstrip())
    else:
        print("\n".join(pages.table_lines(result)))
        print(f"{out / 'validate.html'} shows the tables")
    return 0 if result.missed == 0 else MISSED
