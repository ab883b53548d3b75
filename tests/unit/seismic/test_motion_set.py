"""Sets of motions: checks, sets broken on purpose, records scaled or matched; files that read back to the same bits."""

from dataclasses import replace

import numpy as np
import pytest

from fem.records.files import read_record
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions, artificial_set
from fem.seismic.ground_motion import in_whole_g, sampled_at, write_at2, write_csv
from fem.seismic.matched import matched_records, scaled_records
from fem.seismic.motion_set import check_set, copy_correlation, largest_correlation

ACTION = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)


@pytest.fixture(scope="module")
def motions():
    return artificial_set(ACTION, count=3, seed=1)


@pytest.fixture(scope="module")
def checked(motions):
    return check_set(motions, ACTION)


def test_a_generated_set_is_valid(motions, checked):
    assert checked.valid and checked.reasons == ()
    assert checked.count == 3 and checked.stationary == 12.0
    assert checked.mean_peak == pytest.approx(np.mean([np.abs(m.horizontal).max() for m in motions]))
    assert checked.mean_peak >= checked.wanted_peak == pytest.approx(2.4)
    assert 0.9 <= checked.least_ratio <= 1.0
    mean = checked.horizontal.motions.mean(axis=0)
    place = int(np.argmin(np.abs(checked.periods - checked.least_ratio_period)))
    target = ACTION.horizontal(checked.periods[place : place + 1])[0]
    assert checked.least_ratio == pytest.approx(mean[place] / target)
    assert checked.vertical_least_ratio >= 0.9


def test_a_set_scaled_down_is_not_valid(motions):
    found = check_set([motion.scaled(0.8) for motion in motions], ACTION)
    assert not found.valid
    assert any("mean peak" in reason for reason in found.reasons)
    assert any("of the target at" in reason for reason in found.reasons)
    assert any("vertical" in reason for reason in found.reasons)


def test_one_motion_twice_is_not_valid(motions, checked):
    found = check_set([*motions, replace(motions[0], name="again")], ACTION)
    assert not found.valid
    assert found.largest_correlation == pytest.approx(1.0)
    assert checked.largest_correlation <= 0.3
    assert any("motion_01 and again are one motion" in reason for reason in found.reasons)


@pytest.mark.parametrize(
    "change",
    [lambda a: np.roll(a, 400), lambda a: a[::-1], lambda a: -1.3 * a],
    ids=["shifted", "reversed", "scaled"],
)
def test_a_copy_in_disguise_is_found(motions, change):
    copy = replace(motions[1], name="copy", horizontal=change(motions[1].horizontal).copy())
    assert copy_correlation(motions[1], copy) > 0.95
    assert copy_correlation(motions[0], copy) < 0.8
    assert any("one motion" in reason for reason in check_set([*motions, copy], ACTION).reasons)


def test_another_component_like_the_first_is_not_independent(motions):
    for name in ("vertical", "second"):
        same = [replace(motion, **{name: 0.5 * motion.horizontal}) for motion in motions]
        assert largest_correlation(same) == pytest.approx(1.0)


def test_recorded_verticals_are_shown_and_not_required(motions):
    recorded = [replace(motion, stationary=None, vertical=0.2 * motion.vertical) for motion in motions]
    found = check_set(recorded, ACTION)
    assert found.valid and found.stationary is None
    assert found.vertical_least_ratio < 0.3


def test_motions_with_and_without_vertical_do_not_mix(motions):
    found = check_set([replace(motions[0], vertical=None), *motions[1:]], ACTION)
    assert found.vertical is None
    assert any("some have none" in reason for reason in found.reasons)


@pytest.fixture(scope="module")
def records():
    """Three motions of another ground and type, sampled at 0.01 s: far from the target, as records are."""
    other = SiteAction(shape=eurocode_shape(2, "B"), reference_acceleration=1.0)
    return [
        replace(
            motion,
            name=f"record {k}",
            stationary=None,
            step=0.01,
            horizontal=sampled_at(0.01, 0.005, motion.horizontal),
            vertical=sampled_at(0.01, 0.005, motion.vertical),
        )
        for k, motion in enumerate(artificial_motions(other, count=3, seed=11))
    ]


def test_scaled_records_fulfil_the_code_and_no_more(records):
    scaled = scaled_records(records, ACTION)
    found = check_set(scaled, ACTION)
    assert found.valid
    excess = min(found.mean_peak / found.wanted_peak, found.least_ratio / 0.9)
    assert excess == pytest.approx(1.0, abs=1e-6)
    for record, motion in zip(records, scaled, strict=True):
        np.testing.assert_allclose(motion.horizontal, motion.factor * record.horizontal, rtol=1e-12)
        np.testing.assert_allclose(motion.vertical, motion.factor * record.vertical, rtol=1e-12)
    assert not check_set([motion.scaled(0.99) for motion in scaled], ACTION).valid


def test_matched_records_have_the_spectra_of_the_site(records):
    matched = matched_records(records, ACTION)
    found = check_set(matched, ACTION)
    assert found.valid
    band = (found.periods >= 0.05) & (found.periods <= 4.0)
    for spectra in (found.horizontal, found.vertical):
        ratios = spectra.motions[:, band] / spectra.target[band]
        assert np.sqrt(np.mean((ratios / ratios.mean() - 1.0) ** 2)) < 0.06
        mean = ratios.mean(axis=0)
        assert mean.min() > 0.9 and mean.max() < 1.15
    for record, motion in zip(records, matched, strict=True):
        assert motion.step == 0.005
        velocity, displacement = motion.ends
        assert velocity < 1e-10 and displacement < 1e-9
        # The time course stays that of the record: the envelope of its energy is not moved.
        energy = [np.cumsum(a**2) / np.sum(a**2) for a in (record.horizontal, motion.horizontal[::2])]
        length = min(map(len, energy))
        assert np.abs(energy[0][:length] - energy[1][:length]).max() < 0.15


GENERATOR = np.random.default_rng(7)
SPREAD = GENERATOR.standard_normal(4000) * 10.0 ** GENERATOR.integers(-9, 2, 4000)
VALUES = in_whole_g(np.append(SPREAD, 0.0))


@pytest.mark.parametrize("step", [0.005, 0.01, 1.0 / 3.0])
def test_csv_and_at2_read_back_to_the_same_bits(tmp_path, step):
    write_csv(tmp_path / "a.csv", step, VALUES)
    write_at2(tmp_path / "a.at2", step, VALUES, "ARTIFICIAL, , MOTION 1, H")
    for name in ("a.csv", "a.at2"):
        (component,) = read_record(tmp_path / name).components
        assert component.times.tobytes() == (np.arange(VALUES.size) * step).tobytes()
        assert component.values.tobytes() == VALUES.tobytes()
    heading = (tmp_path / "a.at2").read_text().splitlines()[2:4]
    assert heading == ["ACCELERATION TIME SERIES IN UNITS OF G", f"NPTS= 4001, DT= {step!r} SEC"]


def test_rounding_to_a_number_in_g_is_no_more_than_that():
    values = GENERATOR.standard_normal(100_000)
    rounded = in_whole_g(values)
    np.testing.assert_allclose(rounded, values, rtol=4e-16)
    assert in_whole_g(rounded).tobytes() == rounded.tobytes()


def test_what_has_no_number_in_g_is_refused(tmp_path):
    values = GENERATOR.standard_normal(1000)
    assert (in_whole_g(values) != values).any()
    with pytest.raises(ValueError, match=r"9\.80665"):
        write_at2(tmp_path / "a.at2", 0.01, values, "A, B, C, H")
