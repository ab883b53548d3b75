"""A run as its page shows it: what several of its sections have."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from fem.assessment.floor_words import drawn_level
from fem.assessment.loose_boxes import box_rows
from fem.assessment.summary import to_compare
from fem.case.case import Case
from fem.figures.style import Drawing
from fem.html import sections as html
from fem.html.page import svg_element
from fem.model.model import Model
from fem.report.animation import Animation, player_data
from fem.report.comparison import Compared, compared_rows
from fem.results.history import History
from fem.results.reader import OpenedRun
from fem.results.run_result import RunResult, Verdict


@dataclass(frozen=True, kw_only=True)
class RunView:
    """A run as its page shows it."""

    run: OpenedRun
    model: Model
    history: History
    animation: Animation
    drawn: Mapping[str, Drawing]
    brief: bool  #: of three printed sheets at most

    @property
    def case(self) -> Case:
        """The case, resolved."""
        return self.run.case

    @property
    def result(self) -> RunResult:
        """What `run.json` holds."""
        return self.run.typed_result

    @property
    def verdict(self) -> Verdict:
        """What the run found; empty before there is anything."""
        return self.result.verdict or Verdict()

    @cached_property
    def compared(self) -> list[Compared]:
        """The static rules beside the run."""
        return compared_rows(self.model.static, to_compare(self.result))

    @cached_property
    def boxes(self) -> Sequence[Sequence[str]]:
        """A row for each box of a loose stack."""
        return box_rows(self.result)

    @cached_property
    def played(self) -> dict[str, Any]:
        """What the animation plays; empty where there is none."""
        if len(self.history) < 2 or self.brief:
            return {}
        return player_data(self.animation, self.history, model=self.model)

    @property
    def note_on_level(self) -> str:
        """A note that a sloping floor is drawn level; empty for a level one."""
        return drawn_level(self.case.floor.slope_percent)

    def figures(self, *names: str) -> list[html.Figure]:
        """Figures of the drawings with these names, where there are any."""
        return [
            html.Figure(
                svg_element(drawing.svg, label=drawing.title, prefix=drawing.name),
                f"figure: {drawing.title}",
                axes=drawing.cursor,
            )
            for drawing in (self.drawn[name] for name in names if name in self.drawn)
        ]
