"""The level of a verdict: the gravest of what run, band and margin show. Card, lists and pages take it from here."""

import math
from enum import StrEnum

from fem.case.tables.input_ranges import TOLERANCE
from fem.case.uncertainty import InputChange
from fem.results.figures import RunFigures
from fem.results.outcome import ENDINGS, NOT_STANDING, Ending, Outcome
from fem.results.run_result import Band, ChangedRun, Verdict

SURE, REGIME_UNSURE, UNSURE = "sure", "regime unsure", "unsure"
#: factor below which a motion is hardly another one: by such changes "sure" was tried (`bench.py words`)
SAME_MOTION = 1.05


class Level(StrEnum):
    """The gravest of what a verdict says, in the words of lists; the gravest first."""

    OVERTURNS = "overturns"
    DESTROYS = "destroys a corner"
    MAY_OVERTURN = "may overturn"
    MAY_DESTROY = "may destroy a corner"
    UNSURE = "stands, which is not sure"  # for another reason than a variation that falls
    ENDS_ROCKING = "stands until its run ends"
    LEAVES = "leaves its place"
    ONLY_JUST = "stands only just"
    MAY_LEAVE = "may leave its place"
    STANDS = "stands"


#: what a container does that stands for sure, or of which nothing was varied; the gravest first
STANDING = {
    Outcome.SLIDE_ROCK: "slides, rocks and stands",
    Outcome.SLIDE: "slides and stands",
    Outcome.ROCK: "rocks and stands",
    Outcome.HOP: "lifts off and stands",
    Outcome.REST: "rests",
}


def level_of(verdict: Verdict) -> Level:
    """The level of the verdict of a run that has an outcome."""
    if not stands(verdict):
        return Level.OVERTURNS if verdict.outcome == Outcome.OVERTURNED else Level.DESTROYS
    if fallen := fallen_in_band(verdict):
        return Level.MAY_OVERTURN if fallen[0] == Ending.OVERTURNED else Level.MAY_DESTROY
    _, own, most = slips_of(verdict)
    place = math.inf if verdict.place_m is None else verdict.place_m
    reached = (
        (verdict.sure == UNSURE, Level.UNSURE),
        (verdict.still_turned is not None, Level.ENDS_ROCKING),
        (own > place, Level.LEAVES),
        (only_just(verdict), Level.ONLY_JUST),
        (most > place, Level.MAY_LEAVE),
    )
    return next((level for reaches, level in reached if reaches), Level.STANDS)


def in_a_word(verdict: Verdict) -> str:
    """Its level as lists have it: of what stands, what it does."""
    level = level_of(verdict)
    return STANDING[verdict.outcome or Outcome.REST] if level == Level.STANDS else level


def only_just(verdict: Verdict) -> bool:
    """True if it stands, and does not under a motion that is hardly another one."""
    factor = verdict.margin.governing.factor if verdict.margin and verdict.margin.governing else None
    return stands(verdict) and factor is not None and factor < SAME_MOTION


def sure_in_words(verdict: Verdict) -> str:
    """How sure the outcome is, as people read it; empty where nothing was tried."""
    if verdict.sure in (None, UNSURE):
        return verdict.sure or ""
    if verdict.still_turned or only_just(verdict):
        return Level.ENDS_ROCKING if verdict.still_turned else Level.ONLY_JUST
    if verdict.sure == SURE:
        return SURE
    return (
        f"sure that it {'overturns' if verdict.outcome == Outcome.OVERTURNED else 'stands'}, not how it moves"
    )


def slips_of(verdict: Verdict) -> tuple[float, float, float]:
    """Largest slip, on the floor or of a box on another: the least of the variations, its own, the largest [m]."""
    members = (verdict.band or Band()).members
    alike = [
        run.slipped_most for run in members if run.outcome is not None and ending(run) == ending(verdict)
    ]
    own = verdict.slipped_most
    return min([own, *alike]), own, max([own, *alike])


def ending(run: RunFigures) -> Ending:
    """What a run that did not fail counts as."""
    return ENDINGS.get(run.outcome or "", Ending.STANDING)


def stands(run: RunFigures) -> bool:
    """True if it neither overturned nor destroyed a corner."""
    return ending(run) == Ending.STANDING


def numerical(change: ChangedRun | InputChange) -> bool:
    """True if it changes how the run is computed, and no input."""
    return TOLERANCE in (change.values or {})


def fallen_in_band(verdict: Verdict) -> tuple[Ending, int, int] | None:
    """How variations end that do not stand under the motion of the run, how many, of how many; None where all stand."""
    members = verdict.band.members[1:] if verdict.band is not None else ()
    tried = [ending(run) for run in members if run.outcome is not None and not numerical(run)]
    return next(((kind, tried.count(kind), len(tried)) for kind in NOT_STANDING if kind in tried), None)
