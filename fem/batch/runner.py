"""A list of cases, run on all cores: one row of figures each, in the order of the list.

Cases that have the same container share its mesh and modes. A case that cannot be computed is a row with
status "failed" and the reason; it never has an outcome.
"""

import threading
import time
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from functools import partial
from operator import itemgetter
from typing import Any, TypeVar

import numpy as np

from contact.stepping.integrator import FAILED as STEPPING_FAILED
from contact.stepping.modal_body import ModalBody
from contact.stepping.outcome import KeptSamples, run_to_end
from fem.assessment.verdict import audit, end_of_drive, verdict_from, verdict_of
from fem.batch.workers import LocalWorkers, Pool, hand_out
from fem.case.case import Case
from fem.model.container import Container, discretise
from fem.model.equilibrium import stands_like
from fem.model.model import Model, build_model
from fem.model.recovery import Recovery, recovery_of
from fem.run.recorder import Recorder
from fem.run.simulation import AFTERMATH, simulate, stepping_failure
from fem.runtime.threads import cores

#: scalars of a verdict, as columns; None where a case does not have them
SCALARS = (
    "outcome",
    "max_rotation_rad",
    "rotation_ratio",
    "max_slip_m",
    "residual_slip_m",
    "slip_peak_to_peak_m",
    "slip_travel_m",
    "max_uplift_m",
    "impacts",
    "first_opening_s",
    "first_uplift_s",
    "first_impact_s",
    "overturned_at_s",
    "restored",
    "restitution_first",
    "max_corner_force_N",
    "max_top_displacement_m",
    "max_acceleration_m_s2",
    "max_von_mises_Pa",
)

#: cases handed to a core at a time
CASES_AT_A_TIME = {"rigid": 16, "reduced": 4, "full": 1}

Row = dict[str, Any]


ItemT = TypeVar("ItemT")


def run_cases(
    cases: Sequence[Case],
    *,
    jobs: int | None = None,
    done: Callable[[int], None] = lambda count: None,
    stop: Callable[[], bool] = lambda: False,
) -> list[Row]:
    """Run cases and return a row each, in their order, the same whatever `jobs`.

    No files are written, no fields are kept. Many cases are run by processes (`LocalWorkers`), so a script that calls
    this needs the usual `if __name__ == "__main__":`.

    Args:
        cases: what to run, of any models and containers.
        jobs: cores to use; all by default.
        done: told now and then how many rows there are.
        stop: asked now and then; true ends the work.

    Returns:
        For each case `status` (completed | overturned | failed), `reason` (why it failed, else None), `wall_s`, and
        every scalar of a verdict (`SCALARS`). Cases not reached when stopped have status "interrupted".
    """
    rows: list[Row] = [_row_without_outcome("interrupted", "stopped before its turn") for _ in cases]
    first: dict[Hashable, int] = {}
    for k, case in enumerate(cases):
        first.setdefault(container_key(case), k)
    order = sorted(range(len(cases)), key=lambda k: first[container_key(cases[k])])
    finished = 0
    with LocalWorkers(jobs or cores()) as workers_of:
        for model in ("rigid", "reduced", "full"):
            items = [(k, cases[k]) for k in order if cases[k].solver.model == model]
            if not items:
                continue
            for chunk, found in run_items(
                items, itemgetter(1), model, workers_of(model, len(items)), stop=stop
            ):
                for (k, _), row in zip(chunk, found, strict=True):
                    rows[k] = row
                finished += len(chunk)
                done(finished)
    return rows


def container_key(case: Case) -> Hashable:
    """Equal for cases whose containers are the same, whatever floor they stand on."""
    solver = case.solver
    return (
        case.container,
        case.support,
        case.gravity_m_s2,
        case.folder,
        solver.model,
        solver.elastic_modes if solver.model == "reduced" else None,
        solver.element_size_m,
        solver.order,
        case.output.stop_when_overturned,
    )


def run_items(
    items: Sequence[ItemT],
    make: Callable[[ItemT], Case],
    model: str,
    pools: Sequence[Pool],
    *,
    stop: Callable[[], bool] = lambda: False,
) -> Iterator[tuple[list[ItemT], list[Row]]]:
    """Run one case for each item; yields items and their rows as they come, in any order.

    Args:
        items: in an order in which those of one container stand together.
        make: the case of an item; goes to the workers, so for processes it must be a module's function or a
            method of something that can be pickled.
        model: of all these cases.
        pools: who computes, from `LocalWorkers` or a cluster.
        stop: asked now and then; true ends the work when what has begun is done, and at once for `full`.
    """
    work = partial(run_chunk, make)
    return hand_out(items, work, pools, at_a_time=CASES_AT_A_TIME[model], stop=stop, finish=model != "full")


def run_chunk(make: Callable[[ItemT], Case], items: Sequence[ItemT]) -> list[Row]:
    """Run the cases of some items, one after the other."""
    began = time.perf_counter()
    prepared: list[Model | Row] = []
    for item in items:
        before = prepared[-1] if prepared and isinstance(prepared[-1], Model) else None
        prepared.append(_prepare(make, item, before))
    models = {k: one for k, one in enumerate(prepared) if isinstance(one, Model)}
    rows = [run_model(one) if isinstance(one, Model) else one for one in prepared]
    return _with_wall(rows, models, time.perf_counter() - began)


def _prepare(make: Callable[[ItemT], Case], item: ItemT, before: Model | None) -> Model | Row:
    """The model of an item; or its row, where there is nothing to be computed in common.

    It stands as the one before does, if nothing but the motion of the floor is another.
    """
    try:
        case = make(item).without_fields()
        if case.solver.model == "full":
            return _run_full(case)
        container = _SHELF.container_of(case)
        same = before is not None and before.container is container and stands_like(case, before.case)
        return build_model(case, container, before.footing if before is not None and same else None)
    except (ValueError, ArithmeticError, RuntimeError) as error:  # bad input, no stance, a singular matrix
        return _row_without_outcome("failed", str(error))


def run_model(model: Model) -> Row:
    """Step a rigid or reduced model to its end, in place; its row."""
    assert isinstance(model.body, ModalBody)
    run, duration, until = model.run, model.case.solver.duration_s, end_of_drive(model)
    try:
        status, kept = run_to_end(
            model.body,
            run,
            duration,
            aftermath=AFTERMATH / run.control.frequency_parameter,
            slip_until=until,
            cycle=min(model.case.motion.period, duration),
            strained=model.case.solver.model == "reduced",
        )
        return _row_of(model, status, kept, until)
    except (ValueError, ArithmeticError, RuntimeError) as error:
        return _row_without_outcome("failed", str(error))


def _row_of(model: Model, status: int, kept: KeptSamples, until: float) -> Row:
    """The row of a model that was stepped to its end."""
    run, interval = model.run, model.run.history.interval
    count = int(run.clock[0].samples)
    last = min(count - 1, int((until + 1e-9) / interval))
    numbers = np.arange(max(0, last + 1 - kept.slip.size), last + 1)
    stress = None
    if kept.strain.size:
        positions = kept.position[kept.strain >= 0.0]
        stress = _SHELF.recovery_of(model).largest_von_mises(positions)
    end = (count - 1) * interval if count else None
    verdict = verdict_from(model, end, numbers * interval, kept.slip[numbers % kept.slip.size], stress)
    if status == STEPPING_FAILED:
        error: str | None = stepping_failure(model, float(np.abs(run.work.law - run.work.force).max()))
    else:
        error = audit(model)
    if error is not None:
        return _row_without_outcome("failed", error) | _figures(verdict)
    ended = "overturned" if verdict["outcome"] == "overturned" else "completed"
    return _row_without_outcome(ended, None) | _figures(verdict) | {"outcome": verdict["outcome"]}


def _figures(verdict: Mapping[str, Any]) -> Row:
    """The figures of a verdict, without its outcome."""
    return {name: verdict[name] for name in SCALARS if name != "outcome"}


def _run_full(case: Case) -> Row:
    model = build_model(case, _SHELF.container_of(case))
    recorder = Recorder(model, recovery_of(model))
    ending = simulate(model, recorder)
    verdict = verdict_of(model, recorder.history(), recorder.largest_von_mises)
    row = _row_without_outcome(ending.status, ending.error) | _figures(verdict)
    return row if ending.status == "failed" else row | {"outcome": verdict["outcome"]}


def _with_wall(rows: list[Row], models: Mapping[int, Model], wall: float) -> list[Row]:
    """Give each row its share of the time that all took, by the steps it took."""
    steps = [float(models[k].run.clock[0].steps) if k in models else 0.0 for k in range(len(rows))]
    total = sum(steps) or 1.0
    for row, own in zip(rows, steps, strict=True):
        row["wall_s"] = wall * own / total if models else wall / len(rows)
    return rows


class Shelf:
    """The containers used last; safe for threads, and no container is built twice at once."""

    def __init__(self, room: int = 8) -> None:
        self._room = room
        self._lock = threading.Lock()
        self._held: dict[Hashable, Future[Container]] = {}
        self._recoveries: dict[int, tuple[Container, Recovery]] = {}

    def container_of(self, case: Case) -> Container:
        """The case's container, built if it is not there.

        Raises:
            CaseError, MeshError: bad input.
        """
        key = container_key(case)
        with self._lock:
            found = self._held.pop(key, None)
            mine = found is None
            promise = Future[Container]() if found is None else found
            self._held[key] = promise  # the one used last stands last
            while len(self._held) > self._room:
                del self._held[next(iter(self._held))]
        if mine:
            try:
                promise.set_result(discretise(case))
            except BaseException as error:
                promise.set_exception(error)
        return promise.result()

    def recovery_of(self, model: Model) -> Recovery:
        """How the stresses of a model's container are had; made once a container."""
        key = id(model.container)
        with self._lock:
            found = self._recoveries.get(key)
        if found is not None and found[0] is model.container:
            return found[1]
        made = recovery_of(model)
        with self._lock:
            self._recoveries[key] = (model.container, made)
            while len(self._recoveries) > self._room:
                del self._recoveries[next(iter(self._recoveries))]
        return made


_SHELF = Shelf()


def _row_without_outcome(status: str, reason: str | None) -> Row:
    return {"status": status, "reason": reason, "wall_s": 0.0} | dict.fromkeys(SCALARS)
