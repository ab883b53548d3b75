"""The answer of a verification at a site for runs that a line of a transcript makes: `repeated(), further(71)`."""

from dataclasses import replace

from site_example import RUN, example

from fem.site.answer import Beside, answer_of
from fem.site.request import load_site
from fem.site.result import FURTHER, REPEATED, ConfirmedRun, TwoDirections
from fem.site.runs import key_of
from fem.site.stages import REPETITIONS

MOTIONS = example()[0].set


def runs(motions=range(1, 8), stage="set", **changes):
    return [replace(RUN, stage=stage, motion=number, **changes) for number in motions]


def first(**changes):
    """The runs of the set, the first of which is changed."""
    return runs((1,), **changes) + runs(range(2, 8))


def repeated(**changes):
    return [run for factor in REPETITIONS for run in runs(stage=REPEATED, factor=factor, **changes)]


def further(count=100, beyond=0, overturned=0, **changes):
    """So many further motions; some slide beyond the clearance, others overturn."""
    found = runs(range(1, count + 1), FURTHER, **changes)
    found[:beyond] = [replace(run, max_slip_m=0.2) for run in found[:beyond]]
    found[count - overturned :] = [replace(run, outcome="overturned") for run in found[count - overturned :]]
    return found


def confirmed(**changes):
    found = {"outcome": "rock", "rotation_ratio": 0.1, "max_slip_m": 0.01} | changes
    return (ConfirmedRun(run=RUN, model="reduced", sure="sure", **found),)


def in_two_directions(largest, factor, **more):
    slips = {"slip_mean_m": 0.5 * largest, "slip_largest_m": largest, "slip_mean_in_plane_m": 0.2 * largest}
    return TwoDirections(mu_static=0.3, mu_kinetic=0.15, motion=5, margin_factor=factor, **slips, **more)


def answer(*stages, **beside):
    request = load_site("site").with_value("limits.slip_m", 0.1)  # and 0.5, 0.8 of the angle
    return answer_of(
        request, MOTIONS, {key_of(run): run for stage in stages for run in stage}, Beside(**beside)
    )


def answered(asked):
    """The sentence, the reasons against, and the rule."""
    found = eval(f"answer({asked})")  # a line of this folder
    return "\n".join([f"{found.answer}: {found.sentence}", *found.reasons, f"rule: {found.rule}"])
