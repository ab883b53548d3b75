"""How often a run keeps its fields where nobody says it."""

import pytest

from fem.case.case import load_case
from fem.case.files import CASES
from fem.cli.check import preview_of
from fem.model.frames import INTERVALS, MOST_BYTES, frame_bytes, frame_interval


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
