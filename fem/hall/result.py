"""The result of a hall as typed data: what `hall.json` holds, and the columns that it adds to a list."""

from dataclasses import dataclass, field
from typing import Any

from fem.batch.checked import CHECKED
from fem.batch.study import StudyResult
from fem.batch.table import Columns
from fem.results.figures import RUN_COLUMNS, SLIPPED, TURNED

REFUSED = "refused"  #: status of a row that cannot be computed
#: columns of a run, as in its log
OF_A_RUN = {"status": str} | RUN_COLUMNS | {"reason": str}
STATIC = dict.fromkeys(("utilisation_sliding", "utilisation_overturning"), float)
#: of a container under several motions
OF_MOTIONS: Columns = {"motion": str}
OF_MOTIONS |= dict.fromkeys(("motions_overturned", "motions_invalid", "motions_failed"), int)
OF_MOTIONS |= {"largest_slip_m": float, "largest_slip_motion": str}
COLUMNS = OF_A_RUN | CHECKED | STATIC | OF_MOTIONS | {"rank": int}
FIRST = ("status", "reason", "outcome", *[*CHECKED][:3], TURNED, SLIPPED, "tilt_rad")
#: behind the columns of the list
RESULT_COLUMNS = {name: COLUMNS[name] for name in (*FIRST, *STATIC, *OF_MOTIONS, *CHECKED, *COLUMNS)}


@dataclass(frozen=True, kw_only=True)
class HallResult(StudyResult):
    """All results of a hall."""

    written_where_given = StudyResult.written_where_given | {"allow_outside"}
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
    def not_computed(self) -> list[dict[str, Any]]:
        """The rows that were refused."""
        return [row for row in self.table if row["status"] == REFUSED]
