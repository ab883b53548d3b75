"""Runs of rows, stops and ties: what falls, what their band varies and names, and how they are drawn."""

from dataclasses import replace

import numpy as np
import pytest
import pyvista
from interrupted_runs import stored_run
from runs import harmonic

import fem
from fem.case.case import Case, load_case
from fem.case.tables.input_ranges import UnknownChoice
from fem.case.tables.unknown_inputs import UNKNOWN
from fem.model.geometry import build_container
from fem.model.model import build_model
from fem.model.motion import build_motions
from fem.results.fields import STOP, TIE
from fem.run.card import line
from fem.run.compute import resolve
from fem.run.described import governing
from fem.run.drawn_links import drawn_links
from fem.run.summary import run_found
from fem.runtime.units import KILONEWTONS

SLENDER = {"side": "right", "gap_m": 3.0, "stiffness_N_m": 1e8, "width_m": 0.4}
SLENDER |= {"height_m": 3.0, "mass_kg": 2000.0, "centroid_m": 1.5}
SQUAT = {
    "container": {"width_m": 4.0, "height_m": 1.5, "depth_m": 1.1, "mass_kg": 1e4},
    "contact": {"mu_static": 3.0},
    "motion": {"kind": "pulse", "shape": "rectangular", "peak_acceleration_m_s2": 2.5, "pulse_s": 1.2},
    "solver": {"model": "rigid", "duration_s": 6.0},
    "neighbour": [SLENDER],
}


@pytest.fixture(scope="module")
def fallen():
    return fem.compute(fem.case_from(SQUAT), band=False, margin=True)


def test_what_falls_is_named_and_the_container_is_compared_with_its_own_rule(fallen):
    assert fallen.verdict.outcome == "overturned"
    assert fallen.verdict.neighbours[0].outcome == "overturned" and fallen.verdict.rotation_ratio < 0.001
    leant = replace(fallen.verdict, rotation_ratio=4.9)
    assert "ratio < 0.001" in run_found(fallen.verdict, "overturning")
    assert "ratio 4.9" in run_found(leant, "overturning")
    assert governing(fallen.typed_result) == []


def test_the_margin_begins_below_what_the_most_slender_of_the_row_bears(fallen):
    margin = fallen.verdict.margin
    assert margin.least_tried < 0.4 / 3.0 * 9.81 / 2.5  # its static limit over the peak
    assert margin.factor is not None and 0.5 < margin.factor < 1.0
    assert margin.factor_without_links is None and margin.without_links_tried_to == 4.0


def test_the_rigid_floor_of_a_row_is_one_whichever_of_its_containers_is_the_first():
    def penalties(case):
        equilibrium = build_model(case).equilibrium
        return [one.penalty for one in equilibrium.row or (equilibrium,)]

    # its neighbour is slender, and sinks too far into a floor that is soft enough for it
    first = fem.case_from(SQUAT)
    names = ("width_m", "height_m", "mass_kg", "centroid_m")
    other = first.with_values({f"container.{name}": SLENDER[name] for name in names})
    beside = dict(SLENDER, width_m=4.0, height_m=1.5, mass_kg=1e4, centroid_m=0.75)
    row_of_other = other.with_values({"neighbour": [beside]})
    alone = [penalties(case.with_values({"neighbour": []}))[0] for case in (first, other)]
    assert alone[0] < 0.2 * alone[1]
    for row in (first, row_of_other):
        resolved = resolve(row, build_container(row), build_motions(row))
        assert penalties(row) == penalties(resolved) == [max(alone)] * 2


BESIDE = {"side": "right", "gap_m": 0.03, "stiffness_N_m": 1e8, "mu": 0.2}
KERBS = [
    {"side": side, "height_m": 0.1, "gap_m": gap, "stiffness_N_m": 1e8, "mu": 0.3}
    for side, gap in (("left", 0.025), ("right", 0.02))
]
TIES = [
    {"from": "left", "height_m": 0.5, "slack_m": 0.01, "stiffness_N_m": 1e6},
    {"from": "right", "height_m": 2.0, "slack_m": 0.02, "stiffness_N_m": 2e6},
]
LINKS = {
    *("stop_gap_m", "stop_stiffness_N_m", "stop_mu", "tie_slack_m", "tie_stiffness_N_m"),
    *("neighbour_gap_m", "neighbour_stiffness_N_m", "neighbour_mu"),
}
#: slides, and overturns where a narrow kerb stops it
SLIDING = {
    "solver.model": "rigid",
    "solver.duration_s": 4.0,
    "contact.mu_static": 0.25,
    "contact.mu_kinetic": 0.2,
    "motion.peak_acceleration_m_s2": 5.0,
    "motion.frequency_Hz": 0.9,
    "output.fields_s": 0.0,
}


def unsure_of(*names: str, **keys) -> Case:
    """A case in which these inputs alone have a range."""
    held = {
        f"uncertainty.{one.name}": False if isinstance(one, UnknownChoice) else "held"
        for one in UNKNOWN
        if one.name not in names
    }
    return load_case("stack_on_concrete", []).with_values(SLIDING | held | keys)


def test_every_input_of_links_is_varied_alone_and_with_the_others():
    brief = {"solver.duration_s": 0.5, "uncertainty.draws": 4}
    case = unsure_of(*LINKS, stop=KERBS, tie=TIES, neighbour=[BESIDE], **brief)
    band = fem.compute(case, band=True, margin=False).verdict.band
    keys = {name.replace("_", ".", 1) for name in LINKS}
    alone = {key: set() for key in keys}
    for member in band.members[1:]:
        if member.kind == "one" and (key := next(iter(member.values))) in keys:
            alone[key].add(member.values[key])
        if member.kind == "draw":
            assert set(member.values) == keys
    assert alone["stop.gap_m"] == {0.02, 0.03} and alone["neighbour.gap_m"] == {0.024, 0.036}
    assert alone["stop.mu"] == {0.15, 0.6} and alone["neighbour.mu"] == {0.1, 0.4}
    assert alone["tie.slack_m"] == {0.016, 0.024} and alone["tie.stiffness_N_m"] == {1e6, 4e6}
    assert alone["stop.stiffness_N_m"] == alone["neighbour.stiffness_N_m"] == {5e7, 2e8}


def test_each_link_has_its_own_range():
    case = unsure_of("stop_gap_m", "tie_slack_m", stop=KERBS, tie=TIES, neighbour=[BESIDE])
    run = fem.compute(case.with_values({"solver.duration_s": 1.0}), band=True, margin=False)
    band, own = run.verdict.band, run.typed_result
    beside, stops, ties = band.links[:1], band.links[1:3], band.links[3:]
    for found, ranges in ((run.verdict.neighbours, beside), (own.stops, stops), (own.ties, ties)):
        for one, reach in zip(found, ranges, strict=True):
            for key in ("max_force_N", "hits", "largest_closing_velocity_m_s", "gap_left_m"):
                members = [member.links[band.links.index(reach)][key] for member in band.members]
                assert (
                    reach[key] == (min(members), max(members)) and reach[key][0] <= one[key] <= reach[key][1]
                )
    assert band.stop_force_N[1] == max(reach.max_force_N[1] for reach in stops)
    assert all(reach.max_force_N[0] < reach.max_force_N[1] for reach in band.links)
    for reach in band.links:  # the words have them
        assert (
            f" to {KILONEWTONS.text(reach.max_force_N[1], reach.max_force_N, figures=3).partition(' to ')[2]}"
            in line(own, "how_far")
        )


def test_a_wider_neighbour_has_an_outcome_in_every_variation():
    beside = BESIDE | {"width_m": 2.5}
    case = unsure_of(
        "weakening_m", neighbour=[beside], **{"contact.weakening_m": 1e-3, "solver.duration_s": 0.5}
    )
    members = fem.compute(case, band=True, margin=False).verdict.band.members
    assert all(member.outcome is not None for member in members)
    drawn = [member.values.get("contact.weakening_m") for member in members[1:]]
    least = min(filter(None, drawn))
    assert least >= 1e-4 * 2.5 * (1.0 - 1e-9)


def test_a_gap_that_decides_is_named_and_one_that_is_known_is_not_varied():
    wide = unsure_of("stop_gap_m", stop=KERBS, **{"uncertainty.stop_gap_m": [0.0, 0.2]})
    found = fem.compute(wide, band=True, margin=False)
    said = line(found.typed_result, "sureness")
    assert (found.verdict.outcome, found.verdict.sure) == ("overturned", "unsure")
    assert "gap of the stops 0.2 m" in said
    known = fem.compute(unsure_of(stop=KERBS), band=True, margin=False)
    assert known.verdict.sure == "sure"
    assert all([*one.values] == ["solver.energy_tolerance"] for one in known.verdict.band.members[1:])


SIDES = {"stiffness_N_m": 1e8}
STOPS = [
    {"side": "left", "height_m": 0.3, "gap_m": 0.05, **SIDES},
    {"side": "right", "height_m": 1.5, "gap_m": 0.2, **SIDES},
    {"side": "right", "height_m": 1.5, "gap_m": 9.0, **SIDES},
]
TIE_ROW = {"from": "left", "height_m": 2.0, "slack_m": 0.0, "stiffness_N_m": 1e6, "strength_N": 2e3}
TO_WALL = {"from": "left", "to": "wall", "height_m": 3.5, "slack_m": 0.5, "stiffness_N_m": 1e6}
NEXT_TO = {"side": "right", "gap_m": 0.1, "boxes": 2, **SIDES}
START = {"initial.rotation_rad": 0.0, "initial.angular_velocity_rad_s": 0.4, "solver.duration_s": 0.6}
CASE = load_case("free_rocking", ["solver.model=rigid", "output.fields_s=0.1", "output.figures=false"])
CASE = CASE.with_values(
    harmonic(0.1, 3.0) | START | {"stop": STOPS, "neighbour": [NEXT_TO], "tie": [TIE_ROW, TO_WALL]}
)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("links") / "run"
    return stored_run(CASE, folder, band=False, margin=False)


def test_stops_stand_at_their_gap_and_height_beside_the_last_container_of_their_side():
    left, right, tie, level = drawn_links(CASE)
    half, beyond = 0.55, 0.55 + 0.1 + 1.1  # of the container; the far side of the neighbour
    assert (left.x, left.height) == pytest.approx((-half - 0.05, 0.3)) and left.outer < left.x
    assert (right.x, right.height) == pytest.approx((beyond + 0.2, 1.5)) and right.outer > right.x
    assert tie.is_tie and level.is_tie and level.outer < level.x
    assert (tie.x, tie.height, tie.outer, tie.anchor) == pytest.approx((-half, 2.0, -half, 0.0))
    assert (level.x, level.height, level.anchor) == pytest.approx((-half, 3.5, 3.5))


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
        # the outer face of a wall
        assert moved.points[:, 0].max() == pytest.approx(1.95 + 0.12 + floor, abs=1e-5)


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
