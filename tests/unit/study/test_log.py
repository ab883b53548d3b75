"""Tables and logs: what is written reads back, and a damaged row is computed again."""

from types import SimpleNamespace

import pytest

from fem.results.figures import RUN_COLUMNS
from fem.study.driver import LoggedRuns
from fem.study.table import line_of, row_of


def _logged(path, columns, rows, told=pytest.fail):
    """Rows of items that are their first column, in a log."""
    reporter = SimpleNamespace(warning=told)
    runner = SimpleNamespace(reporter=reporter, stop=lambda: False, rows=lambda *_: rows)
    runs = LoggedRuns(
        what="", path=path, columns=columns, key=lambda item: [item], ids=1, make=None, model_of=None
    )
    runs.run(runner, [[None]])
    return runs


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
