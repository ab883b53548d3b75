"""Figures of a run for a notebook, where it is in a folder (`fem.open_run`) or in memory."""

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fem.results import reader

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PlottedRun(reader.OpenedRun):
    """The folder of a run, which also draws its figures: a layer above the files."""

    def plot(self, name: str = "rotation", ax: "Axes | None" = None) -> "Figure":
        """A figure of the run, see `plotted`: `run.plot("slip").savefig("slip.png")`."""
        return plotted(self, name, ax)


def open_run(folder: str | Path) -> PlottedRun:
    """Open the folder of a run.

    Args:
        folder: that holds `run.json`, or the path of `run.json` itself; `~` is the home folder.

    Raises:
        FolderError: it holds no run, or its `run.json` is damaged.
    """
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
