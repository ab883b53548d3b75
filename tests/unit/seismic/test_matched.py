"""Records scaled to a site, and matched to its spectra."""

from dataclasses import replace

import numpy as np
import pytest

from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions
from fem.seismic.ground_motion import sampled_at
from fem.seismic.matched import matched_records, scaled_records
from fem.seismic.motion_set import check_set

ACTION = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)


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
