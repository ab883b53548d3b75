"""The cases of a sweep, run model by model on whoever computes them, with a line of progress."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from fem.batch.runner import Row, run_items
from fem.batch.workers import WorkersOf
from fem.case.case import Case
from fem.runtime.progress import Reporter, clock_time
from fem.sweep.plan import Sweep


@dataclass(frozen=True, kw_only=True)
class Computing:
    """How the cases of a sweep are computed."""

    sweep: Sweep
    workers_of: WorkersOf
    reporter: Reporter

    def rows_of(
        self, what: str, items: Sequence[Any], make: Callable[[Any], Case], stop: Callable[[], bool]
    ) -> Iterator[tuple[list[Any], list[Row]]]:
        """Run the cases of some items; yields items and their rows as they come.

        Args:
            what: the items, for the line of progress.
            items: cells, or tuples that begin with one.
            make: the case of an item.
            stop: asked now and then; true ends the work.
        """
        total, done, failed = len(items), 0, 0
        self.reporter.start(0.0)
        began = time.perf_counter()

        def progress() -> str:
            return _progress(what, done, total, failed, time.perf_counter() - began)

        for model, some in self._by_model(items).items():
            for chunk, rows in run_items(some, make, model, self.workers_of(model, len(some)), stop=stop):
                yield chunk, rows
                done += len(chunk)
                failed += sum(row["status"] == "failed" for row in rows)
                self.reporter.tell(progress)
        self.reporter.finish()

    def _by_model(self, items: Sequence[Any]) -> dict[str, list[Any]]:
        """Items by the model of their cells."""
        if all(axis.key != "solver.model" for axis in self.sweep.axes):
            return {self.sweep.base.solver.model: list(items)} if items else {}
        by_model: dict[str, list[Any]] = {}
        for item in items:
            cell = item if isinstance(item, int) else item[0]
            by_model.setdefault(self.sweep.point(cell)["solver.model"], []).append(item)
        return by_model


def _progress(what: str, done: int, total: int, failed: int, elapsed: float) -> str:
    """The line of progress."""
    rate = done / elapsed if elapsed > 0.0 else 0.0
    left = f"{clock_time((total - done) / rate)} left" if rate > 0.0 else "time left unknown"
    bad = f", {failed} failed" if failed else ""
    return f"{done} of {total} {what}, {rate:.3g} per s, {left}{bad}"
