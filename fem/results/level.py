"""The level of a verdict: the gravest of what run, band and margin show. Card, lists and pages take it from here."""

import math
from enum import StrEnum

from fem.case.tables.input_ranges import TOLERANCE
from fem.case.uncertainty import InputChange
from fem.results.figures import RunFigures
from fem.results.outcome import ENDINGS, NOT_STANDING, ROCKING, SLIDING, Ending, Outcome
from fem.results.run_result import Band, ChangedRun, RunResult, Verdict

SURE, REGIME_UNSURE, UNSURE = "sure", "regime unsure", "unsure"
OF_THE_END = (
    "sure of the end"  #: the second of these, as people read it: all variations end alike, and move otherwise
)
#: factor below which a motion is hardly another one: by such changes "sure" was tried (`bench.py words`)
SAME_MOTION = 1.05


class Level(StrEnum):
    """The gravest of what a verdict says, in the words of lists; the gravest first."""

    OVERTURNS = "overturns"
    DESTROYS = "destroys a corner"
    MAY_OVERTURN = "may overturn"
    MAY_DESTROY = "may destroy a corner"
    UNSURE = "stands, which is not sure"  # for another reason than a variation that falls
    CUT = "stands until its run ends"
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
LARGE_ROTATION = 0.1  #: rotation ratio from which another size is another way to stand


def level_of(result: RunResult) -> Level:
    """The level of a run that has an outcome."""
    verdict = result.verdict or Verdict()
    if not stands(verdict):
        return Level.OVERTURNS if verdict.outcome == Outcome.OVERTURNED else Level.DESTROYS
    if fallen := fallen_in_band(verdict):
        return Level.MAY_OVERTURN if Ending.OVERTURNED in fallen[0] else Level.MAY_DESTROY
    _, own, most = slips_of(verdict)
    place = math.inf if verdict.place_m is None else verdict.place_m
    reached = (
        (verdict.sure == UNSURE, Level.UNSURE),
        (is_cut(result), Level.CUT),
        (own > place, Level.LEAVES),
        (only_just(verdict), Level.ONLY_JUST),
        (most > place, Level.MAY_LEAVE),
    )
    return next((level for reaches, level in reached if reaches), Level.STANDS)


def in_a_word(result: RunResult) -> str:
    """Its level as lists have it: of what stands, what it does."""
    verdict, level = result.verdict or Verdict(), level_of(result)
    if level not in (Level.STANDS, Level.CUT) or verdict.still_turned or verdict.still_sliding_m_s:
        return level
    word = STANDING[verdict.outcome or Outcome.REST]
    word += " until its run ends" if level == Level.CUT else ""
    if may_rock(verdict):
        return f"{word}, may rock"
    slides = verdict.outcome == Outcome.REST and not {*SLIDING}.isdisjoint((verdict.band or Band()).outcomes)
    return f"{word}, may slide" if slides else word


def is_cut(result: RunResult) -> bool:
    """True if the run ends while it moves, or before its motion: what follows is not known."""
    verdict = result.verdict or Verdict()
    moves = verdict.still_turned is not None or verdict.still_sliding_m_s is not None
    return moves or (result.motion is not None and result.motion.is_cut)


def may_rock(verdict: Verdict) -> bool:
    """True if it does not rock as given, and variations that stand turn far."""
    most = verdict.band.rotation_ratio if verdict.band else None
    return (
        stands(verdict) and verdict.outcome not in ROCKING and most is not None and most[1] > LARGE_ROTATION
    )


def only_just(verdict: Verdict) -> bool:
    """True if it stands, and does not under a motion that is hardly another one."""
    factor = verdict.margin.governing.factor if verdict.margin and verdict.margin.governing else None
    return stands(verdict) and factor is not None and factor < SAME_MOTION


def sure_in_words(result: RunResult) -> str:
    """How sure the outcome is, as people read it; empty where nothing was tried."""
    verdict = result.verdict or Verdict()
    if verdict.sure in (None, UNSURE):
        return verdict.sure or ""
    if stands(verdict) and (is_cut(result) or only_just(verdict)):
        return Level.CUT if is_cut(result) else Level.ONLY_JUST
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


def fallen_in_band(verdict: Verdict) -> tuple[dict[Ending, int], int] | None:
    """How many variations do not stand under the motion of the run, by their end, of how many; None where all stand."""
    members = verdict.band.members[1:] if verdict.band is not None else ()
    tried = [ending(run) for run in members if run.outcome is not None and not numerical(run)]
    fallen = {kind: tried.count(kind) for kind in NOT_STANDING if kind in tried}
    return (fallen, len(tried)) if fallen else None
