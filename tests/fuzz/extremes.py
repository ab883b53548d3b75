"""Extremes that must be computed or refused with a reason, by hand: `python tests/fuzz/extremes.py`."""

import sys
import time

from fem.case.case import load_case
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

STUCK = 120.0  #: [s]
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


def end_of(overrides: tuple[str, ...], model: str) -> str:
    """How a case of the default stack with these keys ends, in one line."""
    began = time.process_time()
    try:
        built = build_model(load_case("seed_stack_plateau", [*SHORT, f"solver.model={model}", *overrides]))
        ending = simulate(built, Recorder(built), stop=lambda: time.process_time() - began > STUCK)
    except ValueError as error:
        if type(error).__module__.partition(".")[0] not in ("fem", "mesh", "contact"):
            raise
        return f"refused: {error}"
    return f"{ending.status}{': ' + ending.error if ending.error else ''}"


if __name__ == "__main__":
    broken = 0
    for model in sys.argv[1:] or ("rigid", "reduced"):
        for overrides in EXTREMES:
            start = time.process_time()
            end = end_of(overrides, model)
            broken += end == "interrupted"
            print(f"{model} {' '.join(overrides)}: {end} ({time.process_time() - start:.1f} s)", flush=True)
    sys.exit(int(broken > 0))
