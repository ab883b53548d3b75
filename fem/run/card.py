"""The verdict of a run as a card of five lines, and the warnings: what the reader must know before relying on it.

`card.txt.j2` and `warnings.txt.j2` say when, and in which words, from the numbers of a result.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import comb
from typing import Any

from contact.stepping.ledger import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT
from contact.stepping.modes import ROCKING
from fem.case.case import Case
from fem.case.tables.duration import MOST_FREE_MOTION, ends_at_rest, longest_time
from fem.case.tables.input_ranges import DASHPOT, WEAKENING
from fem.case.tables.unknown_inputs import WORDS, in_words, is_sign, value_in_words
from fem.results import level as levels
from fem.results.figures import SLIPPED, TURNED
from fem.results.kinds import RUN
from fem.results.level import ending, fallen_in_band, numerical, slips_of, stands
from fem.results.outcome import Ending
from fem.results.run_result import (
    Band,
    ChangedRun,
    Energy,
    MotionResult,
    Numerics,
    RunResult,
    StaticResult,
    Verdict,
    to_overturn,
)
from fem.run.described import (
    doubts,
    fall_in_row,
    joints_in_words,
    largest_joint_slip,
    links_in_words,
    part_covered,
    rule_says,
    sides_in_words,
    used,
)
from fem.run.sureness import below_uplift, rests_on_stiff_floor, static_use
from fem.run.words import largest_rotation, of_band, paragraphs, plastic_corner, reach_of, sentence
from fem.runtime.intervals import binomial_interval
from fem.runtime.units import PERCENT, in_figures

SEEN = 1e-3  #: slip from which it is always said [m]
LEANING = 0.01  #: tilt at the end over the slenderness angle from which it is said
STAYS = 0.9  #: slip at the end over the largest, from which the one says the other
CONFIDENCE = 0.95
MOST_NAMED, DECIDING = 2, 3  #: changes in a sentence; inputs that decide
DOES = {Ending.STANDING: "stands", Ending.OVERTURNED: "overturns", Ending.INVALID: "destroys a corner"}
LIMITS: dict[str, Any] = {
    "NEAR": 0.5,  #: share of a limit from which there is a warning
    "REJECTED_SHARE": 0.05,
    "FLIGHT": 0.05,  #: share of the rocking in the air from which it is said
    #: largest von Mises stress over Young's modulus up to which `reduced` and `full` agree within 5 %: blocks of one to
    #: ten boxes, corners and flat, of 1e9 to 1.5e6 Pa; at 0.024 they differ by 9 % (`fem/README.md`)
    "SMALL_STRAIN": 0.01,
    #: relaxation time of the contact over the time scale of rocking 1/p, from which the dashpot is more than a loss at
    #: impacts: the rotation ratio of a rigid `rocking` on its flat base is 0.85 at 0.006, 0.68 at 0.15, 0.49 at 0.31
    "FAST_RELAXATION": 0.1,
    "ROCKING": ROCKING,
    "GAIN_LIMIT": GAIN_LIMIT,
    "LIKE": 1.02,  #: ratio of two factors from which they are not alike: each is located within 1 %
    "MOST_FREE_MOTION": MOST_FREE_MOTION,
}
#: slip over the width, and its change over the larger one, from which a scatter is said
SLIPS, SCATTER = 1e-3, 0.2
#: the lines of a card: what it does, the margin that governs, how far it moves, how sure that is, the static rule
LINES = ("does", "margin_line", "how_far", "sureness", "static_line")

FINEST_FIGURES = 6  #: of a factor next to 1


def times(factor: float) -> str:
    """A factor on a motion, with two decimals at most, and more where these would make it 1, which it is not."""
    figures = 3 if factor >= 1.0 else 2
    while factor != 1.0 and float(in_figures(factor, figures)) == 1.0 and figures < FINEST_FIGURES:
        figures += 1
    return in_figures(factor, figures)


def with_words(result: RunResult, case: Case) -> RunResult:
    """The result with its warnings and the card of its verdict, which follow from the rest."""
    result = replace(result, warnings=tuple(warnings_for(result, case)))
    if result.verdict is None:
        return result
    card, known = card_of(result), result.verdict.outcome is not None
    level = levels.level_of(result) if known else None
    return replace(result, verdict=replace(result.verdict, level=level, first_line=card[0], card=card))


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
    least, own, most = slips_of(verdict)
    place = math.inf if verdict.place_m is None else verdict.place_m
    on_floor = max(verdict.slipped, *(reach_of(verdict, SLIPPED) or (0.0,)))
    joints = [run.max_joint_slip_m or 0.0 for run in (verdict, *(verdict.band or Band()).members)]
    joint_slip, boxes = largest_joint_slip(verdict)
    between, slip = boxes.replace(" on ", f" slides {joint_slip} on "), of_band(verdict, SLIPPED)
    by_box = (verdict.slipped if own > place else on_floor) <= place  #: not on the floor does it slide so far
    shown = {
        "SEEN": SEEN,
        "STAYS": STAYS,
        "times": times,
        "rule_says": rule_says,
        "deciding_in_words": deciding_in_words,
        "verdict": verdict,
        "used": used,
        "levels": levels,
        "leaves": own > place,
        "may_leave": stands(verdict) and least <= place < most,
        "level": levels.level_of(result) if verdict.outcome is not None else None,
        "cut": levels.is_cut(result),
        "place": most > place and (between if by_box else f"slides {slip}"),
        "between": between if max(joints) > max(on_floor, SEEN) else "",
        "steps": lambda step: PERCENT.text(step, figures=1),
        "static": static,
        "motion": motion,
        "in_row": fall_in_row(verdict),
        "others": fallen_in_band(verdict) if result.status in RUN.finished else None,
        "Ending": Ending,
        "slid": on_floor > SEEN,
        "slip": slip,
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
    return [sentence("card.txt.j2", name, **shown) for name in names]


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
        "alone": [(what, _changes_in_words(runs)) for what, runs in by_kind if runs],
        "draws": len(draws),
        "drawn": drawn,
        "finer_does": next((DOES[ending(member)] for member in other_end if numerical(member)), ""),
        "failed": len(failed),
        "failed_alone": _changes_in_words(failed_alone) if failed_alone else "",
        "below_uplift": below_uplift(band.members),
        "rests_on_stiff_floor": rests_on_stiff_floor(band.members),
        "in_row": sum(member.fell_in_row is not None for member in band.members),
        "itself_first": sum(member.fell_in_row == "container" for member in band.members),
    }


def deciding_in_words(keys: Sequence[str]) -> str:
    """The inputs that decide, as far as a sentence holds them."""
    named = [WORDS.get(key, key) for key in keys[:DECIDING]]
    if len(keys) > DECIDING:
        return f"{', '.join(named)} and others"
    return " and ".join(filter(None, (", ".join(named[:-1]), *named[-1:])))


def _changes_in_words(runs: Sequence[ChangedRun]) -> str:
    """What was changed in the first of these runs, each by itself, and how many more there are."""
    words = [in_words(run.values or {}) for run in runs[:MOST_NAMED]]
    more = len(runs) - MOST_NAMED
    if more > 0:
        words.append(f"one of {more} other changes" if more > 1 else "another change")
    return ", or with ".join(words)


def _counted(draws: Sequence[ChangedRun]) -> str:
    """How many variations of all inputs overturned, or destroyed a corner, with the intervals of their shares."""
    parts = []
    who = "one of the row" if any(draw.fell_in_row for draw in draws) else "it"
    for kind, words in ((Ending.OVERTURNED, f"{who} overturns"), (Ending.INVALID, "a corner is destroyed")):
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
    for key in (key for key in keys if not is_sign(key)):
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
            above, below = _rounded(max(others), math.ceil), _rounded(min(others), math.floor)
            for beyond, limit, side in (
                (sum(value > above for value in same), above, "above"),
                (sum(value < below for value in same), below, "below"),
            ):
                chance = 4 * len(keys) * comb(len(same), beyond) / comb(len(known), beyond)
                if chance < least[0]:
                    value = value_in_words(key, limit)
                    least = chance, f", and all {beyond} with {WORDS[key]} {side} {value} {words}"
    return least[1]


def _rounded(value: float, away: Callable[[float], int]) -> float:
    """A value in two figures, up or down."""
    digit = 10.0 ** (math.floor(math.log10(abs(value))) - 1) if value else 1.0
    return away(value / digit) * digit


def warnings_for(result: RunResult, case: Case) -> list[str]:
    """All warnings that apply to a result, the most important first."""
    verdict, static = result.verdict or Verdict(), result.static or StaticResult()
    numerics, energy = result.numerics or Numerics(), result.energy or Energy()
    reference = energy.reference_J or math.inf
    parts = (energy.friction_J, energy.contact_damping_J, energy.material_damping_J, energy.crushing_J)
    known = energy.reference_J and energy.numerical_J is not None
    width, angle = case.stack[0].width, static.slenderness_angle_rad
    own_dashpot = {case.contact_damping_ratio: verdict.rotation_ratio}
    varied = {ratio: run.rotation_ratio for ratio, run in _changed_alone(verdict, DASHPOT).items()}
    # dashpot over spring, of the whole mass on half the base's stiffness: see contact.penalty.relaxation_time
    frequency = numerics.contact_frequency_Hz
    ratio = numerics.contact_damping_ratio or case.contact.damping_ratio
    return paragraphs(
        "warnings.txt.j2",
        **LIMITS,
        case=case,
        result=result,
        verdict=verdict,
        static=static,
        own=static.ruling,
        numerics=numerics,
        sureness=line(result, "sureness"),
        times=times,
        by_weakening=_changed_alone(verdict, WEAKENING),
        by_dashpot=own_dashpot | varied,
        scatter=_scatter(verdict, width),
        doubts=doubts(result.motion or MotionResult(), case),
        ends_at_rest=ends_at_rest(case),
        longest_time=longest_time(case),
        gained=-(energy.numerical_J or 0.0) / reference,
        lost=(energy.closure_error or 0.0) * reference if known else 0.0,
        lost_limit=max(LOSS_SHARE_LIMIT * sum(part or 0.0 for part in parts), LOSS_LIMIT * reference),
        to_overturn=to_overturn(bool(case.neighbour)),
        tilted=(numerics.max_penetration_m or 0.0) / (width * angle) if angle else 0.0,
        creep=_creep(case, static.ruling.utilisation_sliding),
        relaxation=2.0 * ratio * math.sqrt(2.0) / (2.0 * math.pi * frequency) if frequency else 0.0,
        damping_ratio=ratio,
        plastic_corner=plastic_corner(verdict),
    )


def _changed_alone(verdict: Verdict, key: str) -> dict[float, ChangedRun]:
    """The variations of a run that change nothing but a number, by that number."""
    return {
        float(member.values[key]): member
        for member in (verdict.band or Band()).members
        if member.values is not None and [*member.values] == [key] and member.rotation_ratio is not None
    }


def _scatter(verdict: Verdict, width: float) -> float | None:
    """The slip with steps ten times as accurate, where it is another one and as likely as that of the run [m]."""
    band, own = verdict.band or Band(), verdict.max_slip_m
    finer = next((member.max_slip_m for member in band.members[1:] if numerical(member)), None)
    if own is None or finer is None or band.max_slip_m is None:
        return None
    low, high = band.max_slip_m
    small = max(own, finer) < SLIPS * width or abs(own - finer) < SCATTER * max(own, finer)
    return None if small or not low <= finer <= high else finer  # beyond: it fell, or destroyed a corner


def _creep(case: Case, share: float | None) -> float | None:
    """v = v_reg artanh(s) under a steady load of share s of what friction carries, over the run: no true stick [m]."""
    if case.contact.sticks or share is None or not 0.0 < share < 1.0:
        return None
    return case.contact.regularisation_velocity_m_s * math.atanh(share) * longest_time(case)
