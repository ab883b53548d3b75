"""How sure a verdict is, in words: what its variations showed, and what decides.

Every sentence is made from the members of the band: how many of them stand, what those do that move in another way, and
for what decides between standing and falling the value at which the draws change.
"""

from collections.abc import Iterator, Sequence, Set
from math import comb

from fem.assessment.sureness import (
    SURE,
    UNSURE,
    below_uplift,
    ending,
    numerical,
    rests_on_stiff_floor,
    stands,
    static_use,
)
from fem.case.tables.unknown_inputs import WORDS, in_words, value_in_words
from fem.results.figures import FIGURES, SLIPPED, TURNED
from fem.results.outcome import ROCKING, SLIDING, Ending, Outcome
from fem.results.run_result import Band, ChangedRun, RunResult, Verdict
from fem.runtime.intervals import binomial_interval
from fem.runtime.units import JOINT_MILLIMETRES

CONFIDENCE = 0.95
MOST_NAMED = 2  #: inputs in a sentence
DOES = {
    Ending.STANDING: "stands",
    Ending.OVERTURNED: "overturns",
    Ending.INVALID: "destroys a corner",
}


def sureness_in_words(result: RunResult) -> str:
    """One to three sentences; empty if the band was not computed, or the run is not valid."""
    verdict = result.verdict or Verdict()
    band = verdict.band
    if verdict.outcome == Outcome.INVALID:
        return ""
    if verdict.sure is None:  # no band, or one of a former version
        return "Unsure: see the band." if band is not None and band.unsure else ""
    if band is None:
        used = static_use(result) or 0.0
        return f"Sure by the static rule alone: its utilisation is {used:.2f} and nothing else acts."
    tried = [member for member in band.members[1:] if member.outcome is not None]
    if not tried:
        return (
            "Nothing was varied: all inputs are held."
            if len(band.members) == 1
            else "Unsure: no variation ended."
        )
    if verdict.sure == UNSURE:
        return f"Unsure: {'; '.join(_doubts(verdict, band, tried))}."
    does = DOES[ending(band.members[0])]
    if verdict.sure == SURE and all(map(numerical, tried)):
        return f"No input was varied, all are held; {does} with steps ten times as accurate, too."
    in_all = f"in all {len(tried)} variations" if len(tried) > 1 else "in the one variation"
    if verdict.sure == SURE:
        return f"Sure: {does} {in_all}."
    return f"{does.capitalize()} {in_all}. {_other_regime(verdict, band)}."


def _doubts(verdict: Verdict, band: Band, tried: Sequence[ChangedRun]) -> Iterator[str]:
    """Why it is not sure whether it stands."""
    own = band.members[0]
    crossing = [member for member in tried if ending(member) != ending(own) and not numerical(member)]
    draws = [member for member in tried if member.kind == "draw"]
    if crossing:
        drawn = [draw for draw in draws if draw in crossing]
        alone = [member for member in crossing if member.kind != "draw"]
        for kind, does in DOES.items():
            if alike := [member for member in alone if ending(member) == kind]:
                yield f"{does} with {changes_in_words(alike)}"
        if drawn:
            yield _counted(draws) + _value_that_decides(draws)
        elif draws:
            undrawn = any(not set(member.values or {}) <= set(draws[0].values or {}) for member in alone)
            yield f"not in {len(draws)} draws of {'the other' if undrawn else 'all'} inputs at once"
    if verdict.numerically_unsure:
        verb = next(
            DOES[ending(member)] for member in tried if numerical(member) and ending(member) != ending(own)
        )
        yield f"numerically: it {verb} with steps ten times as accurate"
    if below_uplift(band.members):
        does = "rests" if rests_on_stiff_floor(band.members) else "still rocks"
        yield f"it is below uplift of a rigid block, and on a floor thirty times as stiff it {does}"
    if failed := [member for member in band.members if member.outcome is None]:
        alone = [member for member in failed if member.kind != "draw"]
        of_them = f", among them with {changes_in_words(alone)}" if alone else ""
        yield f"{len(failed)} of {len(band.members) - 1} variations have no outcome{of_them}"
    if band.left_out:
        yield f"{len(band.left_out)} changes were left out for time"


def changes_in_words(runs: Sequence[ChangedRun]) -> str:
    """What was changed in the first of these runs, each by itself, and how many more there are."""
    words = [in_words(run.values or {}) for run in runs[:MOST_NAMED]]
    more = len(runs) - MOST_NAMED
    if more > 0:
        words.append(f"one of {more} other changes" if more > 1 else "another change")
    return ", or with ".join(words)


def _counted(draws: Sequence[ChangedRun]) -> str:
    """How many draws overturned, and how many destroyed a corner, with the intervals of their shares."""
    parts = []
    for kind, words in ((Ending.OVERTURNED, "overturned"), (Ending.INVALID, "a corner destroyed")):
        count = sum(ending(draw) == kind for draw in draws)
        if count or (kind == Ending.OVERTURNED and all(map(stands, draws))):
            low, high = binomial_interval(count, len(draws), CONFIDENCE)
            parts.append(
                f"{words} in {count} of {len(draws)} draws (95 %: {100.0 * low:.0f} to {100.0 * high:.0f} %)"
            )
    return ", ".join(parts)


def _value_that_decides(draws: Sequence[ChangedRun]) -> str:
    """The input and its value beyond which all draws end in one way; empty if chance alone may give such a value.

    Draws that have nothing to do with an input leave the k largest (or smallest) of n values to s draws of one kind
    with the probability C(s, k)/C(n, k); that of all inputs and sides together is below 1 - CONFIDENCE.
    """
    keys, valid = draws[0].values or {}, all(ending(draw) != Ending.INVALID for draw in draws)
    least: tuple[float, str] = (1.0 - CONFIDENCE, "")
    for key in keys:
        known = [
            (value, stands(draw))
            for draw in draws
            if isinstance(value := (draw.values or {}).get(key), float)
        ]
        for standing, words in ((True, "stand"), (False, "overturn" if valid else "do not stand")):
            same = [value for value, stood in known if stood is standing]
            others = [value for value, stood in known if stood is not standing]
            if not same or not others:
                continue
            for beyond, limit, side in (
                (sum(value > max(others) for value in same), max(others), "above"),
                (sum(value < min(others) for value in same), min(others), "below"),
            ):
                chance = 4 * len(keys) * comb(len(same), beyond) / comb(len(known), beyond)
                if chance < least[0]:
                    value = value_in_words(key, limit)
                    least = chance, f"; all {beyond} with {WORDS[key]} {side} {value} {words}"
    return least[1]


def _other_regime(verdict: Verdict, band: Band) -> str:
    """What variations do otherwise and what decides, with the ranges of slip and rotation."""
    own, own_fell, on = (
        band.members[0].outcome,
        band.members[0].fell_in_row,
        deciding_in_words(verdict.decided_by),
    )
    others = {member.outcome for member in band.members if member.outcome is not None} - {own}
    if own == Outcome.OVERTURNED:
        another = "container" if own_fell else "box"
        return f"Another {another} may fall first{on and f', depending on {on}'}"
    may = _may(Outcome(own), {Outcome(other) for other in others}) if own else ""
    if may:
        lead = f"It may {may}{on and f', depending on {on}'}"
    else:
        lead = f"How far it moves depends on {on}" if on else "How far it moves is not known"
    slip, ratio = (FIGURES[key].unit.range_text(band[key]) for key in (SLIPPED, TURNED))
    between = max((box.max_slip_m for box in (band.boxes or ())[1:]), key=max, default=None)
    joints = f" on the floor and {JOINT_MILLIMETRES.range_text(between)} between boxes" if between else ""
    return f"{lead}. Slip is {slip}{joints}, the rotation ratio {ratio}"


def _may(own: Outcome, others: Set[Outcome]) -> str:
    """What those that stand do otherwise: first what the run does not do, else what they leave out."""
    if own == Outcome.SLIDE and Outcome.ROCK in others:
        return "rock instead of slide"
    if own == Outcome.ROCK and Outcome.SLIDE in others:
        return "slide instead of rock"
    further = [
        word
        for word, doing in (("slide", SLIDING), ("rock", ROCKING))
        if own not in doing and not others.isdisjoint(doing)
    ]
    less = {
        Outcome.SLIDE: "slide without rocking",
        Outcome.ROCK: "rock without sliding",
        Outcome.HOP: "hop",
        Outcome.REST: "rest",
    }
    return " or ".join(further or [words for kind, words in less.items() if kind in others])


def deciding_in_words(keys: Sequence[str]) -> str:
    """The inputs that decide, as far as a sentence holds them."""
    named = [WORDS.get(key, key) for key in keys[:MOST_NAMED]]
    if len(keys) > MOST_NAMED:
        return f"{', '.join(named)} and others"
    return " and ".join(named)
