"""The result of a response curve as typed data: what `response.json` holds."""

from dataclasses import dataclass, field
from typing import Any

from fem.batch.study import StudyResult
from fem.response.lasting import AtFrequency, Coexistence, DropOut
from fem.response.records import PointRow


@dataclass(frozen=True, kw_only=True)
class ResponseResult(StudyResult):
    """All results of a response curve."""

    asked: str  #: hash of the request
    case: str = ""  #: its name
    title: str = ""
    request: dict[str, Any] = field(default_factory=dict)  #: without the case
    points: tuple[PointRow, ...] = ()  #: up and down, in the order in which they were swept
    frequencies: tuple[AtFrequency, ...] = ()  #: what lasts at each, whatever led to it
    coexisting: tuple[Coexistence, ...] = ()
    drop_outs: tuple[DropOut, ...] = ()
    stable_everywhere: bool | None = None  #: None without a point
    #: of the points with an outcome that do not stand: overturned, a corner destroyed, slid beyond the limit
    overturned_share: float | None = None
    starts_fell_share: float | None = None  #: of the random states, all frequencies; None without any

    @property
    def limit_slip(self) -> float | None:
        """Slip within the periods observed beyond which a motion does not stand [m]."""
        return self.request.get("limit_slip_m")

    def slid(self, point: PointRow) -> float:
        """Largest slip in the observed periods [m]: from the position at their start, or peak to peak in one."""
        return max(point.slip_stroke_m or 0.0, point.slip_excursion_m or 0.0)
