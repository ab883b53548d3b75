"""What the file of a study of many cases has: a heading, tables, the case it starts from, the keys that vary."""

import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import Field, Strict

from fem.case.case import Case, load_case
from fem.case.files import CASES, DEFAULT_CASE, ENSEMBLES, SWEEPS, Origin, parse_case
from fem.case.overrides import keys_in_effect
from fem.case.tables.links import ROWS
from fem.case.tables.quantities import SLIP_LIMIT
from fem.case.tables.table import CaseTable, OneLine
from fem.case.validation import CaseError, did_you_mean, problem_lines, read_table, told_as
from fem.runtime.intervals import least_draws
from fem.runtime.left import left_words
from fem.study.axes import (
    VERTICAL_FILE,
    Axis,
    AxisError,
    check_varied,
    field_of,
    first_motion,
    read_axis,
    set_axis,
)
from fem.study.derived import FREE, read_derived, value_in
from fem.study.design import (
    Ensemble,
    MapChoice,
    Perturbation,
    Sweep,
    Threshold,
    Unknown,
)
from fem.study.draws import RandomQuantity, Sampling, read_random

TableT = TypeVar("TableT", bound=CaseTable)
StudyT = TypeVar("StudyT")
ReadT = TypeVar("ReadT")


def read_study(origin: Origin, read: Callable[[dict[str, Any], Origin], StudyT]) -> StudyT:
    """Parse the file of a study, and have `read` make it; CaseError with a line for each reason why not."""
    data = parse_case(origin)
    with told_as(f"{origin.place}: ", of=CaseError):
        return read(data, origin)


def read_as(name: str, model: type[TableT], content: Mapping[str, Any]) -> TableT:
    """A table of the file, empty for the keys before the first one; CaseError with a line for each reason."""
    given, _, problems = read_table(name, model, content)
    if problems:
        raise CaseError("\n".join(problem_lines(problems)))
    return model.model_validate(given)


def split_tables(
    data: Mapping[str, Any], known: Sequence[str]
) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """The keys before the first table, and the tables; CaseError for an unknown one, or one written as a value."""
    tables = {key: value for key, value in data.items() if isinstance(value, dict)}
    heading = {key: value for key, value in data.items() if key not in tables}
    for name in tables:
        if words := left_words(f"[{name}]"):
            raise CaseError(f"[{name}] {words}")
        if name not in known:
            raise CaseError(
                f"[{name}] unknown table{did_you_mean(name, known)} (known: {', '.join(known)}); "
                'dotted keys stand in quotes, such as "contact.mu_static"'
            )
    for key in heading:
        if key in known:
            raise CaseError(f"{key} must be a table; write [{key}] above its keys")
    return heading, tables


def flat(name: str, content: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted keys, whether they were written in quotes or, as TOML would have it, as tables in tables."""
    keys: dict[str, Any] = {}
    for key, value in content.items():
        inner = {key: value}
        # A table is a range of one key, but for `vertical.scale = [1, -1]`, which TOML reads as a table, too.
        is_table = isinstance(value, dict) and not {"from", "to", "count"} & value.keys()
        if is_table and not isinstance(value.get("scale"), str):
            inner = {f"{key}.{part}": what for part, what in value.items()}
        for dotted, what in inner.items():
            if dotted in keys:
                raise CaseError(f"[{name}] {dotted} is given twice")
            keys[dotted] = what
    return keys


def base_case(
    name: str,
    changes: Mapping[str, Any],
    origin: Origin,
    motion: Mapping[str, Any] | None = None,
    varied: Iterable[str] = (),
) -> Case:
    """The case that is varied, with the keys of [set] changed; CaseError where it cannot be used.

    A file beside that of the study wins over a shipped case. `motion`: keys of the first of a set of motions; the files
    of a shipped case are then beside the study. `varied`: keys of the table [axes], for messages.
    """
    CASES.beside(name, origin)
    path = origin.folder / name
    is_file = os.path.isfile(path)
    base = load_case(path if is_file else name)
    values = flat("set", changes)
    if motion:
        values = {"motion.kind": "table"} | values | dict(motion)
        if not is_file:
            base = base.from_origin(replace(base.origin_with({}), folder=origin.folder))
    try:
        return base.with_values(values) if values else base
    except CaseError as error:
        lines = []
        for line in str(error).splitlines():  # in words of the file
            line = re.sub(r"\(--set (\S+?)=(.*)\)$", r'([set] "\1" = \2)', line)
            for key in [key for key in varied if re.search(rf"\b{key.rpartition('.')[2]}\b", line)][:1]:
                line += (
                    f"; {key!r} varies, and a key that must follow it stands in [derived] in place of [set]"
                )
            lines.append(line)
        raise CaseError("\n".join(lines)) from None


def _each_key(
    table: str, content: Mapping[str, Any], most: int, example: str, read: Callable[[str, Any], ReadT]
) -> tuple[ReadT, ...]:
    """A table of one to `most` keys, each read by `read`; CaseError with a line for each reason."""
    if not 1 <= len(content) <= most:
        raise CaseError(f"[{table}] must hold one to {most} keys, got {len(content)}; for instance {example}")
    found, problems = [], []
    for key, value in content.items():
        try:
            found.append(read(key, value))
        except AxisError as error:
            problems.append(f"[{table}] {key!r} {error}")
    if problems:
        raise CaseError("\n".join(problems))
    return tuple(found)


def _require_verticals(motions: Axis | None, varied: Iterable[str], base: Case) -> None:
    """Refuse a motion alone in a set where a key of its vertical motion varies."""
    key = next((key for key in varied if key.startswith("vertical.")), None)
    if motions is None or key is None or (not motions.following and base.has_vertical):
        return
    verticals = motions.following.get(VERTICAL_FILE, (None,) * len(motions.values))
    alone = [name for name, vertical in zip(motions.values, verticals, strict=True) if vertical is None]
    if alone:
        raise CaseError(
            f"{key!r} varies, and {alone[0]!r} has no vertical motion; give it as a pair, "
            f'["{alone[0]}", "its vertical file"]'
        )


def require_once(changes: Mapping[str, Any], varied: Sequence[str], base: Case) -> None:
    """Refuse a key of [set] that varies, and two that are one in this case: one of the two would have no effect."""
    effects = [next(iter(keys_in_effect({key: None}, base.kinds))) for key in varied]
    for key, effect in zip(varied, effects, strict=True):
        if {key, effect} & flat("set", changes).keys():
            raise CaseError(f"[set] {key!r} varies as well; take it out of [set], or do not vary it")
        if effects.count(effect) > 1 and key != effect:
            raise CaseError(f"{key!r} of a record is its {effect!r}, which varies as well; leave one out")


MOST_AXES, MOST_POINT_AXES, MOST_RANDOM = 4, 3, 8
MOST_RUNS = 1_000_000  #: of an ensemble
REPLICATES = 16
SWEEP_TABLES = ("set", "axes", "derived", "perturbation", "threshold", "maps")
ENSEMBLE_TABLES = ("set", "axes", "random", "derived")


class StudyHeading(CaseTable):
    """The keys of a study's file that stand before its first table."""

    case: str = Field(default=DEFAULT_CASE, description="a shipped case, or a file beside this file")
    title: Annotated[str, OneLine] = Field(default="", max_length=500, description="for people")
    limit_slip_m: Annotated[float, SLIP_LIMIT] | None = Field(
        default=None,
        description="slip beyond which a run does not stand in the answer, nor in the counts of draws",
    )


class EnsembleHeading(StudyHeading):
    """Those of an ensemble."""

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
    unknown_inputs: Unknown = Field(
        default="drawn",
        description='inputs that this file does not vary: "drawn" over [uncertainty] of the case | "held"',
    )


def load_sweep(name_or_path: str | Path) -> Sweep:
    """Read a sweep file, or a shipped sweep; CaseError with one line for each reason why it cannot be used."""
    return read_study(SWEEPS.find(name_or_path), _read_sweep)


def load_ensemble(name_or_path: str | Path) -> Ensemble:
    """Read an ensemble file, or a shipped one; CaseError with one line for each reason why it cannot be used."""
    return read_study(ENSEMBLES.find(name_or_path), _read_ensemble)


def _read_sweep(data: Mapping[str, Any], origin: Origin) -> Sweep:
    given, tables = split_tables(data, SWEEP_TABLES)
    heading = read_as("", StudyHeading, given)
    example = '"contact.mu_static" = [0.2, 0.3, 0.4]'
    axes = _each_key("axes", flat("axes", tables.get("axes", {})), MOST_AXES, example, _axis)
    keys, known = [axis.key for axis in axes], {axis.key: axis for axis in axes}
    motions = set_axis(axes)
    base = base_case(heading.case, tables.get("set", {}), origin, first_motion(motions), keys)
    _require_verticals(motions, keys, base)

    def check_reference(name: str) -> None:
        if not name.startswith(FREE):
            field_of(name)
        elif name not in known:
            raise AxisError("is no axis")
        if name in known and len(known[name].numbers) < len(known[name].values):
            raise AxisError("has values that are no numbers")
        if name not in known and value_in(base, name, {axis.key: axis.values[0] for axis in axes}) is None:
            way_out = "set it under [set], or refer to a key that is given there"
            raise AxisError(f"has no number in the base case {base.name!r}; {way_out}")

    derived = read_derived(flat("derived", tables.get("derived", {})), keys, check_varied, check_reference)
    require_once(tables.get("set", {}), [*keys, *derived], base)
    perturbation = read_as("perturbation", Perturbation, tables.get("perturbation", {}))
    axis_list = ", ".join(keys)
    threshold = read_as("threshold", Threshold, tables["threshold"]) if "threshold" in tables else None
    if threshold is not None:
        named, along = f"[threshold] axis {threshold.axis!r}", known.get(threshold.axis)
        if along is None:
            raise CaseError(
                f"{named} is none of the axes{did_you_mean(threshold.axis, known)} (axes: {axis_list})"
            )
        if not along.is_numeric:
            raise CaseError(f"{named} needs two or more numbers that rise")
        if any(isinstance(value, int) for value in along.values):
            raise CaseError(f"{named} takes whole numbers: there is nothing between its cells")
    sweep = Sweep(
        name=origin.name,
        text=origin.text,
        title=heading.title,
        limit_slip_m=heading.limit_slip_m,
        base=base,
        axes=axes,
        derived=derived,
        perturbation=perturbation,
        threshold=threshold,
        maps=_maps(tables.get("maps", {}), known, axis_list),
    )
    idle = list(keys)  # without an effect in any of the cases
    for case in sweep.tried(sweep.corners(listed=True), "[axes] make this cell", str):
        idle = [key for key in idle if _is_idle(case, key)]
    if idle:
        raise CaseError(
            f"[axes] {idle[0]!r} has no effect in this case, which has other options; "
            "choose the option it belongs to under [set], or leave the axis out"
        )
    return sweep


def _maps(content: Mapping[str, Any], known: Mapping[str, Axis], axis_list: str) -> MapChoice:
    if isinstance(content.get("fixed", {}), dict):
        content = {**content, "fixed": flat("maps.fixed", content.get("fixed", {}))}
    maps = read_as("maps", MapChoice, content)
    for key in (maps.x, maps.y, *maps.fixed):
        if key is not None and key not in known:
            raise CaseError(
                f"[maps] {key!r} is none of the axes{did_you_mean(key, known)} (axes: {axis_list})"
            )
    for key, value in maps.fixed.items():
        if value not in known[key].values:
            listed = ", ".join(map(str, known[key].values))
            raise CaseError(f"[maps] {key!r} has no value {value!r} (values: {listed})")
        if key in (maps.x, maps.y):
            raise CaseError(f"[maps] {key!r} cannot span the map and be fixed as well")
    if len(known) > 1 and len(known) - len(maps.fixed) < 2:
        raise CaseError("[maps] a map needs two axes that are not fixed")
    if maps.x is not None and maps.x == maps.y:
        raise CaseError(f"[maps] a map needs two axes, got {maps.x!r} twice")
    return maps


def _is_idle(case: Case, key: str) -> bool:
    (key,) = keys_in_effect({key: None}, case.kinds)
    table, _, name = key.rpartition(".")
    if key == "solver.elastic_modes":
        return case.solver.model != "reduced"
    return table not in ("", "free", *ROWS) and getattr(case, table).is_idle(name)


def _read_ensemble(data: Mapping[str, Any], origin: Origin) -> Ensemble:
    given, tables = split_tables(data, ENSEMBLE_TABLES)
    heading, derived = read_as("", EnsembleHeading, given), tables.get("derived", {})
    example = '"motion.peak_acceleration_m_s2" = { from = 2.0, to = 10.0, count = 17 }'
    rising = partial(_axis, rising=True)
    axes = _each_key("axes", tables.get("axes", {}), MOST_POINT_AXES, example, rising)
    keys = [axis.key for axis in axes]

    def drawn_key(key: str, value: Any) -> RandomQuantity:
        check_key(key)
        quantity = read_random(key, value)
        if key in keys and not quantity.spread.relative:
            raise AxisError("is an axis as well; give the scatter about its values with relative = true")
        return quantity

    def check_key(key: str) -> None:
        if not key.startswith(FREE):
            check_varied(key)

    def check_reference(name: str) -> None:
        check_key(name)
        if name.startswith(FREE) and name not in varied:
            raise AxisError("is neither an axis nor drawn")

    example = '"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2832 }'
    random = _each_key("random", tables.get("random", {}), MOST_RANDOM, example, drawn_key)
    motions = set_axis([one.choices for one in random if one.choices is not None])
    base = base_case(heading.case, tables.get("set", {}), origin, first_motion(motions), keys)
    if base.solver.model == "full":
        why = "an ensemble of the full model would take weeks"
        raise CaseError(f'[set] "solver.model" must be "rigid" or "reduced": {why}')
    varied = [*keys, *(quantity.key for quantity in random)]
    _require_verticals(motions, varied, base)
    drawn = [quantity.key for quantity in random if not quantity.spread.relative]
    require_once(tables.get("set", {}), [*keys, *drawn, *derived], base)
    draws, replicates = heading.draws, 1 if heading.sampling == "independent" else heading.replicates
    replicates = len(motions.values) if motions else replicates
    own = heading.model_dump(exclude={"case", "replicates"})
    own |= {"name": origin.name, "text": origin.text, "base": base, "axes": axes, "random": random}
    follow = read_derived(derived, varied, check_key, check_reference)
    ensemble = Ensemble(derived=follow, replicates=replicates, **own)
    if draws % replicates:
        parts = "motions equally likely" if motions else "replicates of one size"
        fit = replicates * max(draws // replicates, 1)
        raise CaseError(f"draws = {draws} do not make {replicates} {parts}; take {fit} draws")
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
    if (runs := ensemble.count * draws) > MOST_RUNS:
        raise CaseError(
            f"[axes] make {ensemble.count} points x {draws} draws = {runs} runs; at most {MOST_RUNS}"
        )
    items = ensemble.corners(drawn=[*product(*(quantity.ends for quantity in random))])
    list(ensemble.tried(items, "[axes] and [random] make this case", lambda value: f"{value:g}"))
    return ensemble


def _axis(key: str, value: Any, *, rising: bool = False) -> Axis:
    # A free variable takes any number, as the scale of a table of motion does.
    axis = replace(read_axis("motion.scale" if key.startswith(FREE) else key, value), key=key)
    if rising and any(isinstance(number, str | bool) for number in axis.values):
        raise AxisError("must hold numbers; make a file for each of its words")
    if rising and list(axis.values) != sorted(axis.values):
        raise AxisError("must rise; sort its values")
    return axis
