"""A verification as its page shows it: its runs in groups, and words that several sections have."""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

from fem.html import sections as html
from fem.html.formula import formula_markup
from fem.html.page import svg_element
from fem.html.units import ABSENT, short, typeset
from fem.results.figures import Shown
from fem.site_check.result import SiteResult, SiteRun
from fem.site_check.rule import RunGroup, groups_of

symbols = partial(formula_markup, prose=True)


class RunPair(NamedTuple):
    """The runs of one motion: with the vertical upward, and the other sign."""

    motion: int
    group: RunGroup
    runs: tuple[SiteRun, ...]


@dataclass(frozen=True, kw_only=True)
class SiteView:
    """A verification as its page shows it."""

    result: SiteResult

    @cached_property
    def groups(self) -> list[RunGroup]:
        """The runs of the set, by what they have in common."""
        return groups_of(run for run in self.result.runs if run.stage == "set")

    @property
    def governing(self) -> RunGroup | None:
        """The group of the run that governs."""
        run = self.result.result.governing
        return next((group for group in self.groups if run in group.runs), None)

    @property
    def signs(self) -> list[int]:
        """Signs of the vertical motion that were computed."""
        return sorted({run.vertical_sign for run in self.result.runs}, reverse=True) or [1]


def figure(svg: str, name: str, label: str) -> html.Figure:
    """A drawing of the page; its name keeps the ids apart."""
    return html.Figure(svg_element(svg, label=name.replace("-", " "), prefix=name), label)


def elevation_in_words(elevation: str) -> str:
    """The elevation behind a name, unless it is that which a case file shows."""
    return "" if elevation == "width" else f", {elevation}"


def sign_in_words(sign: int) -> str:
    """How the vertical motion was taken."""
    return "vertical as it is" if sign > 0 else "vertical reversed" if sign < 0 else "no vertical"


def pairs_of(group: RunGroup) -> list[RunPair]:
    """The runs of a group, motion by motion, the sign + first."""
    return [
        RunPair(
            motion,
            group,
            tuple(
                sorted(
                    (run for run in group.runs if run.motion == motion), key=lambda run: -run.vertical_sign
                )
            ),
        )
        for motion in sorted({run.motion for run in group.runs})
    ]


def two_figures(figure: Shown, value: float | None) -> str:
    """A figure as far as it is known."""
    return ABSENT if value is None else typeset(figure.unit.text(value, figures=2, bare=True))


def friction(run: SiteRun) -> str:
    """Both coefficients of a run."""
    return f"{short(run.mu_static, figures=3)} / {short(run.mu_kinetic, figures=3)}"
