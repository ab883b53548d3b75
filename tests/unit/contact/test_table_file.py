"""Reading motion tables: what is understood, and one message for each way to be wrong."""

import numpy as np
import pytest

from contact.motion.table_file import LARGEST_FILE, read_motion_table


def table(folder, text, **options):
    path = folder / "record.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_motion_table(path, **{"quantity": "acceleration", "unit": "m/s2", **options})


@pytest.mark.parametrize(
    "text",
    [
        "0,1.5\n0.5,-2\n1.25,3e0\n",
        "0;1.5\n0.5;-2\n1.25;3e0",
        "0 1.5\n0.5\t-2\n 1.25   +3.0D+00\n",
        "time,acceleration\n0,1.5\n0.5,-2\n1.25,3\n",
        "# a station\r\ntime_s;a_m_s2\r\n\r\n0;1.5\r\n0.5;-2 # the peak\r\n1.25;3.\r\n",
        "time (s)  acc (m/s^2)\n0 1.5\n0.5 -2\n1.25 3\n",
        "\ufefft [s], a [m/s²]\n0,1.5\n0.5,-2\n1.25,3\n",
    ],
)
def test_tables_of_the_usual_forms_are_read(tmp_path, text):
    motion = table(tmp_path, text)
    assert motion.times.tolist() == [0.0, 0.5, 1.25]
    assert motion.values.tolist() == [1.5, -2.0, 3.0]


def test_values_are_converted_and_scaled_to_si(tmp_path):
    motion = table(tmp_path, "time,acc (g)\n0,0.1\n1,-0.2\n", unit="g", scale=2.0)
    assert motion.values == pytest.approx(np.array([0.2, -0.4]) * 9.80665, rel=1e-15)
    moved = table(tmp_path, "t_s,x_m\n0,0.1\n1,-0.2\n", unit="m", quantity="displacement", scale=0.5)
    assert moved.values.tolist() == [0.05, -0.1] and moved.quantity == "displacement"


def test_baseline_is_passed_on(tmp_path):
    motion = table(tmp_path, "0,1\n1,1\n2,1\n", baseline="mean")
    assert motion.peak_acceleration == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,1\n0.1,abc\n0.2,3\n", "line 2: 'abc' is not a number"),
        ("# c\nt,a\n0,1\n0.1,0.2g\n", "line 4: '0.2g' is not a number"),
        ("0,1\n0.1,nan\n", "line 2: 'nan' is not a number"),
        ("0,1\n0.1,inf\n", "line 2: 'inf' is not a number"),
        ("0,1\n0.1,1_0\n", "line 2: '1_0' is not a number"),
        ("0,1\n0.1,1e999\n", "line 2: '1e999' is too large"),
        ("0,1\n1e300,1\n", "line 2: '1e300' is too large"),
        ("0,1\n,2\n", "line 2: '' is not a number"),
        ("0,1\n0.1\n", "line 2: two columns are needed, time and value, found 1"),
        ("0,1,5\n0.1,2,5\n", "line 1: two columns are needed, time and value, found 3"),
        ("0;1,5\n0,1;2,5\n", "line 1: '1,5' is not a number"),
        ("t,a\nu,b\n0,1\n1,2\n", "line 2: 'u' is not a number"),
        ("0,abc\n1,2\n2,3\n", "line 1: 'abc' is not a number"),
        ("t,a\n", "two samples or more are needed, found 0"),
        ("", "two samples or more are needed, found 0"),
        ("0,1\n", "two samples or more are needed, found 1"),
        ("0,1\n0.2,1\n0.1,1\n", "record.csv: .*is earlier than"),
        ("0,1\n0.1,1\n0.1,1\n", "record.csv: .*occurs twice"),
        ("time,acc [g]\n0,1\n1,2\n", "header gives 'g', but 'm/s2' is needed"),
        ("time_s,a_g\n0,1\n1,2\n", "header gives 'g', but 'm/s2' is needed"),
        ("time (ms), acc (m/s2)\n0,1\n1,2\n", "header gives 'ms', but 's' is needed"),
        ("time (s) acc (Gal)\n0 1\n1 2\n", "header gives 'gal', but 'm/s2' is needed"),
        ("time, acc (m/s2), acc (g)\n0,1\n1,2\n", "header gives 'm/s2', but 's' is needed"),
        (b"\xff\xfe\x00\x01", "not a text file"),
        (b"0,1\x00\n1,2\n", "not a text file"),
    ],
)
def test_bad_tables_are_refused_by_line(tmp_path, text, words):
    with pytest.raises(ValueError, match=words):
        table(tmp_path, text)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"unit": "m"}, "unit 'm' measures displacement, but the quantity is acceleration"),
        ({"quantity": "displacement", "unit": "g"}, "unit 'g' measures acceleration"),
        ({"unit": "cm/s2"}, "unknown unit 'cm/s2'"),
        ({"scale": float("nan")}, "scale must be finite"),
    ],
)
def test_units_that_do_not_fit_are_refused(tmp_path, options, words):
    with pytest.raises(ValueError, match=words):
        table(tmp_path, "0,1\n1,2\n", **options)


def test_missing_files_folders_and_oversized_files_are_refused_before_reading(tmp_path):
    options = {"quantity": "acceleration", "unit": "m/s2"}
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(ValueError, match="does not exist or is not a file"):
            read_motion_table(path, **options)
    large = tmp_path / "large.csv"
    with large.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)  # sparse: takes no room
    with pytest.raises(ValueError, match="may have at most 64 MB"):
        read_motion_table(large, **options)
