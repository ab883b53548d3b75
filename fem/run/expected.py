"""How long a computation will take, roughly, said before it begins where that is long."""

from fem.case.case import Case
from fem.case.tables.duration import ends_at_rest, longest_time
from fem.runtime.progress import Reporter, clock_time

LONG_S = 20.0  #: from which it is said
#: processor time of a run, and of each of its simulated seconds, on corners [s]: the shipped stack (`bench.py`)
OF_A_RUN = {"rigid": 0.002, "reduced": 0.02, "full": 1.0}
OF_A_SECOND = {"rigid": 0.0004, "reduced": 0.003, "full": 3.0}
#: factor of a base, whose contact has more points (of the full model the mesh costs more than they do)
OF_A_BASE = {"corners": 1.0, "feet": 3.0, "flat": 8.0}
OF_LOOSE_BOXES = 15.0
USUAL_RECORD_S = 25.0  #: simulated, of a record until the container is at rest
BAND_RUNS, MOST_OF_BAND_S = 130, 45.0  #: of band and margin; processor time


def of_a_second(case: Case) -> float:
    """Processor time of a simulated second, within a factor of three or so [s]."""
    model = case.solver.model
    factor = 1.0 if model == "full" else OF_A_BASE[case.support.kind]
    if case.container.joints == "loose":
        factor *= OF_LOOSE_BOXES
    return factor * OF_A_SECOND[model]


def expected_s(case: Case, *, record: bool = False) -> float:
    """Processor time of one run of a case, or under a record of usual length, within a factor of three or so [s]."""
    simulated = USUAL_RECORD_S if record or ends_at_rest(case) else longest_time(case)
    return OF_A_RUN[case.solver.model] + of_a_second(case) * simulated


def of_its_band_s(run_s: float) -> float:
    """Processor time of band and margin of a run that takes `run_s` [s]."""
    return min(BAND_RUNS * run_s, MOST_OF_BAND_S)


def expected_words(seconds: float, cores: int = 1) -> str:
    """A wall time of which one figure is known, and the cores that it is for: "roughly 2 min 00 s on 2 cores"."""
    on = f" on {cores} cores" if cores > 1 else ""
    return f"roughly {clock_time(float(f'{seconds:.1g}'))}{on}"


def say_expected(reporter: Reporter, what: str, seconds: float, cores: int = 1) -> None:
    """Tell how long something takes on these cores, where that is long; `seconds` of wall time."""
    if seconds > LONG_S:
        reporter.message(f"{what}: {expected_words(seconds, cores)}")
