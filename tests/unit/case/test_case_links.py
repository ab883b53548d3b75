"""[[stop]] and [[tie]] of a case file: reading, refusing, changing and writing them."""

import pytest

from fem.case.case import CaseError, case_hash, load_case, read_case, to_toml
from fem.case.tables.unknown_inputs import ranges_of
from fem.case.template import case_template
from fem.case.uncertainty import as_changed

STOP = {"side": "right", "height_m": 0.1, "gap_m": 0.05, "stiffness_N_m": 1e8}
TIE = {"from": "left", "height_m": 0.5, "slack_m": 0.01, "stiffness_N_m": 1e6}
RIGID = load_case("rocking", ["solver.model=rigid"])


def held(**keys):
    """The case with one stop and one tie, with keys changed in both as far as they have them."""
    rows = [{key: keys.get(key, value) for key, value in row.items()} for row in (STOP, TIE)]
    rest = {key: value for key, value in keys.items() if key not in STOP | TIE}
    return RIGID.with_values({"stop": [rows[0] | rest], "tie": [rows[1]]})


def test_stops_and_ties_are_read_written_and_are_part_of_the_hash():
    case = held(mu=0.3)
    assert [(one.side, one.height_m) for one in case.links] == [("right", 0.1), ("left", 0.5)]
    for text in (to_toml(case), case_template(case)):
        again = read_case(text)
        assert again.links == case.links
        assert case_hash(again) == case_hash(case)
    assert case_hash(case) != case_hash(RIGID)
    assert case_hash(case.with_values({"stop": [], "tie": []})) == case_hash(RIGID)


def test_a_key_of_a_stop_is_that_of_all_stops():
    case = RIGID.with_values({"stop": [STOP, {**STOP, "side": "left"}]}).with_values({"stop.gap_m": 0.2})
    assert [one.gap_m for one in case.stop] == [0.2, 0.2]
    with pytest.raises(CaseError, match=r"no \[\[tie\]\] to change"):
        case.with_values({"tie.slack_m": 0.1})


def test_the_rows_given_stay_as_they_are():
    rows = [dict(STOP)]
    assert RIGID.with_values({"stop": rows, "stop.gap_m": 0.3}).stop[0].gap_m == 0.3
    assert rows == [STOP]
    with pytest.raises(CaseError, match=r"must be 0 to 20 tables"):
        RIGID.with_values({"stop": [1.0], "stop.gap_m": 0.3})


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({"gap_m": -0.01}, r"stop 1: gap_m must be between 0 and .* would overlap at the start"),
        ({"strength_N": 0.0}, "stop 1: strength_N must be .* holds nothing"),
        ({"height_m": 4.5}, "stop. height_m must be at most the height of the container, 4 m, got 4.5 m"),
        ({"from": "top"}, 'tie 1: from must be "left" or "right"'),
        ({"stiffness_N_m": 0.0}, "tie 1: stiffness_N_m must be"),
        ({"restitution": 0.5, "damping_ratio": 1.0}, "restitution and damping_ratio say the same"),
        ({"heigth_m": 1.0}, "unknown key 'heigth_m'; did you mean 'height_m'"),
    ],
)
def test_what_holds_nothing_or_overlaps_is_refused(keys, reason):
    with pytest.raises(CaseError, match=reason):
        held(**keys)


BESIDE = {"side": "right", "gap_m": 0.1, "stiffness_N_m": 1e8}
STRAP = {"from": "right", "height_m": 0.5, "stiffness_N_m": 1e6}


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({"to": "neighbour"}, 'tie 1: to must be "floor" or "wall", got the text "neighbour"'),
        ({"to_height_m": 0.5}, "tie 1: 'to_height_m' is no longer there; ties run to the floor or to a wall"),
        ({"neighbour": 2}, r"neighbour must be the number of a \[\[neighbour\]\]; the case has 1"),
        ({"to": "wall"}, 'to must be "floor" on the right of the container: neighbour 1 stands before'),
        ({"neighbour": 1, "height_m": 0.9}, "height_m must be at most the height of neighbour 1, 0.7"),
        ({"strength_N": 0.0}, "tie 1: strength_N must be .* holds nothing"),
    ],
)
def test_a_tie_in_a_row_runs_to_the_floor_or_to_a_wall(keys, reason):
    low = {**BESIDE, "boxes": 1, "height_m": 0.7, "centroid_m": 0.35}
    with pytest.raises(CaseError, match=reason):
        RIGID.with_values({"neighbour": [low], "tie": [STRAP | keys]})


def test_what_is_no_row_of_tables_is_refused():
    for wrong in ("right", {"side": "right"}, [1.0]):
        with pytest.raises(CaseError, match=r"must be 0 to 20 tables \[\[stop\]\]"):
            RIGID.with_values({"stop": wrong})


def test_gap_stiffness_and_friction_are_unknown_of_different_stops_in_proportion():
    found = {one.key: one.ends for one in ranges_of(held(mu=0.3), 1e9)}
    assert found["stop.gap_m"] == (0.04, 0.06)
    assert found["stop.stiffness_N_m"] == (5e7, 2e8)
    assert found["stop.mu"] == (0.15, 0.6)
    assert found["tie.slack_m"] == (0.008, 0.012)
    assert found["tie.stiffness_N_m"] == (5e5, 2e6)
    unlike = RIGID.with_values({"stop": [STOP, {**STOP, "side": "left", "gap_m": 0.2}]})
    found = {one.key: one.ends for one in ranges_of(unlike, 1e9)}
    assert found["stop.gap_m"] == (0.16, 0.24)  # of the wider one
    assert "stop.stiffness_N_m" in found
    narrow = unlike.with_values(as_changed(unlike, {"stop.gap_m": 0.16, "stop.stiffness_N_m": 5e7}))
    assert [(one.side, one.gap_m, one.stiffness_N_m) for one in narrow.stop] == [
        ("right", 0.04, 5e7),
        ("left", 0.16, 5e7),
    ]
    assert not {one.key for one in ranges_of(RIGID, 1e9)} & {"stop.gap_m", "tie.slack_m", "stop.mu"}
    stated = held().with_values({"uncertainty.stop_gap_m": [0.0, 0.1]})
    assert {one.key: one.ends for one in ranges_of(stated, 1e9)}["stop.gap_m"] == (0.0, 0.1)
