"""Read a sweep file: base case, axes, derived keys; one line for each reason why it cannot be used."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import islice, product
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from fem.batch import study_file
from fem.batch.axes import Axis, AxisError, check_varied, field_of, first_motion, hint, read_axis
from fem.batch.derived import FREE, Derived, read_derived, value_in
from fem.case.case import Case
from fem.case.files import DEFAULT_CASE, SWEEPS, Origin
from fem.case.overrides import keys_in_effect
from fem.case.tables.links import ROWS
from fem.case.tables.quantities import SLIP_LIMIT
from fem.case.tables.table import CaseTable
from fem.case.validation import CaseError
from fem.sweep.perturbation import Perturbation
from fem.sweep.plan import MapChoice, Sweep, Threshold

MOST_AXES = 4
#: cells that are built to find bad values before anything is computed
TRIED = 64


class SweepHeading(CaseTable):
    """The keys of a sweep file that stand before its first table."""

    case: str = Field(default=DEFAULT_CASE, description="a shipped case, or a file beside the sweep file")
    title: str = Field(default="", max_length=500, description="for people")
    limit_slip_m: Annotated[float, SLIP_LIMIT] | None = Field(
        default=None, description="slip beyond which a cell does not stand in the answer"
    )
    margin: bool = Field(
        default=False, description="find the factor on the motion at which each cell overturns first"
    )


TABLES = ("set", "axes", "derived", "perturbation", "threshold", "maps")


def load_sweep(name_or_path: str | Path) -> Sweep:
    """Read a sweep file, or a shipped sweep.

    Raises:
        CaseError: with one line for each reason why it cannot be used.
    """
    return study_file.read_study(SWEEPS.find(name_or_path), _read)


def _read(data: Mapping[str, Any], origin: Origin) -> Sweep:
    given, tables = study_file.split_tables(data, TABLES)
    heading = study_file.read_as("", SweepHeading, given)
    axes = study_file.read_axes(
        study_file.flat("axes", tables.get("axes", {})),
        MOST_AXES,
        '"contact.mu_static" = [0.2, 0.3, 0.4]',
        _axis,
    )
    base = study_file.base_case(
        heading.case, tables.get("set", {}), origin, first_motion(axes), [axis.key for axis in axes]
    )
    study_file.require_verticals(axes, [axis.key for axis in axes], base)
    derived = _derived(tables.get("derived", {}), base, axes)
    varied = [axis.key for axis in axes] + [quantity.key for quantity in derived]
    study_file.require_once(tables.get("set", {}), varied, base)
    sweep = Sweep(
        name=origin.name,
        text=origin.text,
        title=heading.title,
        base=base,
        axes=axes,
        derived=derived,
        perturbation=study_file.read_as("perturbation", Perturbation, tables.get("perturbation", {})),
        threshold=_threshold(tables, axes),
        maps=_maps(tables.get("maps", {}), axes),
        limit_slip_m=heading.limit_slip_m,
        margin=heading.margin,
    )
    _try_cells(sweep)
    return sweep


def _axis(key: str, value: Any) -> Axis:
    # a free variable takes any number, as the scale of a table of motion does
    return (
        replace(read_axis("motion.scale", value), key=key) if key.startswith(FREE) else read_axis(key, value)
    )


def _derived(content: Mapping[str, Any], base: Case, axes: tuple[Axis, ...]) -> tuple[Derived, ...]:
    values = {axis.key: axis.values for axis in axes}

    def check_reference(name: str) -> None:
        if not (free := name.startswith(FREE)):
            field_of(name)
        if free and name not in values:
            raise AxisError("is no axis")
        if any(isinstance(value, str | bool) for value in values.get(name, ())):
            raise AxisError("has values that are no numbers")
        first = {key: axis_values[0] for key, axis_values in values.items()}
        if name not in values and value_in(base, name, first) is None:
            raise AxisError(
                f"has no number in the base case {base.name!r}; set it under [set], or refer to a key that is "
                "given there"
            )

    return read_derived(study_file.flat("derived", content), values, check_varied, check_reference)


def _threshold(tables: Mapping[str, Any], axes: tuple[Axis, ...]) -> Threshold | None:
    if "threshold" not in tables:
        return None
    threshold = study_file.read_as("threshold", Threshold, tables["threshold"])
    known = {axis.key: axis for axis in axes}
    if threshold.axis not in known:
        raise CaseError(
            f"[threshold] axis {threshold.axis!r} is none of the axes{hint(threshold.axis, known)} "
            f"(axes: {', '.join(known)})"
        )
    if not known[threshold.axis].is_numeric:
        raise CaseError(f"[threshold] axis {threshold.axis!r} needs two or more numbers that rise")
    if any(isinstance(value, int) for value in known[threshold.axis].values):
        raise CaseError(
            f"[threshold] axis {threshold.axis!r} takes whole numbers: there is nothing between its cells"
        )
    return threshold


def _maps(content: Mapping[str, Any], axes: tuple[Axis, ...]) -> MapChoice:
    fixed = content.get("fixed", {})
    given = dict(content) | (
        {"fixed": study_file.flat("maps.fixed", fixed)} if isinstance(fixed, dict) else {}
    )
    choice = study_file.read_as("maps", MapChoice, given)
    known = {axis.key: axis.values for axis in axes}
    for key in (choice.x, choice.y, *choice.fixed):
        if key is not None and key not in known:
            raise CaseError(
                f"[maps] {key!r} is none of the axes{hint(key, known)} (axes: {', '.join(known)})"
            )
    for key, value in choice.fixed.items():
        if value not in known[key]:
            listed = ", ".join(map(str, known[key]))
            raise CaseError(f"[maps] {key!r} has no value {value!r} (values: {listed})")
        if key in (choice.x, choice.y):
            raise CaseError(f"[maps] {key!r} cannot span the map and be fixed as well")
    if len(axes) > 1 and len(axes) - len(choice.fixed) < 2:
        raise CaseError("[maps] a map needs two axes that are not fixed")
    if choice.x is not None and choice.x == choice.y:
        raise CaseError(f"[maps] a map needs two axes, got {choice.x!r} twice")
    return choice


def _try_cells(sweep: Sweep) -> None:
    """Make the cases at the corners of the grid, and those of every listed value.

    Raises:
        CaseError: one of them cannot be used, or an axis has no effect in any.
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
                f"[axes] {axis.key!r} has no effect in this case, which has other options; "
                "choose the option it belongs to under [set], or leave the axis out"
            )


def _is_idle(case: Case, key: str) -> bool:
    (key,) = keys_in_effect({key: None}, case.kinds)
    table, _, name = key.rpartition(".")
    if key == "solver.elastic_modes":
        return case.solver.model != "reduced"
    return table not in ("", "free", *ROWS) and getattr(case, table).is_idle(name)
