"""What counts in the answer of a study, from trials, a folder, points; sentences are in `tests/said/sentences.txt`."""

import csv
import json

import numpy as np
import pytest
from study_words import KINDS, MU, PEAK, WIDTH, G, ensemble_of, over

from fem.run.sureness import changes_of, least_width, rounds_left, values_to_try
from fem.study.answers import Answer, Trial, answer_axis, answer_of, answers_csv, sweep_answer
from fem.study.axes import Axis
from fem.study.sweep_table import BAND, FOUND, open_sweep


def line(values, kinds, *, number=0, slip=None):
    """Trials of one line, a letter each."""
    return [Trial(value, number, KINDS[kind], slip, None) for value, kind in zip(values, kinds, strict=True)]


def test_several_lines_stand_where_all_of_them_do():
    """The second line was refined between 2 and 3; what it showed there is not claimed of the first."""
    first = line([1.0, 2.0, 3.0, 4.0, 5.0], "sssss", number=0)
    second = line([1.0, 2.0, 2.5, 2.75, 3.0, 4.0, 5.0], "ssosoos", number=5, slip=0.01)
    assert answer_of([*first, *second], rising=True) == Answer(
        stood_to=2.0, overturned_from=2.5, stood_slip=0.01, slip=0.01, line=5, stood_again=((5.0, 5.0),)
    )


@pytest.mark.parametrize(
    ("axes", "key"),
    [
        ((MU, PEAK), PEAK.key),
        ((MU, WIDTH), None),
        ((MU, Axis(key="stop.gap_m", values=(0.0, 0.1))), "stop.gap_m"),
        ((MU,), MU.key),
        ((Axis(key="solver.model", values=("rigid", "reduced")),), None),
        ((Axis(key="motion.scale", values=(-1.0, 1.0)), MU), MU.key),
    ],
)
def test_the_axis_of_the_answer_is_the_strength_or_the_only_one(axes, key):
    found = answer_axis(axes)
    assert (found and found.key) == key


@pytest.mark.parametrize(
    ("shares", "peak"),
    [((0.0, 0.8, 0.3), 0.2 + 0.2 * 0.5 / 0.8), ((0.0, None, 1.0), 0.4)],
    ids=["an island does not move the first crossing", "a point without outcome is left out"],
)
def test_half_of_the_draws_overturn_where_straight_lines_between_the_shares_cross(shares, peak):
    assert ensemble_of(*over(PEAK, *shares)).rows[0].found.value == pytest.approx(peak * G)


def test_a_boundary_has_a_row_for_each_value_of_the_other_axis_and_an_unfinished_ensemble_no_answer():
    points = (*over(PEAK, 0.0, 0.25, 0.75, mu=0.3), *over(PEAK, 0.0, 0.5, 1.0, mu=0.6))
    assert [row.found.value for row in ensemble_of(*points).rows] == pytest.approx([0.5 * G, 0.4 * G])
    assert ensemble_of(*points, status="interrupted") is None


TRIED = "cell,value,status,outcome,rotation_ratio,reason,max_slip_m\n"


@pytest.fixture
def folder(tmp_path):
    """Two frictions under 0.2, 0.4, 0.6 g: the first stands throughout, the second overturns at 0.6 g."""
    outcomes = {0.3: ("rest", "slide", "slide"), 0.5: ("rest", "rock", "overturned")}
    columns = ["cell", MU.key, PEAK.key, *FOUND, *BAND]
    lines, peaks = [",".join(columns)], [0.2 * G, 0.4 * G, 0.6 * G]
    for cell, (mu, peak) in enumerate((mu, peak) for mu in outcomes for peak in peaks):
        outcome = outcomes[mu][peaks.index(peak)]
        row = dict.fromkeys(columns, "") | {"cell": cell, MU.key: mu, PEAK.key: peak, "outcome": outcome}
        row |= {"status": "overturned" if outcome == "overturned" else "completed", "max_slip_m": 0.08}
        row["unsure"] = "true" if cell in (4, 5) else "false"
        lines.append(",".join(str(row[name]) for name in columns))
    info = {"sweep": "s", "title": "", "status": "completed", "cells": 6, "rows": 6, "sweep_hash": "ab"}
    info |= {"outcomes": {}, "maps": [], "changes": 1, "threshold": {"axis": PEAK.key}, "answer": "as kept"}
    info["axes"] = [
        {"key": MU.key, "values": [0.3, 0.5], "scale": "list", "unit": ""},
        {"key": PEAK.key, "values": peaks, "scale": "linear", "unit": "m/s2"},
    ]
    (tmp_path / "sweep.json").write_text(json.dumps(info))
    (tmp_path / "table.csv").write_text("\n".join(lines) + "\n")
    between = f"3,{0.44 * G!r},overturned,overturned,2.0,,0.064\n3,{0.42 * G!r},completed,rock,0.9,,0.05\n"
    (tmp_path / "tried.csv").write_text(TRIED + between)
    return tmp_path


def test_each_line_has_a_row_with_what_was_tried_between_its_cells(folder):
    answer = sweep_answer(open_sweep(folder), folder)
    assert "slid up to 80 mm" in answer.sentence
    assert "(slip there 64 mm, with mu static 0.5)" in answer.sentence
    first, second = csv.DictReader(answers_csv(answer).splitlines())
    assert (first[MU.key], float(first["stood_to"]), first["overturned_from"]) == ("0.3", 0.6 * G, "")
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


SCAN = [1.0, 2.0, 3.0, 4.0, 5.0]


def refine_changes(values, outcomes, judge, *, resolution=0.01, inner=3):
    """Every change of outcome, as a sweep locates those of a line of cells."""
    known, least = dict(zip(values, outcomes, strict=True)), least_width(values, resolution)
    while tried := values_to_try(known, resolution=resolution, inner=inner, least=least):
        known |= dict(zip(tried, judge(tried), strict=True))
    return changes_of(known)


def islands(values):
    """Overturns in (1.3, 2.2) and beyond 4.61: a safe island lies between."""
    return ["overturned" if 1.3 < v < 2.2 or v > 4.61 else "standing" for v in values]


def test_every_change_is_closed_in_on():
    changes = refine_changes(SCAN, islands(SCAN), islands, resolution=1e-3)
    assert [c.above for c in changes] == ["overturned", "standing", "overturned"]
    assert [c.below for c in changes] == ["standing", "overturned", "standing"]
    for change, exact in zip(changes, (1.3, 2.2, 4.61), strict=True):
        assert change.low <= exact <= change.high
        assert change.high - change.low <= 1e-3 * change.high


def test_the_rounds_that_are_left_are_foretold():
    known, wanted, rounds = {1.0: "standing", 2.0: "overturned"}, {"resolution": 1e-3, "inner": 3}, 0
    foretold = rounds_left(known, **wanted)
    while tried := values_to_try(known, **wanted):
        known |= {value: "overturned" if value > 1.2 else "standing" for value in tried}
        rounds += 1
    assert rounds == pytest.approx(foretold, abs=1.0)


def test_an_island_inside_a_bracket_is_kept():
    # Between 1 and 2 alone: overturned beyond 1.2, standing again in (1.45, 1.55), as the values tried within show.
    def judge(values):
        return ["overturned" if v > 1.2 and not 1.45 < v < 1.55 else "standing" for v in values]

    changes = refine_changes([1.0, 2.0], judge([1.0, 2.0]), judge, resolution=0.01, inner=3)
    assert [c.value for c in changes] == pytest.approx([1.2, 1.45, 1.55], abs=0.02)


@pytest.mark.parametrize("last_standing", [0.0, -1e-9])
def test_a_change_at_zero_is_closed_in_on_and_left(last_standing):
    # No share of a value is narrow enough there: the step of the scan decides.
    def judge(values):
        return ["overturned" if v > last_standing else "standing" for v in values]

    scan = [-0.2, -0.1, 0.0, 0.1, 0.2]
    (change,) = refine_changes(scan, judge(scan), judge, resolution=0.01)
    assert change.low <= last_standing <= change.high
    assert change.high - change.low <= 0.001


def test_a_resolution_finer_than_numbers_ends_between_two_neighbours():
    def judge(values):
        return ["overturned" if v > np.pi else "standing" for v in values]

    (change,) = refine_changes(SCAN, judge(SCAN), judge, resolution=1e-300)
    assert change.high == np.nextafter(change.low, np.inf)
