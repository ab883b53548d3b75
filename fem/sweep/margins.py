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
    if not sweep.margin:
        return {}
    margins = LoggedRuns[int](
        what="margins of cells",
        path=log,
        columns={"cell": int, **MARGIN},
        make=sweep.case,
        model_of=sweep.model_of,
        key=lambda cell: (cell,),
        items=sweep.by_container(range(sweep.count)),
        work=partial(check_chunk, checks=CHECKS),
    )
    margins.run(runner, iter(margins.missing, []))
    return {cell: tuple(fields_of(line)[1:]) for (cell,), line in margins.lines.items()}
