"""Slip under both horizontal components: from the motions of a site to its answer."""

from dataclasses import replace

import pytest
from site_example import RUN, example

from fem.seismic.two_directions import largest_slip, largest_slips
from fem.site.answer import answer_of
from fem.site.request import load_site
from fem.site.rule import groups_of
from fem.site.stages import REPETITIONS, Stages
from fem.study.driver import runner_of

SITE = """
container = "seed_stack"
[site]
ground = "D"
reference_acceleration_m_s2 = 2.8
[friction]
mu_static = [0.2, 0.4]
[limits]
slip_m = {limit}
[motions]
count = 3
{motions}
{building}"""


def slid(folder, **asked):
    """What stages find, and the motions of the floors."""
    stages = stages_of(folder, **asked)
    return stages.beside()["two_directions"], stages.floors


def stages_of(folder, *, limit=0.2, motions="", building=""):
    place = folder / "hall.toml"
    place.write_text(SITE.format(limit=limit, motions=motions, building=building))
    return Stages.of(load_site(place), folder)


def test_the_largest_slip_of_the_set_is_found_with_its_friction_and_motion(tmp_path):
    found, floors = slid(tmp_path, limit=0.01)
    pairs = [(0.2, 0.1), (0.2, 0.2), (0.4, 0.2), (0.4, 0.4), (0.3, 0.225)]
    slips = largest_slips(floors[None], pairs)
    assert found.slip_largest_m == max(slid.max() for slid in slips.values()) > 0.1
    assert found.slip_mean_m == max(slid.mean() for slid in slips.values())
    assert found.motion == 1 + slips[0.2, 0.1].argmax()
    assert (found.mu_static, found.mu_kinetic) == (0.2, 0.1)
    assert found.slip_mean_in_plane_m < 0.8 * found.slip_mean_m
    assert found.margin_factor == 1.0  # beyond 10 mm


def test_the_slips_of_the_repetitions_are_those_of_the_set_times_their_factors(tmp_path):
    found, floors = slid(tmp_path)
    motion, pair = floors[None][found.motion - 1], (found.mu_static, found.mu_kinetic)
    low, high = found.slip_range_m
    assert low < found.slip_largest_m < high < 1.01 * low
    assert high == max(largest_slip(motion.scaled(factor), pair) for factor in REPETITIONS)


def test_further_motions_have_a_second_component_and_their_own_slips(tmp_path):
    stages = stages_of(tmp_path, motions="further = 2")
    run = replace(RUN, mass="full", rotation_ratio=0.0, max_slip_m=0.0, outcome="rest")
    own = [replace(run, **vars(key)) for key in stages.of_set()]
    keys = stages.of_further(groups_of(own)[:1], 2)
    with runner_of(jobs=1) as runner:
        stages._make(runner, keys)
    stages.runs.update({key: replace(run, **vars(key)) for key in keys})
    slips = stages.beside()["slips_of_further"]
    first = keys[0]
    pair = first.mu_static, first.mu_kinetic
    motions = [stages.motions[stem] for stem in sorted({key.stem for key in keys})]
    assert slips == {
        (number, None, *pair): largest_slip(motion, pair) for number, motion in enumerate(motions, start=1)
    }
    alone = [largest_slip(replace(motion, second=None), pair) for motion in motions]
    assert all(both > 1.1 * plane for both, plane in zip(slips.values(), alone, strict=True))


def test_of_the_periods_of_a_building_the_worst_counts(tmp_path):
    building, pair = "[building]\nz_over_h = 1.0\nbuilding_period_s = 0.5\nstoreys = 5", (0.2, 0.1)
    found, floors = slid(tmp_path, building=building)
    slips = {period: largest_slips(motions, [pair])[pair].max() for period, motions in floors.items()}
    assert found.building_period_s == max(slips, key=slips.get)
    assert found.slip_largest_m == max(slips.values())


@pytest.mark.parametrize(
    ("motions", "changed", "words"),
    [
        ("", {"floor.slope_percent": 2.0}, "is not computed on a sloping floor"),
        ("second_component = 0.0", {"motions.second_component": 1.0}, "have no second horizontal component"),
        ("second_component = 0.0", {"floor.slope_percent": 2.0}, ""),
    ],
)
def test_slip_in_two_directions_that_is_not_known_is_not_sure(tmp_path, motions, changed, words):
    """Unless `second_component` = 0 asks for motion in a plane."""
    stages = stages_of(tmp_path, limit=5.0, motions=motions)
    for key, value in changed.items():
        stages = replace(stages, request=stages.request.with_value(key, value))
    run = replace(RUN, mass="full", rotation_ratio=0.0, max_slip_m=0.0, outcome="rest")
    runs = {key: replace(run, **vars(key)) for key in stages.of_set()}  # all stand, nothing else is asked for
    found = answer_of(stages.request, example()[0].set, runs, **stages.beside())
    told = [reason for reason in found.reasons if "horizontal component" in reason]
    assert len(told) == bool(words) and all(words in reason for reason in told)
    assert found.answer == ("not sure" if words else "fulfilled")
