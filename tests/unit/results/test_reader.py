"""A run opened for reading: the same numbers as in its files, lazily, and a clear word where a file is missing."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import pyvista
from interrupted_runs import stored_run

import fem
from fem.case.columns import ALWAYS
from fem.results.errors import FolderError
from fem.results.fields import FieldError

ROOT = Path(__file__).parents[3]
ROCKING = ("solver.model=rigid", "solver.duration_s=1", "output.fields_s=0.25", "output.figures=false")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A finished run of free rocking, with a rigid check and fields."""
    folder = tmp_path_factory.mktemp("opening") / "r"
    stored_run(fem.load_case("free_rocking", ROCKING), folder, band=False)
    return folder


@pytest.fixture
def damaged(folder, tmp_path):
    """Makes a copy of the run with one file replaced; None takes it away."""

    def copy(name, text):
        place = tmp_path / "copy"
        shutil.copytree(folder, place)
        if text is None:
            (place / name).unlink()
        else:
            (place / name).write_text(text)
        return place

    return copy


def test_result_case_and_history_are_those_of_the_files(folder):
    run = fem.open_run(folder)
    assert run.result == json.loads((folder / "run.json").read_text())
    assert (run.name, run.status, run.folder) == ("free_rocking", "completed", folder)
    assert run.case.resolved() == fem.load_case(folder / "resolved.toml").resolved()
    written = np.loadtxt(folder / "history.csv", delimiter=",", skiprows=1, usecols=range(16))
    for column, name in enumerate(ALWAYS.names((0,))[:16]):
        assert (run.history[name] == written[:, column]).all()
    assert len(run.history.modes) == len(written) == 201
    assert run.history is run.history  # read once
    assert fem.open_run(folder / "run.json").result == run.result
    assert repr(run) == f"<run 'free_rocking' in {str(folder)!r}: completed, rock>"
    assert repr(run.fields) == "<fields: 5 frames from 0 to 1 s>"
    assert repr(run.history).startswith("<history: 201 samples of time_s, base_displacement_m")


def test_a_grid_is_what_pyvista_reads_from_the_file(folder):
    run = fem.open_run(folder)
    made, read = run.grid(0.5), pyvista.read(run.fields.files[2])
    assert made.points == pytest.approx(read.points)
    assert made.cells.tolist() == read.cells.tolist()
    assert made.celltypes.tolist() == read.celltypes.tolist()
    assert run.frame(0.5).von_mises is None  # a rigid container
    assert set(made.point_data) == set(read.point_data) - {"floor_displacement_m"}
    for name in ("displacement_m", "velocity_m_s", "contact_pressure_Pa"):
        assert made.point_data[name] == pytest.approx(read.point_data[name])


@pytest.mark.parametrize(
    ("name", "text", "ask", "words"),
    [
        ("history.csv", None, "history", "history.csv: cannot be read (No such file"),
        ("history.csv", "time\n", "history", "not a history"),
        ("resolved.toml", None, "case", "resolved.toml: missing"),
        ("resolved.toml", "schema = ", "case", "not a TOML file"),
        ("rigid_check.csv", "time_s,rotation_rad\n0,a\n", "rigid_check", "rigid_check.csv: cannot be read"),
        ("fields/run.pvd", None, "fields", "no fields were written"),
        ("fields/run.pvd", "<VTKFile>", "fields", "damaged"),
        ("fields/run.pvd", "<VTKFile/>", "fields", "no frame has been written yet"),
    ],
)
def test_a_damaged_file_is_named_when_it_is_asked_for(damaged, name, text, ask, words):
    run = fem.open_run(damaged(name, text))  # opens all the same
    with pytest.raises(FolderError) as raised:
        getattr(run, ask)
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("text", ["", "<VTKFile", "<VTKFile type='UnstructuredGrid'/>", None])
def test_a_damaged_frame_is_named(damaged, text):
    run = fem.open_run(damaged("fields/frame_00001.vtu", text))
    assert run.fields.frame(0).time == 0.0
    with pytest.raises(FieldError, match=r"frame_00001\.vtu: this frame is (damaged|missing)"):
        run.fields.frame(1)


@pytest.mark.slow
def test_opening_loads_neither_the_solver_nor_pyvista(folder):
    script = (
        f"import sys, fem; assert not {{'numpy', 'fem.results.reader'}} & set(sys.modules); "
        f"run = fem.open_run({str(folder)!r}); run.history, run.case, run.fields.frame(0); "
        "print(*{'numba', 'pyvista', 'skfem', 'matplotlib'} & set(sys.modules))"
    )
    result = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60
    )
    assert result.stdout.strip() == ""
