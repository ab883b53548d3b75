"""Random quantities of an ensemble: their distributions, and the draws.

A distribution maps a number between 0 and 1 to a value, so independent draws, a Latin hypercube and a Sobol sequence
are treated alike. Normal and lognormal distributions are cut off a few deviations from their middle.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from fem.case.case import CaseError
from fem.case.validation import requirement_of
from fem.runtime.arrays import FloatArray

Sampling = Literal["independent", "latin-hypercube", "sobol"]
#: which keys each distribution needs
NEEDS = {
    "uniform": ("from", "to"),
    "log-uniform": ("from", "to"),
    "normal": ("mean", "deviation"),
    "lognormal": ("median", "deviation"),
}


class Distribution(BaseModel):
    """`{ distribution = "uniform", from = .., to = .. }` of an ensemble file."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)

    distribution: Literal["uniform", "log-uniform", "normal", "lognormal"]
    least: float | None = Field(default=None, alias="from")
    most: float | None = Field(default=None, alias="to")
    mean: float | None = None
    median: float | None = None
    deviation: float | None = None  #: standard deviation; of a lognormal quantity that of its logarithm
    cut: float = 3.0  #: deviations from the middle beyond which there are no values
    relative: bool = False  #: a factor on the value that the key has anyway


@dataclass(frozen=True, kw_only=True)
class RandomQuantity:
    """A key whose value is drawn."""

    key: str  #: dotted; `free.NAME` for one that only derived keys refer to
    spread: Distribution

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest value that can be drawn."""
        low, high = self.values(np.array([0.0, 1.0]))
        return float(low), float(high)

    def values(self, shares: FloatArray) -> FloatArray:
        """Values at given shares of probability, each between 0 and 1."""
        spread = self.spread
        if spread.distribution in ("uniform", "log-uniform"):
            low, high = _number(spread.least), _number(spread.most)
            if spread.distribution == "uniform":
                return low + (high - low) * shares
            return np.asarray(low * (high / low) ** shares)
        outside = ndtr(-spread.cut)
        normal = ndtri(outside + (1.0 - 2.0 * outside) * shares)
        if spread.distribution == "normal":
            return np.asarray(_number(spread.mean) + _number(spread.deviation) * normal)
        return np.asarray(_number(spread.median) * np.exp(_number(spread.deviation) * normal))


def read_random(key: str, given: Any) -> RandomQuantity:
    """One entry of `[random]`.

    Raises:
        CaseError: with the reason why it cannot be used.
    """
    place = f"[random] {key!r}"
    example = 'for instance { distribution = "uniform", from = 0.3, to = 0.4 }'
    if not isinstance(given, dict):
        raise CaseError(f"{place} must be a distribution, got {given!r}; {example}")
    try:
        numbers = {
            k: float(v) if isinstance(v, int) and not isinstance(v, bool) else v for k, v in given.items()
        }
        spread = Distribution.model_validate(numbers)
    except ValidationError as error:
        reasons = [_reason(detail, given) for detail in error.errors(include_url=False)]
        raise CaseError(f"{place} {'; '.join(reasons)}; {example}") from None
    needed = NEEDS[spread.distribution]
    named = {"from": spread.least, "to": spread.most, "mean": spread.mean, "median": spread.median}
    named["deviation"] = spread.deviation
    missing = [name for name in needed if named[name] is None]
    idle = [name for name, value in named.items() if value is not None and name not in needed]
    if missing or idle:
        what = f"needs {' and '.join(missing)}" if missing else f"has no use for {' and '.join(idle)}"
        raise CaseError(f"{place} distribution = {spread.distribution!r} {what}; {example}")
    if "from" in needed and not _number(spread.least) < _number(spread.most):
        raise CaseError(f"{place} from = {spread.least:g} must be less than to = {spread.most:g}")
    if spread.distribution == "log-uniform" and not _number(spread.least) > 0.0:
        raise CaseError(f"{place} from must be positive for a log-uniform distribution, got {spread.least:g}")
    if "median" in needed and not _number(spread.median) > 0.0:
        raise CaseError(f"{place} median must be positive, got {spread.median:g}")
    if "deviation" in needed and not _number(spread.deviation) > 0.0:
        raise CaseError(
            f"{place} deviation must be positive, got {spread.deviation:g}; leave the key out of [random]"
        )
    if not 0.5 <= spread.cut <= 8.0:
        raise CaseError(f"{place} cut must lie between 0.5 and 8 deviations, got {spread.cut:g}; 3 is usual")
    return RandomQuantity(key=key, spread=spread)


def draw_shares(
    sampling: Sampling, *, seed: int, cell: int, dimensions: int, draws: int, replicates: int
) -> FloatArray:
    """Points of the unit cube for one cell, shape (draws, dimensions), replicate after replicate.

    Every cell and every replicate has a separate stream of random numbers, given by seed, cell and replicate alone: it
    does not depend on what else is computed, in what order and on how many cores.
    """
    if sampling == "independent":
        return _generator(seed, cell, 0).random((draws, dimensions))
    size = draws // replicates
    blocks = []
    for replicate in range(replicates):
        generator = _generator(seed, cell, replicate)
        if sampling == "sobol":
            blocks.append(qmc.Sobol(dimensions, scramble=True, seed=generator).random(size))
        else:
            blocks.append(qmc.LatinHypercube(dimensions, seed=generator).random(size))
    return np.concatenate(blocks)


def _generator(seed: int, cell: int, replicate: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(cell, replicate)))


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _reason(detail: Any, given: Mapping[str, Any]) -> str:
    name = ".".join(str(part) for part in detail["loc"])
    match detail["type"]:
        case "missing":
            return f"has no {name!r}"
        case "extra_forbidden":
            known = "distribution, from, to, mean, median, deviation, cut, relative"
            return f"has the unknown key {name!r} (known: {known})"
    return f"{name} {requirement_of(detail)}, got {given.get(name)!r}"
