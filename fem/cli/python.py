"""Studies from Python, one function each: sweeps, ensembles, lists, response curves, verifications at sites.

Each does what the command of its name does, writes the same folder and gives its table: a mapping of columns as numpy
arrays, which `pandas.DataFrame` takes as it is. What is finished in the folder is not computed again. In a script, call
them behind `if __name__ == "__main__":`, as `fem.compute_many`. How it is computed is said by `Options`; a study raises

- CaseError or MeshError, each a ValueError, for bad input;
- FolderError or OutputError where the folder holds something else, or cannot be written.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypedDict, Unpack

from fem.case.case import Case
from fem.response.request import request_of
from fem.response.run import run_response
from fem.run.opened import StudyTable, open_run
from fem.runtime.progress import ScreenReporter, watched
from fem.site.request import load_site
from fem.site.run import run_site
from fem.study.ensemble import run_ensemble
from fem.study.file import load_ensemble, load_sweep
from fem.study.hall import Checks, run_hall
from fem.study.hall_file import read_hall
from fem.study.sweep import run_sweep

OUTPUTS = Path("outputs")


class Options(TypedDict, total=False):
    """How a study is computed; its result does not depend on it."""

    jobs: int | None  #: cores to use; None: all
    resume: bool  #: continue one that was interrupted
    force: bool  #: compute again what is there
    progress: bool | None  #: show it by a line; None: on a terminal and in a notebook


def compute_sweep(
    sweep: str | Path, folder: str | Path | None = None, **options: Unpack[Options]
) -> StudyTable:
    """Compute the cases of a sweep; a row a cell.

    Args:
        sweep: a sweep file, or the name of a shipped sweep.
        folder: of the results; default: outputs/NAME.
    """
    plan = load_sweep(sweep)
    return _table(run_sweep, plan, folder=folder or OUTPUTS / plan.name, options=options)


def compute_ensemble(
    ensemble: str | Path, folder: str | Path | None = None, **options: Unpack[Options]
) -> StudyTable:
    """Sample the uncertain parameters of an ensemble; a row a point of its axes. Arguments as `compute_sweep`."""
    plan = load_ensemble(ensemble)
    return _table(run_ensemble, plan, folder=folder or OUTPUTS / plan.name, options=options)


def compute_list(
    path: str | Path,
    case: Case,
    folder: str | Path | None = None,
    *,
    margins: Checks = "weakest",
    **options: Unpack[Options],
) -> StudyTable:
    """Compute a list of containers, a CSV file whose rows change a case; a row a container.

    Args:
        path: of the list.
        case: that its rows change.
        folder: of the results; default: outputs/NAME.
        margins: whose run is repeated for sure and margin: that of the weakest tenth (at least 30), all, or none.
    """
    path = Path(path)
    return _table(
        run_hall, read_hall(path), case, folder=folder or OUTPUTS / path.stem, options=options, checks=margins
    )


def compute_response(
    case: Case,
    folder: str | Path | None = None,
    *,
    first_Hz: float | None = None,
    last_Hz: float | None = None,
    count: int = 28,
    starts: int = 8,
    **options: Unpack[Options],
) -> StudyTable:
    """Sweep the frequency of a harmonic floor up and down and from random states; a row a motion that was followed.

    Args:
        case: rigid or reduced, under a harmonic motion.
        folder: of the results; default: outputs/NAME-response.
        first_Hz, last_Hz: lowest and highest frequency [Hz]; default: 3/11 and 30/11 of the case's own.
        count: frequencies, both ends included.
        starts: random states from which each frequency is begun as well.
    """
    request = request_of(case, first_Hz, last_Hz, count=count, starts=starts)
    return _table(run_response, request, folder=folder or OUTPUTS / f"{case.name}-response", options=options)


def assess_site(
    site: str | Path, folder: str | Path | None = None, *, quick: bool = False, **options: Unpack[Options]
) -> StudyTable:
    """Verify a container at a site; a row a run, and `result` with the answer.

    Args:
        site: a site file, or the name of a shipped one.
        folder: of the results; default: outputs/NAME.
        quick: the set of motions and its repetitions alone.
    """
    request = load_site(site)
    return _table(run_site, request, folder=folder or OUTPUTS / request.name, quick=quick, options=options)


def _table(
    compute: Callable[..., object], *asked: Any, folder: str | Path, options: Options, **more: Any
) -> StudyTable:
    progress = options.pop("progress", None)
    reporter = ScreenReporter(quiet=not (watched() if progress is None else progress))
    place = Path(folder).expanduser()
    compute(*asked, folder=place, reporter=reporter, **options, **more)
    table = open_run(place)
    assert isinstance(table, StudyTable)
    return table
