"""A run that is cut off and gone on with is, bit for bit, the run that was left alone."""

from pathlib import Path

import pytest

import fem.run
import fem.simulation
from fem.case import load_case
from fem.run import RunOptions, RunResult, run_case
from fem.run_folder import read_result

RIGID = ("solver.model=rigid", "solver.duration_s=4", "output.fields_s=0.1")
REDUCED = ("solver.duration_s=1.5", "output.fields_s=0.1")
FLAT = (*REDUCED, "support.kind=flat", "container.wall_m=0.02", "solver.elastic_modes=4")
FULL = ("solver.model=full", "solver.duration_s=0.12", "solver.element_size_m=0.5", "output.fields_s=0.02")
#: still beyond its slenderness angle when time is up, then falling
FALLING = ("solver.model=rigid", "initial.rotation_rad=0.28", "solver.duration_s=0.3", "output.fields_s=0.1")

CASES = {
    "rigid": ("rocking", RIGID),
    "reduced": ("seed_stack_plateau", REDUCED),
    "reduced, flat base": ("seed_stack_plateau", FLAT),
    "full": ("seed_stack_plateau", FULL),
    "aftermath": ("free_rocking", FALLING),
    "aftermath, full": ("free_rocking", (*FALLING, "solver.model=full", "solver.element_size_m=0.5")),
}


class StopAfter:
    """Asks to stop after so many slices."""

    def __init__(self, slices: int) -> None:
        self.left = slices + 1

    def __call__(self) -> bool:
        self.left -= 1
        return self.left < 0


def run(folder: Path, name: str, overrides: tuple[str, ...], **options) -> RunResult:
    case = load_case(name, overrides)
    return run_case(case, case_text=case.text, folder=folder, options=RunOptions(band=False, **options))


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def without_times(result: dict) -> dict:
    kept = {key: value for key, value in result.items() if key not in ("wall_s", "cpu_s")}
    kept["numerics"] = {k: v for k, v in kept["numerics"].items() if k != "stepping_cpu_s"}
    return kept


def same(one: Path, other: Path) -> None:
    found, wanted = files_of(one), files_of(other)
    assert set(found) == set(wanted)
    for name in set(wanted) - {"run.json", "summary.txt"}:
        assert found[name] == wanted[name], name
    assert without_times(read_result(one / "run.json")) == without_times(read_result(other / "run.json"))


@pytest.mark.parametrize("kind", CASES)
def test_a_run_cut_off_after_every_slice_is_the_run_left_alone(tmp_path, monkeypatch, kind):
    name, overrides = CASES[kind]
    monkeypatch.setattr(fem.simulation, "SLICE_FULL", 0.03)
    run(tmp_path / "whole", name, overrides)
    whole = fem.run.simulate
    for _ in range(200):
        # every beginning steps one slice, so every state between slices has been through a checkpoint
        stop = StopAfter(1)
        monkeypatch.setattr(fem.run, "simulate", lambda *a, stop=stop, **k: whole(*a, **k | {"stop": stop}))
        if run(tmp_path / "cut", name, overrides, resume=True).status != "interrupted":
            break
        assert (tmp_path / "cut" / "checkpoint.npz").is_file()
    same(tmp_path / "cut", tmp_path / "whole")
