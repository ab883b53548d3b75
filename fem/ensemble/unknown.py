"""The unknown inputs, drawn over their ranges at every draw of an ensemble.

What the file varies itself, by [axes], [random] or [derived], stays as it is there; the rest follows [uncertainty]
of the case. These draws have random numbers of their own, so those of [random] do not depend on them.
"""

from collections.abc import Iterator
from contextlib import suppress
from itertools import product

import numpy as np

from fem.batch.container_cache import PenaltyCache
from fem.batch.held import held_inputs
from fem.case.case import Case
from fem.case.tables.input_ranges import Value
from fem.case.tables.unknown_inputs import INPUTS, ranges_of
from fem.case.uncertainty import drawn_values
from fem.case.validation import CaseError
from fem.ensemble.distributions import draw_shares
from fem.ensemble.plan import Draw, Ensemble

STREAM = 1  #: of random numbers


class UnknownInputs:
    """The unknown inputs of an ensemble, and their values in each draw."""

    def __init__(self, ensemble: Ensemble) -> None:
        self._ensemble = ensemble
        self._penalties = PenaltyCache()
        cases = list(_cases(ensemble))
        varied = {axis.key for axis in ensemble.axes} | {quantity.key for quantity in ensemble.random}
        fixed = varied | {derived.key for derived in ensemble.derived}
        ranges = (interval for case in cases for interval in ranges_of(case, self._penalties.of(case)))
        drawn = {interval.key for interval in ranges if interval.drawn is not None} - fixed
        #: keys of the inputs that are drawn
        self.keys = tuple(key for key in INPUTS if key in drawn) if ensemble.unknown_inputs == "drawn" else ()
        #: what is held fixed of the others, in words
        self.held = held_inputs(cases, varied | set(self.keys))

    def draws_at(self, cell: int) -> list[Draw]:
        """The draws of a point, with the values of the unknown inputs."""
        ensemble = self._ensemble
        draws = ensemble.draws_at(cell)
        if not self.keys:
            return draws
        shares = draw_shares(
            ensemble.sampling,
            seed=ensemble.seed,
            cell=cell,
            dimensions=len(self.keys),
            draws=ensemble.draws,
            replicates=ensemble.replicates,
            stream=STREAM,
        )
        return [
            draw._replace(unknown=self._values(draw, row))
            for draw, row in zip(draws, shares.tolist(), strict=True)
        ]

    def _values(self, draw: Draw, shares: list[float]) -> dict[str, Value]:
        """Values at these shares of the ranges that a draw has; empty for a draw that cannot be made."""
        try:
            case = self._ensemble.case(draw)
            share = dict(zip(self.keys, shares, strict=True))
            ranges = ranges_of(case, self._penalties.of(case))
        except (CaseError, ValueError):
            return {}
        drawn = [interval for interval in ranges if interval.key in share]
        return drawn_values(drawn, [share[interval.key] for interval in drawn])


def _cases(ensemble: Ensemble) -> Iterator[Case]:
    """The cases in the middle and at the ends of all distributions, at the ends of the axes, those that can be made."""
    corners = product(*((axis.values[0], axis.values[-1]) for axis in ensemble.axes))
    shares = np.array([0.5, 0.0, 1.0])
    drawn = list(zip(*(quantity.values(shares) for quantity in ensemble.random), strict=True))
    for corner, values in product(corners, drawn):
        with suppress(CaseError):
            point = {axis.key: value for axis, value in zip(ensemble.axes, corner, strict=True)}
            yield ensemble.case_of(point, values)
