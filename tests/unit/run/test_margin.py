"""The margin of a run: the factor on its motion at which it overturns, with islands, draws and words."""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from first_swing import first_swing_threshold
from floors import half_sine_pulse

import fem
from contact.reference.rigid_block import RigidBlock
from fem.assessment.margin_words import margin_in_words
from fem.case.strength import scaled_motion
from fem.case.uncertainty import as_changed, draws_of
from fem.model.model import build_model
from fem.results.outcome import Ending
from fem.results.run_result import Band, ChangedRun, Margin, Verdict
from fem.run import changed_runs
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
        between = [factor for factor in (margin.factor, 0.98 * low) if factor < low]
        assert "overturned" in [outcome_at(run, factor) for factor in between]
    assert margin.runs <= search.MOST_RUNS


def test_islands_are_named():
    run = computed("solver.model=reduced", "container.fill=none")
    assert run.verdict.margin.islands
    assert "stands again at" in run.verdict.first_line


@pytest.fixture(scope="module")
def with_draws():
    """A run with draws, on one core and on two."""
    with pytest.MonkeyPatch.context() as patch:
        runs = []
        for count in (1, 2):
            patch.setattr(changed_runs, "cores", lambda count=count: count)
            runs.append(computed(band=None))
        return runs


def test_draws_give_the_range_and_the_margin_repeats_itself(with_draws):
    first, again = (run.verdict.margin for run in with_draws)
    assert first == again
    assert first.draws > 0
    assert first.draws_failed == 0


def test_the_low_end_is_that_of_a_draw_of_margin_or_band(with_draws):
    run, _ = with_draws
    margin, own = run.verdict.margin, run.case
    case = fem.load_case("rocking", RIGID)
    coarse = {"solver.energy_tolerance": changed_runs.DRAWN_TOLERANCE}
    assert margin.low < margin.factor

    def falls(factor: float) -> bool:
        runs = [
            fem.compute(
                own.replace(as_changed(own, {**draw.values, **scaled_motion(own, factor), **coarse})),
                band=False,
            )
            for draw in draws_of(case, search.build_model(case).penalty, margin.draws)
        ]
        return any(one.verdict.outcome == "overturned" for one in runs)

    assert run.verdict.band.draws_overturned > 0
    assert margin.low <= 1.0
    assert margin.low == 1.0 or falls(margin.low)
    assert not falls(margin.low / search.DRAWN_STEP)


def test_a_motion_is_made_as_strong_as_its_keys_allow():
    margin = computed("motion.peak_acceleration_m_s2=40", "motion.angular_frequency_rad_s=50").verdict.margin
    assert margin is not None
    assert 2.1 < margin.largest_tried <= 2.5  # 100 m/s2
    assert margin.draws_failed == 0


def test_failed_trials_say_nothing_and_the_search_ends():
    known = {1.0: Ending.STANDING, 1.2: Ending.OVERTURNED}
    search._locate(known, lambda factor: Ending.FAILED)
    assert len(known) == 3
    found = search._near(lambda factor: Ending.FAILED if factor > 1.1 else Ending.STANDING, 1.0, 0.5, 4.0)
    assert math.isnan(found)


def test_runs_that_are_left_find_an_island_between_two_factors_of_the_scan():
    def trial(factor: float) -> Ending:
        return Ending.OVERTURNED if 1.96 < factor < 2.14 else Ending.STANDING

    with ThreadPoolExecutor() as pool:
        assert all(trial(factor) == Ending.STANDING for factor in search._scanned(0.4, 4.0))
        known = search._searched(Ending.STANDING, 0.4, 4.0, trial, pool)
    first = search._first(known)
    assert first.low <= 1.96 < first.high <= first.low / (1.0 - search.RESOLUTION)
    assert len(known) <= search.MOST_RUNS + 1


def test_a_container_with_stops_has_the_margin_without_them_beside_its_own():
    kerb = "{{side = '{}', height_m = 0.1, gap_m = 0.1, stiffness_N_m = 1e8, restitution = 0.5}}"
    slides = ("contact.mu_static=0.2", "contact.mu_kinetic=0.15", "motion.peak_acceleration_m_s2=5")
    motion = ("motion.angular_frequency_rad_s=4.4", "solver.duration_s=12")
    stops = ",".join(kerb.format(side) for side in ("left", "right"))
    held, free = (computed(*slides, *motion, f"stop=[{rows}]") for rows in (stops, ""))
    assert free.verdict.margin.factor_without_links is None
    assert free.verdict.margin.without_links_tried_to is None
    margin, own = held.verdict.margin, free.verdict.margin
    assert margin.factor < 0.9 * (own.factor or own.largest_tried)  # it falls over its kerb
    assert margin.factor_without_links == (
        None if own.factor is None else pytest.approx(own.factor, rel=0.03)
    )
    assert margin.without_links_tried_to >= 1.0


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


MARGIN = Margin(
    factor=1.504, stands_up_to=1.487, least_tried=0.25, largest_tried=4.0, runs=20, draws_tried_to=4.0
)


def test_the_margin_is_written_and_read():
    margin = replace(MARGIN, islands=((1.6, 1.7),))
    assert Verdict.from_json(Verdict(margin=margin).to_json()).margin == margin


def test_a_corner_that_a_stronger_motion_destroys_is_named():
    # On the end of its wall the plateau stack crushes 7 mm of the floor; under twice its motion it is more than 10.
    changes = ("solver.model=rigid", "solver.duration_s=10", "floor.corner_patch_m=[0.008, 1.1]")
    verdict = fem.compute(fem.load_case("stack_on_concrete", changes), band=False, margin=True).verdict
    assert 1.0 < verdict.margin.destroyed_from < 2.0
    assert f"; at {verdict.margin.destroyed_from:.2f} times this motion a corner is destroyed, and" in (
        margin_in_words(verdict)
    )


def test_what_overturns_in_the_band_bounds_the_margin():
    case = fem.load_case("seed_stack_plateau", [*RIGID, "solver.duration_s=4", "uncertainty.draws=2"])
    run = fem.compute(case, band=False)
    model, result = search.build_model(run.case), run.typed_result

    def low(*members):
        band = Band(outcomes=(), unsure=True, members=members)
        given = replace(result, verdict=replace(run.verdict, band=band))
        return search.margin_of(model, given, drawn=True, stop=lambda: False).low

    own, fell = (
        ChangedRun(status="completed", outcome=run.verdict.outcome),
        ChangedRun(status="overturned", outcome="overturned", kind="draw"),
    )
    assert low(own, replace(own, kind="draw")) > 1.0
    assert low(own, fell) == 1.0
    assert low(own, replace(fell, kind="one", values={"solver.energy_tolerance": 0.1})) > 1.0


def test_the_margin_over_a_mirrored_motion_is_that_of_the_mirrored_case():
    keys = [
        *("solver.model=rigid", "solver.duration_s=6", "container.eccentricity_m=0.15", "motion.kind=pulse"),
        *("motion.shape=sine", "motion.peak_acceleration_m_s2=3.8", "motion.pulse_s=1.0"),
    ]
    own = build_model(fem.load_case("rocking", keys))
    mirrored = build_model(fem.load_case("rocking", [*keys, "motion.peak_acceleration_m_s2=-3.8"]))
    other = {"motion.peak_acceleration_m_s2": -3.8}
    for factor, falls in ((0.8, False), (0.95, True)):  # from its own side it falls from 1.05 on
        ending = search._trial(own, other, lambda: False)(factor)
        assert ending == search._trial(mirrored, {}, lambda: False)(factor)
        assert (ending == Ending.OVERTURNED) == falls
        assert search._trial(own, {}, lambda: False)(factor) == Ending.STANDING
