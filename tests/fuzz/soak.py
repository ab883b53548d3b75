"""Soak: random valid cases, or extreme ones, to their ends: `python tests/fuzz/soak.py rigid 1000 | extremes [MODEL]`.

Each must end: completed or overturned with its energy balance closed and an outcome of the list, failed with a reason,
or refused with one. A random case is stuck after a minute of CPU time, an extreme one after two. Odd ones are printed.
"""

import collections
import sys
import time
import traceback
from collections.abc import Callable

from random_cases import random_case

from fem.case.case import Case, load_case
from fem.model.model import build_model
from fem.results.outcome import Outcome
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.run.verdict import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT, energy_of, outcome_of

STUCK, STUCK_EXTREME = 60.0, 120.0  #: CPU time [s]
SHORT = ("solver.duration_s=2", "output.fields_s=0", "solver.element_size_m=0.5")
BLOCK = ("container.section=solid",)


def axis(key: str, *values: object, beside: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Cases that differ in one key."""
    return [(f"{key}={value}", *beside) for value in values]


EXTREMES: list[tuple[str, ...]] = [
    *axis("container.youngs_modulus_Pa", 1e6, 1e8, 1e10, 1e13),
    *axis("container.width_m", 0.02, 0.05, 5.0, 20.0, beside=(*BLOCK, "container.density_kg_m3=2000.0")),
    *axis("container.boxes", 1, 2, 10, 50),
    *axis("contact.mu_static", 0.0, beside=("contact.mu_kinetic=0.0",)),
    *axis("contact.mu_static", 1.0, 5.0),
    *axis("motion.amplitude_m", 0.0, 1e-6, 1.0, 10.0),
    *axis("motion.frequency_Hz", 0.01, 1.0, 10.0, 100.0, beside=("motion.amplitude_m=0.001",)),
    *axis("solver.duration_s", 1e-3, 0.1, 100.0),
    *axis("solver.duration_s", 1e4, beside=("output.history_s=0.1", "motion.amplitude_m=0.5")),
    *axis("container.wall_m", 1e-6, 1e-4, 0.1, 0.3, 0.49, beside=("container.wall_density_kg_m3=50.0",)),
    *axis("support.kind", "feet", "flat"),
]


def extreme(overrides: tuple[str, ...], model: str) -> Case:
    """The default stack with these keys."""
    return load_case("seed_stack_plateau", [*SHORT, f"solver.model={model}", *overrides])


def end_of(make: Callable[[], Case], stuck: float = STUCK) -> str:
    """How a case ends, in one line; a broken promise begins with BROKEN."""
    began = time.process_time()
    try:
        built = build_model(make())
        ending = simulate(built, Recorder(built), stop=lambda: time.process_time() - began > stuck)
    except Exception as error:
        if type(error).__module__.partition(".")[0] not in ("fem", "mesh", "contact"):
            return "BROKEN " + traceback.format_exc()
        return f"refused: {error}"
    if ending.status == "interrupted":
        clock = built.run.clock[0]
        return f"BROKEN stuck at t = {clock.time} of {built.case.solver.duration_s} s, {clock.steps} steps"
    if ending.status == "failed":
        return f"failed: {ending.error}"
    outcome, energy = outcome_of(built), energy_of(built)
    if outcome not in tuple(Outcome) or (outcome == "overturned") != (ending.status == "overturned"):
        return f"BROKEN outcome {outcome} of a run that {ending.status}"
    dissipated = (
        energy.friction_J + energy.contact_damping_J + energy.material_damping_J + (energy.crushing_J or 0.0)
    )
    limit = max(LOSS_SHARE_LIMIT * dissipated, max(LOSS_LIMIT, GAIN_LIMIT) * energy.reference_J)
    if ending.status == "completed" and not abs(energy.numerical_J) <= limit:
        return f"BROKEN energy balance: {energy}"
    return outcome


def soak(names: dict[str, Callable[[], Case]], stuck: float = STUCK) -> int:
    """Run the cases and print the sum; exit code 1 if a promise was broken."""
    ends: collections.Counter[str] = collections.Counter()
    slowest, began = (0.0, ""), time.process_time()
    for name, make in names.items():
        start = time.process_time()
        end = end_of(make, stuck)
        slowest = max(slowest, (time.process_time() - start, name))
        ends[end.partition(":")[0].split()[0]] += 1
        if end.startswith(("BROKEN", "failed", "refused")):
            print(name, end, flush=True)
    print(
        f"{dict(ends)}; {time.process_time() - began:.0f} s of CPU, slowest {slowest[0]:.1f} s ({slowest[1]})"
    )
    return int(ends["BROKEN"] > 0)


if __name__ == "__main__":
    kind, *rest = sys.argv[1:]
    if kind == "extremes":
        model = rest[0] if rest else "rigid"
        cases = {" ".join(keys): lambda keys=keys: extreme(keys, model) for keys in EXTREMES}
        sys.exit(soak(cases, STUCK_EXTREME))
    numbers = range(int(rest[1]) if rest[1:] else 0, int(rest[0]))
    sys.exit(soak({str(number): lambda number=number: random_case(number, kind) for number in numbers}))
