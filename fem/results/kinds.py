"""The kinds of results that have a folder: the file that marks each, and the files that each may replace."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from fem.results.errors import FolderError
from fem.results.json_block import JsonBlock
from fem.runtime.user_files import read_json

BlockT = TypeVar("BlockT", bound=JsonBlock)

#: of a run, a site or a list
PAGES = ("report.html", "report.pdf", "report-short.html", "report-short.pdf")


@dataclass(frozen=True, kw_only=True)
class ResultKind:
    """A kind of result."""

    name: str
    article: str = "a"
    subject: str  #: what two requests differ in, such as "case"
    mark: str  #: name of the JSON file that marks the folder
    request: str = "asked"  #: its key that holds the hash of what was asked
    results: str  #: where to look for the numbers
    #: patterns of the files that are removed before a new result is computed; nothing else ever is
    own: tuple[str, ...]
    #: those of them that serve to continue, and go when it is finished
    temporary: tuple[str, ...] = ()
    #: statuses after which there is nothing left to compute
    finished: frozenset[str] = frozenset({"completed"})


RUN = ResultKind(
    name="run",
    subject="case",
    mark="run.json",
    request="case_hash",
    results="history.csv",
    own=(
        *PAGES,
        *("checkpoint.npz", "band.json", "summary.txt", "history.csv", "rigid_check.csv", "fields/run.pvd"),
        *("fields/frame_*.vtu", "figures/*.svg", "figures/drawn.json", "figures/picture_*.png"),
        *("figures/movie.gif", "figures/movie.mp4"),
    ),
    finished=frozenset({"completed", "overturned"}),
)
SWEEP = ResultKind(
    name="sweep",
    subject="sweep",
    mark="sweep.json",
    request="sweep_hash",
    results="table.csv",
    own=(
        *("rows.csv", "members.csv", "tried.csv", "thresholds.csv", "answers.csv"),
        *("table.csv", "maps/*.svg"),
    ),
    temporary=("rows.csv",),
)
ENSEMBLE = ResultKind(
    name="ensemble",
    article="an",
    subject="ensemble",
    mark="ensemble.json",
    results="points.csv, draws.csv",
    own=(
        *("points.csv", "draws.csv", "motions.csv", "spectra.csv", "base.toml", "ensemble.toml"),
        *("state.npz", "figures/*.svg"),
    ),
)
RESPONSE = ResultKind(
    name="response curve",
    subject="response curve",
    mark="response.json",
    results="response.csv",
    own=(
        *("response.csv", "starts.csv", "shell.csv", "sections.csv"),
        *("case.toml", "state.npz", "figures/*.svg"),
    ),
    temporary=("state.npz",),
)
SITE = ResultKind(
    name="verification at a site",
    subject="site",
    mark="assess.json",
    results="assess.json",
    own=(
        *PAGES,
        *("runs.csv", "site.toml", "container.toml", "motions/*.csv", "motions/*.at2"),
    ),
)
SIZE = ResultKind(
    name="size study",
    subject="size",
    mark="size.json",
    results="size.json",
    own=("runs.csv", "site.toml", "container.toml", "figures/size.svg"),
)
HALL = ResultKind(
    name="hall",
    subject="hall",
    mark="hall.json",
    results="hall.csv",
    own=(
        *PAGES,
        *("hall.csv", "runs.csv", "checks.csv", "list.csv", "base.toml", "figures/*.svg"),
    ),
)
PAPER = ResultKind(
    name="study",
    subject="study",
    mark="study.json",
    request="study",
    results="study.json",
    own=("study.html", "figures/*.svg"),
)
VERIFICATION = ResultKind(
    name="verification",
    article="the",
    subject="verification",
    mark="verify.json",
    request="status",
    results="verify.json",
    own=(),
)
AGAIN = "compute it again with --force"
KINDS = (RUN, SWEEP, ENSEMBLE, RESPONSE, SITE, SIZE, HALL, PAPER, VERIFICATION)


def read_result(path: Path, kind: ResultKind = RUN) -> dict[str, Any]:
    """The content of a marking file, `run.json` by default.

    Raises:
        FolderError: there is none, or it is damaged.
    """
    try:
        result = read_json(path)
    except OSError as error:
        raise FolderError(
            f"{path}: cannot be read ({error.strerror}); is this the folder of {kind.article} {kind.name}?"
        ) from None
    except ValueError as error:
        result, why = None, str(error)
    else:
        why = f"{kind.request} is no text"
    if not isinstance(result, dict) or not isinstance(result.get(kind.request), str):
        raise FolderError(
            f"{path}: damaged, or not the result of {kind.article} {kind.name} ({why}); {AGAIN}"
        )
    return result


def typed_result(result: type[BlockT], content: Mapping[str, Any], path: Path) -> BlockT:
    """The content of a marking file as a type; FolderError where it is damaged."""
    try:
        return result.from_json(content)
    except ValueError as error:
        raise FolderError(f"{path}: damaged, {error}; {AGAIN}") from None
