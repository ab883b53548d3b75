"""What the paper says of slipping: it does not depend on the number of boxes, and it stabilises."""

from collections.abc import Sequence

import numpy as np

from fem.batch.runner import Row
from fem.paper.cases import FOR_MAPS, HEIGHT, NO_SLIDING, PLATEAU, RIGID, STACK, WIDTH
from fem.paper.claims import Comparison, Evidence, at_most, claim, table
from fem.paper.experiments import Experiments, VariantBand, capped_ratio
from fem.paper.figures import PlottedLine, draw_curves
from fem.paper.maps import HOLDING, MapCell, pairs, stack_map

#: c/a of the stack is 3.636: below a/c = 0.275 it slides before it tilts
WIDTH_OVER_HEIGHT = WIDTH / HEIGHT
LARGER = 1.05  #: a rotation that much larger counts as larger


@claim(
    "8",
    "Slipping is not affected by the number of boxes in the stack, only by the base acceleration "
    "and the coefficient of friction",
    bounds="as long as no stack lifts from the floor",
)
def number_of_boxes(experiments: Experiments) -> Evidence:
    """One to six boxes under the same floor, two pairs of friction, three peaks."""
    stacks = (1, 2, 3, 4, 6)
    flat: list[Comparison] = []
    every: list[Comparison] = []
    lines = []
    for static, kinetic in ((0.2, 0.1), (0.4, 0.2)):
        for peak in (2.5, 5.0, 8.0):
            title = f"mu {static:g}/{kinetic:g}, {peak:g} m/s²"
            group = [
                STACK.but(
                    FOR_MAPS,
                    boxes=boxes,
                    mu_static=static,
                    mu_kinetic=kinetic,
                    duration=10.0,
                    peak=peak,
                    frequency=10.0,
                    what=f"{boxes} boxes, {title} at 10 rad/s",
                )
                for boxes in stacks
            ]
            rows = experiments.rows(group)
            # lengths of path below a tenth of a millimetre are the elasticity of the contact
            if max(row["slip_travel_m"] for row in rows) < 1e-4:
                continue
            on_floor = [row for row in rows if row["first_uplift_s"] is None]
            what = f"spread of the path, {title}"
            found = [at_most(f"{what}: all that never lift from the floor", _spread(on_floor), 0.02)]
            flat += found
            if len(on_floor) < len(rows):
                every.append(at_most(f"{what}: all of them", _spread(rows), 0.02, inside=False))
                found.append(every[-1])
            yield from found
            yield group[0]
            yield group[-1]
            lines += [
                (title, boxes, row["outcome"], 1e3 * row["slip_travel_m"], row["rotation_ratio"])
                for boxes, row in zip(stacks, rows, strict=True)
            ]
    yield (
        f"The paths of stacks that stay flat differ by up to {_largest(flat):.2%}, those of all "
        f"by up to {_largest(every):.0%}: a higher stack lifts earlier (g a/c against mu_s g), "
        "and a rocking stack slides differently."
    )
    yield table(
        "Path over the floor in 10 s, 10 rad/s, rigid",
        "case | boxes | outcome | path [mm] | rotation ratio [-]",
        lines,
    )
    yield _band_of_paths(experiments)


def _spread(rows: Sequence[Row]) -> float:
    paths = [row["slip_travel_m"] for row in rows]
    return float((max(paths) - min(paths)) / (sum(paths) / len(paths)))


def _largest(comparisons: Sequence[Comparison]) -> float:
    return max((one.measured for one in comparisons), default=np.nan)


def _band_of_paths(experiments: Experiments) -> VariantBand:
    """Path of the stack that stays flat, over that of one rigid box under the same floor."""
    case = STACK.but(mu_static=0.2, mu_kinetic=0.1, duration=5.0, peak=5.0, frequency=10.0)
    path = experiments.row(case.but(FOR_MAPS, boxes=1))["slip_travel_m"]
    return experiments.band(
        case,
        quantity="path of four boxes over that of one rigid box, mu 0.2/0.1, 5.0 m/s² at 10 rad/s",
        value=lambda row: row["slip_travel_m"] / path,
        criterion="within 5 % of one rigid box",
        holds=lambda row: abs(row["slip_travel_m"] / path - 1.0) <= 0.05,
    )


@claim(
    "8",
    "According to the above findings slipping leads to increased overall stability",
    bounds=f"mu_s below a/c = {WIDTH_OVER_HEIGHT:.3f}: the stack slides before it could tilt",
)
def slipping_stabilises(experiments: Experiments) -> Evidence:
    """Maps of the rigid stack over frequency and peak acceleration with five frictions, against friction that
    holds."""
    holding = stack_map(experiments, HOLDING)
    fixed = experiments.row(PLATEAU.but(RIGID, NO_SLIDING, duration=10.0))["rotation_ratio"]
    low_cells: list[MapCell] = []
    lines, worse = [], []
    for static, kinetic in ((0.2, 0.1), (0.25, 0.125), (0.3, 0.15), (0.4, 0.2), (0.4, 0.4)):
        slipping = stack_map(experiments, (static, kinetic), perturbed=static in (0.25, 0.4))
        slid = [pair for pair in pairs(holding, slipping) if pair[1].row["max_slip_m"] > 1e-3]
        saved = [one for one, other in slid if one.fell and not other.fell]
        lost = [pair for pair in slid if pair[1].fell and not pair[0].fell]
        sure = [pair for pair in lost if pair[0].sure and pair[1].sure]
        more = [pair for pair in slid if _turns_more(*pair)]
        inside = static < WIDTH_OVER_HEIGHT
        if inside:
            low_cells += slipping.cells
        name = f"mu {static:g}/{kinetic:g}"
        share = len(more) / len(slid) if slid else np.nan
        turning = f"{name}: share of slipping cells that turn more than without slipping"
        falls = f"{name}: sure cells that fall only because they slip"
        yield Comparison(what=falls, measured=len(sure), relation="<=", limit=0.0, inside=inside)
        yield at_most(turning, share, 0.0, inside=inside)
        lines.append((name, len(slid), len(saved), len(lost), len(sure), len(more)))
        worse += [other.case for _, other in (sure or more)[:2]]
    _, cells, saved_by, lost_by, surely, further = (list(column) for column in zip(*lines, strict=True))
    yield (
        f"Of {sum(cells)} motions that make the stack slip, over all frictions, slipping saves "
        f"{sum(saved_by)} from overturning and overturns {sum(lost_by)} that would have stood ({sum(surely)} of "
        f"them sure); {sum(further)} rotate further than without slipping, which changes the times of the impacts. "
        f"With mu_s below a/c the stack lifts from the floor in {sum(c.tilted for c in low_cells)} of "
        f"{len(low_cells)} cells."
    )
    yield from worse
    yield table(
        f"Cells of {len(holding.every)} that slip more than 1 mm, against friction that holds (1.0)",
        "friction | slip | saved by slipping | lost by slipping | .. of them sure | turn more by slipping",
        lines,
    )
    yield experiments.band(
        PLATEAU.but(duration=10.0),
        quantity="rotation ratio at the plateau value",
        criterion=f"it slides and turns less than the rigid block that cannot slide ({fixed:.3f})",
        holds=lambda row: row["outcome"] == "slide-rock" and row["rotation_ratio"] < fixed,
    )


def _turns_more(held: MapCell, slid: MapCell) -> bool:
    if slid.fell or held.fell:
        return slid.fell and not held.fell
    ratio = slid.row["rotation_ratio"]
    return bool(ratio > 0.01 and ratio > LARGER * held.row["rotation_ratio"])


@claim(
    "5.2",
    "the body is less accelerated, leading to a smaller rotation phi if tilting. With the same "
    "displacement amplitude A, the motion of the body becomes less critical",
    bounds=f"mu_s below a/c = {WIDTH_OVER_HEIGHT:.3f}",
)
def same_amplitude(experiments: Experiments) -> Evidence:
    """Amplitudes from 50 to 200 mm at the paper's frequency with four frictions, rigid stack."""
    amplitudes = np.array([round(0.05 + 0.01 * n, 3) for n in range(16)])  # m
    curves = {}
    for static, kinetic in ((1.0, 1.0), (0.4, 0.2), (0.3, 0.15), (0.25, 0.125)):
        name = f"mu {static:g}/{kinetic:g}"
        group = [
            STACK.but(
                FOR_MAPS,
                mu_static=static,
                mu_kinetic=kinetic,
                amplitude=float(one),
                duration=15.0,
                what=f"{name}, {1e3 * one:.0f} mm at 6.928 rad/s",
            )
            for one in amplitudes
        ]
        curves[name] = np.array([capped_ratio(row) for row in experiments.rows(group, also_failed=True)])
        yield group[-1]
        if static < 1.0:
            yield at_most(
                f"{name}: largest excess of its rotation ratio over that without slipping",
                np.nanmax(curves[name] - curves["mu 1/1"]),
                0.05,
                inside=static < WIDTH_OVER_HEIGHT,
            )
    held = curves["mu 1/1"]
    at_100 = held[amplitudes == 0.1].item()
    further = ", ".join(
        f"{np.sum(values > held * LARGER + 0.01)} ({name})"
        for name, values in curves.items()
        if name != "mu 1/1"
    )
    yield (
        "The stack rotates further than with friction that holds (1.0) at "
        f"{further}, of {amplitudes.size} amplitudes each. It overturns at {np.sum(held >= 1.0)} with friction that "
        f"holds and at {np.sum(curves['mu 0.4/0.2'] >= 1.0)} with 0.4/0.2. With mu 0.25/0.125, below "
        f"a/c, its largest rotation is {curves['mu 0.25/0.125'].max():.2g} of beta."
    )
    yield draw_curves(
        "same-amplitude",
        "Largest rotation over the slenderness angle (1: overturned) over the floor's amplitude "
        "at 6.928 rad/s; rigid stack.",
        [
            PlottedLine(x=1e3 * amplitudes, y=values, label=name, style="o-")
            for name, values in curves.items()
        ],
        x_label="amplitude A [mm]",
        y_label="rotation ratio [-]",
    )
    yield experiments.band(
        STACK.but(amplitude=0.1, duration=8.0),
        quantity="rotation ratio at 100 mm, mu 0.4/0.2",
        criterion=f"no more than the rigid stack that cannot slide ({at_100:.3f})",
        holds=lambda row: row["rotation_ratio"] <= at_100 * LARGER,
    )
