"""Tables and logs: what is written reads back, and a damaged row is computed again."""

from types import SimpleNamespace

import pytest

from fem.results.figures import RUN_COLUMNS
from fem.study.driver import LoggedRuns
from fem.study.table import line_of, row_of


def _logged(path, columns, rows, told=pytest.fail, items=(1, 2), **more):
    """Rows of items that are their first column, in a log."""
    reporter = SimpleNamespace(warning=told)
    runner = SimpleNamespace(reporter=reporter, stop=lambda: False, rows=lambda *_: rows)
    one = {"what": "", "path": path, "columns": columns, "key": lambda item: [item], "ids": 1}
    runs = LoggedRuns(**one | {"make": None, "model_of": None} | more)
    runs.run(runner, [items])
    return runs


@pytest.mark.parametrize("line", ["2", "2,0.5,7", "2,fast", "x,0.5", "", "\0,1", "2,nan", "2,-inf"])
def test_a_damaged_row_is_left_out_and_told(tmp_path, line):
    path, told = tmp_path / "rows.csv", []
    path.write_text(f"a,b\n1,0.5\n{line}\n3,1.5\n4,")
    runs = _logged(path, {"a": int, "b": float}, [([2], [{"b": 0.25}])], told.append, (1, 2, 3))
    assert runs.lines == {(1,): "1,0.5", (3,): "3,1.5", (2,): "2,0.25"}
    assert path.read_text() == "a,b\n1,0.5\n3,1.5\n2,0.25\n"
    assert told == [f"{path}: damaged rows, which are computed again: 1"]


def test_a_row_that_says_otherwise_of_what_was_run_is_computed_again(tmp_path):
    """What tells runs apart agrees, what they are made of does not; no run is the seventh, nor of another value."""
    path, told, columns = tmp_path / "rows.csv", [], {"of": str, "a": int, "mu": float, "b": float}
    path.write_text("of,a,mu,b\nx,1,0.3,0.5\nx,2,0.4,0.5\nx,7,0.7,0.5\ny,2,0.3,0.5\n")
    made = {"ids": 2, "of": "x,", "key": lambda item: ("x", item, 0.3)}
    runs = _logged(path, columns, [([2], [{"b": 0.25}])], told.append, **made)
    assert runs.lines == {("x", 1): "x,1,0.3,0.5", ("x", 2): "x,2,0.3,0.25"}
    assert path.read_text() == "of,a,mu,b\nx,1,0.3,0.5\ny,2,0.3,0.5\nx,2,0.3,0.25\n"
    assert told == [f"{path}: rows that say otherwise than this study, which are left out: 2"]


def test_a_row_reads_back_with_the_types_of_its_columns():
    samples = {str: "-rock", int: 3, float: 0.1 + 0.2, bool: False, tuple: (0.1, -2.5e-17)}
    assert {*RUN_COLUMNS.values()} == {*samples}
    row = {name: samples[kind] for name, kind in RUN_COLUMNS.items()}
    for values in (row, dict.fromkeys(RUN_COLUMNS)):
        assert row_of(RUN_COLUMNS, line_of(values.values())) == values
