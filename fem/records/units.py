"""Units of recorded motions and how headers spell them. A unit is never guessed: the file or its user states it."""

import re
from dataclasses import dataclass

from fem.records.record import PLURALS, Quantity, RecordError
from fem.records.source import MotionText

STANDARD_GRAVITY = 9.80665  #: of a record in g (ISO 80000-3), not the gravity of the case [m/s2]


@dataclass(frozen=True, kw_only=True)
class Unit:
    """The quantity of a unit, and its factor to SI."""

    quantity: Quantity
    factor: float


def _unit(quantity: Quantity, factor: float) -> Unit:
    return Unit(quantity=quantity, factor=factor)


UNITS = {
    "m/s2": _unit("acceleration", 1.0),
    "g": _unit("acceleration", STANDARD_GRAVITY),
    "cm/s2": _unit("acceleration", 1e-2),
    "gal": _unit("acceleration", 1e-2),
    "mm/s2": _unit("acceleration", 1e-3),
    "mg": _unit("acceleration", 1e-3 * STANDARD_GRAVITY),
    "g/10": _unit("acceleration", 0.1 * STANDARD_GRAVITY),
    "m/s": _unit("velocity", 1.0),
    "cm/s": _unit("velocity", 1e-2),
    "mm/s": _unit("velocity", 1e-3),
    "m": _unit("displacement", 1.0),
    "cm": _unit("displacement", 1e-2),
    "mm": _unit("displacement", 1e-3),
}
#: units that headers are known to give and that are not read
FOREIGN = ("in", "ft", "in/s2", "ft/s2", "%g", "in/s", "ft/s")
TIMES = {"s": "s", "seconds": "s", "ms": "ms", "us": "us", "min": "min"}
SPELLED = {unit: unit for unit in (*UNITS, *FOREIGN)} | {"gals": "gal"} | TIMES
#: what a user may state; a file may also state the others
STATED = ("g", "m/s2", "cm/s2", "gal", "mm/s2", "m")
OTHERWISE = 'state it as unit = "g", "m/s2", "cm/s2", "gal" or "mm/s2" (displacements: "m")'


def unit_spelled(text: str) -> str | None:
    """The unit that a header spells, such as CM/SEC/SEC, m s-2 or m_s2; None for an unknown unit."""
    word = text.strip().casefold().replace("²", "2").replace("−", "-")
    word = re.sub(r"\s+|\*\*|\^|\*|·", "", word) if "_" not in word else word.replace("_", "/", 1)
    word = re.sub(r"sec(ond)?s?", "s", word)
    word = word.replace("/s/s", "/s2").replace("s-2", "/s2").replace("s-1", "/s").replace("//", "/")
    return SPELLED.get(word)


def settled_unit(stated: str | None, given_unit: str | None, name: str) -> tuple[str, bool]:
    """The unit of some values, and whether their file states it.

    Raises:
        RecordError: neither states one, both do and they differ, or the file's is not read.
    """
    if stated is None and given_unit is None:
        raise RecordError(f"{name}: the file does not state the unit of its values; {OTHERWISE}")
    if stated is not None and stated not in UNITS:
        raise RecordError(
            f"{name}: the header gives {stated!r}, which is not read; convert the values to one of {', '.join(STATED)}"
        )
    if stated is not None and given_unit is not None and UNITS[stated] != UNITS[given_unit]:
        raise RecordError(
            f"{name}: the file states {stated!r}, but unit = {given_unit!r} is given; correct one of them"
        )
    unit = stated or given_unit or ""
    return unit, stated is not None


def unit_in_header(source: MotionText, spelled: str, quantity: Quantity) -> str:
    """The unit that the header of a file spells for a quantity.

    Raises:
        RecordError: it is none that is known, or measures something else.
    """
    unit = unit_spelled(spelled)
    if unit is None:
        raise source.refused(f"the header gives {PLURALS[quantity]} in a unit that is not known")
    if unit in UNITS and UNITS[unit].quantity != quantity:
        raise source.refused(
            f"the header gives {PLURALS[quantity]} in {unit!r}, which measures {PLURALS[UNITS[unit].quantity]}"
        )
    return unit
