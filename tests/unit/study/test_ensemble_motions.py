"""Motions as draws: each equally often, with intervals of a sample of motions."""

import csv

import numpy as np
import pytest
from motion_files import write_pair

from fem.report.study_page import ensemble_report
from fem.runtime.intervals import binomial_interval, estimate
from fem.study.design import sets_among
from fem.study.ensemble import begun_result, run_ensemble
from fem.study.file import load_ensemble
from fem.study.motions import read_motion_set

HEAD = """
case = "seed_stack_plateau"
draws = 12
probability = 0.5
{sampling}
[set]
"solver.model" = "rigid"
"solver.duration_s" = 1.2
"motion.quantity" = "acceleration"
"motion.unit" = "m/s2"
"vertical.quantity" = "acceleration"
"vertical.unit" = "m/s2"
[axes]
"motion.scale" = [1.0, 2.0]
[random]
"motion.file" = [["a_h.csv", "a_v.csv"], ["b_h.csv", "b_v.csv"], "c_h.csv"]
"""
FRICTION = '"contact.mu_static" = { distribution = "uniform", from = 0.3, to = 0.6 }\n'


@pytest.fixture
def ensemble_of(tmp_path):
    for k, name in enumerate(("a", "b", "c")):
        write_pair(tmp_path, name, frequency=2.0 + k)

    def read(body=FRICTION, sampling=""):
        (tmp_path / "try.toml").write_text(HEAD.format(sampling=sampling) + body, encoding="utf-8")
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
    with (folder / "draws.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
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


def test_the_result_depends_on_what_the_files_hold(ensemble_of, tmp_path):
    def asked():
        ensemble = ensemble_of()
        return begun_result(ensemble, read_motion_set(ensemble.base, sets_among(ensemble.random))).asked

    before = asked()
    assert before == asked()
    write_pair(tmp_path, "b", frequency=5.0)
    assert asked() != before


def test_draws_under_one_motion_are_no_sample_of_motions():
    # Six motions, ten draws each; two motions overturn all, the others none: as much as two of six motions tell.
    overturned = np.repeat([True, True, False, False, False, False], 10)
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
