"""The margin of a run in one sentence: whether it stands, and by which factor on the motion it overturns."""

from fem.results.outcome import Outcome
from fem.results.run_result import Margin, Verdict
from fem.runtime.units import DisplayUnit

FACTOR = DisplayUnit(figures=3)


def margin_in_words(verdict: Verdict | None) -> str:
    """The margin of a verdict as a sentence; empty if none was computed."""
    if verdict is None or verdict.margin is None:
        return ""
    margin, stands = verdict.margin, verdict.outcome != Outcome.OVERTURNED
    lead = "Stands" if stands else "Overturns"
    if margin.factor is None:
        most, others = f"{margin.largest_tried:.3g}", f"other motion{'s' * (margin.runs != 1)}"
        none = f"none of {margin.runs}" if margin.runs > 1 else "not one"
        whom = "one of the row" if verdict.neighbours else "it"
        words = f"{lead}; {none} {others} up to {most} times as strong overturns {whom}"
    elif margin.stands_up_to is None:
        still = "overturns" if stands else "still does"
        words = f"{lead}; {still} at {margin.factor:.3g} times this motion, the weakest tried"
    else:
        up_to = "" if stands else f"stands up to {FACTOR.text(margin.stands_up_to)} times this motion, "
        times = " times this motion" if stands else ""
        words = f"{lead}; {up_to}overturns first at {FACTOR.text(margin.factor)}{times}"
    words += f"{_range(margin)}{_islands(margin)}{_destroyed(margin)}{_failed(margin)}"
    return (
        f"{words}{_without_links(margin, 'alone' if verdict.neighbours else 'without its stops and ties')}."
    )


def _without_links(margin: Margin, without: str) -> str:
    """What the same container does without its stops and ties, or its neighbours."""
    most = margin.without_links_tried_to
    if most is None:
        return ""
    if margin.factor_without_links is None:
        return f"; {without} it stands up to {most:.3g}"
    return f"; {without} it overturns first at {FACTOR.text(margin.factor_without_links)}"


def _range(margin: Margin) -> str:
    """What the draws say of the first overturning."""
    if not margin.draws:
        return ""
    if margin.low is None:
        return f", nor do they in any of {margin.draws} draws of what is not known"
    low = FACTOR.in_figures(margin.low, 2)
    if margin.high is not None:
        return f" ({low} to {FACTOR.in_figures(margin.high, 2)} over what is not known)"
    standing = f"{margin.draws_standing} of {margin.draws} draws stand up to {margin.draws_tried_to:.3g}"
    return f" (from {low} on over what is not known; {standing})"


def _islands(margin: Margin) -> str:
    """Where it stands again beyond the first overturning."""
    again = [
        FACTOR.text(low) if low == high else f"{FACTOR.text(low)} to {FACTOR.text(high)}"
        for low, high in margin.islands
    ]
    return f", stands again at {' and at '.join(again)}" if again else ""


def _destroyed(margin: Margin) -> str:
    """From which factor on a corner does not carry what the run says."""
    least = margin.destroyed_from
    return "" if least is None else f"; at {FACTOR.text(least)} times it a corner is destroyed"


def _failed(margin: Margin) -> str:
    count = margin.draws_failed
    return f"; {count} draw{'s' * (count != 1)} destroyed a corner or failed" if count else ""
