"""The result of an ensemble as typed data: what `ensemble.json` holds."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fem.batch.axes import Axis, AxisResult
from fem.batch.study import StudyResult
from fem.results.json_block import JsonBlock


@dataclass(frozen=True, kw_only=True)
class Fall(JsonBlock):
    """A stronger motion that overturns less often than a weaker one, beyond what the intervals allow."""

    weaker: float
    stronger: float
    probability_weaker: float
    probability_stronger: float


@dataclass(frozen=True, kw_only=True)
class Resampled(JsonBlock):
    """The curves of the resamples."""

    median: tuple[float, ...]
    deviation: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class FittedLognormal(JsonBlock):
    """The fitted curve, and how well it describes the counts."""

    median: float
    deviation: float
    levels: int
    levels_missed: int
    missed_by_chance: int
    adequate: bool
    median_interval: tuple[float, ...] | None = None  #: None where too few resamples have a curve
    deviation_interval: tuple[float, ...] | None = None
    resampled: Resampled | None = None

    written_where_given = frozenset({"resampled"})


@dataclass(frozen=True, kw_only=True)
class Fragility(JsonBlock):
    """What the only axis of an ensemble shows."""

    axis: str  #: its key
    falls: tuple[Fall, ...]
    lognormal: FittedLognormal | None = None
    no_lognormal: str | None = None  #: why there is none

    written_where_given = frozenset({"no_lognormal"})


@dataclass(frozen=True, kw_only=True)
class EnsembleResult(StudyResult):
    """All results of an ensemble."""

    asked: str  #: hash of the request
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
    #: beyond which a draw does not stand, and counts as one that overturned
    limit_slip_m: float | None = None
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
    fragility: Fragility | None = None

    @property
    def point_axes(self) -> tuple[Axis, ...]:
        """The axes, to name places on them."""
        return tuple(axis.axis for axis in self.axes)
