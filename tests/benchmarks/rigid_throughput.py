"""Runs per second and core of the `rigid` model, at a setting whose accuracy is measured beside it.

20 s of a homogeneous stack, and of a box, on a floor x = 0.05 m sin(6.93 t) that starts with a jerk, many runs
for their outcome alone, on one thread. Accuracy: free rocking of the stack from half its slenderness angle with the
same penalty and step control; the first six ratios of successive peaks and the first six half periods against
the closed forms of the rigid block. A multibody engine tuned for this makes 30 (stack) and 7 (box) runs.
"""

import math
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
from measuring import Figure, cpu_seconds, median_of, report, stepped

from contact.reference.closed_forms_rocking import peak_after_impacts, quarter_period
from contact.reference.rigid_block import RigidBlock
from contact.stepping.integrator import FAILED
from contact.stepping.outcome import run_to_end
from contact.stepping.state import make_samples
from fem.case.case import Case, load_case
from fem.model.model import Model, build_model

REPEATS, ROWS = 5, 200
DURATION = 20.0  # s
STACK_RATE, BOX_RATE = 500.0, 100.0  # runs per second and core
ACCURACY, COUNT = 0.02, 6
STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
#: as maps would be computed; the penalty is the one chosen for the stack and for the box
SETTING = ("solver.energy_tolerance=10", "solver.step_s=0.024", "contact.normal_penalty_Pa_m=1.2e9")
JERK = ("solver.model=rigid", "container.section=solid", "contact.mu_static=0.4", "contact.mu_kinetic=0.4")
FLOOR = ("motion.amplitude_m=0.05", "motion.angular_frequency_rad_s=6.93", "motion.start=rest")


def throughput(case: Case) -> tuple[float, str]:
    """Runs per second of one core, and details of a run."""
    container = build_model(case).container

    def fresh() -> list[Model]:
        models = [build_model(case, container) for _ in range(ROWS)]
        no_samples = make_samples(math.inf, 4, models[0].run.old.point.shape[0])
        return [replace(model, run=model.run._replace(history=no_samples)) for model in models]

    def step(models: list[Model]) -> list[int]:
        return [run_to_end(model.body, model.run, DURATION).status for model in models]

    models = fresh()
    failed = step(models).count(FAILED)  # compiles
    if failed:
        raise RuntimeError(f"{case.name}: {failed} rows of {ROWS} failed")
    batches = [fresh() for _ in range(REPEATS)]
    rate = ROWS / median_of(REPEATS, lambda: cpu_seconds(lambda: step(batches.pop())))
    run, model = models[0].run, models[0]
    ratio = float(run.track.max_rotation[0]) / model.static.slenderness_angle
    return rate, (
        f"penalty {model.penalty:.3g} Pa/m, {int(run.clock.steps[0])} steps, "
        f"rotation ratio {ratio:.4f}, slip {1e3 * float(run.track.max_slip[0]):.2f} mm"
    )


def free_rocking() -> tuple[np.ndarray, np.ndarray, float]:
    """Peaks (7,) [rad], times of rotation zero (7,) [s] and penalty of the rigid stack's free rocking."""
    run = stepped(load_case("free_rocking", ["solver.model=rigid", "output.history_s=0.001", *SETTING]))
    time, rotation = run.history["time_s"], run.history["rotation_rad"]
    before = np.flatnonzero(np.signbit(rotation[1:]) != np.signbit(rotation[:-1]))[: COUNT + 1]
    a, b = rotation[before], rotation[before + 1]
    zeros = time[before] + (time[1] - time[0]) * a / (a - b)
    size = np.abs(rotation)
    swings = pairwise([0, *before.tolist()])
    peaks = np.array([_vertex(size, first + int(np.argmax(size[first:last]))) for first, last in swings])
    return peaks, zeros, run.model.penalty


def _vertex(values: np.ndarray, k: int) -> float:
    """Height of the parabola through a largest sample and its neighbours."""
    if k == 0:
        return float(values[0])
    left, middle, right = values[k - 1 : k + 2]
    return float(middle - (right - left) ** 2 / (8.0 * (left - 2.0 * middle + right)))


def accuracy() -> list[Figure]:
    peaks, zeros, penalty = free_rocking()
    start, restitution = 0.5 * STACK.slenderness_angle, STACK.housner_restitution
    exact = np.array([peak_after_impacts(STACK, start, n, restitution) for n in range(COUNT + 1)])
    ratios = peaks[1:] / peaks[:-1]
    halves = np.diff(zeros)
    exact_halves = np.array([2.0 * quarter_period(STACK, peak) for peak in exact[1:]])
    rows = []
    for what, found, wanted in (
        ("ratios of successive peaks", ratios[:COUNT], (exact[1:] / exact[:-1])[: len(ratios)]),
        ("half periods [s]", halves[:COUNT], exact_halves),
    ):
        error = float(np.abs(found / wanted - 1.0).max())
        rows.append(
            Figure(
                f"free rocking of the stack, {len(found)} {what}: largest error",
                f"{100.0 * error:.2f} % (penalty {penalty:.3g} Pa/m)",
                f"<= {100.0 * ACCURACY:g} %",
                error <= ACCURACY,
            )
        )
    return rows


def main() -> int:
    figures = []
    for name, limit in (("seed_stack", STACK_RATE), ("seed_box", BOX_RATE)):
        rate, what = throughput(load_case(name, [*JERK, *FLOOR, *SETTING, f"solver.duration_s={DURATION}"]))
        figures.append(
            Figure(f"{name}: runs per second and core", f"{rate:.0f}", f">= {limit:g}", rate >= limit)
        )
        figures.append(Figure(f"{name}: one run", what))
    return report(
        f"rigid model, 20 s on a floor that starts with a jerk; {', '.join(SETTING)}", figures + accuracy()
    )


if __name__ == "__main__":
    sys.exit(main())
