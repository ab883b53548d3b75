"""The result of a response curve as typed data: what `response.json` holds."""

from dataclasses import dataclass, field
from typing import Any

from fem.response.lasting import AtFrequency, Coexistence, DropOut
from fem.response.records import PointRow
from fem.study.driver import StudyResult


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
    #: of the points with an outcome that do not stand: overturned, a corner destroyed
    overturned_share: float | None = None
    starts_fell_share: float | None = None  #: of the random states, all frequencies; None without any
