"""Maps of the stack over frequency and peak acceleration, and which of their cells are sure.

Cells next to one that ends otherwise, or that stand beyond half of the slenderness angle, are perturbed as a sweep
perturbs them (`fem.sweep.perturbation`): amplitude 2 % less and more, both friction coefficients 0.02 less and
more, the phase a twentieth of a turn earlier and later, a contact damping ratio of 0.5. A cell is sure if all its
copies stand, or all fall, as it does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage

from fem.paper.cases import FOR_MAPS, STACK, harmonic
from fem.paper.claims import Setup
from fem.paper.experiments import Laboratory, Row
from fem.sweep.neighbours import OVERTURNED, STANDING, kind_of
from fem.sweep.perturbation import Perturbation

FREQUENCIES = tuple(float(f"{w:.4g}") for w in np.linspace(1.5, 12.0, 20))  #: [rad/s]
PEAKS = tuple(float(f"{a:.4g}") for a in np.geomspace(1.8, 12.0, 20))  #: [m/s2]
DURATION = 15.0  #: s
FALLEN = "overturned"
PERTURBATION = Perturbation(contact_damping_ratios=[0.5])


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One motion of a map."""

    angular_frequency: float  #: [rad/s]
    peak: float  #: [m/s2]
    setup: Setup
    row: Row
    sure: bool = True

    @property
    def amplitude(self) -> float:
        """A of the floor [m]."""
        return self.peak / self.angular_frequency**2

    @property
    def computed(self) -> bool:
        """Whether the run came to its end."""
        return bool(self.row["status"] != "failed")

    @property
    def fell(self) -> bool:
        """Whether it overturned."""
        return bool(self.row["outcome"] == FALLEN)

    @property
    def stood(self) -> bool:
        """Whether it came to its end and stands."""
        return self.computed and not self.fell

    @property
    def tilted(self) -> bool:
        """Whether a side of the base was unloaded at any time."""
        return self.row["first_uplift_s"] is not None


def stack_setup(
    peak: float, angular_frequency: float, values: Mapping[str, Any] | None = None, what: str = ""
) -> Setup:
    """The stack under a harmonic floor, rigid unless `values` say otherwise."""
    return STACK.but(
        {
            **FOR_MAPS,
            "solver.duration_s": DURATION,
            **harmonic(peak, angular_frequency),
            **(values or {}),
        },
        what or f"stack, {peak:g} m/s² at {angular_frequency:g} rad/s",
    )


def stack_map(
    laboratory: Laboratory,
    values: Mapping[str, Any] | None = None,
    *,
    frequencies: Sequence[float] = FREQUENCIES,
    peaks: Sequence[float] = PEAKS,
    perturbed: bool = False,
) -> list[Cell]:
    """The cells of a map, row by row of rising peak.

    Args:
        values: keys changed in all cells.
        frequencies: [rad/s]; peaks: [m/s2].
        perturbed: find out which cells are sure.
    """
    places = [(peak, frequency) for peak in peaks for frequency in frequencies]
    setups = [stack_setup(peak, frequency, values) for peak, frequency in places]
    rows = laboratory.attempts(setups)
    sure = [True] * len(setups)
    if perturbed:
        sure = mark_sure(laboratory, setups, rows, len(frequencies))
    return [
        Cell(angular_frequency=frequency, peak=peak, setup=setup, row=row, sure=certain)
        for (peak, frequency), setup, row, certain in zip(places, setups, rows, sure, strict=True)
    ]


def mark_sure(laboratory: Laboratory, setups: Sequence[Setup], rows: Sequence[Row], width: int) -> list[bool]:
    """Which cells of a map, `width` to a row, are sure; only those near a change are perturbed."""
    near = near_change(rows, width)
    doubtful = [setup for setup, asked in zip(setups, near, strict=True) if asked]
    found = iter(sure_ones(laboratory, doubtful))
    return [next(found) if asked else True for asked in near]


def sure_ones(laboratory: Laboratory, setups: Sequence[Setup]) -> list[bool]:
    """For each setup, whether all its perturbed copies stand, or all fall, as it does; never where one failed."""
    copies = [perturbations(setup) for setup in setups]
    laboratory.attempts([copy for group in copies for copy in group])  # all in one batch
    found = []
    for setup, group in zip(setups, copies, strict=True):
        rows = laboratory.attempts([setup, *group])
        kinds = {kind_of(row["status"], row["outcome"]) for row in rows}
        found.append(kinds in ({STANDING}, {OVERTURNED}))
    return found


def near_change(rows: Sequence[Row], width: int) -> list[bool]:
    """Which cells of a map, `width` to a row, are to be perturbed."""
    kind = np.array([kind_of(row["status"], row["outcome"]) for row in rows]).reshape(-1, width)
    ratio = np.array([row["rotation_ratio"] or 0.0 for row in rows]).reshape(-1, width)
    highest = ndimage.maximum_filter(kind, size=3, mode="nearest")
    lowest = ndimage.minimum_filter(kind, size=3, mode="nearest")
    near = (highest != lowest) | ((kind == STANDING) & (ratio >= PERTURBATION.close))
    return [bool(one) for one in near.ravel()]


def perturbations(setup: Setup) -> list[Setup]:
    """The copies of a setup under slightly other conditions."""
    return [setup.but(change) for change in PERTURBATION.members(setup.case)]


def grid(cells: Sequence[Cell], width: int = len(FREQUENCIES)) -> list[list[Cell]]:
    """Cells of a map, `width` to a row, as rows."""
    return [list(cells[first : first + width]) for first in range(0, len(cells), width)]


def outcomes(cells: Sequence[Cell], width: int = len(FREQUENCIES)) -> list[list[str]]:
    """Outcome of each cell, "failed" where there is none."""
    return [[cell.row["outcome"] or "failed" for cell in row] for row in grid(cells, width)]


def doubts(cells: Sequence[Cell], width: int = len(FREQUENCIES)) -> list[list[bool]]:
    """Which cells are not sure."""
    return [[not cell.sure for cell in row] for row in grid(cells, width)]
