"""What a drawing may hold that stands in a page: SVG elements that are drawn, and none that does anything."""

import re
from dataclasses import dataclass
from typing import Any

#: the tag of an element that drawings of matplotlib never hold; a comment begins like one
FOREIGN = re.compile(
    r"<(?!/|!--|(?:svg|g|defs|clipPath|path|pattern|rect|circle|line|polyline|polygon|use|text|tspan|image|style|title"
    r"|desc|metadata|rdf:RDF|cc:Work|cc:Agent|dc:(?:type|format|date|creator|title))[\s/>])[^\s/>]*"
)


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """A figure as SVG."""

    name: str
    title: str
    cursor: dict[str, Any] | None  #: where a cursor moves over it, see `cursor_axes`
    svg: str  #: the text of the file


def require_drawing(text: str) -> None:
    """Refuse what is no drawing.

    Raises:
        ValueError: no SVG, or elements in it that no drawing has.
    """
    _, start, inside = text.partition("<svg")
    if not start:
        raise ValueError("no drawing")
    if foreign := FOREIGN.search(inside):
        raise ValueError(f"a drawing must not hold {foreign[0]}>")
