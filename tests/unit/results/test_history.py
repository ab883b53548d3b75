"""The history file: bits kept, valid at every moment, and honest about what it cannot read."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact.stepping.state import row_names
from fem.case.columns import ALWAYS, GROUPS, JOINTS, MODE, history_columns
from fem.results.history import HistoryWriter, add_analytic_rotation, read_history

COLUMNS = ALWAYS.names((0,))
NUMBERS = len(COLUMNS) - 1
ROWS = np.random.default_rng(3).normal(size=(7, 20)) * 10.0 ** np.arange(-10, 10)
MODES = ["rest", "rock", "slide", "slide-rock", "rock", "rest", "overturned"]


def test_columns_are_the_documented_ones_in_their_order_and_come_back_to_the_last_bit(tmp_path):
    path, rows = tmp_path / "history.csv", np.hstack([ROWS, ROWS[:, :6]])
    with HistoryWriter(path, (*COLUMNS, *JOINTS.names((1, 2)))) as writer:
        writer.append(rows[:3], MODES[:3])
        writer.append(rows[3:], MODES[3:])
    assert path.read_text().splitlines()[0] == (
        "time_s,base_displacement_m,base_velocity_m_s,base_acceleration_m_s2,rotation_rad,angular_velocity_rad_s,"
        "slip_m,uplift_m,centre_x_m,centre_z_m,normal_force_N,shear_force_N,kinetic_J,strain_J,potential_J,"
        "imbalance_J,mode,base_work_J,friction_J,contact_damping_J,material_damping_J,"
        "joint_1_normal_N,joint_1_shear_N,joint_1_moment_Nm,joint_2_normal_N,joint_2_shear_N,joint_2_moment_Nm"
    )
    history = read_history(path)
    assert history.samples.tobytes() == rows.tobytes()
    assert history.modes == tuple(MODES) and len(history.modes) == 7
    for column, name in {
        4: "rotation_rad",
        15: "imbalance_J",
        16: "base_work_J",
        24: "joint_2_shear_N",
    }.items():
        assert history[name].tolist() == rows[:, column].tolist()
    with pytest.raises(KeyError, match="no column 'joint_3_shear_N'; known: time_s"):
        history["joint_3_shear_N"]


def case_of(*, boxes=1, joints="bolted", vertical=False, crushing=False, restitution=None, **floor):
    """The tables of a case that decide on its columns."""
    turns = bool(floor.get("slope_percent")) and floor.get("motion_along") != "floor"
    return SimpleNamespace(
        container=SimpleNamespace(boxes=boxes, is_loose=joints == "loose"),
        floor=SimpleNamespace(is_slab=crushing),
        has_normal=vertical or turns,
        states_restitution=restitution is not None,
        **dict.fromkeys(("stop", "tie", "neighbour", "links"), ()),
    )


@pytest.mark.parametrize(
    ("boxes", "joints", "along", "vertical", "crushing", "restitution", "analytic"),
    [
        (1, "bolted", None, False, False, None, False),
        (1, "bolted", "horizontal", False, True, None, True),  # along a slope it moves normal to itself
        (2, "bolted", "floor", False, False, 0.95, False),
        (3, "bolted", "floor", True, True, 0.95, True),
        (2, "loose", "horizontal", False, False, 0.95, True),
        (3, "loose", None, True, True, None, False),
    ],
)
def test_crushing_impacts_vertical_motion_joints_boxes_and_rigid_block_follow_in_this_order(
    tmp_path, boxes, joints, vertical, along, crushing, restitution, analytic
):
    normal = vertical or along == "horizontal"
    of_box = ("rotation_rad", "slip_m", "opening_m", "x_m", "z_m")
    of_joint = ("normal_N", "shear_N", "moment_Nm")
    names = ["crushing_J"] * crushing + ["impact_J"] * (restitution is not None)
    names += [
        f"base_vertical_{name}" for name in ("displacement_m", "velocity_m_s", "acceleration_m_s2")
    ] * normal
    if joints == "loose":
        names += [f"box_{box}_{name}" for box in range(2, boxes + 1) for name in of_box]
    else:
        names += [f"joint_{joint}_{name}" for joint in range(1, boxes) for name in of_joint]
    tables = {"boxes": boxes, "joints": joints, "crushing": crushing, "restitution": restitution}
    case = case_of(**tables, vertical=vertical, slope_percent=2.0 if along else 0.0, motion_along=along)
    path, rows = tmp_path / "history.csv", np.hstack([ROWS, ROWS[:, : len(names)]])
    with HistoryWriter(path, history_columns(case)) as writer:
        writer.append(rows, MODES)
    if analytic:
        add_analytic_rotation(path, ROWS[:, 7])
    history = read_history(path)
    assert (history.joints, history.vertical) == ((boxes - 1) * (joints == "bolted"), normal)
    assert history.numbers[NUMBERS:] == (*names, *["analytic_rotation_rad"] * analytic)
    for column, name in enumerate(names):
        assert history[name].tolist() == ROWS[:, column].tolist()


def test_the_stepper_fills_every_column_but_time_floor_joints_and_rigid_block():
    declared = set(history_columns(case_of(boxes=3, joints="loose", crushing=True, restitution=0.95)))
    added = {name for name in declared if name.startswith("base_") and not name.endswith("_J")}
    assert set(row_names(3)) == declared - added - {"time_s", MODE}


def test_a_column_has_its_unit_in_its_name_and_no_name_is_declared_twice():
    columns = [column for group in GROUPS for column in group.columns]
    assert len({column.name for column in columns}) == len(columns)
    for column in columns:
        assert column.name == MODE or column.name.endswith("_" + column.unit.replace("/", "_"))


def test_the_rigid_block_is_the_last_column_and_is_replaced_not_repeated(tmp_path):
    path, rotation = tmp_path / "history.csv", np.array([0.1, math.nan])
    rows = np.arange(2.0 * (NUMBERS + 3)).reshape(2, -1)
    with HistoryWriter(path, (*COLUMNS, *JOINTS.names((1,)))) as writer:
        writer.append(rows, ["rest", "rock"])
    for _ in range(2):
        add_analytic_rotation(path, rotation)
    history = read_history(path)
    assert history.numbers[-1] == "analytic_rotation_rad"
    assert np.array_equal(history.samples, np.column_stack([rows, rotation]), equal_nan=True)
    assert history.modes == ("rest", "rock")
    with pytest.raises(ValueError, match="3 rotations for 2 samples"):
        add_analytic_rotation(path, np.zeros(3))


@given(st.lists(st.floats(allow_nan=False) | st.just(math.nan), min_size=20, max_size=20))
def test_every_double_survives_as_soon_as_it_is_appended(tmp_path_factory, row):
    path = tmp_path_factory.mktemp("h") / "h.csv"
    with HistoryWriter(path, COLUMNS) as writer:
        writer.append(np.array([row]), ["rest"])
        assert read_history(path).samples.tobytes() == np.array([row]).tobytes()


def test_wherever_a_file_is_torn_its_whole_lines_are_read_and_nothing_else(tmp_path):
    # A kill during a write leaves any first part of it: every one is tried.
    path = tmp_path / "h.csv"
    with HistoryWriter(path, COLUMNS) as writer:
        writer.append(ROWS[:2], MODES[:2])
        settled = writer.position
        writer.append(ROWS[2:4], MODES[2:4])
    data = path.read_bytes()
    for end in range(settled, len(data) + 1):
        path.write_bytes(data[:end])
        history = read_history(path)
        count = data[:end].count(b"\n") - 1
        assert len(history.modes) == count
        assert history.samples.tobytes() == ROWS[:count].tobytes()
        assert history.modes == tuple(MODES[:count])
    path.write_bytes(data[: settled + 40])
    with HistoryWriter(path, COLUMNS, position=settled) as writer:  # as after --resume
        writer.append(ROWS[2:4], MODES[2:4])
    assert path.read_bytes() == data


def test_a_history_that_is_too_short_or_missing_is_not_resumed(tmp_path):
    with HistoryWriter(tmp_path / "h.csv", COLUMNS) as writer:
        writer.append(ROWS, MODES)
    for path in (tmp_path / "h.csv", tmp_path / "none.csv"):
        with pytest.raises(ValueError, match="ends before byte 99999"):
            HistoryWriter(path, COLUMNS, position=99999)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not a history"),
        ("time,x\n1,2\n", "not a history"),
        (",".join(COLUMNS) + "\n1,2,rest\n", "line 2"),
    ],
)
def test_files_that_are_no_history_are_refused(tmp_path, text, words):
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(ValueError, match=words):
        read_history(tmp_path / "h.csv")
