"""`ensemble`: probability of overturning with uncertain parameters."""

import importlib
import json
from pathlib import Path
from typing import Annotated

from fem.cli.console import EXIT_CODES, Folder, Force, Jobs, Quiet, Resume, Scheduler, connected, flag
from fem.results.files import to_json
from fem.runtime.progress import ScreenReporter


def ensemble(
    ensemble: str,
    /,
    *,
    out: Folder = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    force: Force = False,
    as_json: Annotated[bool, flag("Print ensemble.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Sample the uncertain parameters and count how often the container overturns, with confidence intervals.

    Parameters
    ----------
    ensemble:
        An ensemble file or the name of a shipped one: fragility, boundary.
    """
    asked = importlib.import_module("fem.ensemble.file").load_ensemble(ensemble)
    folder = out if out is not None else Path("outputs") / asked.name
    # Loaded late: bad input is refused before anything is compiled.
    study = importlib.import_module("fem.ensemble.run")
    with connected(scheduler) as workers_of:
        result = study.run_ensemble(
            asked,
            folder=folder,
            jobs=jobs,
            workers_of=workers_of,
            force=force,
            resume=resume,
            reporter=ScreenReporter(quiet=quiet),
        )
    result = json.loads(to_json(result))
    print(json.dumps(result, indent=2) if as_json else study.page_of(result, folder))
    return EXIT_CODES[result["status"]]
