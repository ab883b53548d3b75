"""What the benchmark scripts share: a case stepped without files, medians, and one table of figures.

Every script is run by hand, `python tests/benchmarks/NAME.py`, prints what it measured beside what is to be
reached, and ends with exit code 1 if a figure misses. CPU time is of the process; compilation comes before the
clock starts. Nothing here is a timed test: a slow machine fails no test.
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
from fem.run.simulation import Ending, simulate
from fem.solid.nodal_body import advance_body

#: the homogeneous box of 2500 kg that general finite-element codes were measured on: 22 x 20 bilinear quads
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
    reached: bool | None = None  #: None: told for information, nothing is asked of it


@dataclass(frozen=True, eq=False)
class Stepped:
    """A case stepped to its end, and what that took."""

    model: Model
    history: History
    ending: Ending

    @property
    def cpu_s(self) -> float:
        """CPU time of the stepping loop alone [s]."""
        return self.ending.stepping_cpu_s

    @property
    def steps(self) -> int:
        return int(self.model.run.clock[0].steps)

    @property
    def rejected_share(self) -> float:
        """Rejected steps over all that were tried [-]."""
        clock = self.model.run.clock[0]
        return float(clock.rejected) / max(float(clock.rejected + clock.steps), 1.0)

    @property
    def ledger(self) -> Figure:
        """Whether the run stands: steps solved and energy accounted for."""
        clock, reference = self.model.run.clock[0], self.model.run.control.reference_energy
        won, lost = -float(clock.least_imbalance) / reference, float(clock.most_imbalance) / reference
        return Figure(
            "status; won and lost over the energy to overturn",
            f"{self.ending.status}; {won:.1e}, {lost:.1e}",
            f"not failed; won <= {GAIN_LIMIT:g}",
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
    """Print the table; exit code 1 if a figure misses its target."""
    wide = [
        max(len(text) for text in column) for column in zip(*(_cells(one) for one in figures), strict=True)
    ]
    print(title)
    for one in figures:
        print(
            "  "
            + "  ".join(text.ljust(width) for text, width in zip(_cells(one), wide, strict=True)).rstrip()
        )
    return int(any(one.reached is False for one in figures))


def _cells(figure: Figure) -> tuple[str, str, str, str]:
    mark = {True: "reached", False: "MISSED", None: ""}[figure.reached]
    return figure.what, figure.measured, figure.target, mark
