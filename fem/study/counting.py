"""The paper's central claim, counted: static rule, the paper's own criteria and the run, cell by cell.

Each criterion says of a motion whether the container stands or overturns; the run says what happens. A criterion is
right, conservative (it says "overturns", the container stands) or unconservative (it says "stands", the container
overturns). Counts are of the cells of the maps that are drawn, and say nothing of how often such motions occur.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fem.study.drawings import Line, drawing, outcome_map
from fem.study.laboratory import Laboratory
from fem.study.maps import (
    FREQUENCIES,
    PEAKS,
    Cell,
    doubts,
    mark_sure,
    outcomes,
    stack_map,
    stack_setup,
)
from fem.study.setups import ANGULAR_FREQUENCY
from fem.study.statements import Comparison, Drawing, Finding, Setup, Statement, Table

GRAVITY, WIDTH = 9.81, 1.1
SLENDERNESS = tuple(float(f"{one:.4g}") for one in np.linspace(1.5, 6.0, 10))  #: c/a
FRICTION = tuple(float(f"{one:.4g}") for one in np.linspace(0.1, 0.8, 8))  #: mu_s; mu_k is half of it
FAST = 3.0 * 1.88  #: rad/s, three times p of the stack
SHELL_FREQUENCIES = FREQUENCIES[::2]
SHELL_PEAKS = PEAKS[1::2]


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What a criterion may know of a cell."""

    peak: float  #: [m/s2]
    amplitude: float  #: [m]
    slenderness: float  #: c/a
    mu_static: float
    mu_kinetic: float

    @property
    def tilts(self) -> bool:
        """M_T of Eq. (9) above M_R of Eq. (10)."""
        return self.peak > GRAVITY / self.slenderness

    @property
    def slides(self) -> bool:
        """Base shear above the limit of Eq. (8)."""
        return self.peak > self.mu_static * GRAVITY

    @property
    def slides_first(self) -> bool:
        """Stiction is lost below the acceleration of tilting."""
        return self.mu_static < 1.0 / self.slenderness


def static_rule(motion: Motion) -> bool:
    """Lateral force method under the run's own peak: it overturns as soon as M_T exceeds M_R."""
    return motion.tilts


def static_rule_or_sliding(motion: Motion) -> bool:
    """The strict quasi-static reading of section 1: loss of stiction is loss of bearing capacity as well."""
    return motion.tilts or motion.slides


def half_width(motion: Motion) -> bool:
    """Section 5.4: A > a/2 overturns, A <= a/2 does not."""
    return motion.amplitude > 0.5 * WIDTH


def paper_criteria(motion: Motion) -> bool:
    """Eqs. (8) to (13) with A > a/2: it tilts before it slides, or while it slides, and the amplitude suffices.

    Once it slides, the shear is mu_k G, and Eqs. (9) to (11) tilt it only if mu_k > a/c.
    """
    tilted = motion.tilts and (not motion.slides_first or motion.mu_kinetic > 1.0 / motion.slenderness)
    return tilted and half_width(motion)


CRITERIA: Mapping[str, Callable[[Motion], bool]] = {
    "static rule, own peak": static_rule,
    "static rule, tilting or sliding": static_rule_or_sliding,
    "A <= a/2": half_width,
    "the paper's, Eqs. 8 to 13 and A": paper_criteria,
}


@dataclass(frozen=True, kw_only=True)
class Contingency:
    """How often a criterion was right, over some cells."""

    cells: int
    right: int
    conservative: int
    unconservative: int

    @property
    def shares(self) -> tuple[float, float, float]:
        """Right, conservative, unconservative, over all cells."""
        total = max(self.cells, 1)
        return self.right / total, self.conservative / total, self.unconservative / total


def contingency(says_overturns: Sequence[bool], overturned: Sequence[bool]) -> Contingency:
    """Count a criterion against the runs."""
    pairs = list(zip(says_overturns, overturned, strict=True))
    return Contingency(
        cells=len(pairs),
        right=sum(said == did for said, did in pairs),
        conservative=sum(said and not did for said, did in pairs),
        unconservative=sum(did and not said for said, did in pairs),
    )


def mode_said(motion: Motion) -> str:
    """The mode of section 5 that Eqs. (8) to (13) predict."""
    if paper_criteria(motion):
        return "overturned"
    if motion.tilts and not motion.slides_first:
        return "rock"
    if motion.slides:
        return "slide-rock" if motion.tilts and motion.mu_kinetic > 1.0 / motion.slenderness else "slide"
    return "rest"


@dataclass(frozen=True, kw_only=True)
class Counted:
    """A map with what the criteria need to know of each cell."""

    title: str
    fast: bool  #: whether it holds motions faster than FAST
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


def stack_counted(laboratory: Laboratory) -> Counted:
    """Frequency and peak acceleration, rigid stack, mu 0.4/0.2."""
    cells = stack_map(laboratory, perturbed=True)
    return Counted(title="rigid stack, frequency x peak", fast=True, cells=cells, motions=_motions(cells))


def shell_counted(laboratory: Laboratory) -> Counted:
    """The same for the deformable shell, on a coarser grid."""
    cells = stack_map(
        laboratory,
        {"solver.model": "reduced", "solver.energy_tolerance": 1.0, "solver.duration_s": 10.0},
        frequencies=SHELL_FREQUENCIES,
        peaks=SHELL_PEAKS,
        perturbed=True,
    )
    return Counted(title="shell stack, frequency x peak", fast=True, cells=cells, motions=_motions(cells))


def shapes_counted(laboratory: Laboratory) -> list[Counted]:
    """Slenderness and friction, under the plateau value at the paper's frequency and at two lower ones."""
    found = []
    for frequency in (2.5, 4.0, ANGULAR_FREQUENCY):
        places = [(mu, slenderness) for mu in FRICTION for slenderness in SLENDERNESS]
        setups = [
            stack_setup(
                4.0,
                frequency,
                {
                    "container.boxes": 1,
                    "container.height_m": round(slenderness * WIDTH, 4),
                    "container.centroid_m": round(0.5 * slenderness * WIDTH, 4),
                    "contact.mu_static": mu,
                    "contact.mu_kinetic": round(0.5 * mu, 4),
                },
            )
            for mu, slenderness in places
        ]
        rows = laboratory.rows(setups)
        sure = mark_sure(laboratory, setups, rows, len(SLENDERNESS))
        cells = [
            Cell(angular_frequency=frequency, peak=4.0, setup=setup, row=row, sure=certain)
            for setup, row, certain in zip(setups, rows, sure, strict=True)
        ]
        motions = [
            Motion(
                peak=4.0,
                amplitude=4.0 / frequency**2,
                slenderness=slenderness,
                mu_static=mu,
                mu_kinetic=0.5 * mu,
            )
            for mu, slenderness in places
        ]
        title = f"rigid, c/a x mu_s, 4.0 m/s² at {frequency:g} rad/s"
        found.append(Counted(title=title, fast=frequency > FAST, cells=cells, motions=motions))
    return found


def static_rule_is_conservative(laboratory: Laboratory) -> Finding:
    """Section 1: the lateral force method is very conservative under reversed motion."""
    maps = [stack_counted(laboratory), *shapes_counted(laboratory)]
    comparisons = []
    for one in maps:
        sure = one.against(static_rule, sure=True)
        said = sum(static_rule(motion) for motion in one.motions)
        share = one.against(static_rule).conservative / said if said else 0.0
        comparisons += [
            _count(f"{one.title}: sure cells it calls standing and that overturn", sure.unconservative),
            Comparison(
                what=f"{one.title}: share of its verdicts 'overturns' that are wrong",
                measured=share,
                relation=">=",
                limit=0.5,
                unit="-",
                inside=one.fast,
            ),
        ]
    stack = maps[0]
    unsafe = sum(one.against(static_rule, sure=True).unconservative for one in maps)
    return Finding(
        comparisons=tuple(comparisons),
        bounds="motion faster than three times p; towards slow motion the rule becomes right",
        reading=(
            f"The static rule under the run's own peak is on the unsafe side in {unsafe} sure cells of "
            f"{sum(len(one.cells) for one in maps)}. How conservative it is depends on the frequency: "
            "where the floor is slow against p = 1.88 1/s the rule is right, where it reverses quickly "
            "the rule is wrong more often than not. See the drawing."
        ),
        setups=_witnesses(stack, static_rule),
        tables=tuple(_table(one) for one in maps),
        drawings=(_over_frequency(stack), _slender_map(maps[-1])),
    )


def paper_criteria_counted(laboratory: Laboratory) -> Finding:
    """Eqs. (8) to (13) with A <= a/2 against the runs."""
    maps = [stack_counted(laboratory), *shapes_counted(laboratory), shell_counted(laboratory)]
    comparisons = []
    for one in maps:
        found = one.against(paper_criteria)
        certain = one.against(paper_criteria, sure=True)
        rule = one.against(static_rule)
        comparisons += [
            _count(f"{one.title}: sure cells it calls standing and that overturn", certain.unconservative),
            Comparison(
                what=f"{one.title}: share of right verdicts less that of the static rule",
                measured=found.shares[0] - rule.shares[0],
                relation=">=",
                limit=0.0,
                unit="-",
            ),
        ]
    stack = maps[0]
    modes = _modes(stack)
    right = sum(modes[name].get(name, 0) for name in modes)
    total = sum(sum(row.values()) for row in modes.values())
    return Finding(
        comparisons=tuple(comparisons),
        reading=(
            "With A <= a/2 the paper's criteria are less conservative than the static rule and are paid "
            "for with motions that they call standing and that overturn. Of the modes of section 5 they "
            f"name {right} of {total} right on the map of the rigid stack. A criterion that is not on the "
            "safe side cannot replace one that is."
        ),
        setups=_witnesses(stack, paper_criteria),
        tables=(*(_table(one) for one in maps), _mode_table(modes)),
        drawings=(_stack_map(stack),),
    )


def less_conservative(laboratory: Laboratory) -> Finding:
    """Section 8: dynamic criteria enable a less conservative statement; FE time history a more precise one."""
    stack, shell = stack_counted(laboratory), shell_counted(laboratory)
    rule, paper = stack.against(static_rule), stack.against(paper_criteria)
    places = {(cell.peak, cell.angular_frequency): cell for cell in stack.cells}
    pairs = [
        (places[cell.peak, cell.angular_frequency], cell)
        for cell in shell.cells
        if cell.computed and (cell.peak, cell.angular_frequency) in places
    ]
    both = [(one, other) for one, other in pairs if one.computed]
    differ = [pair for pair in both if pair[0].fell != pair[1].fell]
    sure = [pair for pair in differ if pair[0].sure]
    return Finding(
        comparisons=(
            Comparison(
                what="motions of the map that the static rule turns over and the run lets stand",
                measured=float(rule.conservative),
                relation=">=",
                limit=1.0,
                unit="-",
            ),
            Comparison(
                what="conservative verdicts of the paper's criteria less those of the static rule",
                measured=float(paper.conservative - rule.conservative),
                relation="<=",
                limit=0.0,
                unit="-",
            ),
            _count(
                "sure cells on which the paper's criteria are on the unsafe side",
                stack.against(paper_criteria, sure=True).unconservative,
                inside=False,
            ),
            Comparison(
                what="cells whose end the deformable shell changes, of those where it is computed",
                measured=len(differ) / max(len(both), 1),
                relation="<=",
                limit=0.1,
                unit="-",
                inside=False,
            ),
        ),
        bounds="by time history; not by the amplitude A",
        reading=(
            f"Time histories let {rule.conservative} of {rule.cells} motions stand that the static rule "
            "turns over: a less conservative statement, with the motion known. The deformable shell ends "
            f"otherwise than the rigid block in {len(differ)} of {len(both)} cells, {len(sure)} of them "
            "sure for the rigid block."
        ),
        setups=tuple(cell.setup for _, cell in differ[:3]),
    )


def region_of_safety(laboratory: Laboratory) -> Finding:
    """Abstract: boundaries in slenderness and friction within which the structure is safe."""
    comparisons = []
    maps = shapes_counted(laboratory)
    for one in maps:
        grid = np.array([cell.fell for cell in one.cells]).reshape(len(FRICTION), len(SLENDERNESS))
        holes = int(sum(_reentries(row.tolist()) for row in grid))
        comparisons += [
            Comparison(
                what=f"{one.title}: share of cells that stand",
                measured=1.0 - float(grid.mean()),
                relation=">=",
                limit=0.05,
                unit="-",
            ),
            _count(f"{one.title}: changes from falling back to standing along c/a", holes, inside=False),
        ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="for a given motion; the boundary is not a single curve where islands lie beyond it",
        reading=(
            "For a given motion there is a region of slenderness and friction that stands: squat "
            "containers, and slender ones whose friction lets them slide. It changes with the frequency "
            "as much as with either."
        ),
        setups=tuple(one.cells[-1].setup for one in maps),
        drawings=tuple(_slender_map(one) for one in maps[:2]),
    )


def _motions(cells: Sequence[Cell]) -> list[Motion]:
    return [
        Motion(
            peak=cell.peak, amplitude=cell.amplitude, slenderness=4.0 / WIDTH, mu_static=0.4, mu_kinetic=0.2
        )
        for cell in cells
    ]


def _table(one: Counted) -> Table:
    rows = []
    for name, criterion in CRITERIA.items():
        for which, sure in (("all", None), ("sure", True), ("unsure", False)):
            found = one.against(criterion, sure=sure)
            if found.cells:
                rows.append((name, which, found.cells, found.right, found.conservative, found.unconservative))
    return Table(
        caption=one.title,
        columns=("criterion", "cells", "number", "right", "conservative", "unconservative"),
        rows=tuple(rows),
    )


def _modes(one: Counted) -> dict[str, dict[str, int]]:
    found: dict[str, dict[str, int]] = {}
    for cell, motion in zip(one.cells, one.motions, strict=True):
        if cell.computed:
            row = found.setdefault(mode_said(motion), {})
            outcome = str(cell.row["outcome"])
            row[outcome] = row.get(outcome, 0) + 1
    return found


def _mode_table(modes: Mapping[str, Mapping[str, int]]) -> Table:
    names = ("rest", "slide", "rock", "slide-rock", "overturned")
    return Table(
        caption="Mode by Eqs. 8 to 13 and A (rows) and by the run (columns), rigid stack, mu 0.4/0.2",
        columns=("said", *names),
        rows=tuple((said, *(modes[said].get(name, 0) for name in names)) for said in names if said in modes),
    )


def _witnesses(one: Counted, criterion: Callable[[Motion], bool]) -> tuple[Setup, ...]:
    """One sure cell of either error, to be run again."""
    found = []
    for said, fell in ((True, False), (False, True)):
        found += [
            cell.setup
            for cell, motion in zip(one.cells, one.motions, strict=True)
            if cell.computed and cell.sure and criterion(motion) is said and cell.fell is fell
        ][:1]
    return tuple(found)


def _over_frequency(one: Counted) -> Drawing:
    shares = []
    for frequency in FREQUENCIES:
        said = [
            cell
            for cell, motion in zip(one.cells, one.motions, strict=True)
            if cell.computed and cell.angular_frequency == frequency and static_rule(motion)
        ]
        shares.append(sum(not cell.fell for cell in said) / max(len(said), 1))
    return drawing(
        "static-rule-over-frequency",
        (
            "Share of the motions that the static rule turns over and the rigid stack stands (peaks from "
            "g a/c to 12 m/s²)."
        ),
        [Line(x=FREQUENCIES, y=shares, style="o-")],
        x_label="angular frequency [rad/s]",
        y_label="share that stands [-]",
        y_limits=(0.0, 1.05),
    )


def _stack_map(one: Counted) -> Drawing:
    smooth = np.linspace(min(FREQUENCIES), max(FREQUENCIES), 100)
    return outcome_map(
        "criteria-map",
        "Outcome of the rigid stack, mu 0.4/0.2, with the criteria; dots: unsure cells.",
        x=FREQUENCIES,
        y=PEAKS,
        outcomes=outcomes(one.cells),
        unsure=doubts(one.cells),
        x_label="angular frequency [rad/s]",
        y_label="peak floor acceleration [m/s²]",
        curves=(
            Line(x=smooth, y=0.5 * WIDTH * smooth**2, label="A = a/2"),
            Line(x=smooth, y=np.full_like(smooth, GRAVITY * WIDTH / 4.0), label="M_T = M_R"),
            Line(x=smooth, y=np.full_like(smooth, 0.4 * GRAVITY), label="stiction"),
        ),
    )


def _slender_map(one: Counted) -> Drawing:
    return outcome_map(
        f"slenderness-friction-{one.cells[0].angular_frequency:g}".replace(".", "-"),
        f"Outcome over slenderness and friction (mu_k = mu_s/2): {one.title}; dots: unsure cells.",
        x=SLENDERNESS,
        y=FRICTION,
        outcomes=outcomes(one.cells, SLENDERNESS),
        unsure=doubts(one.cells, SLENDERNESS),
        x_label="slenderness c/a [-]",
        y_label="static friction mu_s [-]",
        curves=(Line(x=SLENDERNESS, y=[1.0 / one for one in SLENDERNESS], label="mu_s = a/c"),),
        log_y=False,
    )


def _reentries(fell: Sequence[bool]) -> int:
    """How often a row of cells goes from falling back to standing."""
    return sum(bool(before) and not bool(after) for before, after in pairwise(fell))


def _count(what: str, number: float, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=float(number), relation="<=", limit=0.0, unit="-", inside=inside)


STATEMENTS = (
    Statement(
        name="static-rule-is-conservative",
        section="abstract, 1",
        quote=(
            "the Lateral Force Method is very conservative, when it comes to reversed base motion as with "
            "earthquake"
        ),
        tried=(
            "Static rule under the run's own peak against runs: frequency and peak; slenderness and "
            "friction at three frequencies."
        ),
        examine=static_rule_is_conservative,
        seconds=60.0,
    ),
    Statement(
        name="paper-criteria",
        section="5, Eqs. 8-13",
        quote="limit conditions of sticking, slipping, rocking and overturning mode; A <= a/2",
        tried="The paper's criteria and A <= a/2 against the same runs, and against the deformable shell.",
        examine=paper_criteria_counted,
        seconds=40.0,
    ),
    Statement(
        name="less-conservative",
        section="8",
        quote=(
            "Employing dynamic criteria enables a less conservative statement on global rocking "
            "stability; even more precise findings can be expected by FE time history analysis"
        ),
        tried="The same maps: rule, criteria, rigid runs and runs of the shell.",
        examine=less_conservative,
        seconds=1.0,
    ),
    Statement(
        name="region-of-safety",
        section="abstract",
        quote=(
            "Depending on the aspect ratio and a variation of friction coefficients parameter confidence "
            "boundaries are identified, within which the structure is safe"
        ),
        tried="Outcome over slenderness and friction at three frequencies under 4.0 m/s².",
        examine=region_of_safety,
        seconds=1.0,
    ),
)
