"""Numbers that headers state: whole words, each with the unit behind it, and what the file says of its own values.

One parser for every format: the word must be a number from end to end, so that no part of one is taken for it. A
Fortran exponent D is one; a fraction is none.
"""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from fem.records.record import Component, Direction, RecordError
from fem.records.source import MOST_SAMPLES, MotionText, as_numbers
from fem.records.units import TIMES, UNITS, unit_spelled
from fem.records.words import direction_of
from fem.runtime.arrays import FloatArray

INTERVALS = (1e-6, 10.0)  #: shortest and longest between samples [s]
NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[EeDd][-+]?[0-9]+)?"
WORD = re.compile(rf"({NUMBER})\s*(?:[\[(]?\s*([A-Za-zµμ%][^\s\[\]()]*|1/s)\s*[\])]?)?")
#: difference of a stated peak from that of the values from which they contradict each other, over the larger: far
#: above what a correction changes, far below a wrong unit
CONTRADICTION = 0.1


def measured(
    source: MotionText,
    text: str,
    what: str,
    line: int | None = None,
    *,
    units: Mapping[str, float] = TIMES,
) -> float:
    """A number of a header above zero, in the unit whose factor is 1, as it is where none stands behind the number.

    Raises:
        RecordError: about `what`: it is no number from end to end, not above zero, or in none of these units.
    """
    match = WORD.fullmatch(text.strip())
    numbers = as_numbers([match[1]]) if match else None
    if match is None or numbers is None or not numbers[0] > 0.0:
        raise source.refused(f"the header gives no {what}", line)
    unit = "" if match[2] is None else unit_spelled(match[2]) or "?"
    if unit and unit not in units:
        named = "a unit that is not known" if unit == "?" else repr(unit)
        raise source.refused(f"the header gives the {what} in {named}; known: {', '.join(units)}", line)
    return float(numbers[0]) * (units[unit] if unit else 1.0)


def whole_number(source: MotionText, text: str, what: str, line: int | None = None) -> int:
    """A count of a header; RecordError: it is no whole number above zero, or more than a file may have."""
    stripped = text.strip().removesuffix(".")
    if not stripped.isascii() or not stripped.isdigit() or len(stripped) > 9 or int(stripped) < 1:
        raise source.refused(f"the header gives no {what}", line)
    if int(stripped) > MOST_SAMPLES:
        raise source.refused(f"{stripped} as {what}; at most {MOST_SAMPLES} are read", line)
    return int(stripped)


def require_peak(
    source: MotionText, values: Sequence[FloatArray], text: str, line: int | None = None
) -> None:
    """Refuse components of which none has the peak that the file states in their unit; no number states nothing."""
    match = WORD.fullmatch(text.strip())
    numbers = as_numbers([match[1]]) if match else None
    if numbers is None or not numbers[0]:
        return
    stated = abs(float(numbers[0]))
    found = min((float(np.abs(one).max()) for one in values), key=lambda peak: abs(peak - stated))
    if abs(stated - found) > CONTRADICTION * max(stated, found):
        raise source.refused(
            f"the header states a peak of {stated:g}, and the values reach {found:g} in the same unit; one of them is "
            "wrong, or the unit, or the scale",
            line,
        )


def require_length(
    source: MotionText, length: float, count: int, step: float, line: int | None = None
) -> None:
    """Refuse a length [s] that is not that of the samples."""
    if not abs(length - count * step) <= 2.0 * step + 1e-3 * length:
        raise source.refused(
            f"the header gives a length of {length:g} s, and {count} samples {step:g} s apart take {count * step:g} s",
            line,
        )


def require_count(source: MotionText, count: int, stated: int, line: int | None = None) -> None:
    """Refuse another number of samples than the file states."""
    if count != stated:
        raise source.refused(f"the header says {stated} values, found {count}", line)


def require_interval(step: float, subject: str) -> None:
    """Refuse an interval [s] that no sensor has; the message begins with `subject`, such as "the header gives"."""
    if not INTERVALS[0] <= step <= INTERVALS[1]:
        raise RecordError(
            f"{subject} an interval of {step:g} s; it must be between {INTERVALS[0]:g} and {INTERVALS[1]:g} s"
        )


def regular_component(
    readings: FloatArray,
    step: float,
    unit: tuple[str, bool],
    *,
    name: str,
    direction: tuple[Direction | None, float] | None = None,
) -> Component:
    """A component of samples as the file gives them, `step` apart from t = 0 [s].

    The unit is as by `settled_unit`, the direction as by `direction_of`; None: by its name.
    """
    require_interval(step, "the header gives")
    along, sense = direction or direction_of(name)
    return Component(
        times=np.arange(readings.size, dtype=np.float64) * step,
        readings=readings,
        factor=sense * UNITS[unit[0]].factor,
        quantity=UNITS[unit[0]].quantity,
        unit=unit[0],
        unit_stated=unit[1],
        name=name,
        direction=along,
    )
