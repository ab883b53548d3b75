"""Columns of numbers: what is understood; a file is read once as long as it stays as it is."""

import os
from pathlib import Path

import pytest

from fem.records.files import read_record
from fem.records.record import RecordError


def table(folder, text, **options):
    path = folder / "record.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_record(path, **{"unit": "m/s2", **options})


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
    (found,) = table(tmp_path, text).components
    assert found.times.tolist() == [0.0, 0.5, 1.25]
    assert found.values.tolist() == [1.5, -2.0, 3.0]


def test_no_message_quotes_what_is_in_the_file(tmp_path):
    for text in ("secret\n0,1\nsecret,2\n", "root:secret:0\n", "1 secret\n", "secret,secret\n1,2,secret\n"):
        with pytest.raises(ValueError, match=r"record\.csv") as found:
            table(tmp_path, text)
        assert "secret" not in str(found.value)


def test_files_of_the_kernel_that_never_end_are_taken_at_the_size_they_state():
    with pytest.raises(ValueError, match="the file is empty"):
        read_record(Path("/proc/self/status"))


def test_a_file_is_read_again_only_when_it_changed(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("0.0,1.0\n0.1,2.0\n")
    first = read_record(path, unit="g")
    assert read_record(path, unit="g") is first
    assert read_record(path, unit="m/s2") is not first
    path.write_text("0.0,1.0\n0.1,3.0\n")
    os.utime(path, ns=(1, 1))  # of the same size; a clock may be too coarse to tell two writings apart
    assert read_record(path, unit="g").components[0].readings[1] == 3.0
    path.unlink()
    with pytest.raises(RecordError, match="does not exist"):
        read_record(path, unit="g")
