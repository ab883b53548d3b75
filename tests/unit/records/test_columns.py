"""Columns of numbers: what is understood, and one message for each way to be wrong."""

import os
from pathlib import Path

import numpy as np
import pytest

from fem.records.files import read_record
from fem.records.source import LARGEST_FILE, MOST_SAMPLES

G = 9.80665


def table(folder, text, **options):
    path = folder / "record.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_record(path, **{"unit": "m/s2", **options})


def only(record):
    (component,) = record.components
    return component


@pytest.mark.parametrize(
    "text",
    [
        "0,1.5\n0.5,-2\n1.25,3e0\n",
        "0;1.5\n0.5;-2\n1.25;3e0",
        "0 1.5\n0.5\t-2\n 1.25   +3.0D+00\n".replace("\t", "  "),
        "0\t1.5\n0.5\t-2\n1.25\t3.0d+00\n",
        "time,acceleration\n0,1.5\n0.5,-2\n1.25,3\n",
        "# a station\r\ntime_s;a_m_s2\r\n\r\n0;1.5\r\n0.5;-2 # the peak\r\n1.25;3.\r\n",
        "time (s)  acc (m/s^2)\n0 1.5\n0.5 -2\n1.25 3\n",
        "\ufefft [s], a [m/s²]\n0,1.5\n0.5,-2\n1.25,3\n",
        "0,1.5\r0.5,-2\r1.25,3\r",
        # decimal commas: between semicolons, tabs and blanks
        "Zeit;a\n0;1,5\n0,5;-2\n1,25;3\n",
        "Zeit\ta\n0,0\t1,5\n0,5\t-2,0\n1,25\t3,0\n",
        "0,0 1,5\n0,5 -2,0\n1,25 3,0\n",
        # several lines of header, in Latin-1 and UTF-16
        "Meßstation Görlitz\nZeit;a\ns;m/s²\n0;1,5\n0,5;-2\n1,25;3\n".encode("latin-1"),
        "Meßstation\r\nZeit\ta\r\n0,0\t1,5\r\n0,5\t-2,0\r\n1,25\t3,0\r\n".encode("utf-16"),
    ],
)
def test_two_columns_of_the_usual_forms_are_read(tmp_path, text):
    found = only(table(tmp_path, text))
    assert found.times.tolist() == [0.0, 0.5, 1.25]
    assert found.values.tolist() == [1.5, -2.0, 3.0]


def test_one_column_takes_its_interval_from_the_user(tmp_path):
    found = only(table(tmp_path, "# station\n1.5\n-2\n3\n", sample_interval=0.25))
    assert found.times.tolist() == [0.0, 0.25, 0.5] and found.values.tolist() == [1.5, -2.0, 3.0]


def test_three_columns_are_time_horizontal_and_vertical(tmp_path):
    record = table(tmp_path, "t [s]; H [g]; V [g]\n0;0,1;1\n1;0,2;2\n", unit=None)
    horizontal = record.component("horizontal", quantity="acceleration")
    vertical = record.component("vertical", quantity="acceleration")
    assert horizontal.values.tolist() == pytest.approx([0.1 * G, 0.2 * G])
    assert vertical.values.tolist() == pytest.approx([G, 2.0 * G])


@pytest.mark.parametrize(
    ("unit", "factor"), [("m/s2", 1.0), ("g", G), ("cm/s2", 0.01), ("gal", 0.01), ("mm/s2", 1e-3), ("m", 1.0)]
)
def test_units_are_those_given_whatever_the_header_leaves_out(tmp_path, unit, factor):
    found = only(table(tmp_path, "0,2\n1,-4\n", unit=unit))
    assert found.values.tolist() == pytest.approx([2.0 * factor, -4.0 * factor], rel=1e-15)
    assert found.quantity == ("displacement" if unit == "m" else "acceleration") and not found.unit_stated


@pytest.mark.parametrize(
    ("heading", "unit"),
    [
        ("time,acc (g)", "g"), ("time_s,a_g", "g"), ("t [s],a [Gal]", "gal"), ("t,a [cm/sec/sec]", "cm/s2"),
        ("t,a [CM/SEC^2]", "cm/s2"), ("t,a [cm s-2]", "cm/s2"), ("t,a (mm/s**2)", "mm/s2"), ("s,m/s2", "m/s2"),
        ("time_s,base_acceleration_m_s2", "m/s2"), ("Acceleration (gal)", "gal"), ("t,x [mm]", "mm"), ("t_s,x_m", "m"),
    ],
)  # fmt: skip
def test_units_of_the_header_need_no_other_word(tmp_path, heading, unit):
    found = only(table(tmp_path, f"{heading}\n0,1\n1,2\n", unit=None))
    assert found.unit == unit and found.unit_stated


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,1\n0.1,abc\n0.2,3\n", "line 2: not a number"),
        ("# c\nt,a\n0,1\n0.1,0.2g\n", "line 4: not a number"),
        ("0,1\n0.1,nan\n", "line 2: not a number"),
        ("0,1\n0.1,inf\n", "line 2: not a number"),
        ("0,1\n0.1,1_0\n", "line 2: not a number"),
        ("0,1\n0.1,1e999\n", "line 2: not a number, or too large"),
        ("0,1\n1e300,1\n", "line 2: not a number, or too large"),
        ("0,1\n,2\n", "line 2: not a number"),
        ("0,1\n0.1\n", "line 2: 2 columns are needed as in line 1, found 1"),
        ("0,1,5,6\n0.1,2,5,6\n", "line 1: 4 columns; a motion has one"),
        ("0;1,5\n0.1;2,5\n", "line 2: decimal commas and decimal points"),
        ("nan,1\n0.1,2\n", "line 1: not a number"),
        ("0,abc\n1,2\n2,3\n", "line 1: not a number"),
        ("t,a\n", "no numbers were found"),
        ("", "the file is empty"),
        (" \n\n", "the file is empty"),
        ("0,1\n", "two samples or more are needed, found 1"),
        ("0,1\n0.2,1\n0.1,1\n", "line 3: times must increase, but time 0.1 s is earlier"),
        ("0,1\n0.1,1\n0.1,1\n", "line 3: times must increase, but time 0.1 s occurs twice"),
        ("time,acc [g]\n0,1\n1,2\n", "file states 'g', but unit = 'm/s2' is given"),
        ("time_s,a_g\n0,1\n1,2\n", "file states 'g', but unit = 'm/s2' is given"),
        ("time (h), acc (m/s2)\n0,1\n1,2\n", "header gives times in 'h'; they must be in s, ms, us, min"),
        ("time (s) acc (Gal)\n0 1\n1 2\n", "file states 'gal', but unit = 'm/s2'"),
        ("t [s], a (m/s2), b (g)\n0,1\n1,2\n", "names more units than the 2 columns"),
        ("t [s],a [g]\ns,m/s2\n0,1\n1,2\n", "two units for column 2"),
        ("t,a [in/s2]\n0,1\n1,2\n", "header gives 'in/s2', which is not read"),
        ("1\n2\n3\n", "one column without times: give the interval as sample_interval_s"),
        (b"\xff\xfe\x00", "not a text file"),
        (b"0,1\x00\n1,2\n", "not a text file"),
    ],
)
def test_bad_tables_are_refused_by_line(tmp_path, text, words):
    with pytest.raises(ValueError, match=words):
        table(tmp_path, text)


@pytest.mark.parametrize("step", ["1e-9", "100"])
def test_an_interval_that_no_sensor_has_is_refused(tmp_path, step):
    times = [f"{number * float(step):.12g},{number % 2}" for number in range(20)]
    with pytest.raises(
        ValueError, match=r"the samples have an interval of .* s; it must be between 1e-06 and 10 s"
    ):
        table(tmp_path, "\n".join(times))


def test_a_unit_that_nobody_states_is_not_guessed(tmp_path):
    with pytest.raises(ValueError, match='does not state the unit of its values; state it as unit = "g"'):
        table(tmp_path, "t,a\n0,1\n1,2\n", unit=None)
    with pytest.raises(ValueError, match="unknown unit 'ft'"):
        table(tmp_path, "0,1\n1,2\n", unit="ft")


def test_an_interval_is_for_one_column_only(tmp_path):
    with pytest.raises(ValueError, match="sample_interval_s is for a file of one column, and 2 were found"):
        table(tmp_path, "0,1\n1,2\n", sample_interval=0.01)


def test_no_message_quotes_what_is_in_the_file(tmp_path):
    for text in ("secret\n0,1\nsecret,2\n", "root:secret:0\n", "1 secret\n", "secret,secret\n1,2,secret\n"):
        with pytest.raises(ValueError, match=r"record\.csv") as found:
            table(tmp_path, text)
        assert "secret" not in str(found.value)


def test_missing_files_folders_and_oversized_files_are_refused_before_reading(tmp_path):
    os.mkfifo(tmp_path / "endless")
    pipe = "is a device or a pipe, not a regular file"
    for path, reason in (
        (tmp_path / "none.csv", "does not exist or is not a file"),
        (tmp_path, "is a folder, not a file"),
        (tmp_path / "endless", pipe),
        (Path("/dev/zero"), pipe),
    ):
        with pytest.raises(ValueError, match=reason):
            read_record(path)
    large = tmp_path / "large.csv"
    with large.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)  # sparse: takes no room
    with pytest.raises(ValueError, match="larger than 33"):
        read_record(large)


def test_files_of_the_kernel_that_never_end_are_taken_at_the_size_they_state():
    with pytest.raises(ValueError, match="the file is empty"):
        read_record(Path("/proc/self/status"))


@pytest.mark.parametrize("content", ["1 " * 501, "0,1\n" + "1," * 600 + "\n", "1\n" * (MOST_SAMPLES + 1)])
def test_lines_that_no_motion_has_are_refused(tmp_path, content):
    with pytest.raises(ValueError, match="at most 1000000 lines of 1000 characters"):
        table(tmp_path, content, sample_interval=0.01)


def test_values_are_arrays_of_numbers(tmp_path):
    found = only(table(tmp_path, "0,1\n1,2\n"))
    assert found.values.dtype == np.float64 and found.step == 1.0
