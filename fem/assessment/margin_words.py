"""The margin of a run in one sentence: whether it stands, and by which factor on the motion it overturns."""

from fem.assessment.motion_words import covered_in_words, is_cut
from fem.results.outcome import Outcome
from fem.results.run_result import Margin, MotionResult, Verdict
from fem.runtime.units import DisplayUnit

FACTOR = DisplayUnit(figures=3)


def margin_in_words(verdict: Verdict | None, motion: MotionResult | None = None) -> str:
    """The margin of a verdict as a sentence; empty if none was computed.

    Args:
        verdict: of a run.
        motion: of that run, which may end before its motion does.
    """
    if verdict is None or verdict.margin is None:
        return ""
    margin, stands = verdict.margin, verdict.outcome != Outcome.OVERTURNED
    under, this = "", "this motion"
    if motion is not None and is_cut(motion):
        under, this = f" under {covered_in_words(motion)}", "this part of the motion"
    lead, early = f"{'Stands' if stands else 'Overturns'}{under}; ", _destroyed_first(margin, this)
    whom = "one of the row" if verdict.neighbours else "it"
    subject = "one of the row" if verdict.neighbours and stands else "it" if early else ""
    it = lead + (f"{early} and " if early else "") + (f"{subject} " if subject else "")
    if margin.factor is None:
        count, also = margin.runs, " and " if early else ""
        if count and margin.largest_tried > 1.0:
            tried = (
                f"{count} multiple{'s' * (count > 1)} of {this}, up to {margin.largest_tried:.3g} times, "
                f"do{'es' * (count == 1)} not overturn {whom}"
            )
        else:
            tried = f"no multiple of {this} above 1 shows whether {whom} overturns"
        words = f"{lead}{early}{also}{tried}"
    elif margin.stands_up_to is None:
        still = "overturns" if stands else "still does"
        words = f"{it}{still} at {margin.factor:.3g} times {this}, the weakest tried"
    else:
        up_to = "" if stands else f"stands up to {FACTOR.text(margin.stands_up_to)} times {this}, "
        times = f" times {this}" if stands else ""
        words = f"{it}{up_to}overturns first at {FACTOR.text(margin.factor)}{times}"
    late = "" if early else _destroyed(margin)
    words += f"{_range(margin)}{_islands(margin)}{late}{_without_links(verdict, margin)}."
    return f"{words}{_draws(margin)}"


def _without_links(verdict: Verdict, margin: Margin) -> str:
    """What the same container does without its stops, ties and neighbours."""
    most = margin.without_links_tried_to
    forces = {"stops": verdict.stop_force_N, "ties": verdict.tie_force_N}
    held = " and ".join(name for name, force in forces.items() if force is not None)
    it = f"without its {held} it"
    if verdict.neighbours:
        it = f"the container alone{f', without {held},' if held else ''}"
    if most is None:
        return ""
    if margin.factor_without_links is None:
        return f"; {it} does not overturn up to {most:.3g} times"
    return f"; {it} overturns first at {FACTOR.text(margin.factor_without_links)}"


def _range(margin: Margin) -> str:
    """Between which factors all draws overturn first, or that none does; empty where a draw failed or stands."""
    if margin.low is None and margin.draws > 1 and not margin.draws_failed:
        return f", nor does the strongest overturn any of {margin.draws} draws of what is not known"
    if margin.low is None or margin.high is None:
        return ""
    ends = " to ".join(dict.fromkeys(map(FACTOR.text, (margin.low, margin.high))))
    return f" ({ends} over what is not known)"


def _islands(margin: Margin) -> str:
    """Where it stands again beyond the first overturning."""
    again = [
        FACTOR.text(low) if low == high else f"{FACTOR.text(low)} to {FACTOR.text(high)}"
        for low, high in margin.islands
    ]
    return f", stands again at {' and at '.join(again)}" if again else ""


def _destroyed_first(margin: Margin, this: str) -> str:
    """At which factor a corner is destroyed, where that is below the first that overturns; empty elsewhere."""
    least = margin.destroyed_from
    if least is None or (margin.factor is not None and margin.factor <= least):
        return ""
    return f"at {FACTOR.text(least)} times {this} a corner is destroyed,"


def _destroyed(margin: Margin) -> str:
    """At which factor beyond the first that overturns a corner is destroyed; empty where it is at none."""
    least = margin.destroyed_from
    return "" if least is None else f"; at {FACTOR.text(least)} times it a corner is destroyed"


def _draws(margin: Margin) -> str:
    """A sentence on the draws where not all of them overturn, or some say nothing."""
    standing, failed, parts = margin.draws_standing, margin.draws_failed, []
    if margin.low is not None and margin.high is not None:
        standing = 0
    if standing and (margin.low is not None or failed or margin.draws == 1):
        parts.append((standing, f"stand{'s' * (standing == 1)} at {margin.draws_tried_to:.3g} times"))
    if failed:
        parts.append(
            (failed, f"destroy{'s' * (failed == 1)} a corner or fail{'s' * (failed == 1)} at some factor")
        )
    if not parts:
        return ""
    count = margin.draws + failed
    if parts[0][0] == count > 1:
        counts = f"all {count} draws {parts[0][1]}."
    else:
        does = " and ".join(f"{number} {doing}" for number, doing in parts)
        counts = f"of {count} draw{'s' * (count > 1)} {does}."
    if margin.low is None:
        return f" Over what is not known, {counts}"
    if margin.high is not None:
        return f" {counts.capitalize()}"
    return f" Over what is not known it overturns from {FACTOR.text(margin.low)} times on; {counts}"
