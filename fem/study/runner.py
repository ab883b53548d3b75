"""The engine of every study: many cases, run on all cores, one row of results each.

Cases that have the same container share its mesh and modes. A case that cannot be computed is a row with
status "failed" and the reason; it never has an outcome.
"""

import math
import time
import warnings
from bisect import bisect
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from operator import itemgetter
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np

from fem.case.case import Case
from fem.model.container import Container
from fem.model.equilibrium import Equilibrium, same_equilibrium
from fem.model.geometry import build_container
from fem.model.model import Model, build_model
from fem.model.motion import build_motions
from fem.model.recovery import recovery_of
from fem.results.figures import BOXES, SCALARS, BoxResult
from fem.results.level import in_a_word
from fem.results.run_result import Verdict
from fem.run.compute import Run, WantedChecks, compute_on, require_case
from fem.run.expected import OF_A_SECOND, say_expected
from fem.run.recorder import Recorder
from fem.run.simulation import run_without_history, simulate
from fem.run.verdict import verdict_of
from fem.runtime.arrays import FloatArray
from fem.runtime.progress import Reporter, ScreenReporter, clock_time, watched
from fem.runtime.signals import stop_requested
from fem.runtime.threads import cores
from fem.study.containers import ContainerCache, container_key
from fem.study.table import Columns
from fem.study.workers import (
    IN_THREADS,
    FoundT,
    ItemT,
    LocalWorkers,
    WorkersOf,
    hand_out,
    never,
    unguarded,
)

#: cases handed to a core at a time
CASES_AT_A_TIME = {"rigid": 16, "reduced": 4, "full": 1}
#: workers from which they are more, since a scheduler hands out some hundred chunks a second; but never so many that a
#: worker has fewer chunks than that
MANY_WORKERS, LEAST_CHUNKS = 64, 4

AT_HAND = 8  #: equilibria of a chunk that are kept: its cases may differ by turns in friction and weight
MEASURED_S = 4.0  #: in which it is found how long some work takes
#: chunks from all over the work that are handed out first, where it has more than so many
SAMPLED, MANY_CHUNKS = 8, 24
TOLD_S = 5.0  #: work that has taken so long ends with a line of what was done

_CONTAINERS = ContainerCache()
Row = dict[str, Any]
#: from what makes the case of an item, and some items, to a row each
ChunkWork = Callable[[Callable[[Any], Case], Sequence[Any]], list[Row]]


@dataclass(frozen=True, kw_only=True)
class Runner:
    """Runs the cases of a study, of any models, and reports the progress in one line.

    An item names a case: a cell, a draw, or the case itself.
    """

    workers_of: WorkersOf  #: `LocalWorkers` or a cluster
    reporter: Reporter = field(default_factory=Reporter)
    stop: Callable[[], bool] = never  #: asked repeatedly; true ends the work
    jobs: int = 1  #: cores of this machine that it may use

    def rows(
        self,
        what: str,
        items: Iterable[ItemT],
        make: Callable[[ItemT], Any],
        model_of: Callable[[ItemT], str],
        work: ChunkWork | None = None,
        *,
        takes_long: bool = False,
        more: float = 0.0,
    ) -> Generator[tuple[list[ItemT], list[Row]], None, None]:
        """Run one case for each item; yields items and their rows as they are ready, in any order.

        Items stand in an order in which those of one container are neighbours. `make` is picklable; it gives the case
        of an item, or for `found` the item without its number. Other `work` that takes long is handed out one by one,
        and gives no row where it was stopped. `more` of them are expected to follow, for the time left.
        """
        by_model: dict[str, list[ItemT]] = {}
        for item in items:
            by_model.setdefault(model_of(item), []).append(item)
        total, done, failed, began = sum(map(len, by_model.values())), 0, 0, time.perf_counter()
        #: when some were done, after whatever was compiled, and what all until then cost [s]
        marks: list[tuple[float, float]] = []
        foretold, follow = False, " with those that may follow" * (more > 0.0)

        def left() -> float | None:
            """Wall time of those that are not done, and of those that are expected to follow [s]."""
            if not marks:
                return None
            # by the later half: what is loaded first takes its time
            (first, _), (now, worked) = marks[0], marks[-1]
            since, before = marks[bisect(marks, (0.5 * (first + now), math.inf)) - 1]
            if worked <= before:
                return None
            counts = [more, *(len(by_model[one]) * OF_A_SECOND[one] / OF_A_SECOND[model] for one in models)]
            rest = cost_left(costs) + sum(counts) * float(np.nanmean(costs))
            return rest * (now - since) / (worked - before)

        def told() -> str:
            """How much is done, how fast, and the time left."""
            elapsed, lost = time.perf_counter() - began, f", {failed} failed" if failed else ""
            if done == total:
                return f"{total} {what} in {clock_time(elapsed)}{lost}"
            seconds = left()
            words = "time left unknown" if seconds is None else f"{clock_time(seconds)} left"
            return f"{done} of {total} {what}, {done / elapsed:.3g} per s, {words}{follow}{lost}"

        self.reporter.start(0.0)
        models = sorted(by_model, key=[*CASES_AT_A_TIME].index)
        try:
            while models:
                model = models.pop(0)
                own = by_model[model]
                pools, size, finish = self.workers_of(model, len(own)), 1, False
                if model != "full" and not takes_long:  # one of these may take an hour
                    usual, workers, finish = CASES_AT_A_TIME[model], sum(pool.count for pool in pools), True
                    size = min(usual * workers // MANY_WORKERS, len(own) // (LEAST_CHUNKS * workers))
                    size = max(usual, size)
                places = {id(item): place for place, item in enumerate(own)}
                costs: FloatArray = np.full(len(own), np.nan)  # of each of them; nan: it is not done [s]
                options: dict[str, Any] = {"at_a_time": size, "stop": self.stop, "finish": finish}
                for chunk, rows in hand_out(
                    spread(own, size), partial(work or run_chunk, make), pools, **options
                ):
                    yield chunk[: len(rows)], rows
                    done, failed = done + len(rows), failed + sum(row["status"] == "failed" for row in rows)
                    if rows:  # the median is without what was compiled; without times each costs one
                        cost = float(np.median([row.get("wall_s", 1.0) for row in rows]))
                        costs[places[id(chunk[0])] :][: len(rows)] = cost
                        until = marks[-1][1] + cost * len(rows) if marks else 0.0
                        marks.append((time.perf_counter(), until))
                    if done < total:
                        self.reporter.tell(told)
                        measured = not foretold and marks and marks[-1][0] > marks[0][0] + MEASURED_S
                        if measured and (seconds := left()):
                            foretold = True  # said once, by what the first of all over the group took
                            say_expected(self.reporter, f"{total - done} more {what}{follow}", seconds)
        finally:
            self.reporter.finish()
            if total and done == total and time.perf_counter() - began > TOLD_S:
                self.reporter.message(told())  # the last line does not stand at a time left

    def each(self, what: str, items: Sequence[ItemT], work: Callable[[ItemT], FoundT]) -> list[FoundT]:
        """The results of some work for each item, in their order; the ValueError of the first that raises one.

        `work` is picklable; KeyboardInterrupt where `stop` ended it.
        """
        results: list[FoundT] = []
        for _, found in sorted(self.found(what, enumerate(items), work, takes_long=False), key=itemgetter(0)):
            if isinstance(found, ValueError):
                raise found
            results.append(found)
        if len(results) < len(items):
            raise KeyboardInterrupt
        return results

    def found(
        self,
        what: str,
        items: Iterable[tuple[int, ItemT]],
        work: Callable[[ItemT], FoundT],
        model_of: Callable[[tuple[int, ItemT]], str] = lambda item: "rigid",
        *,
        takes_long: bool = True,
    ) -> Generator[tuple[int, FoundT | ValueError], None, None]:
        """Let the workers do some work, which must be picklable, for each numbered item.

        Yields numbers and results, or the ValueError that the work raised, as they are ready.
        """
        tried, make = partial(_work_on, work), itemgetter(1)
        with closing(self.rows(what, items, make, model_of, tried, takes_long=takes_long)) as found:
            for chunk, rows in found:
                for (number, _), row in zip(chunk, rows, strict=True):
                    yield number, row["found"]


def spread(items: Sequence[ItemT], size: int) -> Iterator[ItemT]:
    """Items in the order in which chunks of them are handed out: a few from all over first.

    Neighbours are alike, and the last may take ten times as long as the first.
    """
    whole = len(items) // size
    early = range(0, whole, whole // SAMPLED) if whole > MANY_CHUNKS else range(0)
    for k in (*early, *(k for k in range(whole + 1) if k not in early)):
        yield from items[k * size : (k + 1) * size]


def cost_left(costs: FloatArray) -> float:
    """Cost of the items that are not done, whose own is nan, as their neighbours have it [s]."""
    done, places = np.isfinite(costs), np.arange(costs.size)
    return float(np.interp(places[~done], places[done], costs[done]).sum()) if done.any() else 0.0


@dataclass
class NamedStages:
    """Names the stages of a study with their runs as they begin; how long these take is measured by the runner."""

    names: Sequence[str]
    reporter: Reporter
    last: str = ""  #: stage

    def begin(self, name: str, runs: int, *, up_to: bool = False, seconds: float = 0.0) -> None:
        """A stage of some runs, or of more of them, begins; `up_to`: it may need fewer; `seconds`: that they take."""
        if not runs or len(self.names) < 2:
            return
        words = f"{'up to ' * up_to}{runs} {'more ' * (name == self.last)}runs"
        if seconds:
            words += f", roughly {clock_time(seconds)}"
        self.reporter.message(f"stage {self.names.index(name) + 1} of {len(self.names)}: {name}, {words}")
        self.last = name


def _work_on(
    work: Callable[[ItemT], FoundT],
    of: Callable[[tuple[int, ItemT]], ItemT],
    items: Sequence[tuple[int, ItemT]],
) -> list[Row]:
    rows: list[Row] = []
    for item in items:
        try:
            rows.append({"status": "", "found": work(of(item))})
        except ValueError as error:
            rows.append({"status": "failed", "found": error})
    return rows


def run_chunk(make: Callable[[ItemT], Case], items: Sequence[ItemT]) -> list[Row]:
    """Run the cases of some items, one after the other; they share what is the same in them."""
    rows = []
    before: Model | None = None
    settled: list[tuple[Case, Container, Equilibrium]] = []  # the last `AT_HAND`
    for item in items:
        began = time.perf_counter()
        try:
            case = make(item).without_fields()
            container = _CONTAINERS.container_of(case)
            if case.solver.model == "full":
                model = build_model(case, container)
                recorder = Recorder(model, recovery_of(model))
                ending = simulate(model, recorder)
                verdict = verdict_of(model, recorder.history(), recorder.largest_von_mises)
                row = _row(ending.status, ending.error, verdict)
            else:  # with the motions of the one before, and an equilibrium that is known
                alike = (
                    known
                    for other, own, known in settled
                    if own is container and same_equilibrium(case, other)
                )
                known = next(alike, None)
                motions = (before.case, before.motion, before.vertical) if before else None
                before = build_model(case, container, known, build_motions(case, motions))
                if known is not before.equilibrium:
                    settled.insert(0, (case, container, before.equilibrium))
                    del settled[AT_HAND:]
                row = run_model(before)
        except (ValueError, ArithmeticError, RuntimeError) as error:  # bad input, no equilibrium, singular
            row = _row("failed", str(error))
        rows.append(row | {"wall_s": time.perf_counter() - began})
    return rows


def run_model(model: Model) -> Row:
    """Step a rigid or reduced model to its end, in place; its row."""
    recovery = _CONTAINERS.recovery_of(model) if model.case.solver.model == "reduced" else None
    verdict, error = run_without_history(model, recovery)
    ended = "completed" if verdict.overturned_at_s is None else "overturned"
    return _row("failed" if error else ended, error, verdict)


def _row(status: str, reason: str | None, verdict: Verdict | None = None) -> Row:
    """The row of a run. A failed run has no outcome; it has figures if it reached a verdict."""
    row = {"status": status, "reason": reason, "wall_s": 0.0} | dict.fromkeys((*SCALARS, *BOXES))
    if verdict is not None:
        row |= {name: getattr(verdict, name) for name in SCALARS}
        if verdict.boxes is not None:
            row |= {name: tuple(getattr(box, key) for box in verdict.boxes) for name, key in BOXES.items()}
    return row | {"outcome": None} if status == "failed" else row


def boxes_in(row: Mapping[str, Any]) -> tuple[BoxResult, ...] | None:
    """The boxes of a loose stack, from its row; None of one body."""
    boxes = zip(*(row[name] or () for name in BOXES), strict=True)
    return tuple(BoxResult(**dict(zip(BOXES.values(), box, strict=True))) for box in boxes) or None


#: what a repetition adds to a run beside its card; empty where there is none. The margin is a factor; where there is
#: none, the largest one tried
CHECKED: Columns = {"sure": str, "decided_by": str}
CHECKED |= dict.fromkeys(("margin", "margin_low", "margin_high", "margin_tried_to"), float)
CHECKED["margin_governs"] = float  #: the least factor at which the container or a variation does not stand
#: in a word the gravest of what a container does; the card of its run
CARD: Columns = {"does": str, "card": str}
CARD_LINES = " | "  #: between the lines of a card in one field


def check_chunk(make: Callable[[ItemT], Case], items: Sequence[ItemT]) -> list[Row]:
    """Repeat some runs with their bands and margins: rows by `CHECKED` and `CARD`, empty where there is no outcome.

    A run that was stopped has none.
    """
    rows = []
    for item in items:
        row: Row = dict.fromkeys(CHECKED | CARD) | {"status": "failed"}
        try:
            case = make(item).without_fields()
            run = compute_on(_CONTAINERS.container_of(case), case, WantedChecks())
            if stop_requested():
                break
            verdict, margin = run.verdict, run.verdict.margin
            row |= {"status": run.status, "sure": verdict.sure, "decided_by": " ".join(verdict.decided_by)}
            row |= {"does": in_a_word(run.typed_result), "card": CARD_LINES.join(verdict.card)}
            if margin is not None:
                tried = margin.largest_tried if margin.factor is None else None
                governs = margin.governing and margin.governing.factor
                found = (margin.factor, margin.low, margin.high, tried, governs)
                row |= zip([*CHECKED][2:], found, strict=True)
        except (ValueError, ArithmeticError, RuntimeError):  # the row of the run has the reason
            pass
        rows.append(row)
    return rows


#: number of cases from which processes pay off: runs with history and band hold the interpreter longer than rows do
WORTH_PROCESSES = {"rigid": 24, "reduced": 6, "full": 2}


class Wanted(TypedDict, total=False):
    """What is found of each run, as for `fem.compute`."""

    band: bool | None
    margin: bool | None
    check_rigid: bool
    #: whether the members of a band find stresses, and forces in the joints of a stack, which takes twice as long
    inner_forces: bool


@overload
def compute_many(
    cases: Iterable[Case], jobs: int | None = None, *, progress: bool | None = None, **wanted: Unpack[Wanted]
) -> list[Run]: ...
@overload
def compute_many(
    cases: Iterable[Case],
    jobs: int | None = None,
    *,
    errors: Literal["return"],
    progress: bool | None = None,
    **wanted: Unpack[Wanted],
) -> list[Run | ValueError]: ...
def compute_many(
    cases: Iterable[Case],
    jobs: int | None = None,
    *,
    errors: Literal["raise", "return"] = "raise",
    progress: bool | None = None,
    **wanted: Unpack[Wanted],
) -> Sequence[Run | ValueError]:
    """Compute cases in memory, side by side; no file is written.

    Several cases are shared by threads, many by processes as well. A process loads the script that started it: in a
    script, call this behind `if __name__ == "__main__":`. Where that is missing, a warning says so, and the cases are
    computed by threads alone. Cases that differ in floor or friction only share their container.

    Args:
        cases: from `fem.load_case`, `fem.case_from` or `case.replace`, of any models.
        jobs: cores to use; default: all.
        errors: "raise" that of the first case that cannot be computed, which is looked for before any is computed; or
            "return" it in place of its run.
        progress: show it by a line; default: on a terminal and in a notebook.
        wanted: band, margin, check_rigid, inner_forces: see `Wanted`.

    Returns:
        The runs in the order of the cases, each the same as `fem.compute` gives, whatever `jobs` is.

    Raises:
        CaseError, MeshError: one of the cases cannot be computed; a note of the error says which.
        ValueError: jobs is less than 1.
        WorkersLostError: a process died, perhaps for want of memory.
    """
    all_cases = list(cases)
    for case in all_cases:
        require_case(case)
    jobs = cores() if jobs is None else jobs
    if jobs < 1:
        raise ValueError(f"compute_many: jobs must be at least 1, got {jobs}")

    def noted(run: Run | ValueError, number: int) -> Run | ValueError:
        if isinstance(run, ValueError):
            run.add_note(f"case {number + 1} of {len(all_cases)} of compute_many")
            if errors == "raise":
                raise run
        return run

    runs: dict[int, Run | ValueError] = {}
    for number, case in enumerate(all_cases):
        try:
            build_container(case)
            build_motions(case)
        except ValueError as error:
            runs[number] = noted(error, number)
    alone = unguarded() if min(jobs, len(all_cases)) > 1 else None
    if alone is not None:
        warnings.warn(
            f"{alone}, so its cases are computed by threads of this process only; call compute_many behind "
            "that line, in a script that is a file, to use several processes",
            stacklevel=2,
        )
    keys = [container_key(case) for case in all_cases]  # those of one container follow one another
    first = {key: number for number, key in reversed([*enumerate(keys)])}
    order = sorted(range(len(all_cases)), key=lambda number: first[keys[number]])
    items = [(number, all_cases[number]) for number in order if number not in runs]
    work = partial(_compute, WantedChecks(**wanted))
    reporter = ScreenReporter(quiet=not (watched() if progress is None else progress))
    with LocalWorkers(jobs, WORTH_PROCESSES if alone is None else IN_THREADS) as workers_of:
        runner = Runner(workers_of=workers_of, reporter=reporter, stop=stop_requested)
        with closing(runner.found("runs", items, work, lambda item: item[1].solver.model)) as found:
            for number, run in found:
                runs[number] = noted(run, number)
    if stop_requested():
        raise KeyboardInterrupt
    return [runs[number] for number in range(len(all_cases))]


def _compute(wanted: WantedChecks, case: Case) -> Run:
    return compute_on(_CONTAINERS.container_of(case), case, wanted)
