"""Boxes without bolts: when a loose stack moves as the one body that the paper assumes (sections 3 and 8).

Kinetic friction equals static friction in all runs: a drop would add chance to what is compared.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from evidence.findings import at_most, equal
from paper.cases import FOR_MAPS, STACK, PaperCase, friction
from paper.claims import Evidence, claim, table
from paper.dimensions import ANGULAR_FREQUENCY, PLATEAU_PEAK, STATED_PEAK, WIDTH
from paper.experiments import Experiments, capped_ratio, stands

from fem.figures.heat_map import MapAxis
from fem.study.runner import Row

FLOOR_MU = 0.4
SHARES = (0.5, 0.75, 1.0, 1.5)  #: friction between the boxes over that of the floor
STACKS = (2, 3, 4, 6)  #: boxes
PEAKS = (STATED_PEAK, PLATEAU_PEAK, 6.0)  #: [m/s2]
AS_ONE = 0.01  #: of the rotation ratio, and of the width
FEW = 0.1  #: share of cells
FREQUENCY = MapAxis(label="angular frequency [rad/s]", values=(2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 9.5))
PEAK = MapAxis(label="peak floor acceleration [m/s²]", values=(3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 9.5, 10.5, 11.5))


class BoltedAndLoose(NamedTuple):
    """A bolted and a loose stack under the same motion."""

    boxes: int
    share: float
    peak: float
    bolted: Row
    loose: Row

    @property
    def rocks(self) -> bool:
        """Whether the bolted stack does."""
        return bool(self.bolted["rotation_ratio"] > AS_ONE)

    @property
    def apart(self) -> float:
        """Largest difference of rotation ratio, slip between boxes over the width, opening over the same width [-]."""
        turned = abs(capped_ratio(self.loose) - capped_ratio(self.bolted))
        return max(turned, self.loose["max_joint_slip_m"] / WIDTH, self.loose["max_joint_opening_m"] / WIDTH)


def computed(*rows: Row) -> bool:
    """Whether none of these runs failed."""
    return all(row["status"] != "failed" for row in rows)


def bolted(boxes: int = 4, **named: float) -> PaperCase:
    """A rigid stack of which the friction on the floor does not drop."""
    what = f"{boxes} bolted boxes, {named['peak']:g} m/s²"
    return STACK.but(FOR_MAPS, friction(FLOOR_MU, FLOOR_MU), boxes=boxes, duration=10.0, what=what, **named)


def loosened(case: PaperCase, share: float, what: str) -> PaperCase:
    """The same without bolts, with this share of the floor's friction between the boxes."""
    mu = round(share * FLOOR_MU, 4)
    joints = {"container.joints": "loose", "joints.mu_static": mu, "joints.mu_kinetic": mu}
    return case.but(joints, what=what)


@claim(
    "3",
    "the stack remains rigid, “whipping” is excluded",
    bounds="boxes without bolts, at least the friction of the floor between them, and no rocking with bolts",
)
def loose_stack_moves_as_one(experiments: Experiments) -> Evidence:
    """Bolted and loose stacks of two, three, four and six rigid boxes under three peaks at 6.928 rad/s; friction on the
    floor 0.4, between the boxes 0.2 to 0.6. A loose stack moves as one if its rotation ratio is within 0.01 of that
    with bolts and no joint slides or opens by more than 1 % of the width.
    """
    points = [(boxes, share, peak) for peak in PEAKS for share in SHARES for boxes in STACKS]
    plain = {key: bolted(key[0], peak=key[2], frequency=ANGULAR_FREQUENCY) for key in points}
    loose = {
        key: loosened(
            plain[key], key[1], f"{key[0]} loose boxes, {key[1]:g} of the friction, {key[2]:g} m/s²"
        )
        for key in points
    }
    every = experiments.rows([*plain.values(), *loose.values()], also_failed=True)  # one batch
    halves = every[: len(points)], every[len(points) :]
    pairs = [
        BoltedAndLoose(*key, *rows) for key, *rows in zip(points, *halves, strict=True) if computed(*rows)
    ]
    for rocks, which in ((False, "do not rock"), (True, "rock")):
        for share in SHARES:
            group = [pair for pair in pairs if pair.share == share and pair.rocks is rocks]
            what = f"largest difference of stacks that {which} when bolted, {share:g} of the floor's friction"
            apart = max((pair.apart for pair in group), default=math.nan)
            yield at_most(what, apart, AS_ONE, inside=not rocks and share >= 1.0)
    as_one = [pair for pair in pairs if pair.apart <= AS_ONE]
    rocking = [pair for pair in pairs if pair.rocks]
    flat = [pair for pair in pairs if not pair.rocks and pair.share >= 1.0]
    most = max(pairs, key=lambda pair: pair.loose["max_joint_slip_m"])
    yield (
        f"{len(as_one)} of {len(pairs)} loose stacks move as one. Of those that do not rock when bolted, "
        f"{_count(flat)} do so where the friction between the boxes is at least that on the floor; with less, boxes "
        "slide on one another first. A rocking stack needs more, since an impact shears its joints beyond that: with "
        f"the friction of the floor {_count([pair for pair in rocking if pair.share == 1.0])} move as one, with one "
        f"and a half times that {_count([pair for pair in rocking if pair.share == 1.5])}; in the others joints open. "
        f"The largest slip between boxes is {1e3 * most.loose['max_joint_slip_m']:.0f} mm ({most.boxes} boxes, "
        f"{most.share:g} of the friction, {most.peak:g} m/s²)."
    )
    yield from (loose[4, share, PLATEAU_PEAK] for share in SHARES)
    yield table(
        "Bolted and loose stacks, friction between the boxes over that on the floor",
        "boxes | friction | peak [m/s²] | rotation ratio, bolted | loose | slip between boxes [mm] | opening [mm] | "
        "slip on the floor, bolted [mm] | loose [mm] | outcome, loose",
        [
            (
                *pair[:3],
                *(row["rotation_ratio"] for row in (pair.bolted, pair.loose)),
                *(1e3 * pair.loose[name] for name in ("max_joint_slip_m", "max_joint_opening_m")),
                *(1e3 * row["max_slip_m"] for row in (pair.bolted, pair.loose)),
                pair.loose["outcome"],
            )
            for pair in pairs
        ],
    )


def _count(pairs: Sequence[BoltedAndLoose]) -> str:
    return f"{sum(pair.apart <= AS_ONE for pair in pairs)} of {len(pairs)}"


@claim(
    "8",
    "Slipping is not affected by the number of boxes in the stack, only by the base acceleration "
    "and the coefficient of friction",
    bounds="slip of the lowest of the weak joints, as long as nothing lifts",
)
def slip_between_loose_boxes(experiments: Experiments) -> Evidence:
    """Two, three and four loose boxes with a friction of 0.2 between them and 0.4 on the floor: the largest slip
    between boxes, against the slip of one box on a floor with a friction of 0.2.
    """
    share, lines = 0.5, []
    for peak in (PLATEAU_PEAK, 5.0, 6.0):
        mu = share * FLOOR_MU
        alone = STACK.but(
            FOR_MAPS, friction(mu, mu), boxes=1, duration=10.0, peak=peak, frequency=ANGULAR_FREQUENCY
        )
        slider = experiments.row(alone)["max_slip_m"]
        for boxes in STACKS[:3]:  # six rock
            what = f"{boxes} loose boxes, 0.2 between them, {peak:g} m/s²"
            case = loosened(bolted(boxes, peak=peak, frequency=ANGULAR_FREQUENCY), share, what)
            row = experiments.row(case)
            ratio = row["max_joint_slip_m"] / slider
            yield equal(
                f"slip over that of one box, {what}", ratio, 1.0, 0.05, inside=row["rotation_ratio"] < AS_ONE
            )
            slips = 1e3 * row["max_joint_slip_m"], 1e3 * slider
            lines.append((boxes, peak, *slips, row["rotation_ratio"], row["outcome"]))
            yield case
    yield (
        f"The largest slip between boxes is {lines[0][2]:.0f} mm of two boxes and {lines[2][2]:.0f} mm of four at "
        f"{PLATEAU_PEAK:g} m/s², against {lines[0][3]:.0f} mm of one box on such a floor. Where it does not rock, a "
        "stack slides on its lowest box as that box on the floor. What limits it is the width: a box slides up to "
        f"{max(line[2] for line in lines):.0f} mm of the {1e3 * WIDTH / 2:.0f} mm after which it loses its footing."
    )
    yield table(
        "Largest slip between loose boxes, and of one box on a floor with the same friction",
        "boxes | peak [m/s²] | slip between boxes [mm] | slip of one box [mm] | rotation ratio [-] | outcome",
        lines,
    )


@claim(
    "3",
    "either gapping between the boxes is counterbalanced by the self-weight or the boxes are bolted",
    bounds="the friction of the floor between the boxes, too",
)
def loose_or_bolted_outcome(experiments: Experiments) -> Evidence:
    """Stack of four over frequency and peak acceleration, 72 cells: does it end otherwise without bolts? Friction on
    the floor 0.4; between the boxes the same, and half of it.
    """
    cells = [(peak, frequency) for peak in PEAK.values for frequency in FREQUENCY.values]
    plain = [bolted(peak=peak, frequency=frequency) for peak, frequency in cells]
    loose = {
        share: [loosened(case, share, f"loose, {share:g} of the friction") for case in plain]
        for share in (1.0, 0.5)
    }
    experiments.rows([*plain, *loose[1.0], *loose[0.5]], also_failed=True)  # one batch
    lines = []
    for share, cases in loose.items():
        pairs = [
            (plain_row, loose_row)
            for plain_row, loose_row in zip(
                *(experiments.rows(group, also_failed=True) for group in (plain, cases)), strict=True
            )
            if computed(plain_row, loose_row)
        ]
        fell = np.array([[not stands(row) for row in pair] for pair in pairs])
        new, gone = int((~fell[:, 0] & fell[:, 1]).sum()), int((fell[:, 0] & ~fell[:, 1]).sum())
        what = f"share of the cells that change between standing and overturning, {share:g} of the floor's friction"
        yield at_most(what, (new + gone) / len(pairs), FEW, inside=share == 1.0)
        lines.append((share, len(pairs), int(fell[:, 0].sum()), int(fell[:, 1].sum()), new, gone))
    (_, count, before, after, new, gone), (*_, weak, weak_new, weak_gone) = lines
    yield (
        f"Of {count} cells {before} overturn with bolts and {after} without, with the friction of the floor between "
        f"the boxes: {new} only without bolts, {gone} only with them. With half of it {weak} overturn, {weak_new} only "
        f"without bolts and {weak_gone} only with them: a box slides off, or the sliding keeps the stack from rocking."
    )
    yield from (loose[1.0][0], loose[0.5][0])
    yield table(
        "Cells that overturn, stack of four",
        "friction between over on the floor | cells | with bolts | without | only without | only with",
        lines,
    )
