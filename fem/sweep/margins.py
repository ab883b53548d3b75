"""The margins of a sweep's cells, where they are asked for: the factor on its motion at which each overturns first."""

from collections.abc import Callable, Sequence
from pathlib import Path

from fem.batch.container_cache import ContainerCache
from fem.batch.log import LoggedRuns, fields_of
from fem.batch.runner import Row, Runner
from fem.case.case import Case
from fem.run.checks import WantedChecks
from fem.run.compute import compute_on
from fem.sweep.plan import Sweep

#: the factor; where there is none, the largest one tried
MARGIN = ("margin", "margin_tried_to")
_CONTAINERS = ContainerCache()


def margin_chunk(make: Callable[[int], Case], cells: Sequence[int]) -> list[Row]:
    """The margins of some cells, as `run` finds them, without drawn inputs; empty of a cell without an outcome."""
    rows = []
    for cell in cells:
        row: Row = dict.fromkeys(MARGIN) | {"status": "failed"}
        try:
            case = make(cell).without_fields()
            run = compute_on(_CONTAINERS.container_of(case), case, WantedChecks(band=False, margin=True))
            row["status"], margin = run.status, run.verdict.margin
            if margin is not None:
                tried_to = margin.largest_tried if margin.factor is None else None
                row |= {"margin": margin.factor, "margin_tried_to": tried_to}
        except (ValueError, ArithmeticError, RuntimeError):  # the row of the cell has the reason
            pass
        rows.append(row)
    return rows


def find_margins(runner: Runner, sweep: Sweep, log: Path) -> dict[int, tuple[str, ...]]:
    """The fields of `MARGIN` by cell, none where none are asked for; what the log holds is not computed again."""
    found: dict[int, tuple[str, ...]] = {}
    if not sweep.margin:
        return found

    def note(line: str) -> None:
        cell, *fields = fields_of(line)
        found[int(cell)] = tuple(fields)

    LoggedRuns(
        what="margins of cells",
        path=log,
        columns=("cell", *MARGIN),
        make=sweep.case,
        model_of=sweep.model_of,
        values=lambda cell, row: (cell, *(row[name] for name in MARGIN)),
        note=note,
        work=margin_chunk,
    ).run(runner, (sweep.by_container(set(range(sweep.count)) - found.keys()) for _ in range(1)))
    return found
