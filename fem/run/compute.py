"""A run in memory, for scripts and notebooks: `fem.compute(case)` gives what `python -m fem run` writes."""

import sys
from dataclasses import dataclass, replace
from html import escape
from typing import TYPE_CHECKING, Any

from fem.case.case import Case, case_hash
from fem.case.validation import CaseError
from fem.model.container import Container, discretise
from fem.model.geometry import build_container
from fem.model.model import build_model
from fem.model.motion import build_motions
from fem.model.recovery import recovery_of
from fem.results.fields import Fields, Frame, FrameKeeper
from fem.results.history import History
from fem.results.reader import pyvista_grid
from fem.results.run_result import RunResult, Verdict
from fem.run.checks import WantedChecks, add_checks
from fem.run.drawn_links import LinkCells
from fem.run.opened import plotted
from fem.run.output import Stopwatch
from fem.run.recorder import Recorder
from fem.run.solve import begun, in_words, resolve, stepped
from fem.runtime.compilation import compilation_announced
from fem.runtime.progress import Reporter
from fem.runtime.signals import stop_requested
from fem.runtime.terminal import say
from fem.runtime.threads import use_one_blas_thread

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem.results.reader import UnstructuredGrid


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """A finished run in memory. SI units; x to the right, z up, rotation > 0 toward +x."""

    case: Case  #: with every default and "auto" replaced
    typed_result: RunResult  #: the result as typed data
    history: History  #: `run.history["rotation_rad"]` is a column (numpy), `run.history.modes` the states
    fields: Fields  #: `run.fields.times`, `run.fields.frame(0)`; empty with output.fields_s = 0

    def __repr__(self) -> str:
        """One line, for a notebook."""
        return f"<run {self.case.name!r}: {self.status}, {self.verdict.outcome}>"

    def _repr_html_(self) -> str:
        """That line, and the card of the verdict."""
        return f"<p>{escape(repr(self))}</p><p>{self.verdict._repr_html_()}</p>"

    @property
    def status(self) -> str:
        """Status of the run: completed | overturned | failed; `run.result["error"]` says why it failed."""
        return self.typed_result.status

    @property
    def verdict(self) -> Verdict:
        """Outcome, extremes and events: `run.verdict.sure`, or by its key in the file, `run.verdict["sure"]`."""
        return self.typed_result.verdict or Verdict()

    @property
    def result(self) -> dict[str, Any]:
        """As in `run.json`."""
        return self.typed_result.to_json()

    def frame(self, time: float) -> Frame:
        """The frame of the fields nearest to a time [s].

        Raises:
            FieldError: there is none of that time; a ValueError.
        """
        return self.fields.frame(self.fields.index_at(time))

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.case.name

    @property
    def slenderness_angle(self) -> float:
        """Slenderness angle: beyond it the container falls if left alone [rad]."""
        static = self.typed_result.static
        assert static is not None and static.slenderness_angle_rad is not None
        return static.slenderness_angle_rad

    @property
    def rigid_check(self) -> None:
        """The table of the analytic block, which is in a folder only."""

    def plot(self, name: str = "rotation", ax: "Axes | None" = None) -> "Figure":
        """A figure of the run, see `plotted`: `run.plot("slip").savefig("slip.png")`."""
        return plotted(self, name, ax)

    def grid(self, time: float) -> "UnstructuredGrid":
        """The frame nearest to a time [s] as a pyvista grid in the x-y plane, where the container stood.

        `run.grid(1.5).warp_by_vector("displacement_m").plot(scalars="von_mises_Pa", cpos="xy")`

        Raises:
            FieldError: there is no frame of that time; a ValueError.
        """
        return pyvista_grid(self.frame(time))


def compute(
    case: Case, *, band: bool | None = None, margin: bool | None = None, check_rigid: bool = False
) -> Run:
    """Compute a case in memory; no file is written.

    It is the computation of `python -m fem run`, with the same numbers. The first one after installation compiles the
    time stepping for half a minute or more. BLAS is kept to one thread from then on in this process, because
    the bits of a run must not depend on the number of cores.

    Args:
        case: from `fem.load_case` or `fem.case_from`.
        band: repeat the run over its unknown inputs, for `verdict.sure`; default: all but a plain rest
            and the full model, as the command.
        margin: repeat it under stronger and weaker motions, for `verdict.margin`; default: where that takes
            seconds, unless `band` is False.
        check_rigid: compare it with the analytic rigid block.

    Returns:
        The run. One whose solution failed has the status "failed" and no outcome.

    Raises:
        CaseError, MeshError: the case cannot be computed; both are a ValueError with the message of the command.
    """
    require_case(case)
    return compute_on(None, case, WantedChecks(check_rigid=check_rigid, band=band, margin=margin))


def require_case(given: object) -> None:
    """Refuse what is no case, such as its name.

    Raises:
        CaseError: it is none.
    """
    if not isinstance(given, Case):
        raise CaseError(f"a case from fem.load_case or fem.case_from is needed, got {type(given).__name__}")


def compute_on(container: Container | None, case: Case, wanted: WantedChecks) -> Run:
    """Compute a case in memory, on its container where that is built already; where a signal stops it, a part of that.

    Raises:
        CaseError, MeshError: as `compute`.
    """
    use_one_blas_thread()
    watch, silent = Stopwatch(), Reporter()
    mesh, motions = build_container(case), build_motions(case)
    case = resolve(case, mesh, motions)  # what is changed later on is this case, too
    with compilation_announced(lambda text: say(text, file=sys.stderr)):
        model = build_model(case, container or discretise(case, mesh), motions=motions)
        keeper = FrameKeeper(**LinkCells(model).mesh)
        recorder = Recorder(model, recovery_of(model), frame_sink=keeper.keep)
        result = begun(model, case_hash(case))
        result, history = stepped(model, result, recorder, reporter=silent, stop=stop_requested)
        result, block = add_checks(
            result, model, lambda: history, wanted, None, reporter=silent, stop=stop_requested
        )
    if block is not None:
        history = history.with_analytic(block.analytic_rotation)
    result = in_words(replace(result, **watch.spent()), case)
    return Run(case=case, typed_result=result, history=history, fields=keeper.fields)
