"""How sure a verdict is, in words: what its variations showed, and what decides.

Every sentence is made from the members of the band: how many of them stand, what those do that move in another way, and
for what decides between standing and falling the value at which the draws change.
"""

from collections.abc import Iterator, Sequence, Set

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
from fem.case.unknown_inputs import WORDS, in_words
from fem.results.figures import FIGURES, SLIPPED, TURNED
from fem.results.outcome import ROCKING, SLIDING, Ending, Outcome
from fem.results.run_result import Band, ChangedRun, RunResult, Verdict
from fem.runtime.intervals import binomial_interval

CONFIDENCE = 0.95
LEAST_SHARE, LEAST_DRAWS = 0.25, 4  #: of the draws, on one side of a value from which that value is named
MOST_NAMED = 2  #: inputs in a sentence
DOES = {
    Ending.STANDING: "stands",
    Ending.OVERTURNED: "overturns",
    Ending.INVALID: "destroys a corner, which is not valid,",
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
        return (
            f"Sure: the utilisation of the static rule is {used:.2f} and nothing else acts, so this motion was not "
            "repeated with other inputs."
        )
    tried = [one for one in band.members[1:] if one.outcome is not None]
    if not tried:
        return (
            "Nothing was varied: all inputs are held."
            if len(band.members) == 1
            else "Unsure: no variation ended."
        )
    if verdict.sure == UNSURE:
        return f"Unsure: {'; '.join(_doubts(verdict, band, tried))}."
    does = DOES[ending(band.members[0])]
    if verdict.sure == SURE:
        all_of_them = f"all {len(tried)} variations" if len(tried) > 1 else "the one variation"
        return f"Sure: {does} in {all_of_them}."
    return f"{does.capitalize()} in all {len(tried)} variations. {_other_regime(verdict, band)}{_depending(verdict)}."


def _doubts(verdict: Verdict, band: Band, tried: Sequence[ChangedRun]) -> Iterator[str]:
    """Why it is not sure whether it stands."""
    own = band.members[0]
    crossing = [one for one in tried if ending(one) != ending(own) and not numerical(one)]
    draws = [one for one in tried if one.kind == "draw"]
    if crossing:
        drawn = [one for one in draws if one in crossing]
        alone = [one for one in crossing if one.kind != "draw"]
        for kind, does in DOES.items():
            if alike := [one for one in alone if ending(one) == kind]:
                named = [in_words(one.values or {}) for one in alike[:MOST_NAMED]]
                more = f" and {len(alike) - len(named)} other changes" if len(alike) > len(named) else ""
                yield f"{does} with {' and with '.join(named)}{more}"
        if drawn:
            yield _counted(draws) + _value_that_decides(draws)
        elif draws:
            undrawn = any(not set(one.values or {}) <= set(draws[0].values or {}) for one in alone)
            yield f"not in {len(draws)} draws of {'the other' if undrawn else 'all'} inputs at once"
    if verdict.numerically_unsure:
        verb = next(DOES[ending(one)] for one in tried if numerical(one) and ending(one) != ending(own))
        yield f"numerically, for it {verb} with steps ten times as accurate"
    if below_uplift(band.members):
        found = "rests" if rests_on_stiff_floor(band.members) else "still rocks"
        yield f"it is below uplift of a rigid block, and on a floor thirty times as stiff it {found}"
    if failed := sum(one.outcome is None for one in band.members):
        yield f"{failed} of {len(band.members) - 1} variations failed"
    if band.left_out:
        yield f"{len(band.left_out)} changes were left out for time"


def _counted(draws: Sequence[ChangedRun]) -> str:
    """How many draws overturned, and how many destroyed a corner, with the intervals of their shares."""
    parts = []
    for found, word in ((Ending.OVERTURNED, "overturned"), (Ending.INVALID, "not valid")):
        count = sum(ending(one) == found for one in draws)
        if count or (found == Ending.OVERTURNED and all(map(stands, draws))):
            low, high = binomial_interval(count, len(draws), CONFIDENCE)
            parts.append(
                f"{word} in {count} of {len(draws)} draws (95 %: {100.0 * low:.0f} to {100.0 * high:.0f} %)"
            )
    return ", ".join(parts)


def _value_that_decides(draws: Sequence[ChangedRun]) -> str:
    """The input and its value beyond which most draws end in one way; empty if no value tells enough of them apart."""
    found: list[tuple[int, str]] = []
    all_valid = all(ending(one) != Ending.INVALID for one in draws)
    for key in draws[0].values or {}:
        values = [(one.values or {}).get(key) for one in draws]
        known = [
            (value, stands(one)) for value, one in zip(values, draws, strict=True) if isinstance(value, float)
        ]
        for standing, word in ((True, "stands"), (False, "overturns" if all_valid else "does not stand")):
            same = [value for value, one in known if one is standing]
            others = [value for value, one in known if one is not standing]
            if not same or not others:
                continue
            for beyond, limit, side in (
                ([value for value in same if value > max(others)], max(others), "above"),
                ([value for value in same if value < min(others)], min(others), "below"),
            ):
                if len(beyond) >= max(LEAST_DRAWS, LEAST_SHARE * len(draws)):
                    words = f"; {word} in all {len(beyond)} of them with {WORDS[key]} {side} {limit:.3g}"
                    found.append((len(beyond), words))
    return max(found)[1] if found else ""


def _other_regime(verdict: Verdict, band: Band) -> str:
    """What variations do otherwise, with the ranges of slip and rotation."""
    own = band.members[0].outcome
    others = {one.outcome for one in band.members if one.outcome is not None} - {own}
    if own == Outcome.OVERTURNED:
        return "Another box may fall first"
    may = _may(Outcome(own), {Outcome(one) for one in others}) if own else ""
    lead = f"It may {may}" if may else "How far it moves is not known"
    slip, ratio = (FIGURES[key].unit.range_text(band[key]) for key in (SLIPPED, TURNED))
    return f"{lead}: slip {slip}, rotation ratio {ratio}"


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
    return " or ".join(further or [words for one, words in less.items() if one in others])


def _depending(verdict: Verdict) -> str:
    if not verdict.decided_by:
        return ""
    named = [WORDS.get(key, key) for key in verdict.decided_by[:MOST_NAMED]]
    if len(verdict.decided_by) > MOST_NAMED:
        return f", depending on {', '.join(named)} and others"
    return f", depending on {' and '.join(named)}"
