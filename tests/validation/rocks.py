"""Bodies on a shake table: overturned or stood, under recorded motions of the table.

On which points a rock stood on its pedestal is not known, so blocks of many slenderness angles, with several losses at
an impact and several cambers of the base, are tried; mass centre and inertia are measured. Each record is predicted by
the vote of the blocks that fit the others (`vote`). Beside it, fitted and judged on the same tests: thresholds on the
peak velocity and on the response of one oscillator, the twin on the same table.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from evidence.findings import Finding, prediction
from validation import drawings, shake_tests
from validation.bodies import rigid_case, specimen
from validation.experiments import Experiment, Predictor
from validation.vote import Block, Vote, brier, by_threshold, probabilities, with_neighbours

from fem.case.case import Case
from fem.case.validation import CaseError
from fem.model.container import Container
from fem.model.model import build_model
from fem.records.spectrum import evenly_sampled, response_spectrum
from fem.results.outcome import Outcome
from fem.run.simulation import run_without_history
from fem.runtime.arrays import BoolArray, FloatArray
from fem.runtime.threads import cores
from fem.study.runner import Runner
from fem.study.workers import LocalWorkers
from mesh.errors import MeshError

DENSITY = 2000.0  #: of a block, which is as deep as this asks [kg/m3]
ANGLES = 25  #: of slenderness, evenly over their range
RESTITUTIONS = (1.0, 0.95, 0.9, 0.85)  #: over Housner's
UPLIFTS, DAMPINGS = (0.02, 0.04, 0.06), (0.05, 0.1)  #: of cambered bases [rad], [-]
ELEMENTS = 6  #: across a cambered base
SHARP, CAMBERED = "sharp corners", "sharp corners and cambered bases"
PERIODS, RATIOS = np.geomspace(0.2, 2.0, 24), (0.05, 0.1, 0.2)  #: of oscillators [s], [-]
LEAST_AGREEMENT, SHARE_WITHIN, UNSURE_SHARE = 0.82, 0.08, 0.5
AGREED = 0.95  #: share of the votes from which the blocks agree
DESCRIBED = Experiment(
    name="rocks",
    title=shake_tests.ROCKS_TITLE,
    source=shake_tests.ROCKS_SOURCE,
    licence=shake_tests.ROCKS_LICENCE,
    tests=0,
    fitted="slenderness angle, loss at an impact, camber of the base",
)


def compute(folder: Path | None) -> Experiment:
    """Predict each record by a fit on the others, or those set apart by a fit on the rest, for every specimen."""
    if folder is None:
        return replace(
            DESCRIBED, not_computed="the motions are not part of the program: name their folder with --data"
        )
    series = shake_tests.read_series(folder)
    tried = blocks(series.body)
    with LocalWorkers(cores()) as workers_of:
        runner = Runner(workers_of=workers_of)
        count = len(series.tests)
        pairs = [(block, number) for block in tried for number in range(count)]
        outcomes = runner.each("runs of blocks on the table", pairs, partial(falls, series))
    rows = [outcomes[first : first + count] for first in range(0, len(outcomes), count)]
    possible = [block for block, row in zip(tried, rows, strict=True) if None not in row]
    shares = with_neighbours(possible, np.array([row for row in rows if None not in row], dtype=bool))
    sharp = np.array([block.uplift == 0.0 for block in possible])
    records = np.unique([test.record for test in series.tests], return_inverse=True)[1]
    every = np.ones(len(series.tests), dtype=bool)
    fitted = np.array([test.fitted for test in series.tests])
    targets = ~fitted if series.set_apart else every
    sampled = [evenly_sampled(test.times, test.acceleration) for test in series.tests]
    spectra = [
        [response_spectrum(step, values, PERIODS, ratio) for step, values in sampled] for ratio in RATIOS
    ]
    #: measures of strength on which a threshold is fitted, each (tests,), by the predictor that chooses among them
    measures = {
        "threshold on the peak velocity": [np.array([test.peak_velocity for test in series.tests])],
        "threshold on the response of one oscillator": [
            column for values in spectra for column in np.array(values).T
        ],
    }
    fits, findings, figures, others = [], [], [], []
    for number, name in enumerate(series.specimens):
        overturned = np.array([test.overturned[number] for test in series.tests])
        vote = Vote(falls={SHARP: shares[sharp], CAMBERED: shares}, overturned=overturned, records=records)
        votes = vote.predicted(fitted, targets) if series.set_apart else vote.by_record(every, vote.predicted)
        fits.append(f"{name}: {_described(vote, possible, fitted)}")
        findings += _findings(name, votes, overturned[targets], judged=not series.own)
        tests = [test for test, target in zip(series.tests, targets, strict=True) if target]
        figures.append(drawings.shaken(name, tests, probabilities(votes), overturned[targets]))
        others.append(_scores(series, number, fitted, targets, vote, measures))
    scores = [(name, ", ".join(f"{score[name]:.2f}" for score in others)) for name in others[0]]
    return Experiment(
        name=DESCRIBED.name,
        title=series.title,
        source=series.source,
        licence=series.licence,
        tests=int(targets.sum()),
        fitted=f"{DESCRIBED.fitted}, on {'the tests marked fit' if series.set_apart else 'all other records'}; on "
        f"all that may be used: {'; '.join(fits)}",
        findings=tuple(findings),
        others=tuple(
            Predictor(
                name=name,
                agreement=agreement,
                source=SOURCES.get(name, "the same tests, fitted as the blocks are"),
            )
            for name, agreement in scores
        ),
        figures=tuple(figures),
    )


def blocks(body: shake_tests.Body) -> tuple[Block, ...]:
    """The blocks tried for a body."""
    angles = np.linspace(*body.angles, ANGLES).tolist()
    sharp = [Block(angle=angle, restitution=one) for one, angle in product(RESTITUTIONS, angles)]
    cambered = [
        Block(angle=angle, uplift=uplift, damping=damping)
        for uplift, damping, angle in product(UPLIFTS, DAMPINGS, angles)
    ]
    return (*sharp, *cambered)


def falls(series: shake_tests.Series, pair: tuple[Block, int]) -> bool | None:
    """Whether a block overturns in the test of a number; None where there is no such block, as on too round a base."""
    block, number = pair
    try:
        return overturns(series.body, block, series.tests[number])
    except (CaseError, MeshError):
        return None


def overturns(body: shake_tests.Body, block: Block, test: shake_tests.ShakeTest) -> bool:
    """Whether the program's rigid block overturns."""
    case, container = _block(body, block)
    model = build_model(case.with_motion(test.times, test.acceleration), container)
    verdict, error = run_without_history(model, None)
    if error is not None:
        raise ArithmeticError(f"{test.name}, {block.angle:g} rad: {error}")
    return verdict.outcome == Outcome.OVERTURNED


@cache
def _block(body: shake_tests.Body, block: Block) -> tuple[Case, Container]:
    """A block with the mass centre and inertia of the body, which does not slide."""
    width = 2.0 * body.centroid * math.tan(block.angle)
    size = 0.5 * body.height
    changes: dict[str, float | str | list[float]] = {}
    if block.uplift > 0.0:
        size = width / ELEMENTS
        changes = {
            "support__kind": "flat",
            "support__camber_m": 0.25 * block.uplift * width,
            "support__rocking_damping_ratio": block.damping,
        }
    elif block.restitution != 1.0:
        changes = {"contact__restitution_over_housner": block.restitution}
    case = rigid_case(
        width=width,
        height=body.height,
        element_size=size,
        container__depth_m=body.mass / (DENSITY * width * body.height),
        container__mass_kg=body.mass,
        container__centroid_m=body.centroid,
        solver__duration_s="auto",
        **changes,
    )
    columns = ELEMENTS if block.uplift > 0.0 else 1
    container = specimen(case, centroid=body.centroid, inertia_ratio=body.inertia, columns=columns)
    return case, container


def _described(vote: Vote, tried: Sequence[Block], fitted: BoolArray) -> str:
    """The family that was chosen, and means of its blocks by their weights."""
    family = vote.family(fitted)
    members = [block for block in tried if family == CAMBERED or block.uplift == 0.0]
    weights = vote.weights(family, fitted)

    def mean(value: Callable[[Block], float]) -> float:
        return float(weights @ np.array([value(block) for block in members]))

    angle = mean(lambda block: block.angle)
    scatter = math.sqrt(mean(lambda block: (block.angle - angle) ** 2))
    return (
        f"{family}, {angle:.3f} +- {scatter:.3f} rad, restitution {mean(lambda block: block.restitution):.2f} of "
        f"Housner's, {100.0 * mean(lambda block: block.uplift > 0.0):.0f} % of the weight on cambered bases"
    )


def _findings(name: str, votes: FloatArray, overturned: BoolArray, *, judged: bool) -> list[Finding]:
    """Measured and predicted outcomes of a specimen: votes and outcomes, (n,) each; own tests have no criteria."""
    count, chances = votes.size, probabilities(votes)
    wrong = (chances > 0.5) != overturned
    agreement, share, seen = 1.0 - wrong.mean(), chances.mean(), overturned.mean()
    agreed = (votes >= AGREED) | (votes <= 1.0 - AGREED)
    doubted = int((wrong & ~agreed).sum())
    constant = float(seen * (1.0 - seen))

    predicted = "share of outcomes predicted", round(float(agreement), 3), "1"
    scored = "Brier score of the probabilities", round(brier(chances, overturned), 3), "0"
    fallen = "share overturned", round(float(share), 3), round(float(seen), 3)
    unsure = "wrong predictions on which the blocks do not agree", doubted, int(wrong.sum())
    within, half = abs(share - seen) <= SHARE_WITHIN, doubted >= UNSURE_SHARE * int(wrong.sum())
    note = (
        f"they agree, with {100 * AGREED:.0f} % of the votes, on {int(agreed.sum())} of {count} tests, of which "
        f"{int((wrong & agreed).sum())} are wrong"
    )
    rows: list[tuple[tuple[str, float, float | str], str, bool, str]] = [
        (predicted, f"at least {LEAST_AGREEMENT}", bool(agreement >= LEAST_AGREEMENT), ""),
        (scored, "", True, f"{constant:.3f} where each has the probability of all"),
        (fallen, f"within {SHARE_WITHIN}", bool(within), ""),
        (unsure, "at least half", half, note),
    ]
    for low, high in ((0.0, 0.25), (0.25, 0.5), (0.5, 0.75), (0.75, 1.0)):
        band = (chances >= low) & ((chances < high) | (high == 1.0))
        what = f"overturned of {int(band.sum())} with a probability from {low:g} to {high:g}"
        counted = what, round(float(chances[band].sum()), 1), int(overturned[band].sum())
        if band.any():
            rows.append((counted, "", True, ""))
    findings = []
    for (what, value, reference), criterion, met, note in rows:
        stated: dict[str, Any] = {"criterion": criterion, "met": met} if criterion and judged else {}
        findings.append(prediction(f"{name}: {what}", value, reference=reference, note=note, **stated))
    return findings


def _scores(
    series: shake_tests.Series,
    number: int,
    fitted: BoolArray,
    targets: BoolArray,
    vote: Vote,
    measures: dict[str, list[FloatArray]],
) -> dict[str, float]:
    """Share of the outcomes of a specimen that other predictors say, each fitted as the blocks are."""
    overturned = vote.overturned

    def by_measures(values: list[FloatArray], fit: BoolArray, wanted: BoolArray) -> FloatArray:
        return np.asarray(by_threshold(values, overturned, fit)[wanted], dtype=np.float64)

    scores = {"always stands": np.zeros(int(targets.sum()))}
    for name, values in measures.items():
        says = partial(by_measures, values)
        scores[name] = says(fitted, targets) if series.set_apart else vote.by_record(targets, says)
    every = np.array([test.overturned for test in series.tests])[targets]
    if every.shape[1] == 2:
        scores["the twin on the same table"] = every[:, 1 - number].astype(np.float64)
    if all(test.simulated for test in series.tests):
        simulated = np.array([test.simulated[number] for test in series.tests])[targets]
        scores["discrete elements in three dimensions, contact stiffness tuned on these tests"] = simulated
    return {name: float(np.mean(says == overturned[targets])) for name, says in scores.items()}


SOURCES = {
    "the twin on the same table": "the same tests; 0.87 of all 582 of the rocks",
    "discrete elements in three dimensions, contact stiffness tuned on these tests": "the authors; 0.87 and 0.90 of "
    "all 582",
}
