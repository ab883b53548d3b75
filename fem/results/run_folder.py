"""The folder of one run: what lies in it, who may write into it, and how a file is replaced whole.

`run.json` is written first, with status "running", and marks the folder as a run's; the case files follow.
Every file that is replaced is written beside its place and renamed, so a reader, or the next run after a
kill, finds the old one or the new one and never half of one.
"""

import contextlib
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fem.case.case import Case
from fem.results.errors import FolderError, OutputError
from fem.results.errors import obstacle as what_is_in_the_way
from fem.results.errors import writing_into as naming_what_cannot_be_written
from fem.results.files import to_json, write_atomically
from fem.results.folder import read_result
from fem.results.lock import LOCK_NAME, OWNER_NAME

__all__ = [
    "FolderError",
    "OutputError",
    "naming_what_cannot_be_written",
    "read_result",
    "to_json",
    "what_is_in_the_way",
    "write_atomically",
]

#: Statuses after which there is nothing left to compute.
FINISHED = frozenset({"completed", "overturned"})
STATUSES = FINISHED | {"failed", "interrupted", "running"}

SETUP_NAME = ".setup"


@dataclass(frozen=True, kw_only=True)
class RunFolder:
    """Places of a run's files."""

    path: Path  #: of the folder itself
    finished: dict[str, Any] | None = None  #: result already there; None if there is something to compute

    @property
    def case(self) -> Path:
        """The case file as given."""
        return self.path / "case.toml"

    @property
    def resolved(self) -> Path:
        """The case with every default written out."""
        return self.path / "resolved.toml"

    @property
    def result(self) -> Path:
        """Status, verdict, static checks, energy, numerics."""
        return self.path / "run.json"

    @property
    def summary(self) -> Path:
        """The table of the end of the run."""
        return self.path / "summary.txt"

    @property
    def history(self) -> Path:
        """One row a sample."""
        return self.path / "history.csv"

    @property
    def rigid_check(self) -> Path:
        """The analytic block's rotation beside the run's."""
        return self.path / "rigid_check.csv"

    @property
    def fields(self) -> Path:
        """Folder of `run.pvd` and its frames."""
        return self.path / "fields"

    @property
    def checkpoint(self) -> Path:
        """State to go on from."""
        return self.path / "checkpoint.npz"

    @property
    def band(self) -> Path:
        """Finished members of a band that is not."""
        return self.path / "band.json"

    @property
    def members(self) -> Path:
        """Folder of the checkpoints of a band's members under way."""
        return self.path / "members"

    def member_checkpoint(self, number: int) -> Path:
        """State to go on from with a member of a band."""
        return self.members / f"member_{number}.npz"

    @property
    def setup(self) -> Path:
        """Folder of the parts of a set-up under way."""
        return self.path / SETUP_NAME

    def part(self, number: int) -> Path:
        """Parts of a set-up, those of one number together."""
        return self.setup / f"part_{number}.npz"

    @property
    def figures(self) -> Path:
        """Folder of the figures."""
        return self.path / "figures"

    @property
    def drawn(self) -> Path:
        """What the figures were drawn from."""
        return self.figures / "drawn.json"

    @property
    def report(self) -> Path:
        """The report, unless it was asked for elsewhere."""
        return self.path / "report.html"

    @property
    def variations(self) -> Path:
        """What a report found of the run under other assumptions."""
        return self.path / "variations.json"

    @property
    def own(self) -> tuple[Path, ...]:
        """Every file and folder that a run writes."""
        results = (self.result, self.summary, self.history, self.rigid_check, self.fields, self.figures)
        reports = (self.report, self.variations)
        unfinished = (self.checkpoint, self.band, self.members, self.setup)
        return (self.case, self.resolved, *results, *reports, *unfinished, self.path / LOCK_NAME)

    def write_result(self, result: Mapping[str, Any]) -> None:
        """Replace `run.json`; numbers that are not finite become null.

        Raises:
            ValueError: a status that is none of `STATUSES`.
            OSError: the file cannot be written.
        """
        if result.get("status") not in STATUSES:
            raise ValueError(f"unknown status {result.get('status')!r}; known: {', '.join(sorted(STATUSES))}")
        write_atomically(self.result, to_json(result))

    def remove_checkpoint(self) -> None:
        """Remove the checkpoint, and what a kill may have left of the next one."""
        self.checkpoint.unlink(missing_ok=True)
        self.checkpoint.with_name(f".{self.checkpoint.name}.part").unlink(missing_ok=True)

    def remove_band(self) -> None:
        """Remove what is kept of a band under way."""
        self.band.unlink(missing_ok=True)
        self.band.with_name(f".{self.band.name}.part").unlink(missing_ok=True)
        _remove_from(self.members, ("member_*.npz", ".*.part"))

    def remove_setup(self) -> None:
        """Remove what is kept of a set-up."""
        _remove_from(self.setup, ("part_*.npz", ".*.part"))

    def write_summary(self, text: str) -> None:
        """Replace `summary.txt`."""
        write_atomically(self.summary, text)


def open_run_folder(
    path: Path,
    *,
    case_text: str,
    resolved_text: str,
    case_hash: str,
    force: bool = False,
    resume: bool = False,
    inspect: Callable[[RunFolder], None] = lambda folder: None,
) -> RunFolder:
    """Make or reuse the folder of a run and mark it as running.

    A finished run of the same case is left untouched and returned as `finished`, unless `force`. An
    unfinished one of the same case is begun anew: its results are removed, or kept for `resume` if there is a
    checkpoint. Only files that a run makes are ever removed, also under `force`.

    Args:
        path: the folder.
        case_text, resolved_text, case_hash: of the case.
        force, resume: as on the command line.
        inspect: called with a folder that is to be gone on with, before anything in it is changed; may refuse.

    Raises:
        FolderError: the folder holds another case or something else (without `force`), is not a folder, or
            cannot be written. No folder is then left behind that was not there before.
    """
    found = _look_into(path, case_hash, force)
    if found is not None and found.get("status") in FINISHED and not force:
        return RunFolder(path=path, finished=found)
    folder = RunFolder(path=path)
    keep = resume and not force and found is not None and folder.checkpoint.exists()
    if keep:
        inspect(folder)
    return _prepare(folder, case_text, resolved_text, case_hash, keep=keep)


def finished_run(path: Path, *, case_hash: str, force: bool = False) -> dict[str, Any] | None:
    """The result of a finished run of this case in a folder, if there is one; nothing is written.

    Raises:
        FolderError: as `open_run_folder`.
    """
    found = None if force else _look_into(path, case_hash, force)
    return found if found is not None and found.get("status") in FINISHED else None


def _look_into(path: Path, case_hash: str, force: bool) -> dict[str, Any] | None:
    """The `run.json` already there, if it is one; refuses a folder that is not this case's unless forced."""
    remedy = "choose another folder with --out DIR, or overwrite it with --force"
    try:
        if not path.exists():
            return None
        if not path.is_dir():
            raise FolderError(f"{path} is a file, not a folder; choose another with --out DIR")
        names = _names_in(path)
    except OSError as error:
        raise FolderError(
            f"{path}: cannot be read ({error.strerror}); choose another folder with --out DIR"
        ) from None
    if "run.json" not in names:
        if names and not force:
            raise FolderError(f"{path} is not empty and holds no run; {remedy}")
        return None
    try:
        found = read_result(path / "run.json")
    except FolderError as error:
        if force:
            return None
        raise FolderError(f"{error}; {remedy}") from None
    if found["case_hash"] != case_hash and not force:
        raise FolderError(f"{path} holds the results of another case; {remedy}")
    return found


def _prepare(
    folder: RunFolder, case_text: str, resolved_text: str, case_hash: str, *, keep: bool
) -> RunFolder:
    made = _make(folder.path)
    was_empty = not _names_in(folder.path)
    try:
        # The mark first: whatever comes between, the folder is then known as this case's, and not finished.
        folder.write_result({"status": "running", "case_hash": case_hash})
        if not keep:
            _remove_results(folder)
        write_atomically(folder.case, case_text)
        write_atomically(folder.resolved, resolved_text)
    except OSError as error:
        for file in (folder.result, folder.case, folder.resolved):
            if was_empty:
                with contextlib.suppress(OSError):
                    file.unlink()
        for part in reversed(made):
            shutil.rmtree(part, ignore_errors=True)
        raise FolderError(
            f"{folder.path}: cannot be written ({error.strerror}); choose another folder with --out DIR"
        ) from None
    return folder


def _names_in(path: Path) -> list[str]:
    """What lies in a folder, without the lock, parts of a set-up, and what a kill may have left half written."""
    return [
        entry.name
        for entry in path.iterdir()
        if entry.name not in (LOCK_NAME, OWNER_NAME, SETUP_NAME)
        and not (entry.name.startswith(".") and entry.name.endswith(".part"))
    ]


def _make(path: Path) -> list[Path]:
    """Make a folder with its parents; returns those that were not there, outermost first."""
    missing = [place for place in (path, *path.parents) if not place.exists()][::-1]
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        for part in reversed(missing):
            with contextlib.suppress(OSError):
                part.rmdir()
        raise FolderError(
            f"{path}: cannot be made ({error.strerror}); choose another folder with --out DIR"
        ) from None
    return missing


def _remove_results(folder: RunFolder) -> None:
    """Remove what an earlier run left, and nothing else that may lie there."""
    folder.remove_checkpoint()
    folder.remove_band()
    for file in (folder.summary, folder.history, folder.rigid_check, folder.report, folder.variations):
        file.unlink(missing_ok=True)
    _remove_from(folder.fields, ("run.pvd", "frame_*.vtu", ".*.part"))
    _remove_from(folder.figures, ("*.svg", folder.drawn.name, "picture_*.png", "movie.gif", "movie.mp4"))


def _remove_from(place: Path, patterns: Sequence[str]) -> None:
    """Remove files of these names from a folder, and the folder if nothing else lies in it."""
    for pattern in patterns:
        for file in place.glob(pattern):
            file.unlink(missing_ok=True)
    with contextlib.suppress(OSError):  # absent, or something else lies in it
        place.rmdir()


def copy_data_files(case: Case, folder: Path) -> None:
    """Put mesh and motion files into the folder, under the names that the case gives them."""
    for path in case.data_files.values():
        target = folder / path.relative_to(case.folder)
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.resolve() != path.resolve():
            shutil.copyfile(path, target)
