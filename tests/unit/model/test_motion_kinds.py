"""Every kind of floor motion is known wherever one is asked for."""

import math
from typing import get_args

import numpy as np
import pytest
from cases import BLOCK, named_case

from fem.case.case import CaseError, read_case
from fem.case.strength import scaled_motion
from fem.case.tables.motion_tables import MotionTable, VerticalTable
from fem.model.motion import build_motion, build_motions, motion_result

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


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_built_with_its_peak_span_and_words(tmp_path, monkeypatch, kind):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "record.txt").write_text("".join(f"{0.01 * k} {math.sin(0.2 * k)}\n" for k in range(200)))
    case, peak = named_case("least", {"motion.kind": kind, **KEYS[kind]}), 0.0 if kind == "none" else PEAK
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


def test_displacements_that_cannot_be_meant_are_refused_with_the_guess(tmp_path):
    times = np.arange(0.0, 2.0, 0.01)
    rows = np.column_stack([times, 50.0 * np.sin(2.0 * np.pi * times)])
    np.savetxt(tmp_path / "floor.csv", rows, delimiter=",")
    keys = '"table"\nfile = "floor.csv"\nquantity = "displacement"\nunit = "m"\n'
    case = read_case(BLOCK.replace('"none"\n', keys), folder=tmp_path)
    with pytest.raises(CaseError, match=r"is the unit right|looks like"):
        build_motion(case)
