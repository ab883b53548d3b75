"""Units of recorded motions and how headers spell them. A unit is never guessed: the file or its user states it."""

import re
from itertools import takewhile
from typing import NamedTuple

from fem.records.record import PLURALS, Quantity, RecordError
from fem.records.source import MotionText

STANDARD_GRAVITY = 9.80665  #: of a record in g (ISO 80000-3), not the gravity of the case [m/s2]


class Unit(NamedTuple):
    """The quantity of a unit, and its factor to SI."""

    quantity: Quantity
    factor: float


UNITS = {
    "m/s2": Unit("acceleration", 1.0),
    "g": Unit("acceleration", STANDARD_GRAVITY),
    "cm/s2": Unit("acceleration", 1e-2),
    "gal": Unit("acceleration", 1e-2),
    "mm/s2": Unit("acceleration", 1e-3),
    "mg": Unit("acceleration", 1e-3 * STANDARD_GRAVITY),
    "g/10": Unit("acceleration", 0.1 * STANDARD_GRAVITY),
    "m/s": Unit("velocity", 1.0),
    "cm/s": Unit("velocity", 1e-2),
    "mm/s": Unit("velocity", 1e-3),
    "m": Unit("displacement", 1.0),
    "cm": Unit("displacement", 1e-2),
    "mm": Unit("displacement", 1e-3),
}
#: units that headers are known to give and that are not read
FOREIGN = (
    "in", "ft", "in/s2", "ft/s2", "%g", "in/s", "ft/s", "counts", "volts", "v", "mv", "h", "hz", "%", "rad/s",
    "deg", "d",
)  # fmt: skip
#: units of time, and of rates, to s and 1/s
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
RATES = {"hz": 1.0, "khz": 1e3}
SPELLED = {unit: unit for unit in (*UNITS, *FOREIGN, *TIMES, *RATES)} | {
    "gals": "gal", "g's": "g", "millis": "ms", "micros": "us", "μs": "us", "minute": "min", "minutes": "min",
    "mins": "min", "hour": "h", "hours": "h", "hr": "h", "hrs": "h", "day": "d", "days": "d", "hertz": "hz",
    "1/s": "hz", "sps": "hz", "samples/s": "hz", "points/s": "hz", "pts/s": "hz", "muestras/s": "hz", "count": "counts",
    "volt": "volts", "percent": "%", "%ofg": "%g", "percentg": "%g",
}  # fmt: skip
#: what a user may state; a file may also state the others
STATED = ("g", "m/s2", "cm/s2", "gal", "mm/s2", "m")
OTHERWISE = 'state it as unit = "g", "m/s2", "cm/s2", "gal" or "mm/s2" (displacements: "m")'
#: "in units of G", "UNIT: CM/SEC/SEC", "unit = gal(cm/s/s)"; "acceleration in g", where a quantity is in the line
UNITS_OF = re.compile(
    r"\b(?:units?|unidades|einheit)\b(?:\s+(?:of|is|are)\b)?\s*[:=]?\s*(.{1,80})", re.IGNORECASE
)
QUANTITY_IN = re.compile(r"\b(?:acc|vel|disp)[a-z]*\b.{0,60}?\bin\s+(\S{1,30})", re.IGNORECASE)


def unit_spelled(text: str) -> str | None:
    """The unit that a header spells, such as CM/SEC/SEC, m s-2, m_s2 or gal(cm/s/s); None for an unknown unit."""
    word = text.strip(" \t[](){}.,;:").partition("(")[0].casefold().replace("²", "2").replace("−", "-")
    word = re.sub(r"\s+|\*\*|\^|\*|·", "", word) if "_" not in word else word.replace("_", "/", 1)
    word = re.sub(r"se[cg](ond|undo)?s?", "s", word)
    word = word.replace("/s/s", "/s2").replace("s-2", "/s2").replace("s-1", "/s").replace("//", "/")
    return SPELLED.get(word)


def units_in_words(line: str) -> list[str | None]:
    """The units that a line states in words, two at most, in their order."""
    if match := UNITS_OF.search(line):
        words = [
            word for word in re.split(r"[\s,;]+", match[1]) if word.casefold() not in ("", "and", "in", "of")
        ]
        return [*takewhile(bool, map(unit_spelled, words[:2]))]
    match = QUANTITY_IN.search(line)
    unit = unit_spelled(match[1]) if match else None
    return [unit] if unit in UNITS or unit in FOREIGN else []


def settled_unit(stated: str | None, given_unit: str | None, name: str) -> tuple[str, bool]:
    """The unit of some values, and whether their file states it; refused: none, two, or one not read."""
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
    """The unit that a header spells for a quantity; RecordError: it is not known, or measures something else."""
    unit = unit_spelled(spelled)
    if unit is None:
        raise source.refused(f"the header gives {PLURALS[quantity]} in a unit that is not known")
    if unit in UNITS and UNITS[unit].quantity != quantity:
        raise source.refused(
            f"the header gives {PLURALS[quantity]} in {unit!r}, which measures {PLURALS[UNITS[unit].quantity]}"
        )
    return unit
