"""The engine of every study: many cases, run on all cores, one row of results each.

Cases that have the same container share its mesh and modes. A case that cannot be computed is a row with
status "failed" and the reason; it never has an outcome.
"""

import time
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from operator import itemgetter
from typing import Any, NamedTuple

from fem.assessment.motion_words import covered_in_words, is_cut, missing_peak
from fem.assessment.verdict import verdict_of
from fem.batch.container_cache import ContainerCache, container_key
from fem.batch.workers import FoundT, ItemT, LocalWorkers, Pool, WorkersOf, hand_out, never
from fem.case.case import Case, CaseError
from fem.model.container import Container
from fem.model.equilibrium import Equilibrium, same_equilibrium
from fem.model.model import Model, build_model
from fem.model.motion import build_motions, motion_result
from fem.model.recovery import recovery_of
from fem.results.figures import BOXES, SCALARS
from fem.results.run_result import Verdict
from fem.run.expected import expected_s, say_expected, with_band_s
from fem.run.outcome import run_without_history
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.runtime.progress import Reporter, SilentReporter, clock_time
from fem.runtime.threads import cores

#: cases handed to a core at a time
CASES_AT_A_TIME = {"rigid": 16, "reduced": 4, "full": 1}
#: workers from which they are more, since a scheduler hands out some hundred chunks a second; but never so many that a
#: worker has fewer chunks than that
MANY_WORKERS, LEAST_CHUNKS = 64, 4

AT_HAND = 8  #: equilibria of a chunk that are kept: its cases may differ by turns in friction and weight
TOLD_S = 5.0  #: work that has taken so long ends with a line of what was done

_CONTAINERS = ContainerCache()


class Settled(NamedTuple):
    """A container at rest on its floor."""

    case: Case
    container: Container
    equilibrium: Equilibrium


Row = dict[str, Any]
#: from what makes the case of an item, and some items, to a row each
ChunkWork = Callable[[Callable[[Any], Case], Sequence[Any]], list[Row]]


@dataclass(frozen=True, kw_only=True)
class Runner:
    """Runs the cases of a study, of any models, and reports the progress in one line.

    An item names a case: a cell, a draw, or the case itself.
    """

    workers_of: WorkersOf  #: `LocalWorkers` or a cluster
    reporter: Reporter = field(default_factory=SilentReporter)
    stop: Callable[[], bool] = never  #: asked repeatedly; true ends the work
    jobs: int = 1  #: cores of this machine that it may use

    def rows(
        self,
        what: str,
        items: Iterable[ItemT],
        make: Callable[[ItemT], Case],
        model_of: Callable[[ItemT], str],
        work: ChunkWork | None = None,
    ) -> Iterator[tuple[list[ItemT], list[Row]]]:
        """Run one case for each item; yields items and their rows as they are ready, in any order.

        Args:
            what: the items, for the line of progress.
            items: in an order in which those of one container are neighbours.
            make: the case of an item; for processes it must be picklable.
            model_of: the model of its case.
            work: what is done with some items at a time, picklable; default: their runs. Other work repeats a run with
                its band and margin: it is handed out one by one, and gives no row where it was stopped.
        """
        by_model: dict[str, list[ItemT]] = {}
        for item in items:
            by_model.setdefault(model_of(item), []).append(item)
        total, done, failed = sum(map(len, by_model.values())), 0, 0
        self._say_expected(f"{total} {what}", by_model, make, expected_s if work is None else with_band_s)
        self.reporter.start(0.0)
        began = time.perf_counter()

        def progress() -> str:
            return _progress(what, done, total, failed, time.perf_counter() - began)

        for model, group in sorted(by_model.items(), key=lambda pair: list(CASES_AT_A_TIME).index(pair[0])):
            pools = self.workers_of(model, len(group))
            chunks = hand_out(
                group,
                partial(work or run_chunk, make),
                pools,
                at_a_time=1 if work else _chunk_size(model, len(group), pools),
                stop=self.stop,
                finish=model != "full" and work is None,  # one of these may take an hour
            )
            for chunk, rows in chunks:
                yield chunk[: len(rows)], rows
                done += len(rows)
                failed += sum(row["status"] == "failed" for row in rows)
                if done < total:
                    self.reporter.tell(progress)
        self.reporter.finish()
        if total and done == total and time.perf_counter() - began > TOLD_S:
            self.reporter.message(progress())  # the last line does not stand at a time left

    def _say_expected(
        self,
        what: str,
        by_model: Mapping[str, Sequence[ItemT]],
        make: Callable[[ItemT], Case],
        cost: Callable[[Case], float],
    ) -> None:
        """How long the cases take, by the first of each model."""
        seconds = 0.0
        for group in by_model.values():
            with suppress(ValueError):  # a case that cannot be computed is told in its row
                seconds += len(group) * cost(make(group[0]))
        say_expected(self.reporter, what, seconds / self.jobs, self.jobs)

    def each(self, what: str, items: Sequence[ItemT], work: Callable[[ItemT], FoundT]) -> list[FoundT]:
        """Let the workers do some work for each item; it must be picklable.

        Returns:
            The results in the order of the items.

        Raises:
            ValueError: that of the first item whose work raises one.
            KeyboardInterrupt: `stop` ended the work.
        """
        self.reporter.start(0.0)
        began, done = time.perf_counter(), 0
        ready: dict[int, list[FoundT | ValueError]] = {}
        numbered = list(enumerate(items))
        pools = self.workers_of("rigid", len(numbered))
        chunks = hand_out(
            numbered,
            partial(_work_on, work),
            pools,
            at_a_time=_chunk_size("rigid", len(numbered), pools),
            stop=self.stop,
        )
        results: list[FoundT] = []
        for chunk, outcomes in chunks:
            ready[chunk[0][0]] = outcomes
            while len(results) in ready:  # in order, so that the first error does not depend on the workers
                for outcome in ready.pop(len(results)):
                    if isinstance(outcome, ValueError):
                        raise outcome
                    results.append(outcome)
            done += len(chunk)
            if done < len(numbered):
                self.reporter.tell(
                    partial(_progress, what, done, len(numbered), 0, time.perf_counter() - began)
                )
        self.reporter.finish()
        if len(results) < len(numbered):
            raise KeyboardInterrupt
        if time.perf_counter() - began > TOLD_S:
            self.reporter.message(_progress(what, done, done, 0, time.perf_counter() - began))
        return results


def _chunk_size(model: str, count: int, pools: Sequence[Pool]) -> int:
    """Cases handed to a worker at a time."""
    usual, workers = CASES_AT_A_TIME[model], sum(pool.count for pool in pools)
    if model == "full":
        return usual
    return max(usual, min(usual * workers // MANY_WORKERS, count // (LEAST_CHUNKS * workers)))


def _work_on(
    work: Callable[[ItemT], FoundT], items: Sequence[tuple[int, ItemT]]
) -> list[FoundT | ValueError]:
    results: list[FoundT | ValueError] = []
    for _, item in items:
        try:
            results.append(work(item))
        except ValueError as error:
            return [*results, error]
    return results


def run_cases(
    cases: Sequence[Case],
    *,
    jobs: int | None = None,
    done: Callable[[int], None] = lambda count: None,
    stop: Callable[[], bool] = never,
) -> list[Row]:
    """Run cases and return a row each, in their order; the rows do not depend on `jobs`.

    No files are written, no fields are kept. Many cases are run by processes (`LocalWorkers`), so a script that calls
    this needs the usual `if __name__ == "__main__":`.

    Args:
        cases: what to run, of any models and containers.
        jobs: cores to use; all by default.
        done: called with the number of rows that are ready.
        stop: asked repeatedly; true ends the work.

    Returns:
        For each case `status` (completed | overturned | failed), `reason` (why it failed, else None), `wall_s`, and
        every scalar of a verdict (`SCALARS`). Cases not reached have status "interrupted".
    """
    rows: list[Row] = [_row_without_outcome("interrupted", "stopped before its turn") for _ in cases]
    first: dict[Hashable, int] = {}
    for k, case in enumerate(cases):
        first.setdefault(container_key(case), k)
    order = sorted(range(len(cases)), key=lambda k: first[container_key(cases[k])])
    finished = 0
    with LocalWorkers(jobs or cores()) as workers_of:
        runner = Runner(workers_of=workers_of, stop=stop)
        for chunk, computed in runner.rows(
            "cases",
            [(k, cases[k]) for k in order],
            itemgetter(1),
            lambda item: item[1].solver.model,
        ):
            for (k, _), row in zip(chunk, computed, strict=True):
                rows[k] = row
            finished += len(chunk)
            done(finished)
    return rows


def motion_left_out(case: Case) -> str | None:
    """How much of the motion a run covers, in words; None if all of it."""
    try:
        motion = motion_result(case, *build_motions(case))
    except CaseError:  # a row of the study says so
        return None
    return f"{covered_in_words(motion)}{missing_peak(motion)}" if is_cut(motion) else None


def run_chunk(make: Callable[[ItemT], Case], items: Sequence[ItemT]) -> list[Row]:
    """Run the cases of some items, one after the other; they share what is the same in them."""
    rows = []
    before: Model | None = None
    settled: list[Settled] = []
    for item in items:
        began = time.perf_counter()
        try:
            case = make(item).without_fields()
            if case.solver.model == "full":
                row = _run_full(case)
            else:
                before = _model_of(case, before, settled)
                row = run_model(before)
        except (ValueError, ArithmeticError, RuntimeError) as error:  # bad input, no equilibrium, singular
            row = _row_without_outcome("failed", str(error))
        rows.append(row | {"wall_s": time.perf_counter() - began})
    return rows


def _model_of(case: Case, before: Model | None, settled: list[Settled]) -> Model:
    """The model of a case; it takes over the motions of the one before, and an equilibrium that is known.

    The last `AT_HAND` equilibria are kept.
    """
    container = _CONTAINERS.container_of(case)
    known = next(
        (place for place in settled if place.container is container and same_equilibrium(case, place.case)),
        None,
    )
    motions = (before.case, before.motion, before.vertical) if before else None
    model = build_model(case, container, known and known.equilibrium, build_motions(case, motions))
    if known is None or known.equilibrium is not model.equilibrium:
        settled.insert(0, Settled(case, container, model.equilibrium))
        del settled[AT_HAND:]
    return model


def run_model(model: Model) -> Row:
    """Step a rigid or reduced model to its end, in place; its row."""
    recovery = _CONTAINERS.recovery_of(model) if model.case.solver.model == "reduced" else None
    verdict, error = run_without_history(model, recovery)
    ended = "completed" if verdict.overturned_at_s is None else "overturned"
    return _row("failed" if error else ended, error, verdict)


def _row(status: str, reason: str | None, verdict: Verdict) -> Row:
    """The row of a run; a failed one has figures, and no outcome."""
    row = _row_without_outcome(status, reason) | {name: getattr(verdict, name) for name in SCALARS}
    if verdict.boxes is not None:
        row |= {name: tuple(getattr(box, key) for box in verdict.boxes) for name, key in BOXES.items()}
    return row | {"outcome": None} if status == "failed" else row


def _run_full(case: Case) -> Row:
    model = build_model(case, _CONTAINERS.container_of(case))
    recorder = Recorder(model, recovery_of(model))
    ending = simulate(model, recorder)
    verdict = verdict_of(model, recorder.history(), recorder.largest_von_mises)
    return _row(ending.status, ending.error, verdict)


def _row_without_outcome(status: str, reason: str | None) -> Row:
    return {"status": status, "reason": reason, "wall_s": 0.0} | dict.fromkeys((*SCALARS, *BOXES))


def _progress(what: str, done: int, total: int, failed: int, elapsed: float) -> str:
    """The line of progress."""
    rate, lost = done / elapsed if elapsed > 0.0 else 0.0, f", {failed} failed" if failed else ""
    if done == total:
        return f"{total} {what} in {clock_time(elapsed)}{lost}"
    left = f"{clock_time((total - done) / rate)} left" if rate > 0.0 else "time left unknown"
    return f"{done} of {total} {what}, {rate:.3g} per s, {left}{lost}"
