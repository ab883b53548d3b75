"""How long a run lasts, by its tables [solver], [motion] and [vertical]."""

from typing import Any

#: simulated time of duration_s = "auto" where the floor stands or moves harmonically [s]
USUAL_DURATION = 20.0
#: time after the end of a pulse or a table in which the container comes to rest or falls, at most [s]
MOST_FREE_MOTION = 60.0


def ends_at_rest(case: Any) -> bool:
    """Whether a run ends where the container comes to rest after its motions, and not at a given time."""
    kinds = {case.motion.kind, case.vertical.kind} - {"none"}
    return case.solver.duration_s == "auto" and bool(kinds) and kinds <= {"pulse", "table"}


def longest_time(case: Any) -> float:
    """Simulated time of a case, at most [s]; of a table without duration, the free motion after it alone."""
    if case.solver.duration_s != "auto":
        return float(case.solver.duration_s)
    if not ends_at_rest(case):
        return USUAL_DURATION
    pulses = [motion for motion in (case.motion, case.vertical) if motion.kind == "pulse"]
    return max([0.0, *(pulse.delay_s + (pulse.pulse_s or 0.0) for pulse in pulses)]) + MOST_FREE_MOTION


def duration_in_words(case: Any) -> str:
    """The simulated time as a case file has it, with its upper bound."""
    time = f"{longest_time(case):g} s"
    return (
        f"duration_s = {time}" if case.solver.duration_s != "auto" else f'duration_s = "auto", up to {time}'
    )
