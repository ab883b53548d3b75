"""`validate`: predict laboratory experiments and compare with what was measured."""

import sys
from functools import partial
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import AsJson, Quiet
from fem.cli.evidence import compute_into, from_clone
from fem.run.expected import say_expected
from fem.runtime.progress import ScreenReporter

FOLDER = Path("outputs") / "validate"
ALL_S, TABLE_S = 60.0, 240.0  #: without and with tests on a shake table


def validate(
    *,
    data: Annotated[
        Path | None, Parameter(help="Folder of shake-table tests: of the rocks, or your own.")
    ] = None,
    out: Annotated[Path, Parameter(help="Folder of validate.json and validate.html.")] = FOLDER,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Predict experiments; writes validate.json and validate.html; exits with 3 if one is missed."""
    suite = from_clone("validation.suite")
    pages = from_clone("validation.page")

    def report(name: str) -> None:
        if not quiet:
            print(name, file=sys.stderr, flush=True)

    suite.require(data)  # refused before a folder is made
    if not quiet:
        expected = ALL_S + (TABLE_S if data is not None else 0.0)
        say_expected(ScreenReporter(), "the experiments, once kernels are compiled", expected)
    return compute_into(
        out, "validate", partial(suite.run_validation, data, before=report), pages, as_json=as_json
    )
