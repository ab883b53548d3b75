"""`ensemble`: how probable is it that the container overturns, over strength of motion, slenderness, friction."""

import importlib
import json
from pathlib import Path
from typing import Annotated

from fem.cli.console import EXIT_CODES, Folder, Force, Jobs, Quiet, flag
from fem.results.run_folder import to_json
from fem.runtime.progress import ScreenReporter


def ensemble(
    ensemble: str,
    /,
    *,
    out: Folder = None,
    jobs: Jobs = None,
    resume: Annotated[bool, flag("Go on with the draws that are there.")] = False,
    force: Force = False,
    as_json: Annotated[bool, flag("Print ensemble.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Draw what nobody knows beforehand and count what overturns, with confidence intervals.

    Parameters
    ----------
    ensemble:
        An ensemble file or the name of a shipped one: fragility, boundary.
    """
    asked = importlib.import_module("fem.ensemble.file").load_ensemble(ensemble)
    folder = out if out is not None else Path("outputs") / asked.name
    # The solver is loaded only now: bad input is answered before anything is compiled.
    study = importlib.import_module("fem.ensemble.run")
    done = study.run_ensemble(
        asked, folder=folder, jobs=jobs, force=force, resume=resume, reporter=ScreenReporter(quiet=quiet)
    )
    result = json.loads(to_json(done.result))
    print(json.dumps(result, indent=2) if as_json else study.page_of(result, folder))
    return EXIT_CODES[done.status]
