"""Formulas as text, set for a page: symbols of one letter in italics, with their index; words and numbers upright;
powers, written as ^2.5, raised."""

import re

from markupsafe import Markup, escape

#: a letter alone, but pi and the s of a unit such as m/s, with what follows its underscore; or a power
SYMBOL = re.compile(
    r"(?<![A-Za-zα-ωΩ_])(?<!m/)([A-Za-zα-ορ-ωΩ])(?:_([A-Za-z0-9μ]+))?(?![A-Za-zα-ωΩ])|\^([−0-9.]+)"
)


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
