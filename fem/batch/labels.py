"""Keys and values of axes in words: "peak acceleration [m/s²]", "0.42 g"."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fem.assessment.motion_words import STANDARD_GRAVITY
from fem.batch.axes import MOTION_FILE, Axis
from fem.runtime.units import plain_number

#: units in which people say the values of a key: from which value on, the unit, the factor
PEOPLE = {
    "m": ((0.1, "m", 1.0), (0.0, "mm", 1e3)),
    "N": ((1e3, "kN", 1e-3),),
    "Pa": ((1e9, "GPa", 1e-9), (1e6, "MPa", 1e-6)),
}


def axis_name(axis: Axis) -> str:
    """The name of a key: `motion.peak_acceleration_m_s2` is "peak acceleration"."""
    table, _, name = axis.key.rpartition(".")
    if axis.key == MOTION_FILE:
        return "motion"
    if name == "scale_to_m_s2":  # of a record
        name = "peak_acceleration_m_s2"
    name = name.removesuffix("_" + axis.unit.replace("/", "_").replace(" ", "_")).replace("_", " ")
    before = {"vertical": "vertical ", "joints": "joint "}.get(table, "")
    return f"{before}{name}"


def axis_label(axis: Axis) -> str:
    """The name of a key with its unit: "peak acceleration [m/s²]"."""
    unit = axis.unit.replace("s2", "s²").replace("m3", "m³") or "-"
    words = all(isinstance(value, bool | str) for value in axis.values)
    return axis_name(axis) + ("" if words else f" [{unit}]")


def in_words(axis: Axis, values: Sequence[Any], figures: int = 3, *, bare: bool = False) -> str:
    """Values on an axis in their usual unit, unless `bare`: "0.5 to 0.55 g", "steel, wood"."""
    if any(isinstance(value, bool | str) for value in values):
        return ", ".join(str(value) for value in values)
    unit, factor = _unit_of_people(axis)
    words = " to ".join(plain_number(factor * value, figures) for value in values)
    return words if bare else f"{words} {unit}".strip()


def unit_in_words(axis: Axis) -> str:
    """The unit that `in_words` takes; empty for none."""
    return _unit_of_people(axis)[0]


def place_in_words(axes: Iterable[Axis], point: Mapping[str, Any]) -> str:
    """Where on some axes a point is: "mu static 0.3, width 1.1 m"."""
    return ", ".join(f"{axis_name(axis)} {in_words(axis, [point[axis.key]], 4)}" for axis in axes)


def _unit_of_people(axis: Axis) -> tuple[str, float]:
    """The usual unit and the factor from the unit of the key; it depends on the largest value."""
    largest = max((abs(value) for value in axis.values if not isinstance(value, bool | str)), default=0.0)
    if axis.unit == "m/s2" and axis.key.startswith(("motion.", "vertical.")):
        return "g", 1.0 / STANDARD_GRAVITY
    for least, unit, factor in PEOPLE.get(axis.unit, ()):
        if largest >= least:
            return unit, factor
    return axis.unit, 1.0
