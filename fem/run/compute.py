"""The computation of a run: a resolved case, stepping until done, the checks, the result in numbers and words.

`fem.compute(case)` keeps it in memory and gives what `python -m fem run` writes; `fem.run.run` keeps it in a folder.
The checks are the rigid block, the band over unknown inputs and the margin; all can be added to a run that was
finished without them.
"""

import importlib
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from contact.motion.base_motion import BaseMotion
from fem.case.case import Case, case_hash
from fem.case.tables.duration import ends_at_rest, longest_time
from fem.case.tables.links import TieTable
from fem.case.validation import CaseError
from fem.model.container import Container, discretise
from fem.model.floor_numbers import floor_result
from fem.model.frames import frame_interval
from fem.model.geometry import build_container, node_count
from fem.model.links import heights_of_links
from fem.model.model import Model, build_model
from fem.model.motion import build_motions, longest_run, motion_result
from fem.model.recovery import recovery_of
from fem.model.static_checks import static_checks_of
from fem.model.step_size import largest_step_of
from fem.model.support import normal_penalty
from fem.results.fields import Fields, Frame, FrameKeeper
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.level import SURE
from fem.results.reader import RunData
from fem.results.run_result import LinkResult, Numerics, RigidCheckResult, RunResult
from fem.run.band import ChangedRunsFile, rests_far_below_limits, wants_band, with_band
from fem.run.card import with_words
from fem.run.described import sides_of
from fem.run.drawn_links import LinkCells
from fem.run.margin import margin_of, wants_margin
from fem.run.opened import plotted
from fem.run.output import Stopwatch
from fem.run.recorder import Recorder
from fem.run.simulation import BEGINNING, Progress, simulate
from fem.run.verdict import energy_of, held_by, joint_demands, numerics_of, verdict_of
from fem.runtime.compilation import compilation_announced
from fem.runtime.identity import versions
from fem.runtime.progress import Reporter
from fem.runtime.signals import stop_requested
from fem.runtime.terminal import say
from fem.runtime.threads import use_one_blas_thread
from mesh.container import ContainerMesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem.run.rigid_check import RigidCheck


def resolve(case: Case, mesh: ContainerMesh, motions: tuple[BaseMotion, BaseMotion]) -> Case:
    """The case with every "auto" replaced by the value chosen; running it again gives the same result.

    A CaseError where the given step would step over a motion.
    """
    chosen = chosen_values(case, mesh, motions)
    return case.with_chosen(chosen) if chosen else case


def chosen_values(case: Case, mesh: ContainerMesh, motions: tuple[BaseMotion, BaseMotion]) -> dict[str, Any]:
    """What is chosen for a case where it says "auto", by dotted key.

    A duration that depends on when the container comes to rest stays "auto".
    """
    chosen: dict[str, Any] = {}
    longest = longest_run(case, *motions)
    if case.contact.normal_penalty_Pa_m == "auto" and not case.floor.is_slab:  # of a slab it follows
        chosen["contact.normal_penalty_Pa_m"] = normal_penalty(case, mesh)
    if case.solver.duration_s == "auto" and not ends_at_rest(case):
        chosen["solver.duration_s"] = longest_time(case)
    if case.solver.step_s == "auto":
        row = case.row or (case,)
        meshes = [mesh, *(build_container(container) for container in row[1:])]
        each = (static_checks_of(container, own, 0.0) for container, own in zip(row, meshes, strict=True))
        fastest = max(static.frequency_parameter for static in each)
        chosen["solver.step_s"], _ = largest_step_of(case, fastest, longest, *motions)
    if case.output.fields_s == "auto":
        chosen["output.fields_s"] = frame_interval(case, node_count(mesh, case.solver.order), longest)
    return chosen


def begun(model: Model, case_hash: str) -> RunResult:
    """The result of a run that is to be stepped: what is known before."""
    case, static, box = model.case, model.static.to_result(), model.case.container
    return RunResult(
        status="running",
        case=case.name,
        title=case.title,
        overrides=case.overrides or None,
        case_hash=case_hash,
        static=static,
        sides=sides_of(case.stack[0].width, box.depth_m, static) if box.mesh_file is None else None,
        motion=motion_result(case, model.motion, model.vertical),
        floor=floor_result(case, model.container.mesh, model.static),
        versions=versions(),
    )


def stepped(
    model: Model,
    result: RunResult,
    recorder: Recorder,
    *,
    reporter: Reporter,
    stop: Callable[[], bool],
    save: Callable[[Progress, bool], None] | None = None,
    progress: Progress = BEGINNING,
) -> tuple[RunResult, History]:
    """Step a model to its end: the result with verdict, energy and numerics, and the samples.

    Args:
        model: from its present state on; result: begun.
        recorder, reporter, stop, save, progress: as for `fem.run.simulation.simulate`.
    """
    end = simulate(model, recorder, reporter=reporter, stop=stop, save=save, progress=progress)
    case, container, history = model.case, model.container, recorder.history()
    stress = recorder.largest_von_mises if case.solver.model != "rigid" else None
    verdict = verdict_of(model, history, stress)
    heights = heights_of_links(case, container.elements.nodes[container.nodes])
    held = (held_by(model) or ())[len(case.neighbour) :]
    links = [
        LinkResult(
            side=link.side,
            height_m=height,
            neighbour=link.neighbour if isinstance(link, TieTable) else None,
            max_force_N=one.max_force_N or 0.0,
            hits=int(one.hits or 0),
            largest_closing_velocity_m_s=one.largest_closing_velocity_m_s or 0.0,
            gap_left_m=one.gap_left_m,
            broken_at_s=one.broken_at_s,
        )
        for link, height, one in zip(case.links, heights, held, strict=True)
    ]
    result = replace(
        result,
        status=end.status,
        verdict=verdict if end.error is None else replace(verdict, outcome=None),
        joints=joint_demands(model, history),
        stops=tuple(links[: len(case.stop)]) or None,
        ties=tuple(links[len(case.stop) :]) or None,
        energy=energy_of(model),
        numerics=numerics_of(model, end.stepping_cpu_s),
        error=end.error,
    )
    return result, history


@dataclass(frozen=True, kw_only=True)
class WantedChecks:
    """Which checks are asked for."""

    check_rigid: bool = False
    band: bool | None = None  #: None: wherever it takes no longer than it is worth
    margin: bool | None = None  #: None: wherever it takes seconds, and a band is not refused
    analytic: bool = False  #: follow the analytic block under the same motion, where there is one
    inner_forces: bool = True  #: let members of a band find stresses and the forces in joints of a stack


def add_checks(
    result: RunResult,
    model: Model,
    history_of: Callable[[], History],
    wanted: WantedChecks,
    members: ChangedRunsFile | None,
    *,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> tuple[RunResult, "RigidCheck | None"]:
    """Add the rigid check, the band and the margin to a finished run, where they are wanted and missing.

    Args:
        result, model: of the run; history_of: gives its samples.
        members: the file of the finished members of a band.
        stop: called in pauses; true ends band and margin.

    Returns:
        The result with them, the same object where nothing was added; and the comparison with the rigid block, where
        it was made now.
    """
    verdict, check = result.verdict, None
    if result.status not in RUN.finished or verdict is None:
        return result, None
    case, missing = model.case, lacking(result, model.case, wanted)
    analytic = wanted.analytic and verdict.analytic is None and has_analytic_block(case)
    if "rigid check" in missing or analytic:  # with scipy.integrate
        block = importlib.import_module("fem.run.rigid_check")
        events = importlib.import_module("contact.reference.event_driven")
    if "rigid check" in missing:
        history = history_of()
        try:
            check = block.check_against_rigid_block(model, history, verdict)
            result = replace(result, rigid_check=check.result)
        except (ValueError, events.EventError) as error:  # a run too short, a block that bounces without end
            result = replace(result, rigid_check=RigidCheckResult(reasons=(str(error),)))
    if analytic:
        end = (result.numerics or Numerics()).simulated_s or 0.0
        with suppress(ValueError, events.EventError):  # a block that bounces without end has no row
            verdict = replace(verdict, analytic=block.analytic_block(model, end))
            result = replace(result, verdict=verdict)
    if "band" in missing and not stop():
        judged = with_band(
            model, result, stop=stop, reporter=reporter, kept_in=members, inner_forces=wanted.inner_forces
        )
        if judged is not None:
            result = replace(result, verdict=judged)
    elif verdict.sure is None and wanted.band is None and rests_far_below_limits(case, result):
        result = replace(result, verdict=replace(verdict, sure=SURE))
    if "margin" in missing and not stop():
        reporter.message("margin: repeating the run under stronger and weaker motions")
        margin = margin_of(model, result, drawn=wanted.band is not False, stop=stop)
        if margin is not None:
            result = replace(result, verdict=replace(result.verdict or verdict, margin=margin))
    return result, check


def lacking(result: RunResult, case: Case, wanted: WantedChecks) -> set[str]:
    """What a finished run is still to have, of `rigid check`, `band` and `margin`."""
    verdict = result.verdict
    if verdict is None:
        return set()
    margin = (wanted.band is not False or bool(wanted.margin)) and wants_margin(wanted.margin, case, result)
    missing = {
        "rigid check": result.rigid_check is None and wants_rigid_check(wanted.check_rigid, case),
        "band": verdict.band is None and wants_band(wanted.band, case, result),
        "margin": verdict.margin is None and margin,
    }
    return {check for check, is_missing in missing.items() if is_missing}


def has_analytic_block(case: Case) -> bool:
    """Whether a case is a block on rigid ground whose motion formulas give: harmonic, a pulse, or a release."""
    alone = not (case.links or case.neighbour or case.container.is_loose or case.floor.is_slab or case.rolls)
    release = case.motion.kind == "none" and case.initial.rotation_rad != 0.0
    moves = case.motion.kind in ("harmonic", "pulse") or release
    return alone and moves and case.support.kind == "corners"


def wants_rigid_check(choice: bool, case: Case) -> bool:
    """Free rocking always has the check, other runs on request."""
    return choice or (case.motion.kind == "none" and case.initial.rotation_rad != 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Run(RunData):
    """A finished run in memory. SI units; x to the right, z up, rotation > 0 toward +x."""

    case: Case  #: with every default and "auto" replaced
    typed_result: RunResult  #: the result as typed data
    history: History  #: `run.history["rotation_rad"]` is a column (numpy), `run.history.modes` the states
    fields: Fields  #: `run.fields.times`, `run.fields.frame(0)`; empty with output.fields_s = 0

    def __repr__(self) -> str:
        """One line, for a notebook."""
        return f"<run {self.case.name!r}: {self.status}, {self.verdict.outcome}>"

    @property
    def status(self) -> str:
        """Status of the run: completed | overturned | failed; `run.result["error"]` says why it failed."""
        return self.typed_result.status

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
    """Refuse what is no case, such as its name, by a CaseError."""
    if not isinstance(given, Case):
        raise CaseError(f"a case from fem.load_case or fem.case_from is needed, got {type(given).__name__}")


def compute_on(container: Container | None, case: Case, wanted: WantedChecks) -> Run:
    """Compute a case in memory, on its container where that is built already; where a signal stops it, a part of that.

    Errors as `compute`.
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
    result = with_words(replace(result, **watch.spent()), case)
    return Run(case=case, typed_result=result, history=history, fields=keeper.fields)
