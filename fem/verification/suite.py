"""The ladder: every room of checks, climbed from the elements up to the limits of the whole.

A check that cannot be computed is a row that fails, with its reason; the others go on.
"""

import difflib
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from fem.runtime.identity import versions
from fem.verification import (
    contact_laws,
    elasticity,
    friction,
    invariance,
    limits,
    overturning,
    restitution,
    rocking,
    sliding,
    statics,
    time_stepping,
)
from fem.verification.rows import Check, Row, failed_row
from fem.verification.runs import STACK, run

ROOMS: dict[str, tuple[Check, ...]] = {
    "statics": statics.CHECKS,
    "elasticity": elasticity.CHECKS,
    "time": time_stepping.CHECKS + invariance.CHECKS,
    "contact": contact_laws.CHECKS,
    "sliding": friction.CHECKS + sliding.CHECKS,
    "rocking": rocking.CHECKS,
    "restitution": restitution.CHECKS,
    "overturning": overturning.CHECKS,
    "limits": limits.CHECKS,
}


class UnknownRoomError(ValueError):
    """There is no such room."""

    def __init__(self, name: str) -> None:
        near = difflib.get_close_matches(name, ROOMS, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        super().__init__(f"no room {name!r}{hint} (known: {', '.join(ROOMS)})")


@dataclass(frozen=True, kw_only=True)
class Rung:
    """A check that was computed."""

    room: str
    check: str
    rows: tuple[Row, ...]
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Ladder:
    """Everything that was computed, and what it came to."""

    quick: bool
    rungs: tuple[Rung, ...]
    seconds: float

    @property
    def rows(self) -> Iterator[tuple[Rung, Row]]:
        """Every row with its check, from the first to the last."""
        return ((rung, row) for rung in self.rungs for row in rung.rows)

    @property
    def failures(self) -> int:
        """Number of rows that fail."""
        return sum(not row.passed for _, row in self.rows)

    @property
    def count(self) -> int:
        """Number of rows."""
        return sum(len(rung.rows) for rung in self.rungs)

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data, for JSON."""
        return {
            "quick": self.quick,
            "passed": self.failures == 0,
            "rows": [{"room": rung.room, "check": rung.check, **row.to_dict()} for rung, row in self.rows],
            "checks": [
                {"room": rung.room, "check": rung.check, "rows": len(rung.rows), "seconds": rung.seconds}
                for rung in self.rungs
            ],
            "count": self.count,
            "failures": self.failures,
            "seconds": self.seconds,
            "versions": versions(),
        }


def chosen_checks(*, quick: bool, rooms: Sequence[str] = ()) -> list[tuple[str, Check]]:
    """Checks of the quick or the whole ladder, of some rooms or of all, in order."""
    return [
        (room, check)
        for room, checks in ROOMS.items()
        for check in checks
        if (not rooms or room in rooms) and (check.quick or not quick)
    ]


def climb(
    *, quick: bool, rooms: Sequence[str] = (), before: Callable[[str, Check], None] = lambda room, check: None
) -> Ladder:
    """Compute the checks one after the other; `before` is told of each.

    The stepping kernels are compiled first, outside the clock.
    """
    run(STACK, {"solver.duration_s": 0.01})
    began = time.perf_counter()
    rungs = []
    for room, check in chosen_checks(quick=quick, rooms=rooms):
        before(room, check)
        rungs.append(_rung(room, check))
    return Ladder(quick=quick, rungs=tuple(rungs), seconds=time.perf_counter() - began)


def _rung(room: str, check: Check) -> Rung:
    began = time.perf_counter()
    try:
        rows = check.rows()
    except (ArithmeticError, ValueError, RuntimeError, LookupError) as error:
        rows = [failed_row(check, error)]
    return Rung(room=room, check=check.name, rows=tuple(rows), seconds=time.perf_counter() - began)
