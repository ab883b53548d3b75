"""The result of a list of containers: its columns, what its containers may do, and all results as typed data."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from fem.results.figures import RUN_COLUMNS, SLIPPED, TURNED
from fem.results.level import STANDING, Level
from fem.study.driver import (
    StudyResult,
)
from fem.study.runner import CARD, CHECKED
from fem.study.table import Columns

REFUSED = "refused"  #: status of a row that cannot be computed
NONE = "has no outcome"
#: what a container may do, the gravest first
FALLS: tuple[str, ...] = (Level.OVERTURNS, Level.DESTROYS, NONE)
DOUBTFUL: tuple[str, ...] = tuple(level for level in Level if level not in (*FALLS, Level.STANDS))
GRAVEST = (*FALLS, *DOUBTFUL, *STANDING.values())
#: columns of a run, as in its log
OF_A_RUN = {"status": str} | RUN_COLUMNS | {"reason": str}
STATIC = dict.fromkeys(("utilisation_sliding", "utilisation_overturning"), float)
#: of a container under several motions
OF_MOTIONS: Columns = {"motion": str}
OF_MOTIONS |= dict.fromkeys(("motions_overturned", "motions_invalid", "motions_failed"), int)
OF_MOTIONS |= {"largest_slip_m": float, "largest_slip_motion": str}
COLUMNS = OF_A_RUN | CHECKED | STATIC | OF_MOTIONS | {"rank": int, "side": str}
FIRST = ("status", "reason", "outcome", *[*CHECKED][:3], TURNED, SLIPPED, "tilt_rad")
#: of a row of the list
ROW_COLUMNS = {"row": int, "line": int, "name": str, "count": int, "tag": str, "command": str}
ROW_COLUMNS |= CARD
#: behind the columns of the list
RESULT_COLUMNS = {name: COLUMNS[name] for name in (*FIRST, *STATIC, *OF_MOTIONS, *CHECKED, *COLUMNS)}
RESULT_COLUMNS["first_line"] = str
OF_A_TAG = {"tag": str, "containers": int, "counts": dict[str, int], "margin": float}


@dataclass(frozen=True, kw_only=True)
class HallResult(StudyResult):
    """All results of a hall."""

    written_where_given = StudyResult.written_where_given | {"allow_outside", "one_side"}
    columns_of: ClassVar[Mapping[str, Any]] = {"table": RESULT_COLUMNS | ROW_COLUMNS, "tags": OF_A_TAG}
    needed = frozenset({"status", *ROW_COLUMNS, *OF_A_TAG} - {"command", "margin", "does", "card"})
    hall: str
    case: str
    asked: str  #: hash of what is computed
    listed: str = ""  #: hash of the list
    model: str
    motions: tuple[str, ...] = ()  #: files, of pairs both, as they were named; empty: the motion of the case
    motion_covered: str | None = None
    rows: int  #: of the list
    containers: int  #: rows times their counts
    distinct: int  #: containers that were computed
    refused: int = 0  #: rows
    runs: int = 0
    checks: str = "weakest"  #: which runs are repeated: weakest | all | none
    checked: int = 0  #: containers whose run was repeated
    one_side: bool | None = None  #: whether only the width was looked at
    #: of containers, by count
    outcomes: dict[str, int] = field(default_factory=dict)
    #: what the containers of each tag did: stood, overturned, invalid, failed, refused
    tags: tuple[dict[str, Any], ...] = ()
    kept: tuple[str, ...] = ()  #: columns of the list that set nothing
    columns: tuple[str, ...] = ()  #: of the list
    allow_outside: bool | None = None  #: files of the case may lie outside its folder
    table: tuple[dict[str, Any], ...] = ()  #: rows of `hall.csv`, with `row`, `name`, `count`, `command`

    @property
    def extent(self) -> str:
        """How much there is of it, in words."""
        under = f" under {len(self.motions)} motions" if len(self.motions) > 1 else ""
        return f"{self.rows} rows, {self.containers} containers, {self.distinct} that differ{under}: {self.runs} runs"

    @property
    def ranked(self) -> list[dict[str, Any]]:
        """The rows that were computed, the weakest first."""
        return sorted((row for row in self.table if row["rank"]), key=lambda row: (row["rank"], row["row"]))

    @property
    def counts(self) -> dict[str, int]:
        """How many containers do what, the gravest first."""
        counts = Counter[str]()
        for row in self.ranked:
            counts[row.get("does") or row["outcome"]] += row["count"]
        return {word: counts[word] for word in (*GRAVEST, *sorted({*counts} - {*GRAVEST})) if counts[word]}

    @property
    def not_computed(self) -> list[dict[str, Any]]:
        """The rows that were refused."""
        return [row for row in self.table if row["status"] == REFUSED]
