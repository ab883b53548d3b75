"""A sweep from its file to its table: the same whatever the jobs, cut off or not."""

import numpy as np
import pytest
from small_sweep import SMALL, rows_without_wall

from fem.case.validation import CaseError
from fem.study.file import load_sweep
from fem.study.sweep import check_size, run_sweep
from fem.study.sweep_table import open_sweep

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    path = tmp_path_factory.mktemp("file") / "small.toml"
    path.write_text(SMALL, encoding="utf-8")
    return load_sweep(path)


@pytest.fixture
def computed(gallery):
    """The folder of the sweep."""
    return gallery("sweep")


def test_the_table_does_not_depend_on_the_jobs(small, computed, tmp_path):
    one, two = open_sweep(computed).info, run_sweep(small, tmp_path / "two", jobs=2)
    assert one["status"] == two["status"] == "completed"
    assert rows_without_wall(computed) == rows_without_wall(tmp_path / "two")
    assert one["outcomes"] == two["outcomes"]
    assert one["answer"] == two["answer"]
    assert one["answer"].startswith("peak acceleration: stood in every motion tried up to ")
    answers = [(folder / "answers.csv").read_bytes() for folder in (computed, tmp_path / "two")]
    assert answers[0] == answers[1]
    assert answers[0].count(b"\n") == 1 + 2  # a row for each frequency
    assert {"overturned", "rest"} <= set(one["outcomes"])
    assert not (computed / "rows.csv").exists()


def test_the_folder_opens_as_arrays(small, computed):
    table = open_sweep(computed)
    info = table.info
    assert table.shape == small.shape
    grid = table["motion.peak_acceleration_m_s2"].reshape(table.shape)
    assert np.array_equal(grid[1], small.axes[1].values)
    assert np.array_equal(table["contact.mu_kinetic"], np.full(10, 0.2))
    fallen = table.outcome == "overturned"
    assert fallen.sum() == info["outcomes"]["overturned"]
    assert np.all(np.isfinite(table["overturned_at_s"]) == fallen)
    assert table["unsure"].sum() == info["unsure"]


def test_another_band_keeps_the_rows(gallery, tmp_path):
    folder = gallery.copy("sweep", tmp_path)
    rows, walls = rows_without_wall(folder), open_sweep(folder)["wall_s"]
    path = tmp_path / "small.toml"
    path.write_text(SMALL + '[perturbation]\ncells = "none"\n', encoding="utf-8")
    again = run_sweep(load_sweep(path), folder)
    assert (again["unsure"], again["perturbed"]) == (None, 0)
    kept = rows_without_wall(folder)
    last = kept[0].index("perturbed")
    assert [row[:last] for row in kept] == [row[:last] for row in rows]
    # the wall times are the first computation's: nothing was computed again
    assert np.array_equal(open_sweep(folder)["wall_s"], walls)


def test_a_failed_cell_has_a_reason_and_never_stands(tmp_path):
    # At 4 rad/s the expression has no value; the ends of the range are fine.
    derived = "[derived]", '[derived]\n"container.depth_m" = "1 / (motion.angular_frequency_rad_s - 4)^2"'
    path = tmp_path / "bad.toml"
    few = SMALL.replace("count = 2", "count = 3").replace("count = 5", "count = 2")
    path.write_text(few.replace(*derived), encoding="utf-8")
    run_sweep(load_sweep(path), tmp_path / "out")
    table = open_sweep(tmp_path / "out")
    middle = table["motion.angular_frequency_rad_s"] == 4.0
    assert np.array_equal(table.outcome == "failed", middle)
    assert np.all(table["outcome"][middle] == "") and np.all(table["unsure"][middle] == 1.0)
    assert all("it divides by zero" in reason for reason in table["reason"][middle])


def test_a_million_cells_need_force_and_name_time_and_disk(tmp_path):
    axes = """"solver.duration_s" = { from = 2.0, to = 6.0, count = 1100 }
"solver.model" = ["rigid", "full"]
"""
    text = "\n".join(line for line in SMALL.splitlines() if not line.startswith('"solver.'))
    text = text.replace("count = 2", "count = 30").replace("count = 5", "count = 20")
    path = tmp_path / "huge.toml"
    path.write_text(text.replace("[derived]", axes + "[derived]"))
    with pytest.raises(CaseError, match="1320000 cells") as refused:
        check_size(load_sweep(path), 1, False)
    # half of the cells are of the full model: 660000 x (1 + 4 x 3) s, of which one figure is known
    assert all(words in str(refused.value) for words in ("roughly 2500 h", "GB", "--force"))
    check_size(load_sweep(path), 1, True)
