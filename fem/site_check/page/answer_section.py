"""The answer on the page of a site, in sentences and numbers."""

from collections.abc import Sequence

from markupsafe import Markup

from fem.html import sections as html
from fem.html.units import ABSENT, millimetres, number, quantity, ratio, short, typeset
from fem.results.figures import FIGURES, TURNED, RunFigures
from fem.results.outcome import Outcome
from fem.site_check.answer import FULFILLED
from fem.site_check.reasons import NOT_FULFILLED, both_ways, destroyed, unit_of
from fem.site_check.reasons import span as span_in_words
from fem.site_check.result import (
    ActionAnswer,
    ConfirmedRun,
    RuleRange,
    SiteAnswer,
    SiteResult,
    TwoDirections,
)


def answer_section(result: SiteResult) -> html.PageSection:
    """The answer, the numbers that it rests on, what speaks against it, and the rule."""
    answer, reasons = result.result, result.set.reasons
    standing = {FULFILLED: "stood", NOT_FULFILLED: "fell"}.get(answer.answer or "", "open")
    first = (
        f"{answer.answer.capitalize()} under the rule below."
        if answer.reasons and answer.answer
        else answer.sentence
    )
    return html.section(
        "Answer",
        "verdict-title",
        html.Paragraph(typeset(first), "sentence"),
        *([html.Bullets([typeset(words) for words in answer.reasons], "tight")] if answer.reasons else []),
        *([html.Paragraph(actions_in_words(answer.actions))] if len(answer.actions) > 1 else []),
        *([html.Headlines(_headlines(result))] if answer.answer is not None else []),
        *([html.Paragraph(typeset(words)) for words in beside_the_set(result)]),
        html.Note(html.joined(html.strong("Rule:"), f" {answer.rule}.")),
        *([html.Paragraph(typeset(f"Reasons: {'; '.join(reasons)}."), "fail")] if reasons else []),
        look=f"answer {standing}",
    )


def actions_in_words(actions: Sequence[ActionAnswer]) -> Markup:
    """The answer for each action with its utilisation, on a line."""
    parts: list[object] = []
    for action in actions:
        used = "" if action.utilisation is None else f" (utilisation {number(action.utilisation, figures=3)})"
        parts += [
            "; " if parts else "",
            html.strong(f"{action.name}:"),
            f" {action.answer or 'no answer'}{used}",
        ]
    return html.joined(*parts, ".")


def beside_the_set(result: SiteResult) -> list[str]:
    """What the further motions and the repeated deciding runs showed, and what was not computed, each in a sentence."""
    answer, words = result.result, []
    if answer.still:
        count = f"{answer.still} of {answer.runs} runs stay"
        if answer.still == answer.runs:
            moved = answer.factor_at_first_movement
            count = f"Nothing moves up to {short(moved, figures=3)} × the set: all {answer.runs} runs stay"
        words.append(f"{count} below uplift and slip of a rigid body and were not computed.")
    if answer.two_directions:
        words.append(two_directions_in_words(answer.two_directions, further=bool(answer.further)))
    if known := [group for group in answer.further if group.motions]:
        worst = max(known, key=lambda group: (group.overturned + group.invalid, group.beyond_limits))
        furthest = max(known, key=lambda group: group.beyond_limits)
        slips = [group.slip_largest_m for group in known if group.slip_largest_m is not None]
        slid = f" (the largest slip in both directions is {millimetres(max(slips))} mm)" if slips else ""
        low, high = (short(end, 100, 2) for end in worst.interval)
        location = "floor" if result.floor and result.floor.z_over_h is None else "site"
        of_both = " of both" if worst.invalid else ""
        pairs, most = "", ""
        if len(known) > 1:
            pairs, most = f" for each of {len(known)} combinations of weight and friction", "at most "
        overturned, beyond = (
            f"{most}{count}" if count else "none" for count in (worst.overturned, furthest.beyond_limits)
        )
        words.append(
            f"Of {worst.motions} further motions{pairs} {overturned} overturned it{destroyed(worst.invalid)} "
            f"(95 % interval{of_both} {low} to {high} %) and {beyond} went beyond a limit of a single "
            f"motion{both_ways(furthest)}{slid}. All these motions have the spectrum of the {location}; recorded ones "
            "scatter more."
        )
    if repeated := confirmation(result):
        words.append(repeated)
    if repeated and (bolts := bolts_in_words(answer.confirmed)):
        words[-1] += f" {bolts}"
    if failed := {point.factor: point.failed for point in answer.scan if point.failed}:
        words.append(
            f"Runs that failed at other factors on the set: "
            f"{', '.join(f'{count} at {short(factor)}' for factor, count in failed.items())}. The margin does not know "
            "how they end."
        )
    if answer.failed_between:
        words.append(
            f"Runs that failed at factors between those of the scan: {answer.failed_between}. The margin does not know "
            "how they end."
        )
    return words


def two_directions_in_words(slip: TwoDirections, *, further: bool) -> str:
    """How far it slides under both horizontal components, and how much further than in the plane of the runs."""
    largest, mean = millimetres(slip.slip_largest_m), millimetres(slip.slip_mean_m)
    again = ""
    if slip.slip_range_m:
        again = f"; in the repetitions {' to '.join(dict.fromkeys(map(millimetres, slip.slip_range_m)))} mm"
    return (
        f"Under both horizontal components at once, sliding without rocking: largest slip {largest} mm, mean {mean} "
        f"mm, in the plane {millimetres(slip.slip_mean_in_plane_m)} mm{again}. It is held against the clearance, too"
        f"{', also under the further motions' * further}. Rocking, and the slip of a container that rocks or bends, "
        "are computed in the plane only."
    )


def confirmation(result: SiteResult) -> str:
    """The result of the deciding runs when they are repeated; empty where they were not."""
    again = result.result.confirmed
    if not again:
        return ""
    words = f"The {len(again)} deciding runs, repeated with the elastic model"
    inputs = "their unknown inputs"
    if len(again) == 1:
        words, inputs = "The deciding run, repeated with the elastic model", "its unknown inputs"
    failed = sum(repeated.outcome is None for repeated in again)
    invalid = sum(Outcome.INVALID in (repeated.outcome, *repeated.outcomes) for repeated in again)
    fell = sum(Outcome.OVERTURNED in (repeated.outcome, *repeated.outcomes) for repeated in again)
    if failed or fell or invalid:
        corner = f", {invalid} can destroy a corner" if invalid else ""
        return f"{words} over {inputs}: {fell} can overturn{corner}, {failed} failed."

    def largest(runs: Sequence[RunFigures]) -> str:
        turned, slipped = max(run.turned for run in runs), max(run.slipped for run in runs)
        return f"largest rotation ratio {ratio(turned)}, largest slip {millimetres(slipped)} mm"

    turned = max((end for run in again for end in run.rotation_ratio_range), default=None)
    slipped = max((end for run in again for end in run.max_slip_m_range), default=None)
    over = (
        f"; over {inputs} none overturns, either, with rotation ratios up to {ratio(turned)} and slips up to "
        f"{millimetres(slipped)} mm"
        if turned is not None and slipped is not None
        else ""
    )
    return (
        f"{words}: none overturns, {largest(again)}{over}; in the set {largest([run.run for run in again])}. The "
        "answer rests on the set: a single rotation is chaotic with either model, and a repetition counts where it "
        "overturns, destroys a corner, fails or, with the inputs as given, goes beyond a limit of a single motion."
    )


def bolts_in_words(confirmed: Sequence[ConfirmedRun]) -> str:
    """What the bolts of a stack carry in the deciding runs; empty of a single box, or without such runs."""
    loaded = [repeated for repeated in confirmed if repeated.bolt_tension_N is not None]
    if not loaded:
        return ""
    most = max(loaded, key=lambda run: run.bolt_tension_N or 0.0)
    tension, used = FIGURES["bolt_tension_N"].unit.text(most.bolt_tension_N, figures=2), most.bolt_utilisation
    of_it = (
        "; the capacity of a bolt is not given"
        if used is None
        else f", {short(used, 100, 2)} % of their capacity"
    )
    return f"The bolts along one edge carry at most {tension} of tension there{of_it}."


def _headlines(result: SiteResult) -> list[html.Headline]:
    answer, inputs = result.result, result.inputs
    span = answer.rule_range or RuleRange()
    tried = [point.factor for point in answer.scan]
    far = f"factors {short(tried[0])} to {short(tried[-1])} tried" if tried else "other factors not computed"
    if answer.factor_at_first_movement is not None:
        moves = f"a rigid body moves from {short(answer.factor_at_first_movement, figures=3)} on"
    else:
        moves = far
    slip, both = f"{_with_range('slip_m', answer, span)} mm", answer.two_directions
    where = f"mean {millimetres(answer.slip_mean_m)}"
    if both and both.slip_largest_m > (answer.slip_m or 0.0):  # of which the first sentence speaks
        plane = "" if answer.slip_m is None else f"; in the plane {slip}, {where}"
        where = f"under both horizontal components{plane}"
        slip = f"{millimetres(both.slip_largest_m)} mm"

    def at(factor: float | None) -> str:
        if factor is None:
            return "none" if tried else ABSENT
        least = "at most " if answer.is_least_tried(factor) else ""
        return f"{least}{short(factor, figures=3)} × the set"

    return [
        html.Headline("overturned", f"{answer.overturned} of {answer.runs} runs{destroyed(answer.invalid)}"),
        html.Headline(
            "rotation, by the rule",
            _with_range(TURNED, answer, span),
            f"limit {short(inputs.rotation_ratio_limit)}; a single motion "
            f"{_with_range('rotation_ratio_largest', answer, span)}, limit {short(inputs.single_rotation_ratio_limit)}",
        ),
        html.Headline(
            "slip, largest",
            slip,
            f"limit {quantity(inputs.slip_limit_m, 'mm', 1000, 3)}; {where}",
        ),
        html.Headline("the rule first fails at", at(answer.margin_factor), far),
        html.Headline("first overturned at", at(answer.factor_at_first_overturning), moves),
    ]


def _with_range(key: str, answer: SiteAnswer, span: RuleRange) -> str:
    """A figure of the rule, with the range that it has over the repetitions."""
    if answer[key] is None:
        return ABSENT
    text = unit_of(key).text(answer[key], figures=2, bare=True)
    ends = span_in_words(key, span[key][0], span[key][-1]) if span[key] else ""
    return typeset(f"{text} ({ends})" if " to " in ends else text)
