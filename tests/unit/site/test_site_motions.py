"""The motions of a site: second horizontal components, and floors of buildings with storeys."""

import json

import numpy as np
import pytest
from small_site import LEAST, three_motions, three_records

from fem.case.validation import CaseError
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions
from fem.seismic.floor import floor_motion, storey_modes
from fem.seismic.ground_motion import in_whole_g, write_at2
from fem.seismic.motion_set import check_set
from fem.site.motions import floor_motions, ground_motions, motion_target
from fem.site.request import load_site
from fem.site.run import site_hash


def request(folder, *tables):
    place = folder / "hall.toml"
    place.write_text(LEAST + "\n".join(tables))
    return load_site(place)


#: of the least site
ACTION = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=1.6)


def test_artificial_motions_have_a_second_component_of_the_share_asked_for(tmp_path):
    both, half, none = (
        ground_motions(request(tmp_path, f"[motions]\ncount = 3\nsecond_component = {share}"), 4.0)
        for share in (1.0, 0.5, 0.0)
    )
    action = request(tmp_path).action
    assert check_set(both, action).valid and check_set(half, action, second=0.5).valid
    assert any("second components" in reason for reason in check_set(half, action).reasons)
    np.testing.assert_allclose(half[0].second, 0.5 * both[0].second, rtol=1e-12, atol=1e-12)
    assert none[0].second is None
    np.testing.assert_array_equal(none[0].horizontal, both[0].horizontal)


def test_a_third_file_of_a_record_is_its_second_component(tmp_path):
    names = three_records(tmp_path, ACTION, "hvt")
    asked = request(tmp_path, f'[motions]\nsource = "records"\nfiles = {names}')
    own = three_motions(asked.action)
    for recorded, motion in zip(ground_motions(asked, 4.0), own, strict=True):
        factor = recorded.factor  # one for all components
        np.testing.assert_allclose(recorded.second, 0.5 * factor * motion.second, rtol=1e-9, atol=1e-9)
        expected = 0.5 * factor * motion.horizontal
        np.testing.assert_allclose(recorded.horizontal, expected, rtol=1e-9, atol=1e-9)


def test_records_of_a_coarse_step_are_read_between_their_samples(tmp_path):
    # 0.02 s apart: the check of a set begins at a period of 0.02 s
    names = three_records(tmp_path, ACTION, "h", every=4)
    asked = request(tmp_path, f'[motions]\nsource = "floor"\nvertical = false\nfiles = {names}')
    motion, curve = ground_motions(asked, 4.0)[0], three_motions(ACTION)[0].horizontal[::4]
    assert motion.step == 0.01
    np.testing.assert_allclose(motion.horizontal[::2], 0.5 * curve, atol=1e-9)
    np.testing.assert_allclose(motion.horizontal[1::2], 0.25 * (curve[1:] + curve[:-1]), atol=1e-9)


def test_matched_records_have_their_second_component_matched_to_its_share(tmp_path):
    names = three_records(tmp_path, ACTION, "hvt")
    asked = request(tmp_path, f'[motions]\nsource = "matched"\nsecond_component = 0.7\nfiles = {names}')
    found = check_set(ground_motions(asked, 4.0), asked.action, second=0.7)
    assert found.valid and found.second_least_ratio > 0.9


def with_a_fling(folder, seconds):
    """The same motions without their vertical components; the first ends elsewhere, by a sine pulse of 0.8 s."""
    names = [names[:1] for names in json.loads(three_records(folder, ACTION, "h"))]
    times = 0.005 * np.arange(round(seconds / 0.005))
    pulse = np.where(times < 0.8, 3.4 * np.sin(2.0 * np.pi * times / 0.8), 0.0)
    write_at2(folder / names[0][0], 0.005, in_whole_g(pulse), "EVENT 0, 1/1/20, STATION 0, 090")
    return f'[motions]\nsource = "matched"\nvertical = false\nfiles = {json.dumps(names)}'


def test_a_baseline_that_takes_a_fifth_of_a_matched_record_must_be_allowed(tmp_path):
    motions = with_a_fling(tmp_path, 5.0)
    words = r"0\.866 m/s .* \(-59 %\).*take another record, or set allow_baseline = true$"
    with pytest.raises(CaseError, match=words):
        ground_motions(request(tmp_path, motions), 4.0)
    site = str(tmp_path / "hall.toml")
    asked = load_site(site, allow_baseline=True)
    assert "allow_baseline = true" in asked.origin.text  # which the results keep
    assert "(-59 %)" in ground_motions(asked, 4.0)[0].notes[0]
    request(tmp_path)
    with pytest.raises(CaseError, match="allow_baseline"):
        load_site(site, allow_baseline=True)


def test_a_building_of_storeys_moves_with_all_its_modes(tmp_path):
    building = "[building]\nz_over_h = 0.6\nbuilding_period_s = 1.0\nstoreys = 10\nkind = 'cantilever'"
    asked = request(tmp_path, "[motions]\ncount = 3\nvertical = false", building)
    ground = ground_motions(asked, 4.0)[:1]
    floors = floor_motions(asked, ground)
    assert sorted(floors) == [0.85, 1.0, 1.15]
    for period, (floor,) in floors.items():
        modes = storey_modes(storeys=10, kind="cantilever", height_ratio=0.6, period=period)
        np.testing.assert_array_equal(floor.horizontal, floor_motion(ground[0], modes).horizontal)
        assert floor.second is not None and not np.array_equal(floor.second, floor.horizontal)


SPECTRUM = """[floor_spectrum]
period_s = [0.03, 0.2, 0.5, 4.0]
acceleration_m_s2 = [3.0, 9.0, 9.0, 0.3]
"""


def test_the_motions_of_a_site_fit_the_given_spectrum_of_the_floor_and_no_building_filters_them(tmp_path):
    asked = request(tmp_path, SPECTRUM, "[motions]\ncount = 3")
    ground = ground_motions(asked, 4.0)
    target = motion_target(asked, ground, 4.0)
    assert target.surface_acceleration == 3.0
    assert check_set(ground, target).valid and not check_set(ground, asked.action).valid
    assert floor_motions(asked, ground) == {None: ground}
    points = "period_s,acceleration_m_s2\n0.03,3.0\n0.2,9.0\n0.5,9.0\n4.0,0.3\n"
    (tmp_path / "floor.csv").write_text(points)
    assert request(tmp_path, '[floor_spectrum]\nfile = "floor.csv"').floor_target == target


def test_records_of_a_floor_are_taken_as_they_are_and_further_motions_fit_their_mean(tmp_path):
    names = three_records(tmp_path, ACTION)
    asked = request(tmp_path, f'[motions]\nsource = "floor"\nfiles = {names}\nsecond_component = 0.0')
    ground = ground_motions(asked, 4.0)
    (first, *_) = three_motions(asked.action)
    np.testing.assert_allclose(ground[0].horizontal, 0.5 * first.horizontal, rtol=1e-12)
    assert all(motion.factor == 1.0 for motion in ground)
    target = motion_target(asked, ground, 4.0)
    found = check_set(ground, target)
    assert found.valid
    np.testing.assert_allclose(found.horizontal.mean, found.horizontal.target, rtol=1e-9)
    again = artificial_motions(target, count=1, seed=1)[0]
    assert again.peak == pytest.approx(np.mean([one.peak for one in ground]), rel=0.1)


def test_what_is_kept_of_a_verification_goes_with_the_points_of_the_floor(tmp_path):
    """Also where they change none of the motions: of scaled records their vertical has a target of its own."""
    points = "period_s,acceleration_m_s2,vertical_acceleration_m_s2\n0.03,3,2\n4,0.5,0.3\n"
    (tmp_path / "floor.csv").write_text(points)
    asked = request(tmp_path, '[floor_spectrum]\nfile = "floor.csv"')
    first = site_hash(asked, [])
    for old, new in (("0.03", "0.04"), ("3,2", "3.1,2"), ("3,2", "3,2.1")):
        (tmp_path / "floor.csv").write_text(points.replace(old, new))
        assert site_hash(load_site(tmp_path / "hall.toml"), []) != first
