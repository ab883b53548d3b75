"""All stepping kernels, compiled once for a whole suite: its workers share the work, and none waits for long."""

from contextlib import suppress

from filelock import FileLock, Timeout

from contact.jit import cache_folder
from fem.case.case import load_case
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

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
