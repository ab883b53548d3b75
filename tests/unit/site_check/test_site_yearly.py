"""The rate per year of a site: hazard, levels with motions of their own, counts, and what is said of them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr
from site_example import RUN, example, site_body

from fem.case.validation import CaseError
from fem.cli.assess import page_of
from fem.html.page import Page, html_of
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.hazard import HazardCurve, counted_rate
from fem.site_check.file import load_site
from fem.site_check.page.answer_section import rates_in_words
from fem.site_check.page.runs_section import runs_section
from fem.site_check.page.view import SiteView
from fem.site_check.rule import groups_of
from fem.site_check.run import site_hash
from fem.site_check.runs import HAZARD, key_of
from fem.site_check.yearly import (
    annual_rates,
    hazard_motions,
    hazard_runs,
    rocks_from,
    scattered,
    slides_from,
)

SITE = """
container = "seed_stack"
[site]
ground = "D"
reference_acceleration_m_s2 = 1.6
[motions]
scatter = {scatter}
[friction]
mu_static = [0.3, 0.4]
[limits]
slip_m = 0.1
[hazard]
{hazard}
"""
POINTS = "points = [[475, 1.6], [2475, 3.0]]"
CURVE = HazardCurve.from_return_periods([(475.0, 1.6), (2475.0, 3.0)])
BODY = site_body("full")
TIMES = np.arange(0.0, 1.0, 0.01)


def request(folder, hazard=POINTS, scatter=0.4):
    place = folder / "hall.toml"
    place.write_text(SITE.format(hazard=hazard, scatter=scatter))
    return load_site(place)


def push(peak, *, second=None, vertical=None):
    """A motion that accelerates back and forth once a second."""
    wave = np.sin(2.0 * np.pi * TIMES)
    parts = {
        name: None if one is None else one * wave
        for name, one in (("second", second), ("vertical", vertical))
    }
    return GroundMotion(name="push", step=0.01, horizontal=peak * wave, **parts)


def rates(folder, counts, *, motions=100, scatter=0.4, hazard=POINTS, velocity=0.5, failed=None):
    """From counts of overturning at factors on the motions, of which shares failed."""
    runs, made = {}, {}
    for level, (factor, fallen) in enumerate(counts.items()):
        without = round(motions * (failed or {}).get(factor, 0.0))
        for k in range(motions):
            run = replace(
                RUN,
                stage=HAZARD,
                motion=level * motions + k + 1,
                factor=factor,
                outcome=None if k >= motions - without else "overturned" if k < fallen else "rock",
                max_slip_m=0.0,
            )
            runs[key_of(run)] = run
            made[key_of(run).stem] = push(0.01)
    return annual_rates(request(folder, hazard, scatter), runs, made, [BODY], None, velocity)


def test_the_hazard_is_that_of_its_points_or_of_a_file(tmp_path):
    given = request(tmp_path).hazard_curve
    np.testing.assert_allclose(given.strengths, [1.6, 3.0])
    np.testing.assert_allclose(given.rates, [1 / 475, 1 / 2475])
    (tmp_path / "curve.csv").write_text("velocity_m_s,rate_per_year\n0.1,1e-2\n0.6,1e-4\n")
    read = request(tmp_path, 'file = "curve.csv"').hazard_curve
    assert (read.measure, read.rate(0.6)) == ("velocity_m_s", pytest.approx(1e-4))


def test_another_curve_under_the_same_name_of_its_file_is_another_verification(tmp_path):
    def asked(text):
        (tmp_path / "curve.csv").write_text(text)
        return site_hash(request(tmp_path, 'file = "curve.csv"'), [])

    curve = "velocity_m_s,rate_per_year\n0.1,1e-2\n0.6,1e-4\n"
    assert asked(curve) == asked(curve)
    changed = [curve.replace("0.6", "0.7"), curve.replace("1e-4", "2e-4")]
    assert len({asked(one) for one in (curve, *changed)}) == 3


@pytest.mark.parametrize(
    ("hazard", "words"),
    [
        ("points = [[475, 1.6]]", "two points"),
        ("points = [[475, 3.0], [2475, 1.6]]", "rise"),
        ("motions = 40", "exactly one of the two"),
        ('file = "none.csv"', "none.csv"),
        ('file = "../up.csv"', "folder"),
        ('file = "hall.toml"', "the first line must be"),
        (POINTS + "\nmotions = 3", "motions"),
    ],
)
def test_what_is_no_hazard_is_refused(tmp_path, hazard, words):
    with pytest.raises(CaseError, match=words):
        request(tmp_path, hazard)


def test_scatter_of_the_motions_spreads_the_hazard():
    """A lognormal fragility under the spread hazard: as one with both scatters under the hazard itself."""
    acting = scattered(CURVE, 0.4, [1.0, 8.0])
    assert acting.lognormal(3.0, 0.3) == pytest.approx(CURVE.lognormal(3.0, math.hypot(0.3, 0.4)), rel=1e-4)
    assert scattered(CURVE, 0.0, [1.0, 8.0]) is CURVE


def test_the_terminal_tells_the_rates(tmp_path):
    found = rates(tmp_path, {1.0: 0, 2.0: 30, 4.0: 100})
    result = example()[0]
    lines = [*page_of(replace(result, result=replace(result.result, hazard=found)), tmp_path)]
    fall, slide = (line for line in lines if line.startswith("  a year"))
    assert f"overturns {found.overturning_per_year:.2g} times (" in fall and "% in 50 years" in fall
    assert f"slides beyond the limit {found.slip_per_year:.2g} times (" in slide


def test_counts_of_a_fragility_give_its_rate_with_scatter(tmp_path):
    factors = np.geomspace(0.8, 6.0, 15)
    median, beta = 3.2, 0.3  # m/s2; the site's own motions are those of 1.6 m/s2
    counts = {float(f): round(400 * ndtr(math.log(1.6 * f / median) / beta)) for f in factors}
    found = rates(tmp_path, counts, motions=400)
    exact = CURVE.lognormal(median, 0.5)
    assert found.overturning_per_year == pytest.approx(exact, rel=0.03)
    assert found.fit_per_year == pytest.approx(exact, rel=0.02)
    assert (found.median, found.beta) == (pytest.approx(median, rel=0.01), pytest.approx(0.5, rel=0.02))
    # one power law: the closed form is the integral
    assert found.closed_form_per_year == pytest.approx(found.fit_per_year, rel=1e-9)
    assert found.interval[0] < exact < found.interval[1]
    assert found.in_50_years == pytest.approx(-math.expm1(-50.0 * found.overturning_per_year))
    assert found.most_from < 3.21 < found.most_to  # there phi/Phi = k beta


def test_without_scatter_the_counts_meet_the_hazard_itself(tmp_path):
    found = rates(tmp_path, {1.0: 0, 2.0: 30, 4.0: 100}, scatter=0.0)
    never = 1.6 * rocks_from(BODY, [push(0.01)])
    expected = counted_rate(
        CURVE, [1.6, 3.2, 6.4], [0, 30, 100], [100] * 3, never_below=min(never, 0.99 * 1.6)
    )
    assert found.overturning_per_year == pytest.approx(expected.rate)
    assert found.interval == pytest.approx((expected.low, expected.high))
    assert found.scatter == 0.0


def test_the_strength_of_a_curve_of_velocities_is_that_of_the_motions(tmp_path):
    (tmp_path / "curve.csv").write_text("velocity_m_s,rate_per_year\n0.1,1e-2\n0.6,1e-4\n")
    found = rates(tmp_path, {1.0: 0, 2.0: 50}, hazard='file = "curve.csv"', velocity=0.3)
    assert [level.strength for level in found.levels] == pytest.approx([0.3, 0.6])


def test_below_its_static_limits_a_body_does_not_move():
    limit = math.tan(BODY.slenderness_angle_rad)
    assert rocks_from(BODY, [push(1.0)]) == pytest.approx(0.9 * limit * 9.81, rel=1e-3)
    assert rocks_from(BODY, [push(1.0), push(2.0)]) == pytest.approx(0.45 * limit * 9.81, rel=1e-3)
    assert slides_from(BODY, 0.3, [push(3.0, second=4.0)]) == pytest.approx(0.9 * 0.3 * 9.81 / 5.0, rel=1e-3)
    lifted = slides_from(BODY, 0.3, [push(3.0, vertical=2.0)])
    assert lifted == pytest.approx(0.9 * 0.3 * 9.81 / (3.0 + 0.3 * 2.0), rel=1e-3)


def test_on_a_floor_that_gives_way_the_levels_begin_below_the_first_uplift():
    limit = math.tan(BODY.slenderness_angle_rad)
    soft = replace(BODY, gives_way=True)
    assert rocks_from(soft, [push(1.0)]) == pytest.approx(0.4 * limit * 9.81, rel=1e-3)
    runs = [replace(RUN, rotation_ratio=0.1)]
    first, weakest = (hazard_runs(groups_of(runs), [one], [push(1.0)], 40)[0].factor for one in (BODY, soft))
    assert weakest < 0.6 * limit * 9.81 < limit * 9.81 < first


def test_every_level_has_motions_of_its_own(tmp_path):
    runs = [replace(RUN, motion=k, rotation_ratio=0.1 * k, mu_static=0.3 + 0.05 * k) for k in (1, 2)]
    keys = hazard_runs(groups_of(runs), [BODY], [push(1.0)], 40)
    assert len({key.motion for key in keys}) == len(keys) == 7 * 40
    assert {key.mu_static for key in keys} == {0.4}  # that which rocks most
    levels = sorted({key.factor for key in keys})
    uplift = math.tan(BODY.slenderness_angle_rad) * 9.81
    assert hazard_motions(request(tmp_path)) == len(keys)
    assert (levels[0], levels[-1]) == pytest.approx((1.15 * uplift, 5.5 * uplift), rel=1e-3)
    assert sum(key.vertical_sign for key in keys) == 0  # half of them with the vertical reversed


@pytest.mark.parametrize("outcome", ["overturned", "invalid"])
def test_the_levels_are_run_for_the_group_that_falls(outcome):
    milder = [replace(RUN, motion=k, rotation_ratio=0.6) for k in (1, 2)]
    falls = [replace(RUN, mu_static=0.3, motion=1, outcome=outcome, rotation_ratio=None)]
    keys = hazard_runs(groups_of([*milder, *falls]), [BODY], [push(1.0)], 2)
    assert {key.mu_static for key in keys} == {0.3}


def test_where_nothing_rocks_the_levels_are_run_for_the_most_slender_body():
    runs = [
        replace(RUN, elevation=side, outcome="rest", rotation_ratio=0.0, mu_static=mu)
        for side, mu in (("width", 0.4), ("depth", 0.3), ("depth", 0.35))
    ]
    narrow = replace(BODY, elevation="depth", slenderness_angle_rad=0.5 * BODY.slenderness_angle_rad)
    keys = hazard_runs(groups_of(runs), [BODY, narrow], [push(1.0)], 2)
    assert {(key.elevation, key.mu_static) for key in keys} == {("depth", 0.35)}


def test_slip_beyond_the_limit_counts_in_the_plane_and_in_both_directions(tmp_path):
    run = replace(
        RUN, stage=HAZARD, factor=1.0, outcome="slide", max_slip_m=0.02, mu_static=0.3, mu_kinetic=0.3
    )
    runs = {
        key_of(one): one for one in (replace(run, motion=1), replace(run, motion=2), replace(run, motion=3))
    }
    runs[key_of(replace(run, motion=1))] = replace(run, motion=1, max_slip_m=0.2)
    stems = [key.stem for key in runs]
    made = dict(zip(stems, [push(0.1), push(2.0), push(6.0, second=6.0)], strict=True))
    found = annual_rates(request(tmp_path), runs, made, [BODY], None, 0.5)
    assert [(level.overturned, level.slipped, level.motions) for level in found.levels] == [(0, 2, 3)]
    assert found.overturning_per_year == 0.0 and found.slip_per_year > 0.0
    assert found.fit_per_year is None


def test_failed_runs_count_into_the_upper_ends_alone(tmp_path):
    counts = {1.0: 0, 2.0: 10, 4.0: 40}
    lacking = dict.fromkeys(counts, 0.2)
    known, found = (
        rates(tmp_path, counts, motions=one, failed=more) for one, more in ((40, {}), (50, lacking))
    )
    assert [(level.motions, level.failed) for level in found.levels] == [(40, 10)] * 3
    assert (found.overturning_per_year, found.interval[0]) == (known.overturning_per_year, known.interval[0])
    assert found.interval[1] > known.interval[1] and found.slip_interval[1] > known.slip_interval[1]
    assert (
        rates_in_words(found, 0.1)[-1].startswith("30 of these runs failed")
        and len(rates_in_words(known, 0.1)) == 2
    )
    # a level of which every run failed has no count, and may have fallen throughout
    gone = rates(tmp_path, counts, motions=40, failed={1.0: 1.0})
    assert gone.levels[0].motions == 0 and gone.interval[1] > known.interval[1]
    assert rates(tmp_path, counts, motions=40, failed=dict.fromkeys(counts, 1.0)) is None


def test_the_friction_of_the_set_that_slides_furthest_counts_for_slip_in_a_plane(tmp_path):
    """The levels are run with the friction that rocks most, under which this motion does not move the body."""
    level = replace(
        RUN, stage=HAZARD, factor=1.0, outcome="rest", max_slip_m=0.0, mu_static=0.9, mu_kinetic=0.9
    )
    slides = replace(RUN, mu_static=0.3, mu_kinetic=0.15, outcome="slide", max_slip_m=0.5)
    falls = replace(RUN, mu_static=0.6, mu_kinetic=0.6, outcome="overturned", max_slip_m=9.0)
    runs = {key_of(one): one for one in (level, slides, falls)}
    made = {key_of(level).stem: push(6.0)}
    found = annual_rates(request(tmp_path), runs, made, [BODY], None, 0.5)
    assert found.levels[0].slipped == 1 and found.slip_per_year > 0.0
    del runs[key_of(slides)]
    assert annual_rates(request(tmp_path), runs, made, [BODY], None, 0.5).levels[0].slipped == 0


def test_on_a_sloping_floor_the_rate_of_slip_is_not_known(tmp_path):
    run = replace(RUN, stage=HAZARD, factor=1.0, outcome="rock")
    asked = request(tmp_path).with_value("floor.slope_percent", 2.0)
    found = annual_rates(asked, {key_of(run): run}, {key_of(run).stem: push(6.0)}, [BODY], None, 0.5)
    assert found.slip_per_year is None and found.overturning_per_year == 0.0
    assert "not known on a sloping floor" in rates_in_words(found, 0.1)[0]


def test_the_page_says_what_was_counted_and_compares_no_target(tmp_path):
    found = rates(tmp_path, {1.0: 0, 1.5: 3, 2.0: 30, 3.0: 80, 4.0: 100})
    first, second = rates_in_words(found, 0.1)
    assert f"{found.overturning_per_year:.2g} per year" in first and "in 50 years" in first
    assert "spread by 0.4" in second and "none is compared" in second
    nothing = rates(tmp_path, {1.0: 0, 1.5: 0})
    assert "no lognormal curve fits the counts" in rates_in_words(nothing, 0.1)[1]


def test_the_rate_arises_level_by_level(tmp_path):
    counts = {1.0: 0, 1.5: 3, 2.0: 30, 3.0: 80, 4.0: 95}
    found = rates(tmp_path, counts, failed={1.5: 1.0})  # a level without counts takes no part
    assert [level.rate_per_year for level in found.levels] == pytest.approx(
        [CURVE.rate(1.6 * factor) for factor in counts]
    )
    assert found.levels[1].overturning_per_year == 0.0 and found.levels[1].interval == ()
    inner = [level.overturning_per_year for level in found.levels]
    assert sum(inner) + found.beyond_per_year == pytest.approx(found.overturning_per_year)
    low, high = found.levels[3].interval
    assert low < 0.8 < high
    result, _ = example()
    page = runs_section(SiteView(result=replace(result, result=replace(result.result, hazard=found))))
    table = html_of(Page(kind="", title="", name="", hash="", signature=None, sections=[page]))
    assert "80 of 100" in table and "71 to 87 %" in table and "0 of 0" in table
