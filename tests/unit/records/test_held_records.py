"""A record is read once as long as its file stays as it is."""

import os

import pytest

from fem.records.files import read_record
from fem.records.record import RecordError


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
