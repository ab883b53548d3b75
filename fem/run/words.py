"""The words of a run: templates of `fem/html/templates` that read like what is said.

A blank line ends a text; other white space counts as one space. Behind a line that ends in a tag, whose newline is not
set, it takes two.
"""

import re
from typing import Any

from fem.case.tables.unknown_inputs import in_words
from fem.html.page import text_of
from fem.results.outcome import SLIDING, Outcome
from fem.runtime import units


def _parts(text: str) -> list[str]:
    return [words for part in re.split(r"\n\s*\n", text) if (words := " ".join(part.split()))]


#: what every template may name; `listed` joins the texts of a macro
NAMED: dict[str, Any] = {
    "units": units,
    "in_words": in_words,
    "Outcome": Outcome,
    "SLIDING": SLIDING,
    "listed": lambda text: "; ".join(_parts(text)),
}


def paragraphs(template: str, macro: str = "", **shown: Any) -> list[str]:
    """The texts of a template, or of one of its macros, that are not empty."""
    return _parts(text_of(template, macro, **NAMED, **shown))


def sentence(template: str, macro: str = "", **shown: Any) -> str:
    """All that a template or one of its macros says; empty where it says nothing."""
    return " ".join(paragraphs(template, macro, **shown))


def rows(template: str, macro: str = "", **shown: Any) -> list[tuple[str, str]]:
    """Name and value of each row of a template, or of one of its macros: `name | value`; none without a value."""
    pairs = (text.partition("|") for text in paragraphs(template, macro, **shown))
    return [(name.strip(), value.strip()) for name, _, value in pairs if value.strip()]
