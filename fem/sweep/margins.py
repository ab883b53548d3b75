"""The margins of a sweep's cells, where they are asked for: the factor on its motion at which each overturns first."""

from functools import partial
from pathlib import Path

from fem.batch.checked import MARGIN, check_chunk
from fem.batch.log import LoggedRuns
from fem.batch.runner import Runner
from fem.batch.table import fields_of
from fem.run.checks import WantedChecks
from fem.sweep.plan import Sweep

CHECKS = WantedChecks(band=False, margin=True)  #: as `run` makes them, without drawn inputs


def find_margins(runner: Runner, sweep: Sweep, log: Path) -> dict[int, tuple[str, ...]]:
    """The fields of `MARGIN` by cell, none where none are asked for; what the log holds is not computed again."""
    margins: dict[int, tuple[str, ...]] = {}
    if not sweep.margin:
        return margins

    def note(line: str) -> None:
        cell, *fields = fields_of(line)
        margins[int(cell)] = tuple(fields)

    LoggedRuns(
        what="margins of cells",
        path=log,
        columns={"cell": int, **MARGIN},
        make=sweep.case,
        model_of=sweep.model_of,
        key=lambda cell: (cell,),
        note=note,
        work=partial(check_chunk, checks=CHECKS),
    ).run(runner, (sweep.by_container(set(range(sweep.count)) - margins.keys()) for _ in range(1)))
    return margins
