"""Cost of the figures, fields and films of a run.

Figures of a run of 20 s in less than 5 s, a film of 100 frames in less than 60 s with software rendering, and the
fields of a `full` run in less than 5 % of its time. Figures are measured in CPU time, on one thread. For the fields,
the frames of a run are made and written once more and compared with the CPU time of its stepping, since two whole
runs differ by more than that.
"""

import math
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from measuring import Figure, at_most, cpu_seconds, median_of, report

import fem
from fem.case.case import load_case
from fem.figures.cache import write_figures
from fem.model.container import discretise
from fem.model.model import build_model
from fem.model.recovery import Recovery, recovery_of
from fem.render.movie import write_movie
from fem.render.opengl import probe_rendering
from fem.results.fields import FieldWriter, Frame
from fem.results.reader import OpenedRun
from fem.run.run import RunOptions, run_case

REPEATS = 3
FIGURES, FILM, FIELDS = 5.0, 60.0, 0.05
FRAMES = 100


def run_of(folder: Path, name: str, *overrides: str) -> OpenedRun:
    case = load_case(name, ["output.figures=false", *overrides])
    run_case(case, case_text=case.text, folder=folder, options=RunOptions(band=False))
    return fem.open_run(folder)


def figures_of_a_long_run(folder: Path) -> Figure:
    """CPU time, the median; matplotlib is already loaded."""
    run = run_of(folder, "seed_stack_plateau", "output.fields_s=0")
    container = discretise(run.case)
    write_figures(run, container)  # loads the fonts
    cost = median_of(REPEATS, lambda: cpu_seconds(lambda: write_figures(fem.open_run(folder), container)))
    size = sum(path.stat().st_size for path in run.place.figures.iterdir())
    return at_most(f"figures of {len(run.history)} samples, CPU s ({size / 1e3:.0f} kB)", cost, FIGURES)


def film(folder: Path) -> Figure:
    """Wall and CPU time of a film of the stack, rocking."""
    if (reason := probe_rendering()) is not None:
        return Figure(f"film of {FRAMES} frames", f"not possible: {reason}")
    run = run_of(folder, "rocking", f"solver.duration_s={0.05 * (FRAMES - 1)}", "output.fields_s=0.05")
    began, cpu = time.perf_counter(), time.process_time()
    path = folder / "film.gif"
    write_movie(run, path, begin=0.0, until=math.inf, rate=25.0)
    wall, cpu = time.perf_counter() - began, time.process_time() - cpu
    what = f"film of {len(run.fields)} frames, s ({path.stat().st_size / 1e6:.1f} MB, CPU {cpu:.0f} s)"
    return at_most(what, wall, FILM, ".1f")


def write_again(frames: list[Frame], recovery: Recovery, folder: Path) -> None:
    """The frames of a run, made from its coordinates and written as a run does."""
    first = frames[0]
    writer = FieldWriter(folder, points=first.points, cells=first.cells, region=first.region, box=first.box)
    for frame in frames:
        made = recovery.frame((frame.points + frame.displacement).ravel(), frame.velocity.ravel())
        writer.write(replace(frame, **vars(made)))
    writer.close()


def fields_of_a_full_run(folder: Path) -> Figure:
    """CPU time of writing the fields over that of the stepping, default interval."""
    run = run_of(folder, "rocking", "solver.model=full", "solver.duration_s=1")
    frames, recovery = list(run.fields), recovery_of(build_model(run.case))
    again = folder / "again"
    cost = median_of(REPEATS, lambda: cpu_seconds(lambda: write_again(frames, recovery, again)))
    stepping = run.result["numerics"]["stepping_cpu_s"]
    what = f"fields of a full run: {len(frames)} frames in {cost:.2f} s, stepping {stepping:.1f} s, share"
    return at_most(what, cost / stepping, FIELDS, ".3f")


def main() -> int:
    with tempfile.TemporaryDirectory() as place:
        parts = {"figures": figures_of_a_long_run, "film": film, "fields": fields_of_a_full_run}
        return report("pictures and fields", [part(Path(place) / name) for name, part in parts.items()])


if __name__ == "__main__":
    sys.exit(main())
