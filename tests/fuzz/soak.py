"""Soak: random valid cases to their ends, by hand: `python tests/fuzz/soak.py rigid 1000`.

Each must end: completed or overturned with its ledger closed and an outcome of the list, failed with a reason, or
refused with one. What takes longer than a minute is stuck. Prints what was found, and every odd one by its number.
"""

import collections
import sys
import time
import traceback

from random_cases import random_case

from fem.assessment.verdict import GAIN_LIMIT, LOSS_LIMIT, LOSS_SHARE_LIMIT, MODE_NAMES, energy_of, outcome_of
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

STUCK = 60.0  #: [s]
OUTCOMES = set(MODE_NAMES.values())


def end_of(number: int, model: str, longest: float) -> str:
    """How the case of this number ends, in one line; a broken promise begins with BROKEN."""
    began = time.process_time()
    try:
        case = random_case(number, model, longest)
        built = build_model(case)
        ending = simulate(built, Recorder(built), stop=lambda: time.process_time() - began > STUCK)
    except Exception as error:
        if type(error).__module__.partition(".")[0] not in ("fem", "mesh", "contact"):
            return "BROKEN " + traceback.format_exc()
        return f"refused: {error}"
    if ending.status == "interrupted":
        clock = built.run.clock[0]
        return f"BROKEN stuck at t = {clock.time} of {case.solver.duration_s} s, {clock.steps} steps"
    if ending.status == "failed":
        return f"failed: {ending.error}"
    outcome, energy = outcome_of(built), energy_of(built)
    if outcome not in OUTCOMES or (outcome == "overturned") != (ending.status == "overturned"):
        return f"BROKEN outcome {outcome} of a run that {ending.status}"
    dissipated = energy.friction_J + energy.contact_damping_J + energy.material_damping_J
    limit = max(LOSS_SHARE_LIMIT * dissipated, max(LOSS_LIMIT, GAIN_LIMIT) * energy.reference_J)
    if ending.status == "completed" and not abs(energy.numerical_J) <= limit:
        return f"BROKEN ledger: {energy}"
    return outcome


def soak(model: str, count: int, first: int = 0, longest: float = 20.0) -> int:
    """Run the cases and print the sum; exit code 1 if a promise was broken."""
    ends: collections.Counter[str] = collections.Counter()
    end_of(0, model, 0.1)  # compiles
    slowest, broken, began = (0.0, -1), 0, time.process_time()
    for number in range(first, first + count):
        start = time.process_time()
        end = end_of(number, model, longest)
        slowest = max(slowest, (time.process_time() - start, number))
        ends[end.partition(":")[0].split()[0]] += 1
        broken += end.startswith("BROKEN")
        if end.startswith(("BROKEN", "failed", "refused")):
            print(number, end, flush=True)
    print(
        f"{model}: {dict(ends)}; {time.process_time() - began:.0f} s of CPU, slowest {slowest[0]:.1f} s "
        f"(number {slowest[1]})"
    )
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(soak(sys.argv[1], int(sys.argv[2]), *(int(word) for word in sys.argv[3:4])))
