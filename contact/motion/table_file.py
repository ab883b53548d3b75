"""Motion tables from text files: two columns, time [s] and value, separated by commas, semicolons or blanks.

`#` starts a comment; the first line may be a header. A unit in the header must be the unit that the case gives,
because a table in g that is read as m/s2 is hard to notice. The size of the file is checked before it is read.
"""

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np

from contact.motion.table import TableMotion

Unit = Literal["m/s2", "g", "m"]

STANDARD_GRAVITY = 9.80665  #: of a record in g (ISO 80000-3), not the gravity of the case [m/s2]
LARGEST_FILE = 64 * 2**20  #: [bytes]: three million samples and more

# Quantity of each unit, and its factor to SI.
UNITS: dict[str, tuple[str, float]] = {
    "m/s2": ("acceleration", 1.0),
    "g": ("acceleration", STANDARD_GRAVITY),
    "m": ("displacement", 1.0),
}
# Spellings in headers; those of `REFUSED` are recognised only to be refused.
SPELLINGS = dict.fromkeys(
    ("m/s2", "m/s^2", "m/s**2", "m/s²", "m/sec2", "m/sec^2", "m_s2", "m s-2", "m s^-2"), "m/s2"
)
REFUSED = "mm cm in ft m/s cm/s gal cm/s2 cm/s^2 mm/s2 in/s2 mg %g"
SPELLINGS |= {unit: unit for unit in ("g", "m", *REFUSED.split())}
LARGEST_NUMBER = 1e12  #: of seconds or of any unit: above it the integrals of the motion are meaningless
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?", re.ASCII)


def read_motion_table(
    path: Path,
    *,
    quantity: Literal["acceleration", "displacement"],
    unit: Unit,
    scale: float = 1.0,
    baseline: Literal["none", "mean", "linear"] = "none",
) -> TableMotion:
    """Read a table of base motion, convert it to SI and multiply its values by `scale`.

    Raises:
        ValueError: no such file, too large, not text, a unit that does not measure the quantity or is not the
            header's, a line that is not two finite numbers (named), or samples that `TableMotion` refuses.
    """
    if unit not in UNITS:
        raise ValueError(f"motion table: unknown unit {unit!r}; known: {', '.join(UNITS)}")
    measured, factor = UNITS[unit]
    if measured != quantity:
        raise ValueError(f"motion table: unit {unit!r} measures {measured}, but the quantity is {quantity}")
    if not math.isfinite(scale):
        raise ValueError(f"motion table: scale must be finite, got {scale}")
    rows = list(_rows(_text(path), path.name, unit))
    if len(rows) < 2:
        raise ValueError(f"{path.name}: two samples or more are needed, found {len(rows)}")
    times, values = np.array(rows, dtype=np.float64).T
    try:
        return TableMotion(
            times=times, values=values * (factor * scale), quantity=quantity, baseline=baseline
        )
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None


def _text(path: Path) -> str:
    if not path.is_file():
        raise ValueError(
            f"motion table {path} does not exist or is not a file; paths start at the folder of the case file"
        )
    size = path.stat().st_size
    if size > LARGEST_FILE:
        raise ValueError(
            f"{path.name}: {size} bytes; a motion table may have at most {LARGEST_FILE >> 20} MB"
        )
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path.name}: not a text file (UTF-8); two columns of numbers are needed") from None
    except OSError as error:
        raise ValueError(f"{path.name}: cannot be read ({error.strerror})") from None
    if "\0" in text:
        raise ValueError(f"{path.name}: not a text file; two columns of numbers are needed")
    return text


def _rows(text: str, name: str, unit: Unit) -> Iterator[tuple[float, float]]:
    first = True
    for number, line in enumerate(text.split("\n"), start=1):
        content = line.split("#", 1)[0].strip()
        if not content:
            continue
        if first and not any(NUMBER.fullmatch(field) for field in _fields(content)):
            _check_header(content, f"{name}, line {number}", unit)
        else:
            yield _pair(_fields(content), f"{name}, line {number}")
        first = False


def _fields(content: str) -> list[str]:
    for separator in (";", ","):
        if separator in content:
            return [field.strip() for field in content.split(separator)]
    return content.split()


def _pair(fields: list[str], place: str) -> tuple[float, float]:
    if len(fields) != 2:
        raise ValueError(f"{place}: two columns are needed, time and value, found {len(fields)}")
    time, value = (_number(field, place) for field in fields)
    return time, value


def _number(field: str, place: str) -> float:
    # Stricter than float(), which takes "1_000", "nan" and digits of other scripts.
    if not NUMBER.fullmatch(field):
        raise ValueError(f"{place}: {field[:40]!r} is not a number (a decimal point, no unit, no text)")
    number = float(field.replace("d", "e").replace("D", "e"))
    if not abs(number) <= LARGEST_NUMBER:
        raise ValueError(f"{place}: {field[:40]!r} is too large for a number")
    return number


def _check_header(content: str, place: str, unit: Unit) -> None:
    """Refuse a header whose units, in brackets or after the underscore, are not seconds and `unit`."""
    fields = _fields(content)
    if len(fields) != 2:
        # "time (s) acc (g)" splits at its blanks; only its units matter: two of them or none.
        fields = [f"[{text}]" for text in re.findall(r"[\[(]([^\])]*)[\])]", content)]
        if len(fields) not in (0, 2):
            raise ValueError(
                f"{place}: a header of two columns is needed, time and value, got {content[:60]!r}"
            )
    for field, wanted in zip(fields, ("s", unit), strict=False):
        found = _unit_of(field)
        if found is not None and found != wanted:
            raise ValueError(
                f"{place}: the header gives {found!r}, but {wanted!r} is needed ({field[:40]!r}); "
                f"set the unit or convert the column"
            )


def _unit_of(field: str) -> str | None:
    """The unit in the name of a column; None if there is no known unit."""
    bracketed = re.search(r"[\[(]([^\])]*)[\])]", field)
    spelled = bracketed.group(1) if bracketed else field.partition("_")[2]
    spelled = spelled.strip()
    if spelled in ("s", "sec", "seconds"):
        return "s"
    if spelled in ("ms", "min", "us"):
        return spelled
    # "G" and "M" are used for g and m; "Mm" is not.
    return SPELLINGS.get(spelled) or SPELLINGS.get(spelled.lower())
