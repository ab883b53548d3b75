"""Sets of motions: how they are written, what is refused, and what is told of each."""

import numpy as np
import pytest
from motion_files import write_motion, write_pair

from fem.case.case import CaseError, read_case
from fem.model.motion import build_motion
from fem.records.intensity import intensity
from fem.records.spectrum import response_spectrum
from fem.study.axes import read_axis
from fem.study.motions import read_motion_set, spectra_of

CASE = """
[container]
width_m = 1.1
height_m = 4.0
weight_N = 98100.0
[contact]
mu_static = 0.4
[motion]
kind = "table"
file = "a_h.csv"
quantity = "acceleration"
unit = "m/s2"
[vertical]
quantity = "acceleration"
unit = "m/s2"
[solver]
model = "rigid"
"""


@pytest.fixture
def base(tmp_path):
    for k, name in enumerate(("a", "b", "c")):
        write_pair(tmp_path, name, frequency=2.0 + k)
    return read_case(CASE, folder=tmp_path)


def test_the_motions_are_read_as_the_case_takes_them(base):
    axis = read_axis("motion.file", [["a_h.csv", "a_v.csv"], ["b_h.csv", "b_v.csv"]])
    scaled = base.with_values({"motion.scale": 2.0, "vertical.scale": -1.0})
    found = read_motion_set(scaled, [axis])
    assert [one.name for one in found] == ["a_h.csv", "b_h.csv"]
    numbers = found[1].numbers()
    assert numbers["peak_acceleration_m_s2"] == pytest.approx(6.0)
    assert numbers["vertical"]["peak_acceleration_m_s2"] == pytest.approx(2.0)
    assert (numbers["duration_s"], numbers["step_s"], numbers["samples"]) == (1.0, pytest.approx(0.02), 51)
    motion = build_motion(found[1].case)
    assert numbers["significant_s"] == intensity(motion.times, motion.values).significant_s


def test_spectra_are_those_of_each_motion(base):
    axis = read_axis("motion.file", [["a_h.csv", "a_v.csv"], "b_h.csv"])
    motions = read_motion_set(base, [axis])
    periods, spectra = spectra_of(motions)
    assert list(spectra) == ["a_h.csv", "a_v.csv", "b_h.csv"]
    assert periods[0] == pytest.approx(0.04)  # two steps of 0.02 s
    alone = response_spectrum(0.02, build_motion(motions[1].case).values, periods)
    assert spectra["b_h.csv"] == pytest.approx(alone.pseudo_acceleration_m_s2)


def test_motions_that_are_one_are_refused(base, tmp_path):
    # of a_h.csv: half as strong, of the other sign
    write_motion(tmp_path, "copy.csv", frequency=2.0, peak=-1.5)
    with pytest.raises(CaseError, match=r"'copy.csv' and 'a_h.csv' hold the same motion"):
        read_motion_set(base, [read_axis("motion.file", ["a_h.csv", "b_h.csv", "copy.csv"])])
    with pytest.raises(CaseError, match=r"a_h.csv: the file has one motion"):
        read_motion_set(base, [read_axis("motion.file", [["a_h.csv", "a_h.csv"]])])


def test_two_motions_of_one_file_are_refused(base, tmp_path):
    columns = [np.loadtxt(tmp_path / f"{name}_h.csv", delimiter=",", skiprows=1).T for name in ("a", "b")]
    rows = np.column_stack([columns[0][0], columns[0][1], columns[1][1]])
    np.savetxt(tmp_path / "both.csv", rows, delimiter=",")
    (pair,) = read_motion_set(base, [read_axis("motion.file", [["both.csv#1", "both.csv#2"]])])
    assert len(pair.measures) == 2
    with pytest.raises(CaseError, match=r"'both.csv#1' and 'both.csv#2' are motions of one file, both.csv"):
        read_motion_set(base, [read_axis("motion.file", ["both.csv#1", "both.csv#2"])])
    with pytest.raises(CaseError, match=r"'a_h.csv' and './a_h.csv' are motions of one file"):
        read_motion_set(base, [read_axis("motion.file", ["a_h.csv", "./a_h.csv"])])
