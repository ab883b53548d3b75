"""Runs per second and core of the `rigid` model, with the accuracy of the same settings.

20 s of a homogeneous stack, and of a box, on a floor x = 0.05 m sin(6.93 t) that starts with a jerk, many runs
for their outcome alone, on one thread. Accuracy: free rocking of the stack from half its slenderness angle with the
same penalty and step control; the first six ratios of successive peaks against the closed form of the rigid block.
A multibody engine tuned for this makes 30 (stack) and 7 (box) runs.

In turns with them, a kernel that does nothing but this (`moreau.slide_and_rock`): one rigid block, plastic impacts,
steps of 1 ms, no springs, no ledger, no choice of steps.
"""

import math
import statistics
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from measuring import Figure, at_least, at_most, cpu_seconds, report, stepped

from contact.reference.rigid_block import RigidBlock
from contact.stepping.integrator import FAILED
from contact.stepping.outcome import run_to_end
from contact.stepping.state import make_samples
from fem.assessment.rigid_check import block_of
from fem.case.case import Case, load_case
from fem.model.model import Model, build_model

sys.path.extend(str(Path(__file__).parents[1] / name) for name in ("", "rigs"))
from closed_forms_rocking import peak_after_impacts
from moreau import slide_and_rock_batch
from verification.rocking import turning_points

REPEATS, ROWS = 5, 200
DURATION = 20.0  # s
STACK_RATE, BOX_RATE = 500.0, 100.0  # runs per second and core
OVER_MOREAU, MOREAU_STEP = 1.5, 1e-3  # ratio of rates; s
ACCURACY, COUNT = 0.02, 6
STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
#: settings of maps; the penalty is that of the stack and of the box
SETTING = ("solver.energy_tolerance=30", "solver.step_s=0.026", "contact.normal_penalty_Pa_m=1.2e9")
JERK = ("solver.model=rigid", "container.section=solid", "contact.mu_static=0.4", "contact.mu_kinetic=0.4")
FLOOR = ("motion.amplitude_m=0.05", "motion.angular_frequency_rad_s=6.93", "motion.start=rest")


def throughput(case: Case) -> tuple[float, str, float]:
    """Runs per second of one core, what a run does, and the rate over that of the Moreau kernel."""
    container = build_model(case).container

    def fresh() -> list[Model]:
        models = [build_model(case, container) for _ in range(ROWS)]
        no_samples = make_samples(math.inf, 4, models[0].run.old.point.shape[0])
        return [
            replace(model, run=model.run._replace(buffers=model.run.buffers._replace(history=no_samples)))
            for model in models
        ]

    def step(models: list[Model]) -> list[int]:
        return [run_to_end(model.body, model.run, DURATION).status for model in models]

    models = fresh()
    failed = step(models).count(FAILED)  # compiles
    if failed:
        raise RuntimeError(f"{case.name}: {failed} rows of {ROWS} failed")
    moreau(models[0])
    batches = [fresh() for _ in range(REPEATS)]
    costs = [(cpu_seconds(lambda: step(batches.pop())), moreau(models[0])[0]) for _ in range(REPEATS)]
    run, model = models[0].run, models[0]
    ratio = float(run.track.max_rotation[0]) / model.static.slenderness_angle
    what = (
        f"penalty {model.penalty:.3g} Pa/m, {int(run.clock.steps[0])} steps, "
        f"rotation ratio {ratio:.4f}, slip {1e3 * float(run.joints.max_slip[0]):.2f} mm; "
        f"Moreau {moreau(model)[1]}"
    )
    own = statistics.median(own for own, _ in costs)
    return ROWS / own, what, statistics.median(other / own for own, other in costs)


def moreau(model: Model) -> tuple[float, str]:
    """CPU time of as many runs of the Moreau kernel [s], and what one does."""
    block, contact, motion = block_of(model), model.case.contact, model.case.motion
    shape = block.half_width, block.centroid_height
    inertia = (block.inertia_ratio - 1.0) * block.radius**2
    friction = np.tile([contact.mu_static, contact.mu_kinetic], (ROWS, 1))
    found, steps = np.zeros((ROWS, 3)), round(DURATION / MOREAU_STEP)
    seconds = cpu_seconds(
        lambda: slide_and_rock_batch(
            np.tile([*shape, 1.0 / inertia], (ROWS, 1)),
            friction,
            model.case.gravity_m_s2,
            np.full(ROWS, motion.amplitude_m),
            np.full(ROWS, motion.angular_frequency_rad_s),
            motion.start == "rest",
            MOREAU_STEP,
            steps,
            found,
        )
    )
    ratio, slip = found[0, 0] / block.slenderness_angle, 1e3 * found[0, 1]
    return seconds, f"{ROWS / seconds:.0f} runs, ratio {ratio:.4f}, slip {slip:.2f} mm"


def accuracy() -> Figure:
    """Free rocking of the rigid stack with the settings of the maps, against Housner's block."""
    run = stepped(load_case("free_rocking", ["solver.model=rigid", "output.history_s=0.001", *SETTING]))
    start, restitution = 0.5 * STACK.slenderness_angle, STACK.housner_restitution
    exact = np.array([peak_after_impacts(STACK, start, n, restitution) for n in range(COUNT + 1)])
    peaks = np.array([start, *turning_points(run.history)[:COUNT]])
    error = float(np.abs(peaks[1:] / peaks[:-1] / (exact[1:] / exact[:-1]) - 1.0).max())
    what = f"free rocking of the stack, {COUNT} ratios of successive peaks: largest relative error"
    return at_most(what, error, ACCURACY, ".4f", details=f" (penalty {run.model.penalty:.3g} Pa/m)")


def main() -> int:
    figures = []
    for name, limit in (("seed_stack", STACK_RATE), ("seed_box", BOX_RATE)):
        rate, what, over = throughput(
            load_case(name, [*JERK, *FLOOR, *SETTING, f"solver.duration_s={DURATION}"])
        )
        figures += [
            Figure(f"{name}: runs per second and core", f"{rate:.0f}", f">= {limit:g}", rate >= limit),
            Figure(f"{name}: one run", what),
            at_least(f"{name}: rate over that of the Moreau kernel", over, OVER_MOREAU),
        ]
    title = f"rigid model, 20 s on a floor that starts with a jerk; {', '.join(SETTING)}"
    return report(title, [*figures, accuracy()])


if __name__ == "__main__":
    sys.exit(main())
