"""What a notebook opens (`fem.open_run`): a run in a folder, with its figures, or the table of a study."""

import csv
import importlib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.results import kinds, reader
from fem.results.errors import FolderError
from fem.runtime.user_files import read_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FIRST_ROWS = 10  #: shown in a notebook


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PlottedRun(reader.OpenedRun):
    """The folder of a run, which also draws its figures: a layer above the files."""

    def plot(self, name: str = "rotation", ax: "Axes | None" = None) -> "Figure":
        """A figure of the run, see `plotted`: `run.plot("slip").savefig("slip.png")`."""
        return plotted(self, name, ax)


#: the studies that have a table, and the key of their marking file that holds it, where it is no file
STUDIES = {
    kinds.SWEEP: "",
    kinds.ENSEMBLE: "points",
    kinds.HALL: "table",
    kinds.RESPONSE: "",
    kinds.SITE: "runs",
}


class StudyTable(dict[str, np.ndarray]):
    """The table of a study: name of a column -> its values, shape (n_rows,); a number that is missing is nan.

    Cells of a sweep, points of an ensemble, rows of a list, steps of a response curve, runs of a site.
    """

    def __init__(self, result: Mapping[str, Any], rows: Iterable[Mapping[str, Any]]) -> None:
        rows = list(rows)
        names = dict.fromkeys(name for row in rows for name in row)
        super().__init__({name: _column([row.get(name) for row in rows]) for name in names})
        self.result = result  #: all that the marking file holds
        self.answer = str(result.get("answer") or "no answer yet")  #: in one sentence

    def to_dataframe(self) -> Any:
        """The table as a `pandas.DataFrame`; ImportError, in words, where pandas is not installed."""
        try:
            return importlib.import_module("pandas").DataFrame(self)
        except ImportError:
            raise ImportError("to_dataframe needs pandas: python -m pip install pandas") from None

    def __repr__(self) -> str:
        """One line, with what was found."""
        rows = len(next(iter(self.values()), ()))
        return f"<study: {rows} rows of {', '.join(self)}; {self.answer}>"

    def _repr_html_(self) -> str:
        """The answer and the first rows, for a notebook."""
        head = "".join(f"<th>{escape(name)}</th>" for name in self)
        rows = zip(*(column[:FIRST_ROWS] for column in self.values()), strict=True)
        body = "".join(f"<tr>{''.join(f'<td>{escape(str(cell))}</td>' for cell in row)}</tr>" for row in rows)
        return f"<p>{escape(self.answer)}</p><table>{head}{body}</table>"


def _column(cells: list[Any]) -> np.ndarray:
    """Numbers where all are, else texts."""
    with suppress(ValueError, TypeError):
        return np.array([np.nan if cell in (None, "") else float(cell) for cell in cells])
    return np.array(["" if cell is None else str(cell) for cell in cells])


def open_run(folder: str | Path) -> PlottedRun | StudyTable:
    """Open the folder of a run, or of a study as its table.

    Args:
        folder: that holds `run.json`, or the path of `run.json` itself; `~` is the home folder. Of a sweep, an
            ensemble, a list, a response curve or a site likewise.

    Raises:
        FolderError: it holds no result, or one that is damaged.
    """
    place = Path(folder).expanduser()
    for kind, key in STUDIES.items():
        mark = place if place.name == kind.mark else place / kind.mark
        if mark.exists():
            result = kinds.read_result(mark, kind)
            try:
                text = "" if key else read_text(mark.parent / kind.results)
                return StudyTable(result, result[key] if key else csv.DictReader(text.splitlines()))
            except (AttributeError, LookupError, OSError, TypeError, ValueError, csv.Error) as error:
                raise FolderError(f"{mark}: damaged, it has no table ({error})") from None
    run = reader.open_run(folder)
    return PlottedRun(place=run.place, result=run.result)


def plotted(run: reader.RunData, name: str, ax: "Axes | None" = None) -> "Figure":
    """A figure of a run as matplotlib draws it on a report's page; a notebook shows what is returned.

    Args:
        run: in a folder or in memory.
        name: rotation, slip, uplift, base_motion, forces, energy, phase_portrait; where the run has such data:
            spectrum, joints, rigid_check, band.
        ax: draw rotation, slip or uplift into these axes, beside what they hold.

    Raises:
        ValueError: this run has no such figure, or it cannot be drawn into `ax`; with those that can.
    """
    # Importing matplotlib takes most of a second.
    figures = importlib.import_module("fem.figures.run")
    figure: Figure = figures.figure_of(run, name) if ax is None else figures.draw_curve(run, name, ax)
    return figure
