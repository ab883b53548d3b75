"""The maps on which criteria are counted: the stack over frequency and peak, a container over slenderness and friction.

Rigid, and coarser for the shell. Counts are of the cells of these maps, and say nothing of how often such motions
occur.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np

from fem.paper.cases import ANGULAR_FREQUENCY, BOX_WEIGHT, FREQUENCY_PARAMETER, HEIGHT, PLATEAU_PEAK, WIDTH
from fem.paper.criteria import Contingency, Motion, contingency
from fem.paper.experiments import Laboratory
from fem.paper.maps import FREQUENCIES, PEAKS, Cell, mark_sure, stack_map, stack_setup

SLENDERNESS = tuple(float(f"{one:.4g}") for one in np.linspace(1.5, 6.0, 19))  #: c/a
FRICTION = tuple(float(f"{one:.4g}") for one in np.linspace(0.1, 0.8, 15))  #: mu_s; mu_k is half of it
FAST = 3.0 * FREQUENCY_PARAMETER  #: of a floor, against the stack [rad/s]
SHAPE_FREQUENCIES = (2.5, 4.0, ANGULAR_FREQUENCY)  #: [rad/s]
#: what of the grids is computed with the shell, and how
SHELL_FREQUENCIES, SHELL_PEAKS = FREQUENCIES[::2], PEAKS[1::2]
SHELL_SLENDERNESS, SHELL_FRICTION = SLENDERNESS[1::2], FRICTION[1::2]
SHELL = {"solver.model": "reduced", "solver.duration_s": 10.0}


@dataclass(frozen=True, kw_only=True)
class Counted:
    """A map with what the criteria need to know of each cell."""

    title: str
    rigid: bool
    fast: bool  #: whether it holds motions faster than FAST
    columns: int  #: cells to a row
    cells: list[Cell]
    motions: list[Motion]

    def against(self, criterion: Callable[[Motion], bool], *, sure: bool | None = None) -> Contingency:
        """The criterion against all computed cells, or the sure or the unsure ones."""
        chosen = [
            (cell, motion)
            for cell, motion in zip(self.cells, self.motions, strict=True)
            if cell.computed and (sure is None or cell.sure is sure)
        ]
        return contingency([criterion(motion) for _, motion in chosen], [cell.fell for cell, _ in chosen])

    def standing_of_said(self, criterion: Callable[[Motion], bool], frequencies: Collection[float]) -> float:
        """Of the cells at these frequencies that a criterion turns over, the share that stands; nan without any."""
        said = [
            cell
            for cell, motion in zip(self.cells, self.motions, strict=True)
            if cell.computed and cell.angular_frequency in frequencies and criterion(motion)
        ]
        return sum(cell.stood for cell in said) / len(said) if said else np.nan


def stack_counted(laboratory: Laboratory, *, rigid: bool = True) -> Counted:
    """Frequency and peak acceleration, mu 0.4/0.2; the shell on a coarser grid."""
    frequencies, peaks = (FREQUENCIES, PEAKS) if rigid else (SHELL_FREQUENCIES, SHELL_PEAKS)
    cells = stack_map(
        laboratory, {} if rigid else SHELL, frequencies=frequencies, peaks=peaks, perturbed=True
    )
    motions = [
        Motion(
            peak=cell.peak,
            amplitude=cell.amplitude,
            slenderness=HEIGHT / WIDTH,
            mu_static=0.4,
            mu_kinetic=0.2,
        )
        for cell in cells
    ]
    title = f"{'rigid' if rigid else 'shell'} stack, frequency x peak"
    return Counted(
        title=title, rigid=rigid, fast=True, columns=len(frequencies), cells=cells, motions=motions
    )


def shapes_counted(laboratory: Laboratory, *, rigid: bool = True) -> list[Counted]:
    """Slenderness and friction under the plateau value, at the paper's frequency and two lower ones."""
    frictions, shapes = (FRICTION, SLENDERNESS) if rigid else (SHELL_FRICTION, SHELL_SLENDERNESS)
    places = [(mu, slenderness) for mu in frictions for slenderness in shapes]
    found = []
    for frequency in SHAPE_FREQUENCIES:
        setups = [
            stack_setup(
                PLATEAU_PEAK,
                frequency,
                {
                    **({} if rigid else SHELL),
                    "container.boxes": 1,
                    "container.height_m": round(slenderness * WIDTH, 4),
                    "container.centroid_m": round(0.5 * slenderness * WIDTH, 4),
                    "container.weight_N": round(BOX_WEIGHT * slenderness * WIDTH, 1),
                    "contact.mu_static": mu,
                    "contact.mu_kinetic": round(0.5 * mu, 4),
                },
                f"{'rigid' if rigid else 'shell'}, c/a = {slenderness:g}, mu_s = {mu:g}, {frequency:g} rad/s",
            )
            for mu, slenderness in places
        ]
        rows = laboratory.attempts(setups)
        sure = mark_sure(laboratory, setups, rows, len(shapes))
        cells = [
            Cell(angular_frequency=frequency, peak=PLATEAU_PEAK, setup=setup, row=row, sure=certain)
            for setup, row, certain in zip(setups, rows, sure, strict=True)
        ]
        motions = [
            Motion(
                peak=PLATEAU_PEAK,
                amplitude=PLATEAU_PEAK / frequency**2,
                slenderness=slenderness,
                mu_static=mu,
                mu_kinetic=0.5 * mu,
            )
            for mu, slenderness in places
        ]
        title = f"{'rigid' if rigid else 'shell'}, c/a x mu_s, {PLATEAU_PEAK:.1f} m/s² at {frequency:g} rad/s"
        found.append(
            Counted(
                title=title,
                rigid=rigid,
                fast=frequency > FAST,
                columns=len(shapes),
                cells=cells,
                motions=motions,
            )
        )
    return found


def counted_maps(laboratory: Laboratory) -> list[Counted]:
    """All of them: the rigid ones first, of these the stack's first."""
    return [
        one
        for rigid in (True, False)
        for one in (stack_counted(laboratory, rigid=rigid), *shapes_counted(laboratory, rigid=rigid))
    ]


def same_places(one: Counted, other: Counted) -> list[tuple[Cell, Cell]]:
    """Cells of two maps under the same motion and of the same shape and friction, both computed."""
    known = dict(zip(one.motions, one.cells, strict=True))
    pairs = [(known[motion], cell) for motion, cell in zip(other.motions, other.cells, strict=True)]
    return [(first, second) for first, second in pairs if first.computed and second.computed]
