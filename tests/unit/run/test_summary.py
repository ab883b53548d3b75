"""What a summary keeps to whatever it says; what it says is in `tests/said/results.txt`."""

import pytest
from typed_results import RESULT

from fem.run.summary import plain_summary


@pytest.mark.parametrize("name", ["short", "a folder with words", "long-" * 40])
def test_summary_says_what_to_open_with_unbroken_paths(tmp_path, name):
    folder = tmp_path / name
    (folder / "fields").mkdir(parents=True)
    (folder / "fields" / "run.pvd").write_text("")
    text = plain_summary(RESULT, folder=folder)
    for file in ("fields/run.pvd", "history.csv", "run.json"):
        assert str(folder / file) in text
