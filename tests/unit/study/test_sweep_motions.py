"""A sweep over a set of motions, from its file to its folder."""

import csv
import json
import re

import pytest
from motion_files import write_pair

from fem.case.case import CaseError, load_case
from fem.report.study_page import sweep_report
from fem.study.file import load_sweep
from fem.study.motions import read_motion_set
from fem.study.sweep import asked_of, run_sweep
from fem.study.sweep_table import open_sweep

HEAD = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"solver.duration_s" = 1.5
"motion.quantity" = "acceleration"
"motion.unit" = "m/s2"
"vertical.quantity" = "acceleration"
"vertical.unit" = "m/s2"
[perturbation]
cells = "none"
[axes]
"""
PAIRS = '[["a_h.csv", "a_v.csv"], ["b_h.csv", "b_v.csv"]]'
SIGNS = "vertical.scale = [1.0, -1.0]\n"


@pytest.fixture
def sweep_of(tmp_path):
    for k, name in enumerate(("a", "b")):
        write_pair(tmp_path, name, frequency=1.0 + k)

    def read(axes):
        (tmp_path / "try.toml").write_text(HEAD + axes, encoding="utf-8")
        return load_sweep(tmp_path / "try.toml")

    return read


def test_a_cell_has_both_components_of_its_motion(sweep_of):
    sweep = sweep_of(f"motion.file = {PAIRS}\n{SIGNS}")
    assert sweep.shape == (2, 2)
    case = sweep.case(3)
    assert (case.motion.kind, case.motion.file) == ("table", "b_h.csv")
    assert (case.vertical.kind, case.vertical.file, case.vertical.scale) == ("table", "b_v.csv", -1.0)


def test_a_motion_alone_has_no_vertical_motion_and_no_sign_of_it(sweep_of):
    sweep = sweep_of('motion.file = ["a_h.csv", ["b_h.csv", "b_v.csv"]]\n')
    assert [sweep.case(cell).vertical.kind for cell in (0, 1)] == ["none", "table"]
    with pytest.raises(CaseError, match=r"'vertical.scale' varies, and 'a_h.csv' has no vertical motion"):
        sweep_of(f'motion.file = ["a_h.csv", ["b_h.csv", "b_v.csv"]]\n{SIGNS}')
    with pytest.raises(CaseError, match=r"'vertical.scale' varies, and 'a_h.csv' has no vertical motion"):
        sweep_of(f'motion.file = ["a_h.csv", "b_h.csv"]\n{SIGNS}')


def sweep_hash(sweep):
    return asked_of(sweep, read_motion_set(sweep.base, sweep.axes), 1).sweep_hash


def test_the_hash_follows_the_files(sweep_of, tmp_path):
    before = sweep_hash(sweep_of(f"motion.file = {PAIRS}\n"))
    assert before == sweep_hash(sweep_of(f"motion.file = {PAIRS}\n"))
    write_pair(tmp_path, "b", frequency=4.0)
    assert before != sweep_hash(sweep_of(f"motion.file = {PAIRS}\n"))


def test_the_peak_is_an_axis_of_records_too_and_ends_with_the_answer(sweep_of, tmp_path):
    sweep = sweep_of(
        f"{SIGNS}motion.file = {PAIRS}\nmotion.peak_acceleration_m_s2 = [2.0, 14.0, 30.0]\n"
        '[threshold]\naxis = "motion.peak_acceleration_m_s2"\nresolution = 0.2\n'
    )
    assert sweep.case(1).motion.scale_to_m_s2 == 14.0
    info = run_sweep(sweep, tmp_path / "out", jobs=1)
    assert info["status"] == "completed"
    table = open_sweep(tmp_path / "out")
    assert table["vertical.file"].tolist() == (["a_v.csv"] * 3 + ["b_v.csv"] * 3) * 2
    # The base case in the folder runs there, with the files of any row.
    base = load_case(tmp_path / "out" / "base.toml", ["motion.file=b_h.csv", "vertical.file=b_v.csv"])
    assert all(path.is_file() for path in base.data_files.values())
    told_cells = json.loads(
        re.search(r'id="sweep"[^>]*>(.*?)</script>', sweep_report(tmp_path / "out"), re.DOTALL)[1]
    )["derived"]
    assert told_cells[1] == {"key": "vertical.file", "values": table["vertical.file"].tolist()}
    assert info["answer"].startswith("peak acceleration: stood in every motion tried up to ")
    with (tmp_path / "out" / "answers.csv").open() as file:
        rows = list(csv.DictReader(file))
    # the signs of a motion count as one
    assert [row["motion.file"] for row in rows] == ["a_h.csv", "b_h.csv"]
    for row in rows:
        fell = [float(row["overturned_from"])] if row["overturned_from"] else []
        assert 2.0 <= float(row["stood_to"]) < min([*fell, 31.0])
