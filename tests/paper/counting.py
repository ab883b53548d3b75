"""The paper's central claim, counted: static rule, the paper's own criteria and the run, cell by cell."""

from collections import Counter
from itertools import pairwise

import numpy as np
from evidence.findings import at_least, at_most
from evidence.pages import Picture
from paper import criteria, maps
from paper.cases import BOX, SHELL, STACK, PaperCase, friction
from paper.claims import Curve, Evidence, claim, draw_curves, outcomes, table
from paper.dimensions import ANGULAR_FREQUENCY, FREQUENCY_PARAMETER, GRAVITY, HALF_WIDTH, PAPER_MU, UPLIFT
from paper.experiments import Experiments

from fem.figures.heat_map import MapCurve
from fem.results.outcome import Outcome

UNSAFE = "sure cells it calls standing and that overturn"


def _maps(experiments: Experiments) -> list[maps.OutcomeMap]:
    """All maps, the rigid ones first; of either kind the stack's first."""
    return [
        outcome_map
        for rigid in (True, False)
        for outcome_map in (
            maps.stack_map(experiments, rigid=rigid),
            *maps.shape_maps(experiments, rigid=rigid),
        )
    ]


@claim(
    "abstract, 1",
    "the Lateral Force Method ... is very conservative, when it comes to reversed base motion as with earthquake",
    bounds="overturning of a rigid container on corners, motion faster than three times p",
)
def static_rule_is_conservative(experiments: Experiments) -> Evidence:
    """Static rule under the run's own peak against runs, over frequency and peak of the stack, and over slenderness and
    friction at three frequencies; two floors below the static limits."""
    every_map = _maps(experiments)
    for outcome_map in every_map:
        unsafe = outcome_map.count(criteria.static_rule, sure=True).unconservative
        wrong = f"{outcome_map.title}: share of its verdicts 'overturns' that are wrong"
        share = outcome_map.standing_share(criteria.static_rule)
        yield at_most(f"{outcome_map.title}: {UNSAFE}", unsafe, 0.0, inside=outcome_map.rigid)
        yield at_least(wrong, share, 0.5, inside=outcome_map.fast and outcome_map.rigid)
    stack = every_map[0]
    slow, fast = (
        stack.standing_share(
            criteria.static_rule,
            [frequency for frequency in maps.FREQUENCIES if (frequency > maps.FAST) is wanted],
        )
        for wanted in (False, True)
    )
    rigid = [
        outcome_map.count(criteria.static_rule, sure=True) for outcome_map in every_map if outcome_map.rigid
    ]
    yield (
        "The static rule under the run's own peak is on the unsafe side in "
        f"{sum(counts.unconservative for counts in rigid)} of {sum(counts.cells for counts in rigid)} sure cells of "
        "the rigid maps. How conservative it is depends on the frequency of the floor over p = "
        f"{FREQUENCY_PARAMETER:.2f} 1/s: of the motions for which it predicts overturning, the rigid stack stands in "
        f"{100.0 * slow:.0f} % up to 3 p and in {100.0 * fast:.0f} % above 3 p. See the figure. These are counts of "
        "overturning."
    )
    # runs that the static rule holds for sliding and tilting, and that may move all the same
    jump = BOX.but(
        SHELL,
        {"motion.kind": "pulse", "motion.shape": "rectangular", "motion.pulse_s": 0.5, "motion.delay_s": 0.1},
        peak=0.8 * PAPER_MU[0] * GRAVITY,
        duration=1.5,
        what="shell box, the floor jumps to 0.80 of mu_s g for 0.5 s",
    )
    flat = STACK.but(
        SHELL,
        friction(0.4, 0.4),
        support="flat",
        peak=0.95 * UPLIFT,
        frequency=ANGULAR_FREQUENCY,
        duration=15.0,
        what="shell stack on a flat base, 0.95 of g a/c, mu_k = mu_s",
    )
    cases = [
        jump,
        jump.but({"contact.weakening_m": 2e-4}, what=f"{jump.what}; mu falls over 0.2 mm of slip"),
        flat,
        experiments.on_floor(flat, 100.0).but(what=f"{flat.what}; a floor 100 times as stiff"),
    ]
    rows = experiments.rows(cases)
    slips, ratios = ([row[key] for row in rows] for key in ("max_slip_m", "rotation_ratio"))
    slide = at_most(f"slip, {jump.what}", 1e3 * slips[0], 0.1, "mm", inside=False)
    rock = at_most(f"rotation ratio, {flat.what}", ratios[2], 0.01, inside=False)
    bounds = ["a bound" if finding.holds else "no bound" for finding in (slide, rock)]
    yield slide
    yield rock
    yield (
        f"For sliding it is {bounds[0]} in this program: where the floor jumps to 0.80 of stiction the shell box "
        f"slides by {1e3 * slips[0]:.3g} mm ({1e3 * slips[1]:.2g} mm if mu falls over 0.2 mm of slip). For the start "
        f"of rocking it is {bounds[1]}: at 0.95 of g a/c the shell stack on a flat base rotates to {ratios[2]:.2g} "
        f"of the slenderness angle ({ratios[3]:.2g} on a floor 100 times as stiff)."
    )
    yield from cases
    yield outcomes("Below the static limits", experiments, cases)
    yield from _witnesses(stack, criteria.static_rule)
    yield draw_curves(
        "static-rule-over-frequency",
        "Share of the motions that the static rule turns over and the rigid stack stands (peaks from "
        "g a/c to 12 m/s²).",
        "angular frequency [rad/s] | share that stands [-]",
        [
            Curve(
                maps.FREQUENCIES,
                [stack.standing_share(criteria.static_rule, [frequency]) for frequency in maps.FREQUENCIES],
                style="o-",
            )
        ],
        y_limits=(0.0, 1.05),
    )
    yield _shape_figure(maps.shape_maps(experiments)[-1])


@claim(
    "5, Eqs. 8-13",
    "Identification of Modes ... Limit conditions",
    bounds="Eqs. 8 to 13, when it slides and tilts; A <= a/2 is the claim half-width-is-conservative",
)
def paper_criteria(experiments: Experiments) -> Evidence:
    """The paper's criteria against the same runs, with and without A <= a/2."""
    every_map = _maps(experiments)
    for name, rule in (("Eqs. 8 to 13", criteria.tilting_rule), ("with A <= a/2", criteria.paper_rule)):
        for outcome_map in every_map:
            unsafe = outcome_map.count(rule, sure=True).unconservative
            gain = outcome_map.count(rule).share_right - outcome_map.count(criteria.static_rule).share_right
            what = f"{name}, {outcome_map.title}"
            inside = rule is criteria.tilting_rule
            yield at_most(f"{what}: {UNSAFE}", unsafe, 0.0, inside=inside)
            yield at_least(f"{what}: share right less that of the static rule", gain, 0.0, inside=inside)
    stack = every_map[0]
    modes = Counter((criteria.predicted_mode(cell.motion), str(cell.row["outcome"])) for cell in stack.cells)
    tilting, paper, static = (
        f"right in {counts.right} of {counts.cells} cells, conservative in {counts.conservative} and unconservative in "
        f"{counts.unconservative}"
        for counts in map(stack.count, (criteria.tilting_rule, criteria.paper_rule, criteria.static_rule))
    )
    right = sum(count for (predicted, observed), count in modes.items() if predicted == observed)
    yield (
        f"On the map of the rigid stack Eqs. 8 to 13 are {tilting}; with A <= a/2 {paper}; the static rule "
        f"{static}. Of the modes of section 5 the criteria predict {right} of {modes.total()} correctly. A criterion "
        "is a bound on the safe side only where it is never unconservative."
    )
    yield from _witnesses(stack, criteria.paper_rule)
    rows = []
    for outcome_map in every_map:
        for name, criterion in criteria.CRITERIA.items():
            every, sure = outcome_map.count(criterion), outcome_map.count(criterion, sure=True)
            counted = every.cells, every.right, every.conservative, every.unconservative
            rows.append((outcome_map.title, name, *counted, sure.unconservative))
    yield table(
        "Criteria against runs, cell by cell",
        "map | criterion | cells | right | conservative | unconservative | .. of sure cells",
        rows,
    )
    names, said = tuple(Outcome), {mode for mode, _ in modes}
    yield table(
        "Mode by Eqs. 8 to 13 and A (rows) and by the run (columns), rigid stack, mu 0.4/0.2",
        f"said | {' | '.join(names)}",
        [(mode, *(modes[mode, observed] for observed in names)) for mode in names if mode in said],
    )
    smooth = np.linspace(min(maps.FREQUENCIES), max(maps.FREQUENCIES), 100)
    yield maps.draw_map(
        "criteria-map",
        "Outcome of the rigid stack, mu 0.4/0.2, with the criteria; hatched: unsure cells.",
        stack,
        [
            MapCurve(x=smooth, y=HALF_WIDTH * smooth**2, label="A = a/2"),
            MapCurve(x=smooth, y=np.full_like(smooth, UPLIFT), label="M_T = M_R"),
            MapCurve(x=smooth, y=np.full_like(smooth, PAPER_MU[0] * GRAVITY), label="stiction"),
        ],
    )


@claim(
    "8",
    "Employing dynamic criteria enables a less conservative statement on global rocking "
    "stability; even more precise findings can be expected by FE time history analysis",
    bounds="by time history; not by the amplitude A",
)
def less_conservative(experiments: Experiments) -> Evidence:
    """The same maps: rule, criteria, rigid runs and runs of the shell."""
    stack, shell = (maps.stack_map(experiments, rigid=rigid) for rigid in (True, False))
    rule, paper = stack.count(criteria.static_rule), stack.count(criteria.paper_rule)
    unsafe = stack.count(criteria.paper_rule, sure=True).unconservative
    both = maps.pairs(stack, shell)
    differ = [pair for pair in both if pair[0].fell != pair[1].fell]
    share = len(differ) / max(len(both), 1)
    fewer = "conservative verdicts of the paper's criteria less those of the static rule"
    yield at_least("motions that the static rule turns over and the run lets stand", rule.conservative, 1.0)
    yield at_most(fewer, paper.conservative - rule.conservative, 0.0)
    yield at_most("sure cells with the paper's criteria on the unsafe side", unsafe, 0.0, inside=False)
    yield at_most("share of cells whose end the deformable shell changes", share, 0.1, inside=False)
    yield (
        f"In {rule.conservative} of {rule.cells} motions the static rule predicts overturning and the time history "
        "shows that the stack stands; this requires that the motion is known. The outcome of the deformable shell "
        f"differs from that of the rigid block in {len(differ)} of {len(both)} cells, "
        f"{sum(cell.sure for cell, _ in differ)} of them sure for the rigid block."
    )
    yield from [cell.case for _, cell in differ[:3]]


@claim(
    "abstract",
    "Depending on the aspect ratio and a variation of friction coefficients parameter confidence "
    "boundaries are identified, within which the structure is safe",
    bounds="for a given motion; the boundary is not a single curve where islands lie beyond it",
)
def region_of_safety(experiments: Experiments) -> Evidence:
    """Outcome over slenderness and friction under 4.0 m/s²."""
    every_map, shells = (maps.shape_maps(experiments, rigid=rigid) for rigid in (True, False))
    for outcome_map in (*every_map, *shells):
        changes = f"{outcome_map.title}: changes from falling back to standing along c/a"
        share = outcome_map.standing_share()
        yield at_least(
            f"{outcome_map.title}: share of cells that stand", share, 0.05, inside=outcome_map.rigid
        )
        yield at_most(changes, _re_entries(outcome_map), 0.0, inside=False)
    both = [pair for rigid, shell in zip(every_map, shells, strict=True) for pair in maps.pairs(rigid, shell)]
    yield (
        "The safe region depends on the motion: it is "
        f"{', '.join(f'{100.0 * outcome_map.standing_share():.0f} %' for outcome_map in every_map)} of the cells of "
        f"the rigid container at {', '.join(f'{w:g}' for w in maps.SHAPE_FREQUENCIES)} rad/s. Along c/a it "
        f"is left and re-entered {sum(map(_re_entries, every_map))} times in {len(every_map) * len(maps.FRICTION)} "
        "rows of cells. The outcome of the shell differs from that of the rigid container in "
        f"{sum(rigid.fell != shell.fell for rigid, shell in both)} of {len(both)} cells. These "
        "are outcomes of single motions; for regions with a probability, see python -m fem ensemble boundary."
    )
    yield from [outcome_map.every[-1].case for outcome_map in (*every_map, *shells[-1:])]
    yield from [_shape_figure(outcome_map) for outcome_map in every_map[:2]]


def _re_entries(outcome_map: maps.OutcomeMap) -> int:
    """How often the rows of a map go from falling back to standing."""
    return sum(before.fell and after.stood for row in outcome_map.rows for before, after in pairwise(row))


def _witnesses(outcome_map: maps.OutcomeMap, criterion: criteria.Criterion) -> list[PaperCase]:
    """One sure cell of either error, to be run again."""
    wrong = [cell for cell in outcome_map.cells if cell.sure and criterion(cell.motion) is not cell.fell]
    first = [next((cell for cell in wrong if cell.fell is fell), None) for fell in (False, True)]
    return [cell.case for cell in first if cell is not None]


def _shape_figure(outcome_map: maps.OutcomeMap) -> Picture:
    frequency = f"{outcome_map.every[0].motion.angular_frequency:g}"
    shapes = np.array(maps.SLENDERNESS)
    return maps.draw_map(
        f"slenderness-friction-{frequency}".replace(".", "-"),
        f"Outcome over slenderness and friction (mu_k = mu_s/2): {outcome_map.title}; hatched: unsure cells.",
        outcome_map,
        [MapCurve(x=shapes, y=1.0 / shapes, label="mu_s = a/c")],
    )
