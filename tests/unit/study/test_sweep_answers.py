"""The answer of a sweep from its folder: cells, what a threshold tried between them, and a row for each line."""

import csv
import json

import pytest

from fem.study.answers import answers_csv, sweep_answer
from fem.study.sweep_table import BAND, FOUND, open_sweep

PEAK, MU = "motion.peak_acceleration_m_s2", "contact.mu_static"
G = 9.80665
TRIED = "cell,value,status,outcome,rotation_ratio,reason,max_slip_m\n"


@pytest.fixture
def folder(tmp_path):
    """Two frictions under 0.2, 0.4, 0.6 g: the first stands throughout, the second overturns at 0.6 g."""
    outcomes = {0.3: ("rest", "slide", "slide"), 0.5: ("rest", "rock", "overturned")}
    columns = ["cell", MU, PEAK, *FOUND, *BAND]
    lines, peaks = [",".join(columns)], [0.2 * G, 0.4 * G, 0.6 * G]
    for cell, (mu, peak) in enumerate((mu, peak) for mu in outcomes for peak in peaks):
        outcome = outcomes[mu][peaks.index(peak)]
        row = dict.fromkeys(columns, "") | {"cell": cell, MU: mu, PEAK: peak, "outcome": outcome}
        row |= {"status": "overturned" if outcome == "overturned" else "completed", "max_slip_m": 0.08}
        row["unsure"] = "true" if cell in (4, 5) else "false"
        lines.append(",".join(str(row[name]) for name in columns))
    info = {"sweep": "s", "title": "", "status": "completed", "cells": 6, "rows": 6, "sweep_hash": "ab"}
    info |= {"outcomes": {}, "maps": [], "changes": 1, "threshold": {"axis": PEAK}, "answer": "as kept"}
    info["axes"] = [
        {"key": MU, "values": [0.3, 0.5], "scale": "list", "unit": ""},
        {"key": PEAK, "values": peaks, "scale": "linear", "unit": "m/s2"},
    ]
    (tmp_path / "sweep.json").write_text(json.dumps(info))
    (tmp_path / "table.csv").write_text("\n".join(lines) + "\n")
    between = f"3,{0.44 * G!r},overturned,overturned,2.0,,0.064\n3,{0.42 * G!r},completed,rock,0.9,,0.05\n"
    (tmp_path / "tried.csv").write_text(TRIED + between)
    return tmp_path


def test_each_line_has_a_row_with_what_was_tried_between_its_cells(folder):
    answer = sweep_answer(open_sweep(folder), folder)
    assert (
        "slid up to 80 mm" in answer.sentence and "(slip there 64 mm, with mu static 0.5)" in answer.sentence
    )
    first, second = csv.DictReader(answers_csv(answer).splitlines())
    assert (first[MU], float(first["stood_to"]), first["overturned_from"]) == ("0.3", 0.6 * G, "")
    assert float(second["stood_to"]) == 0.42 * G
    assert float(second["overturned_from"]) == 0.44 * G
    assert second["unsure"] == f"{0.4 * G!r} to {0.6 * G!r}"


def test_missing_cells_give_no_answer(folder):
    lines = (folder / "table.csv").read_text().splitlines()
    (folder / "rows.csv").write_text("\n".join(lines[:-1]) + "\n")
    (folder / "table.csv").unlink()
    info = json.loads((folder / "sweep.json").read_text())
    (folder / "sweep.json").write_text(json.dumps(info | {"status": "interrupted"}))
    assert sweep_answer(open_sweep(folder), folder) is None
