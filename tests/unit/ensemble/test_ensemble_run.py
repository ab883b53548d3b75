"""An ensemble from its file to its folder: seeded, the same on any number of cores, resumed, and refused."""

import csv
import errno
import json
import os

import numpy as np
import pytest

from fem.__main__ import main
from fem.case.files import ENSEMBLES
from fem.case.validation import CaseError
from fem.ensemble import run as study
from fem.ensemble.distributions import draw_shares, read_random
from fem.ensemble.figures import COLOURS
from fem.ensemble.file import load_ensemble
from fem.ensemble.plan import Ensemble
from fem.ensemble.run import code_of, run_ensemble
from fem.ensemble.statistics import FAILED, OVERTURNED, STOOD, count_point
from fem.results.run_folder import FolderError, OutputError

FILE = """
case = "seed_stack_plateau"
draws = 8
confidence = 0.9
probability = 0.5
seed = 4
[set]
"solver.model" = "rigid"
"solver.duration_s" = 3.0
"solver.energy_tolerance" = 10.0
"motion.frequency_Hz" = 0.5
[axes]
"motion.peak_acceleration_m_s2" = [2.0, 6.0, 12.0]
[random]
"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2 }
"contact.mu_static" = { distribution = "lognormal", median = 1.0, deviation = 0.1, relative = true }
"free.ratio" = { distribution = "uniform", from = 0.6, to = 1.0 }
[derived]
"contact.mu_kinetic" = "free.ratio * contact.mu_static"
"""


def written(tmp_path, text=FILE, **changes):
    for before, after in changes.items():
        assert before in text or before == "add"
        text = text + after if before == "add" else text.replace(before, after)
    path = tmp_path / "e.toml"
    path.write_text(text)
    return path


def changed(tmp_path, *pairs):
    text = FILE
    for before, after in pairs:
        assert before in text, before
        text = text.replace(before, after)
    return written(tmp_path, text)


def files_of(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith(".")
    }


def test_the_same_seed_gives_the_same_files_on_any_number_of_cores_and_after_a_cut(tmp_path, monkeypatch):
    ensemble = load_ensemble(written(tmp_path))
    one = run_ensemble(ensemble, folder=tmp_path / "one", jobs=1)
    assert one.status == "completed"
    assert [point.region for point in one.points] == ["below", "above", "above"]
    with monkeypatch.context() as patch:
        patch.setattr(study, "BATCH", 8)
        calls = []

        def cut_off(cases, **options):
            calls.append(len(cases))
            if len(calls) == 2:
                raise KeyboardInterrupt
            return run_cases(cases, **options)

        run_cases = study.run_cases
        patch.setattr(study, "run_cases", cut_off)
        with pytest.raises(KeyboardInterrupt):
            run_ensemble(ensemble, folder=tmp_path / "two", jobs=2)
    assert calls == [8, 8]
    run_ensemble(ensemble, folder=tmp_path / "two", jobs=2, resume=True)
    assert files_of(tmp_path / "one") == files_of(tmp_path / "two")

    again = run_ensemble(ensemble, folder=tmp_path / "one")
    assert again.points == () and again.result["status"] == "completed"
    with (tmp_path / "one" / "draws.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 24
    for point in one.points:
        found = [row["outcome"] for row in rows[8 * one.points.index(point) :][:8]]
        assert found.count("overturned") == point.overturned


def test_draws_of_another_program_are_not_gone_on_with(tmp_path, monkeypatch):
    ensemble = load_ensemble(written(tmp_path))
    folder = tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr("fem.results.result_folder.program_identity", lambda: {"sources": "other"})
        patch.setattr(study, "run_cases", lambda cases, **options: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            run_ensemble(ensemble, folder=folder)
    with pytest.raises(FolderError, match="another version of the program or of its libraries; --force"):
        run_ensemble(ensemble, folder=folder, resume=True)


def test_a_disk_that_fills_up_is_told_with_the_file_and_the_way_on(tmp_path, monkeypatch):
    def full(self, name, arrays):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self.path / name))

    monkeypatch.setattr("fem.results.result_folder.ResultFolder.write_arrays", full)
    with pytest.raises(OutputError, match=r"state.npz: cannot be written \(No space left.*--resume goes on"):
        run_ensemble(load_ensemble(written(tmp_path)), folder=tmp_path / "out")


def test_another_seed_draws_others_and_a_point_does_not_depend_on_its_neighbours():
    first = draw_shares("independent", seed=1, cell=3, dimensions=2, draws=16, replicates=1)
    assert np.array_equal(
        first, draw_shares("independent", seed=1, cell=3, dimensions=2, draws=16, replicates=1)
    )
    assert not np.array_equal(
        first, draw_shares("independent", seed=2, cell=3, dimensions=2, draws=16, replicates=1)
    )
    assert not np.array_equal(
        first, draw_shares("independent", seed=1, cell=4, dimensions=2, draws=16, replicates=1)
    )


@pytest.mark.parametrize("sampling", ["latin-hypercube", "sobol"])
def test_each_replicate_is_stratified_and_no_two_are_the_same(sampling):
    shares = draw_shares(sampling, seed=1, cell=0, dimensions=3, draws=64, replicates=4)
    blocks = shares.reshape(4, 16, 3)
    for block in blocks:
        strata = np.sort(np.floor(16 * block), axis=0)
        assert np.array_equal(strata, np.tile(np.arange(16)[:, None], 3))
    assert len({block.tobytes() for block in blocks}) == 4


@pytest.mark.parametrize(
    ("given", "middle", "ends"),
    [
        ({"distribution": "uniform", "from": 1, "to": 3}, 2.0, (1.0, 3.0)),
        ({"distribution": "log-uniform", "from": 0.5, "to": 2}, 1.0, (0.5, 2.0)),
        ({"distribution": "normal", "mean": 1.0, "deviation": 0.1, "cut": 2}, 1.0, (0.8, 1.2)),
        (
            {"distribution": "lognormal", "median": 2.0, "deviation": 0.5},
            2.0,
            (2 * np.exp(-1.5), 2 * np.exp(1.5)),
        ),
    ],
)
def test_distributions_have_their_middles_and_ends(given, middle, ends):
    one = read_random("contact.mu_static", given)
    assert one.values(np.array([0.5]))[0] == pytest.approx(middle)
    assert one.ends == pytest.approx(ends)


def test_a_normal_quantity_has_its_deviation():
    one = read_random("x", {"distribution": "normal", "mean": 1.0, "deviation": 0.1})
    values = one.values((np.arange(20000) + 0.5) / 20000)
    # Cut at three deviations, a normal quantity keeps 0.9866 of its deviation.
    assert values.std() == pytest.approx(0.09866, rel=1e-3)


def test_a_failed_draw_is_never_one_that_stood():
    assert code_of({"status": "failed", "outcome": None}) == FAILED
    assert code_of({"status": "completed", "outcome": "rock"}) == STOOD
    assert code_of({"status": "overturned", "outcome": "overturned"}) == OVERTURNED


def test_a_point_with_failed_draws_is_judged_with_them_against_it(tmp_path):
    ensemble = load_ensemble(written(tmp_path))
    codes = np.array([STOOD] * 5 + [FAILED] * 3)
    point = count_point(ensemble, 0, codes)
    assert point.estimate.value == 0.0 and point.failed == 3
    assert point.estimate.high > 0.5 and point.region == "undecided"
    assert count_point(ensemble, 0, np.array([STOOD] * 8)).region == "below"


@pytest.mark.parametrize("name", ENSEMBLES.names)
def test_shipped_ensembles_can_be_read(name):
    ensemble = load_ensemble(name)
    assert isinstance(ensemble, Ensemble)
    case = ensemble.cases(0)[0]
    assert case.contact.mu_kinetic < case.contact.mu_static


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        ([("draws = 8", "draws = 4")], "draws must be at least 8, got 4"),
        ([("draws = 8", "draws = 8\nsampling = 'sobol'\nreplicates = 5")], "take 5 draws"),
        ([("draws = 8", "draws = 24\nsampling = 'sobol'\nreplicates = 8")], "powers of two; take 16 draws"),
        ([("probability = 0.5", "probability = 0.05")], "at least 59 are needed"),
        ([("[random]", "[randon]")], r"\[randon\] unknown table; did you mean 'random'"),
        ([('"motion.phase_rad" =', '"motion.phase" =')], r"\[random\] 'motion.phase' is no key"),
        (
            [('distribution = "uniform", from = 0.0, to = 6.2', 'distribution = "uniform", from = 0.0')],
            "needs to",
        ),
        (
            [('distribution = "uniform", from = 0.0', 'distribution = "unifrom", from = 0.0')],
            "distribution must be 'uniform', .* got 'unifrom'; for instance",
        ),
        ([("to = 6.2 }", "to = 62.0 }")], "phase_rad"),
        (
            [("free.ratio * contact", "free.ration * contact")],
            "which is neither an axis nor drawn",
        ),
        ([("free.ratio * contact", "3 * free.ratio * contact")], "must be at most mu_static"),
        ([("[2.0, 6.0, 12.0]", "[6.0, 2.0]")], "must rise"),
        ([('"solver.model" = "rigid"', '"solver.model" = "full"')], "weeks"),
        ([("seed = 4", "seed = -4")], "seed must be at least 0, got -4"),
        ([("draws = 8", "draws = 400000")], "runs; at most"),
        (
            [('"motion.phase_rad"', '"motion.peak_acceleration_m_s2"')],
            "is an axis as well; give the scatter about its values with relative = true",
        ),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_with_a_way_out(tmp_path, pairs, message):
    with pytest.raises(CaseError, match=message):
        load_ensemble(changed(tmp_path, *pairs))


def test_the_command_ends_with_2_on_a_bad_file_and_prints_its_result(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["ensemble", "fragilty"]) == 2
    assert "did you mean 'fragility'" in capsys.readouterr().err
    assert main(["ensemble", "fragility", "-j", "0"]) == 2
    assert list(tmp_path.iterdir()) == []
    written(tmp_path)
    assert main(["ensemble", "e.toml", "-q", "--json", "-j", "1"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result == json.loads((tmp_path / "outputs" / "e" / "ensemble.json").read_text())
    assert result["regions"] == {"below": 1, "undecided": 0, "above": 2}
    assert (tmp_path / "outputs" / "e" / "figures" / "fragility.svg").is_file()


def test_two_axes_make_a_boundary(tmp_path):
    path = changed(
        tmp_path,
        ("[2.0, 6.0, 12.0]", '[2.0, 12.0]\n"free.slenderness" = [2.0, 4.0]'),
        ("[derived]", '[derived]\n"container.width_m" = "4.0 / free.slenderness"'),
        ('solver.duration_s" = 3.0', 'solver.duration_s" = 1.5'),
    )
    done = run_ensemble(load_ensemble(path), folder=tmp_path / "b")
    assert done.status == "completed" and len(done.points) == 4
    assert done.result["fragility"] is None
    drawn = (tmp_path / "b" / "figures" / "boundary.svg").read_text().lower()
    for region in {point.region for point in done.points}:
        assert drawn.count(f"fill: {COLOURS[region].lower()}") > 1  # the legend has one
