"""Reports of ensembles and response curves: the answer first, then figures, request, points, how to repeat."""

import json

import pytest
from study_folders import ensemble_folder, response_folder

from fem.report.study_page import ensemble_report, folded, response_report
from fem.results.errors import FolderError

MADE = {"ensemble": (ensemble_folder, ensemble_report), "response": (response_folder, response_report)}


@pytest.mark.parametrize("kind", MADE)
def test_an_unfinished_one_is_refused_with_the_way_out(kind, tmp_path):
    folder = MADE[kind][0](tmp_path)
    (folder / f"{kind}.json").write_text(json.dumps({"status": "running", "asked": "ab"}))
    with pytest.raises(FolderError, match="not finished; continue it with --resume"):
        MADE[kind][1](folder)


def test_equal_containers_are_one_row_and_those_that_rest_stand_apart():
    outcomes = ("overturned", "rest", "rest", "rest", "rest")
    ranked = [
        {"name": f"C{k}", "command": f"run {k % 4}", "tag": "", "line": k + 2, "count": 1, "outcome": outcome}
        for k, outcome in enumerate(outcomes)
    ]
    ranked[4]["command"] = "run 3"
    moving, resting = folded(ranked)
    assert [row["name"] for row in moving] == ["C0"]
    assert [row["name"] for row in resting] == ["C1", "C2", "C3 and 1 alike"]
    assert resting[-1]["line"] == "5, 6" and resting[-1]["count"] == 2
    assert folded(ranked[:3]) == (ranked[:3], []) and folded(ranked[1:4]) == (ranked[1:4], [])
