"""Recorded motions that are read but doubtful, and such as cannot be meant: each has its own message."""

import json

import numpy as np
import pytest

from fem.__main__ import main
from fem.case.case import CaseError, read_case
from fem.model.motion import build_motion, motion_notes

CASE = """
[container]
width_m = 1.1
height_m = 4.0
density_kg_m3 = 2000.0
[contact]
mu_static = 0.4
[motion]
kind = "table"
file = "floor.csv"
quantity = "{quantity}"
unit = "{unit}"
baseline = "{baseline}"
[solver]
model = "rigid"
duration_s = 1.0
element_size_m = 2.0
[output]
fields_s = 0.0
"""
TIMES = np.arange(0.0, 2.0, 0.01)


def motion(folder, values, *, times=TIMES, quantity="acceleration", unit="m/s2", baseline="none"):
    rows = "".join(f"{t!r},{v!r}\n" for t, v in zip(times.tolist(), values.tolist(), strict=True))
    (folder / "floor.csv").write_text(rows)
    text = CASE.format(quantity=quantity, unit=unit, baseline=baseline)
    (folder / "case.toml").write_text(text)
    return build_motion(read_case(text, folder=folder))


def test_a_mean_acceleration_that_drifts_is_reported_with_the_baselines(tmp_path):
    drifting = 2.0 * np.sin(2.0 * np.pi * TIMES) + 0.1
    (note,) = motion_notes(motion(tmp_path, drifting))
    assert "mean acceleration, 0.1 m/s2" in note and "with 0.2 m/s at the end" in note
    assert 'baseline = "mean"' in note and '"linear"' in note
    for baseline in ("mean", "linear"):
        assert motion_notes(motion(tmp_path, drifting, baseline=baseline)) == []


def test_samples_too_far_apart_for_the_motion_are_reported(tmp_path):
    times = np.linspace(0.0, 4.0, 41)
    (note,) = motion_notes(motion(tmp_path, np.cos(2.0 * np.pi * 2.5 * times), times=times))
    assert "too coarse for this motion" in note and "0.1 s apart" in note
    assert motion_notes(motion(tmp_path, np.cos(2.0 * np.pi * 0.5 * times), times=times)) == []


def test_accelerations_that_cannot_be_meant_are_refused_with_the_guess(tmp_path):
    with pytest.raises(CaseError, match=r"reach 350 m/s2, at most 100 m/s2 are accepted; looks like gal"):
        motion(tmp_path, 350.0 * np.cos(2.0 * np.pi * TIMES))
    with pytest.raises(CaseError, match=r"is its unit right|looks like"):
        motion(tmp_path, 50.0 * np.sin(2.0 * np.pi * TIMES), quantity="displacement", unit="m")


def test_run_and_check_tell_of_a_drift(tmp_path, capsys):
    motion(tmp_path, np.full(TIMES.size, 0.1))
    assert main(["check", str(tmp_path / "case.toml"), "--json"]) == 0
    assert any("it drifts" in note for note in json.loads(capsys.readouterr().out)["notes"])
    out = tmp_path / "out"
    assert main(["run", str(tmp_path / "case.toml"), "--out", str(out), "-q"]) == 0
    assert any("it drifts" in warning for warning in json.loads((out / "run.json").read_text())["warnings"])
