"""Read an ensemble file: base case, axes, random quantities, sampling; refuse it with all reasons.

Beside the keys of a case, axes and draws may be variables `free.NAME`, to which derived keys refer.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from itertools import islice, product
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, Strict

from fem.batch import study_file
from fem.batch.axes import Axis, AxisError, check_varied, first_motion, read_axis
from fem.batch.derived import FREE, Derived, read_derived
from fem.case.files import DEFAULT_CASE, ENSEMBLES, Origin
from fem.case.tables.quantities import SLIP_LIMIT
from fem.case.tables.table import CaseTable
from fem.case.validation import CaseError
from fem.ensemble.distributions import RandomChoice, RandomQuantity, Sampling, read_random
from fem.ensemble.plan import Ensemble, Unknown, sets_among
from fem.runtime.intervals import least_draws

TABLES = ("set", "axes", "random", "derived")
MOST_AXES, MOST_RANDOM = 3, 8
MOST_RUNS = 1_000_000
TRIED = 64  #: cases that are built to find bad values before anything is computed
REPLICATES = 16
EXAMPLE = '"motion.peak_acceleration_m_s2" = { from = 2.0, to = 10.0, count = 17 }'


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
        default=0.05, gt=0.0, lt=1.0, description="of overturning, to which the points are compared"
    )
    limit_slip_m: Annotated[float, SLIP_LIMIT] | None = Field(
        default=None, description="slip beyond which a draw does not stand, and counts as one that overturned"
    )
    unknown_inputs: Unknown = Field(
        default="drawn",
        description='inputs that this file does not vary: "drawn" over [uncertainty] of the case | "held"',
    )
    copy_motions: bool | None = Field(
        default=None, description="copy the motion files into the results; default: sets of up to 100"
    )


def load_ensemble(name_or_path: str | Path) -> Ensemble:
    """Read an ensemble file, or a shipped one.

    Raises:
        CaseError: with one line for each reason why it cannot be used.
    """
    return study_file.read_study(ENSEMBLES.find(name_or_path), _read)


def _read(data: Mapping[str, Any], origin: Origin) -> Ensemble:
    heading_keys, tables = study_file.split_tables(data, TABLES)
    heading = study_file.read_as("", EnsembleHeading, heading_keys)
    axes = study_file.read_axes(tables.get("axes", {}), MOST_AXES, EXAMPLE, _axis)
    random = _random(tables.get("random", {}), axes)
    sets = sets_among(random)
    base = study_file.base_case(
        heading.case, tables.get("set", {}), origin, first_motion(sets), [axis.key for axis in axes]
    )
    if base.solver.model == "full":
        raise CaseError(
            '[set] "solver.model" must be "rigid" or "reduced": an ensemble of the full model would take weeks'
        )
    varied_keys = [*(axis.key for axis in axes), *(quantity.key for quantity in random)]
    study_file.require_verticals(sets, varied_keys, base)
    drawn = [quantity.key for quantity in random if not quantity.relative]
    replicates = 1 if heading.sampling == "independent" else heading.replicates
    varied = [*(axis.key for axis in axes), *drawn, *tables.get("derived", {})]
    study_file.require_once(tables.get("set", {}), varied, base)
    ensemble = Ensemble(
        name=origin.name,
        text=origin.text,
        title=heading.title,
        base=base,
        axes=axes,
        random=random,
        derived=_derived(tables.get("derived", {}), varied_keys),
        draws=heading.draws,
        seed=heading.seed,
        sampling=heading.sampling,
        replicates=len(sets[0].values) if sets else replicates,
        confidence=heading.confidence,
        probability=heading.probability,
        unknown_inputs=heading.unknown_inputs,
        limit_slip_m=heading.limit_slip_m,
        copy_motions=heading.copy_motions,
    )
    _check_draws(ensemble)
    _try_cases(ensemble)
    return ensemble


def _axis(key: str, value: Any) -> Axis:
    # A free variable takes any number, as the scale of a table of motion does.
    axis = replace(read_axis("motion.scale" if key.startswith(FREE) else key, value), key=key)
    if not all(isinstance(number, float | int) and not isinstance(number, bool) for number in axis.values):
        raise AxisError("must hold numbers; make a file for each of its words")
    if list(axis.values) != sorted(axis.values):
        raise AxisError("must rise; sort its values")
    return axis


def _random(content: Mapping[str, Any], axes: tuple[Axis, ...]) -> tuple[RandomQuantity | RandomChoice, ...]:
    if not 1 <= len(content) <= MOST_RANDOM:
        example = '"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2832 }'
        raise CaseError(
            f"[random] must hold one to {MOST_RANDOM} keys, got {len(content)}; for instance {example}"
        )
    quantities: list[RandomQuantity | RandomChoice] = []
    for key, value in content.items():
        try:
            _check_key(key)
            quantity = read_random(key, value)
        except AxisError as error:
            raise CaseError(f"[random] {key!r} {error}") from None
        if any(axis.key == key for axis in axes) and not quantity.relative:
            raise CaseError(
                f"[random] {key!r} is an axis as well; give the scatter about its values with relative = true"
            )
        quantities.append(quantity)
    return tuple(quantities)


def _derived(content: Mapping[str, Any], varied: Collection[str]) -> tuple[Derived, ...]:
    def check_reference(name: str) -> None:
        if not name.startswith(FREE):
            check_varied(name)
        elif name not in varied:
            raise AxisError("is neither an axis nor drawn")

    return read_derived(content, varied, _check_key, check_reference)


def _check_key(key: str) -> None:
    if not key.startswith(FREE):
        check_varied(key)


def _check_draws(ensemble: Ensemble) -> None:
    draws, replicates = ensemble.draws, ensemble.replicates
    if draws % replicates:
        raise CaseError(
            f"draws = {draws} do not make {replicates} "
            f"{'replicates of one size' if ensemble.motions is None else 'motions equally likely'}; "
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
    """Make the cases at the ends of axes and distributions; raises a CaseError for one that cannot be used."""
    ends = [(axis.values[0], axis.values[-1]) for axis in ensemble.axes]
    drawn = [quantity.ends for quantity in ensemble.random]
    for corner in islice(product(*ends, *drawn), TRIED):
        point = {axis.key: value for axis, value in zip(ensemble.axes, corner, strict=False)}
        try:
            ensemble.case_of(point, corner[len(ends) :])
        except CaseError as error:
            keys = [*(axis.key for axis in ensemble.axes), *(quantity.key for quantity in ensemble.random)]
            where = ", ".join(
                f"{key} = {value if isinstance(value, str) else format(value, 'g')}"
                for key, value in zip(keys, corner, strict=True)
            )
            raise CaseError(f"{error}\n[axes] and [random] make this case: {where}") from None
