"""A sweep over a set of motions, from its file to its folder."""

import csv
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from motion_files import write_pair

from fem.case.case import CaseError, load_case
from fem.cli.sweep import page_of
from fem.report.study_page import sweep_report
from fem.study.file import load_sweep
from fem.study.sweep import run_sweep, sweep_hash
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


def test_the_hash_follows_the_files(sweep_of, tmp_path):
    before = sweep_hash(sweep_of(f"motion.file = {PAIRS}\n"))
    assert before == sweep_hash(sweep_of(f"motion.file = {PAIRS}\n"))
    write_pair(tmp_path, "b", frequency=4.0)
    assert before != sweep_hash(sweep_of(f"motion.file = {PAIRS}\n"))


def test_what_a_sweep_tells_of_its_motions(sweep_of, tmp_path):
    folder = tmp_path / "results"
    strengths = "motion.scale = [0.7, 3.0]\n"
    sweep = sweep_of(f"{strengths}motion.file = {PAIRS}\n{SIGNS}")
    info = run_sweep(sweep, folder, jobs=1)
    assert info["status"] == "completed"
    table = open_sweep(folder)
    assert table.axes[1].following == {
        "vertical.kind": ("table",) * 2,
        "vertical.file": ("a_v.csv", "b_v.csv"),
    }
    assert (
        table["vertical.file"].tolist()
        == ["a_v.csv"] * 2 + ["b_v.csv"] * 2 + ["a_v.csv"] * 2 + ["b_v.csv"] * 2
    )
    told = json.loads((folder / "sweep.json").read_text(encoding="utf-8"))
    assert [one["file"] for one in told["motions"]] == ["a_h.csv", "b_h.csv"]
    assert [one["motion.scale"] for one in told["motion_set"]] == [0.7, 3.0]
    weak = told["motion_set"][0]
    ratios = table.grid("rotation_ratio")[0].max(axis=1)  # the worse sign of each motion
    assert weak["worst_rotation_ratio"] == ratios.max()
    assert weak["mean_rotation_ratio"] == pytest.approx(ratios.mean())
    assert weak["motions"] == 2
    with (folder / "motion_set.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["high"]) for row in rows] == [one["high"] for one in told["motion_set"]]
    spectra = np.loadtxt(folder / "spectra.csv", delimiter=",", skiprows=1)
    assert spectra.shape == (100, 5)
    for name in told["motion_figures"]:
        assert (folder / name).read_text(encoding="utf-8").startswith("<?xml")
    assert told["motion_figures"] == ["figures/spectra.svg", "figures/overturned.svg"]
    # The base case in the folder runs there, with the files of any row.
    base = load_case(folder / "base.toml", ["motion.file=b_h.csv", "vertical.file=b_v.csv"])
    assert all(path.is_file() for path in base.data_files.values())
    assert "holds this sweep already" in _again(sweep, folder)
    page = sweep_report(folder)
    assert re.search(r'aria-label="outcome of each motion".*?a_h\.csv.*?b_h\.csv', page, re.DOTALL)
    assert "b_v.csv (vertical)" in page
    assert 'aria-label="spectra"' in page and 'aria-label="overturned"' in page
    told_cells = json.loads(re.search(r'id="sweep"[^>]*>(.*?)</script>', page, re.DOTALL)[1])["derived"]
    assert told_cells[1] == {"key": "vertical.file", "values": table["vertical.file"].tolist()}
    assert "of 2 motions overturn" in "\n".join(page_of(table.info, folder))


def test_signs_are_no_strength_and_a_short_run_is_told(sweep_of, tmp_path):
    sweep = sweep_of('motion.scale = [-1.0, 1.0]\nmotion.file = ["a_h.csv", "b_h.csv"]\n')
    short = replace(sweep, base=sweep.base.with_values({"solver.duration_s": 0.5}))
    info = run_sweep(short, tmp_path / "results", jobs=1)
    assert [row["motions"] for row in info["motion_set"]] == [2]
    assert info["motion_figures"] == ("figures/spectra.svg",)
    assert info["motion_covered"].startswith("the first 0.5 of 1 s")
    assert info["motion_covered"].endswith("(a_h.csv, and 1 more motions are cut)")


def _again(sweep, folder):
    said = []

    class Listener:
        def __getattr__(self, name):
            return lambda *words, **more: said.append(words)

    run_sweep(sweep, folder, jobs=1, reporter=Listener())
    return str(said)


def test_the_peak_is_an_axis_of_records_too_and_ends_with_the_answer(sweep_of, tmp_path):
    sweep = sweep_of(
        f"{SIGNS}motion.file = {PAIRS}\nmotion.peak_acceleration_m_s2 = [2.0, 14.0, 30.0]\n"
        '[threshold]\naxis = "motion.peak_acceleration_m_s2"\nresolution = 0.2\n'
    )
    assert sweep.case(1).motion.scale_to_m_s2 == 14.0
    info = run_sweep(sweep, tmp_path / "out", jobs=1)
    assert info["status"] == "completed"
    assert info["answer"].startswith("peak acceleration: stood in every motion tried up to ")
    with (tmp_path / "out" / "answers.csv").open() as file:
        rows = list(csv.DictReader(file))
    # the signs of a motion count as one
    assert [row["motion.file"] for row in rows] == ["a_h.csv", "b_h.csv"]
    for row in rows:
        fell = [float(row["overturned_from"])] if row["overturned_from"] else []
        assert 2.0 <= float(row["stood_to"]) < min([*fell, 31.0])
