"""A run on a slab, from the case file to its files: floor block, work of crushing over time, band, summary."""

import json
from dataclasses import replace

import pytest
from interrupted_runs import stored_run

import fem
from fem.figures.forces import energy_figure
from fem.run.card import card_of

KEYS = (
    *("floor.preset=concrete C25/30", "floor.corner_patch_m=[0.008, 1.1]", "solver.model=rigid"),
    *("solver.element_size_m=0.5", "solver.order=1", "solver.duration_s=4", "output.fields_s=0"),
    *("output.figures=false", "uncertainty.draws=2"),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("slab") / "run"
    case = fem.load_case("rocking", KEYS)
    stored_run(case, place, margin=False)
    return place


def test_the_floor_stands_in_the_result_and_its_force_is_capped(folder):
    """At its surface, and more by what bears besides as the edge sinks in: 50 MPa x 1.1 m x 4/1.1 for each metre."""
    found = json.loads((folder / "run.json").read_text())
    floor, verdict = found["floor"], found["verdict"]
    assert (floor["kind"], floor["governs"], floor["corner_patch_m"]) == ("slab", "floor", [0.008, 1.1])
    deepest = floor["corner_cap_N"] + 50e6 * 4.0 * verdict["max_indentation_m"]
    assert floor["corner_cap_N"] < verdict["max_corner_force_N"] <= deepest * (1.0 + 1e-9)
    assert verdict["valid"] is True and "invalid_reason" not in verdict
    assert found["numerics"]["normal_penalty_Pa_m"] is None


def test_the_work_of_crushing_rises_to_that_of_the_energy_balance(folder):
    run = fem.open_run(folder)
    crushing = run.history["crushing_J"]
    assert (crushing[1:] >= crushing[:-1]).all()
    assert crushing[-1] == pytest.approx(run.typed_result.energy.crushing_J)
    # All of it is the growing cap over the indentations of both corners, of which the largest is in the verdict.
    deepest, cap = run.typed_result.verdict.max_indentation_m, run.typed_result.floor.corner_cap_N
    work = cap * deepest + 0.5 * 50e6 * 4.0 * deepest**2
    assert 0.97 * work < crushing[-1] < 2.0 * work


def test_its_band_tries_strength_and_stiffness_of_the_slab(folder):
    verdict = fem.open_run(folder).typed_result.verdict
    tried = {key for member in verdict.band.members if member.kind == "one" for key in member.values}
    assert {"floor.bearing_strength_Pa", "floor.youngs_modulus_Pa"} <= tried
    assert tried.isdisjoint({"contact.normal_penalty_Pa_m", "contact.damping_ratio"})
    low, high = verdict.band.max_indentation_m
    assert low < verdict.max_indentation_m < high


def test_the_energies_that_are_drawn_add_up_with_the_work_of_crushing(folder):
    axes = energy_figure(fem.open_run(folder)).axes[1]
    curves = {line.get_label().partition(",")[0]: line.get_ydata()[-1] for line in axes.lines}
    parts = ("stored", "friction", "contact damping", "material damping", "crushing of the floor")
    history = fem.open_run(folder).history
    unit = history["crushing_J"][-1] / curves["crushing of the floor"]
    lost = history["imbalance_J"][-1] / unit
    assert sum(curves[part] for part in parts) + lost == pytest.approx(curves["work of the floor"], rel=1e-6)


WEAK = ("floor.bearing_strength_Pa=14e6", "solver.duration_s=10")


def test_a_corner_that_is_destroyed_is_said_before_anything_else_and_is_never_sure(tmp_path):
    case = fem.load_case("rocking", (*KEYS, *WEAK))
    stored_run(case, tmp_path / "run")
    found = json.loads((tmp_path / "run" / "run.json").read_text())
    verdict = found["verdict"]
    assert found["status"] == "completed" and verdict["outcome"] == "invalid"
    assert verdict["valid"] is False and verdict["sure"] != "sure"
    assert verdict["max_indentation_m"] > 0.01
    assert verdict["invalid_reason"] in verdict["card"][0] and "stands" not in verdict["card"][0].lower()
    again = fem.compute(case, band=True, margin=False).verdict
    assert again.sure == "unsure"


def test_what_gives_way_under_a_corner_is_named():
    posts = ("support.casting_m=[0.1, 0.1, 0.0]", "container.corner_post_N=100e3")
    weak = fem.load_case("rocking", (*KEYS[:1], *posts, *KEYS[2:]))
    assert "its posts" in fem.compute(weak, band=False).verdict.invalid_reason


@pytest.mark.parametrize("boxes", [(), ("container.boxes=2", "container.joints=loose")], ids=["one", "loose"])
def test_pressure_in_a_frame_is_the_force_of_a_corner_on_its_patch(boxes):
    case = fem.load_case("rocking", (*KEYS, *boxes, "solver.duration_s=1", "output.fields_s=0.1"))
    run = fem.compute(case, band=False)
    patch = 0.008 * 1.1
    for frame in run.fields:
        instant = round(frame.time / run.case.output.history_s)
        base = frame.points[:, 1] == 0.0
        force = patch * frame.contact_pressure[base].sum()
        assert force == pytest.approx(run.history["normal_force_N"][instant], rel=1e-5, abs=1e-3)
        assert frame.contact_pressure.max() <= run.case.floor.bearing_strength_Pa * (1.0 + 1e-6)
    # at rest what the lower corners of the upper box press is its weight, on patches of the same size
    if boxes:
        upper = (run.fields.frame(0).points[:, 1] == 1.0) & (run.fields.frame(0).contact_pressure > 0.0)
        pressed = patch * run.fields.frame(0).contact_pressure[upper].sum()
        assert pressed == pytest.approx(run.case.weight / 2.0, rel=1e-5)


def test_a_container_left_leaning_on_its_hole_is_said_to_lean():
    pulse = [
        *("motion.kind=pulse", "motion.shape=half-sine", "motion.peak_acceleration_m_s2=6.0"),
        "motion.pulse_s=0.4",
    ]
    weak = ["contact.mu_static=0.6", "floor.bearing_strength_Pa=12e6", "floor.corner_patch_m=[0.1, 0.2]"]
    run = fem.compute(fem.load_case("stack_on_concrete", ["solver.model=rigid", *pulse, *weak]), band=False)
    result, verdict, angle = run.typed_result, run.verdict, run.typed_result.static.slenderness_angle_rad
    assert verdict.tilt_rad == pytest.approx(run.history["rotation_rad"][-1], rel=1e-6)
    assert abs(verdict.tilt_rad) > 0.005 * angle and verdict.restored
    leaning = replace(verdict, tilt_rad=2.0 * verdict.tilt_rad, restored=False)  # a hole twice as deep
    share = f"{2.0 * abs(verdict.tilt_rad) / angle:.0%} less capacity"
    assert share in card_of(replace(result, verdict=leaning))[2]
