"""The computation of a run, without its files: a resolved case, stepping until done, the result in numbers and words.

`fem.run.compute` keeps a run in memory, `fem.run.run` in a folder; both call what is here.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from contact.motion.base_motion import BaseMotion
from fem.case.case import Case
from fem.case.tables.duration import ends_at_rest, longest_time
from fem.case.tables.links import TieTable
from fem.model.floor_numbers import floor_result
from fem.model.frames import frame_interval
from fem.model.geometry import build_container, node_count
from fem.model.links import heights_of_links
from fem.model.model import Model
from fem.model.motion import longest_run, motion_result
from fem.model.static_checks import static_checks_of
from fem.model.step_size import largest_step_of
from fem.model.support import normal_penalty
from fem.results.history import History
from fem.results.run_result import LinkResult, RunResult
from fem.run.card import card_of
from fem.run.described import sides_of
from fem.run.recorder import Recorder
from fem.run.simulation import BEGINNING, Progress, simulate
from fem.run.verdict import energy_of, joint_demands, numerics_of, verdict_of
from fem.run.warnings import warnings_for
from fem.runtime.identity import versions
from fem.runtime.progress import Reporter
from mesh.container import ContainerMesh


def resolve(case: Case, mesh: ContainerMesh, motions: tuple[BaseMotion, BaseMotion]) -> Case:
    """The case with every "auto" replaced by the value chosen; running it again gives the same result.

    Raises:
        CaseError: a motion that the given step would step over.
    """
    chosen = chosen_values(case, mesh, motions)
    return case.with_chosen(chosen) if chosen else case


def chosen_values(case: Case, mesh: ContainerMesh, motions: tuple[BaseMotion, BaseMotion]) -> dict[str, Any]:
    """What is chosen for a case where it says "auto", by dotted key.

    A duration that depends on when the container comes to rest stays "auto".

    Raises:
        CaseError: a motion that the given step would step over.
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
        nodes = node_count(mesh, case.solver.order)
        chosen["output.fields_s"] = frame_interval(case, nodes, longest)
    return chosen


def begun(model: Model, case_hash: str) -> RunResult:
    """The result of a run that is to be stepped: what is known before."""
    case = model.case
    return RunResult(
        status="running",
        case=case.name,
        title=case.title,
        overrides=case.overrides or None,
        case_hash=case_hash,
        static=(static := model.static.to_result()),
        sides=sides_of(case.stack[0].width, case.container.depth_m, static)
        if case.container.mesh_file is None
        else None,
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
    ending = simulate(model, recorder, reporter=reporter, stop=stop, save=save, progress=progress)
    history = recorder.history()
    stress = recorder.largest_von_mises if model.case.solver.model != "rigid" else None
    verdict = verdict_of(model, history, stress)
    stops, ties = _link_results(model)
    result = replace(
        result,
        status=ending.status,
        verdict=verdict if ending.error is None else replace(verdict, outcome=None),
        joints=joint_demands(model, history),
        stops=stops,
        ties=ties,
        energy=energy_of(model),
        numerics=numerics_of(model, ending.stepping_cpu_s),
        error=ending.error,
    )
    return result, history


def _link_results(model: Model) -> tuple[tuple[LinkResult, ...] | None, tuple[LinkResult, ...] | None]:
    """What stops and ties did in a model that was stepped, in the order of the case; None where there are none."""
    case, container = model.case, model.container
    records = model.run.links[len(case.neighbour) :]
    heights = heights_of_links(case, container.elements.nodes[container.nodes])
    results = [
        LinkResult(
            side=link.side,
            height_m=height,
            neighbour=link.neighbour if isinstance(link, TieTable) else None,
            max_force_N=float(record.max_force),
            hits=int(record.hits),
            largest_closing_velocity_m_s=float(record.largest_closing_velocity),
            gap_left_m=float(record.least_gap)
            if math.isinf(record.broken_at) and math.isfinite(record.least_gap)
            else None,
            broken_at_s=None if math.isinf(record.broken_at) else float(record.broken_at),
        )
        for link, height, record in zip(case.links, heights, records, strict=True)
    ]
    stops = len(case.stop)
    return tuple(results[:stops]) or None, tuple(results[stops:]) or None


def in_words(result: RunResult, case: Case) -> RunResult:
    """The result with its warnings and the card of its verdict, which follow from the rest."""
    result = replace(result, warnings=tuple(warnings_for(result, case)))
    if result.verdict is None:
        return result
    card = card_of(result)
    return replace(result, verdict=replace(result.verdict, first_line=card[0], card=card))
