"""`report`: one self-contained page from the folder of a run, a sweep, an ensemble, a response curve or a study."""

import importlib
from pathlib import Path
from typing import Annotated

from fem.cli.console import ELSEWHERE_TO, PAGE, SHORT_PAGE, Quiet, option, print_to_pdf
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import FolderError, require_writable, writing_into
from fem.runtime.own_files import make_folder, write_atomically
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say

OF = "The folder of a run, a sweep, an ensemble, a response curve, a hall or a study, such as outputs/my-stack."
SUFFIXES = (".html", ".htm")
#: what makes the page of a study, by the file that marks its folder
PAGES = {
    "sweep.json": "fem.report.study_page:sweep_report",
    "ensemble.json": "fem.report.study_page:ensemble_report",
    "response.json": "fem.report.study_page:response_report",
    "study.json": "fem.cli.evidence:paper_report",
    "assess.json": "fem.site.page:site_report",
    "hall.json": "fem.report.study_page:hall_report",
}

#: the files that mark a folder whose report has a short form
WITH_SHORT = ("run.json", "assess.json", "hall.json")


def report(
    folder: Annotated[Path, option(OF)],
    /,
    *,
    to: Path | None = None,
    author: str = "",
    checker: str = "",
    revision: str = "",
    short: bool = False,
    pdf: bool = False,
    full: bool = False,
    quiet: Quiet = False,
) -> None:
    """Make one HTML file that can be sent, read offline and printed.

    Args:
        to: The file; default: report.html, or report-short.html, in the folder.
        author: Author; may be filled in later.
        checker: Checker.
        revision: Revision.
        short: At most three printed pages, of a run; two, of a verification at a site.
        pdf: Print the short page to a PDF beside it, by Chromium or Chrome.
        full: With --pdf: the whole page.
    """
    if not folder.is_dir():
        raise FolderError(
            f"{folder}: no such folder; give the folder of a run, a sweep, an ensemble, a response curve or a study, "
            "such as outputs/NAME"
        )
    has_short = any((folder / mark).is_file() for mark in WITH_SHORT)
    if short and not has_short:
        raise FolderError(
            f"{folder}: --short is for the report of a run, of a verification at a site, or of a hall"
        )
    short = short or (pdf and has_short and not full)
    if pdf and to is not None and to.suffix.lower() == ".pdf":
        to = to.with_suffix(".html")  # the PDF lies beside the page
    # where the page goes, checked before anything is computed; never a file of results
    target = to if to is not None else folder / (SHORT_PAGE if short else PAGE)
    if target.suffix.lower() not in SUFFIXES:
        raise FolderError(
            f"--to {target}: the page is HTML; give a name that ends in {' or '.join(SUFFIXES)}"
        )
    if target.is_dir():
        raise FolderError(f"--to {target}: this is a folder; give the name of a file in it")
    try:
        make_folder(target.parent)
    except OSError as error:
        reason = f"the folder cannot be made ({error.strerror or error}); choose another place"
        raise FolderError(f"--to {target}: {reason}") from None
    require_writable(target.parent, ELSEWHERE_TO, BYTES_BESIDE)
    reporter = ScreenReporter(quiet=quiet)
    pages = importlib.import_module("fem.report.run_page")
    signature = pages.Signature(author=author, checker=checker, revision=revision)
    mark = next((mark for mark in PAGES if (folder / mark).exists()), "run.json")
    try:
        if mark in PAGES:
            module, _, name = PAGES[mark].partition(":")
            brief = {"brief": True} if short else {}
            page = getattr(importlib.import_module(module), name)(folder, signature=signature, **brief)
        else:
            opened = importlib.import_module("fem.results.reader").open_run(folder)
            models = () if short else importlib.import_module("fem.report.models").of_run(opened)
            page = pages.run_report(
                opened, signature=signature, brief=short, models=models, message=reporter.message
            )
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        if not type(error).__module__ == "builtins":
            raise  # has its words already
        raise FolderError(
            f"{folder / mark}: damaged, no page can be made of it ({type(error).__name__}: {error}); compute it again "
            "with --force"
        ) from error
    with writing_into(target.parent, ELSEWHERE_TO):
        write_atomically(target, page)
    say(target)
    if pdf:
        say(print_to_pdf(target))
