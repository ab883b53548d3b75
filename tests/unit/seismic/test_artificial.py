"""Artificial motions: spectra within the target, ends at rest, the same bits for the same seed."""

import eqsig
import numpy as np
import pytest

from contact.motion.samples import sampled_motion
from fem.records.spectrum import response_spectrum
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import STEP_S, Shaper, artificial_motions, artificial_set, raised, rounded_off
from fem.seismic.motion_set import check_set, largest_correlation
from fem.seismic.oscillators import pseudo_accelerations

#: ground D, type 1, a_g S = 2.4 m/s2
ACTION = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)
PERIODS = np.geomspace(0.02, 4.0, 80)


@pytest.fixture(scope="module")
def motions():
    return artificial_set(ACTION, count=7, seed=1)


def spectra(components):
    return np.array([response_spectrum(STEP_S, one, PERIODS) for one in components])


def test_the_mean_horizontal_spectrum_matches_from_two_hundredths_to_four_seconds(motions):
    ratios = spectra([motion.horizontal for motion in motions]) / ACTION.horizontal(PERIODS)
    mean = ratios.mean(axis=0)
    assert mean.min() > 0.95 and mean.max() < 1.06
    assert np.sqrt(np.mean((ratios - 1.0) ** 2)) < 0.04
    peaks = np.array([motion.peak for motion in motions])
    assert 2.4 <= peaks.mean() < 1.1 * 2.4
    assert peaks.max() < 1.12 * 2.4  # one motion of plain iteration is 22 % above


def test_the_vertical_spectrum_is_matched_from_other_phases(motions):
    ratios = spectra([motion.vertical for motion in motions]) / ACTION.vertical(PERIODS)
    mean = ratios.mean(axis=0)
    assert mean.min() > 0.93 and mean.max() < 1.06
    peaks = [np.abs(motion.vertical).max() for motion in motions]
    assert 1.6 <= np.mean(peaks) < 1.1 * 1.6
    assert largest_correlation(motions) <= 0.3


def test_an_independent_oscillator_finds_the_same_spectra(motions):
    # eqsig takes peaks at the samples alone: the straight lines are sampled more densely for it.
    parts = 8
    for component in motions[0].components:
        count = component.size - 1
        dense = np.interp(np.arange(count * parts + 1) / parts, np.arange(count + 1), component)
        found = response_spectrum(STEP_S, component, PERIODS)
        other = eqsig.sdof.pseudo_response_spectra(dense, STEP_S / parts, PERIODS, 0.05)[2]
        np.testing.assert_allclose(other, found, rtol=0.01)


def test_the_floor_ends_at_rest_where_it_began(motions):
    for motion in motions:
        for component in motion.components:
            x, v, _ = sampled_motion(motion.times, component, "acceleration")
            assert abs(v[-1]) < 1e-12 * np.abs(v).max()
            assert abs(x[-1]) < 1e-11 * np.abs(x).max()
            assert component[0] == pytest.approx(0.0, abs=0.01)


def test_the_stationary_part_is_as_long_as_asked():
    short, long = (artificial_motions(ACTION, count=1, seed=3, stationary=s)[0] for s in (10.0, 20.0))
    assert short.duration == pytest.approx(18.0)
    assert long.duration == pytest.approx(28.0)
    longer = long.intensities["h"].significant_s - short.intensities["h"].significant_s
    assert longer == pytest.approx(10.0, abs=3.0)
    envelope = Shaper(stationary=10.0).envelope
    assert (envelope == 1.0).sum() * STEP_S >= 10.0


def test_the_same_seed_gives_the_same_bits(motions):
    again = artificial_set(ACTION, count=2, seed=1)
    for motion, other in zip(motions, again, strict=False):
        assert motion.horizontal.tobytes() == other.horizontal.tobytes()
        assert motion.vertical.tobytes() == other.vertical.tobytes()
    (fourth,) = artificial_motions(ACTION, count=1, seed=1, first=4, vertical=False)
    assert fourth.vertical is None
    assert fourth.horizontal.tobytes() == motions[3].horizontal.tobytes()
    (other,) = artificial_motions(ACTION, count=1, seed=2)
    assert other.horizontal.tobytes() != motions[0].horizontal.tobytes()


def test_rounding_off_leaves_small_values_and_keeps_the_sign():
    values = np.linspace(-3.0, 3.0, 601)
    found = rounded_off(values, 1.0)
    np.testing.assert_array_equal(found[np.abs(values) < 1.04], values[np.abs(values) < 1.04])
    assert np.abs(found).max() == pytest.approx(1.1)
    np.testing.assert_allclose(found, -found[::-1], rtol=1e-12, atol=1e-12)
    assert (np.diff(found) >= -1e-15).all()


def test_a_low_peak_is_raised_to_that_of_the_target():
    times = np.arange(401) * 0.005
    motion = 0.8 * np.sin(2.0 * np.pi * times) * np.exp(-times)
    found = raised(times, motion, 1.0)
    assert np.abs(found).max() == pytest.approx(1.0, rel=1e-12)
    far = np.abs(times - times[np.argmax(np.abs(motion))]) > 0.05
    np.testing.assert_allclose(found[far], motion[far], atol=1e-6)
    np.testing.assert_array_equal(raised(times, motion, 0.5), motion)


@pytest.mark.parametrize(("kind", "ground", "longest"), [(2, "A", 4.0), (1, "B", 8.0)])
def test_sets_of_three_fulfil_the_code_on_other_grounds_and_for_larger_bodies(kind, ground, longest):
    """Ground B at 8 s needs a factor on the set: 12 s of stationary motion hold two cycles of such periods."""
    action = SiteAction(shape=eurocode_shape(kind, ground), reference_acceleration=1.5)
    made = artificial_set(action, count=3, seed=3, longest=longest)
    assert check_set(made, action, longest=longest).valid
    assert all(1.0 <= motion.factor <= 1.05 for motion in made)


def test_the_compiled_oscillators_agree_with_the_exact_spectrum(motions):
    periods = np.geomspace(0.02, 4.0, 50)
    exact = response_spectrum(STEP_S, motions[0].horizontal, periods)
    found = pseudo_accelerations(STEP_S, motions[0].horizontal, periods)
    assert (found <= exact * (1.0 + 1e-9)).all()
    np.testing.assert_allclose(found, exact, rtol=0.02)
    # With two steps of oscillators: a step of acceleration, 1 + exp(-z pi / sqrt(1 - z^2)) at every period.
    step = pseudo_accelerations(0.005, np.ones(4001), np.geomspace(0.1, 5.0, 12))
    np.testing.assert_allclose(step, 1.854468, rtol=0.02)
