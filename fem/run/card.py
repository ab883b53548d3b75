"""The verdict of a run as a card of five lines, from the numbers of a result alone: what `card.txt.j2` says."""

from collections.abc import Sequence
from math import comb
from typing import Any

from fem.case.tables.unknown_inputs import WORDS, in_words, value_in_words
from fem.results.figures import SLIPPED, TURNED
from fem.results.kinds import RUN
from fem.results.outcome import Ending
from fem.results.run_result import (
    Band,
    ChangedRun,
    MotionResult,
    Numerics,
    RunResult,
    StaticResult,
    Verdict,
)
from fem.run.described import fall_in_row, links_in_words, part_covered, rule_says, sides_in_words
from fem.run.joints import joints_in_words
from fem.run.ranges import largest_rotation, largest_slip, of_band, reach_of
from fem.run.sureness import (
    below_uplift,
    ending,
    numerical,
    rests_on_stiff_floor,
    stands,
    static_use,
)
from fem.run.words import sentence
from fem.runtime.intervals import binomial_interval
from fem.runtime.units import PERCENT, in_figures

SEEN = 1e-3  #: slip from which it is always said [m]
LEANING = 0.01  #: tilt at the end over the slenderness angle from which it is said
STAYS = 0.9  #: slip at the end over the largest, from which the one says the other
CONFIDENCE = 0.95
MOST_NAMED, DECIDING = 2, 3  #: changes in a sentence; inputs that decide
DOES = {Ending.STANDING: "stands", Ending.OVERTURNED: "overturns", Ending.INVALID: "destroys a corner"}
#: the lines of a card: what it does, the margin that governs, how far it moves, how sure that is, the static rule
LINES = ("does", "margin_line", "how_far", "sureness", "static_line")


def times(factor: float) -> str:
    """A factor on a motion, with two decimals at most."""
    return in_figures(factor, 3 if factor >= 1.0 else 2)


def card_of(result: RunResult) -> tuple[str, ...]:
    """The five lines; of a run that did not end, what is known."""
    if result.status == "failed":
        return (f"No verdict: {result.error or 'the solution failed'}. Results up to there are kept.",)
    outcome = (result.verdict or Verdict()).outcome
    if result.status not in RUN.finished:
        at = (result.numerics or Numerics()).simulated_s
        so_far = "nothing is known yet" if outcome is None else f"so far {line(result, 'does')}"
        until = "" if at is None else f" at t = {at:.4g} s"
        return (f"Not finished ({result.status}{until}): {so_far}.",)
    if outcome is None:
        return ("No result yet.",)
    return tuple(f"{words[:1].upper()}{words[1:]}." for words in _lines(result, LINES))


def line(result: RunResult, name: str) -> str:
    """One line of the card, of `LINES`, without a capital and a full stop."""
    return _lines(result, [name])[0]


def _lines(result: RunResult, names: Sequence[str]) -> list[str]:
    verdict, static = result.verdict or Verdict(), result.static or StaticResult()
    motion, angle, tilt = result.motion or MotionResult(), static.slenderness_angle_rad, verdict.tilt_rad
    leans = angle and tilt is not None and abs(tilt) >= LEANING * angle and not verdict.restored
    shown = {
        "verdict": verdict,
        "static": static,
        "motion": motion,
        "in_row": fall_in_row(verdict),
        "others": _others(verdict) if result.status in RUN.finished else None,
        "most": max((*(reach_of(verdict, SLIPPED) or ()), verdict.slipped)),
        "slip": largest_slip(verdict),
        "slip_at_end": of_band(verdict, "residual_slip_m"),
        "left_leaning": abs(tilt) if leans and tilt is not None else 0.0,
        "covered": part_covered(motion),
        "turned": largest_rotation(verdict),
        "share": PERCENT.text(verdict.rotation_ratio, reach_of(verdict, TURNED)),
        "joints": joints_in_words(verdict, result.static),
        "links": links_in_words(result),
        "static_use": static_use(result),
        "of": _variations(verdict.band) if verdict.band and verdict.band.members else None,
        "sides": sides_in_words(result.sides),
    }
    named = {"SEEN": SEEN, "STAYS": STAYS, "times": times, "rule_says": rule_says}
    named |= {"deciding_in_words": deciding_in_words}
    return [sentence("card.txt.j2", name, **shown, **named) for name in names]


def _others(verdict: Verdict) -> tuple[str, int, int] | None:
    """What variations do under this very motion that do not stand, how many, of how many; None where all stand."""
    members = (verdict.band or Band()).members[1:]
    tried = [ending(run) for run in members if run.outcome is not None and not numerical(run)]
    for kind, verb in ((Ending.OVERTURNED, "overturn"), (Ending.INVALID, "destroy")):
        if kind in tried:
            return verb, tried.count(kind), len(tried)
    return None


def _variations(band: Band) -> dict[str, Any]:
    """What the variations of a run show, for the line that says how sure it is."""
    own, tried = band.members[0], [member for member in band.members[1:] if member.outcome is not None]
    draws = [member for member in tried if member.kind == "draw"]
    other_end = [member for member in tried if ending(member) != ending(own)]
    crossing = [member for member in other_end if not numerical(member)]
    failed = [member for member in band.members if member.outcome is None]
    alone, failed_alone = ([run for run in runs if run.kind != "draw"] for runs in (crossing, failed))
    by_kind = ((what, [run for run in alone if ending(run) == kind]) for kind, what in DOES.items())
    drawn = _counted(draws) + _value_that_decides(draws) if len(alone) < len(crossing) else ""
    return {
        "own": own,
        "does": DOES[ending(own)],
        "tried": len(tried),
        "numerical_alone": all(map(numerical, tried)),
        "other_ways": [other for other in band.outcomes if other != own.outcome],
        "crossing": len(crossing),
        "alone": [(what, changes_in_words(runs)) for what, runs in by_kind if runs],
        "draws": len(draws),
        "drawn": drawn,
        "finer_does": next((DOES[ending(member)] for member in other_end if numerical(member)), ""),
        "failed": len(failed),
        "failed_alone": changes_in_words(failed_alone) if failed_alone else "",
        "below_uplift": below_uplift(band.members),
        "rests_on_stiff_floor": rests_on_stiff_floor(band.members),
    }


def deciding_in_words(keys: Sequence[str]) -> str:
    """The inputs that decide, as far as a sentence holds them."""
    named = [WORDS.get(key, key) for key in keys[:DECIDING]]
    return (
        f"{', '.join(named)} and others"
        if len(keys) > DECIDING
        else " and ".join(filter(None, (", ".join(named[:-1]), *named[-1:])))
    )


def changes_in_words(runs: Sequence[ChangedRun]) -> str:
    """What was changed in the first of these runs, each by itself, and how many more there are."""
    words = [in_words(run.values or {}) for run in runs[:MOST_NAMED]]
    more = len(runs) - MOST_NAMED
    if more > 0:
        words.append(f"one of {more} other changes" if more > 1 else "another change")
    return ", or with ".join(words)


def _counted(draws: Sequence[ChangedRun]) -> str:
    """How many variations of all inputs overturned, or destroyed a corner, with the intervals of their shares."""
    parts = []
    for kind, words in ((Ending.OVERTURNED, "it overturns"), (Ending.INVALID, "a corner is destroyed")):
        count = sum(ending(draw) == kind for draw in draws)
        if count or (kind == Ending.OVERTURNED and all(map(stands, draws))):
            low, high = binomial_interval(count, len(draws), CONFIDENCE)
            share = f"(95 %: {100.0 * low:.0f} to {100.0 * high:.0f} %)"
            parts.append(f"{words} in {count} of {len(draws)} variations of all inputs at once {share}")
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
                    least = chance, f", and all {beyond} with {WORDS[key]} {side} {value} {words}"
    return least[1]
