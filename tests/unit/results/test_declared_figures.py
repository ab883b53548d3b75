"""The declaration of the figures of a run: each stands in every place that it names, and is filled by some run."""

import json
from dataclasses import fields, replace

import pytest
from site_example import RUN

from fem.case.case import load_case
from fem.results.figures import (
    FIGURES,
    SCALARS,
    WHERE_GIVEN,
    BoxResult,
    Place,
    keys_of,
)
from fem.results.run_result import Band, ChangedRun, Verdict
from fem.site.runs import COLUMNS
from fem.study.runner import run_chunk
from fem.study.sweep_table import FOUND

BOX = BoxResult(max_rotation_rad=0.5, max_slip_m=0.5, max_opening_m=0.5)
OF_FIELDS = [key for key in FIGURES if key in {one.name for one in fields(Verdict)}]
WORDED = ("fell_in_row", "row_outcomes")
NUMBERS = [key for key in OF_FIELDS if key not in ("impacts", "restored", "valid", "fell_box", *WORDED)]
FULL = Verdict(
    outcome="rock",
    boxes=(BOX, BOX),
    fell_box=2,
    **dict.fromkeys(NUMBERS, 0.5),
    **dict.fromkeys(WORDED, "neighbour 1"),
    impacts=3,
    restored=True,
    valid=True,
)
#: of a run these are the forces in its joints
BOLTS = {"bolt_tension_N", "bolt_shear_N"}


def test_a_figure_is_a_key_of_run_json_and_comes_back():
    assert set(OF_FIELDS) - BOLTS <= FULL.to_json().keys()
    empty = Verdict().to_json()
    assert set(OF_FIELDS) - BOLTS - WHERE_GIVEN <= empty.keys() and not WHERE_GIVEN & empty.keys()
    again = Verdict.from_json(json.loads(json.dumps(FULL.to_json())))
    assert all(again[key] == FULL[key] for key in OF_FIELDS if key not in BOLTS)


def test_a_member_of_a_band_and_its_ranges_have_the_figures_of_a_band_and_no_others():
    banded = set(keys_of(Place.BAND))
    member = ChangedRun(status="completed", **FULL.figures(Place.BAND)).to_json()
    reach = Band(**dict.fromkeys(banded, (0.1, 0.5)))
    assert set(OF_FIELDS) & member.keys() == banded == set(OF_FIELDS) & reach.to_json().keys()
    assert Band.from_json(json.loads(json.dumps(reach.to_json()))) == reach


def test_a_figure_is_a_column_of_tables_and_of_the_runs_of_a_site():
    assert set(keys_of(Place.COLUMN)) <= set(SCALARS) <= set(FOUND)
    of_site = replace(RUN, **FULL.figures(Place.RUNS))
    assert set(keys_of(Place.RUNS)) <= set(COLUMNS)
    assert set(OF_FIELDS) & of_site.to_json().keys() == set(keys_of(Place.RUNS))


def test_every_figure_is_filled_by_some_run():
    cases = {
        "rocking": ["solver.duration_s=3"],
        "sliding": ["solver.model=rigid"],
        "overturning": ["solver.model=rigid", "container.joints=loose"],
    }
    struck = {"side": "right", "gap_m": 0.01, "stiffness_N_m": 1e8}
    links = {
        "neighbour": [struck],
        "stop": [struck | {"height_m": 1.0, "strength_N": 1e3}],
        "tie": [{"from": "left", "height_m": 1.0, "slack_m": 0.01, "stiffness_N_m": 1e6}],
    }
    runs = [load_case(name, keys) for name, keys in cases.items()]
    runs.append(load_case("overturning", ["solver.model=rigid", "contact.mu_static=0.6"]).with_values(links))
    filled = set()
    for row in run_chunk(lambda case: case, runs):
        assert row["status"] != "failed", row["reason"]
        filled |= {key for key in SCALARS if row[key] is not None}
    assert filled == set(SCALARS)


@pytest.mark.parametrize(("velocity", "largest"), [(0.5, 0.5), (-0.5, 0.5), (0.0, 0.0)])
def test_a_container_pushed_over_a_still_floor_slides_fastest_at_the_start(velocity, largest):
    # friction alone acts on it: v0 - mu g t
    pushed = ("motion.kind=none", f"initial.velocity_m_s={velocity}")
    keys = (*pushed, "solver.model=rigid", "solver.duration_s=1")
    (row,) = run_chunk(lambda name: load_case(name, keys), ["sliding"])
    assert row["max_slip_velocity_m_s"] == pytest.approx(largest, rel=1e-2, abs=1e-9)
