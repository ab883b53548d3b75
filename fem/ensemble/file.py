"""Read an ensemble file: base case, axes, what is random, how it is drawn; every reason why it cannot be used.

    case = "seed_stack"                    # a shipped case, or a file in the folder of the ensemble file
    draws = 128                            # at each point
    [set]                                  # keys changed in the base case, as in a sweep file
    [axes]                                 # one: a fragility curve; two: a boundary; three: one a value of the first
    [random]                               # distributions of keys
    [derived]                              # keys that follow, as expressions of others

Beside the keys of a case, axes and draws may be variables `free.NAME`, to which derived keys refer.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import islice, product
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, Strict

from fem.batch.axes import NO_AXIS, Axis, AxisError, field_of, read_axis
from fem.batch.base_case import base_case, read_as, require_once, split_tables
from fem.batch.expressions import Expression, ExpressionError, parse_expression
from fem.case.files import DEFAULT_CASE, ENSEMBLES, Origin, parse_case
from fem.case.tables import CaseTable
from fem.case.validation import CaseError
from fem.ensemble.distributions import RandomQuantity, Sampling, read_random
from fem.ensemble.intervals import least_draws
from fem.ensemble.plan import FREE, Ensemble
from fem.sweep.plan import Derived, in_order

TABLES = ("set", "axes", "random", "derived")
MOST_AXES, MOST_RANDOM = 3, 8
MOST_RUNS = 1_000_000
TRIED = 64  #: cases that are built to see whether axes and draws make cases at all
REPLICATES = 16


class EnsembleHeading(CaseTable):
    """The keys of an ensemble file that stand before its first table."""

    case: str = Field(default=DEFAULT_CASE, description="a shipped case, or a file beside the ensemble file")
    title: str = Field(default="", max_length=500, description="for people")
    draws: Annotated[int, Strict()] = Field(default=128, ge=8, le=1_000_000, description="at each point")
    seed: Annotated[int, Strict()] = Field(default=1, ge=0, le=2**63 - 1, description="of the draws")
    sampling: Sampling = Field(default="independent", description="how the draws are spread")
    replicates: Annotated[int, Strict()] = Field(
        default=REPLICATES, ge=4, le=1000, description="of a Latin hypercube or Sobol sequence"
    )
    confidence: float = Field(default=0.95, ge=0.5, le=0.9999, description="of the intervals, two-sided")
    probability: float = Field(
        default=0.05, gt=0.0, lt=1.0, description="of overturning by which points are told apart"
    )


def load_ensemble(name_or_path: str | Path) -> Ensemble:
    """Read an ensemble file, or a shipped one.

    Raises:
        CaseError: with one line for each reason why it cannot be used.
    """
    origin = ENSEMBLES.find(name_or_path)
    data = parse_case(origin)
    try:
        return _read(data, origin)
    except CaseError as error:
        raise CaseError("\n".join(f"{origin.place}: {line}" for line in str(error).splitlines())) from None


def _read(data: Mapping[str, Any], origin: Origin) -> Ensemble:
    given, tables = split_tables(data, TABLES)
    numbers = {
        key: float(value) if key in ("confidence", "probability") and type(value) is int else value
        for key, value in given.items()
    }
    heading = read_as("", EnsembleHeading, numbers)
    base = base_case(heading.case, tables.get("set", {}), origin)
    if base.solver.model == "full":
        raise CaseError(
            '[set] "solver.model" must be "rigid" or "reduced": an ensemble of the full model would take weeks'
        )
    axes = _axes(tables.get("axes", {}))
    random = _random(tables.get("random", {}), axes)
    drawn = [one.key for one in random if not one.spread.relative]
    require_once(tables.get("set", {}), [*(axis.key for axis in axes), *drawn, *tables.get("derived", {})])
    ensemble = Ensemble(
        name=origin.name,
        text=origin.text,
        title=heading.title,
        base=base,
        axes=axes,
        random=random,
        derived=_derived(tables.get("derived", {}), [axis.key for axis in axes], [one.key for one in random]),
        draws=heading.draws,
        seed=heading.seed,
        sampling=heading.sampling,
        replicates=1 if heading.sampling == "independent" else heading.replicates,
        confidence=heading.confidence,
        probability=heading.probability,
    )
    _check_draws(ensemble)
    _try_cases(ensemble)
    return ensemble


def _axes(content: Mapping[str, Any]) -> tuple[Axis, ...]:
    if not 1 <= len(content) <= MOST_AXES:
        example = '"motion.peak_acceleration_m_s2" = { from = 2.0, to = 10.0, count = 17 }'
        raise CaseError(
            f"[axes] must hold one to {MOST_AXES} keys, got {len(content)}; for instance {example}"
        )
    axes = []
    for key, value in content.items():
        try:
            # A free variable takes any number, as the scale of a table of motion does.
            axis = replace(read_axis("motion.scale" if _is_free(key) else key, value), key=key)
        except AxisError as error:
            raise CaseError(f"[axes] {key!r} {error}") from None
        if not all(isinstance(one, float | int) and not isinstance(one, bool) for one in axis.values):
            raise CaseError(f"[axes] {key!r} must hold numbers; make a file for each of its words")
        if list(axis.values) != sorted(axis.values):
            raise CaseError(f"[axes] {key!r} must rise; sort its values")
        axes.append(axis)
    return tuple(axes)


def _random(content: Mapping[str, Any], axes: tuple[Axis, ...]) -> tuple[RandomQuantity, ...]:
    if not 1 <= len(content) <= MOST_RANDOM:
        example = '"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2832 }'
        raise CaseError(
            f"[random] must hold one to {MOST_RANDOM} keys, got {len(content)}; for instance {example}"
        )
    found = []
    for key, value in content.items():
        if not _is_free(key):
            _known_number(f"[random] {key!r}", key)
        one = read_random(key, value)
        if any(axis.key == key for axis in axes) and not one.spread.relative:
            raise CaseError(
                f"[random] {key!r} is an axis as well; give the scatter about its values with relative = true"
            )
        found.append(one)
    return tuple(found)


def _derived(content: Mapping[str, Any], axes: list[str], random: list[str]) -> tuple[Derived, ...]:
    expressions: dict[str, Expression] = {}
    for key, text in content.items():
        place = f"[derived] {key!r}"
        if key in axes or key in random:
            raise CaseError(f"{place} is an axis or drawn already; it cannot follow another as well")
        if not _is_free(key):
            _known_number(place, key)
        if not isinstance(text, str):
            raise CaseError(
                f"{place} must be an expression in quotes, got {text!r}; a fixed value goes under [set]"
            )
        try:
            expressions[key] = parse_expression(text)
        except ExpressionError as error:
            raise CaseError(f"{place} {error}") from None
    for key, expression in expressions.items():
        for name in sorted(expression.keys):
            if not _is_free(name):
                _known_number(f"[derived] {key!r} refers to {name!r}, which", name)
            elif name not in (*axes, *random, *expressions):
                raise CaseError(f"[derived] {key!r} refers to {name!r}, which is neither an axis nor drawn")
    return tuple(Derived(key=key, expression=expressions[key]) for key in in_order(expressions))


def _known_number(place: str, key: str) -> None:
    try:
        field_of(key)
    except AxisError as error:
        raise CaseError(f"{place} {error}") from None
    if key in NO_AXIS:
        raise CaseError(f"{place} cannot vary: {NO_AXIS[key]}")


def _check_draws(ensemble: Ensemble) -> None:
    draws, replicates = ensemble.draws, ensemble.replicates
    if draws % replicates:
        raise CaseError(
            f"draws = {draws} do not make {replicates} replicates of one size; "
            f"take {replicates * max(draws // replicates, 1)} draws"
        )
    size = draws // replicates
    if ensemble.sampling == "sobol" and size & (size - 1):
        raise CaseError(
            f"draws = {draws} are {replicates} replicates of {size}: a Sobol sequence is balanced for powers of two; "
            f"take {replicates * 2 ** max(size.bit_length() - 1, 1)} draws"
        )
    needed = least_draws(ensemble.probability, ensemble.confidence)
    if draws < needed:
        raise CaseError(
            f"draws = {draws} cannot show a probability of {ensemble.probability:g} with confidence "
            f"{ensemble.confidence:g}, even if nothing overturned: at least {needed} are needed"
        )
    runs = ensemble.count * draws
    if runs > MOST_RUNS:
        raise CaseError(
            f"[axes] make {ensemble.count} points x {draws} draws = {runs} runs; at most {MOST_RUNS}"
        )


def _try_cases(ensemble: Ensemble) -> None:
    """Make the cases at the ends of axes and distributions, and refuse what they refuse."""
    ends = [(axis.values[0], axis.values[-1]) for axis in ensemble.axes]
    drawn = [one.ends for one in ensemble.random]
    for corner in islice(product(*ends, *drawn), TRIED):
        point = {axis.key: value for axis, value in zip(ensemble.axes, corner, strict=False)}
        try:
            ensemble.case_of(point, list(corner[len(ends) :]))  # type: ignore[arg-type]
        except CaseError as error:
            keys = [*(axis.key for axis in ensemble.axes), *(one.key for one in ensemble.random)]
            where = ", ".join(f"{key} = {value:g}" for key, value in zip(keys, corner, strict=True))
            raise CaseError(f"{error}\n[axes] and [random] make this case: {where}") from None


def _is_free(key: str) -> bool:
    return key.startswith(FREE)
