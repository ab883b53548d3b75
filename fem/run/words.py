"""The words of a run: templates of `fem/html/templates` that read like what is said."""

import re
from typing import Any

from fem.case.tables.unknown_inputs import in_words
from fem.html.page import text_of
from fem.results.outcome import SLIDING, Outcome
from fem.runtime import units

#: what every template may name
NAMED: dict[str, Any] = {"units": units, "in_words": in_words, "Outcome": Outcome, "SLIDING": SLIDING}


def paragraphs(template: str, **shown: Any) -> list[str]:
    """The texts of a template that are not empty: a blank line ends one, and other white space is a space."""
    parts = re.split(r"\n\s*\n", text_of(template, **NAMED, **shown))
    return [text for part in parts if (text := " ".join(part.split()))]


def sentence(template: str, **shown: Any) -> str:
    """The one text of a template; empty where it says nothing."""
    return " ".join(paragraphs(template, **shown))


def rows(template: str, **shown: Any) -> list[tuple[str, str]]:
    """Name and value of each row of a template, `name | value`; a row without a value is left out."""
    pairs = (text.partition("|") for text in paragraphs(template, **shown))
    return [(name.strip(), value.strip()) for name, _, value in pairs if value.strip()]
