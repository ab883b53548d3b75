"""The examples run as they are, print little, and what they compute is right by closed forms."""

import math
import runpy
from pathlib import Path

import numpy as np
import pytest

import fem
from contact.reference.rigid_block import RigidBlock

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
        names = runpy.run_path(str(FOLDER / f"{name}.py"))
        assert len(capsys.readouterr().out.splitlines()) <= 3
        return names

    return run


def test_examples_are_short_and_use_every_public_function():
    texts = [(FOLDER / f"{name}.py").read_text() for name in EXAMPLES]
    assert max(len(text.splitlines()) for text in texts) <= LONGEST
    studies = {
        name for name in fem.__all__ if fem.PLACES[name] == "fem.cli.python"
    }  # unit/study/test_from_python.py
    assert all(any(f"fem.{name}(" in text for text in texts) for name in {*fem.__all__} - studies)
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
    first = example("scan_for_the_margin")["main"]()
    assert uplift < first < uplift + 0.1


def test_a_container_left_behind_by_a_jerk_has_slid_as_far_as_a_rigid_slider(example):
    names = example("motion_from_arrays")
    floor, friction, jerk = 6.0, 0.3 * GRAVITY, 0.25
    distance = (
        0.5 * floor * (floor - friction) / friction * jerk**2
    )  # until floor and slider are equally fast
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
