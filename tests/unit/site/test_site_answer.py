"""The three answers: what each condition of "fulfilled" asks for, and the sentence where it is not met."""

from dataclasses import replace

import pytest
from site_example import RUN, example

from fem.site.answer import Beside, answer_of
from fem.site.request import load_site
from fem.site.result import FURTHER, REFINED, REPEATED, SCAN, ConfirmedRun, SiteRun, TwoDirections
from fem.site.rule import margin_factor
from fem.site.runs import key_of
from fem.site.stages import REPETITIONS

REQUEST = load_site("site").with_value("limits.slip_m", 0.1)  # and 0.5, 0.8 of the angle
MOTIONS = example()[0].set
SEVEN = range(1, 8)


def runs_of(stage="set", motions=SEVEN, factor=1.0, **changes) -> list[SiteRun]:
    return [replace(RUN, stage=stage, motion=number, factor=factor, **changes) for number in motions]


def repeated(**changes) -> list[SiteRun]:
    return [run for factor in REPETITIONS for run in runs_of(REPEATED, factor=factor, **changes)]


def further(count=100, beyond=0, overturned=0) -> list[SiteRun]:
    """So many further motions; some slide beyond the clearance, others overturn."""
    runs = runs_of(FURTHER, range(1, count + 1))
    runs[:beyond] = [replace(run, max_slip_m=0.2) for run in runs[:beyond]]
    last = count - overturned
    runs[last:] = [replace(run, outcome="overturned") for run in runs[last:]]
    return runs


def answer(*stages: list[SiteRun], **beside):
    runs = {key_of(run): run for stage in stages for run in stage}
    return answer_of(REQUEST, MOTIONS, runs, Beside(**beside))


def confirmed(**changes) -> ConfirmedRun:
    found = {"outcome": "rock", "rotation_ratio": 0.1, "max_slip_m": 0.01} | changes
    return ConfirmedRun(run=RUN, model="reduced", sure="sure", **found)


def test_fulfilled_needs_the_set_its_repetitions_the_further_motions_and_the_deciding_runs():
    found = answer(runs_of(), repeated(), further(), confirmed=(confirmed(),), wind=0.6)
    assert (found.answer, found.fulfilled, found.reasons) == ("fulfilled", True, ())
    assert found.sentence.startswith("Fulfilled under the rule below: none of 7 runs overturned")
    assert [(one.name, one.answer) for one in found.actions] == [
        ("earthquake", "fulfilled"),
        ("wind", "fulfilled"),
    ]
    assert found.actions[0].utilisation == pytest.approx(0.2)  # rotation 0.1 of 0.5
    assert found.rule_range.repetitions == 5
    assert found.rule_range.rotation_ratio == pytest.approx((0.1, 0.1))


FIRST = {"motions": (1,)}
OTHERS = {"motions": range(2, 8)}


@pytest.mark.parametrize(
    ("own", "again", "words"),
    [
        ({"rotation_ratio": 0.51}, {"rotation_ratio": 0.52}, "mean rotation of the 7 motions is 0.51"),
        (
            {"max_slip_m": 0.12},
            {"max_slip_m": 0.12},
            "The largest slip is 120 mm, beyond the clearance of 100 mm",
        ),
    ],
)
def test_a_limit_that_the_set_and_all_repetitions_exceed_is_not_fulfilled(own, again, words):
    found = answer(runs_of(**own), repeated(**again), further())
    assert (found.answer, found.fulfilled) == ("not fulfilled", False)
    assert words in found.sentence and found.sentence.startswith("Not fulfilled. ")


def test_one_slip_beyond_the_clearance_is_told_with_its_count():
    own = runs_of(**OTHERS) + runs_of(**FIRST, max_slip_m=0.239)
    again = [run for run in repeated() if run.motion > 1] + [
        run for run in repeated(max_slip_m=0.23) if run.motion == 1
    ]
    found = answer(own, again, further())
    assert found.answer == "not fulfilled"
    assert "240 mm" in found.sentence and "1 of 7 motions beyond it" in found.sentence
    assert found.slip_m == 0.239 and found.slip_mean_m < 0.05


@pytest.mark.parametrize(("own", "again"), [(0.49, 0.52), (0.51, 0.48)])
def test_a_limit_within_the_range_of_the_repetitions_is_not_sure(own, again):
    found = answer(runs_of(rotation_ratio=own), repeated(rotation_ratio=again), further())
    assert (found.answer, found.fulfilled) == ("not sure", None)
    assert "lies between" in found.sentence
    assert found.rule_range.rotation_ratio == pytest.approx(sorted((own, again)))


@pytest.mark.parametrize(
    ("stages", "beside", "words"),
    [
        ([repeated(outcome="overturned"), further()], {}, "In 5 of 5 repetitions"),
        ([repeated(outcome=None), further()], {}, "Runs of the repetitions that failed: 35."),
        ([repeated(), further(71)], {}, "cannot show that at most 5 % overturn it: at least 72 can"),
        ([repeated(), further(100, overturned=2)], {}, "2 of 100 further motions overturned it"),
        ([repeated(), further(100, beyond=18)], {}, "Of 100 further motions 18 went beyond a limit"),
        (
            [repeated(), further()],
            {"confirmed": (confirmed(outcomes=("rock", "overturned")),)},
            "can overturn",
        ),
        ([repeated(), further()], {"confirmed": (confirmed(outcome=None),)}, "1 of 1 deciding runs"),
        ([repeated(), further()], {"confirmed": (confirmed(max_slip_m=0.2),)}, "go beyond a limit"),
        ([repeated(), further()], {"confirmed": (confirmed(bolt_utilisation=1.2),)}, "bolts carry 1.2"),
        ([repeated()], {"left_out": "Further motions were left out."}, "were left out"),
    ],
)
def test_what_speaks_against_it_is_one_sentence_and_not_sure(stages, beside, words):
    found = answer(runs_of(), *stages, **beside)
    assert (found.answer, found.fulfilled) == ("not sure", None)
    assert len(found.reasons) == 1 and words in found.reasons[0] and words in found.sentence


def test_the_limit_of_a_single_rotation_governs_where_most_of_it_is_used():
    """0.5 of 0.8 by one motion of the empty container; of the full one slip 0.06 of 0.1 m."""
    empty = runs_of(**OTHERS, mass="empty") + runs_of(**FIRST, mass="empty", rotation_ratio=0.5)
    found = answer(runs_of(max_slip_m=0.06) + empty, repeated(), further())
    assert found.actions[0].utilisation == pytest.approx(0.5 / 0.8)
    assert (found.governing.mass, found.governing.motion) == ("empty", 1)


def test_what_further_motions_can_show():
    """0 of 72 and 1 of 110 put the upper end of the 95 % interval at 5 %."""
    for motions, overturned, sure in ((72, 0, True), (109, 1, False), (110, 1, True), (200, 3, True)):
        found = answer(runs_of(), repeated(), further(motions, overturned=overturned))
        assert (found.answer == "fulfilled") == sure, (motions, overturned)
    found = answer(runs_of(), repeated(), further(100, beyond=10))
    assert found.answer == "fulfilled" and found.further[0].beyond_limits == 10


def test_any_overturning_is_not_fulfilled_and_counts_before_all_doubts():
    own = runs_of(**OTHERS) + runs_of(**FIRST, outcome="overturned")
    found = answer(own, repeated(), further(100, beyond=20), wind=1.27)
    assert found.answer == "not fulfilled" and found.rotation_ratio is None
    assert "1 of 7 runs overturned: up to 1 of 7 motions" in found.sentence
    assert "Wind uses 1.3 times" in found.sentence and "further" not in found.sentence
    assert any("20 went beyond" in reason for reason in found.reasons)


def test_a_run_that_destroys_a_corner_does_not_count_as_standing_and_is_named_apart():
    own = runs_of(**OTHERS) + runs_of(**FIRST, outcome="invalid")
    found = answer(own, repeated(), further())
    assert (found.answer, found.overturned) == ("not fulfilled", 0)
    assert "1 of 7 runs destroyed a corner" in found.sentence
    assert (found.invalid, found.governing.outcome) == (1, "invalid")
    scanned = answer(runs_of(), runs_of(SCAN, factor=1.5, outcome="invalid"))
    assert answer(runs_of(), runs_of(SCAN, factor=1.5, outcome=None)).scan[1].failed == 7
    assert [(point.factor, point.overturned, point.invalid) for point in scanned.scan] == [
        (1.0, 0, 0),
        (1.5, 0, 7),
    ]
    many = further(99) + runs_of(FURTHER, (100,), outcome="invalid")
    found = answer(runs_of(), repeated(), many)
    assert found.answer == "not sure" and (found.further[0].overturned, found.further[0].invalid) == (0, 1)
    assert "0 of 100 further motions overturned it, 1 destroyed a corner" in found.sentence
    found = answer(runs_of(), repeated(), further(), confirmed=(confirmed(outcomes=("rock", "invalid")),))
    assert found.answer == "not sure" and "can destroy a corner" in found.sentence


def test_wind_alone_can_refuse_and_the_earthquake_keeps_its_own_answer():
    found = answer(runs_of(), repeated(), further(), wind=1.27)
    assert found.answer == "not fulfilled"
    assert [one.answer for one in found.actions] == ["fulfilled", "not fulfilled"]


def test_failed_runs_leave_no_answer():
    own = runs_of(**OTHERS) + runs_of(**FIRST, outcome=None)
    found = answer(own, repeated(), further())
    assert (found.answer, found.fulfilled) == (None, None)
    assert found.sentence == "No answer: 1 of 7 runs failed."


def test_the_margin_is_the_least_factor_at_which_any_limit_fails():
    scan = runs_of(SCAN, factor=1.25, max_slip_m=0.12) + runs_of(SCAN, factor=1.5, outcome="overturned")
    runs = {key_of(run): run for run in [*runs_of(), *scan]}
    assert margin_factor(REQUEST.limits, runs) == 1.25
    between = runs_of(REFINED, factor=1.125, max_slip_m=0.11)
    runs |= {key_of(run): run for run in between}
    assert margin_factor(REQUEST.limits, runs) == 1.125
    # A part of a group has no mean: of one run that turns far nothing follows, of one that overturns it does.
    part = replace(RUN, stage=REFINED, factor=1.0625, rotation_ratio=0.7)
    assert margin_factor(REQUEST.limits, runs | {key_of(part): part}) == 1.125
    part = replace(part, outcome="overturned")
    assert margin_factor(REQUEST.limits, runs | {key_of(part): part}) == 1.0625


def test_each_pair_of_further_motions_is_told_by_itself():
    both = further() + [replace(run, mass="empty") for run in further(100, overturned=3)]
    found = answer(runs_of(), repeated(), both)
    assert [(one.mass, one.overturned) for one in found.further] == [("full", 0), ("empty", 3)]
    assert (
        "3 of 100 further motions overturned it" in found.sentence
        and "(empty, motion along its width, friction 0.4/0.2)" in found.sentence
    )


def two_directions(largest, factor):
    return TwoDirections(
        slip_mean_m=0.5 * largest,
        slip_largest_m=largest,
        slip_mean_in_plane_m=0.2 * largest,
        mu_static=0.3,
        mu_kinetic=0.15,
        motion=5,
        margin_factor=factor,
    )


def test_the_slip_in_two_directions_is_compared_with_the_clearance():
    found = answer(runs_of(), repeated(), further(), two_directions=two_directions(0.12, 1.0))
    assert (found.answer, found.margin_factor) == ("not fulfilled", 1.0)
    assert found.reasons == (
        "Under both horizontal components at once the largest slip is 120 mm, beyond the clearance of 100 mm "
        "(motion 5, friction 0.3/0.15; a body that does not rock).",
    )
    assert found.actions[0].utilisation == pytest.approx(1.2)


@pytest.mark.parametrize(("used", "said"), [(1.27, "1.3"), (1.004, "1.004"), (1.00001, "just over 1")])
def test_what_is_used_up_is_not_rounded_to_its_limit(used, said):
    found = answer(runs_of(), repeated(), further(), wind=used, confirmed=(confirmed(bolt_utilisation=used),))
    assert f"Wind uses {said} times the resistance" in found.reasons[0]
    assert f"the bolts carry {said} times their capacity" in found.reasons[1]
    slid = answer(runs_of(), repeated(), further(), two_directions=two_directions(0.1004, 1.0))
    assert "the largest slip is 100.4 mm, beyond the clearance of 100 mm" in slid.sentence


def test_fulfilled_names_every_limit_with_what_is_held_against_it():
    found = answer(runs_of(), repeated(), further())
    assert found.answer == "fulfilled" and found.rotation_ratio_largest == 0.1
    assert "(limit 0.5), of a single motion 0.100 (limit 0.8), largest slip" in found.sentence


def test_within_the_clearance_the_slip_in_two_directions_is_the_one_in_the_sentence():
    found = answer(runs_of(), repeated(), further(), two_directions=two_directions(0.08, 1.5))
    assert (found.answer, found.margin_factor) == ("fulfilled", 1.5)
    assert "largest slip 80.0 mm (limit 100 mm)" in found.sentence
    assert found.actions[0].utilisation == pytest.approx(0.8)


def test_a_clearance_within_the_slips_of_the_repetitions_in_two_directions_is_not_sure():
    slid = replace(two_directions(0.0999, None), slip_range_m=(0.0998, 0.1001))
    found = answer(runs_of(), repeated(), further(), two_directions=slid)
    assert found.answer == "not sure"
    assert "99.8 to 100.1 mm in repetitions" in found.reasons[0] and "lies between" in found.reasons[0]


def test_further_motions_that_slide_too_far_in_two_directions_speak_against_it():
    """With the slips of its runs, which are plane, well within the clearance."""
    pair = (None, 0.4, 0.2)
    slips = {(motion, *pair): 0.2 if motion <= 18 else 0.05 for motion in range(1, 101)}
    found = answer(runs_of(), repeated(), further(), slips_of_further=slips)
    assert found.answer == "not sure"
    assert found.reasons == (
        "Of 100 further motions 18 went beyond a limit of a single motion, 18 by slip under both horizontal components "
        "(full, motion along its width, friction 0.4/0.2): of such motions more than 5 % do.",
    )
    assert (found.further[0].slip_largest_m, found.further[0].slid_too_far) == (0.2, 18)


def test_a_further_motion_beyond_the_clearance_in_the_plane_and_in_two_directions_counts_once():
    slips = {(motion, None, 0.4, 0.2): 0.2 for motion in (1, 2, 3)}
    found = answer(runs_of(), repeated(), further(beyond=2), slips_of_further=slips)
    assert (found.further[0].beyond_limits, found.further[0].slid_too_far) == (3, 3)
