"""Stops and ties in fields, pictures and the animation: where they stand, what holds them, until they break."""

import numpy as np
import pytest
import pyvista

import fem
from fem.results.fields import STOP, TIE
from fem.run.drawn_links import drawn_links
from fem.run.run import RunOptions, run_case

SIDES = {"stiffness_N_m": 1e8}
STOPS = [
    {"side": "left", "height_m": 0.3, "gap_m": 0.05, **SIDES},
    {"side": "right", "height_m": 1.5, "gap_m": 0.2, **SIDES},
    {"side": "right", "height_m": 1.5, "gap_m": 9.0, **SIDES},
]
TIE_ROW = {"from": "left", "height_m": 2.0, "slack_m": 0.0, "stiffness_N_m": 1e6, "strength_N": 2e3}
TO_WALL = {"from": "left", "to": "wall", "height_m": 3.5, "slack_m": 0.5, "stiffness_N_m": 1e6}
BESIDE = {"side": "right", "gap_m": 0.1, "boxes": 2, **SIDES}
CASE = fem.load_case(
    "free_rocking",
    [
        "solver.model=rigid",
        "solver.duration_s=0.6",
        "output.fields_s=0.1",
        "output.figures=false",
    ],
).with_values(
    {
        "motion.kind": "harmonic",
        "motion.amplitude_m": 0.1,
        "motion.angular_frequency_rad_s": 3.0,
        "stop": STOPS,
        "neighbour": [BESIDE],
        "initial.rotation_rad": 0.0,
        "initial.angular_velocity_rad_s": 0.4,
        "tie": [TIE_ROW, TO_WALL],
    }
)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("links") / "run"
    return run_case(CASE, case_text=CASE.text, folder=folder, options=RunOptions(band=False, margin=False))


def test_stops_stand_at_their_gap_and_height_beside_the_last_container_of_their_side():
    left, right, tie, level = drawn_links(CASE)
    half, beyond = 0.55, 0.55 + 0.1 + 1.1  # of the container; the far side of the neighbour
    assert (left.x, left.height) == pytest.approx((-half - 0.05, 0.3)) and left.outer < left.x
    assert (right.x, right.height) == pytest.approx((beyond + 0.2, 1.5)) and right.outer > right.x
    assert tie.is_tie and (tie.x, tie.height, tie.outer, tie.anchor) == pytest.approx(
        (-half, 2.0, -half, 0.0)
    )
    assert level.is_tie and (level.x, level.height, level.anchor) == pytest.approx((-half, 3.5, 3.5))
    assert level.outer < level.x


def test_paraview_reads_all_bodies_with_their_links(run):
    reader = pyvista.get_reader(run.place.fields / "run.pvd")
    for point, time in enumerate(reader.time_values):
        reader.set_active_time_point(point)
        (grid,) = reader.read()
        assert set(grid.cell_data["region"]) >= {STOP, TIE}
        moved = grid.warp_by_vector("displacement_m")
        stops = moved.extract_cells(grid.cell_data["region"] == STOP)
        floor = 0.1 * np.sin(3.0 * time)
        assert (stops.n_cells, stops.bounds[2]) == (2, pytest.approx(0.0, abs=1e-6))
        assert max(stops.points[:, 1]) == pytest.approx(1.5)
        left = stops.points[stops.points[:, 0] < 0.0]
        assert left[:, 0].max() == pytest.approx(-0.6 + floor, abs=1e-5)
        assert moved.points[:, 0].max() == pytest.approx(
            1.95 + 0.12 + floor, abs=1e-5
        )  # the outer face of a wall


def test_a_tie_runs_from_its_point_to_the_floor_until_it_breaks(run):
    tie = run.typed_result.ties[0]
    times = run.fields.times
    assert times[0] < tie.broken_at_s < times[-1]
    for k, time in enumerate(times):
        frame = run.fields.frame(k)
        strap = frame.cells[frame.region == TIE][0]
        at = frame.points[strap[:4]] + frame.displacement[strap[:4]]
        own = frame.without_links()
        node = np.hypot(*(own.points - (-0.55, 2.0)).T).argmin()
        point = own.points[node] + own.displacement[node]
        if time < tie.broken_at_s:
            assert at[2:].mean(axis=0) == pytest.approx(point, abs=1e-5)
            assert at[:2, 1] == pytest.approx(0.0, abs=1e-6)
        else:
            assert np.ptp(at, axis=0) == pytest.approx((0.0, 0.0), abs=1e-6)
