"""Outcome maps: the stack over frequency and peak acceleration, a container over slenderness and friction.

The container is rigid, or a shell on a coarser grid. Counts are of the cells of these maps, and say nothing of how
often such motions occur.

Cells next to one that ends otherwise, or that stand beyond half of the slenderness angle, are perturbed as in a sweep
(`Perturbation`): amplitude 2 % less and more, both friction coefficients 0.02 less and more, the phase a twentieth of a
turn earlier and later, a contact damping ratio of 0.5. A cell is sure if all its copies stand, or all overturn, as it
does.
"""

import itertools
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from evidence.pages import Picture
from paper.cases import FOR_MAPS, SHELL, STACK, PaperCase, friction
from paper.criteria import Contingency, Criterion, MapMotion, contingency, motion_of
from paper.dimensions import ANGULAR_FREQUENCY, BOX_WEIGHT, FREQUENCY_PARAMETER, PAPER_MU, PLATEAU_PEAK, WIDTH
from paper.experiments import Experiments, stands

from fem.figures.heat_map import MapAxis, MapCurve, Panel, draw_heat_map
from fem.figures.style import svg_of
from fem.results.outcome import Ending, ending_of
from fem.runtime.arrays import BoolArray
from fem.study.axes import Axis
from fem.study.design import Perturbation
from fem.study.maps import OUTCOME_COLOURS
from fem.study.runner import Row
from fem.study.sure import near_cells

FREQUENCIES = tuple(float(f"{w:.4g}") for w in np.linspace(1.5, 12.0, 20))  #: [rad/s]
PEAKS = tuple(float(f"{a:.4g}") for a in np.geomspace(1.8, 12.0, 20))  #: [m/s2]
SLENDERNESS = tuple(float(f"{ratio:.4g}") for ratio in np.linspace(1.5, 6.0, 19))  #: c/a
FRICTION = tuple(float(f"{mu:.4g}") for mu in np.linspace(0.1, 0.8, 15))  #: mu_s; mu_k is half of it
FREQUENCY = MapAxis(label="angular frequency [rad/s]", values=FREQUENCIES, scale="linear")
PEAK = MapAxis(label="peak floor acceleration [m/s²]", values=PEAKS, scale="log")
SHAPE = MapAxis(label="slenderness c/a [-]", values=SLENDERNESS, scale="linear")
STICTION = MapAxis(label="static friction mu_s [-]", values=FRICTION, scale="linear")
SHAPE_FREQUENCIES = (2.5, 4.0, ANGULAR_FREQUENCY)  #: [rad/s]
FAST = 3.0 * FREQUENCY_PARAMETER  #: of a floor, against the stack [rad/s]
PERTURBATION = Perturbation(contact_damping_ratios=[0.5])


@dataclass(frozen=True, kw_only=True)
class MapCell:
    """One run of a map."""

    motion: MapMotion
    case: PaperCase
    row: Row = field(repr=False)
    sure: bool = True

    @property
    def computed(self) -> bool:
        """Whether the run did not fail."""
        return bool(self.row["status"] != "failed")

    @property
    def fell(self) -> bool:
        """Whether the container overturned."""
        return not stands(self.row)

    @property
    def stood(self) -> bool:
        """Whether the run did not fail and the container stands."""
        return self.computed and not self.fell

    @property
    def tilted(self) -> bool:
        """Whether a side of the base was unloaded at any time."""
        return self.row["first_uplift_s"] is not None


@dataclass(frozen=True, kw_only=True)
class OutcomeMap:
    """Cells over two axes, row by row of rising y."""

    title: str
    rigid: bool  #: or a shell
    x: MapAxis
    y: MapAxis
    every: Sequence[MapCell]  #: failed ones as well

    @property
    def cells(self) -> list[MapCell]:
        """The computed cells."""
        return [cell for cell in self.every if cell.computed]

    @property
    def rows(self) -> list[list[MapCell]]:
        """All cells, those of one y together."""
        width = len(self.x.values)
        return [list(self.every[first : first + width]) for first in range(0, len(self.every), width)]

    @property
    def fast(self) -> bool:
        """Whether it holds motions faster than FAST."""
        return any(cell.motion.angular_frequency > FAST for cell in self.every)

    def count(self, criterion: Criterion, *, sure: bool | None = None) -> Contingency:
        """The criterion against all computed cells, or the sure or the unsure ones."""
        chosen = [cell for cell in self.cells if sure is None or cell.sure is sure]
        return contingency([criterion(cell.motion) for cell in chosen], [cell.fell for cell in chosen])

    def standing_share(
        self, criterion: Criterion = lambda motion: True, frequencies: Collection[float] = ()
    ) -> float:
        """Of the computed cells that a criterion turns over, at some frequencies [rad/s], the share that stands."""
        stood = [
            cell.stood
            for cell in self.cells
            if criterion(cell.motion) and (not frequencies or cell.motion.angular_frequency in frequencies)
        ]
        return sum(stood) / len(stood) if stood else np.nan


def stack_map(
    experiments: Experiments,
    mu: tuple[float, float] = PAPER_MU,
    *,
    peaks: Sequence[float] = PEAKS,
    rigid: bool = True,
    perturbed: bool = True,
) -> OutcomeMap:
    """The stack over frequency and peak acceleration [m/s2]; rigid, or a shell at every second of either.

    `mu`: static and kinetic friction; `perturbed`: find out which cells are sure; all count as sure otherwise.
    """
    base = STACK.but(FOR_MAPS, friction(*mu), duration=15.0)

    def case_at(frequency: float, peak: float) -> PaperCase:
        return base.but(peak=peak, frequency=frequency, what=f"stack, {peak:g} m/s² at {frequency:g} rad/s")

    y = replace(PEAK, values=peaks)
    return _computed(experiments, case_at, "stack, frequency x peak", FREQUENCY, y, (0, 1), rigid, perturbed)


def shape_maps(experiments: Experiments, *, rigid: bool = True) -> list[OutcomeMap]:
    """One container over slenderness and friction under 4.0 m/s2, a map for each frequency.

    Rigid, or a shell at every second slenderness and friction.
    """

    def of_frequency(frequency: float) -> OutcomeMap:
        base = STACK.but(
            FOR_MAPS, {"container.boxes": 1}, duration=15.0, peak=PLATEAU_PEAK, frequency=frequency
        )

        def case_at(slenderness: float, mu: float) -> PaperCase:
            body = {
                "container.height_m": round(slenderness * WIDTH, 4),
                "container.centroid_m": round(0.5 * slenderness * WIDTH, 4),
                "container.weight_N": round(BOX_WEIGHT * slenderness * WIDTH, 1),
            }
            what = f"c/a = {slenderness:g}, mu_s = {mu:g}, {frequency:g} rad/s"
            return base.but(body, friction(mu, 0.5 * mu), what=what)

        title = f"container, c/a x mu_s, {PLATEAU_PEAK:.1f} m/s² at {frequency:g} rad/s"
        return _computed(experiments, case_at, title, SHAPE, STICTION, (1, 1), rigid)

    return [of_frequency(frequency) for frequency in SHAPE_FREQUENCIES]


def pairs(base: OutcomeMap, other: OutcomeMap) -> list[tuple[MapCell, MapCell]]:
    """Cells at the same place of two maps, both computed; every place of the other must be one of the first."""
    positions = itertools.product(other.y.values, other.x.values)
    x, y = list(base.x.values), list(base.y.values)
    both = [
        (base.rows[y.index(up)][x.index(across)], cell)
        for (up, across), cell in zip(positions, other.every, strict=True)
    ]
    return [(first, second) for first, second in both if first.computed and second.computed]


def near_change(rows: Sequence[Row], x: Sequence[float], y: Sequence[float]) -> BoolArray:
    """Which cells of a map over x and y are to be perturbed, (n_cells,)."""
    shape = (len(y), len(x))
    kind = np.array([ending_of(row["status"], row["outcome"]) for row in rows]).reshape(shape)
    ratio = np.array([row["rotation_ratio"] or 0.0 for row in rows]).reshape(shape)
    axes = [Axis(key="", values=tuple(values)) for values in (y, x)]
    return near_cells(axes, kind, ratio, PERTURBATION.close).ravel()


def _computed(
    experiments: Experiments,
    case_at: Callable[[float, float], PaperCase],
    title: str,
    x: MapAxis,
    y: MapAxis,
    first: tuple[int, int],
    rigid: bool,
    perturbed: bool = True,
) -> OutcomeMap:
    """Compute a map; with `perturbed`, perturb the cells near a change of outcome.

    That of a shell has every second value of either axis, from the given first ones on, and runs of 10 s.
    """
    if not rigid:
        x, y = (
            replace(axis, values=axis.values[start::2]) for axis, start in zip((x, y), first, strict=True)
        )
    cases = [case_at(across, up) for up in y.values for across in x.values]
    if not rigid:
        cases = [case.but(SHELL, duration=10.0, what=f"shell, {case.what}") for case in cases]
    rows = experiments.rows(cases, also_failed=True)
    sure = [True] * len(cases)
    if perturbed:
        near = np.flatnonzero(near_change(rows, x.values, y.values)).tolist()
        copies = {
            k: [cases[k].but(change.values) for change in PERTURBATION.changes(experiments.case(cases[k]))]
            for k in near
        }
        experiments.rows([copy for group in copies.values() for copy in group], also_failed=True)  # one batch
        for k, group in copies.items():
            group_rows = experiments.rows([cases[k], *group], also_failed=True)
            kinds = {ending_of(row["status"], row["outcome"]) for row in group_rows}
            sure[k] = kinds in ({Ending.STANDING}, {Ending.OVERTURNED})
    cells = [
        MapCell(motion=motion_of(case), case=case, row=row, sure=certain)
        for case, row, certain in zip(cases, rows, sure, strict=True)
    ]
    title = f"{'rigid' if rigid else 'shell'} {title}"
    return OutcomeMap(title=title, rigid=rigid, x=x, y=y, every=cells)


def draw_map(name: str, caption: str, outcome_map: OutcomeMap, curves: Sequence[MapCurve]) -> Picture:
    """Outcome of every cell by colour, unsure cells hatched, curves on top."""
    words = list(OUTCOME_COLOURS)
    panel = Panel(
        values=np.array(
            [[words.index(cell.row["outcome"] or "failed") for cell in row] for row in outcome_map.rows]
        ),
        overturned=np.array([[cell.fell for cell in row] for row in outcome_map.rows]),
        unsure=np.array([[not cell.sure for cell in row] for row in outcome_map.rows]),
        curves=curves,
    )
    figure = draw_heat_map(outcome_map.x, outcome_map.y, [panel], colours=OUTCOME_COLOURS)
    return Picture(name=name, caption=caption, svg=svg_of(figure))
