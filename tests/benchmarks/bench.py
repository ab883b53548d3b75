"""What the program costs and what its words are worth: one table, one function a measurement.

    python tests/benchmarks/bench.py [--list | --all | NAME ...]

Without a name the rows with a star are measured, in five minutes; all of them take an hour. A name is that of a row, or
its beginning. Measured values stand beside their targets and those of November 2026 on two cores; exit code 1 if a
target is missed. CPU time is that of a process with its children; compilation is not included but where it is named. It
is not part of the test suite: a slow machine fails no test. Needs psutil, which comes with the extra `cluster`.
"""

import argparse
import math
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import psutil

import fem
from contact.stepping.outcome import run_to_end
from contact.stepping.state import make_samples
from fem.case.case import Case, load_case
from fem.case.strength import scaled_motion
from fem.figures.cache import write_figures
from fem.model.container import discretise
from fem.model.model import Model, build_model
from fem.run.band import with_band
from fem.run.recorder import Recorder
from fem.run.rigid_check import block_of
from fem.run.run import RunOptions, run_case
from fem.run.simulation import simulate
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions
from fem.solid.nodal_body import advance_body
from fem.study.axes import read_axis
from fem.study.file import load_sweep
from fem.study.sweep import run_sweep

sys.path.append(str(Path(__file__).parents[1] / "rigs"))
from case_rows import run_cases
from moreau import slide_and_rock

Measured = float | tuple[float, str]  #: the number of the table, and what else was found


def cpu_seconds(work: Callable[[], object]) -> float:
    """CPU time that a call takes in this process [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


def median_of(repeats: int, measure: Callable[[], float]) -> float:
    return statistics.median(measure() for _ in range(repeats))


@cache
def place() -> Path:
    """A folder for files, of this process."""
    return Path(tempfile.mkdtemp(prefix="bench-"))


# Commands, as whole processes with their workers


class Cost(NamedTuple):
    """Of a command: wall time, CPU time [s], and the largest sum of memory over its processes [MB]."""

    wall: float
    cpu: float
    peak: float


def cost_of(*arguments: str, cache: str | None = None) -> Cost:
    """Of `python -m fem` with these arguments, memory by twenty samples a second."""
    began, peak, done = time.perf_counter(), 0, threading.Event()
    process = subprocess.Popen(
        [sys.executable, "-m", "fem", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | ({"NUMBA_CACHE_DIR": str(place() / cache)} if cache else {}),
    )

    def watch() -> None:
        nonlocal peak
        root = psutil.Process(process.pid)
        while not done.wait(0.05):
            try:
                peak = max(peak, sum(one.memory_info().rss for one in (root, *root.children(recursive=True))))
            except psutil.Error:  # one of them has just ended
                continue

    watcher = threading.Thread(target=watch)
    watcher.start()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    done.set()
    watcher.join()
    if process.returncode:
        raise RuntimeError(f"{' '.join(arguments)}: exit code {process.returncode}")
    return Cost(time.perf_counter() - began, usage.ru_utime + usage.ru_stime, peak / 1e6)


def out(*arguments: str, **options: str) -> Cost:
    return cost_of(*arguments, "-q", "--force", "--out", str(place() / "out"), **options)


SHORT_RUN = ("run", "rocking", "--no-band")


def compiling() -> Measured:
    return out(*SHORT_RUN, cache="a run").cpu - out(*SHORT_RUN, cache="a run").cpu


def memory_of(*arguments: str) -> Measured:
    """Of a command on two cores."""
    found = out(*arguments)
    return found.peak, f"{found.wall:.0f} s, {found.cpu:.0f} CPU s"


# Runs, stepped without files


def stepped(case: Case, container: Any = None) -> tuple[Model, float]:
    """A case at its end, and the CPU time of the stepping alone [s]; kernels are compiled before the clock starts."""
    model = build_model(case, container)
    warm = build_model(case, model.container)
    advance_body(warm.body, warm.run, min(0.002, case.solver.duration_s))
    ending = simulate(model, Recorder(model))
    if ending.status == "failed":
        raise RuntimeError(f"{case.name}: {ending.error}")
    return model, ending.stepping_cpu_s


def full_box() -> Measured:
    """A solid box of 22 x 20 bilinear quads, E = 2.1e9 Pa, released from a quarter of its slenderness angle.

    General finite-element codes need 10 to 25 CPU seconds a simulated second with small strain, 60 to 95 with finite
    rotation.
    """
    changes = ("container.boxes=1", "container.section=solid", "container.youngs_modulus_Pa=2.1e9")
    changes += ("solver.model=full", "solver.order=1", "solver.element_size_m=0.05", "solver.duration_s=1")
    tilt = 0.25 * math.atan(1.1)
    case = load_case("free_rocking", [*changes, f"initial.rotation_rad={tilt}"])
    return median_of(3, lambda: stepped(case)[1])


def full_stack() -> Measured:
    """Milliseconds a step of the shell stack with all nodes, in free rocking."""
    changes = ("solver.model=full", "floor.kind=rigid", "motion.kind=none", "initial.rotation_rad=0.05")
    model, cpu = stepped(load_case("rocking", [*changes, "solver.duration_s=1.5"]))
    return 1e3 * cpu / int(model.run.clock[0].steps)


def reduced(kind: str) -> float:
    """CPU seconds of stepping, median."""
    given = {"floor.kind": "rigid", "support.kind": kind, "solver.duration_s": 20.0}
    case = load_case("rocking").with_values(given)
    container = discretise(case)
    return median_of(5, lambda: stepped(case, container)[1])


def loose_stack(model: str) -> Measured:
    """Median over five strengths of the motion, because loose boxes that rock are chaotic."""
    base = load_case("seed_stack_plateau", ["container.joints=loose", f"solver.model={model}"])
    base = base.with_values({"floor.kind": "rigid", "solver.duration_s": 20.0})
    cases = [base.replace(scaled_motion(base, factor)) for factor in (0.92, 0.96, 1.0, 1.04, 1.08)]
    return statistics.median(stepped(case)[1] for case in cases)


ROWS, MOREAU_STEP = 200, 1e-3


def over_moreau(name: str) -> Measured:
    """CPU time of a kernel that does nothing but this over that of runs for their outcome alone, in turns.

    20 s on a floor x = 0.05 m sin(6.93 t) that starts with a jerk, in the settings of maps. The kernel: one rigid
    block, plastic impacts, steps of 1 ms, no springs, no ledger, no choice of steps.
    """
    changes = ("solver.model=rigid", "container.section=solid")
    changes += ("contact.mu_static=0.4", "contact.mu_kinetic=0.4")
    changes += ("motion.amplitude_m=0.05", "motion.angular_frequency_rad_s=6.93", "motion.start=rest")
    changes += ("solver.energy_tolerance=30", "solver.step_s=0.026", "contact.normal_penalty_Pa_m=1.2e9")
    case = load_case(name, [*changes, "solver.duration_s=20"])
    container = build_model(case).container

    def fresh() -> list[Model]:
        models = [build_model(case, container) for _ in range(ROWS)]
        none = make_samples(math.inf, 4, models[0].run.old.point.shape[0])
        kept = [one.run._replace(buffers=one.run.buffers._replace(history=none)) for one in models]
        return [replace(one, run=run) for one, run in zip(models, kept, strict=True)]

    def own(models: list[Model]) -> None:
        for one in models:
            run_to_end(one.body, one.run, 20.0)

    def moreau() -> None:
        block, contact, motion = block_of(model), case.contact, case.motion
        inertia = (block.inertia_ratio - 1.0) * block.radius**2
        slide_and_rock(
            np.tile([block.half_width, block.centroid_height, 1.0 / inertia], (ROWS, 1)),
            np.tile([contact.mu_static, contact.mu_kinetic], (ROWS, 1)),
            case.gravity_m_s2,
            np.full(ROWS, motion.amplitude_m),
            np.full(ROWS, motion.angular_frequency_rad_s),
            True,
            MOREAU_STEP,
            round(20.0 / MOREAU_STEP),
            np.zeros((ROWS, 3)),
        )

    model = build_model(case)
    own(fresh())
    moreau()  # compiled
    batches = [fresh() for _ in range(5)]
    costs = [(cpu_seconds(lambda: own(batches.pop())), cpu_seconds(moreau)) for _ in range(5)]
    rate = ROWS / statistics.median(mine for mine, _ in costs)
    return statistics.median(other / mine for mine, other in costs), f"{rate:.0f} runs a second and core"


def band(*changes: str) -> Measured:
    """CPU seconds of the band of a run of 20 s, without the run."""
    quick = ["floor.kind=rigid", "output.figures=false", "output.fields_s=0"]
    for duration in (0.2, 20.0):  # the first compiles
        case = load_case("seed_stack_plateau", [*changes, *quick, f"solver.duration_s={duration}"])
        options = RunOptions(band=False, force=True)
        run = run_case(case, case_text=case.text, folder=place() / "band", options=options).typed_result
        model, began = build_model(case), time.process_time()
        judged = with_band(model, run, stop=lambda: False)
        spent = time.process_time() - began
    return spent, f"{len(judged.band.members)} runs, {judged.sure}" if judged and judged.band else ""


# Pictures


def figures() -> Measured:
    case = load_case("seed_stack_plateau", ["output.figures=false", "output.fields_s=0"])
    run_case(case, case_text=case.text, folder=place() / "run", options=RunOptions(band=False, force=True))
    run = fem.open_run(place() / "run")
    container = discretise(run.case)
    write_figures(run, container)  # loads the fonts
    return median_of(3, lambda: cpu_seconds(lambda: write_figures(fem.open_run(run.folder), container)))


# Studies

PEAK = "motion.peak_acceleration_m_s2"


def map_seconds(sweep: Any) -> Measured:
    """Wall time of a whole sweep into a folder on two cores; compiled and loaded before."""
    run_cases([sweep.case(0), sweep.case(sweep.count - 1)], jobs=2)
    began, cpu = time.perf_counter(), time.process_time()
    info = run_sweep(sweep, Path(tempfile.mkdtemp(dir=place())) / "map", jobs=2)
    found = ", ".join(f"{word} {count}" for word, count in info["outcomes"].items())
    return time.perf_counter() - began, f"CPU {time.process_time() - cpu:.1f} s; {found}"


def outcome_map(model: str, cells: int) -> Any:
    """The shipped sweep with other axes, without copies."""
    shipped = load_sweep("outcome_map")
    alone = shipped.perturbation.model_copy(update={"cells": "none"})
    frequency = {"from": 1.5, "to": 12.0, "count": cells, "scale": "log"}
    axes = (
        read_axis("motion.angular_frequency_rad_s", frequency),
        read_axis(PEAK, {"from": 1.0, "to": 16.0, "count": cells}),
    )
    base = shipped.base.with_values({"solver.model": model})
    return replace(shipped, base=base, axes=axes, perturbation=alone)


def random_motion(seed: int) -> np.ndarray:
    """Times and a random acceleration of 40 s whose spectrum falls beyond 3 Hz, peak 1, shape (n, 2)."""
    generator, times = np.random.default_rng(seed), np.arange(0.0, 40.0025, 0.005)
    frequencies = np.fft.rfftfreq(times.size, 0.005)
    size = np.where(frequencies > 0.3, 1.0 / (1.0 + (frequencies / 3.0) ** 2), 0.0)
    noise = np.fft.irfft(size * np.exp(2j * np.pi * generator.random(frequencies.size)), times.size)
    envelope = np.clip(times / 3.0, 0.0, 1.0) * np.clip((40.0 - times) / 10.0, 0.0, 1.0)
    return np.column_stack([times, noise * envelope / np.abs(noise).max()])


ACTION = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=1.6)


def artificial() -> Measured:
    artificial_motions(ACTION, count=1, seed=1)
    return median_of(5, lambda: cpu_seconds(lambda: artificial_motions(ACTION, count=5, seed=2)) / 5)


# What words are worth: verdicts under changes that an engineer would not call another case


def ordinary_changes(case: Case) -> dict[str, dict[str, Any]]:
    contact, box = case.contact, case.container
    both = ("contact.mu_static", "contact.mu_kinetic")
    values = (contact.mu_static, contact.mu_kinetic)
    changes = {f"friction x {f}": {k: f * v for k, v in zip(both, values, strict=True)} for f in (0.9, 1.1)}
    changes |= {f"kinetic friction x {f}": {both[1]: f * contact.mu_kinetic} for f in (0.75, 0.9)}
    changes |= {f"width x {f}": {"container.width_m": f * box.width_m} for f in (0.99, 1.01)}
    changes |= {f"mass centre x {f}": {"container.centroid_m": f * box.centroid_m} for f in (0.98, 1.02)}
    changes |= {f"motion x {f}": scaled_motion(case, f) for f in (0.95, 1.05)}
    changes |= {"step": {"solver.energy_tolerance": 0.1}, "reduced": {"solver.model": "reduced"}}
    if case.motion.kind == "harmonic":
        changes |= {"phase + 0.5": {"motion.phase_rad": 0.5}}
    return changes


def random_case(seed: int) -> Case:
    """A container on any base and floor, under a motion of 0.9 to 3 times its static limit."""
    generator = np.random.default_rng(seed)
    draw, pick = generator.uniform, generator.choice
    boxes, width, static = int(pick([1, 2, 3, 4])), float(draw(0.5, 2.5)), float(draw(0.25, 0.7))
    height = float(draw(0.8, 2.5)) * width * (1.0 if boxes == 1 else 0.6)
    peak = float(draw(0.9, 3.0)) * 9.81 * min(static, width / (boxes * height))
    support = str(pick(["corners", "feet", "flat"]))
    mass = {"mass_kg": 1000.0 * width * width * height, "centroid_m": float(draw(0.42, 0.52)) * height}
    tables: dict[str, Any] = {
        "container": {"width_m": width, "height_m": height, "boxes": boxes, "wall_m": 0.008} | mass,
        "support": {"kind": support} | ({"foot_m": 0.12 * width} if support == "feet" else {}),
        "contact": {"mu_static": static, "mu_kinetic": static * float(pick([0.7, 0.9, 1.0]))},
        "motion": {"kind": "harmonic", "peak_acceleration_m_s2": peak, "frequency_Hz": float(draw(0.8, 4.0))},
        "solver": {"model": "rigid", "element_size_m": 0.25 * width, "order": 1, "duration_s": 8.0},
        "output": {"fields_s": 0.0, "figures": False},
        "floor": {"kind": "rigid"},
    }
    if pick([True, False]):
        return fem.case_from(tables)
    times, along = random_motion(seed).T
    return fem.case_from(tables | {"motion": {"kind": "none"}}).with_motion(times, peak * along)


def turned_over(seed: int) -> tuple[str, list[str]]:
    """How sure the verdict of a random case is, and the changes that turn it over."""
    try:
        case = random_case(seed)
        verdict = fem.compute(case, band=True, margin=False).verdict
    except ValueError:
        return "refused", []
    turned = []
    for name, values in ordinary_changes(case).items() if verdict.sure != "unsure" else ():
        try:
            other = fem.compute(case.with_values(values), band=False, margin=False).verdict.outcome
        except ValueError:
            continue
        if other is not None and (other == "overturned") != (verdict.outcome == "overturned"):
            turned.append(name)
    return str(verdict.sure), turned


def wrong_verdicts() -> Measured:
    """Share of the sure verdicts of 200 random cases that an ordinary change turns over."""
    with ProcessPoolExecutor(2) as pool:
        found = list(pool.map(turned_over, range(20261123, 20261323)))
    sure = [turned for word, turned in found if word == "sure"]
    decided = sum(word in ("sure", "regime unsure") for word, _ in found)
    return sum(map(bool, sure)) / max(1, len(sure)), f"{len(sure)} sure, {decided} of {len(found)} decided"


#: name, target, value of November 2026 on two cores, a star where five minutes measure it, what is measured
TABLE = """
page             <= 70    39     * first page: `run`, empty cache, without pip [s]
compiling        <= 15    32.5   * compiling for a run without its band [CPU s]
run              <= 2.5   3.5    * `run rocking --no-band` [CPU s]
default          <= 5     7.8    * `run` with band and margin, compiled [CPU s]
check            <= 0.4   0.50   * `check` [CPU s]
full-box         <= 0.6   0.44   * `full`, 966 unknowns, a simulated second [CPU s]
full-stack       <= 4     1.3    * `full`, 5238 unknowns, a step [ms]
corners          <= 0.06  0.030  * `reduced`, 20 s on two corners [CPU s]
flat             <= 0.5   0.41   * `reduced`, 20 s on a flat base [CPU s]
moreau-stack     >= 1.5   1.34   * runs of the `rigid` stack over those of a Moreau kernel
moreau-box       >= 1.5   1.50   * of the `rigid` box
loose-rigid      <= 0.15  0.09   * 20 s of a loose stack of four, `rigid` [CPU s]
loose-reduced    <= 1     0.32   * the same, `reduced` [CPU s]
band-rigid       <= 1.5   0.96   * band of the default case, `rigid` [CPU s]
band             <= 6     3.8    * band of the default case [CPU s]
figures          <= 5     1.0    * figures of a run of 20 s [CPU s]
map              <= 30    24.5   * 100 x 100 rigid cells, two cores [s]
map-reduced      <= 300   -        50 x 50 reduced cells [s]
artificial       <= 0.02  0.028  * an artificial motion with its vertical one [CPU s]
memory-run       <= 1000  279    * memory of a run with its band [MB]
memory-sweep     <= 1000  491      of the sweep `outcome_map` [MB]
memory-ensemble  <= 1000  499      of the ensemble `fragility` [MB]
memory-site      <= 1000  639      of `assess site` [MB]
site             <= 15    28     * `assess site` on two cores [s]
words            <= 0.02  0        random sure verdicts that an ordinary change turns over
"""
MEASURES: dict[str, Callable[[], Measured]] = {
    "page": lambda: out("run", cache="page").wall,
    "compiling": compiling,
    "run": lambda: median_of(5, lambda: out(*SHORT_RUN).cpu),
    "default": lambda: median_of(3, lambda: out("run").cpu),
    "check": lambda: median_of(5, lambda: cost_of("check").cpu),
    "full-box": full_box,
    "full-stack": full_stack,
    "corners": partial(reduced, "corners"),
    "flat": partial(reduced, "flat"),
    "moreau-stack": partial(over_moreau, "seed_stack"),
    "moreau-box": partial(over_moreau, "seed_box"),
    "loose-rigid": partial(loose_stack, "rigid"),
    "loose-reduced": partial(loose_stack, "reduced"),
    "band-rigid": partial(band, "solver.model=rigid"),
    "band": band,
    "figures": figures,
    "map": lambda: map_seconds(outcome_map("rigid", 100)),
    "map-reduced": lambda: map_seconds(outcome_map("reduced", 50)),
    "artificial": artificial,
    "memory-run": partial(memory_of, "run", "rocking"),
    "memory-sweep": partial(memory_of, "sweep", "outcome_map", "-j", "2"),
    "memory-ensemble": partial(memory_of, "ensemble", "fragility", "-j", "2"),
    "memory-site": partial(memory_of, "assess", "site", "-j", "2"),
    "site": lambda: out("assess", "site", "-j", "2").wall,
    "words": wrong_verdicts,
}


def main() -> int:
    """Measure and print; 1 if a target is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("names", nargs="*", help="of rows, or how they begin")
    parser.add_argument("--list", action="store_true", help="print the table without measuring")
    parser.add_argument("--all", action="store_true", help="measure every row")
    given = parser.parse_args()
    chosen = [
        row
        for row in TABLE.strip().splitlines()
        if (row.startswith(tuple(given.names)) if given.names else " * " in row or given.all or given.list)
    ]
    missed = 0
    for row in chosen:
        print(row, end="" if not given.list else "\n", flush=True)
        if given.list:
            continue
        name, sign, target, *_ = row.split()
        found = MEASURES[name]()
        value, details = found if isinstance(found, tuple) else (found, "")
        reached = value >= float(target) if sign == ">=" else value <= float(target)
        missed += not reached
        print(f": {value:.3g}{'' if reached else ' MISSED'}  {details}")
    return int(missed > 0 or not chosen)


if __name__ == "__main__":
    sys.exit(main())
