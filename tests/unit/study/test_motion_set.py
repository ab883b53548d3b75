"""Sets of motions: how they are written, what is refused and told, and each as a value of an axis or as a draw."""

import json
import re

import numpy as np
import pytest
from motion_files import write_motion, write_pair
from small_sweep import rows_of, sweep_in

from fem.case.case import CaseError, load_case
from fem.model.motion import build_motion
from fem.records.intensity import intensity
from fem.records.spectrum import response_spectrum
from fem.report.study_page import ensemble_report, sweep_report
from fem.runtime.intervals import binomial_interval, estimate
from fem.study.axes import read_axis
from fem.study.ensemble import begun_result, run_ensemble
from fem.study.file import load_ensemble
from fem.study.motions import read_motion_set, spectra_of
from fem.study.sweep import asked_of, run_sweep
from fem.study.sweep_table import open_sweep

UNITS = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"solver.duration_s" = 1.2
"motion.quantity" = "acceleration"
"motion.unit" = "m/s2"
"vertical.quantity" = "acceleration"
"vertical.unit" = "m/s2"
"""


@pytest.fixture
def written(tmp_path):
    """The folder with three pairs."""
    for k, name in enumerate(("a", "b", "c")):
        write_pair(tmp_path, name, frequency=2.0 + k)
    return tmp_path


@pytest.fixture
def base(sweep_of):
    return sweep_of('motion.file = ["a_h.csv", "b_h.csv"]\n').base


def test_the_motions_are_read_as_the_case_takes_them(base):
    axis = read_axis("motion.file", [["a_h.csv", "a_v.csv"], ["b_h.csv", "b_v.csv"]])
    scaled = base.with_values({"motion.scale": 2.0, "vertical.scale": -1.0})
    found = read_motion_set(scaled, axis)
    assert [one.name for one in found] == ["a_h.csv", "b_h.csv"]
    numbers = found[1].numbers()
    assert numbers["peak_acceleration_m_s2"] == pytest.approx(6.0)
    assert numbers["vertical"]["peak_acceleration_m_s2"] == pytest.approx(2.0)
    assert (numbers["duration_s"], numbers["step_s"], numbers["samples"]) == (1.0, pytest.approx(0.02), 51)
    motion = build_motion(found[1].case)
    assert numbers["significant_s"] == intensity(motion.times, motion.values).significant_s


def test_spectra_are_those_of_each_motion(base):
    axis = read_axis("motion.file", [["a_h.csv", "a_v.csv"], "b_h.csv"])
    motions = read_motion_set(base, axis)
    periods, spectra = spectra_of(motions)
    assert list(spectra) == ["a_h.csv", "a_v.csv", "b_h.csv"]
    assert periods[0] == pytest.approx(0.04)  # two steps of 0.02 s
    alone = response_spectrum(0.02, build_motion(motions[1].case).values, periods)
    assert spectra["b_h.csv"] == pytest.approx(alone)


def test_motions_that_are_one_are_refused(base, tmp_path):
    # of a_h.csv: half as strong, of the other sign
    write_motion(tmp_path, "copy.csv", frequency=2.0, peak=-1.5)
    with pytest.raises(CaseError, match=r"'copy.csv' and 'a_h.csv' hold the same motion"):
        read_motion_set(base, read_axis("motion.file", ["a_h.csv", "b_h.csv", "copy.csv"]))
    with pytest.raises(CaseError, match=r"a_h.csv: the file has one motion"):
        read_motion_set(base, read_axis("motion.file", [["a_h.csv", "a_h.csv"]]))


def test_two_motions_of_one_file_are_refused(base, tmp_path):
    columns = [np.loadtxt(tmp_path / f"{name}_h.csv", delimiter=",", skiprows=1).T for name in ("a", "b")]
    rows = np.column_stack([columns[0][0], columns[0][1], columns[1][1]])
    np.savetxt(tmp_path / "both.csv", rows, delimiter=",")
    (pair,) = read_motion_set(base, read_axis("motion.file", [["both.csv#1", "both.csv#2"]]))
    assert len(pair.measures) == 2
    with pytest.raises(CaseError, match=r"'both.csv#1' and 'both.csv#2' are motions of one file, both.csv"):
        read_motion_set(base, read_axis("motion.file", ["both.csv#1", "both.csv#2"]))
    with pytest.raises(CaseError, match=r"'a_h.csv' and './a_h.csv' are motions of one file"):
        read_motion_set(base, read_axis("motion.file", ["a_h.csv", "./a_h.csv"]))


HEAD = UNITS + '[perturbation]\ncells = "none"\n[axes]\n'
PAIRS = '[["a_h.csv", "a_v.csv"], ["b_h.csv", "b_v.csv"]]'
SIGNS = "vertical.scale = [1.0, -1.0]\n"


@pytest.fixture
def sweep_of(tmp_path, written):
    return lambda axes: sweep_in(tmp_path, HEAD + axes)


def test_a_motion_alone_has_no_vertical_motion_and_no_sign_of_it(sweep_of):
    sweep = sweep_of('motion.file = ["a_h.csv", ["b_h.csv", "b_v.csv"]]\n')
    assert [sweep.case(cell).vertical.kind for cell in (0, 1)] == ["none", "table"]
    with pytest.raises(CaseError, match=r"'vertical.scale' varies, and 'a_h.csv' has no vertical motion"):
        sweep_of(f'motion.file = ["a_h.csv", ["b_h.csv", "b_v.csv"]]\n{SIGNS}')
    with pytest.raises(CaseError, match=r"'vertical.scale' varies, and 'a_h.csv' has no vertical motion"):
        sweep_of(f'motion.file = ["a_h.csv", "b_h.csv"]\n{SIGNS}')


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
    rows = rows_of(tmp_path / "out" / "answers.csv")
    # the signs of a motion count as one
    assert [row["motion.file"] for row in rows] == ["a_h.csv", "b_h.csv"]
    for row in rows:
        fell = [float(row["overturned_from"])] if row["overturned_from"] else []
        assert 2.0 <= float(row["stood_to"]) < min([*fell, 31.0])


DRAWN = """[axes]
"motion.scale" = [1.0, 2.0]
[random]
"motion.file" = [["a_h.csv", "a_v.csv"], ["b_h.csv", "b_v.csv"], "c_h.csv"]
"""
FRICTION = '"contact.mu_static" = { distribution = "uniform", from = 0.3, to = 0.6 }\n'


@pytest.fixture
def ensemble_of(tmp_path, written):
    def read(body=FRICTION, sampling=""):
        text = f"draws = 12\nprobability = 0.5\n{sampling}\n{UNITS}{DRAWN}{body}"
        (tmp_path / "try.toml").write_text(text, encoding="utf-8")
        return load_ensemble(tmp_path / "try.toml")

    return read


@pytest.mark.parametrize("sampling", ["", 'sampling = "latin-hypercube"', 'sampling = "sobol"'])
def test_each_motion_is_drawn_equally_often(ensemble_of, sampling):
    ensemble = ensemble_of(sampling=sampling)
    assert ensemble.replicates == 3
    draws = ensemble.draws_at(1)
    assert [draw.drawn["motion.file"] for draw in draws] == ["a_h.csv"] * 4 + ["b_h.csv"] * 4 + [
        "c_h.csv"
    ] * 4
    frictions = np.array([draw.drawn["contact.mu_static"] for draw in draws])
    assert len(np.unique(frictions)) == 12
    if sampling:  # one in each quarter of the range, for every motion
        quarters = np.sort(np.floor((frictions.reshape(3, 4) - 0.3) / 0.075), axis=1)
        assert (quarters == [0, 1, 2, 3]).all()
    case = ensemble.make.case(draws[5])
    assert (case.motion.file, case.vertical.file, case.motion.scale) == ("b_h.csv", "b_v.csv", 2.0)
    assert ensemble.make.case(draws[11]).vertical.kind == "none"


def test_a_list_is_drawn_evenly(ensemble_of):
    ensemble = ensemble_of(FRICTION + '"support.kind" = ["corners", "flat"]\n', sampling='sampling = "sobol"')
    kinds = [ensemble.make.case(draw).support.kind for draw in ensemble.draws_at(0)]
    assert [kinds[k : k + 4].count("flat") for k in (0, 4, 8)] == [2, 2, 2]


def test_an_ensemble_tells_its_motions(ensemble_of, tmp_path):
    folder = tmp_path / "results"
    result = run_ensemble(ensemble_of(), folder=folder, jobs=1)
    assert [one["file"] for one in result["motions"]] == ["a_h.csv", "b_h.csv", "c_h.csv"]
    for one in result["motions"]:
        assert one["stood"] + one["overturned"] + one["failed"] == 8  # four draws at each of two points
    rows = rows_of(folder / "draws.csv")
    assert [rows[k]["vertical.file"] for k in (0, 4, 8)] == ["a_v.csv", "b_v.csv", ""]
    fallen = sum(row["outcome"] == "overturned" for row in rows)
    assert sum(one["overturned"] for one in result["motions"]) == fallen
    assert (folder / "c_h.csv").is_file()
    assert (folder / "spectra.csv").read_text(encoding="utf-8").startswith("period_s,a_h.csv,a_v.csv,b_h.csv")
    # Nothing of three motions overturned at the first point, or everything: no narrower than three of three tell.
    for point in result["points"]:
        if point["overturned"] in (0, 12):
            assert point["high"] - point["low"] >= binomial_interval(0, 3, 0.95)[1] - 1e-12
    page = ensemble_report(folder)
    assert "c_h.csv" in page and "sample of 3 motions" in page


def test_what_a_sweep_and_an_ensemble_ask_for_depends_on_what_the_files_hold(sweep_of, ensemble_of, tmp_path):
    def asked():
        sweep, ensemble = sweep_of(f"motion.file = {PAIRS}\n"), ensemble_of()
        motions = read_motion_set(sweep.base, sweep.motions)
        drawn = read_motion_set(ensemble.base, ensemble.motions)
        return asked_of(sweep, motions, 1).sweep_hash, begun_result(ensemble, drawn).asked

    before = asked()
    assert before == asked()
    write_pair(tmp_path, "b", frequency=5.0)
    assert all(one != other for one, other in zip(before, asked(), strict=True))


@pytest.mark.parametrize(
    "overturned",
    [
        np.repeat([True, True, False, False, False, False], 12),  # two motions overturn all, the others none
        np.tile([True, False, False], 24),  # every motion overturns a third, and none differs from another
    ],
)
def test_draws_under_one_motion_are_no_sample_of_motions(overturned):
    """Six motions, twelve draws each: as much as two of six motions tell."""
    of_motions = estimate(overturned, ~overturned & overturned, replicates=6, confidence=0.95, independent=6)
    low, high = binomial_interval(2, 6, 0.95)
    assert of_motions.low <= low and of_motions.high >= high
    assert of_motions.value == pytest.approx(1.0 / 3.0)


@pytest.mark.slow
@pytest.mark.parametrize(("count", "spread"), [(7, 0.0), (7, 4.0), (12, 1.0), (30, 0.3)])
def test_intervals_of_motions_hold_the_truth_as_often_as_they_say(count, spread):
    # Motions whose share of overturning draws differs: not at all (0), or by a beta distribution about 0.3.
    generator = np.random.default_rng(7)
    held, trials, draws, truth = 0, 400, 16, 0.3
    for _ in range(trials):
        shares = np.full(count, truth)
        if spread:
            shares = generator.beta(truth / spread, (1.0 - truth) / spread, size=count)
        codes = (generator.random((count, draws)) < shares[:, None]).ravel()
        found = estimate(codes, np.zeros_like(codes), replicates=count, confidence=0.95, independent=count)
        held += found.low <= truth <= found.high
    assert held / trials >= 0.93
