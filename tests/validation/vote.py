"""Fit blocks to outcomes by likelihood, and predict by their weighted vote.

Outcomes flip back and forth as the size of a block changes a little, so a block predicts of a test the share of the
blocks near it in angle that overturn. A test comes out otherwise in a share s of cases that no planar block can
predict: twins on one table differ in 0.13 of 582 tests, which is 2 s (1 - s) where each departs by itself. So a share v
is a probability of overturning s + (1 - 2 s) v. The blocks tried, weighted by the likelihoods of the tests fitted, vote
on a test that is not in the fit. Their vote is a probability in the same way, with a smaller share: the votes hold most
of such departures already, and of the 42 tests of two rocks on which they agreed to 0.05, each predicted by the other
records, none came out otherwise, (0 + 1) / (42 + 2) by the rule of succession.

Whether cambered bases vote as well is chosen among the tests of the fit: for each record by the others, by the mean
squared error of the probabilities (Brier, 1950).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fem.runtime.arrays import BoolArray, FloatArray

SHARE = 0.07  #: of the tests, which no block predicts
SHARE_OF_VOTES = 0.02  #: likewise, which no vote predicts
NEAR = 3  #: neighbours in angle on either side with which a block predicts


@dataclass(frozen=True, kw_only=True)
class Block:
    """What is tried: a block on two corners, or on a base whose moment rises over an angle."""

    angle: float  #: of slenderness [rad]
    restitution: float = 1.0  #: over Housner's, on corners
    uplift: float = 0.0  #: rotation over which the restoring moment rises, 0 on corners [rad]
    damping: float = 0.0  #: ratio of small rocking on a cambered base


@dataclass(frozen=True, kw_only=True, eq=False)
class Vote:
    """Votes of families of blocks on a series of tests of one specimen."""

    #: by family, (blocks, tests): what each predicts, from 0 (stands) to 1 (overturns)
    falls: dict[str, FloatArray]
    overturned: BoolArray  #: (tests,) measured
    records: NDArray[np.int64]  #: (tests,) number of the record of each

    def weights(self, family: str, fitted: BoolArray) -> FloatArray:
        """Likelihoods of the blocks of a family by the tests fitted, (blocks,), with the sum 1; a mask (tests,)."""
        chances = probabilities(self.falls[family][:, fitted], SHARE)
        logarithms = np.log(np.where(self.overturned[fitted], chances, 1.0 - chances)).sum(axis=1)
        weights = np.exp(logarithms - logarithms.max())
        return np.asarray(weights / weights.sum(), dtype=np.float64)

    def votes(self, family: str, fitted: BoolArray, tested: BoolArray) -> FloatArray:
        """Shares of the votes for overturning (k,) of the tests marked, by a fit on others; masks (tests,)."""
        return np.asarray(self.weights(family, fitted) @ self.falls[family][:, tested], dtype=np.float64)

    def by_record(
        self, among: BoolArray, votes_of: Callable[[BoolArray, BoolArray], FloatArray]
    ) -> FloatArray:
        """Votes (k,) on the tests marked, each by a fit on those of the other records; a mask (tests,)."""
        votes = np.full(self.overturned.size, np.nan)
        for record in np.unique(self.records[among]):
            tested = among & (self.records == record)
            votes[tested] = votes_of(among & ~tested, tested)
        return votes[among]

    def family(self, among: BoolArray) -> str:
        """The family that predicts some tests best, record by record; a mask (tests,)."""

        def score(family: str) -> float:
            votes = self.by_record(among, partial(self.votes, family))
            return brier(probabilities(votes, SHARE), self.overturned[among])

        return min(self.falls, key=score)

    def predicted(self, fitted: BoolArray, tested: BoolArray) -> FloatArray:
        """Votes (k,) of the tests marked, by the family and weights that the tests fitted give; masks (tests,)."""
        return self.votes(self.family(fitted), fitted, tested)


def with_neighbours(blocks: Sequence[Block], falling: BoolArray) -> FloatArray:
    """What each block predicts, (blocks, tests): the mean of itself and its neighbours in angle, alike otherwise.

    Of those that are alike otherwise the blocks rise in angle; which overturn is `falling`, (blocks, tests).
    """
    predictions = np.empty(falling.shape)
    alike: dict[Block, list[int]] = {}
    for number, block in enumerate(blocks):
        alike.setdefault(replace(block, angle=0.0), []).append(number)
    for row in alike.values():
        for index, number in enumerate(row):
            predictions[number] = falling[row[max(0, index - NEAR) : index + NEAR + 1]].mean(axis=0)
    return predictions


def probabilities(votes: FloatArray, share: float = SHARE_OF_VOTES) -> FloatArray:
    """Probabilities of overturning of votes, of the same shape; share: of tests that come out otherwise."""
    return np.asarray(share + (1.0 - 2.0 * share) * votes, dtype=np.float64)


def brier(probabilities: FloatArray, overturned: BoolArray) -> float:
    """Mean squared error of probabilities (n,) of outcomes (n,): 0 at best, 0.25 for one half throughout."""
    return float(np.mean((probabilities - overturned) ** 2))


def best_threshold(measures: FloatArray, overturned: BoolArray) -> tuple[int, float]:
    """The most outcomes that a threshold of a measure (n,) predicts, and the threshold, above which it overturns."""
    levels = np.sort(measures)
    between = np.concatenate([[-np.inf], 0.5 * (levels[1:] + levels[:-1]), [np.inf]])
    right = ((measures[None, :] > between[:, None]) == overturned).sum(axis=1)
    best = np.flatnonzero(right == right.max())
    middle = int(best[best.size // 2])
    return int(right[middle]), float(between[middle])


def by_threshold(measures: Sequence[FloatArray], overturned: BoolArray, fitted: BoolArray) -> BoolArray:
    """Outcomes of all tests (n,) by the threshold of the measure (n,) that fits best."""
    scores = [best_threshold(measure[fitted], overturned[fitted]) for measure in measures]
    best = max(range(len(scores)), key=lambda k: scores[k][0])
    return np.asarray(measures[best] > scores[best][1])
