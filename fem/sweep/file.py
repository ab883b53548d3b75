"""Read a sweep file: base case, axes, derived keys; every reason why it cannot be used, a line each.

The file is TOML:

    case = "seed_stack"                    # a shipped case, or a file in the folder of the sweep file
    [set]                                  # keys changed in the base case
    [axes]                                 # one to four dotted keys: a list, or { from, to, count, scale }
    [derived]                              # keys that follow, as expressions of others
    [perturbation]                         # how sure is a cell: see `perturbation`
    [threshold]                            # where the outcome changes along one axis: see `threshold`
    [maps]                                 # x, y: the axes that span them; fixed: values of others
"""

from collections.abc import Mapping
from itertools import islice, product
from pathlib import Path
from typing import Any

from pydantic import Field

from fem.batch.axes import NO_AXIS, Axis, AxisError, field_of, read_axis
from fem.batch.base_case import base_case, flat, read_as, require_once, split_tables
from fem.batch.expressions import Expression, ExpressionError, parse_expression
from fem.case.case import Case
from fem.case.files import DEFAULT_CASE, SWEEPS, Origin, parse_case
from fem.case.tables import CaseTable
from fem.case.validation import CaseError, did_you_mean
from fem.sweep.perturbation import Perturbation
from fem.sweep.plan import Derived, MapChoice, Sweep, in_order, value_in
from fem.sweep.threshold import Threshold

MOST_AXES = 4
#: cells that are built to see whether the axes make cases at all
TRIED = 64


class SweepHeading(CaseTable):
    """The keys of a sweep file that stand before its first table."""

    case: str = Field(default=DEFAULT_CASE, description="a shipped case, or a file beside the sweep file")
    title: str = Field(default="", max_length=500, description="for people")


TABLES = ("set", "axes", "derived", "perturbation", "threshold", "maps")


def load_sweep(name_or_path: str | Path) -> Sweep:
    """Read a sweep file, or a shipped sweep.

    Raises:
        CaseError: with one line for each reason why it cannot be used.
    """
    origin = SWEEPS.find(name_or_path)
    data = parse_case(origin)
    try:
        return _read(data, origin)
    except CaseError as error:
        raise CaseError("\n".join(f"{origin.place}: {line}" for line in str(error).splitlines())) from None


def _read(data: Mapping[str, Any], origin: Origin) -> Sweep:
    given, tables = split_tables(data, TABLES)
    heading = read_as("", SweepHeading, given)
    base = base_case(heading.case, tables.get("set", {}), origin)
    axes = _axes(tables.get("axes", {}))
    derived = _derived(tables.get("derived", {}), base, axes)
    varied = [axis.key for axis in axes] + [one.key for one in derived]
    require_once(tables.get("set", {}), varied)
    sweep = Sweep(
        name=origin.name,
        text=origin.text,
        title=heading.title,
        base=base,
        axes=axes,
        derived=derived,
        perturbation=read_as("perturbation", Perturbation, tables.get("perturbation", {})),
        threshold=_threshold(tables, axes),
        maps=_maps(tables.get("maps", {}), axes),
    )
    _try_cells(sweep)
    return sweep


def _axes(content: Mapping[str, Any]) -> tuple[Axis, ...]:
    given = flat("axes", content)
    if not 1 <= len(given) <= MOST_AXES:
        example = '"contact.mu_static" = [0.2, 0.3, 0.4]'
        raise CaseError(f"[axes] must hold one to {MOST_AXES} keys, got {len(given)}; for instance {example}")
    axes, problems = [], []
    for key, value in given.items():
        try:
            axes.append(read_axis(key, value))
        except AxisError as error:
            problems.append(f"[axes] {key!r} {error}")
    if problems:
        raise CaseError("\n".join(problems))
    return tuple(axes)


def _derived(content: Mapping[str, Any], base: Case, axes: tuple[Axis, ...]) -> tuple[Derived, ...]:
    given = flat("derived", content)
    axis_keys = {axis.key: axis for axis in axes}
    expressions: dict[str, Expression] = {}
    for key, text in given.items():
        place = f"[derived] {key!r}"
        try:
            field_of(key)
            if key in axis_keys:
                raise AxisError("is an axis already; it cannot follow another as well")
            if key in NO_AXIS:
                raise AxisError(f"cannot follow anything: {NO_AXIS[key]}")
            if not isinstance(text, str):
                raise AxisError(
                    f"must be an expression in quotes, got {text!r}; a fixed value goes under [set]"
                )
            expressions[key] = parse_expression(text)
        except (AxisError, ExpressionError) as error:
            raise CaseError(f"{place} {error}") from None
    for key, expression in expressions.items():
        for name in sorted(expression.keys):
            _must_have_a_value(f"[derived] {key!r}", name, base, axis_keys, expressions)
    return tuple(Derived(key=key, expression=expressions[key]) for key in in_order(expressions))


def _must_have_a_value(
    place: str, name: str, base: Case, axes: Mapping[str, Axis], derived: Mapping[str, Expression]
) -> None:
    try:
        field_of(name)
    except AxisError as error:
        raise CaseError(f"{place} refers to {name!r}, which {error}") from None
    if name in derived:
        return
    if name in axes:
        if any(isinstance(value, str | bool) for value in axes[name].values):
            raise CaseError(f"{place} refers to {name!r}, whose values are no numbers")
        return
    if value_in(base, name, {axis.key: axis.values[0] for axis in axes.values()}) is None:
        raise CaseError(
            f"{place} refers to {name!r}, which has no number in the base case {base.name!r}; "
            "set it under [set], or refer to a key that is given there"
        )


def _threshold(tables: Mapping[str, Any], axes: tuple[Axis, ...]) -> Threshold | None:
    if "threshold" not in tables:
        return None
    threshold = read_as("threshold", Threshold, tables["threshold"])
    known = {axis.key: axis for axis in axes}
    if threshold.axis not in known:
        near = did_you_mean(threshold.axis, known)
        raise CaseError(
            f"[threshold] axis {threshold.axis!r} is none of the axes{'; ' + near if near else ''} "
            f"(axes: {', '.join(known)})"
        )
    if not known[threshold.axis].is_numeric:
        raise CaseError(f"[threshold] axis {threshold.axis!r} needs two or more numbers that rise")
    if any(isinstance(value, int) for value in known[threshold.axis].values):
        raise CaseError(
            f"[threshold] axis {threshold.axis!r} takes whole numbers: nothing lies between its cells"
        )
    return threshold


def _maps(content: Mapping[str, Any], axes: tuple[Axis, ...]) -> MapChoice:
    fixed = content.get("fixed", {})
    given = dict(content) | ({"fixed": flat("maps.fixed", fixed)} if isinstance(fixed, dict) else {})
    choice = read_as("maps", MapChoice, given)
    known = {axis.key: axis.values for axis in axes}
    for key in (choice.x, choice.y, *choice.fixed):
        if key is not None and key not in known:
            near = did_you_mean(key, known)
            raise CaseError(
                f"[maps] {key!r} is none of the axes{'; ' + near if near else ''} (axes: {', '.join(known)})"
            )
    for key, value in choice.fixed.items():
        if value not in known[key]:
            listed = ", ".join(str(one) for one in known[key])
            raise CaseError(f"[maps] {key!r} has no value {value!r} (values: {listed})")
        if key in (choice.x, choice.y):
            raise CaseError(f"[maps] {key!r} cannot span the map and be fixed as well")
    if choice.x is not None and choice.x == choice.y:
        raise CaseError(f"[maps] a map needs two axes, got {choice.x!r} twice")
    return choice


def _try_cells(sweep: Sweep) -> None:
    """Make the cases at the corners of the grid, and those of every listed value, and refuse what they refuse.

    Raises:
        CaseError: one of them cannot be used, or an axis plays no part in any.
    """
    ends = [axis.values if axis.scale == "list" else (axis.values[0], axis.values[-1]) for axis in sweep.axes]
    idle = [True] * len(sweep.axes)
    for corner in islice(product(*ends), TRIED):
        point = {axis.key: value for axis, value in zip(sweep.axes, corner, strict=True)}
        try:
            case = sweep.base.with_values(sweep.values(point))
        except CaseError as error:
            where = ", ".join(f"{key} = {value}" for key, value in point.items())
            raise CaseError(f"{error}\n[axes] make this cell: {where}") from None
        for k, axis in enumerate(sweep.axes):
            idle[k] = idle[k] and _is_idle(case, axis.key)
    for axis, unused in zip(sweep.axes, idle, strict=True):
        if unused:
            raise CaseError(
                f"[axes] {axis.key!r} plays no part in this case, whose options are others; "
                "choose the option it belongs to under [set], or leave the axis out"
            )


def _is_idle(case: Case, key: str) -> bool:
    table, dot, name = key.rpartition(".")
    if not dot:
        return False
    if table == "solver" and name == "elastic_modes":
        return case.solver.model != "reduced"
    return name in getattr(case, table).idle_keys()
