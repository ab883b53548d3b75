"""How much stronger the motion may be: the least factor on it at which the container overturns.

Both components of the floor's motion are multiplied by a factor. A scan tries factors up to `LARGEST`, of a container
that overturned up to 1; then each change between standing and overturning is located, the first one first. Runs that
are left halve the widest steps before the first one. The same is done near the first one with all unknown inputs drawn
at once. An island narrower than the steps may be missed.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import cache
from itertools import pairwise

from fem.assessment.sureness import ending, numerical
from fem.assessment.verdict import outcome_of
from fem.case.case import Case, CaseError
from fem.case.strength import scaled_motion
from fem.case.tables.input_keys import TOLERANCE
from fem.case.tables.input_ranges import Value
from fem.case.tables.links import ROWS
from fem.case.uncertainty import as_changed, draws_of
from fem.model.container import Container, changed_container, without_links
from fem.model.equilibrium import same_equilibrium
from fem.model.model import Model, build_model
from fem.model.motion import peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.outcome import Ending, Outcome, ending_of
from fem.results.run_result import Margin, Numerics, RunResult, Verdict
from fem.run.bracket import Change, changes_of
from fem.run.changed_runs import cost_of, tolerance_of_draws, workers_for
from fem.run.outcome import run_without_history
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

LARGEST = 4.0
#: of the scan: least ratio of neighbouring factors, most factors; largest number of runs with those that locate changes
STEP, MOST_SCANNED, MOST_RUNS = 1.15, 15, 25
LOCATING = 2  #: runs that locate a change in half a step of the scan
#: width of a located change over its upper end; of the same change with drawn inputs, and the ratio of factors tried
RESOLUTION, DRAWN_RESOLUTION, DRAWN_STEP = 0.02, 0.04, 1.1
#: share of the uplift acceleration below which nothing rocks, however soft and whatever is not known
SURELY_AT_REST = 0.6
LEAST = 0.05  #: smallest factor
#: draws, of a model whose runs are cheap; at least; runs that one takes; processor time for all, and for the scan [s]
DRAWS, LEAST_DRAWS, RUNS_A_DRAW, DRAWN_S, SCAN_S = 16, 6, 5, 2.5, 12.0

#: endings that say whether it overturns; a run that failed does not, nor one that destroyed a corner
SAID = (Ending.STANDING, Ending.OVERTURNED)
#: the ending under a factor, by the values of a change
Trial = Callable[[float], Ending]


class StoppedError(Exception):
    """A request to stop was heard."""


def wants_margin(choice: bool | None, case: Case, result: RunResult) -> bool:
    """Whether a finished run gets a margin: as chosen, else where a scan takes seconds; never without a motion.

    A run that is not valid has none.
    """
    outcome = (result.verdict or Verdict()).outcome
    if choice is False or outcome in (None, Outcome.INVALID) or not scaled_motion(case, 1.0):
        return False
    cost = MOST_RUNS * cost_of(result.numerics or Numerics())
    return bool(choice) or (case.solver.model != "full" and cost <= SCAN_S)


def margin_of(model: Model, result: RunResult, *, drawn: bool, stop: Callable[[], bool]) -> Margin | None:
    """Find the least factor on the motion at which a container overturns, and how uncertain it is.

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
    least = _least(model)
    most = _largest(model.case)
    trial = _trial(model, {}, stop)
    try:
        with ThreadPoolExecutor(max_workers=workers_for(model, MOST_SCANNED)) as pool:
            known = _searched(own, least, most, trial, pool)
            least = min(known)
            first, ended = _first(known), [factor for factor in known if known[factor] in SAID]
            bare = _bare(model, least, most, pool, stop)
            ends: list[float | None] = []
            lowest = None
            if drawn:
                start = first.high if first else max(ended)
                changes = draws_of(model.case, model.penalty, _draws(model.case, result))
                trials = [_trial(model, change.values, stop) for change in changes]
                near = [pool.submit(_near, trial, start, least, most) for trial in trials]
                ends = [future.result() for future in near]
                by_band = 1.0 if own == Ending.STANDING and _overturns_in_band(verdict) else None
                lowest = _lowest(pool, trials, [*ends, first.high if first else None, by_band], least)
    except StoppedError:
        return None
    factor = None if first is None else first.high
    factors = [end for end in ends if end is None or not math.isnan(end)]
    return Margin(
        factor=factor,
        stands_up_to=None if first is None or first.low == 0.0 else first.low,
        low=lowest,
        high=_highest([factor, *factors]) if factors else None,
        draws=len(factors),
        draws_standing=factors.count(None),
        draws_failed=len(ends) - len(factors),
        draws_tried_to=most if ends else None,
        islands=_islands(known),
        least_tried=min(ended),
        largest_tried=max(ended),
        runs=len(ended) - 1,
        destroyed_from=min((factor for factor in known if known[factor] == Ending.INVALID), default=None),
        factor_without_links=None if bare is None else bare[0],
        without_links_tried_to=None if bare is None else bare[1],
    )


def _overturns_in_band(verdict: Verdict) -> bool:
    """Whether a member of the band overturns under the motion of the run, by another input."""
    members = verdict.band.members[1:] if verdict.band else ()
    return any(ending(member) == Ending.OVERTURNED and not numerical(member) for member in members)


def _bare(
    model: Model, least: float, most: float, pool: Executor, stop: Callable[[], bool]
) -> tuple[float | None, float] | None:
    """The first factor that overturns the container without stops, ties and neighbours, and the largest one tried.

    None where it has none of them.
    """
    if not (model.case.links or model.case.neighbour):
        return None
    free = model.case.with_values({name: [] for name in ROWS})
    try:
        bare = build_model(free, without_links(model.case, model.container))
    except (ValueError, ArithmeticError, RuntimeError):  # it does not stand without them
        return None
    trial = _trial(bare, {}, stop)
    known = _searched(trial(1.0), least, most, trial, pool)
    first, ended = _first(known), [factor for factor in known if known[factor] in SAID]
    return (None if first is None else first.high, max(ended)) if ended else None


def _least(model: Model) -> float:
    """The least factor that may overturn one of the row; what is pushed or tilted at the start may fall at any."""
    case, peaks = model.case, peaks_in_run(model.case, model.motion, model.vertical)
    if case.initial.is_pushed:
        return LEAST
    row = zip(case.row, model.container.row, strict=True)
    rules = [model.static.ruling, *(static_checks_of(case, alone.mesh, *peaks).ruling for case, alone in row)]
    uses = [rule.overturning.utilisation for rule in rules]
    if [
        *case.stop,
        *case.neighbour,
        *(tie for tie in case.tie if tie.to == "wall"),
    ]:  # what slides may fall over it
        uses += [rule.sliding.utilisation or math.inf for rule in rules]
    use = max((use for use in uses if use is not None), default=0.0)
    return LEAST if use <= 0.0 else min(LARGEST, max(LEAST, SURELY_AT_REST / use))


def _largest(case: Case) -> float:
    """The largest factor that the keys of the motion allow, in steps of the scan, at least 1."""
    factor = LARGEST
    while factor > 1.0:
        try:
            case.with_values(scaled_motion(case, factor))
        except CaseError:
            factor /= STEP
        else:
            return factor
    return 1.0


def _scanned(least: float, largest: float) -> list[float]:
    """Factors of the scan in steps of one ratio, 1 left out: that is the run."""
    if least >= largest:
        return [least]
    count = min(MOST_SCANNED, math.ceil(math.log(largest / least) / math.log(STEP)))
    ratio = (largest / least) ** (1.0 / count)
    factors = [*(least * ratio**k for k in range(count)), largest]
    return [factor for factor in factors if abs(factor - 1.0) > 1e-9]


def _searched(own: Ending, least: float, most: float, trial: Trial, pool: Executor) -> dict[float, Ending]:
    """The endings under the factors of a search; `own`: that of the run itself, `most`: largest factor allowed."""
    scanned = _scanned(least, 1.0 if own == Ending.OVERTURNED else most)
    known = {1.0: own} | dict(zip(scanned, pool.map(trial, scanned), strict=True))
    while own == Ending.OVERTURNED and known[least] == Ending.OVERTURNED and least > LEAST:
        least = max(LEAST, least / STEP**2)
        known[least] = trial(least)
    _locate(known, trial)
    _narrow(known, trial)
    return known


def _locate(known: dict[float, Ending], trial: Trial) -> None:
    """Halve the changes that are too wide, the lowest first, until all are narrow or no run is left."""
    while len(known) <= MOST_RUNS:
        middles = [
            math.sqrt(change.low * change.high)
            for change in _changes(known)
            if change.high - change.low > RESOLUTION * change.high
        ]
        left = [middle for middle in middles if middle not in known]  # those that failed are
        if not left:
            return
        known[left[0]] = trial(left[0])


def _narrow(known: dict[float, Ending], trial: Trial) -> None:
    """Halve the widest step before the first factor that overturns as long as runs are left; locate what it finds.

    Of a container that stands, steps from its own motion on, the weakest of equal ones first: the question is how much
    stronger that may be.
    """
    while len(known) <= MOST_RUNS - LOCATING:
        first = _first(known)
        end = max(known) if first is None else first.high
        begin = 1.0 if end > 1.0 else 0.0
        factors = sorted(factor for factor in known if begin <= factor <= end)
        steps = list(pairwise(factors))
        if not steps:
            return
        low, high = max(steps, key=lambda step: (round(step[1] / step[0], 6), -step[0]))
        if high - low <= RESOLUTION * high:
            return
        middle = math.sqrt(low * high)
        known[middle] = trial(middle)
        if known[middle] == Ending.OVERTURNED:
            _locate(known, trial)


def _changes(known: dict[float, Ending]) -> list[Change]:
    """Neighbouring factors of which one stands and the other overturns; others say nothing."""
    words = {factor: ending.word for factor, ending in known.items() if ending in SAID}
    return changes_of(words)


def _first(known: dict[float, Ending]) -> Change | None:
    """The first factor that overturns and the one below it, 0 where there is none; None if all stand."""
    fallen = [factor for factor, ending in known.items() if ending == Ending.OVERTURNED]
    if not fallen:
        return None
    falls = [change for change in _changes(known) if change.high == min(fallen)]
    return falls[0] if falls else Change(low=0.0, high=min(fallen), below="", above=Ending.OVERTURNED.word)


def _islands(known: dict[float, Ending]) -> tuple[tuple[float, float], ...]:
    """Where it stands again beyond the first factor that overturns: the least and the largest factor of each."""
    islands: list[list[float]] = []
    fallen = False
    for factor in sorted(known):
        if known[factor] == Ending.OVERTURNED:
            fallen = True
            islands.append([])
        elif known[factor] == Ending.STANDING and fallen:
            islands[-1].append(factor)
    return tuple((island[0], island[-1]) for island in islands if island)


def _near(trial: Trial, start: float, least: float, most: float) -> float | None:
    """The factor near `start` from which a changed case overturns; None: none up to `most`; nan: not known."""
    failed = False

    def falls(factor: float) -> bool:
        nonlocal failed
        ending = trial(factor)
        failed = failed or ending not in SAID
        return ending == Ending.OVERTURNED

    low, high = start, start
    if falls(start):
        while low > least and falls(low := max(least, low / DRAWN_STEP)):
            high = low
    else:
        while low < most and not falls(high := min(most, low * DRAWN_STEP)):
            low = high
        if low >= most:
            return math.nan if failed else None
    while high - low > DRAWN_RESOLUTION * high:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if falls(middle) else (middle, high)
    return math.nan if failed else high


def _lowest(
    pool: Executor, trials: Sequence[Trial], ends: Sequence[float | None], least: float
) -> float | None:
    """The least of the factors found, or one below it at which a draw overturns as well, one step after the other."""
    known = [end for end in ends if end is not None and not math.isnan(end)]
    low = min(known, default=None)
    while trials and low is not None and low > least:
        below = max(least, low / DRAWN_STEP)
        if Ending.OVERTURNED not in pool.map(lambda trial, factor=below: trial(factor), trials):
            break
        low = below
    return low


def _highest(ends: Sequence[float | None]) -> float | None:
    """The largest; None where there is none for one of them."""
    known = [end for end in ends if end is not None]
    return max(known) if len(known) == len(ends) else None


def _draws(case: Case, result: RunResult) -> int:
    """How many draws the time allows."""
    runs = DRAWN_S / max(cost_of(result.numerics or Numerics()), 1e-9)
    return min(case.uncertainty.draws, DRAWS, max(LEAST_DRAWS, int(runs / RUNS_A_DRAW)))


def _trial(model: Model, values: Mapping[str, Value], stop: Callable[[], bool]) -> Trial:
    """What runs the changed case under a factor."""
    own = model.case
    coarse: dict[str, Value] = {
        "output.fields_s": 0.0,
        TOLERANCE: tolerance_of_draws(own),
    }

    @cache
    def container() -> Container:
        return changed_container(own.with_values(as_changed(own, values)), model.container, own)

    def ending(factor: float) -> Ending:
        if stop():
            raise StoppedError
        try:
            case = own.with_values(as_changed(own, {**values, **_scaled(own, factor, values), **coarse}))
            shared = model.equilibrium if same_equilibrium(case, own) else None
            return _ending(build_model(case, container(), shared), stop)
        except (ValueError, ArithmeticError, RuntimeError):  # a motion too strong for its key, no equilibrium
            return Ending.FAILED

    return ending


def _scaled(own: Case, factor: float, values: Mapping[str, Value]) -> dict[str, float]:
    """`scaled_motion` with the sign of the motion that the values choose."""
    scaled = scaled_motion(own, factor)
    return {key: math.copysign(value, float(values.get(key, value))) for key, value in scaled.items()}


def _ending(model: Model, stop: Callable[[], bool]) -> Ending:
    """What a trial counts as."""
    if model.case.solver.model != "full":
        verdict, error = run_without_history(model, None)
        return Ending.FAILED if error else ending_of("completed", verdict.outcome)
    ending = simulate(model, Recorder(model, None), stop=stop)
    if ending.status == "interrupted":
        raise StoppedError
    return ending_of(ending.status, outcome_of(model))
