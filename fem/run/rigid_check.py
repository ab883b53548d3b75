"""The rigid check of a run: its rotation compared with that of the analytic rigid block on the same floor.

Impacts of the block are Housner's: angular momentum about the new corner is kept (BSSA 53 (1963) 403).
Rotation > 0 toward +x.
"""

import math
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import numpy as np

from contact.interface.penalty import contact_frequency
from contact.motion.base_motion import BaseMotion
from contact.motion.kernel import PIECEWISE, SUM, floor_motion
from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.planar_block import (
    PlanarBlock,
    PlanarImpact,
    PlanarMode,
    PlanarMotion,
    simulate_planar_block,
)
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import RockingMotion, simulate_rocking
from contact.stepping.modes import ROCKING, SLIDING
from fem.model.model import Model
from fem.results.history import ANALYTIC_COLUMN, History
from fem.results.run_result import AnalyticBlock, PeakPair, RigidCheckResult, RunAndBlock, Verdict
from fem.run.described import AS_ONE, joints_in_words
from fem.run.words import paragraphs
from fem.runtime.arrays import FloatArray

LIMITS: dict[str, Any] = {
    "STIFF_CONTAINER": 7.0,  #: first elastic over contact frequency, from which an impact is a rigid block's
    "SOFT_FLOOR": 1e-3,  #: static penetration over width times slenderness angle: the gap that counts as an impact
    "BOUNCING_CONTACT": 1.0,  #: contact damping ratio below which an impact is not plastic
    "OFF_CENTRE": 1e-6,  #: of the mass centre, over the width
}
#: modes of a block that a block which cannot slide does not have
SLIPPING = {PlanarMode.SLIDE, PlanarMode.SLIDE_ROCK, PlanarMode.OUTSIDE}
SAMPLES_OF_SLIP, SAMPLES_OF_FORCES = 200.0, 500.0  #: of the analytic block, a second
PEAKS = 6  #: turning points that are compared
COLUMNS = ("time_s", "rotation_rad", ANALYTIC_COLUMN, "analytic_angular_velocity_rad_s")


@dataclass(frozen=True, kw_only=True, eq=False)
class RigidCheck:
    """A run compared with its rigid block."""

    result: RigidCheckResult
    rows: FloatArray  #: (n, 4), see COLUMNS; nan where the block is outside its model

    @property
    def analytic_rotation(self) -> FloatArray:
        """The block's, at each sample of the history, shape (n,) [rad]."""
        return self.rows[:, COLUMNS.index(ANALYTIC_COLUMN)]

    def table(self) -> str:
        """The rows as CSV."""
        lines = [",".join(COLUMNS), *(",".join(map(repr, row)) for row in self.rows.tolist())]
        return "\n".join(lines) + "\n"


def check_against_rigid_block(model: Model, history: History, verdict: Verdict) -> RigidCheck:
    """Compare a finished run with the rigid block.

    Args:
        model, history, verdict: of the run; the model may be stepped or not.

    Raises:
        ValueError: the history has less than two samples.
        EventError: the block changes its state too often.
    """
    if len(history.modes) < 2:
        raise ValueError(f"rigid check: the history needs two samples and has {len(history.modes)}")
    time, angle = history["time_s"], model.static.slenderness_angle
    motion, slides, left_model_at = _reference(model, float(time[-1]))

    def had_tilted(impact: PlanarImpact) -> bool:
        before = motion.at(np.linspace(0.0, impact.time, 512))[0]
        return bool(np.nanmax(np.abs(before)) > ROCKING * angle)

    impact = next(filter(had_tilted, motion.impacts), None)
    rotation, rate = motion.at(time)[:2]
    peaks = zip(
        first_peaks(time, history["rotation_rad"], ROCKING * angle)[:PEAKS],
        first_peaks(time, rotation, ROCKING * angle)[:PEAKS],
        strict=False,
    )
    same_side = takewhile(lambda pair: pair[0][1] * pair[1][1] > 0.0, peaks)
    reasons = _reasons_against(model, history, verdict, impact, left_model_at)
    impacts = RunAndBlock(run=verdict.first_impact_s, block=impact.time if impact else None)
    ratio = impact.velocity_after / impact.velocity_before if impact else None
    first = min((time_s for time_s in (impacts.run, impacts.block) if time_s is not None), default=math.inf)
    difference = np.abs(history["rotation_rad"] - rotation)[(time < first) & np.isfinite(rotation)]
    result = RigidCheckResult(
        reference="rigid block with friction" if slides else "rigid block that does not slide",
        meaningful=not reasons,
        reasons=tuple(reasons),
        first_impact_s=impacts,
        velocity_ratio=RunAndBlock(run=verdict.restitution_first, block=ratio),
        peaks=tuple(
            PeakPair(run_s=run[0], run_rad=run[1], block_s=block[0], block_rad=block[1])
            for run, block in same_side
        ),
        largest_difference_before_impact=float(difference.max()) / angle if difference.size else None,
    )
    rows = np.column_stack([time, history["rotation_rad"], rotation, rate])
    return RigidCheck(result=result, rows=rows)


def analytic_block(model: Model, end: float) -> AnalyticBlock:
    """The rigid block of a container under its motion, up to `end` [s]; EventError: it changes its state too often."""
    angle, (block, floor) = model.static.slenderness_angle, _with_friction(model, end)
    times = np.linspace(0.0, block.end, max(2, math.ceil(SAMPLES_OF_SLIP * block.end)))
    slip = block.at(times).slip
    swings: RockingMotion | PlanarMotion = block
    if block.modes & SLIPPING or any(impact.slides for impact in block.impacts):
        swings = _without_sliding(model, floor, end)
    fell = swings.outcome is PlanarMode.OVERTURNED
    return AnalyticBlock(
        outcome=None if block.outcome is PlanarMode.OUTSIDE else block.outcome.value,
        rotation_ratio=block.largest_rotation / angle,
        max_slip_m=float(np.nanmax(np.abs(slip))) if np.isfinite(slip).any() else None,
        friction_needed=None if fell else _friction_needed(block_of(model), swings, floor),
    )


def _friction_needed(
    block: RigidBlock, held: RockingMotion | PlanarMotion, floor: FloorAcceleration
) -> float | None:
    """Largest |tangential| over normal force of a block that does not slide, impacts aside [-].

    About its corner its mass centre is at s = R (-sin l, cos l), l the slenderness angle less |rotation|, on the side
    of the corner; T and N follow from the acceleration of that and of the floor. None where it leaves the floor.
    """
    times = np.linspace(0.0, held.end, max(2, math.ceil(SAMPLES_OF_FORCES * held.end)))
    rotation, rate = held.at(times)[:2]
    known = np.isfinite(rotation)
    times, rotation, rate = times[known], rotation[known], rate[known]
    shake = np.array([(floor.function(time), floor.vertical(time)) for time in times.tolist()])
    side = np.sign(rotation)
    lean, pull = block.slenderness_angle - np.abs(rotation), shake[:, 1] + block.gravity
    swing = -(block.frequency_parameter**2) / block.gravity
    swing = swing * (pull * np.sin(lean) + side * shake[:, 0] * np.cos(lean))  # of |rotation|
    along = side * block.radius * (np.cos(lean) * swing + np.sin(lean) * rate**2) * (side != 0.0)
    up = block.radius * (np.sin(lean) * swing - np.cos(lean) * rate**2) * (side != 0.0)
    normal = pull + up
    if not np.all(normal > 0.0):
        return None
    return float(np.max(np.abs(shake[:, 0] + along) / normal))


def block_of(model: Model) -> RigidBlock:
    """The rigid block with the mesh's mass centre and inertia on the points about which it turns."""
    mesh = model.container.mesh
    half, height = 0.5 * model.static.width, mesh.centroid[1]
    return RigidBlock(
        half_width=half,
        centroid_height=height,
        gravity=model.case.gravity_toward_floor,
        inertia_ratio=1.0 + mesh.inertia / (mesh.mass * (half**2 + height**2)),
    )


def _reference(model: Model, end: float) -> tuple[RockingMotion | PlanarMotion, bool, float | None]:
    """The rigid block under the run's floor up to `end` [s]; whether it slides; when it left its model [s].

    A floor that starts with a velocity under a container at rest gives the block a slip velocity. Where the
    block never slides, the block that cannot slide is the reference. In the frame of a floor that moves up and down,
    gravity is g + a_v; on a slope, the part of gravity along it is an acceleration of the floor uphill.
    """
    block, floor = _with_friction(model, end)
    outside = block.outcome is PlanarMode.OUTSIDE
    if block.modes & {PlanarMode.SLIDE, PlanarMode.SLIDE_ROCK} or (model.case.has_normal and outside):
        return block, True, block.end if outside else None
    return _without_sliding(model, floor, end), False, None


def _with_friction(model: Model, end: float) -> tuple[PlanarMotion, FloorAcceleration]:
    """The block that may slide, and the acceleration of its floor, with its slope and vertical motion."""
    case = model.case
    floor = floor_of(model.motion, driven_until=model.duration).on_slope(case.gravity_downhill)
    if case.has_normal:
        floor = floor.with_vertical(floor_of(model.vertical, driven_until=model.duration))
    jerk = 0.0 if case.starts_moving else floor_motion(model.motion.compiled(), 0.0)[1]
    contact = case.contact
    motion = simulate_planar_block(
        PlanarBlock(body=block_of(model), mu_static=contact.mu_static, mu_kinetic=contact.mu_kinetic),
        floor,
        duration=end,
        rotation=case.initial.rotation_rad,
        angular_velocity=case.initial.angular_velocity_rad_s,
        slip_velocity=case.initial.velocity_m_s - jerk,
    )
    return motion, floor


def _without_sliding(model: Model, floor: FloorAcceleration, end: float) -> RockingMotion:
    start = model.case.initial
    return simulate_rocking(
        block_of(model),
        floor,
        duration=end,
        rotation=start.rotation_rad,
        angular_velocity=start.angular_velocity_rad_s,
    )


def floor_of(motion: BaseMotion, *, driven_until: float) -> FloorAcceleration:
    """Acceleration of the floor of a run, zero after its duration."""
    data = motion.compiled()
    breaks = {*motion.break_times.tolist(), driven_until}
    if data.kind in (PIECEWISE, SUM):  # it bends at every sample
        breaks |= set(data.breaks.tolist())

    def acceleration(time: float) -> float:
        return float(floor_motion.call_by_class(data, time)[2]) if time < driven_until else 0.0

    return FloorAcceleration(
        function=acceleration,
        break_times=tuple(sorted(time for time in breaks if time > 0.0)),
        longest_step=0.125 * motion.time_scale,
    )


def first_peaks(time: FloatArray, rotation: FloatArray, least: float) -> list[tuple[float, float]]:
    """Largest rotation of each swing to one side: time [s] and rotation [rad].

    A swing is a stretch of samples on one side of the vertical that goes beyond `least` [rad]; the parabola
    through the largest sample and its neighbours gives the peak. A stretch that is largest where the record
    begins or ends has none.
    """
    known = np.isfinite(rotation)
    time, rotation = time[known], rotation[known]
    if time.size < 3:
        return []
    bounds = np.flatnonzero(np.diff(np.sign(rotation)) != 0.0) + 1
    peaks = []
    for swing in np.split(np.arange(time.size), bounds):
        top = int(swing[np.argmax(np.abs(rotation[swing]))])
        if abs(rotation[top]) <= least or top in (0, time.size - 1):
            continue
        before, here, after = np.abs(rotation[top - 1 : top + 2])
        bend = before - 2.0 * here + after
        share = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
        instant = time[top] + share * (time[top + 1] - time[top])
        peak = here - 0.25 * (before - after) * share
        peaks.append((float(instant), math.copysign(peak, rotation[top])))
    return peaks


def _reasons_against(
    model: Model, history: History, verdict: Verdict, impact: PlanarImpact | None, left_model_at: float | None
) -> list[str]:
    """Reasons why the container differs from the rigid block; empty if there are none.

    Args:
        impact: the first of the block after it had tilted.
        left_model_at: the block is outside its model from here on [s].
    """
    case, mesh, static, at = model.case, model.container.mesh, model.static, verdict.first_impact_s
    elastic = math.inf  #: first frequency of the container [Hz]
    if case.solver.model != "rigid":
        full = case.solver.model == "full"
        elastic = float(model.container.lowest_modes(1).frequencies_Hz[0] if full else model.spectra[0][0])
    moved = joints_in_words(verdict, static.to_result())
    slides = impact is not None and (impact.slides or impact.slip_velocity_before != 0.0)
    if at is not None and not slides:  # by what counts as sliding, within a few samples of the impact
        first = int(np.searchsorted(history["time_s"], at))
        near = history["slip_m"][max(first - 2, 0) : first + 3]
        slides = bool(near.size and np.ptp(near) > SLIDING * mesh.width)
    return paragraphs(
        "reasons.txt.j2",
        case=case,
        mesh=mesh,
        static=static,
        quoted=repr,
        moved="" if moved == AS_ONE else moved,
        slides=slides,
        stiffness=elastic / contact_frequency(mesh.mass, model.base_stiffness),
        damping_ratio=model.damping_ratio,
        sinking=static.weight / model.base_stiffness / (mesh.width * static.slenderness_angle),
        left_model_at=left_model_at,
        jerk=not case.starts_moving and floor_motion(model.vertical.compiled(), 0.0)[1] != 0.0,
        no_impact=impact is None and at is None,
        **LIMITS,
    )
