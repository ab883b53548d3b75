"""`size`: the values of one key that fulfil the rule of a site."""

import importlib
import json
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.cli.console import (
    EXIT_CODES,
    AllowOutside,
    AsJson,
    Folder,
    Force,
    Jobs,
    Quiet,
    Resume,
    Scheduler,
    connected,
    whole,
)
from fem.runtime.progress import ScreenReporter


def size(
    site: str,
    /,
    *,
    over: Annotated[
        str, Parameter(help="The key: container.width_m, container.boxes, contact.mu_static, site...")
    ],
    low: Annotated[
        float | None,
        Parameter(name="--from", show_default=False, help="Least value; default: as suits the key."),
    ] = None,
    high: Annotated[float | None, Parameter(name="--to", show_default=False, help="Largest value.")] = None,
    count: Annotated[int | None, whole("Values of the scan; default: 13.")] = None,
    out: Folder = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    force: Force = False,
    allow_outside: AllowOutside = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Find the least width, the tallest stack, the window of friction or the strongest action that fulfils the rule.

    Parameters
    ----------
    site:
        A site file or the name of a shipped one: site.
    """
    request = importlib.import_module("fem.site_check.file").load_site(site)
    axis = importlib.import_module("fem.site_check.size_axis").size_axis(
        request, over, low=low, high=high, count=count
    )
    folder = out if out is not None else Path("outputs") / f"{request.name}_size"
    # Loaded late: bad input is refused before anything is compiled.
    study = importlib.import_module("fem.site_check.size_run")
    with connected(scheduler) as workers_of:
        result = study.run_size(
            request,
            axis,
            folder,
            jobs=jobs,
            workers_of=workers_of,
            resume=resume,
            force=force,
            allow_outside=allow_outside,
            reporter=ScreenReporter(quiet=quiet),
        )
    if result is None:
        print("interrupted; --resume continues")
        return EXIT_CODES["interrupted"]
    print(json.dumps(result.to_json(), indent=2) if as_json else study.size_page(result, folder))
    return EXIT_CODES["completed"]
