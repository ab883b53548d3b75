"""How much stronger the motion may be: the least factor on it at which the container overturns.

Both components of the floor's motion are multiplied by a factor. A scan tries factors up to `LARGEST`, of a container
that overturned up to 1; then each change between standing and overturning is located, the first one first. The same is
done near the first one with all unknown inputs drawn at once. An island narrower than a step of the scan may be missed.
"""

import math
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cache

from fem.case.case import Case
from fem.case.strength import scaled_motion
from fem.case.uncertainty import as_changed, draws_of
from fem.case.unknown_inputs import TOLERANCE, Value
from fem.model.container import Container, with_mass_of
from fem.model.equilibrium import same_equilibrium
from fem.model.model import Model, build_model
from fem.model.validity import runs_in_memory
from fem.results.outcome import Ending, ending_of
from fem.results.run_result import Margin, Numerics, RunResult, StaticResult, Verdict
from fem.run.bracket import Change, changes_of
from fem.run.changed_runs import DRAWN_TOLERANCE, cost_of
from fem.run.outcome import run_without_history
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.runtime.threads import cores
from fem.solid.nodal_body import full_model_memory

LARGEST = 4.0
#: of the scan: least ratio of neighbouring factors, most factors; largest number of runs with those that locate changes
STEP, MOST_SCANNED, MOST_RUNS = 1.15, 15, 25
#: width of a located change over its upper end; of the same change with drawn inputs, and the ratio of factors tried
RESOLUTION, DRAWN_RESOLUTION, DRAWN_STEP = 0.02, 0.04, 1.1
#: share of the uplift acceleration below which nothing rocks, however soft and whatever is not known
BELOW_UPLIFT = 0.6
LEAST = 0.05  #: smallest factor
#: draws, of a model whose runs are cheap; at least; runs that one takes; processor time for all, and for the scan [s]
DRAWS, LEAST_DRAWS, RUNS_A_DRAW, DRAWN_S, SCAN_S = 16, 6, 5, 2.5, 12.0

#: the ending under a factor, by the values of a change
Trial = Callable[[float], Ending]


class StoppedError(Exception):
    """A request to stop was heard."""


def wants_margin(asked: bool | None, case: Case, result: RunResult) -> bool:
    """Whether a finished run is to have a margin: as asked, else where a scan takes seconds; never without a motion."""
    outcome = (result.verdict or Verdict()).outcome
    if asked is False or outcome is None or not scaled_motion(case, 1.0):
        return False
    cost = MOST_RUNS * cost_of(result.numerics or Numerics())
    return bool(asked) or (case.solver.model != "full" and cost <= SCAN_S)


def margin_of(model: Model, result: RunResult, *, drawn: bool, stop: Callable[[], bool]) -> Margin | None:
    """Find the least factor on the motion at which a container overturns, and what is not known of it.

    Args:
        model: of the run; all trials have its container.
        result: of the run, which is the trial of factor 1.
        drawn: also with the unknown inputs drawn.
        stop: called in pauses; true ends the search.

    Returns:
        The margin, or None if it was stopped.
    """
    verdict = result.verdict or Verdict()
    own = ending_of(result.status, verdict.outcome)
    least = _least(model.case, result)
    workers = cores()
    if model.case.solver.model == "full":
        workers = runs_in_memory(workers, full_model_memory(len(model.container.elements.nodes)))
    trial = _trial(model, {}, stop)
    try:
        with ThreadPoolExecutor(max_workers=workers) as pool:
            largest = 1.0 if own == Ending.OVERTURNED else LARGEST
            scanned = _scanned(least, largest)
            known = {1.0: own} | dict(zip(scanned, pool.map(trial, scanned), strict=True))
            while own == Ending.OVERTURNED and known[least] == Ending.OVERTURNED and least > LEAST:
                least = max(LEAST, least / STEP**2)
                known[least] = trial(least)
            _locate(known, trial)
            first = _first(known)
            ends: list[float | None] = []
            if drawn:
                start = first.high if first else largest
                changes = draws_of(model.case, model.penalty, _draws(model.case, result))
                near = [
                    pool.submit(_near, _trial(model, change.values, stop), start, least) for change in changes
                ]
                ends = [one.result() for one in near]
    except StoppedError:
        return None
    factor = None if first is None else first.high
    tried = [one for one in (factor, *ends) if one is not None]
    return Margin(
        factor=factor,
        stands_up_to=None if first is None or first.low == 0.0 else first.low,
        low=min(tried) if ends and tried else None,
        high=max(tried) if ends and None not in (factor, *ends) else None,
        draws=len(ends),
        draws_standing=ends.count(None),
        islands=_islands(known),
        least_tried=min(known),
        largest_tried=max(known),
        runs=len(known) - 1,
    )


def _least(case: Case, result: RunResult) -> float:
    """The least factor that may overturn; what is pushed or tilted at the start may fall at any."""
    initial = case.initial
    if initial.rotation_rad or initial.angular_velocity_rad_s or initial.velocity_m_s:
        return LEAST
    use = (result.static or StaticResult()).ruling.utilisation_overturning
    return LEAST if not use or use < 0.0 else min(LARGEST, max(LEAST, BELOW_UPLIFT / use))


def _scanned(least: float, largest: float) -> list[float]:
    """Factors of the scan in steps of one ratio, 1 left out: that is the run."""
    if least >= largest:
        return [least]
    count = min(MOST_SCANNED, math.ceil(math.log(largest / least) / math.log(STEP)))
    ratio = (largest / least) ** (1.0 / count)
    factors = [*(least * ratio**k for k in range(count)), largest]
    return [factor for factor in factors if abs(factor - 1.0) > 1e-9]


def _locate(known: dict[float, Ending], trial: Trial) -> None:
    """Halve the changes that are too wide, the lowest first, until all are narrow or no run is left."""
    while len(known) <= MOST_RUNS:
        wide = [one for one in _changes(known) if one.high - one.low > RESOLUTION * one.high]
        if not wide:
            return
        middle = math.sqrt(wide[0].low * wide[0].high)
        known[middle] = trial(middle)


def _changes(known: dict[float, Ending]) -> list[Change]:
    """Neighbouring factors of which one stands and the other overturns; failed runs say nothing."""
    said = {factor: ending.word for factor, ending in known.items() if ending != Ending.FAILED}
    return changes_of(said)


def _first(known: dict[float, Ending]) -> Change | None:
    """The first factor that overturns and the one below it, 0 where there is none; None if all stand."""
    fallen = [factor for factor, ending in known.items() if ending == Ending.OVERTURNED]
    if not fallen:
        return None
    falls = [one for one in _changes(known) if one.high == min(fallen)]
    return falls[0] if falls else Change(low=0.0, high=min(fallen), below="", above=Ending.OVERTURNED.word)


def _islands(known: dict[float, Ending]) -> tuple[tuple[float, float], ...]:
    """Where it stands again beyond the first factor that overturns: the least and the largest factor of each."""
    found: list[list[float]] = []
    fallen = False
    for factor in sorted(known):
        if known[factor] == Ending.OVERTURNED:
            fallen = True
            found.append([])
        elif known[factor] == Ending.STANDING and fallen:
            found[-1].append(factor)
    return tuple((island[0], island[-1]) for island in found if island)


def _near(trial: Trial, start: float, least: float) -> float | None:
    """The factor near `start` from which a changed case overturns; None: none up to the largest."""
    low, high = start, start
    if trial(start) == Ending.OVERTURNED:
        while low > least and (low := max(least, low / DRAWN_STEP)) and trial(low) == Ending.OVERTURNED:
            high = low
    else:
        while low < LARGEST and trial(high := min(LARGEST, low * DRAWN_STEP)) != Ending.OVERTURNED:
            low = high
        if low >= LARGEST:
            return None
    while high - low > DRAWN_RESOLUTION * high:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if trial(middle) == Ending.OVERTURNED else (middle, high)
    return high


def _draws(case: Case, result: RunResult) -> int:
    """How many draws the time allows."""
    runs = DRAWN_S / max(cost_of(result.numerics or Numerics()), 1e-9)
    return min(case.uncertainty.draws, DRAWS, max(LEAST_DRAWS, int(runs / RUNS_A_DRAW)))


def _trial(model: Model, values: Mapping[str, Value], stop: Callable[[], bool]) -> Trial:
    """What runs the changed case under a factor."""
    own = model.case
    coarse: dict[str, Value] = {
        "output.fields_s": 0.0,
        TOLERANCE: max(DRAWN_TOLERANCE, own.solver.energy_tolerance),
    }

    @cache
    def container() -> Container:
        return with_mass_of(own.with_values(as_changed(own, values)), model.container, own)

    def ending(factor: float) -> Ending:
        if stop():
            raise StoppedError
        try:
            case = own.with_values(as_changed(own, {**values, **scaled_motion(own, factor), **coarse}))
            shared = model.equilibrium if same_equilibrium(case, own) else None
            return _ending(build_model(case, container(), shared), stop)
        except (ValueError, ArithmeticError, RuntimeError):  # a motion too strong for its key, no equilibrium
            return Ending.FAILED

    return ending


def _ending(model: Model, stop: Callable[[], bool]) -> Ending:
    if model.case.solver.model != "full":
        verdict, error = run_without_history(model, None)
        return Ending.FAILED if error else ending_of("completed", verdict.outcome)
    ending = simulate(model, Recorder(model, None), stop=stop)
    if ending.status == "interrupted":
        raise StoppedError
    return Ending.OVERTURNED if ending.status == "overturned" else ending_of(ending.status, "stands")
