"""The result of an ensemble as typed data: what `ensemble.json` holds."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fem.batch.axes import Axis, AxisResult
from fem.batch.study import StudyResult


@dataclass(frozen=True, kw_only=True)
class EnsembleResult(StudyResult):
    """Everything an ensemble found."""

    asked: str  #: hash of what was asked
    ensemble: str = ""  #: its name
    title: str = ""
    case: str = ""  #: name of the base case
    model: str = ""
    duration_s: float | str = "auto"
    motion_covered: str | None = None  #: the part of the motion that the runs cover, where they end before it
    draws: int = 0  #: at each point
    seed: int = 0
    sampling: str = ""
    replicates: int = 1
    confidence: float
    probability: float
    unknown_inputs: str = ""
    axes: tuple[AxisResult, ...]
    random: dict[str, Any]  #: what is drawn, by key
    derived: dict[str, str] = field(default_factory=dict)
    drawn_over_uncertainty: tuple[str, ...] = ()
    held: str = ""
    motions: tuple[dict[str, Any], ...] | None = None  #: measures and counts of each motion of a set
    motion_figures: tuple[str, ...] = ()
    points: tuple[Mapping[str, Any], ...] = ()  #: by the keys of the axes and `statistics.POINT_COLUMNS`
    regions: dict[str, int] = field(default_factory=dict)
    failed: int = 0
    fragility: dict[str, Any] | None = None

    @property
    def point_axes(self) -> tuple[Axis, ...]:
        """The axes, to name places on them."""
        return tuple(one.axis for one in self.axes)
