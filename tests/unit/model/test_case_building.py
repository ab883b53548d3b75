"""From a case to its mesh, its support, its base motion, and how often it keeps its fields."""

import numpy as np
import pytest
from mesh_writer import write_container_mesh

from fem.case.case import load_case, read_case
from fem.case.files import CASES
from fem.cli.check import preview_of
from fem.model.frames import INTERVALS, MOST_BYTES, frame_bytes, frame_interval
from fem.model.geometry import base_positions, build_container, node_count
from fem.model.motion import build_motion


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
    keys = ["container.section=solid", "solver.element_size_m=0.5", "container.width_m=1.0"]
    mesh = build_container(load_case("seed_box", keys))
    assert (node_count(mesh, 1), node_count(mesh, 2)) == (9, 25)
    np.testing.assert_allclose(base_positions(mesh, 1), [-0.5, 0.0, 0.5])
    np.testing.assert_allclose(base_positions(mesh, 2), [-0.5, -0.25, 0.0, 0.25, 0.5])


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


@pytest.mark.parametrize("name", CASES.names)
def test_the_frames_of_a_shipped_case_take_sixteen_megabytes_at_most(name):
    numerics = preview_of(load_case(name)).numerics
    usual = numerics["field_frames"] * (numerics["duration_s"] - 50.0 * numerics["ends_at_rest"])
    assert usual * frame_bytes(numerics["nodes"]) <= MOST_BYTES * numerics["duration_s"]


def test_more_nodes_or_a_longer_run_keep_fewer_frames_and_a_given_interval_stays():
    case, given = load_case("rocking"), load_case("rocking", ["output.fields_s=0.02"])
    assert frame_interval(case, 600, 20.0) == INTERVALS[0]
    found = [frame_interval(case, nodes, 20.0) for nodes in (600, 2600, 10_000, 100_000)]
    assert found == sorted(set(found)) and set(found) <= set(INTERVALS)
    assert frame_interval(case, 600, 200.0) > INTERVALS[0]
    assert frame_interval(given, 100_000, 200.0) == 0.02
    assert frame_interval(case.without_fields(), 600, 20.0) == 0.0
