"""The paper's central claim, counted: static rule, the paper's own criteria and the run, cell by cell."""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from fem.paper.cases import FREQUENCY_PARAMETER, GRAVITY, UPLIFT, WIDTH
from fem.paper.claims import Comparison, Drawing, Finding, Setup, Statement, Table
from fem.paper.counted_maps import (
    FAST,
    FRICTION,
    SHAPE_FREQUENCIES,
    SLENDERNESS,
    Counted,
    counted_maps,
    same_places,
    shapes_counted,
    stack_counted,
)
from fem.paper.criteria import CRITERIA, Contingency, Motion, mode_said, paper_criteria, static_rule
from fem.paper.experiments import Laboratory
from fem.paper.figures import Line, drawing, outcome_map
from fem.paper.maps import FREQUENCIES, PEAKS, Cell, doubts, grid, outcomes

GRIDS = (
    f"Maps of {len(FREQUENCIES)} x {len(PEAKS)} cells over frequency and peak, and of {len(SLENDERNESS)} x "
    f"{len(FRICTION)} over slenderness and friction at {len(SHAPE_FREQUENCIES)} frequencies; the shell at every "
    "second value of each."
)


def static_rule_is_conservative(laboratory: Laboratory) -> Finding:
    """Section 1: the lateral force method is very conservative under reversed motion."""
    maps = counted_maps(laboratory)
    comparisons = []
    for one in maps:
        comparisons += [
            _count(
                f"{one.title}: sure cells it calls standing and that overturn",
                one.against(static_rule, sure=True).unconservative,
                inside=one.rigid,
            ),
            Comparison(
                what=f"{one.title}: share of its verdicts 'overturns' that are wrong",
                measured=one.standing_of_said(static_rule, {cell.angular_frequency for cell in one.cells}),
                relation=">=",
                limit=0.5,
                unit="-",
                inside=one.fast and one.rigid,
            ),
        ]
    stack = maps[0]
    slow, fast = (
        stack.standing_of_said(static_rule, [one for one in FREQUENCIES if (one > FAST) is wanted])
        for wanted in (False, True)
    )
    rigid = [one.against(static_rule, sure=True) for one in maps if one.rigid]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="a rigid container, motion faster than three times p",
        reading=(
            "The static rule under the run's own peak is on the unsafe side in "
            f"{sum(one.unconservative for one in rigid)} of {sum(one.cells for one in rigid)} sure cells of the "
            f"rigid maps. How conservative it is depends on how fast the floor is against p = "
            f"{FREQUENCY_PARAMETER:.2f} 1/s: of the motions that it turns over the rigid stack stands "
            f"{100.0 * slow:.0f} % up to 3 p and {100.0 * fast:.0f} % beyond. See the drawing."
        ),
        setups=_witnesses(stack, static_rule),
        tables=tuple(_table(one) for one in maps),
        drawings=(_over_frequency(stack), _slender_map(shapes_counted(laboratory)[-1])),
    )


def paper_criteria_counted(laboratory: Laboratory) -> Finding:
    """Eqs. (8) to (13) with A <= a/2 against the runs."""
    maps = counted_maps(laboratory)
    comparisons = []
    for one in maps:
        found, rule = one.against(paper_criteria), one.against(static_rule)
        comparisons += [
            _count(
                f"{one.title}: sure cells it calls standing and that overturn",
                one.against(paper_criteria, sure=True).unconservative,
            ),
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
            f"On the map of the rigid stack the paper's criteria with A <= a/2 are "
            f"{_counts(stack.against(paper_criteria))}, the static rule "
            f"{_counts(stack.against(static_rule))}. Of the modes of section 5 the criteria name {right} of "
            f"{total} right. A criterion bounds what is safe only where it is never unconservative."
        ),
        setups=_witnesses(stack, paper_criteria),
        tables=(*(_table(one) for one in maps), _mode_table(modes)),
        drawings=(_stack_map(stack),),
    )


def less_conservative(laboratory: Laboratory) -> Finding:
    """Section 8: dynamic criteria enable a less conservative statement; FE time history a more precise one."""
    stack, shell = (stack_counted(laboratory, rigid=rigid) for rigid in (True, False))
    rule, paper = stack.against(static_rule), stack.against(paper_criteria)
    both = same_places(stack, shell)
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
            "turns over; the motion must be known for that. The deformable shell ends otherwise than the rigid "
            f"block in {len(differ)} of {len(both)} cells, {len(sure)} of them sure for the rigid block."
        ),
        setups=tuple(cell.setup for _, cell in differ[:3]),
    )


def region_of_safety(laboratory: Laboratory) -> Finding:
    """Abstract: boundaries in slenderness and friction within which the structure is safe."""
    comparisons, found = [], []
    maps, shells = (shapes_counted(laboratory, rigid=rigid) for rigid in (True, False))
    for one in (*maps, *shells):
        stood = np.array([cell.stood for cell in one.cells]).reshape(-1, one.columns)
        holes = sum(_reentries(row) for row in grid(one.cells, one.columns))
        comparisons += [
            Comparison(
                what=f"{one.title}: share of cells that stand",
                measured=float(stood.mean()),
                relation=">=",
                limit=0.05,
                unit="-",
                inside=one.rigid,
            ),
            _count(f"{one.title}: changes from falling back to standing along c/a", holes, inside=False),
        ]
        found.append((100.0 * float(stood.mean()), holes))
    both = [pair for one, other in zip(maps, shells, strict=True) for pair in same_places(one, other)]
    differ = sum(one.fell != other.fell for one, other in both)
    shares = ", ".join(f"{share:.0f} %" for share, _ in found[: len(maps)])
    return Finding(
        comparisons=tuple(comparisons),
        bounds="for a given motion; the boundary is not a single curve where islands lie beyond it",
        reading=(
            "The region that stands is one of a given motion: it is "
            f"{shares} of the cells of the rigid container at "
            f"{', '.join(f'{one:g}' for one in SHAPE_FREQUENCIES)} rad/s. Along c/a it is left and entered again "
            f"{sum(holes for _, holes in found[: len(maps)])} times in {len(maps) * len(FRICTION)} rows of "
            f"cells. The shell ends otherwise than the rigid container in {differ} of {len(both)} cells. These "
            "are outcomes of single motions; regions with a probability: python -m fem ensemble boundary."
        ),
        setups=tuple(one.cells[-1].setup for one in (*maps, *shells[-1:])),
        drawings=tuple(_slender_map(one) for one in maps[:2]),
    )


def _counts(one: Contingency) -> str:
    return (
        f"right in {one.right} of {one.cells} cells, conservative in {one.conservative} and unconservative in "
        f"{one.unconservative}"
    )


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
    shares = [one.standing_of_said(static_rule, [frequency]) for frequency in FREQUENCIES]
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
        outcomes=outcomes(one.cells, one.columns),
        unsure=doubts(one.cells, one.columns),
        x_label="angular frequency [rad/s]",
        y_label="peak floor acceleration [m/s²]",
        curves=(
            Line(x=smooth, y=0.5 * WIDTH * smooth**2, label="A = a/2"),
            Line(x=smooth, y=np.full_like(smooth, UPLIFT), label="M_T = M_R"),
            Line(x=smooth, y=np.full_like(smooth, 0.4 * GRAVITY), label="stiction"),
        ),
    )


def _slender_map(one: Counted) -> Drawing:
    return outcome_map(
        f"slenderness-friction-{one.cells[0].angular_frequency:g}".replace(".", "-"),
        f"Outcome over slenderness and friction (mu_k = mu_s/2): {one.title}; dots: unsure cells.",
        x=SLENDERNESS,
        y=FRICTION,
        outcomes=outcomes(one.cells, one.columns),
        unsure=doubts(one.cells, one.columns),
        x_label="slenderness c/a [-]",
        y_label="static friction mu_s [-]",
        curves=(Line(x=SLENDERNESS, y=[1.0 / one for one in SLENDERNESS], label="mu_s = a/c"),),
        log_y=False,
    )


def _reentries(row: Sequence[Cell]) -> int:
    """How often a row of cells goes from falling back to standing."""
    return sum(before.fell and after.stood for before, after in pairwise(row))


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
        tried=f"Static rule under the run's own peak against runs. {GRIDS}",
        examine=static_rule_is_conservative,
        seconds=53.0,
    ),
    Statement(
        name="paper-criteria",
        section="5, Eqs. 8-13",
        quote="limit conditions of sticking, slipping, rocking and overturning mode; A <= a/2",
        tried=f"The paper's criteria and A <= a/2 against the same runs. {GRIDS}",
        examine=paper_criteria_counted,
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
    ),
    Statement(
        name="region-of-safety",
        section="abstract",
        quote=(
            "Depending on the aspect ratio and a variation of friction coefficients parameter confidence "
            "boundaries are identified, within which the structure is safe"
        ),
        tried=f"Outcome over slenderness and friction under 4.0 m/s². {GRIDS}",
        examine=region_of_safety,
    ),
)
