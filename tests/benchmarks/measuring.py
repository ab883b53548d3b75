"""What the benchmark scripts share: a case stepped without files, medians, and one table of figures.

Every script is run by hand (`python tests/benchmarks/NAME.py`), prints measured values beside their targets, and ends
with exit code 1 if a target is missed. CPU time is that of the process; compilation is not included. They are
not part of the test suite: a slow machine fails no test.
"""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from fem.assessment.verdict import GAIN_LIMIT
from fem.case.case import Case
from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.results.history import History
from fem.run.recorder import Recorder
from fem.run.simulation import SimulationEnd, simulate
from fem.solid.nodal_body import advance_body

#: the homogeneous box of 2500 kg used to measure general finite-element codes: 22 x 20 bilinear quads
BENCHMARK_BOX = (
    "container.boxes=1",
    "container.section=solid",
    "container.youngs_modulus_Pa=2.1e9",
    "solver.model=full",
    "solver.order=1",
    "solver.element_size_m=0.05",
)
WARMING = 0.002  # s, simulated to have the kernels compiled and loaded


@dataclass(frozen=True)
class Figure:
    """One line of a benchmark's table."""

    what: str
    measured: str
    target: str = ""
    reached: bool | None = None  #: None: for information only


def at_most(what: str, value: float, limit: float, form: str = ".2f", *, details: str = "") -> Figure:
    """A value that must not exceed a limit."""
    return Figure(what, f"{value:{form}}{details}", f"<= {limit:g}", value <= limit)


def at_least(what: str, value: float, limit: float, form: str = ".2f") -> Figure:
    """A value that must not be less than a limit."""
    return Figure(what, f"{value:{form}}", f">= {limit:g}", value >= limit)


def near(
    what: str, value: float, exact: float, accuracy: float, form: str = ".4f", *, details: str = ""
) -> Figure:
    """A value that must be near its reference, by an absolute difference."""
    target = f"{exact:{form}} within {accuracy:.2g}"
    return Figure(what, f"{value:{form}}{details}", target, abs(value - exact) <= accuracy)


@dataclass(frozen=True, eq=False)
class Stepped:
    """A case stepped to its end, and its cost."""

    model: Model
    history: History
    ending: SimulationEnd

    @property
    def cpu_s(self) -> float:
        """CPU time of the stepping loop alone [s]."""
        return self.ending.stepping_cpu_s

    @property
    def steps(self) -> int:
        return int(self.model.run.clock[0].steps)

    @property
    def rotation_ratio(self) -> float:
        """Largest rotation over the slenderness angle [-]."""
        return float(self.model.run.track[0].max_rotation) / self.model.static.slenderness_angle

    @property
    def rejected_share(self) -> float:
        """Rejected steps over all that were tried [-]."""
        clock = self.model.run.clock[0]
        return float(clock.rejected) / max(float(clock.rejected + clock.steps), 1.0)

    @property
    def ledger(self) -> Figure:
        """Whether the run passes: steps solved and energy balanced."""
        clock, reference = self.model.run.clock[0], self.model.run.problem.control.reference_energy
        gained, lost = -float(clock.least_imbalance) / reference, float(clock.most_imbalance) / reference
        return Figure(
            "status; energy gained and lost over that to overturn",
            f"{self.ending.status}; {gained:.1e}, {lost:.1e}",
            f"not failed; gained <= {GAIN_LIMIT:g}",
            self.ending.status != "failed",
        )


def stepped(case: Case, container: Container | None = None) -> Stepped:
    """Step a case to its end, without files, fields or stresses; kernels are compiled before the clock starts."""
    model = build_model(case, container)
    warm = build_model(case, model.container)
    advance_body(warm.body, warm.run, min(WARMING, case.solver.duration_s))
    recorder = Recorder(model)
    ending = simulate(model, recorder)
    return Stepped(model, recorder.history(), ending)


def cpu_seconds(work: Callable[[], object]) -> float:
    """CPU time that a call takes in this process [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


def median_of(repeats: int, measure: Callable[[], float]) -> float:
    """Median over repeated measurements."""
    return statistics.median(measure() for _ in range(repeats))


def report(title: str, figures: Sequence[Figure]) -> int:
    """Print the table; exit code 1 if a target is missed."""
    marks = {True: "reached", False: "MISSED", None: ""}
    rows = [(one.what, one.measured, one.target, marks[one.reached]) for one in figures]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    print(title)
    for row in rows:
        cells = (text.ljust(width) for text, width in zip(row, widths, strict=True))
        print(f"  {'  '.join(cells)}".rstrip())
    return int(any(one.reached is False for one in figures))
