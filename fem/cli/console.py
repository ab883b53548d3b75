"""What commands have in common: options that mean the same everywhere, and the exit code of a status."""

import importlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter, Token

from fem.case.validation import CaseError
from fem.results.errors import require_writable
from fem.results.kinds import ResultKind
from fem.runtime.own_files import write_atomically
from fem.runtime.progress import ScreenReporter
from fem.runtime.signals import unheard
from fem.runtime.terminal import say
from fem.runtime.user_files import read_text

if TYPE_CHECKING:
    from fem.study.driver import StudyOptions, StudyResult

ELSEWHERE_OUT = "run the command again, or choose another place with --out DIR"
ELSEWHERE_TO = "run the command again, or choose another place with --to FILE"
PAGE, SHORT_PAGE = "report.html", "report-short.html"
WIDTH = 79  #: of what is printed for people
#: exit codes by status: 0 computed, 3 failed, 4 interrupted
EXIT_CODES = {"completed": 0, "overturned": 0, "failed": 3, "interrupted": 4}


def flag(text: str, *names: str) -> Parameter:
    """A switch without a negative form, named like the argument unless names are given."""
    return Parameter(name=names or None, negative=(), show_default=False, help=text)


def _whole(kind: type, tokens: Sequence[Token]) -> int:
    """A whole number; cyclopts would round 2.5 silently."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"a whole number is needed, not {tokens[0].value!r}") from None


def _at_least_one(kind: type, count: int | None) -> None:
    if count is not None and count < 1:
        raise ValueError(f"at least one core is needed, not {count}")


def whole(text: str) -> Parameter:
    """A whole number; a fraction is refused."""
    return Parameter(help=text, converter=_whole)


CaseName = Annotated[
    str | None,
    Parameter(name="CASE", help="A case file or the name of a shipped case; default: seed_stack_plateau."),
]
RunFolder = Annotated[Path, Parameter(name="RUN", help="Folder of a run, such as outputs/my-stack.")]
Folder = Annotated[Path | None, Parameter(help="Folder of the results; default: outputs/NAME.")]
Overrides = Annotated[
    tuple[str, ...], flag("Set a key of the case, as in contact.mu_static=0.3; may be repeated.", "--set")
]
Motion = Annotated[
    str | None,
    Parameter(name="--motion", help="A record in place of motion.file, anywhere; FILE#CHANNEL of several."),
]
AllowOutside = Annotated[bool, flag("Let the case file name files outside its folder.", "--allow-outside")]
AllowBaseline = Annotated[
    bool, flag("Take a baseline that changes a peak of a record by more than 20 %.", "--allow-baseline")
]
Jobs = Annotated[
    int | None,
    Parameter(
        name=("--jobs", "-j"),
        show_default=False,
        help="Number of cores; default: all.",
        converter=_whole,
        validator=_at_least_one,
    ),
]
Resume = Annotated[bool, flag("Continue an interrupted computation.")]
Force = Annotated[bool, flag("Recompute and overwrite existing results.")]
AsJson = Annotated[bool, flag("Print JSON.", "--json")]
Scheduler = Annotated[
    str | None,
    Parameter(
        show_default=False,
        help="Address of a dask scheduler, such as tcp://127.0.0.1:8786. Whoever reaches it can run code on it and "
        "on its workers; start all with the certificates of dask's TLS, and give tls://HOST:PORT.",
    ),
]
Quiet = Annotated[bool, flag("Print no progress.", "--quiet", "-q")]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class StudyFlags:
    """Options of every study of many runs."""

    out: Folder = None
    jobs: Jobs = None
    scheduler: Scheduler = None
    resume: Resume = False
    force: Force = False
    as_json: AsJson = False
    quiet: Quiet = False

    def folder(self, name: str) -> Path:
        """Folder of the results, which can be written: as given, else that of this name.

        Raises:
            OutputError: it cannot; motions may take long before it is opened.
        """
        folder = self.out if self.out is not None else Path("outputs") / name
        require_writable(folder)
        return folder

    @contextmanager
    def options(self) -> "Iterator[StudyOptions]":
        """For `run_study`; workers of a cluster are released at the end."""
        cluster: AbstractContextManager[Any] = nullcontext()
        if self.scheduler is not None:
            try:  # the optional dask is loaded here
                cluster = importlib.import_module("fem.study.cluster").cluster(self.scheduler)
            except ModuleNotFoundError as error:
                if (error.name or "").partition(".")[0] not in ("dask", "distributed"):
                    raise
                words = "--scheduler needs the extra 'cluster': python -m pip install \"unanchored[cluster]\""
                raise CaseError(words) from None
        with cluster as workers_of:
            yield {
                "jobs": self.jobs,
                "workers_of": workers_of,
                "resume": self.resume,
                "force": self.force,
                "reporter": ScreenReporter(quiet=self.quiet),
            }


def print_short(folder: Path, report: Callable[..., str]) -> str:
    """Write the short page of a folder and print it, as `print_to_pdf`."""
    page = folder / SHORT_PAGE
    write_atomically(page, report(folder, brief=True))
    return print_to_pdf(page)


def print_to_pdf(page: Path) -> str:
    """Print a page: the name of the PDF, or how to print it by hand where there is no browser."""
    printing = importlib.import_module("fem.report.printing")
    return str(printing.print_page(page) or printing.BY_HAND)


STUDY = StudyFlags()


def print_json(text: str) -> None:
    """Print a document, whole or not at all."""
    with unheard():
        say(text.rstrip(), flush=True)


def print_result(result: "StudyResult", kind: ResultKind, folder: Path, page: str, *, as_json: bool) -> int:
    """Print the result of a study, its marking file or a page for people; returns its exit code.

    Args:
        page: without its last line, which is the answer or what is missing.
    """
    if as_json:
        print_json(read_text(folder / kind.mark))
    else:
        say("\n".join(filter(None, (page, result.no_answer_yet or result.answer))))
    return EXIT_CODES[result.status]
