"""The strength of the floor's motion: the peak as a key of records, and both components scaled as one."""

import pytest
from motion_files import write_pair

from fem.case.case import CaseError, load_case
from fem.case.strength import scaled_motion
from fem.model.motion import build_motion
from fem.study.design import CaseMaker
from fem.study.file import require_once

PEAK, TO = "motion.peak_acceleration_m_s2", "motion.scale_to_m_s2"
HARMONIC = {"motion.kind": "harmonic", "vertical.kind": "harmonic", "vertical.frequency_Hz": 2.0}


@pytest.fixture
def record(tmp_path):
    """A case with a pair of records, of 3 and 2 m/s2, over the harmonic motion of a shipped case."""
    horizontal, vertical = write_pair(tmp_path, "a", frequency=2.0)
    (tmp_path / "case.toml").write_text(load_case("seed_stack_plateau").text, encoding="utf-8")
    pair = {"motion.kind": "table", "motion.file": horizontal, "motion.unit": "m/s2"}
    pair |= {"vertical.kind": "table", "vertical.file": vertical, "vertical.unit": "m/s2"}
    return load_case(tmp_path / "case.toml").with_values(pair)


def peaks(case):
    return build_motion(case).peak_acceleration, build_motion(case, "vertical").peak_acceleration


@pytest.mark.parametrize(
    "make", [lambda case, values: case.with_values(values), lambda case, v: CaseMaker(case)(v)]
)
def test_the_peak_of_a_record_is_what_it_is_scaled_to_and_the_pair_keeps_its_ratio(record, make):
    assert peaks(record) == pytest.approx((3.0, 2.0))  # the peak of the harmonic motion is no key of a record
    scaled = make(record, {PEAK: 4.5})
    assert scaled.motion.scale_to_m_s2 == 4.5
    assert scaled.motion.nominal_peak == 4.5
    assert peaks(scaled) == pytest.approx((4.5, 3.0))
    assert scaled.overrides[-1] == f"{PEAK}=4.5"  # as it was asked for
    assert peaks(make(record, {PEAK: 4.5, "vertical.scale": -0.5})) == pytest.approx((4.5, 1.5))
    both = make(record, {PEAK: 4.5, "vertical.peak_acceleration_m_s2": 1.0})
    assert peaks(both) == pytest.approx((4.5, 1.0))


def test_it_replaces_a_factor_and_is_replaced_by_one(record):
    scaled = record.with_values({"motion.scale": 2.0}).with_values({PEAK: 4.5})
    assert scaled.motion.scale == 1.0
    assert scaled.with_values({"motion.scale": 0.5}).motion.scale_to_m_s2 is None
    with pytest.raises(CaseError, match=r"\[motion\] scale_to_m_s2 and scale are alternatives"):
        record.with_values({PEAK: 4.5, "motion.scale": 2.0})


@pytest.mark.parametrize(
    ("changes", "values", "reason"),
    [
        ({TO: 3.0}, [PEAK], rf"\[set\] '{PEAK}' varies as well"),
        ({}, [TO, PEAK], f"'{PEAK}' of a record is its '{TO}', which varies as"),
    ],
)
def test_two_names_of_one_key_do_not_vary_at_once(record, changes, values, reason):
    with pytest.raises(CaseError, match=reason):
        require_once(changes, values, record)


@pytest.mark.parametrize(
    ("values", "doubled"),
    [
        ({}, {"motion.scale": 2.0, "vertical.scale": 2.0}),
        ({PEAK: 4.0}, {TO: 8.0}),
        ({PEAK: 4.0, "vertical.scale_to_m_s2": 1.0}, {TO: 8.0, "vertical.scale_to_m_s2": 2.0}),
        ({"vertical.kind": "none"}, {"motion.scale": 2.0}),
        ({"motion.kind": "none", "vertical.kind": "none"}, {}),
        (HARMONIC | {"vertical.amplitude_m": 0.01}, {PEAK: 8.0, "vertical.amplitude_m": 0.02}),
    ],
)
def test_a_stronger_motion_is_stronger_in_both_components(record, values, doubled):
    case = record.with_values(values)
    assert scaled_motion(case, 2.0) == doubled
    twice = case.with_values(doubled)
    assert peaks(twice) == pytest.approx([2.0 * peak for peak in peaks(case)])
