"""The verdict of a run as a card of five lines, the same on terminal, summary and page and in lists.

What it does, the gravest first; the margin that governs; how far it moves; how sure that is, and what decides; the
static rule. Made from the numbers of a result alone. The first two lines are read aloud: at most 45 words, none that a
client does not have.
"""

from collections.abc import Iterator, Sequence
from math import comb

from fem.case.tables.unknown_inputs import WORDS, in_words, value_in_words
from fem.results.figures import SLIPPED, TURNED
from fem.results.kinds import RUN
from fem.results.outcome import Ending, Outcome
from fem.results.run_result import (
    Band,
    ChangedRun,
    Margin,
    MotionResult,
    Numerics,
    RunResult,
    StaticResult,
    Verdict,
)
from fem.run.described import fall_in_row, links_in_words, part_covered
from fem.run.joints import fall_in_words, joints_in_words, leaning_in_words
from fem.run.ranges import largest_rotation, largest_slip, of_band, reach_of
from fem.run.static_words import rule_says, sides_in_words
from fem.run.sureness import (
    SURE,
    UNSURE,
    below_uplift,
    ending,
    numerical,
    rests_on_stiff_floor,
    stands,
    static_use,
)
from fem.runtime.intervals import binomial_interval
from fem.runtime.units import DEGREES, METRES, PERCENT, in_figures

SEEN = 1e-3  #: slip from which it is always said [m]
LEANING = 0.01  #: tilt at the end over the slenderness angle from which it is said
STAYS = 0.9  #: slip at the end over the largest, from which the one says the other
CONFIDENCE = 0.95
MOST_NAMED, DECIDING = 2, 3  #: changes in a sentence; inputs that decide
DOES = {Ending.STANDING: "stands", Ending.OVERTURNED: "overturns", Ending.INVALID: "destroys a corner"}
OUTCOMES = {
    Outcome.REST: "rests",
    Outcome.SLIDE: "slides and stands",
    Outcome.HOP: "leaves the floor for moments and stands",
    Outcome.ROCK: "rocks and stands",
    Outcome.SLIDE_ROCK: "slides, rocks and stands",
}
PLACES = {"limit": "the limit of", "width": "its own width of", "gap": "a gap beside it of"}


def times(factor: float) -> str:
    """A factor on a motion, with two decimals at most."""
    return in_figures(factor, 3 if factor >= 1.0 else 2)


def card_of(result: RunResult) -> tuple[str, ...]:
    """The five lines; of a run that did not end, what is known."""
    if result.status == "failed":
        return (f"No verdict: {result.error or 'the solution failed'}. Results up to there are kept.",)
    if result.status not in RUN.finished:
        at = (result.numerics or Numerics()).simulated_s
        so_far = (
            "nothing is known yet"
            if not result.verdict or result.verdict.outcome is None
            else f"so far {does(result)}"
        )
        until = "" if at is None else f" at t = {at:.4g} s"
        return (f"Not finished ({result.status}{until}): {so_far}.",)
    verdict = result.verdict or Verdict()
    if verdict.outcome is None:
        return ("No result yet.",)
    lines = [does(result), margin_line(result), how_far(result), sureness(result), static_line(result)]
    return tuple(f"{line[:1].upper()}{line[1:]}." for line in lines)


# 1: what it does


def does(result: RunResult) -> str:
    """The gravest of what it does, and of what its variations do under this motion; its slip is always said."""
    verdict, slip = result.verdict or Verdict(), largest_slip(result.verdict or Verdict())
    if verdict.outcome == Outcome.INVALID:
        return f"not valid: a corner is destroyed, {verdict.invalid_reason}; what follows is not known"
    if verdict.outcome == Outcome.OVERTURNED:
        fell = (
            fall_in_words(verdict)
            or fall_in_row(verdict)
            or (leaning_in_words("", verdict) if verdict.leans else "")
        )
        at = verdict.overturned_at_s
        return fell or "overturns" + (f" at t = {at:.3f} s" if at is not None else "")
    place, most = verdict.place_m, max((*(reach_of(verdict, SLIPPED) or ()), verdict.slipped))
    limit = f"{PLACES[verdict.place_is or 'width']} {METRES.text(place, figures=3)}"
    assert verdict.outcome is not None  # a run that ended without has failed
    if place is not None and most > place:
        sure = verdict.slipped > place
        leaves, than = ("leaves", "more than") if sure else ("may leave", "and has")
        own = f"{leaves} its place: it slides {slip}, {than} {limit}; it does not overturn"
    else:
        own = OUTCOMES[Outcome(verdict.outcome)]
        if most > SEEN and slip:
            own = own.replace("slides", f"slides {slip}") if "slides" in own else f"{own}; slip {slip}"
    if result.status in RUN.finished and (other := _other_ends(verdict)):
        own = f"{other}; as given it {own}"
    motion = result.motion or MotionResult()
    under = f" (under {part})" if (part := part_covered(motion)) else ""
    return f"{own}{_leaning(verdict, result.static)}{under}"


def _other_ends(verdict: Verdict) -> str:
    """How many variations under this very motion do not stand, and what these do; empty where all do."""
    tried = [
        run for run in (verdict.band or Band()).members[1:] if run.outcome is not None and not numerical(run)
    ]
    for kind in (Ending.OVERTURNED, Ending.INVALID):
        if count := sum(ending(run) == kind for run in tried):
            fall = kind == Ending.OVERTURNED
            verb = f"overturn{'s' * (count == 1)}" if fall else f"destroy{'s' * (count == 1)} a corner"
            may = "overturn" if fall else "destroy a corner"
            return f"may {may}: {count} of {len(tried)} variations of its inputs {verb}"
    return ""


def _leaning(verdict: Verdict, static: StaticResult | None) -> str:
    """How a container that stands again is left leaning, and what that takes of its capacity; empty if it stands."""
    angle, tilt = (static or StaticResult()).slenderness_angle_rad, verdict.tilt_rad
    if not angle or tilt is None or abs(tilt) < LEANING * angle or verdict.restored:
        return ""
    leaning = DEGREES.text(abs(tilt), figures=2)
    return f"; left leaning by {leaning}, {abs(tilt) / angle:.0%} less capacity on that side"


# 2: the margin that governs


def margin_line(result: RunResult) -> str:
    """The least factor at which the case or a variation does not stand, and what the case itself does."""
    verdict, motion = result.verdict or Verdict(), result.motion or MotionResult()
    margin = verdict.margin
    if verdict.outcome == Outcome.INVALID:
        return "margin: none, this motion itself destroys a corner"
    if margin is None:
        still = motion.kind == "none" and motion.vertical is None
        return (
            "margin: none, the floor does not move" if still else "margin: not computed (--margin finds it)"
        )
    governs = margin.governing
    own = _of_case(verdict, margin)
    if governs is None:  # of a former version
        return f"margin: {own}"
    if governs.factor is None:
        of_them = f", in all {governs.variations} variations tried" if governs.variations else ""
        if margin.largest_tried <= 1.0:
            return "margin: not known, no stronger motion could be tried"
        most = f"{margin.largest_tried:.3g}"
        return f"margin above {most}: stands at up to {most} times this motion{of_them}"
    factor, does = (
        times(governs.factor),
        "overturns" if governs.ending == "overturned" else "destroys a corner",
    )
    whom = "one of the row" if verdict.neighbours else "it"
    if governs.of == "case":
        found = f" (found in steps of {PERCENT.text(governs.step, figures=1)})" if governs.step else ""
        before = f", before any of {governs.variations} variations" if governs.variations else ""
        return f"margin {factor}: {whom} {does} at {factor} times this motion{before}{found}"
    if governs.factor == 1.0:
        return f"margin: none, a variation {does} under this motion itself; {own}"
    among = (
        f"the least favourable of {governs.variations} variations tried"
        if governs.variations > 1
        else "the variation tried"
    )
    return f"margin {factor}: {among} {does} at {factor} times this motion; {own}"


def _of_case(verdict: Verdict, margin: Margin) -> str:
    """What the case does with its inputs as given, under stronger motions, or weaker ones where it overturned."""
    destroyed, factor = margin.destroyed_from, margin.factor
    if destroyed is not None and (factor is None or destroyed < factor):
        return f"as given a corner is destroyed at {times(destroyed)} times"
    if factor is not None:
        return f"as given it overturns at {times(factor)} times"
    if margin.largest_tried <= 1.0:
        return "no stronger motion could be tried"
    return f"as given it stands at up to {margin.largest_tried:.3g} times"


# 3: how far


def how_far(result: RunResult) -> str:
    """Rotation, slip and what stands beside it did, with their ranges."""
    verdict = result.verdict or Verdict()
    parts = []
    if verdict.outcome not in (Outcome.OVERTURNED, Outcome.INVALID) and verdict.rotation_ratio is not None:
        share = PERCENT.text(verdict.rotation_ratio, reach_of(verdict, TURNED))
        parts.append(f"turns by {largest_rotation(verdict)}, {share} of the angle at which it falls")
    if slip := largest_slip(verdict):
        stays = verdict.slipped < SEEN or abs(verdict.residual_slip_m or 0.0) > STAYS * verdict.slipped
        at_end = "" if stays else f", at the end {of_band(verdict, 'residual_slip_m')}"
        parts.append(f"slides {slip}{at_end}")
    parts += [joints_in_words(verdict, result.static), links_in_words(result)]
    return "; ".join(part for part in parts if part) or "nothing is known of how far it moves"


# 4: how sure


def sureness(result: RunResult) -> str:
    """Whether the variations of the inputs end alike, and the inputs that decide."""
    verdict = result.verdict or Verdict()
    band = verdict.band
    if verdict.sure is None or (band is None and verdict.outcome == Outcome.INVALID):
        return (
            "unsure: see the band"
            if band is not None and band.unsure
            else "how sure: not tried (--band varies the inputs)"
        )
    if band is None:
        used = PERCENT.text(static_use(result) or 0.0)
        return f"sure by the static rule, used to {used}; nothing else acts, so its inputs were not varied"
    tried = [member for member in band.members[1:] if member.outcome is not None]
    if not tried:
        return (
            "nothing was varied: all inputs are held"
            if len(band.members) == 1
            else "unsure: no variation ended"
        )
    decides = f". What decides: {deciding_in_words(verdict.decided_by)}" if verdict.decided_by else ""
    if verdict.sure == UNSURE:
        return f"unsure: {'; '.join(_doubts(verdict, band, tried))}{decides}"
    own = DOES[ending(band.members[0])]
    if all(map(numerical, tried)):
        return f"no input was varied, all are held; it {own} with steps ten times as accurate, too"
    in_all = (
        f"in all {len(tried)} variations of its inputs"
        if len(tried) > 1
        else "in the one variation of its inputs"
    )
    if verdict.sure == SURE:
        return f"sure: it {own} {in_all}, and in the same way{decides}"
    other = _other_ways(verdict, band)
    return f"sure that it {own}, {in_all}; not sure how far it moves{other}{decides}"


def deciding_in_words(keys: Sequence[str]) -> str:
    """The inputs that decide, as far as a sentence holds them."""
    named = [WORDS.get(key, key) for key in keys[:DECIDING]]
    return (
        f"{', '.join(named)} and others"
        if len(keys) > DECIDING
        else " and ".join(filter(None, (", ".join(named[:-1]), *named[-1:])))
    )


def _other_ways(verdict: Verdict, band: Band) -> str:
    """What variations that end alike do otherwise."""
    own = band.members[0]
    if own.outcome == Outcome.OVERTURNED:
        return f", nor which {'container' if own.fell_in_row else 'box'} falls first"
    others = [outcome for outcome in band.outcomes if outcome != own.outcome and outcome in OUTCOMES]
    words = {
        Outcome.SLIDE: "slides only",
        Outcome.ROCK: "rocks only",
        Outcome.REST: "rests",
        Outcome.SLIDE_ROCK: "slides and rocks",
        Outcome.HOP: "leaves the floor for moments",
    }
    return f": it {' or '.join(words[Outcome(other)] for other in others)} in some" if others else ""


def _doubts(verdict: Verdict, band: Band, tried: Sequence[ChangedRun]) -> Iterator[str]:
    """Why it is not sure whether it stands."""
    own = band.members[0]
    crossing = [member for member in tried if ending(member) != ending(own) and not numerical(member)]
    draws = [member for member in tried if member.kind == "draw"]
    if crossing:
        drawn = [draw for draw in draws if draw in crossing]
        alone = [member for member in crossing if member.kind != "draw"]
        for kind, what in DOES.items():
            if alike := [member for member in alone if ending(member) == kind]:
                yield f"it {what} with {changes_in_words(alike)}"
        if drawn:
            yield _counted(draws) + _value_that_decides(draws)
        elif draws:
            yield f"in none of {len(draws)} variations of all inputs at once"
    if verdict.numerically_unsure:
        verb = next(
            DOES[ending(member)] for member in tried if numerical(member) and ending(member) != ending(own)
        )
        yield f"the computation does not decide it: it {verb} with steps ten times as accurate"
    if below_uplift(band.members):
        rests = "rests" if rests_on_stiff_floor(band.members) else "still rocks"
        yield f"it is below uplift of a rigid block, and on a floor thirty times as stiff it {rests}"
    if failed := [member for member in band.members if member.outcome is None]:
        alone = [member for member in failed if member.kind != "draw"]
        of_them = f", with {changes_in_words(alone)}" if alone else ""
        have = "has" if len(failed) == 1 else "have"
        yield f"{len(failed)} of {len(band.members) - 1} variations {have} no outcome{of_them}"
    if band.left_out:
        yield f"{len(band.left_out)} variations were left out for time"


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


# 5: the static rule


def static_line(result: RunResult) -> str:
    """What the static rule says of the same motion, and which side governs."""
    static = result.static or StaticResult()
    own = static.ruling
    sliding, overturning = own.utilisation_sliding, own.utilisation_overturning
    if not sliding and not overturning:
        return "static rule: this motion is no load that it knows"
    says = [
        f"{rule_says(check, use)} ({'no capacity' if use is None else f'{use:.3f}'})"
        for check, use in (("sliding", sliding), ("overturning", overturning))
    ]
    return f"static rule, same motion: {', '.join(says)}{sides_in_words(result.sides)}"
