"""How much stronger the motion may be: the least factor on it at which a container overturns or destroys a corner.

Both components of the floor's motion are multiplied by a factor. A scan tries factors up to `LARGEST`, of a container
that overturned up to 1, and none above one that destroys a corner. What ends the standing first is located; the runs
that are left halve steps below it, the wide ones and those at which the container turns most before the others. The
same is done with all unknown inputs drawn at once, each draw from the weakest motion up to its first end; of several
draws the factors are staggered. An island narrower than the steps that are left may be missed: `Governing.step`.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from functools import cache
from itertools import groupby, pairwise
from typing import Any, NamedTuple

from fem.case.case import Case, CaseError
from fem.case.strength import scaled_motion
from fem.case.tables.input_ranges import TOLERANCE, Value
from fem.case.tables.links import ROWS
from fem.case.uncertainty import all_changes, as_changed
from fem.model.container import Container, changed_container, without_links
from fem.model.equilibrium import same_equilibrium
from fem.model.model import Model, build_model
from fem.model.motion import peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.level import fallen_in_band
from fem.results.outcome import NOT_STANDING, Ending, Outcome, ending_of
from fem.results.run_result import Governing, Margin, Numerics, RunResult, Verdict
from fem.run.band import cost_of, key_of, tolerance_of_draws, worker_threads, workers_for
from fem.run.recorder import Recorder
from fem.run.simulation import run_without_history, simulate
from fem.run.verdict import outcome_of

LARGEST, LEAST = 4.0, 0.05  #: factors
#: share of the uplift acceleration below which nothing rocks, however soft, and whatever the unknown inputs are
SURELY_AT_REST = 0.6
SCANNED, STEP = 15, 1.15  #: most factors of a first scan, and their least ratio
#: width of a located end over the end, and of the finest steps below it; of drawn inputs
RESOLUTION, FINEST, DRAWN_RESOLUTION = 0.01, 0.005, 0.04
#: processor time of the runs of a case, and of its draws [s]; runs of a case at least and at most
OWN_S, DRAWN_S, LEAST_RUNS, MOST_RUNS = 1.0, 1.2, 25, 200
#: draws; of a model whose runs are dear; runs of one draw, and of these its first
DRAWS, LEAST_DRAWS, RUNS_A_DRAW, RISING = 16, 6, 5, 3
SCAN_S = 12.0  #: processor time up to which a margin is found unasked [s]
BATCH = 4  #: steps halved side by side, on any machine
STILL = 0.25  #: weight of a step at which nothing turns, over one at which the container nearly falls


class StoppedError(Exception):
    """A request to stop was heard."""


class Tried(NamedTuple):
    """What one factor led to."""

    ending: Ending
    turned: float  #: largest |rotation| over the slenderness angle


Trial = Callable[[float], Tried]


class Search:
    """The factors that were tried on one case."""

    def __init__(self, trial: Trial, known: Mapping[float, Tried]) -> None:
        self.trial, self.known = trial, dict(known)

    def of(self, *endings: Ending) -> list[float]:
        """The factors of these endings, from the least on."""
        return sorted(factor for factor, tried in self.known.items() if tried.ending in endings)

    def first(self, *endings: Ending) -> float | None:
        """The least factor of these endings."""
        return min(self.of(*endings), default=None)

    @property
    def end(self) -> float:
        """The first factor at which it does not stand, else the largest one at which it does."""
        return self.first(*NOT_STANDING) or max(self.of(Ending.STANDING), default=min(self.known))

    def steps(self, up_to: float) -> list[tuple[float, float]]:
        """Neighbouring factors up to one of those tried."""
        return [(low, high) for low, high in pairwise(sorted(self.known)) if high <= up_to]

    def rise(self, factors: Iterable[float]) -> None:
        """Try rising factors up to the first at which it does not stand, or the run fails."""
        for factor in factors:
            self.known[factor] = self.trial(factor)
            if self.known[factor].ending != Ending.STANDING:
                return

    def locate(self, resolution: float) -> None:
        """Halve the step below the first end until it is narrow."""
        while (end := self.first(*NOT_STANDING)) is not None:
            below = [factor for factor in self.known if factor < end]
            if not below or end - max(below) <= resolution * end:
                return
            middle = math.sqrt(max(below) * end)
            self.known[middle] = self.trial(middle)


def wants_margin(choice: bool | None, case: Case, result: RunResult) -> bool:
    """Whether a finished run gets a margin: as chosen, else where a scan takes seconds; never without a motion.

    A run that is not valid has none.
    """
    outcome = (result.verdict or Verdict()).outcome
    if choice is False or outcome in (None, Outcome.INVALID) or not scaled_motion(case, 1.0):
        return False
    cost = LEAST_RUNS * cost_of(result.numerics or Numerics())
    return bool(choice) or (case.solver.model != "full" and cost <= SCAN_S)


def margin_of(model: Model, result: RunResult, *, drawn: bool, stop: Callable[[], bool]) -> Margin | None:
    """Find the least factor on the motion at which a container overturns or destroys a corner, and what governs.

    Args:
        model, result: of the run, which is the trial of factor 1; all trials have its container.
        drawn: also with the unknown inputs drawn.
        stop: called in pauses; true ends the search.

    Returns:
        The margin, or None if it was stopped.
    """
    verdict, cost = result.verdict or Verdict(), max(cost_of(result.numerics or Numerics()), 1e-9)
    itself = Tried(ending_of(result.status, verdict.outcome), verdict.turned)
    own, least = Search(_trial(model, {}, stop), {1.0: itself}), _least(model)
    most, draws = _largest(model.case), []
    fallen = None if itself.ending == Ending.OVERTURNED else fallen_in_band(verdict)
    in_band = next(iter(fallen[0])) if fallen else None
    try:
        with worker_threads(workers := workers_for(model, SCANNED)) as pool:
            _scan(own, least, most, pool, workers)
            runs = LEAST_RUNS if model.case.solver.model == "full" else int(OWN_S / cost)
            runs = min(MOST_RUNS, max(LEAST_RUNS, runs))
            _narrow([own], runs, pool, RESOLUTION)
            linked = model.case.links or model.case.neighbour
            bare = _bare(model, least, most, runs, pool, stop) if linked else None
            begin = min(own.known) if in_band or itself.ending == Ending.OVERTURNED else 1.0
            if drawn:
                drawn_runs = int(DRAWN_S / cost)
                worst = _worst_draws(model, verdict, min(DRAWS, max(LEAST_DRAWS, drawn_runs // RUNS_A_DRAW)))
                # what is not known to stand at `begin` falls just above it, too
                draws = [
                    Search(_trial(model, values, stop), {begin: Tried(Ending.STANDING, turned)})
                    for values, turned in worst
                ]
                ratio = (own.end / begin) ** (1.0 / RISING)
                rising = (  # staggered, the last of each where the case itself ends
                    [begin * ratio ** (step + (k + 1) / len(draws)) for step in range(RISING - 1)] + [own.end]
                    for k in range(len(draws))
                )
                list(pool.map(Search.rise, draws, rising))
                _narrow(draws, drawn_runs, pool, DRAWN_RESOLUTION)
    except StoppedError:
        return None
    said = own.of(Ending.STANDING, Ending.OVERTURNED)
    factor, destroyed = own.first(Ending.OVERTURNED), own.first(Ending.INVALID)
    falls = [draw.first(Ending.OVERTURNED) for draw in draws if not draw.of(Ending.INVALID, Ending.FAILED)]
    first_falls = (factor, *(draw.first(Ending.OVERTURNED) for draw in draws))
    reached = [fall for fall in first_falls if fall is not None]
    if in_band == Ending.OVERTURNED:
        reached.append(1.0)
    # where it stands again beyond the first factor that overturns: least and largest factor of each
    beyond = [other for other in said if factor is not None and other > factor]
    by_ending = groupby(beyond, key=lambda other: own.known[other].ending)
    islands = [list(group) for end, group in by_ending if end == Ending.STANDING]
    return Margin(
        factor=factor,
        stands_up_to=max(
            (standing for standing in own.of(Ending.STANDING) if standing < (factor or 0.0)), default=None
        ),
        low=min(reached, default=None) if draws else None,
        high=max(reached) if draws and len(reached) > len(draws) and None not in falls else None,
        draws=len(falls),
        draws_standing=falls.count(None),
        draws_failed=len(draws) - len(falls),
        draws_tried_to=own.end if draws else None,
        islands=tuple((island[0], island[-1]) for island in islands),
        least_tried=min(said),
        largest_tried=max(said),
        runs=len(said) - 1,
        destroyed_from=destroyed,
        factor_without_links=None if bare is None else bare[0],
        without_links_tried_to=None if bare is None else bare[1],
        governing=_governing(own, draws, in_band),
    )


def _governing(own: Search, draws: Sequence[Search], in_band: Ending | None) -> Governing:
    """The least factor of all that were tried at which a container does not stand, and what it rests on."""
    failed = sum(draw.first(*NOT_STANDING) is None and bool(draw.of(Ending.FAILED)) for draw in draws)
    counts: dict[str, Any] = {
        "variations": len(draws) - failed,
        "variations_failed": failed or None,
        "variations_overturned": sum(draw.first(Ending.OVERTURNED) is not None for draw in draws),
        "variations_destroyed": sum(draw.first(Ending.INVALID) is not None for draw in draws),
    }
    ends = [
        (end, number) for number, search in enumerate((own, *draws)) if (end := search.first(*NOT_STANDING))
    ]
    factor, number = min(ends, default=(None, 0))
    if in_band and (factor is None or factor > 1.0):
        return Governing(factor=1.0, of="variations", ending=in_band.word, step=None, **counts)
    search = (own, *draws)[number]
    up_to = search.end if factor is None else factor
    asked = 1.0 if up_to > 1.0 else 0.0  # of one that falls under its own motion, all steps below
    steps = [high / low - 1.0 for low, high in search.steps(up_to) if low >= asked]
    return Governing(
        factor=factor,
        of="variations" if number else "case",
        ending=None if factor is None else search.known[factor].ending.word,
        step=max(steps, default=None),
        **counts,
    )


def _worst_draws(model: Model, verdict: Verdict, count: int) -> list[tuple[Mapping[str, Value], float]]:
    """The draws of all unknown inputs that turn most under the motion of the run, and how far, by its band."""
    members = verdict.band.members if verdict.band else ()
    turned = {key_of(member.values): member.turned for member in members}
    draws = [change.values for change in all_changes(model.case, model.penalty)[2]]
    known = sorted(((turned.get(key_of(values), 0.0), -k) for k, values in enumerate(draws)), reverse=True)
    return [(draws[-k], ratio) for ratio, k in known[:count]]


def _bare(
    model: Model, least: float, most: float, runs: int, pool: Executor, stop: Callable[[], bool]
) -> tuple[float | None, float] | None:
    """The first factor that overturns the container without stops, ties and neighbours, and the largest one tried.

    It is sought as that of the container with them.
    """
    free = model.case.with_values({name: [] for name in ROWS})
    try:
        bare = build_model(free, without_links(model.case, model.container))
    except (ValueError, ArithmeticError, RuntimeError):  # it does not stand without them
        return None
    trial = _trial(bare, {}, stop)
    search = Search(trial, {1.0: trial(1.0)})
    _scan(search, least, most, pool, SCANNED)
    _narrow([search], runs, pool, RESOLUTION)
    said = search.of(Ending.STANDING, Ending.OVERTURNED)
    return (search.first(Ending.OVERTURNED), max(said)) if said else None


def _least(model: Model) -> float:
    """The least factor that may overturn one of the row; what is pushed or tilted at the start may fall at any."""
    case, peaks = model.case, peaks_in_run(model.case, model.motion, model.vertical)
    if case.initial.is_pushed:
        return LEAST
    row = zip(case.row, model.container.row, strict=True)
    rules = [model.static.ruling, *(static_checks_of(case, alone.mesh, *peaks).ruling for case, alone in row)]
    uses = [rule.overturning.utilisation for rule in rules]
    if [*case.stop, *case.neighbour, *(tie for tie in case.tie if tie.to == "wall")]:
        uses += [rule.sliding.utilisation or math.inf for rule in rules]  # what slides may fall over it
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


def _scan(search: Search, least: float, most: float, pool: Executor, side_by_side: int) -> None:
    """A first scan in steps of one ratio from `least` to `most`, of what overturned to 1, and further down there."""
    largest = 1.0 if search.known[1.0].ending == Ending.OVERTURNED else most
    if least >= largest:
        factors = [least]
    else:
        count = min(SCANNED, math.ceil(math.log(largest / least) / math.log(STEP)))
        factors = [*(least * (largest / least) ** (k / count) for k in range(count)), largest]
    factors = [factor for factor in factors if abs(factor - 1.0) > 1e-9]
    for begin in range(0, len(factors), side_by_side):
        some = factors[begin : begin + side_by_side]
        search.known |= dict(zip(some, pool.map(search.trial, some), strict=True))
        if (last := search.first(Ending.INVALID)) is not None:  # none above one that destroys a corner counts
            search.known = {factor: tried for factor, tried in search.known.items() if factor <= last}
            break
    while search.known[lowest := min(search.known)].ending == Ending.OVERTURNED and lowest > LEAST:
        lower = max(LEAST, lowest / STEP**2)
        search.known[lower] = search.trial(lower)


def _narrow(searches: Sequence[Search], runs: int, pool: Executor, resolution: float) -> None:
    """Halve steps below the least end of several searches, until so many runs are made, and locate what ends first."""
    while True:
        end = min((search.end for search in searches), default=0.0)
        for search in searches:
            if search.end == end:
                search.locate(resolution)
        end = min((search.end for search in searches), default=0.0)
        left = runs - sum(len(search.known) for search in searches)
        wide = []
        for number, search in enumerate(searches):
            for low, high in search.steps(min(end, search.end)):
                if high > (1.0 + FINEST) * low:
                    turned = max(min(1.0, search.known[factor].turned) for factor in (low, high))
                    wide.append((math.log(high / low) * (STILL + turned), -low, number, high))
        chosen = sorted(wide, reverse=True)[: min(BATCH, left)]
        if left <= 0 or not chosen:
            return
        middles = [(searches[number], math.sqrt(-low * high)) for _, low, number, high in chosen]
        found = pool.map(lambda middle: middle[0].trial(middle[1]), middles)
        for (search, middle), tried in zip(middles, found, strict=True):
            search.known[middle] = tried


def _trial(model: Model, values: Mapping[str, Value], stop: Callable[[], bool]) -> Trial:
    """What runs the changed case under a factor."""
    own = model.case
    coarse: dict[str, Value] = {"output.fields_s": 0.0, TOLERANCE: tolerance_of_draws(own)}

    @cache
    def container() -> Container:
        return changed_container(own.with_values(as_changed(own, values)), model.container, own)

    def tried(factor: float) -> Tried:
        if stop():
            raise StoppedError
        try:
            scaled = {  # with the sign of the motion that the values choose
                key: math.copysign(value, float(values.get(key, value)))
                for key, value in scaled_motion(own, factor).items()
            }
            case = own.with_values(as_changed(own, {**values, **scaled, **coarse}))
            shared = model.equilibrium if same_equilibrium(case, own) else None
            return _tried(build_model(case, container(), shared), stop)
        except (ValueError, ArithmeticError, RuntimeError):  # a motion too strong for its key, no equilibrium
            return Tried(Ending.FAILED, 0.0)

    return tried


def _tried(model: Model, stop: Callable[[], bool]) -> Tried:
    """What a trial counts as."""
    if model.case.solver.model != "full":
        verdict, error = run_without_history(model, None)
        return Tried(Ending.FAILED if error else ending_of("completed", verdict.outcome), verdict.turned)
    end = simulate(model, Recorder(model, None), stop=stop)
    if end.status == "interrupted":
        raise StoppedError
    rotation = float(model.run.track[0].max_rotation)
    return Tried(ending_of(end.status, outcome_of(model)), rotation / model.static.slenderness_angle)
