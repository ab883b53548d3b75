"""What commands have in common: options that mean the same everywhere, and the exit code of a status."""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter, Token

from fem.results.kinds import ResultKind
from fem.runtime.signals import unheard
from fem.runtime.terminal import say
from fem.runtime.user_files import read_text

if TYPE_CHECKING:
    from fem.study.driver import StudyResult

ELSEWHERE_OUT = "run the command again, or choose another place with --out DIR"
ELSEWHERE_TO = "run the command again, or choose another place with --to FILE"
PAGE, SHORT_PAGE = "report.html", "report-short.html"
WIDTH = 79  #: of what is printed for people
#: exit codes by status: 0 computed, 3 failed, 4 interrupted
EXIT_CODES = {"completed": 0, "overturned": 0, "failed": 3, "interrupted": 4}


def option(text: str, *names: str) -> Parameter:
    """What is said of an option, named like its argument unless names are given."""
    return Parameter(name=names or None, help=text)


def _whole(kind: type, tokens: Sequence[Token]) -> int:
    """A whole number; cyclopts would round 2.5 silently."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"a whole number is needed, not {tokens[0].value!r}") from None


def _at_least_one(kind: type, count: int | None) -> None:
    if count is not None and count < 1:
        raise ValueError(f"at least one core is needed, not {count}")


WHOLE = Parameter(converter=_whole)
CaseName = Annotated[
    str | None, option("A case file or the name of a shipped case; default: seed_stack_plateau.", "CASE")
]
Out = Annotated[Path | None, option("Folder of the results; default: outputs/NAME.")]
Overrides = Annotated[
    tuple[str, ...], option("Set a key of the case, as in contact.mu_static=0.3; may be repeated.", "--set")
]
Motion = Annotated[
    str | None, option("A record in place of motion.file, anywhere; FILE#CHANNEL of several.", "--motion")
]
AllowOutside = Annotated[bool, option("Let the case file name files outside its folder.", "--allow-outside")]
AllowBaseline = Annotated[
    bool, option("Take a baseline that changes a peak of a record by more than 20 %.", "--allow-baseline")
]
Jobs = Annotated[
    int | None,
    option("Number of cores; default: all.", "--jobs", "-j"),
    Parameter(converter=_whole, validator=_at_least_one),
]
Resume = Annotated[bool, option("Continue an interrupted computation.")]
Force = Annotated[bool, option("Recompute and overwrite existing results.")]
AsJson = Annotated[bool, option("Print JSON.", "--json")]
Quiet = Annotated[bool, option("Print no progress.", "--quiet", "-q")]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class StudyFlags:
    """Options of every study of many runs."""

    out: Out = None
    jobs: Jobs = None
    scheduler: Annotated[
        str | None,
        option(
            "Address of a dask scheduler, such as tcp://127.0.0.1:8786. Whoever reaches it can run code on it and on "
            "its workers; start all with the certificates of dask's TLS, and give tls://HOST:PORT."
        ),
    ] = None
    resume: Resume = False
    force: Force = False
    as_json: AsJson = False
    quiet: Quiet = False


STUDY = StudyFlags()


def print_to_pdf(page: Path) -> str:
    """Print a page: the name of the PDF, or how to print it by hand where there is no browser."""
    printing = importlib.import_module("fem.report.printing")
    return str(printing.print_page(page) or printing.BY_HAND)


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
        noted = "\n".join(
            fill(f"  note: {words}", WIDTH, subsequent_indent="    ") for words in result.warnings
        )
        say("\n".join(filter(None, (page, noted, result.no_answer_yet or result.answer))))
    return EXIT_CODES[result.status]
