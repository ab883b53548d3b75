"""`report`: one self-contained page from the folder of a run, a sweep or a study."""

import importlib
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fem.commands.shared import Quiet
from fem.progress import ScreenReporter
from fem.run_folder import FolderError, naming_what_cannot_be_written, write_atomically

PAGE = "report.html"


def report(
    folder: Path,
    /,
    *,
    to: Annotated[Path | None, Parameter(help="The file; default: report.html in the folder.")] = None,
    author: Annotated[str, Parameter(show_default=False, help="Who made it; may be filled in later.")] = "",
    checker: Annotated[str, Parameter(show_default=False, help="Who checked it.")] = "",
    revision: Annotated[str, Parameter(show_default=False, help="Which revision it is.")] = "",
    all_variations: Annotated[
        bool,
        Parameter(
            name="--all-variations",
            negative=(),
            show_default=False,
            help="Compute every variation of a run, however long it takes.",
        ),
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Make one HTML file that can be sent, read without a network, and printed.

    Parameters
    ----------
    folder:
        The folder of a run, a sweep or a study, such as outputs/my-stack.
    """
    if not folder.is_dir():
        raise FolderError(
            f"{folder}: no such folder; give the folder of a run, a sweep or a study, such as outputs/NAME"
        )
    reporter = ScreenReporter(quiet=quiet)
    runs = importlib.import_module("fem.run")
    pages = importlib.import_module("fem.report.run_page")
    signature = pages.Signature(author=author, checker=checker, revision=revision)
    if (folder / "sweep.json").is_file():
        page = importlib.import_module("fem.report.sweep_page").sweep_report(folder, signature=signature)
    elif (folder / "study.json").is_file():
        page = importlib.import_module("fem.report.study_page").study_report(folder, signature=signature)
    else:
        opened = importlib.import_module("fem.opening").open_run(folder)
        with runs.interruptible(reporter) as stop:
            page = pages.run_report(
                opened,
                signature=signature,
                every_variation=all_variations,
                told=reporter.message,
                stop=stop,
            )
    place = to if to is not None else folder / PAGE
    with naming_what_cannot_be_written(place.parent, "ask again, or elsewhere with --to FILE"):
        write_atomically(place, page)
    print(place)
