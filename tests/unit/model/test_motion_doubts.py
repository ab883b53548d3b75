"""Recorded motions that are read but doubtful, and such as cannot be meant: each has its own message."""

import numpy as np
import pytest
from cases import BLOCK

from fem.case.case import CaseError, read_case
from fem.model.motion import build_motion, motion_notes

KEYS = '"table"\nfile = "floor.csv"\nquantity = "{}"\nunit = "{}"\nbaseline = "{}"\n{}'
TIMES = np.arange(0.0, 2.0, 0.01)


def case_of(folder, values, *, times=TIMES, quantity="acceleration", unit="m/s2", baseline="none", extra=""):
    rows = "".join(f"{t!r},{v!r}\n" for t, v in zip(times.tolist(), values.tolist(), strict=True))
    (folder / "floor.csv").write_text(rows)
    keys = KEYS.format(quantity, unit, baseline, extra)
    text = BLOCK.replace('"none"\n', keys + "\n").replace("duration_s = 0.05", "duration_s = 1.0")
    (folder / "case.toml").write_text(text)
    return read_case(text, folder=folder)


def motion(folder, values, **options):
    return build_motion(case_of(folder, values, **options))


def test_a_mean_acceleration_that_drifts_is_reported_with_the_baselines(tmp_path):
    drifting = 2.0 * np.sin(2.0 * np.pi * TIMES) + 0.1
    (note,) = motion_notes(motion(tmp_path, drifting))
    assert "mean acceleration, 0.1 m/s2" in note and "with 0.2 m/s at the end" in note
    assert 'baseline = "mean"' in note and '"linear"' in note
    for baseline in ("mean", "linear"):
        found = motion(tmp_path, drifting, baseline=baseline, extra="allow_baseline = true\n")
        assert motion_notes(found) == []


def test_samples_too_far_apart_for_the_motion_are_reported(tmp_path):
    times = np.linspace(0.0, 4.0, 41)
    (note,) = motion_notes(motion(tmp_path, np.cos(2.0 * np.pi * 2.5 * times), times=times))
    assert "too coarse for this motion" in note and "0.1 s apart" in note
    assert motion_notes(motion(tmp_path, np.cos(2.0 * np.pi * 0.5 * times), times=times)) == []


def test_accelerations_that_cannot_be_meant_are_refused_with_the_guess(tmp_path):
    with pytest.raises(
        CaseError, match=r"reach 350 m/s2 with unit = 'm/s2'.* 3.5 m/s2 if the values were gal"
    ):
        motion(tmp_path, 350.0 * np.cos(2.0 * np.pi * TIMES))
    with pytest.raises(
        CaseError, match=r"reach 39.2\d m/s2 with unit = 'g'.* 4 m/s2 if the values were m/s2"
    ):
        motion(tmp_path, 4.0 * np.cos(2.0 * np.pi * TIMES), unit="g")
    with pytest.raises(CaseError, match=r"is the unit right|looks like"):
        motion(tmp_path, 50.0 * np.sin(2.0 * np.pi * TIMES), quantity="displacement", unit="m")
