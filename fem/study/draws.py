"""Random quantities of an ensemble: their distributions, and the draws.

A distribution maps a number between 0 and 1 to a value, so independent draws, a Latin hypercube and a Sobol sequence
are treated alike. Normal and lognormal distributions are cut off a few deviations from their middle.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from fem.case.case import Case
from fem.case.tables.input_ranges import MU_KINETIC, RAMP, START, STRIBECK, WEAKENING
from fem.runtime.arrays import FloatArray
from fem.study.axes import VERTICAL_FILE, Axis, AxisError, read_axis, read_inline

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
    least: float | None = Field(default=None, alias="from")  #: smallest value of a uniform or log-uniform one
    most: float | None = Field(default=None, alias="to")  #: largest value of these
    mean: float | None = None  #: of a normal one
    median: float | None = None  #: of a lognormal one
    deviation: float | None = None  #: standard deviation; of a lognormal quantity that of its logarithm
    cut: float = 3.0  #: deviations from the middle beyond which there are no values
    relative: bool = False  #: a factor on the value that the key has anyway

    @property
    def numbers(self) -> list[float]:
        """Values of the keys that the distribution needs."""
        values = self.model_dump(by_alias=True)
        return [values[name] for name in NEEDS[self.distribution]]


EVEN = Distribution(distribution="uniform")  #: of a list


@dataclass(frozen=True, kw_only=True)
class RandomQuantity:
    """A key whose value is drawn: from a distribution, or of a list, each with the same probability."""

    key: str  #: dotted; `free.NAME` for one that only derived keys refer to
    spread: Distribution = EVEN
    #: the list, such as a set of motions or the signs of one, and what follows each
    choices: Axis | None = None

    @property
    def definition(self) -> Any:
        """As the file gives it; pairs of motions as pairs."""
        if self.choices is None:
            return self.spread.model_dump(by_alias=True, exclude_none=True)
        values = self.choices.values
        verticals = self.choices.following.get(VERTICAL_FILE, (None,) * len(values))
        return [[one, above] if above else one for one, above in zip(values, verticals, strict=True)]

    @property
    def ends(self) -> tuple[Any, ...]:
        """Least and largest value that can be drawn; of a list the first and the last."""
        return tuple(self.values(np.array([0.0, 1.0])))

    def values(self, shares: FloatArray) -> list[Any]:
        """Values at given shares of probability, each between 0 and 1."""
        if self.choices is not None:
            values = self.choices.values
            return [values[min(int(share * len(values)), len(values) - 1)] for share in shares.tolist()]
        kind, (first, second) = self.spread.distribution, self.spread.numbers
        drawn: FloatArray
        if kind == "uniform":
            drawn = first + (second - first) * shares
        elif kind == "log-uniform":
            drawn = np.asarray(first * (second / first) ** shares)
        else:
            outside = ndtr(-self.spread.cut)
            normal = ndtri(outside + (1.0 - 2.0 * outside) * shares)
            drawn = first + second * normal if kind == "normal" else first * np.exp(second * normal)
        return drawn.tolist()


def read_random(key: str, entry: Any) -> RandomQuantity:
    """One entry of `[random]`: a distribution, or values that are equally likely; AxisError where it is neither."""
    if isinstance(entry, list):
        return RandomQuantity(key=key, choices=read_axis(key, entry))
    example = 'for instance { distribution = "uniform", from = 0.3, to = 0.4 }'
    if not isinstance(entry, dict):
        raise AxisError(f"must be a distribution or a list of values, got {entry!r}; {example}")
    spread = read_inline(Distribution, entry, example)
    kind, needed = spread.distribution, NEEDS[spread.distribution]
    missing = [name for name in needed if entry.get(name) is None]
    idle = [name for name in entry if any(name in names for names in NEEDS.values()) and name not in needed]
    if missing or idle:
        problem = f"needs {' and '.join(missing)}" if missing else f"has no use for {' and '.join(idle)}"
        raise AxisError(f"distribution = {kind!r} {problem}; {example}")
    first, second = spread.numbers
    if "from" in needed and not first < second:
        raise AxisError(f"from = {first:g} must be less than to = {second:g}")
    if kind == "log-uniform" and not first > 0.0:
        raise AxisError(f"from must be positive for a log-uniform distribution, got {first:g}")
    if kind == "lognormal" and not first > 0.0:
        raise AxisError(f"median must be positive, got {first:g}")
    if "deviation" in needed and not second > 0.0:
        raise AxisError(f"deviation must be positive, got {second:g}; leave the key out of [random]")
    if not 0.5 <= spread.cut <= 8.0:
        raise AxisError(f"cut must lie between 0.5 and 8 deviations, got {spread.cut:g}; 3 is usual")
    return RandomQuantity(key=key, spread=spread)


def draw_shares(
    sampling: Sampling, *, seed: int, cell: int, dimensions: int, draws: int, replicates: int, stream: int = 0
) -> FloatArray:
    """Points of the unit cube for one cell, shape (draws, dimensions), replicate after replicate.

    Every cell and every replicate has a separate stream of random numbers, given by seed, cell and replicate alone: it
    does not depend on what else is computed, in what order and on how many cores. A further stream has random numbers
    of its own, and its points in random order: two scrambled sequences in their own order depend on each other.
    """
    blocks = []
    for replicate in range(1 if sampling == "independent" else replicates):
        key = (cell, replicate, stream) if stream else (cell, replicate)
        generator = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
        if sampling == "independent":
            return generator.random((draws, dimensions))
        if sampling == "sobol":
            block = qmc.Sobol(dimensions, scramble=True, seed=generator).random(draws // replicates)
        else:
            block = qmc.LatinHypercube(dimensions, seed=generator).random(draws // replicates)
        blocks.append(generator.permutation(block) if stream else block)
    return np.concatenate(blocks)


def held_inputs(cases: Sequence[Case], varied: Collection[str]) -> str:
    """How friction falls and the motion begins in all cases: "with mu_k = mu_s/2 falling at once, no ramp".

    Keys in `varied` are not held.
    """
    contacts, friction, law = [case.contact for case in cases], "", ""
    slips, speeds = (
        {getattr(one, key) for one in contacts} for key in ("weakening_m", "stribeck_velocity_m_s")
    )
    falls = any(one.mu_kinetic < one.mu_static for one in contacts) and not {WEAKENING, STRIBECK} & {*varied}
    if falls and len(slips) == len(speeds) == 1:
        over = [f"{1e3 * slip:g} mm" for slip in slips if slip] + [f"{v:g} m/s" for v in speeds if v]
        law = f" falling over {' and '.join(over)}" if over else " falling at once"
        friction = "friction"
    ratios = [one.mu_kinetic / one.mu_static for one in contacts if one.mu_static > 0.0]
    if MU_KINETIC not in varied:
        if ratios and all(math.isclose(ratio, ratios[0], rel_tol=1e-9) for ratio in ratios):
            inverse = 1.0 / ratios[0] if ratios[0] else 0.0
            whole = inverse and math.isclose(inverse, round(inverse), rel_tol=1e-9)
            times = f"mu_s/{round(inverse)}" if whole else f"{ratios[0]:.3g} mu_s"
            friction = f"mu_k = {'mu_s' if ratios[0] == 1.0 else times}"
        elif len({one.mu_kinetic for one in contacts}) == 1:
            friction = f"mu_k = {contacts[0].mu_kinetic:g}"
    parts = [f"{friction}{law}"] * bool(friction)
    motions = [case.motion for case in cases if case.motion.kind == "harmonic"]
    ramps = {motion.ramp_cycles for motion in motions}
    if START not in varied and {motion.start for motion in motions} == {"rest"}:
        parts.append("a start at rest")
    if RAMP not in varied and len(ramps) == 1:
        parts += [f"a ramp of {cycles:g} cycles" if cycles else "no ramp" for cycles in ramps]
    return f"with {', '.join(parts)}" if parts else ""
