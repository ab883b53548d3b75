"""The margin of a run: the factor on its motion at which it overturns, with islands and variations."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import pytest
from closed_forms import first_swing_threshold
from floors import half_sine_pulse

import fem
from contact.reference.rigid_block import RigidBlock
from fem.case.strength import scaled_motion
from fem.case.uncertainty import all_changes, as_changed
from fem.model.model import build_model
from fem.results.outcome import Ending
from fem.results.run_result import Band, ChangedRun, Governing, Margin, Verdict
from fem.run import band
from fem.run import margin as search
from fem.run.compute import Run

RIGID = ["solver.model=rigid", "floor.kind=rigid", "output.fields_s=0"]


PULSE = [*RIGID, "contact.mu_static=2", "motion.kind=pulse", "motion.shape=half-sine", "motion.pulse_s=0.4"]


def computed(*changes: str, name: str = "rocking", **wanted) -> Run:
    return fem.compute(fem.load_case(name, [*RIGID, *changes]), **({"band": False, "margin": True} | wanted))


def outcome_at(run: Run, factor: float) -> str:
    scaled = run.case.replace(scaled_motion(run.case, factor))
    return fem.compute(scaled, band=False, margin=False).verdict.outcome


def test_a_pulse_overturns_at_the_threshold_of_the_analytic_block():
    peak = 3.0
    run = computed(*PULSE, f"motion.peak_acceleration_m_s2={peak}")
    width, height = run.case.container.width_m, 2.0 * run.typed_result.static.centroid_m
    threshold = first_swing_threshold(
        RigidBlock.homogeneous(width=width, height=height, gravity=9.81),
        lambda a: half_sine_pulse(peak=a, duration=0.4),
        low=peak,
        high=4.0 * peak,
        duration=20.0,
    )
    margin = run.verdict.margin
    assert margin.stands_up_to * peak <= 1.005 * threshold
    assert threshold <= 1.005 * margin.factor * peak
    assert margin.factor / margin.stands_up_to <= 1.0 / (1.0 - search.RESOLUTION)
    assert (margin.governing.of, margin.governing.factor) == ("case", margin.factor)


@pytest.mark.parametrize("peak", ["6.4", "10.6"])
def test_the_factors_are_those_of_runs_on_their_own(peak):
    run = computed(f"motion.peak_acceleration_m_s2={peak}")
    margin = run.verdict.margin
    assert (margin.factor > 1.0) == (run.verdict.outcome != "overturned")
    assert outcome_at(run, margin.factor) == "overturned"
    assert outcome_at(run, margin.stands_up_to) != "overturned"
    assert margin.factor / margin.stands_up_to <= 1.0 / (1.0 - search.RESOLUTION)
    # each step of the first scan is halved at least twice
    assert 0.0 < margin.governing.step <= (search.STEP - 1.0) / 4
    for low, high in margin.islands:
        assert "overturned" not in (outcome_at(run, low), outcome_at(run, high))


def test_islands_are_found():
    assert computed("solver.model=reduced", "container.fill=none").verdict.margin.islands


def test_the_margin_does_not_depend_on_the_cores_and_what_governs_is_a_draw_that_overturns(monkeypatch):
    for name in ("OWN_S", "DRAWN_S"):
        monkeypatch.setattr(search, name, 0.2)
    monkeypatch.setattr(band, "cores", lambda: 2)
    run = computed("uncertainty.draws=4", "solver.duration_s=6", band=None)
    margin, own = run.verdict.margin, run.case
    monkeypatch.setattr(band, "cores", lambda: 1)
    again = search.margin_of(search.build_model(own), run.typed_result, drawn=True, stop=lambda: False)
    assert margin == again
    governing = margin.governing
    assert governing.of == "variations" and governing.factor < margin.factor
    assert governing.variations == margin.draws + margin.draws_failed > 0
    stronger = scaled_motion(own, governing.factor) | {"solver.energy_tolerance": band.DRAWN_TOLERANCE}

    def outcome(draw):
        return fem.compute(own.replace(as_changed(own, draw.values | stronger)), band=False).verdict.outcome

    draws = all_changes(own, search.build_model(own).penalty)[2]
    assert governing.factor == 1.0 or "overturned" in map(outcome, draws)


def test_a_motion_is_made_as_strong_as_its_keys_allow():
    margin = computed("motion.peak_acceleration_m_s2=40", "motion.angular_frequency_rad_s=50").verdict.margin
    assert margin is not None and margin.draws_failed == 0
    assert 2.1 < margin.largest_tried <= 2.5  # 100 m/s2


def searched(trial, runs=search.LEAST_RUNS):
    """The search of one container."""
    own = search.Search(trial, {1.0: trial(1.0)})
    with ThreadPoolExecutor(2) as pool:
        search._scan(own, 0.4, 4.0, pool, 2)
        search._narrow([own], runs, pool, search.RESOLUTION)
    return own


@pytest.mark.parametrize(("falls_from", "asked"), [(0.9, 0.0), (1.7, 1.0)])
def test_of_one_that_falls_under_its_own_motion_all_steps_below_count(falls_from, asked):
    def trial(factor):
        ending = Ending.OVERTURNED if factor > falls_from else Ending.STANDING
        return search.Tried(ending, min(1.0, factor**4))

    own = searched(trial, 40)
    governing = search._governing(own, [], None)
    below = sorted(factor for factor in own.known if factor <= governing.factor)
    steps = {low: high / low - 1.0 for low, high in pairwise(below)}
    assert governing.step == max(step for low, step in steps.items() if low >= asked)
    assert (governing.step == max(steps.values())) == (asked == 0.0)


def test_failed_trials_say_nothing_and_the_search_ends():
    ends = searched(lambda factor: search.Tried(Ending.FAILED if factor > 1.1 else Ending.STANDING, 0.1))
    assert ends.first(Ending.OVERTURNED) is None and ends.end <= 1.1


@pytest.mark.parametrize(("low", "high"), [(1.96, 2.14), (1.5, 1.53)])
def test_steps_at_which_it_turns_are_halved_until_an_island_is_found(low, high):
    def trial(factor):
        ending = Ending.OVERTURNED if low < factor < high else Ending.STANDING
        return search.Tried(ending, 0.9 if 1.3 < factor < 2.3 else 0.1)

    found = searched(trial, 60).first(Ending.OVERTURNED)
    assert low < found <= low / (1.0 - search.RESOLUTION)


def test_no_factor_above_one_that_destroys_a_corner_counts():
    def trial(factor):
        return search.Tried(Ending.INVALID if factor > 1.7 else Ending.STANDING, 0.2)

    own = searched(trial)
    assert 1.7 < own.first(Ending.INVALID) <= 1.7 / (1.0 - search.RESOLUTION)
    assert len(own.of(Ending.INVALID)) <= 1 + 6  # of the scan, and of those that locate it


def test_a_container_with_stops_has_the_margin_without_them_beside_its_own():
    kerb = "{{side = '{}', height_m = 0.1, gap_m = 0.1, stiffness_N_m = 1e8, restitution = 0.5}}"
    slides = ("contact.mu_static=0.2", "contact.mu_kinetic=0.15", "motion.peak_acceleration_m_s2=5")
    motion = ("motion.angular_frequency_rad_s=4.4", "solver.duration_s=12")
    stops = ",".join(kerb.format(side) for side in ("left", "right"))
    held, free = (computed(*slides, *motion, f"stop=[{rows}]") for rows in (stops, ""))
    margin, own = held.verdict.margin, free.verdict.margin
    assert own.factor_without_links is None and own.without_links_tried_to is None
    assert margin.factor < 0.9 * (own.factor or own.largest_tried)  # it falls over its kerb
    without = None if own.factor is None else pytest.approx(own.factor, rel=0.03)
    assert margin.factor_without_links == without and margin.without_links_tried_to >= 1.0


def test_where_there_is_no_margin():
    short = "solver.duration_s=2"
    assert computed(short, name="free_rocking").verdict.margin is None  # a floor at rest
    assert computed(short, margin=None).verdict.margin is None  # the band is refused
    assert computed(short, margin=False).verdict.margin is None


def test_a_request_to_stop_ends_the_search():
    case = fem.load_case("rocking", RIGID)
    run = fem.compute(case, band=False)
    model = search.build_model(case)
    assert search.margin_of(model, run.typed_result, drawn=False, stop=lambda: True) is None


def test_the_margin_is_written_and_read():
    governing = Governing(factor=1.1, of="variations", ending="overturned", variations=6, step=0.04)
    margin = Margin(
        factor=1.5, least_tried=0.2, largest_tried=4.0, runs=20, islands=((1.6, 1.7),), governing=governing
    )
    assert Verdict.from_json(Verdict(margin=margin).to_json()).margin == margin


def test_a_corner_that_a_stronger_motion_destroys_governs():
    # On the end of its wall the plateau stack crushes 8 mm of the floor; at 1.58 times its motion it is more than 10.
    # With a patch of 8 mm and 10 s it overturns at 1.64, before a corner is destroyed at 1.74.
    changes = ("solver.model=rigid", "solver.duration_s=14", "floor.corner_patch_m=[0.0075, 1.1]")
    margin = fem.compute(fem.load_case("stack_on_concrete", changes), band=False, margin=True).verdict.margin
    assert 1.0 < margin.destroyed_from < 2.0
    assert (margin.governing.factor, margin.governing.ending) == (margin.destroyed_from, "invalid")


def test_what_overturns_in_the_band_bounds_the_margin(monkeypatch):
    for name in ("OWN_S", "DRAWN_S"):  # as far as little time allows: the bound is the same
        monkeypatch.setattr(search, name, 0.1)
    case = fem.load_case("seed_stack_plateau", [*RIGID, "solver.duration_s=3", "uncertainty.draws=2"])
    run = fem.compute(case, band=False)
    model, result = search.build_model(run.case), run.typed_result

    def low(*members):
        band = Band(outcomes=(), unsure=True, members=members)
        given = replace(result, verdict=replace(run.verdict, band=band))
        margin = search.margin_of(model, given, drawn=True, stop=lambda: False)
        return margin.low, margin.governing.factor

    own = ChangedRun(status="completed", outcome=run.verdict.outcome)
    fell = ChangedRun(status="overturned", outcome="overturned", kind="draw")
    assert min(low(own, replace(own, kind="draw"))) > 1.0
    assert low(own, fell) == (1.0, 1.0)
    assert min(low(own, replace(fell, kind="one", values={"solver.energy_tolerance": 0.1}))) > 1.0


def test_the_margin_over_a_mirrored_motion_is_that_of_the_mirrored_case():
    keys = [
        *("solver.model=rigid", "solver.duration_s=6", "container.eccentricity_m=0.15", "motion.kind=pulse"),
        *("motion.shape=sine", "motion.peak_acceleration_m_s2=3.8", "motion.pulse_s=1.0"),
    ]
    own = build_model(fem.load_case("rocking", keys))
    mirrored = build_model(fem.load_case("rocking", [*keys, "motion.peak_acceleration_m_s2=-3.8"]))
    other = {"motion.peak_acceleration_m_s2": -3.8}
    for factor, falls in ((0.8, False), (0.95, True)):  # from its own side it falls from 1.05 on
        tried = search._trial(own, other, lambda: False)(factor)
        assert tried == search._trial(mirrored, {}, lambda: False)(factor)
        assert (tried.ending == Ending.OVERTURNED) == falls
        assert search._trial(own, {}, lambda: False)(factor).ending == Ending.STANDING
