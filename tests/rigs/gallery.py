"""What a session makes once: computed runs that many tests read, each in a folder nobody changes, and all kernels.

The fixture `gallery` of `conftest` gives folders to read, `gallery("rigid")`; opened, `gallery.run("rigid")`; or a copy
to change, `gallery.copy("rigid", tmp_path)`. A run that two modules need is a line in RUNS; a study, or anything else,
is a function in MADE that fills the folder it is given.
"""

import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from filelock import FileLock, Timeout
from small_sweep import sweep_in

from contact.jit import cache_folder
from fem.case.case import load_case
from fem.model.model import build_model
from fem.results.reader import OpenedRun, open_run
from fem.run.recorder import Recorder
from fem.run.run import RunOptions, run_case
from fem.run.simulation import simulate
from fem.runtime.progress import Reporter
from fem.study.sweep import run_sweep

#: a title that must stay text wherever it is shown
HOSTILE = "</title><script>alert(1)</script> & co"
SHORT = ("solver.duration_s=2", "solver.element_size_m=0.5", "solver.order=1", "solver.elastic_modes=4")
RIGID = ("solver.model=rigid", "floor.kind=rigid", "output.fields_s=0.25")
SLIPPERY = ("container.joints=loose", "joints.mu_static=0.1", "joints.mu_kinetic=0.1", "floor.kind=rigid")
#: name -> shipped case, its changes, options of the run; all have figures and frames
RUNS: dict[str, tuple[str, tuple[str, ...], dict[str, bool]]] = {
    "default": ("seed_stack_plateau", (*SHORT, f"title={HOSTILE}"), {"margin": False}),
    "rigid": (
        "rocking",
        (*RIGID, "solver.duration_s=3", "document.project=Store <3>", "document.number=7-A"),
        {"check_rigid": True, "band": True, "margin": False},
    ),
    "overturned": ("overturning", RIGID, {"band": False}),
    "slides": ("sliding", (*RIGID, "solver.duration_s=2"), {"band": False}),
    "rests": ("seed_box", (*RIGID, "motion.kind=none", "solver.duration_s=0.5"), {"band": False}),
    # two boxes, of which the upper slides from the first instant on and the lower never
    "loose": (
        "seed_stack",
        ("solver.model=rigid", "solver.duration_s=1", "container.boxes=2", *SLIPPERY),
        {"band": False},
    ),
}


def small_sweep(folder: Path) -> None:
    """The sweep of `small_sweep`, without maps."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fem.study.sweep.draw_maps", lambda *_: [])
        run_sweep(sweep_in(folder.parent), folder, jobs=1)


MADE: dict[str, Callable[[Path], object]] = {"sweep": small_sweep}


class Strict(Reporter):
    """Lets no run end without its figures."""

    def message(self, text: str) -> None:
        assert "not drawn" not in text, text


class Gallery:
    """Folders of `RUNS` and `MADE` below one place, which all workers of a session share."""

    def __init__(self, place: Path) -> None:
        self.place = place

    def __call__(self, name: str) -> Path:
        """The folder of an entry, to be read only."""
        folder, done = self.place / name, self.place / f"{name}.done"
        self.place.mkdir(exist_ok=True)
        with FileLock(self.place / f"{name}.lock"):
            if not done.exists():
                MADE[name](folder) if name in MADE else _computed(folder, *RUNS[name])
                done.touch()
        return folder

    def copy(self, name: str, place: Path) -> Path:
        """A copy of an entry in a folder of the test's own."""
        return Path(shutil.copytree(self(name), place / name))

    def run(self, name: str) -> OpenedRun:
        """An entry of `RUNS`, opened."""
        return open_run(self(name))


def _computed(folder: Path, name: str, changes: tuple[str, ...], options: dict[str, bool]) -> None:
    case = load_case(name, changes)
    run_case(case, case_text=case.text, folder=folder, options=RunOptions(**options), reporter=Strict())


LOOSE = ("container.joints=loose", "container.boxes=3")
STOP = "stop=[{side = 'right', height_m = 0.1, gap_m = 0.02, stiffness_N_m = 1e8}]"
#: cases that step with different kernels, the longest compilation first
STEPPED = {
    "loose": LOOSE,
    "linked boxes": ("solver.model=rigid", *LOOSE, STOP),
    "corners": (),
    "rigid": ("solver.model=rigid",),
    "full loose": (
        "solver.model=full",
        "container.joints=loose",
        "container.boxes=2",
    ),  # compiled for so many boxes
    "full": ("solver.model=full",),
    "linked": ("solver.model=rigid", STOP),
}


def compile_kernels() -> None:
    """Compile those that no other worker is compiling and no earlier suite has compiled, then wait for the others."""
    for wait in (0.0, -1.0):
        for name, changes in STEPPED.items():
            place = cache_folder() / name
            with suppress(Timeout), FileLock(f"{place}.lock", timeout=wait):
                if not (done := place.with_suffix(".compiled")).exists():
                    model = build_model(load_case("seed_box", ["solver.duration_s=0.02", *changes]))
                    simulate(model, Recorder(model))
                    done.touch()
