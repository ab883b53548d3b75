"""Tables and logs: what is written reads back, a spreadsheet computes nothing of it, a removed log ends the study."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from fem.results.errors import FolderLostError
from fem.results.figures import RUN_COLUMNS, types_of
from fem.site.result import RunKey
from fem.site.runs import RunRows
from fem.study.driver import LoggedRuns
from fem.study.table import fields_of, line_of, row_of


def _logged(path, columns, rows, told=pytest.fail):
    """Rows of items that are their first column, in a log."""
    reporter = SimpleNamespace(warning=told)
    runner = SimpleNamespace(reporter=reporter, stop=lambda: False, rows=lambda *_: rows)
    runs = LoggedRuns(
        what="", path=path, columns=columns, key=lambda item: [item], ids=1, make=None, model_of=None
    )
    runs.run(runner, [[None]])
    return runs


@pytest.mark.parametrize("name", ["=1+1.csv", "@SUM(A1).csv", "-2+3.csv", "+1.csv", "-2+3", "=1"])
def test_a_name_that_a_spreadsheet_would_compute_is_made_text(name):
    line = line_of([1.0, name])
    assert line == f"1.0,'{name}"
    assert fields_of(line) == ["1.0", name]
    assert line_of(fields_of(line)) == line


@pytest.mark.parametrize("value", [-1.5, (-0.5, 2.0), "-1e-05 2.0", "a=1", None, "-inf"])
def test_numbers_and_other_texts_stay_as_they_are(value):
    line = line_of([value, "x"])
    assert "'" not in line
    assert line_of(fields_of(line)) == line


def test_rows_are_not_added_to_a_log_that_was_removed(tmp_path):
    """The study ends with the first row after that, not when all are computed."""

    def rows():
        yield [1], [{}]
        (tmp_path / "rows.csv").unlink()
        yield [2], [{}]

    with pytest.raises(FolderLostError, match="removed during the run"):
        _logged(tmp_path / "rows.csv", {"a": int}, rows())


@pytest.mark.parametrize("line", ["2", "2,0.5,7", "2,fast", "x,0.5", "", "\0,1", "2,nan", "2,-inf"])
def test_a_damaged_row_is_left_out_and_told(tmp_path, line):
    path, told = tmp_path / "rows.csv", []
    path.write_text(f"a,b\n1,0.5\n{line}\n3,1.5\n4,")
    runs = _logged(path, {"a": int, "b": float}, [([2], [{"b": 0.25}])], told.append)
    assert runs.lines == {(1,): "1,0.5", (3,): "3,1.5", (2,): "2,0.25"}
    assert path.read_text() == "a,b\n1,0.5\n3,1.5\n2,0.25\n"
    assert told == [f"{path}: damaged rows, which are computed again: 1"]


def test_a_row_reads_back_with_the_types_of_its_columns():
    samples = {str: "-rock", int: 3, float: 0.1 + 0.2, bool: False, tuple: (0.1, -2.5e-17)}
    assert {*RUN_COLUMNS.values()} == {*samples}
    row = {name: samples[kind] for name, kind in RUN_COLUMNS.items()}
    for values in (row, dict.fromkeys(RUN_COLUMNS)):
        assert row_of(RUN_COLUMNS, line_of(values.values())) == values


def test_the_columns_of_a_class_have_the_types_of_its_fields():
    columns = types_of(RunKey)
    assert [columns[name] for name in ("stage", "motion", "building_period_s")] == [str, int, float]


def test_a_row_of_a_stage_that_a_site_does_not_have_is_none_of_its_runs():
    key = RunKey(
        motion=1,
        vertical_sign=0,
        model="rigid",
        mu_static=0.4,
        mu_kinetic=0.2,
        mass="full",
        elevation="width",
    )
    rows = RunRows()
    rows.rest(key)
    with pytest.raises(ValueError, match="not in tuple"):
        rows.rest(replace(key, stage="later"))
    assert list(rows.runs) == [key]
