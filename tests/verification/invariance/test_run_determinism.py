"""The same case is the same bytes: on any number of threads, from its resolved file; and mirrored, its mirror."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from interrupted_runs import COARSE, require_same, run_command
from mesh_writer import write_container_mesh

from fem.__main__ import main
from fem.case.case import load_case
from fem.case.files import CASES
from fem.model.geometry import build_container
from fem.model.model import Model, build_model
from fem.results.kinds import read_result
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

#: 28 contact nodes, dense products large enough for a BLAS to share them among threads
FLAT = ("support.kind=flat", "solver.duration_s=0.3")
THREADED = (FLAT, (*COARSE, "solver.duration_s=0.1"), ("solver.model=rigid", "solver.duration_s=3"))


@pytest.mark.slow
@pytest.mark.parametrize("overrides", THREADED, ids=["reduced", "full", "rigid"])
def test_the_number_of_threads_changes_no_byte(tmp_path, overrides):
    variables = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS")
    for threads in ("1", "2"):
        words = run_command("seed_stack_plateau", tmp_path / threads, "output.figures=false", *overrides)
        command = [sys.executable, "-m", "fem", *words, "--no-band"]
        few = os.environ | dict.fromkeys(variables, threads)
        subprocess.run(command, env=few, check=True, timeout=600)
    require_same(tmp_path / "1", tmp_path / "2")


def test_a_resolved_case_with_its_files_beside_it_gives_the_same_bytes(tmp_path, monkeypatch):
    (tmp_path / "case" / "data").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "case")  # paths relative to the current folder, as a user gives them
    write_container_mesh(
        Path("data/box.vtu"), build_container(load_case("seed_box", ["solver.element_size_m=0.25"]))
    )
    times = np.arange(0.0, 1.0, 0.02)
    rows = "".join(f"{t:.2f},{4.5 * np.sin(7.0 * t):.6f}\n" for t in times)
    Path("data/floor.csv").write_text("time_s,acceleration_m_s2\n" + rows)
    text = CASES.text("seed_box").replace("boxes = 1 ", 'mesh_file = "data/box.vtu"\nboxes = 1 ')
    before, _, rest = text.partition("[motion]")
    motion = '[motion]\nkind = "table"\nfile = "data/floor.csv"\nquantity = "acceleration"\nunit = "m/s2"\n'
    Path("mine.toml").write_text(before + motion + "\n[" + rest.partition("\n[")[2])
    common = ["-q", "--no-band", "--set", "solver.duration_s=0.5", "--set", "output.figures=false"]
    assert main(["run", "mine.toml", *common]) == 0
    first, second = Path("outputs/mine"), Path("again")
    assert main(["run", str(first / "resolved.toml"), "--out", str(second), "-q", "--no-band"]) == 0
    hashes = [read_result(folder / "run.json")["case_hash"] for folder in (first, second)]
    assert hashes[0] == hashes[1]
    assert "auto" not in (first / "resolved.toml").read_text()
    for name in ("history.csv", "resolved.toml", "data/floor.csv", "data/box.vtu", "fields/frame_00003.vtu"):
        assert (second / name).read_bytes() == (first / name).read_bytes()
    assert len((first / "history.csv").read_bytes().splitlines()) > 100


#: of the floor in both runs
VERTICAL = ("vertical.kind=harmonic", "vertical.peak_acceleration_m_s2=3", "vertical.frequency_Hz=3")
ODD = ("rotation_rad", "angular_velocity_rad_s", "slip_m", "centre_x_m", "shear_force_N")
EVEN = ("uplift_m", "centre_z_m", "normal_force_N", "kinetic_J")


def pulsed(sign: float, overrides: tuple[str, ...]) -> tuple[Model, Recorder]:
    """The stack under one sine of acceleration, which rocks it."""
    pulse = ("motion.kind=pulse", "motion.shape=sine", "motion.pulse_s=0.9", "output.fields_s=0")
    peak = f"motion.peak_acceleration_m_s2={4.5 * sign}"
    model = build_model(load_case("seed_stack_plateau", [*pulse, peak, *overrides]))
    recorder = Recorder(model)
    assert simulate(model, recorder).status in ("completed", "overturned")
    return model, recorder


@pytest.mark.parametrize(
    ("overrides", "before", "after"),
    [
        # rounding alone until the first impact at 0.68 s; an impact multiplies it, and near a limit of the step
        # control it decides on a step: from there on two runs differ by what a step may err, forces by ten times that
        (("solver.model=rigid", "solver.duration_s=4", *VERTICAL), 1e-11, 1e-9),
        (("support.kind=flat", "solver.duration_s=0.8"), 1e-10, 1e-8),
        # Its posts ring: what two runs differ by, 1e-9 at 0.8 s, is 4e-2 of the angular velocity at 1.2 s.
        pytest.param((*COARSE, "solver.duration_s=0.8"), 1e-8, 1e-6, marks=pytest.mark.slow),
    ],
    ids=["rigid, vertical motion", "reduced, flat base", "full"],
)
def test_a_mirrored_floor_gives_the_mirrored_history(overrides, before, after):
    (model, right), (_, left) = pulsed(1.0, overrides), pulsed(-1.0, overrides)
    one, other = right.history(), left.history()
    assert len(one) == len(other)
    assert np.abs(one["rotation_rad"]).max() > 0.05 * model.static.slenderness_angle
    early = one["time_s"] < 0.67
    for names, sign in ((ODD, -1.0), (EVEN, 1.0)):
        for name in names:
            scale = np.abs(one[name]).max()
            difference = np.abs(one[name] - sign * other[name]) / scale
            loose = 100.0 if name in ("normal_force_N", "shear_force_N") else 10.0  # stiff springs
            assert difference[early].max() < loose * before, name
            assert difference.max() < loose * after, name
