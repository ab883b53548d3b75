"""Runs of a study, repeated as `run` does: with other inputs, and under stronger and weaker motions."""

from collections.abc import Callable, Sequence

from fem.batch.container_cache import ContainerCache
from fem.batch.runner import ItemT, Row
from fem.batch.table import Columns
from fem.case.case import Case
from fem.run.checks import WantedChecks
from fem.run.compute import compute_on
from fem.runtime.signals import stop_requested

#: the factor; where there is none, the largest one tried
MARGIN: Columns = {"margin": float, "margin_tried_to": float}
#: what a repetition adds to a run; empty where there is none
CHECKED: Columns = {
    "sure": str,
    "decided_by": str,
    "margin": float,
    "margin_low": float,
    "margin_high": float,
} | MARGIN

_CONTAINERS = ContainerCache()


def check_chunk(
    make: Callable[[ItemT], Case], items: Sequence[ItemT], checks: WantedChecks | None = None
) -> list[Row]:
    """Repeat some runs; a row by `CHECKED`, empty of a run without an outcome; none of a run that was stopped.

    Args:
        make: the case of an item.
        items: the runs.
        checks: what of each; None: all.
    """
    rows = []
    for item in items:
        row: Row = dict.fromkeys(CHECKED) | {"status": "failed"}
        try:
            case = make(item).without_fields()
            run = compute_on(_CONTAINERS.container_of(case), case, checks or WantedChecks())
            if stop_requested():
                break
            verdict, margin = run.verdict, run.verdict.margin
            row |= {"status": run.status, "sure": verdict.sure, "decided_by": " ".join(verdict.decided_by)}
            if margin is not None:
                row |= {
                    "margin": margin.factor,
                    "margin_low": margin.low,
                    "margin_high": margin.high,
                    "margin_tried_to": margin.largest_tried if margin.factor is None else None,
                }
        except (ValueError, ArithmeticError, RuntimeError):  # the row of the run has the reason
            pass
        rows.append(row)
    return rows
