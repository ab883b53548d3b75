"""From a case to its mesh, its support and its base motion."""

import numpy as np
import pytest
from mesh_writer import write_container_mesh

from contact.motion.base_motion import HarmonicMotion, NoMotion, PulseMotion, TableMotion
from fem.case.case import CaseError, load_case, read_case
from fem.case.files import CASES
from fem.cli.check import preview_of
from fem.model.geometry import base_positions, build_container, node_count
from fem.model.motion import build_motion
from fem.model.support import build_support, normal_penalty


@pytest.mark.parametrize("name", CASES.names)
def test_the_mesh_of_a_case_has_its_mass_and_mass_centre(name):
    case = load_case(name)
    mesh = build_container(case)
    assert mesh.mass == pytest.approx(case.mass, rel=1e-9)
    # Equal boxes: the stack's centre is half of what stands below the last box, plus that box's own.
    boxes, height = case.container.boxes, case.container.height_m
    assert mesh.centroid[1] == pytest.approx(0.5 * (boxes - 1) * height + case.container.centroid_m, rel=1e-9)
    assert (mesh.width, mesh.height) == pytest.approx((case.container.width_m, case.container.total_height))


def test_a_mesh_file_beside_the_case_takes_the_place_of_the_structured_mesh(tmp_path):
    case = load_case("seed_box", ["solver.element_size_m=0.2"])
    mesh = build_container(case)
    write_container_mesh(tmp_path / "box.vtu", mesh)
    text = CASES.text("seed_box").replace("boxes = 1 ", 'mesh_file = "box.vtu"\nboxes = 1 ')
    read = build_container(read_case(text, folder=tmp_path))
    assert len(read.quads) == len(mesh.quads)
    assert read.mass == pytest.approx(mesh.mass, rel=1e-9)
    assert read.inertia == pytest.approx(mesh.inertia, rel=1e-9)


def test_nodes_of_a_mesh_are_counted_by_order():
    # 1 m x 1 m in elements of 0.5 m: 3 x 3 points, and 5 x 5 nodes of quadratic elements.
    mesh = build_container(
        load_case(
            "seed_box", ["container.section=solid", "solver.element_size_m=0.5", "container.width_m=1.0"]
        )
    )
    assert (node_count(mesh, 1), node_count(mesh, 2)) == (9, 25)
    np.testing.assert_allclose(base_positions(mesh, 1), [-0.5, 0.0, 0.5])
    np.testing.assert_allclose(base_positions(mesh, 2), [-0.5, -0.25, 0.0, 0.25, 0.5])


@pytest.mark.parametrize(("kind", "share"), [("corners", 1.0), ("flat", 1.0), ("feet", 0.3 / 1.1)])
def test_the_springs_of_a_support_add_up_to_the_penalty_over_the_area_that_bears(kind, share):
    case = load_case("seed_box", [f"support.kind={kind}", "contact.normal_penalty_Pa_m=1e9"])
    mesh = build_container(case)
    springs = build_support(case, mesh).normal_stiffness(normal_penalty(case, mesh))
    assert springs.sum() == pytest.approx(1e9 * 1.1 * 1.1 * share, rel=1e-9)


def test_auto_penalty_of_corners_sinks_in_by_the_promised_share_of_height_and_swing():
    # At most 1e-5 of the height and 6e-5 of width x slenderness angle; the stack: 17.7 micrometres.
    case = load_case("seed_stack", ["floor.kind=rigid"])
    mesh = build_container(case)
    stiffness = build_support(case, mesh).normal_stiffness(normal_penalty(case, mesh)).sum()
    swing = 1.1 * np.arctan2(1.1, 4.0)
    assert case.weight / stiffness == pytest.approx(min(1e-5 * 4.0, 6e-5 * swing), rel=1e-6)


def test_motion_of_a_case_is_its_formula():
    times = np.linspace(0.0, 2.0, 7)
    harmonic = build_motion(load_case("seed_stack", ["motion.phase_rad=0.3"]))
    assert isinstance(harmonic, HarmonicMotion)
    np.testing.assert_allclose(harmonic.evaluate(times)[0], 0.05 * np.sin(6.928 * times + 0.3), atol=1e-15)
    assert isinstance(build_motion(load_case("free_rocking")), NoMotion)


def test_pulse_of_a_case_has_its_sign_and_delay():
    pulse = {"shape": "rectangular", "peak_acceleration_m_s2": -3.0, "pulse_s": 0.5, "delay_s": 1.0}
    values = {f"motion.{key}": value for key, value in pulse.items()} | {"motion.kind": "pulse"}
    case = load_case("free_rocking").with_values(values)
    motion = build_motion(case)
    assert isinstance(motion, PulseMotion)
    np.testing.assert_allclose(motion.evaluate(np.array([0.5, 1.25, 1.75]))[2], [0.0, -3.0, 0.0])
    assert preview_of(case).peak == 3.0


TABLE = 'kind = "table"\nfile = "floor.csv"\nquantity = "acceleration"\nunit = "g"\nscale = 2.0\n'


def with_table(folder, content):
    (folder / "floor.csv").write_text(content, encoding="utf-8")
    text = CASES.text("free_rocking").replace('kind = "none"\n', TABLE)
    return read_case(text, folder=folder)


def test_table_of_a_case_is_read_beside_it_and_scaled(tmp_path):
    case = with_table(tmp_path, "t [s],a\n0,0\n0.5,-0.2\n1.0,0.1\n")
    assert isinstance(build_motion(case), TableMotion)
    assert preview_of(case).peak == pytest.approx(2.0 * 0.2 * 9.80665)


def test_a_table_that_is_none_is_refused_as_an_error_of_the_case(tmp_path):
    with pytest.raises(CaseError, match=r"\[motion\] .*floor.csv"):
        build_motion(with_table(tmp_path, "0,0\n0.5,x\n"))


@pytest.mark.parametrize(
    "overrides",
    [
        [],
        ["motion.ramp_cycles=2"],
        ["motion.cycles=3"],
        ["solver.duration_s=0.1", "motion.phase_rad=1.5"],
        ["motion.cycles=0.1", "motion.phase_rad=1.0"],
    ],
)
def test_peak_of_the_floor_is_that_of_the_motion_within_the_run(overrides):
    case = load_case("seed_stack_plateau", overrides)
    assert preview_of(case).peak == pytest.approx(build_motion(case).peak_acceleration, rel=1e-9)
