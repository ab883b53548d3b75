"""`assess`: verify a container at a site, by time histories for the action of EN 1998-1."""

import importlib
from pathlib import Path
from typing import Annotated

from fem.cli.console import (
    EXIT_CODES,
    AllowOutside,
    Folder,
    Force,
    Jobs,
    Quiet,
    Resume,
    Scheduler,
    connected,
    flag,
)
from fem.results.files import to_json
from fem.runtime.progress import ScreenReporter


def assess(
    site: str,
    /,
    *,
    out: Folder = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    force: Force = False,
    motion: Annotated[
        tuple[str, ...],
        flag(
            "A record in place of the motions of the site, anywhere, or a pair H,V; repeat it for each.",
            "--motion",
        ),
    ] = (),
    allow_outside: AllowOutside = False,
    as_json: Annotated[bool, flag("Print assess.json.", "--json")] = False,
    pdf: Annotated[bool, flag("Print the page to report.pdf, by Chromium or Chrome.")] = False,
    quiet: Quiet = False,
) -> int:
    """Verify a container at a site: overturning and slip under motions for the site, by EN 1998-1, 4.4.2.4(2).

    Motions that match the spectra of the site, the container full and empty, over the range of friction, with both
    signs of the vertical motion; the answer by a stated rule and limits, beside simplified methods. Writes
    report.html and assess.json.

    Parameters
    ----------
    site:
        A site file or the name of a shipped one: site.
    """
    request = importlib.import_module("fem.site_check.file").load_site(site, motion)
    folder = out if out is not None else Path("outputs") / request.name
    # Loaded late: bad input is refused before anything is compiled.
    study = importlib.import_module("fem.site_check.run")
    with connected(scheduler) as workers_of:
        result = study.run_site(
            request,
            folder,
            jobs=jobs,
            workers_of=workers_of,
            resume=resume,
            force=force,
            allow_outside=allow_outside or bool(motion),
            reporter=ScreenReporter(quiet=quiet),
        )
    if pdf and result.status == "completed":
        printing = importlib.import_module("fem.report.printing")
        ScreenReporter(quiet=quiet).message(str(printing.print_page(folder / study.PAGE) or printing.BY_HAND))
    print(to_json(result.to_json()).rstrip() if as_json else study.page_of(result, folder))
    return EXIT_CODES[result.status]
