"""The same case is the same bytes: on any number of threads, from its resolved file; and mirrored, its mirror."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mesh_writer import write_container_mesh

from fem.__main__ import main
from fem.case.case import load_case
from fem.case.files import CASES
from fem.model.geometry import build_container
from fem.model.model import Model, build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

FULL = ("solver.model=full", "solver.element_size_m=0.5")
#: 28 contact nodes, dense products large enough for a BLAS to share them among threads
FLAT = ("support.kind=flat", "solver.duration_s=0.3")
THREADED = (FLAT, (*FULL, "solver.duration_s=0.1"), ("solver.model=rigid", "solver.duration_s=3"))

COMPUTE = """
import sys
from fem.__main__ import main
folder, *models = sys.argv[1:]
for number, model in enumerate(models):
    changes = [word for value in model.split() for word in ("--set", value)]
    code = main(["run", "seed_stack_plateau", "--out", f"{folder}/{number}", "-q", "--no-band",
                 "--set", "output.figures=false", *changes])
    assert code == 0
"""


def bytes_of(folder: Path) -> str:
    """One digest for history and frames of the runs in a folder."""
    digest = hashlib.sha256()
    files = sorted([*folder.rglob("history.csv"), *folder.rglob("frame_*.vtu")])
    assert len(files) > len(THREADED)
    for path in files:
        digest.update(path.relative_to(folder).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()


def test_the_number_of_threads_changes_no_byte(tmp_path):
    found = []
    for threads in ("1", "2"):
        variables = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS")
        done = subprocess.run(
            [sys.executable, "-c", COMPUTE, str(tmp_path / threads), *map(" ".join, THREADED)],
            env=os.environ | dict.fromkeys(variables, threads),
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert done.returncode == 0, done.stderr
        found.append(bytes_of(tmp_path / threads))
    assert found[0] == found[1]


def test_a_resolved_case_with_its_files_beside_it_gives_the_same_bytes(tmp_path, monkeypatch):
    (tmp_path / "case" / "data").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "case")  # paths relative to the current folder, as a user gives them
    write_container_mesh(
        "data/box.vtu", build_container(load_case("seed_box", ["solver.element_size_m=0.25"]))
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
    for name in ("history.csv", "resolved.toml", "data/floor.csv", "data/box.vtu", "fields/frame_00003.vtu"):
        assert (second / name).read_bytes() == (first / name).read_bytes()
    assert len((first / "history.csv").read_bytes().splitlines()) > 100


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
        (("solver.model=rigid", "solver.duration_s=4"), 1e-11, 1e-9),
        (("solver.duration_s=2",), 1e-11, 1e-4),
        (("support.kind=flat", "solver.duration_s=0.8"), 1e-10, 1e-8),
        pytest.param((*FULL, "solver.duration_s=1.2"), 1e-8, 3e-4, marks=pytest.mark.slow),
    ],
    ids=["rigid", "reduced", "reduced, flat base", "full"],
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
