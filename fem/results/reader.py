"""A run opened for reading: its result, case, history and fields, for a notebook, a figure or a report.

Only what is asked for is read: `run.json` at once, the case and the history on first use, a frame of the fields each
time. An unfinished run opens as well, with the files it has. SI units; x to the right, z up, rotation > 0 toward +x.
"""

from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fem.case.case import Case, load_case
from fem.results.errors import FolderError
from fem.results.fields import FieldError, Fields, Frame, open_fields, pyvista_grid
from fem.results.history import History, read_history
from fem.results.kinds import KINDS, RUN, read_result, typed_result
from fem.results.run_files import RunFiles
from fem.results.run_result import RunResult, Verdict
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import read_text

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


class RunData(Protocol):
    """A run in a folder or in memory: what figures show, and what a notebook asks of either."""

    if TYPE_CHECKING:  # a property here would be in the way of a field of the same name

        @property
        def name(self) -> str: ...
        @property
        def status(self) -> str: ...
        @property
        def case(self) -> Case: ...
        @property
        def typed_result(self) -> RunResult: ...
        @property
        def history(self) -> History: ...
        @property
        def slenderness_angle(self) -> float: ...
        @property
        def rigid_check(self) -> dict[str, FloatArray] | None: ...
        def frame(self, time: float) -> Frame: ...

    @property
    def verdict(self) -> Verdict:
        """Outcome, extremes and events: `run.verdict.sure`, or by its key in the file, `run.verdict["sure"]`."""
        return self.typed_result.verdict or Verdict()

    def _repr_html_(self) -> str:
        """Its line, and the card of the verdict."""
        return f"<p>{escape(repr(self))}</p><p>{self.verdict._repr_html_()}</p>"

    def grid(self, time: float) -> "UnstructuredGrid":
        """The frame nearest to a time [s] as a pyvista grid in the x-y plane, where the container stood.

        `run.grid(1.5).warp_by_vector("displacement_m").plot(scalars="von_mises_Pa", cpos="xy")`; errors as `frame`.
        """
        return pyvista_grid(self.frame(time))


@dataclass(frozen=True, kw_only=True, eq=False)
class OpenedRun(RunData):
    """The folder of a run, read when it is asked for.

    Every property raises FolderError, with the file and the way out, if that file is missing or damaged.
    """

    place: RunFiles
    result: dict[str, Any]  #: as in `run.json`

    def __repr__(self) -> str:
        """One line, for a notebook."""
        suffix = f", {self.verdict.outcome}" if self.verdict.outcome else ""
        return f"<run {self.name!r} in {str(self.folder)!r}: {self.status}{suffix}>"

    @property
    def folder(self) -> Path:
        """Its path."""
        return self.place.path

    @property
    def name(self) -> str:
        """Name of the case."""
        return str(self.result.get("case") or self.folder.name)

    @property
    def status(self) -> str:
        """Status of the run: completed | overturned | failed | interrupted | running."""
        return str(self.result.get("status"))

    @cached_property
    def typed_result(self) -> RunResult:
        """The result as typed data; what the run has not reached is None."""
        return typed_result(RunResult, self.result, self.place.result)

    @property
    def slenderness_angle(self) -> float:
        """Slenderness angle: beyond it the container falls if left alone [rad]."""
        try:
            return float(self.result["static"]["slenderness_angle_rad"])
        except (KeyError, TypeError, ValueError):
            raise FolderError(f"{self.place.result}: has no static block; run the case again") from None

    @cached_property
    def case(self) -> Case:
        """The case with every default and "auto" replaced."""
        if not self.place.resolved.is_file():
            raise FolderError(f"{self.place.resolved}: missing; run the case again")
        try:
            return load_case(str(self.place.resolved))
        except ValueError as error:
            raise FolderError(f"{error}; run the case again") from None

    @cached_property
    def history(self) -> History:
        """Samples over time; `run.history["rotation_rad"]` is a column, `run.history.modes` the states."""
        try:
            return read_history(self.place.history)
        except (OSError, ValueError) as error:
            raise FolderError(_unreadable(self.place.history, error)) from None

    @cached_property
    def rigid_check(self) -> dict[str, FloatArray] | None:
        """The columns of `rigid_check.csv` by name, the analytic block's rotation among them; None without."""
        path = self.place.rigid_check
        if not path.exists():
            return None
        try:
            header, *lines = read_text(path).splitlines()
            names, rows = header.split(","), np.loadtxt(lines, delimiter=",", ndmin=2)
            return dict(zip(names, rows.T, strict=True))
        except (OSError, ValueError) as error:
            raise FolderError(_unreadable(path, error)) from None

    @cached_property
    def fields(self) -> Fields:
        """Frames over time: `run.fields.times`, `run.fields.frame(0)`, `run.fields.nearest(1.5)`."""
        path = self.place.fields
        if not (path / "run.pvd").exists():
            raise FolderError(
                f"{path}: no fields were written; run the case with output.fields_s > 0, into another folder"
            )
        try:
            fields = open_fields(path)
        except (OSError, ValueError) as error:
            raise FolderError(_unreadable(path, error)) from None
        if not len(fields):
            raise FolderError(f"{path}: no frame has been written yet")
        return fields

    def frame(self, time: float) -> Frame:
        """The frame nearest to a time [s].

        Raises:
            FolderError: there are no fields, or none of that time.
            FieldError: this frame is damaged.
        """
        try:
            index = self.fields.index_at(time)
        except FieldError as error:
            raise FolderError(f"{self.place.fields}: {error}") from None
        return self.fields.frame(index)


def open_run(folder: str | Path) -> OpenedRun:
    """Open the folder of a run.

    Args:
        folder: that holds `run.json`, or the path of `run.json` itself; `~` is the home folder.

    Raises:
        FolderError: it holds no run, or its `run.json` is damaged.
    """
    path = Path(folder).expanduser()
    path = path.parent if path.name == "run.json" else path
    if not path.is_dir():
        raise FolderError(f"{path}: no such folder; give the folder of a run, such as outputs/NAME")
    for kind in KINDS:
        if (path / kind.mark).exists() and not (path / RUN.mark).exists():
            if read_result(path / kind.mark, kind).get("status") in ("running", "interrupted"):
                raise FolderError(f"{path}: the {kind.name} is not finished; continue it with --resume")
            raise FolderError(
                f"{path}: the folder of {kind.article} {kind.name} (its results: {kind.results}); give that of a run, "
                "such as outputs/NAME"
            )
    place = RunFiles(path)
    return OpenedRun(place=place, result=read_result(place.result))


def _unreadable(path: Path, error: Exception) -> str:
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    reason = reason.removeprefix(f"{path}: ")
    return f"{path}: cannot be read ({reason}); run the case again with --force"
