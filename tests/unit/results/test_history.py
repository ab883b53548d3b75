"""The history file: bits kept, valid at every moment, and honest about what it cannot read."""

import math
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fem.results.history import (
    HISTORY_COLUMNS,
    NUMBERS,
    History,
    HistoryWriter,
    add_analytic_rotation,
    read_history,
)

ROWS = np.random.default_rng(3).normal(size=(7, 20)) * 10.0 ** np.arange(-10, 10)
MODES = ["rest", "rock", "slide", "slide-rock", "rock", "rest", "overturned"]


def test_columns_are_the_documented_ones_in_their_order(tmp_path):
    with HistoryWriter(tmp_path / "history.csv") as writer:
        writer.append(ROWS, MODES)
    header = (tmp_path / "history.csv").read_text().splitlines()[0]
    assert header == (
        "time_s,base_displacement_m,base_velocity_m_s,base_acceleration_m_s2,rotation_rad,angular_velocity_rad_s,"
        "slip_m,uplift_m,centre_x_m,centre_z_m,normal_force_N,shear_force_N,kinetic_J,strain_J,potential_J,"
        "imbalance_J,mode,base_work_J,friction_J,contact_damping_J,material_damping_J"
    )


def test_numbers_come_back_to_the_last_bit(tmp_path):
    with HistoryWriter(tmp_path / "h.csv") as writer:
        writer.append(ROWS[:3], MODES[:3])
        writer.append(ROWS[3:], MODES[3:])
    history = read_history(tmp_path / "h.csv")
    assert history.values.tobytes() == ROWS.tobytes()
    assert history.modes == tuple(MODES)
    assert history["rotation_rad"].tolist() == ROWS[:, 4].tolist()
    assert len(history) == 7


def test_a_stack_has_three_columns_for_every_joint_behind_all_others(tmp_path):
    with HistoryWriter(tmp_path / "h.csv", joints=2) as writer:
        writer.append(np.hstack([ROWS, ROWS[:, :6]]), MODES)
    header = (tmp_path / "h.csv").read_text().splitlines()[0]
    assert header.endswith(
        "material_damping_J,joint_1_normal_N,joint_1_shear_N,joint_1_moment_Nm,joint_2_normal_N,joint_2_shear_N,"
        "joint_2_moment_Nm"
    )
    history = read_history(tmp_path / "h.csv")
    assert history.joints == 2 and history.modes == tuple(MODES)
    assert history["imbalance_J"].tolist() == ROWS[:, 15].tolist()
    assert history["base_work_J"].tolist() == ROWS[:, 16].tolist()
    assert history["joint_2_shear_N"].tolist() == ROWS[:, 4].tolist()
    with pytest.raises(KeyError, match="no column 'joint_3_shear_N'"):
        history["joint_3_shear_N"]


@given(st.lists(st.floats(allow_nan=False) | st.just(math.nan), min_size=20, max_size=20))
def test_every_double_survives_as_soon_as_it_is_appended(tmp_path_factory, row):
    path = tmp_path_factory.mktemp("h") / "h.csv"
    with HistoryWriter(path) as writer:
        writer.append(np.array([row]), ["rest"])
        assert read_history(path).values.tobytes() == np.array([row]).tobytes()


def test_a_killed_writer_leaves_whole_lines_and_at_most_a_torn_last_one(tmp_path):
    script = textwrap.dedent("""
        import sys
        from pathlib import Path
        import numpy as np
        from fem.results.history import NUMBERS, HistoryWriter
        writer = HistoryWriter(Path(sys.argv[1]))
        print("ready", flush=True)
        while True:
            writer.append(np.arange(50.0 * NUMBERS).reshape(50, -1), ["rock"] * 50)
    """)
    path = tmp_path / "h.csv"
    process = subprocess.Popen([sys.executable, "-c", script, str(path)], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"ready\n"
    while path.stat().st_size < 200_000:
        assert process.poll() is None
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    history = read_history(path)
    # every sample is one that was written, in its order: nothing is made up, nothing but the end is missing
    assert len(history) == path.read_bytes().count(b"\n") - 1 > 100
    counted = np.arange(NUMBERS) + float(NUMBERS) * (np.arange(len(history)) % 50)[:, None]
    assert np.array_equal(history.values, counted)


def test_wherever_a_file_is_torn_its_whole_lines_are_read_and_nothing_else(tmp_path):
    # A kill amid a write leaves any first part of it: every one is tried.
    path = tmp_path / "h.csv"
    with HistoryWriter(path) as writer:
        writer.append(ROWS[:2], MODES[:2])
        settled = writer.position
        writer.append(ROWS[2:5], MODES[2:5])
    data = path.read_bytes()
    for end in range(settled, len(data) + 1):
        path.write_bytes(data[:end])
        history = read_history(path)
        count = data[:end].count(b"\n") - 1
        assert len(history) == count
        assert history.values.tobytes() == ROWS[:count].tobytes()
        assert history.modes == tuple(MODES[:count])
    path.write_bytes(data[: settled + 40])
    with HistoryWriter(path, position=settled) as writer:  # as after --resume
        writer.append(ROWS[2:5], MODES[2:5])
    assert path.read_bytes() == data


def test_going_on_in_a_history_that_is_too_short_or_missing_is_refused(tmp_path):
    with HistoryWriter(tmp_path / "h.csv") as writer:
        writer.append(ROWS, MODES)
    for path in (tmp_path / "h.csv", tmp_path / "none.csv"):
        with pytest.raises(ValueError, match="ends before byte 99999"):
            HistoryWriter(path, position=99999)


def test_a_line_that_does_not_go_through_is_cut_off(tmp_path):
    resource = pytest.importorskip("resource")
    path = tmp_path / "h.csv"
    with HistoryWriter(path) as writer:
        writer.append(ROWS[:2], MODES[:2])
        limit = writer.position + 100  # less than one more line
    script = textwrap.dedent(f"""
        import resource, signal, sys
        from pathlib import Path
        import numpy as np
        from fem.results.history import HistoryWriter
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        writer = HistoryWriter(Path(sys.argv[1]), position={limit - 100})
        resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
        try:
            writer.append(np.full((3, 20), 1.0 / 3.0), ["rock"] * 3)
        except OSError as error:
            print(error.strerror)
    """)
    assert resource.RLIMIT_FSIZE is not None
    done = subprocess.run(
        [sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True
    )
    assert "File too large" in done.stdout
    assert path.stat().st_size == limit - 100
    assert len(read_history(path)) == 2


def test_unknown_columns_and_wrong_shapes_are_named(tmp_path):
    history = History(values=ROWS, modes=tuple(MODES))
    with pytest.raises(KeyError, match="no column 'rotation'; known: time_s"):
        history["rotation"]
    with pytest.raises(ValueError, match="20 columns"):
        History(values=ROWS[:, :19], modes=tuple(MODES))
    with HistoryWriter(tmp_path / "h.csv") as writer, pytest.raises(ValueError, match="20 columns"):
        writer.append(ROWS, MODES[:-1])
    assert len(HISTORY_COLUMNS) == 21


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not a history"),
        ("time,x\n1,2\n", "not a history"),
        (",".join(HISTORY_COLUMNS) + "\n1,2,rest\n", "line 2"),
    ],
)
def test_files_that_are_no_history_are_refused(tmp_path, text, words):
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(ValueError, match=words):
        read_history(tmp_path / "h.csv")


def test_the_rigid_block_stands_in_the_last_column_and_is_replaced_not_repeated(tmp_path):
    path, rotation = tmp_path / "history.csv", np.array([0.1, math.nan])
    rows = np.arange(2.0 * (NUMBERS + 3)).reshape(2, -1)
    with HistoryWriter(path, joints=1) as writer:
        writer.append(rows, ["rest", "rock"])
    for _ in range(2):
        add_analytic_rotation(path, rotation)
    history = read_history(path)
    assert history.numbers[-1] == "analytic_rotation_rad"
    assert np.array_equal(history["analytic_rotation_rad"], rotation, equal_nan=True)
    assert np.array_equal(history["joint_1_moment_Nm"], rows[:, -1])
    assert history.modes == ("rest", "rock")
    assert np.array_equal(history.values[:, :-1], rows)
    with pytest.raises(ValueError, match="3 rotations for 2 samples"):
        add_analytic_rotation(path, np.zeros(3))
