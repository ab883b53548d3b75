"""What a summary keeps to whatever it says; what it says is in `tests/said/results.txt`."""

from dataclasses import replace

import pytest
from typed_results import RESULT, changed, changes_asked

from fem.run.summary import brief_summary, plain_summary
from fem.run.warnings import warnings_for


def test_no_text_is_wide_or_long_or_calls_a_run_safe_or_verified(tmp_path):
    for asked in changes_asked():
        result, case = changed(asked)
        whole = plain_summary(replace(result, warnings=tuple(warnings_for(result, case))), folder=tmp_path)
        assert not any(word in whole.lower() for word in ("safe", "verified", "stable"))
        assert max(len(line) for line in whole.splitlines() if str(tmp_path) not in line) <= 80
        assert len(brief_summary(result, folder=tmp_path).splitlines()) <= 40


@pytest.mark.parametrize("name", ["short", "a folder with words", "long-" * 40])
def test_summary_says_what_to_open_with_unbroken_paths(tmp_path, name):
    folder = tmp_path / name
    (folder / "fields").mkdir(parents=True)
    (folder / "fields" / "run.pvd").write_text("")
    text = plain_summary(RESULT, folder=folder)
    for file in ("fields/run.pvd", "history.csv", "run.json"):
        assert str(folder / file) in text
