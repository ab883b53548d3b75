"""The folder of a sweep: what lies in it, and who may write into it.

`sweep.json` is written first, with status "running"; `sweep.toml` (as given) and `base.toml` (the base case, with what
[set] changes) follow. `sweep_hash` tells whether rows belong to the sweep at hand, `band_hash` whether what was
computed on top of them does.
"""

import contextlib
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fem.case.case import case_hash
from fem.case.toml import toml_document
from fem.results.lock import LOCK_NAME
from fem.results.run_folder import FolderError, to_json, write_atomically
from fem.runtime.identity import program_identity, versions
from fem.sweep.plan import Sweep
from fem.sweep.size import check_disk
from fem.sweep.table import read_info

REMEDY = "choose another folder with --out DIR, or overwrite it with --force"


@dataclass(frozen=True, kw_only=True)
class SweepFolder:
    """Places of a sweep's files."""

    path: Path
    finished: bool = False  #: nothing is left to compute
    same_band: bool = False  #: the members there belong to this sweep

    @property
    def info(self) -> Path:
        """Status, what was asked, counts of outcomes, versions."""
        return self.path / "sweep.json"

    @property
    def rows(self) -> Path:
        """Rows as they come, while the sweep is not finished."""
        return self.path / "rows.csv"

    @property
    def members(self) -> Path:
        """One row a perturbed copy of a cell."""
        return self.path / "members.csv"

    @property
    def tried(self) -> Path:
        """One row a case between the cells that a threshold tried."""
        return self.path / "tried.csv"

    @property
    def thresholds(self) -> Path:
        """One row a change of outcome along an axis."""
        return self.path / "thresholds.csv"

    @property
    def table(self) -> Path:
        """One row a cell."""
        return self.path / "table.csv"

    @property
    def maps(self) -> Path:
        """Folder of the maps."""
        return self.path / "maps"

    def remove_results(self) -> None:
        """Remove what an earlier sweep left, and nothing else that may lie there."""
        for file in (self.rows, self.members, self.tried, self.thresholds, self.table):
            file.unlink(missing_ok=True)
        for file in self.maps.glob("*.svg"):
            file.unlink(missing_ok=True)
        with contextlib.suppress(OSError):  # absent, or something else lies in it
            self.maps.rmdir()


def sweep_hash(sweep: Sweep) -> str:
    """Equal for sweeps whose rows are the same."""
    digest = hashlib.sha256(case_hash(sweep.base).encode())
    given = {key: value for key, value in sweep.base.given().items() if key != "title"}
    digest.update(toml_document(given).encode())
    digest.update(repr([(axis.key, axis.values) for axis in sweep.axes]).encode())
    digest.update(repr([(one.key, one.expression.tree) for one in sweep.derived]).encode())
    return digest.hexdigest()


def band_hash(sweep: Sweep) -> str:
    """Equal for sweeps that are perturbed and refined in the same way."""
    return hashlib.sha256(repr((sweep.perturbation, sweep.threshold)).encode()).hexdigest()


def open_sweep_folder(path: Path, sweep: Sweep, *, force: bool, resume: bool) -> SweepFolder:
    """Look at the folder of a sweep, or make it.

    A finished sweep is left alone; rows of an unfinished one are kept for `resume`, and otherwise refused, since
    they may have taken hours; `force` begins anew. Other settings of the band are no other sweep: its rows are kept.

    Raises:
        FolderError: the folder holds another sweep or something else, an unfinished one (without `resume` or `force`),
            is not a folder, cannot be written, or has no room for what will be.
    """
    folder = SweepFolder(path=path)
    try:
        if path.exists() and not path.is_dir():
            raise FolderError(f"{path} is a file, not a folder; choose another with --out DIR")
        path.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in path.iterdir() if not entry.name.endswith(".part")} - {LOCK_NAME}
        if force:
            check_disk(sweep, path)
            folder.remove_results()
            return folder
        if not names:
            check_disk(sweep, path)
            return folder
        if folder.info.name not in names:
            raise FolderError(f"{path} is not empty and holds no sweep; {REMEDY}")
        found = _info_of(folder)
        if found["sweep_hash"] != sweep_hash(sweep):
            raise FolderError(f"{path} holds the results of another sweep; {REMEDY}")
        same_band = found.get("band_hash") == band_hash(sweep)
        if found.get("status") == "completed" and folder.table.is_file():
            if same_band:
                return SweepFolder(path=path, finished=True, same_band=True)
        elif not resume and (count := _rows_in(folder.rows)) > 0:
            raise FolderError(
                f"{path} holds this sweep, unfinished, with {count} of {sweep.count} rows; --resume goes on with "
                "it, --force begins anew"
            )
        if found.get("program") != program_identity()["sources"]:
            raise FolderError(f"{path} holds rows of another version of the program; {REMEDY}")
        if (other := _other_library(found.get("versions"))) is not None:
            raise FolderError(f"{path} holds rows computed with another {other}; {REMEDY}")
        check_disk(sweep, path)
    except OSError as error:
        raise FolderError(
            f"{path}: cannot be used ({error.strerror}); choose another folder with --out DIR"
        ) from None
    return SweepFolder(path=path, same_band=same_band)


def _other_library(recorded: Any) -> str | None:
    """A library on which numbers depend, of another version than here."""
    theirs = recorded if isinstance(recorded, dict) else {}
    for name, mine in versions().items():
        if theirs.get(name) != mine:
            return f"version of {name} ({theirs.get(name)}, here {mine})"
    return None


def write_plan(folder: SweepFolder, sweep: Sweep, info: Mapping[str, Any]) -> None:
    """Write what was asked: `sweep.json` before all else."""
    write_info(folder, info)
    write_atomically(folder.path / "sweep.toml", sweep.text)
    write_atomically(folder.path / "base.toml", toml_document(sweep.base.given()))


def write_info(folder: SweepFolder, info: Mapping[str, Any]) -> None:
    """Replace `sweep.json`."""
    write_atomically(folder.info, to_json(info))


def _rows_in(log: Path) -> int:
    """Whole lines behind the header."""
    return max(log.read_bytes().count(b"\n") - 1, 0) if log.is_file() else 0


def _info_of(folder: SweepFolder) -> dict[str, Any]:
    try:
        return read_info(folder.path)
    except FolderError as error:
        raise FolderError(f"{error}; {REMEDY}") from None
