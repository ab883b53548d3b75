"""Every kind of floor motion is known wherever one is asked for; recorded ones that are doubtful or refused."""

import math
from typing import get_args

import numpy as np
import pytest
from cases import BLOCK, named_case

from fem.case.case import CaseError, read_case
from fem.case.strength import scaled_motion
from fem.case.tables.motion_tables import MotionTable, VerticalTable
from fem.model.motion import build_motion, build_motions, motion_notes, motion_result
from fem.model.motion_summary import summary_from_keys

KINDS = get_args(MotionTable.model_fields["kind"].annotation)
PEAK = 2.0
#: keys of a motion of each kind with this peak
KEYS = {
    "none": {},
    "harmonic": {"motion.peak_acceleration_m_s2": PEAK, "motion.frequency_Hz": 1.0},
    "pulse": {"motion.shape": "sine", "motion.peak_acceleration_m_s2": PEAK, "motion.pulse_s": 1.0},
    "table": {"motion.file": "record.txt", "motion.unit": "g", "motion.scale_to_m_s2": PEAK},
}


def test_the_vertical_motion_has_the_same_kinds():
    assert get_args(VerticalTable.model_fields["kind"].annotation) == KINDS == tuple(KEYS)


@pytest.fixture
def case_of(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "record.txt").write_text("".join(f"{0.01 * k} {math.sin(0.2 * k)}\n" for k in range(200)))
    return lambda kind: named_case("least", {"motion.kind": kind, **KEYS[kind]})


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_built_with_its_peak_span_and_words(case_of, kind):
    case, peak = case_of(kind), 0.0 if kind == "none" else PEAK
    motion = build_motion(case)
    assert case.motion.nominal_peak == peak == pytest.approx(motion.peak_acceleration)
    assert motion.peak_within(20.0) == pytest.approx(peak)
    assert motion.peak_within(0.1) <= motion.peak_within(20.0)
    begin, end = motion.span
    assert begin <= 0.0 < end and motion.time_scale > 0.0
    assert motion.evaluate(np.array([0.3, 0.6])).shape == (3, 2)
    found = motion_result(case, *build_motions(case))
    assert (found.kind, found.peak_in_run_m_s2) == (kind, pytest.approx(peak))
    doubled = case.with_values(scaled_motion(case, 2.0))
    assert build_motion(doubled).peak_acceleration == pytest.approx(2.0 * peak)


@pytest.mark.parametrize("kind", ["ramp"])
def test_another_kind_is_refused(kind):
    case = named_case("harmonic")
    other = case.motion.model_copy(update={"kind": kind})
    with pytest.raises(AssertionError, match=kind):
        _ = other.nominal_peak
    changed = case.model_copy(update={"motion": other})
    for ask in (build_motion, summary_from_keys, lambda case: scaled_motion(case, 2.0)):
        with pytest.raises(AssertionError, match=kind):
            ask(changed)


KEYS_OF_A_TABLE = '"table"\nfile = "floor.csv"\nquantity = "{}"\nunit = "{}"\nbaseline = "{}"\n{}'
TIMES = np.arange(0.0, 2.0, 0.01)


def recorded_in(
    folder, values, *, times=TIMES, quantity="acceleration", unit="m/s2", baseline="none", extra=""
):
    rows = "".join(f"{t!r},{v!r}\n" for t, v in zip(times.tolist(), values.tolist(), strict=True))
    (folder / "floor.csv").write_text(rows)
    keys = KEYS_OF_A_TABLE.format(quantity, unit, baseline, extra)
    text = BLOCK.replace('"none"\n', keys + "\n").replace("duration_s = 0.05", "duration_s = 1.0")
    return build_motion(read_case(text, folder=folder))


def test_a_mean_acceleration_that_drifts_is_reported_with_the_baselines(tmp_path):
    drifting = 2.0 * np.sin(2.0 * np.pi * TIMES) + 0.1
    (note,) = motion_notes(recorded_in(tmp_path, drifting))
    assert "mean acceleration, 0.1 m/s2" in note and "with 0.2 m/s at the end" in note
    assert 'baseline = "mean"' in note and '"linear"' in note
    for baseline in ("mean", "linear"):
        found = recorded_in(tmp_path, drifting, baseline=baseline, extra="allow_baseline = true\n")
        assert motion_notes(found) == []


def test_samples_too_far_apart_for_the_motion_are_reported(tmp_path):
    times = np.linspace(0.0, 4.0, 41)
    (note,) = motion_notes(recorded_in(tmp_path, np.cos(2.0 * np.pi * 2.5 * times), times=times))
    assert "too coarse for this motion" in note and "0.1 s apart" in note
    assert motion_notes(recorded_in(tmp_path, np.cos(2.0 * np.pi * 0.5 * times), times=times)) == []


def test_displacements_that_cannot_be_meant_are_refused_with_the_guess(tmp_path):
    with pytest.raises(CaseError, match=r"is the unit right|looks like"):
        recorded_in(tmp_path, 50.0 * np.sin(2.0 * np.pi * TIMES), quantity="displacement", unit="m")
