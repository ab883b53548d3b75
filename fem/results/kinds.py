"""The kinds of results that have a folder: the file that marks each, and the files that each may replace."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ResultKind:
    """A kind of result."""

    name: str
    article: str = "a"
    asked: str  #: what two requests differ in, such as "case"
    mark: str  #: name of the JSON file that marks the folder
    request: str  #: its key that holds the hash of what was asked
    results: str  #: where to look for the numbers
    #: patterns of the files that are removed before a new result is computed; nothing else ever is
    own: tuple[str, ...]
    finished: frozenset[str] = frozenset(
        {"completed"}
    )  #: statuses after which there is nothing left to compute


RUN = ResultKind(
    name="run",
    asked="case",
    mark="run.json",
    request="case_hash",
    results="history.csv",
    own=(
        "checkpoint.npz",
        "band.json",
        "members/member_*.npz",
        "summary.txt",
        "history.csv",
        "rigid_check.csv",
        "report.html",
        "variations.json",
        "fields/run.pvd",
        "fields/frame_*.vtu",
        "figures/*.svg",
        "figures/drawn.json",
        "figures/picture_*.png",
        "figures/movie.gif",
        "figures/movie.mp4",
    ),
    finished=frozenset({"completed", "overturned"}),
)
SWEEP = ResultKind(
    name="sweep",
    asked="sweep",
    mark="sweep.json",
    request="sweep_hash",
    results="table.csv",
    own=("rows.csv", "members.csv", "tried.csv", "thresholds.csv", "table.csv", "maps/*.svg"),
)
ENSEMBLE = ResultKind(
    name="ensemble",
    article="an",
    asked="ensemble",
    mark="ensemble.json",
    request="asked",
    results="points.csv, draws.csv",
    own=("points.csv", "draws.csv", "base.toml", "ensemble.toml", "state.npz", "figures/*.svg"),
)
RESPONSE = ResultKind(
    name="response curve",
    asked="response curve",
    mark="response.json",
    request="asked",
    results="response.csv",
    own=("response.csv", "sections.csv", "portraits.csv", "case.toml", "state.npz", "figures/*.svg"),
)
PAPER = ResultKind(
    name="study",
    asked="study",
    mark="study.json",
    request="study",
    results="study.json",
    own=("study.html", "figures/*.svg"),
)
KINDS = (RUN, SWEEP, ENSEMBLE, RESPONSE, PAPER)
#: statuses that `run.json` may have
RUN_STATUSES = RUN.finished | {"failed", "interrupted", "running"}
