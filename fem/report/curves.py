"""The figures of a run in its report: the same drawings as in `figures/`, with places for a moving cursor."""

import json
from collections.abc import Iterable
from dataclasses import dataclass

from markupsafe import Markup

from fem.figures.style import Drawing
from fem.html.page import svg_element


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A figure, ready to stand in a page."""

    name: str
    title: str
    svg: Markup
    axes: str  #: for the cursor, as JSON; empty where there is nothing to follow


def curves_of(drawings: Iterable[Drawing]) -> dict[str, Curve]:
    """Figures of a run as elements of a page, by name."""
    return {one.name: _curve(one) for one in drawings}


def _curve(one: Drawing) -> Curve:
    return Curve(
        name=one.name,
        title=one.title,
        svg=svg_element(one.svg, label=one.title, prefix=one.name),
        axes="" if one.cursor is None else json.dumps(one.cursor),
    )
