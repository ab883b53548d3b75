"""The margin of a run: the factor on its motion at which it overturns, with islands, draws and words."""

from dataclasses import replace

import pytest

import fem
from contact.reference.floor_acceleration import half_sine_pulse
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import first_swing_threshold
from fem.assessment.margin_words import margin_in_words
from fem.case.strength import scaled_motion
from fem.results.run_result import Margin, Verdict
from fem.run import margin as search
from fem.run.compute import Run

RIGID = ["solver.model=rigid", "floor.kind=rigid", "output.fields_s=0"]
PULSE = [
    *RIGID,
    "contact.mu_static=2",
    "motion.kind=pulse",
    "motion.shape=half-sine",
    "motion.pulse_s=0.4",
]


def computed(*changes: str, name: str = "rocking", **wanted) -> Run:
    return fem.compute(fem.load_case(name, [*RIGID, *changes]), **({"band": False, "margin": True} | wanted))


def outcome_at(run: Run, factor: float) -> str:
    return fem.compute(run.case.replace(scaled_motion(run.case, factor)), band=False).verdict.outcome


def test_a_pulse_overturns_at_the_threshold_of_the_analytic_block():
    peak = 3.0
    run = fem.compute(
        fem.load_case("rocking", [*PULSE, f"motion.peak_acceleration_m_s2={peak}"]), band=False, margin=True
    )
    container = run.case.container
    block = RigidBlock.homogeneous(
        width=container.width_m, height=2.0 * run.typed_result.static.centroid_m, gravity=9.81
    )
    threshold = first_swing_threshold(
        block, lambda a: half_sine_pulse(peak=a, duration=0.4), low=peak, high=4.0 * peak, duration=20.0
    )
    margin = run.verdict.margin
    assert margin.stands_up_to * peak <= 1.005 * threshold
    assert threshold <= 1.005 * margin.factor * peak
    assert margin.factor / margin.stands_up_to <= 1.0 / (1.0 - search.RESOLUTION)


@pytest.mark.parametrize("peak", ["6.4", "10.6"])
def test_the_factors_are_those_of_runs_on_their_own(peak):
    run = computed(f"motion.peak_acceleration_m_s2={peak}")
    margin = run.verdict.margin
    assert (margin.factor > 1.0) == (run.verdict.outcome != "overturned")
    assert outcome_at(run, margin.factor) == "overturned"
    assert outcome_at(run, margin.stands_up_to) != "overturned"
    for low, high in margin.islands:
        assert "overturned" not in (outcome_at(run, low), outcome_at(run, high))
    assert margin.runs <= search.MOST_RUNS


def test_islands_are_named():
    run = computed("solver.model=reduced")
    assert run.verdict.margin.islands
    assert "stands again at" in run.verdict.first_line
    assert all(run.verdict.margin.factor < low for low, _ in run.verdict.margin.islands)


def test_draws_give_the_range_and_the_margin_repeats_itself(monkeypatch):
    both = []
    for count in (1, 2):
        monkeypatch.setattr(search, "cores", lambda count=count: count)
        both.append(computed(band=None).verdict.margin)
    first, again = both
    assert first == again
    assert first.draws > 0
    assert first.low <= first.factor
    assert first.high is None or first.factor <= first.high


def test_a_floor_at_rest_has_no_margin():
    assert computed(name="free_rocking").verdict.margin is None


def test_a_refused_band_leaves_the_margin_out_unless_it_is_asked_for():
    assert computed(margin=None).verdict.margin is None
    assert computed(margin=False, band=None).verdict.margin is None


def test_a_request_to_stop_ends_the_search():
    case = fem.load_case("rocking", RIGID)
    run = fem.compute(case, band=False)
    model = search.build_model(case)
    assert search.margin_of(model, run.typed_result, drawn=False, stop=lambda: True) is None


MARGIN = Margin(factor=1.504, stands_up_to=1.487, least_tried=0.25, largest_tried=4.0, runs=20)


@pytest.mark.parametrize(
    ("changes", "outcome", "words"),
    [
        ({}, "rock", "Stands; overturns first at 1.50 times this motion."),
        (
            {"low": 1.29, "high": 1.72, "draws": 16},
            "rock",
            "Stands; overturns first at 1.50 times this motion (1.3 to 1.7 over what is not known).",
        ),
        (
            {"low": 1.29, "draws": 16, "draws_standing": 3},
            "rock",
            "Stands; overturns first at 1.50 times this motion (from 1.3 on over what is not known; 3 of 16 draws "
            "stand up to 4).",
        ),
        (
            {"islands": ((1.62, 1.68), (2.0, 2.0))},
            "rock",
            "Stands; overturns first at 1.50 times this motion, stands again at 1.62 to 1.68 and at 2.00.",
        ),
        (
            {"factor": None, "stands_up_to": None, "runs": 16},
            "slide",
            "Stands; none of 16 other motions up to 4 times as strong overturns it.",
        ),
        (
            {"factor": None, "stands_up_to": None, "low": 1.9, "draws": 16, "draws_standing": 15},
            "slide",
            "Stands; none of 20 other motions up to 4 times as strong overturns it (from 1.9 on over what is not "
            "known; 15 of 16 draws stand up to 4).",
        ),
        (
            {"factor": None, "stands_up_to": None, "draws": 16, "draws_standing": 16},
            "slide",
            "Stands; none of 20 other motions up to 4 times as strong overturns it, nor in any of 16 draws of what is "
            "not known.",
        ),
        (
            {"factor": 0.81, "stands_up_to": 0.799, "largest_tried": 1.0},
            "overturned",
            "Overturns; stands up to 0.799 times this motion.",
        ),
        (
            {"factor": 0.05, "stands_up_to": None, "largest_tried": 1.0},
            "overturned",
            "Overturns; overturns at 0.05 times this motion, too, the weakest tried.",
        ),
    ],
)
def test_the_sentence_says_what_was_tried(changes, outcome, words):
    verdict = Verdict(outcome=outcome, margin=replace(MARGIN, **changes))
    assert margin_in_words(verdict) == words


def test_the_margin_is_written_and_read():
    margin = replace(MARGIN, islands=((1.6, 1.7),))
    assert Verdict.from_json(Verdict(margin=margin).to_json()).margin == margin
