"""Tables: what is written reads back, and a spreadsheet computes nothing of it."""

import re
from pathlib import Path

import pytest

from fem.batch.table import fields_of, line_of

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("name", ["=1+1.csv", "@SUM(A1).csv", "-2+3.csv", "+1.csv", "-2+3", "=1"])
def test_a_name_that_a_spreadsheet_would_compute_is_made_text(name):
    line = line_of([1.0, name])
    assert line == f"1.0,'{name}"
    assert fields_of(line) == ["1.0", name]
    assert line_of(fields_of(line)) == line


def test_tables_are_written_in_one_place():
    written = [
        path for path in ROOT.rglob("fem/**/*.py") if re.search(r"csv\.(Dict)?[wW]riter", path.read_text())
    ]
    assert [path.name for path in written] == ["table.py"]


@pytest.mark.parametrize("value", [-1.5, (-0.5, 2.0), "-1e-05 2.0", "a=1", None, "-inf"])
def test_numbers_and_other_texts_stay_as_they_are(value):
    line = line_of([value, "x"])
    assert "'" not in line
    assert line_of(fields_of(line)) == line
