"""The report of a sweep: every cell with its values and the command that runs it; unfinished sweeps and refusals."""

import base64
import json
import re
import shlex

import numpy as np
import pytest
from cases import HARMONIC

from fem.__main__ import main
from fem.report import sweep_map
from fem.report.study_page import sweep_report
from fem.report.sweep_map import map_data
from fem.results.errors import FolderError
from fem.study.sweep_table import BAND, FOUND, WIDTH, open_sweep

SPEED, MU = "motion.peak_acceleration_m_s2", "contact.mu_static"
BASE = HARMONIC.replace("amplitude_m = 0.05", "peak_acceleration_m_s2 = 4.0") + '[solver]\nmodel = "rigid"\n'


@pytest.fixture
def folder(tmp_path):
    """A finished sweep of 3 x 2 cells: rest, slide, overturned; a failed one; one unsure."""
    place = tmp_path / "my <b> sweep"
    place.mkdir()
    axes = [
        {"key": SPEED, "values": [1.0, 4.5, 20.0], "scale": "list", "unit": "m/s2"},
        {"key": MU, "values": [0.2, 0.4], "scale": "list", "unit": ""},
    ]
    info = {
        "status": "completed",
        "sweep": "boxes",
        "title": "</script><b>",
        "case": "seed_stack",
        "model": "rigid",
        "axes": axes,
        "derived": {"contact.mu_kinetic": f"0.5 * {MU}"},
        "cells": 6,
        "rows": 6,
        "held": "with mu_k = mu_s/2 falling at once",
        "unsure": 2,
        "sure": {"sure": 3, "regime unsure": 1, "unsure": 2},
        "decided_by": {"contact.mu_kinetic": 1, "motion.start": 1},
        "left_out": "pairs",
        "perturbed": 2,
        "copies": 7,
        "maps": ["../outside.svg"],
        "sweep_hash": "ab" * 32,
        "versions": {"unanchored": "0.1.0"},
    }
    (place / "sweep.json").write_text(json.dumps(info))
    (place / "base.toml").write_text(BASE)
    (tmp_path / "outside.svg").write_text("<svg>outside</svg>")
    columns = ["cell", SPEED, MU, "contact.mu_kinetic", *FOUND, *BAND, WIDTH + SPEED, WIDTH + MU]
    outcomes = ["rest", "rest", "slide", "rest", "overturned", ""]
    lines = [",".join(columns)]
    for cell, outcome in enumerate(outcomes):
        row = dict.fromkeys(columns, "")
        row |= {
            "cell": cell,
            SPEED: axes[0]["values"][cell // 2],
            MU: axes[1]["values"][cell % 2],
            "contact.mu_kinetic": 0.5 * axes[1]["values"][cell % 2],
            "status": "completed" if outcome else "failed",
            "outcome": outcome,
            "reason": "" if outcome else "no <b>balance",
            "rotation_ratio": 0.01 * cell if outcome else "",
            "max_slip_m": 0.001 * cell if outcome else "",
            "unsure": "true" if cell in (2, 5) else "false",
            "sure": ("sure", "regime unsure", "unsure", "sure", "sure", "unsure")[cell],
            "decided_by": "contact.mu_kinetic motion.start" if cell == 2 else "",
        }
        lines.append(",".join(str(row[name]) for name in columns))
    (place / "table.csv").write_text("\n".join(lines) + "\n")
    return place


def column(data, name):
    found = next(one for one in data["columns"] if one["name"] == name)
    raw = base64.b64decode(found["values"])
    return np.frombuffer(raw, "u1" if found.get("words") else "<f4")


def test_cells_carry_their_outcomes_and_values(folder):
    data = map_data(open_sweep(folder), folder)
    words = [data["outcomes"][k]["name"] for k in column(data, "outcome")]
    assert words == ["rest", "rest", "slide", "rest", "overturned", "failed"]
    assert [axis["marks"] for axis in data["axes"]] == [[2.4, 4.0], [0.4]] and data[
        "marked"
    ] == "the paper's example"
    np.testing.assert_allclose(column(data, "max_slip_m")[:5], 0.001 * np.arange(5), rtol=1e-6)
    assert np.isnan(column(data, "rotation_ratio")[5])
    assert words_in(data, "sure") == ["sure", "regime unsure", "unsure", "sure", "sure", "unsure"]
    assert words_in(data, "decided_by") == ["-", "-", "mu_kinetic start", "-", "-", "-"]
    assert not [one["name"] for one in data["columns"] if one["name"] == "impacts"]  # nothing was found of it


def words_in(data, name):
    names = next(one["names"] for one in data["columns"] if one["name"] == name)
    return [names[int(place)] for place in column(data, name)]


def test_the_page_says_what_is_held_and_what_decides(folder):
    page = sweep_report(folder)
    assert "with mu_k = mu_s/2 falling at once" in page
    assert (
        "(<code>regime unsure</code>), 1: no copy" in page and "<strong>unsure</strong>, 2: whether" in page
    )
    assert "Unsure cells are decided by kinetic friction (1), start (1)." in page
    assert "Left out: pairs." in page


def test_what_destroyed_a_corner_is_not_listed_as_overturned(folder):
    table = (folder / "table.csv").read_text()
    (folder / "table.csv").write_text(
        table.replace("overturned", "invalid").replace("failed,,no", "completed,rest,no")
    )
    page = sweep_report(folder)
    assert "first destroyed a corner at" in page and "(a corner destroyed)</td>" in page
    assert "first overturned at 2" not in page


def test_a_folder_of_before_still_opens(folder):
    """Its table has no columns `sure` and `decided_by`, and its sweep.json no counts of them."""
    header, *rows = (line.split(",") for line in (folder / "table.csv").read_text().splitlines())
    kept = [k for k, name in enumerate(header) if name not in ("sure", "decided_by")]
    lines = [",".join(row[k] for k in kept) for row in (header, *rows)]
    (folder / "table.csv").write_text("\n".join(lines) + "\n")
    info = json.loads((folder / "sweep.json").read_text())
    for name in ("held", "sure", "decided_by", "left_out", "copies"):
        del info[name]
    (folder / "sweep.json").write_text(json.dumps(info))
    assert words_in(map_data(open_sweep(folder), folder), "unsure")[2] == "unsure"
    assert "2 cells are unsure" in sweep_report(folder)


def test_the_command_of_a_cell_repeats_it(folder):
    data = map_data(open_sweep(folder), folder)
    words = shlex.split(data["command"])
    assert words == ["python", "-m", "fem", "run", str(folder / "base.toml")]
    assert [axis["key"] for axis in data["axes"]] == [SPEED, MU]
    assert data["derived"] == [{"key": "contact.mu_kinetic", "values": [0.1, 0.2, 0.1, 0.2, 0.1, 0.2]}]


def test_a_failed_cell_is_listed_with_its_reason_and_counted_as_no_outcome(folder):
    page = sweep_report(folder)
    assert "1 no outcome: failed" in page
    assert "cell 5: no &lt;b&gt;balance" in page


def test_names_stay_text_and_files_outside_the_folder_stay_out(folder):
    page = sweep_report(folder)
    assert "</script><b>" not in page
    assert "outside" not in re.sub(r"<style>.*?</style>", "", page, flags=re.DOTALL).replace(
        "outside.svg", ""
    )
    assert page.count("<script") == page.count("</script>") == 3


def test_more_cells_than_a_page_can_carry_are_refused_with_a_way_out(folder, monkeypatch):
    monkeypatch.setattr(sweep_map, "MOST_BYTES", 50)
    with pytest.raises(FolderError, match="6 cells are more than one page can carry"):
        sweep_report(folder)


def test_the_command_line_tells_a_sweep_from_a_run(folder, tmp_path, capsys):
    page = tmp_path / "page.html"
    assert main(["report", str(folder), "--to", str(page), "--author", "N. N."]) == 0
    assert "Report of a sweep" in page.read_text(encoding="utf-8")
    assert capsys.readouterr().out.strip() == str(page)


def test_the_answer_comes_first_with_a_row_for_each_value_of_the_other_axes(folder):
    """Over the peak acceleration; old folders have no answer in sweep.json, so it is made from the table."""
    page = sweep_report(folder)
    sentence = (
        "Peak acceleration: stood in every motion tried up to 0.459 g (slid up to 3 mm); first overturned at"
    )
    assert page.index(sentence) < page.index("6 of 6 cells")
    assert "stood up to [g]" in page and "first overturned at [g]" in page
    rows = re.findall(r'<tr><th scope="row">mu static (\S+)</th>' + 3 * "<td>(.*?)</td>", page)
    assert rows == [("0.2", "0.459", "2.00", "2.04"), ("0.4", "0.459", "3.00", "–")]
