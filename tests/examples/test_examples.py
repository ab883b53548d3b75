"""The examples run as they are, print little, and what they compute is right by closed forms."""

import math
import runpy
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import fem
from contact.reference.rigid_block import RigidBlock
from fem.run.opened import StudyTable
from fem.runtime.progress import watched

FOLDER = Path(__file__).parent
EXAMPLES = sorted(path.stem for path in FOLDER.glob("*.py") if not path.stem.startswith("test_"))
LONGEST = 20  #: lines
STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
GRAVITY = 9.81


@pytest.fixture
def example(tmp_path, monkeypatch, capsys):
    """What an example leaves behind."""
    monkeypatch.chdir(tmp_path)

    def run(name):
        names = runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
        assert len(capsys.readouterr().out.splitlines()) <= 3
        return names

    return run


def test_examples_are_short_and_use_every_public_function():
    texts = [(FOLDER / f"{name}.py").read_text() for name in EXAMPLES]
    assert max(len(text.splitlines()) for text in texts) <= LONGEST
    assert all(any(f"fem.{name}(" in text for text in texts) for name in fem.__all__)
    assert any(".with_motion(" in text for text in texts)


def test_a_stepped_stack_rocks_as_housner_says(example):
    names = example("step_and_judge")
    # released at half the slenderness angle; Housner (1963), Eq. (2): cosh(p t) = 1/(1 - theta/alpha), linearised
    quarter = math.acosh(2.0) / STACK.frequency_parameter
    assert names["verdict"].outcome == "rock"
    assert names["verdict"].first_impact_s == pytest.approx(quarter, rel=5e-3)
    assert len(names["history"]["time_s"]) > 100


def test_a_computed_case_loses_at_an_impact_what_housner_says(example):
    verdict = example("compute_a_case")["run"].verdict
    assert verdict.outcome == "rock"
    assert verdict.rotation_ratio == pytest.approx(0.5, rel=1e-9)
    assert verdict.restitution_first == pytest.approx(STACK.housner_restitution, rel=0.01)


def test_a_case_from_a_mapping_slides_within_the_friction_cone(example):
    names = example("case_from_a_mapping")
    assert names["run"].verdict.outcome == "slide"  # 5 m/s2 > 0.3 g
    assert np.abs(names["shear"]).max() == pytest.approx(0.3 * names["normal"].mean(), rel=1e-3)


def test_a_scan_finds_the_uplift_acceleration(example):
    uplift = STACK.uplift_acceleration
    first = example("scan_for_the_margin")["first"]
    assert uplift < first < uplift + 0.1


def test_a_container_left_behind_by_a_jerk_has_slid_as_far_as_a_rigid_slider(example):
    names = example("motion_from_arrays")
    floor, friction, jerk = 6.0, 0.3 * GRAVITY, 0.25
    distance = 0.5 * floor * (floor - friction) / friction * jerk**2  # until both are equally fast
    assert names["run"].verdict.outcome == "slide"
    assert names["run"].verdict.residual_slip_m == pytest.approx(-distance, rel=0.01)


def test_opened_results_begin_with_the_release(example, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(FOLDER.parents[1]))
    names = example("open_results")
    assert names["largest"] == pytest.approx(0.5, rel=1e-9)
    assert names["rotation"][0] == max(names["rotation"])
    assert len(names["run"].fields) == 5  # at 0, 0.5 .. 2 s


def test_two_components_of_a_circle_slide_on_a_circle(example):
    both, alone = example("slide_in_two_directions")["across"]
    assert both == pytest.approx(2.0 * math.sqrt(0.1**2 - (0.2 * GRAVITY / 49.0) ** 2), rel=1e-3)
    assert alone < 0.9 * both


@pytest.fixture
def study(example, tmp_path, monkeypatch, capsys):
    """The table of the example of a study, which is not computed again, and says so where it is watched."""

    def run(name):
        table = example(name)["table"]
        assert isinstance(table, StudyTable)
        assert len({len(column) for column in table.values()}) == 1
        marks = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.json")}
        monkeypatch.setattr("fem.cli.python.watched", lambda: True)
        runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
        assert "holds this" in capsys.readouterr().err
        assert marks == {path: path.stat().st_mtime_ns for path in marks}
        return table

    return run


def test_a_sweep_slides_where_the_floor_is_stronger_than_friction(study):
    table = study("compute_a_sweep")
    mu, peak = table["contact.mu_static"], table["motion.peak_acceleration_m_s2"]
    assert peak.max() < 1.2 * STACK.uplift_acceleration  # friction holds less than what lifts it
    assert ((table["outcome"] == "slide") == (peak > mu * GRAVITY)).all()
    assert table.result["status"] == "completed"


def test_an_ensemble_counts_what_cannot_overturn_as_clopper_and_pearson_do(study):
    table = study("compute_an_ensemble")
    weak, strong = table["motion.peak_acceleration_m_s2"]
    assert weak < STACK.uplift_acceleration < strong
    none_of_16 = 1.0 - 0.025 ** (1 / 16)
    assert (table["probability"][0], table["high"][0]) == (0.0, pytest.approx(none_of_16, rel=1e-9))
    assert table["probability"][1] > 0.5


def test_a_list_ranks_by_the_narrower_side(study):
    table = study("compute_a_list")
    peak, height, sides = 0.05 * 6.928**2, 1.0, np.array([0.4, 1.1])  # of the wide one its depth
    assert table["utilisation_overturning"] == pytest.approx(peak * height / GRAVITY / sides, rel=1e-3)
    assert [*table["name"][np.argsort(table["rank"])]] == ["narrow", "wide"]


def test_a_response_curve_leaves_rest_where_the_floor_is_stronger_than_friction(study):
    table = study("compute_a_response_curve")
    strength = 0.05 * (2.0 * math.pi * table["frequency_Hz"]) ** 2
    assert ((table["motion"] == "rest") == (strength < 0.4 * GRAVITY)).all()
    assert [*table["direction"]] == ["up"] * 3 + ["down"] * 3


def test_a_site_where_a_run_overturns_is_not_fulfilled(study):
    table = study("assess_a_site")
    # EN 1998-1:2004, Table 3.2, ground D
    assert table.result["action"]["ag_S_m_s2"] == pytest.approx(1.35 * 3.5)
    assert "overturned" in table["outcome"]
    assert table.result["answer"].startswith("Not fulfilled")


def test_bad_input_of_a_study_is_a_value_error_in_words(tmp_path):
    still = fem.load_case("seed_box", ("solver.model=rigid", "motion.kind=none"))
    with pytest.raises(ValueError, match="no sweep"):
        fem.compute_sweep("nothing", tmp_path / "out")
    with pytest.raises(ValueError, match="harmonic"):
        fem.compute_response(still, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_notebook_is_shown_the_progress(monkeypatch):
    assert not watched()
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    assert watched()


def test_a_table_becomes_a_data_frame_where_pandas_is(monkeypatch):
    table = StudyTable({"answer": "It stands."}, [{"outcome": "rest", "slip_m": "0.1"}, {"outcome": "slide"}])
    made = ModuleType("pandas")
    made.DataFrame = dict
    monkeypatch.setitem(sys.modules, "pandas", made)
    assert [*table.to_dataframe()] == ["outcome", "slip_m"]
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        table.to_dataframe()
