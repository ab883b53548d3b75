"""`ensemble`: how probable is it that the container overturns, over strength of motion, slenderness, friction."""

import importlib
import json
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.case import CaseError
from fem.progress import ScreenReporter
from fem.run_folder import to_json

EXIT_CODES = {"completed": 0, "failed": 3, "interrupted": 4}


def ensemble(
    ensemble: str,
    /,
    *,
    out: Annotated[Path | None, Parameter(help="Folder of the results; default: outputs/NAME.")] = None,
    jobs: Annotated[
        int | None, Parameter(name=("--jobs", "-j"), show_default=False, help="Cores; default: all.")
    ] = None,
    resume: Annotated[
        bool, Parameter(negative=(), show_default=False, help="Go on with the draws that are there.")
    ] = False,
    force: Annotated[
        bool, Parameter(negative=(), show_default=False, help="Compute anew, over what is there.")
    ] = False,
    as_json: Annotated[
        bool, Parameter(name="--json", negative=(), show_default=False, help="Print ensemble.json.")
    ] = False,
    quiet: Annotated[
        bool, Parameter(name=("--quiet", "-q"), negative=(), show_default=False, help="No progress.")
    ] = False,
) -> int:
    """Draw what nobody knows beforehand and count what overturns, with confidence intervals.

    Parameters
    ----------
    ensemble:
        An ensemble file or the name of a shipped one: fragility, boundary.
    """
    if jobs is not None and jobs < 1:
        raise CaseError(f"-j {jobs}: at least one core is needed")
    asked = importlib.import_module("fem.ensemble.file").load_ensemble(ensemble)
    folder = out if out is not None else Path("outputs") / asked.name
    # The solver is loaded only now: bad input is answered before anything is compiled.
    study = importlib.import_module("fem.ensemble.study")
    done = study.run_ensemble(
        asked, folder=folder, jobs=jobs, force=force, resume=resume, reporter=ScreenReporter(quiet=quiet)
    )
    result = json.loads(to_json(done.result))
    print(json.dumps(result, indent=2) if as_json else study.page_of(result, folder))
    return EXIT_CODES[done.status]
