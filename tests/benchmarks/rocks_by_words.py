"""Do the words hold on a shake table: of the tests that are sure to stand or fall, how many went the other way?

A rock is three bolted rigid layers with its measured mass, mass centre and moment of inertia, on two corners; each
test is run with its band, as a case of a user is. Its slenderness angle and its loss at an impact are those that
`python -m fem validate --data FOLDER` finds by likelihood from the same tests; beside them, angles fitted with
Housner's loss.

    python tests/benchmarks/rocks_by_words.py FOLDER
"""

import argparse
import math
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from measuring import Figure, at_least, at_most, report

import fem
from fem.case.case import Case
from fem.results.outcome import Outcome

sys.path.extend(str(Path(__file__).parents[1] / name) for name in ("", "rigs"))
from validation.bodies import LAYERS, layer_shares, rigid_case
from validation.rocks import DENSITY
from validation.shake_tests import Body, Series, read_series

MOST_WRONG, LEAST_DECIDED = 0.02, 0.55
Fit = tuple[float, float | None]  #: slenderness angle [rad], restitution over Housner's
#: of rock 1 and rock 2
FITS: dict[str, Sequence[Fit]] = {
    "fitted by likelihood": ((0.072, 0.93), (0.117, 0.96)),
    "fitted with Housner's loss": ((0.087, None), (0.130, None)),
}


def main() -> int:
    """Run the tests; a line for each fit."""
    parser = argparse.ArgumentParser(description="Hold the words about rocks against what they did.")
    parser.add_argument("folder", type=Path, help="with granite_rock_motions.csv.gz")
    series = read_series(parser.parse_args().folder)
    return report("Rocks on a shake table, by words", [f for name in FITS for f in figures(series, name)])


def figures(series: Series, name: str) -> list[Figure]:
    """How many are decided, and how many of these are wrong."""
    runs = [
        (rock(series.body, *fit).with_motion(test.times, test.acceleration), test.overturned[number])
        for number, fit in enumerate(FITS[name])
        for test in series.tests
    ]
    counts, wrong = Counter[str](), Counter[str]()
    again = fem.compute_many([case for case, _ in runs], band=True, margin=False)
    for run, (_, fell) in zip(again, runs, strict=True):
        verdict = run.result["verdict"]
        counts[verdict["sure"]] += 1
        wrong[verdict["sure"]] += fell != (verdict["outcome"] == Outcome.OVERTURNED)
    sure, decided = counts["sure"], counts["sure"] + counts["regime unsure"]
    return [
        at_most(f"{name}: wrong of {sure} sure", wrong["sure"] / max(sure, 1), MOST_WRONG),
        at_least(f"{name}: decided of {counts.total()}", decided / counts.total(), LEAST_DECIDED),
        Figure(f"{name}: wrong of {decided - sure} regime unsure", str(wrong["regime unsure"])),
    ]


def rock(body: Body, angle: float, restitution: float | None) -> Case:
    """The case of a rock, but for its motion."""
    width, layer = 2.0 * body.centroid * math.tan(angle), body.height / LAYERS
    shares = layer_shares(width, body.height, centroid=body.centroid, inertia_ratio=body.inertia)
    loss = {} if restitution is None else {"contact__restitution_over_housner": restitution}
    return rigid_case(
        width=width,
        height=layer,
        element_size=layer,
        container__depth_m=body.mass / (DENSITY * width * body.height),
        container__box=[{"height_m": layer, "mass_kg": float(body.mass * share)} for share in shares],
        solver__duration_s="auto",
        **loss,
    )


if __name__ == "__main__":
    sys.exit(main())
