"""The report of a sweep: every cell with its values and the command that runs it; that of a list: equal rows as one."""

import base64
import re
import shlex

import numpy as np
import pytest
from study_folders import sweep_folder

from fem.report import sweep_map
from fem.report.study_page import folded, sweep_report
from fem.report.sweep_map import map_data
from fem.results.errors import FolderError
from fem.study.sweep_table import open_sweep


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "outside.svg").write_text("<svg>outside</svg>")
    return sweep_folder(tmp_path / "my <b> sweep")


def column(data, name):
    found = next(one for one in data["columns"] if one["name"] == name)
    raw = base64.b64decode(found["values"])
    return np.frombuffer(raw, "u1" if found.get("words") else "<f4")


def test_cells_carry_their_outcomes_and_values(folder):
    data = map_data(open_sweep(folder), folder)
    words = [data["outcomes"][k]["name"] for k in column(data, "outcome")]
    assert words == ["rest", "rest", "slide", "rest", "overturned", "failed"]
    assert [axis["marks"] for axis in data["axes"]] == [[2.4, 4.0], [0.4]]
    assert data["marked"] == "the paper's example"
    np.testing.assert_allclose(column(data, "max_slip_m")[:5], 0.001 * np.arange(5), rtol=1e-6)
    assert np.isnan(column(data, "rotation_ratio")[5])
    assert words_in(data, "sure") == ["sure", "sure of the end", "unsure", "sure", "sure", "unsure"]
    assert words_in(data, "decided_by") == ["-", "-", "mu_kinetic start", "-", "-", "-"]
    assert not [one["name"] for one in data["columns"] if one["name"] == "impacts"]  # nothing was found of it


def words_in(data, name):
    names = next(one["names"] for one in data["columns"] if one["name"] == name)
    return [names[int(place)] for place in column(data, name)]


def test_the_command_of_a_cell_repeats_it(folder):
    data = map_data(open_sweep(folder), folder)
    words = shlex.split(data["command"])
    assert words == ["python", "-m", "fem", "run", str(folder / "base.toml")]
    assert [axis["key"] for axis in data["axes"]] == ["motion.peak_acceleration_m_s2", "contact.mu_static"]
    assert data["derived"] == [{"key": "contact.mu_kinetic", "values": [0.1, 0.2, 0.1, 0.2, 0.1, 0.2]}]


def test_names_stay_text_and_files_outside_the_folder_stay_out(folder):
    page = sweep_report(folder)
    assert "</script><b>" not in page
    unstyled = re.sub(r"<style>.*?</style>", "", page, flags=re.DOTALL)
    assert "outside" not in unstyled.replace("outside.svg", "")
    assert page.count("<script") == page.count("</script>") == 3


def test_more_cells_than_a_page_can_carry_are_refused_with_a_way_out(folder, monkeypatch):
    monkeypatch.setattr(sweep_map, "MOST_BYTES", 50)
    with pytest.raises(FolderError, match="6 cells are more than one page can carry"):
        sweep_report(folder)


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
    doubtful = ranked[1] | {"command": "run 4", "does": "may overturn"}
    assert folded([doubtful, *ranked[1:4]]) == ([doubtful], ranked[1:4])
