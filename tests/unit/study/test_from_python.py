"""Studies from Python write the folders of their commands and give their tables."""

import numpy as np
import pytest
from small_site import SITE

import fem

RIGID = '[set]\n"solver.model" = "rigid"\n"solver.duration_s" = 0.2\n'
SWEEP = (
    f'case = "seed_box"\n{RIGID}[axes]\n"contact.mu_static" = [0.3, 0.4]\n[perturbation]\ncells = "none"\n'
)
ENSEMBLE = f"""case = "seed_box"
draws = 8
probability = 0.5
{RIGID}[axes]
"motion.peak_acceleration_m_s2" = [2.0, 3.0]
[random]
"contact.mu_static" = {{ distribution = "uniform", from = 0.3, to = 0.5 }}
"""


def box(*overrides):
    return fem.load_case("seed_box", ("solver.model=rigid", "solver.duration_s=0.2", *overrides))


STUDIES = {
    "sweep": (lambda place, **given: fem.compute_sweep(place / "sweep.toml", place / "out", **given), 2),
    "ensemble": (
        lambda place, **given: fem.compute_ensemble(place / "ensemble.toml", place / "out", **given),
        2,
    ),
    "list": (
        lambda place, **given: fem.compute_list(
            place / "list.csv", box(), place / "out", margins="none", **given
        ),
        2,
    ),
    "response": (
        lambda place, **given: fem.compute_response(box(), place / "out", count=2, starts=0, **given),
        4,
    ),
}


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_gives_its_table_and_is_not_computed_again(tmp_path, name, capsys):
    for file, text in {
        "sweep.toml": SWEEP,
        "ensemble.toml": ENSEMBLE,
        "list.csv": "width_m\n1.0\n1.2\n",
    }.items():
        (tmp_path / file).write_text(text)
    compute, rows = STUDIES[name]
    table = compute(tmp_path, jobs=1)
    assert all(isinstance(column, np.ndarray) and len(column) == rows for column in table.values())
    assert table.result["status"] == "completed"
    marks = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*.json")}
    again = compute(tmp_path, progress=True)
    assert list(again) == list(table) and marks == {path: path.stat().st_mtime_ns for path in marks}
    said = capsys.readouterr()
    assert said.out == "" and "holds this" in said.err


def test_a_site_gives_its_runs_and_its_answer(tmp_path, monkeypatch):
    monkeypatch.setattr("fem.site.stages.SCANNED", ())
    monkeypatch.setattr("fem.site.run.confirmed", lambda *arguments: [])
    (tmp_path / "site.toml").write_text(SITE)
    table = fem.assess_site(tmp_path / "site.toml", tmp_path / "out", quick=True, jobs=1)
    assert table.result["answer"] and len(table["outcome"]) >= 6
