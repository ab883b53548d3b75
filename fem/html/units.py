"""Numbers, units and formulas for pages: kN, kNm, mm, degrees, MPa; four figures unless stated otherwise.

A trailing zero that is known is kept: 98.10, not 98.1. Of formulas, symbols of one letter are set in italics, with
their index; words and numbers upright; powers, written as ^2.5, raised.
"""

import math
import re

from markupsafe import Markup, escape

from fem.results.figures import Shown
from fem.runtime.units import MILLIMETRES, RATIO, DisplayUnit, in_unit, plain_number

ABSENT = "–"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: a letter alone, but pi and the s of a unit such as m/s, with what follows its underscore; or a power
SYMBOL = re.compile(
    r"(?<![A-Za-zα-ωΩ_])(?<!m/)([A-Za-zα-ορ-ωΩ])(?:_([A-Za-z0-9μ]+))?(?![A-Za-zα-ωΩ])|\^([−0-9.]+)"
)


def number(value: float | None, factor: float = 1.0, figures: int = 4) -> str:
    """A number times a factor, with this many significant figures; a dash for none."""
    if value is None or not math.isfinite(value):
        return ABSENT
    scaled = in_unit(value, factor)
    if scaled == 0.0:
        return "0"
    mantissa, _, exponent = f"{scaled:.{figures - 1}e}".partition("e")
    if not -3 <= int(exponent) < 6:
        return mantissa.replace("-", "−") + times_ten_to(exponent)
    return f"{scaled:.{max(figures - 1 - int(exponent), 0)}f}".replace("-", "−")


def short(value: float | None, factor: float = 1.0, figures: int = 4) -> str:
    """The same without trailing zeros, for what was given and not computed."""
    text = number(value, factor, figures)
    return text.rstrip("0").rstrip(".") if "." in text and "×" not in text else text


def rounded(value: float, figures: int = 3) -> str:
    """A number for a figure: 1350 for 1.35e+03, 2 × 10⁻⁵ for 2e-05."""
    return typeset(plain_number(value, figures))


def one_two_five(value: float, *, up: bool) -> float:
    """1, 2 or 5 times a power of ten, not below a value or, not `up`, not above it; 0 of 0."""
    if not value > 0.0:
        return 0.0
    steps = [step * 10.0 ** math.floor(math.log10(value)) for step in (1.0, 2.0, 5.0, 10.0)]
    if up:
        return next(step for step in steps if step >= value * (1.0 - 1e-9))
    return max(step for step in steps[:3] if step <= value * (1.0 + 1e-9))


def quantity(value: float | None, unit: str, factor: float = 1.0, figures: int = 4) -> str:
    """A number with its unit, held together by a space that does not break."""
    text = number(value, factor, figures)
    return text if text == ABSENT else f"{text}\u00a0{unit}"


def millimetres(value: float | None) -> str:
    """A length given in metres, without its unit; below 0.01 mm only that limit."""
    return _in_unit(value, MILLIMETRES)


def figure_cell(figure: Shown, value: float | None) -> str:
    """A figure of a run in a column with its `figure_head`."""
    return ratio(value) if figure.unit is RATIO else _in_unit(value, figure.unit)


def figure_head(figure: Shown) -> str:
    """Over a column of figures of runs."""
    return typeset(f"{figure.head or figure.words} [{figure.unit.name}]").removesuffix(" []")


def _in_unit(value: float | None, unit: DisplayUnit) -> str:
    """Three significant figures without the unit; below the least only that limit."""
    if value is not None and 0.0 < abs(value) < unit.least:
        return f"< {rounded(unit.factor * unit.least)}"
    return number(value, unit.factor, 3)


def degrees(value: float | None) -> str:
    """An angle given in radians."""
    return quantity(value, "°", 180.0 / math.pi, 4).replace("\u00a0", "")


def ratio(value: float | None) -> str:
    """A largest rotation over the slenderness angle."""
    return ABSENT if value is None else typeset(RATIO.text(value))


def typeset(text: str) -> str:
    """A line of the summary for a page: true minus and times signs, powers of ten, m/s², µm, ν."""
    if text == "-":
        return ABSENT
    text = re.sub(r"(?<=\d) x (?=\d)", " × ", text.replace("m/s2", "m/s²").replace("nu = ", "ν = "))
    text = re.sub(r"(?<=\d) um\b", " µm", text)
    text = re.sub(r"(?<![\w.)-])-(?=\d)", "−", text)
    return re.sub(r"(?<=\d)e([+-]\d+)\b", lambda power: times_ten_to(power[1]), text)


def times_ten_to(exponent: str) -> str:
    """The power of ten behind a mantissa: " × 10⁻⁵" for "-05"."""
    return f" × 10{str(int(exponent)).translate(SUPERSCRIPTS)}"


def formula_markup(text: str, *, prose: bool = False) -> Markup:
    """A formula, escaped; of prose only the symbols that bear an index are set: a letter alone may be a word."""
    parts, end = [], 0
    for match in SYMBOL.finditer(text):
        letter, index, power = match.groups()
        if prose and letter and index is None:
            continue
        parts.append(escape(text[end : match.start()]))
        parts += [Markup("<sup>{}</sup>").format(power)] if power else [Markup("<i>{}</i>").format(letter)]
        parts += [Markup("<sub>{}</sub>").format(index)] if index else []
        end = match.end()
    return Markup("").join([*parts, escape(text[end:])])
