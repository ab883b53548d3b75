"""The rigid check of a run: its rotation compared with that of the analytic rigid block on the same floor.

Impacts of the block are Housner's: angular momentum about the new corner is kept (BSSA 53 (1963) 403).
Rotation > 0 toward +x.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import takewhile

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
from fem.run.joints import AS_ONE, joints_in_words
from fem.runtime.arrays import FloatArray

STIFF_CONTAINER = 7.0  #: first elastic over contact frequency, from which an impact is a rigid block's
SOFT_FLOOR = 1e-3  #: static penetration over width times slenderness angle: the gap that counts as an impact
BOUNCING_CONTACT = 1.0  #: contact damping ratio below which an impact is not plastic
OFF_CENTRE = 1e-6  #: of the mass centre, over the width
#: modes of a block that a block which cannot slide does not have
SLIPPING = {PlanarMode.SLIDE, PlanarMode.SLIDE_ROCK, PlanarMode.OUTSIDE}
SAMPLES_OF_SLIP, SAMPLES_OF_FORCES = 200.0, 500.0  #: of the analytic block, a second
PEAKS = 6  #: turning points that are compared
#: times [s] -> rotation [rad], angular velocity [rad/s], each of shape (n,)
RotationAt = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
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


@dataclass(frozen=True, kw_only=True)
class Reference:
    """The motion of the rigid block."""

    name: str
    at: RotationAt
    impact: PlanarImpact | None  #: the first after it had tilted
    left_model_at: float | None = None  #: outside its model from here on [s]


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
    reference = follow_block(model, float(time[-1]))
    rotation, rate = reference.at(time)
    peaks = zip(
        first_peaks(time, history["rotation_rad"], ROCKING * angle)[:PEAKS],
        first_peaks(time, rotation, ROCKING * angle)[:PEAKS],
        strict=False,
    )
    same_side = takewhile(lambda pair: pair[0][1] * pair[1][1] > 0.0, peaks)
    reasons = reasons_against(model, history, verdict, reference)
    impact = reference.impact
    impacts = RunAndBlock(run=verdict.first_impact_s, block=impact.time if impact else None)
    ratio = impact.velocity_after / impact.velocity_before if impact else None
    first = min((time_s for time_s in (impacts.run, impacts.block) if time_s is not None), default=math.inf)
    difference = np.abs(history["rotation_rad"] - rotation)[(time < first) & np.isfinite(rotation)]
    result = RigidCheckResult(
        reference=reference.name,
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
    """The rigid block of a container under its motion, up to `end` [s].

    Raises:
        EventError: the block changes its state too often.
    """
    case, angle = model.case, model.static.slenderness_angle
    floor, start = _floor_and_start(model)
    rotation, rate = case.initial.rotation_rad, case.initial.angular_velocity_rad_s
    friction = PlanarBlock(
        body=block_of(model), mu_static=case.contact.mu_static, mu_kinetic=case.contact.mu_kinetic
    )
    block = simulate_planar_block(
        friction, floor, duration=end, rotation=rotation, angular_velocity=rate, slip_velocity=start
    )
    times = np.linspace(0.0, block.end, max(2, math.ceil(SAMPLES_OF_SLIP * block.end)))
    slip = block.at(times).slip
    swings: RockingMotion | PlanarMotion = block
    if block.modes & SLIPPING or any(impact.slides for impact in block.impacts):
        swings = simulate_rocking(
            friction.body, floor, duration=end, rotation=rotation, angular_velocity=rate
        )
    fell = swings.outcome is PlanarMode.OVERTURNED
    return AnalyticBlock(
        outcome=None if block.outcome is PlanarMode.OUTSIDE else block.outcome.value,
        rotation_ratio=block.largest_rotation / angle,
        max_slip_m=float(np.nanmax(np.abs(slip))) if np.isfinite(slip).any() else None,
        friction_needed=None if fell else friction_needed(friction.body, swings, floor),
    )


def friction_needed(
    block: RigidBlock, held: RockingMotion | PlanarMotion, floor: FloorAcceleration
) -> float | None:
    """Largest |tangential| over normal force of a block that does not slide, impacts aside [-].

    About its corner its mass centre is at s = R (-sin l, cos l), l the slenderness angle less |rotation|, on the side
    of the corner; T and N follow from the acceleration of that and of the floor.

    Returns:
        None where the block leaves the floor.
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


def follow_block(model: Model, end: float) -> Reference:
    """The rigid block under the run's floor, from the run's start to `end` [s].

    A floor that starts with a velocity under a container at rest gives the block a slip velocity. Where the
    block never slides, the block that cannot slide is the reference. In the frame of a floor that moves up and down,
    gravity is g + a_v; on a slope, the part of gravity along it is an acceleration of the floor uphill.
    """
    case, block = model.case, block_of(model)
    floor, start = _floor_and_start(model)
    rotation, rate = case.initial.rotation_rad, case.initial.angular_velocity_rad_s

    def had_tilted(at: RotationAt, impact: PlanarImpact) -> bool:
        before, _ = at(np.linspace(0.0, impact.time, 512))
        return bool(np.nanmax(np.abs(before)) > ROCKING * model.static.slenderness_angle)

    sliding = simulate_planar_block(
        PlanarBlock(body=block, mu_static=case.contact.mu_static, mu_kinetic=case.contact.mu_kinetic),
        floor,
        duration=end,
        rotation=rotation,
        angular_velocity=rate,
        slip_velocity=start,
    )
    left = case.has_normal and sliding.outcome is PlanarMode.OUTSIDE
    if left or sliding.modes & {PlanarMode.SLIDE, PlanarMode.SLIDE_ROCK}:

        def at(times: FloatArray) -> tuple[FloatArray, FloatArray]:
            history = sliding.at(times)
            return history.rotation, history.angular_velocity

        return Reference(
            name="rigid block with friction",
            at=at,
            impact=next((impact for impact in sliding.impacts if had_tilted(at, impact)), None),
            left_model_at=sliding.end if sliding.outcome is PlanarMode.OUTSIDE else None,
        )
    rocking = simulate_rocking(block, floor, duration=end, rotation=rotation, angular_velocity=rate)
    return Reference(
        name="rigid block that does not slide",
        at=rocking.at,
        impact=next((impact for impact in rocking.impacts if had_tilted(rocking.at, impact)), None),
    )


def _floor_and_start(model: Model) -> tuple[FloorAcceleration, float]:
    """The acceleration of a run's floor, with its slope and vertical motion, and the slip velocity at t = 0 [m/s]."""
    case = model.case
    floor = floor_of(model.motion, driven_until=model.duration).on_slope(case.gravity_downhill)
    if case.has_normal:
        floor = floor.with_vertical(floor_of(model.vertical, driven_until=model.duration))
    jerk = 0.0 if case.starts_moving else floor_motion(model.motion.compiled(), 0.0)[1]
    return floor, case.initial.velocity_m_s - jerk


def floor_of(motion: BaseMotion, *, driven_until: float) -> FloorAcceleration:
    """Acceleration of the floor of a run, zero after its duration."""
    data = motion.compiled()
    breaks = {*motion.break_times.tolist(), driven_until}
    if data.kind in (PIECEWISE, SUM):  # it bends at every sample
        breaks |= set(data.breaks.tolist())

    def acceleration(time: float) -> float:
        return float(floor_motion(data, time)[2]) if time < driven_until else 0.0

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


def reasons_against(model: Model, history: History, verdict: Verdict, reference: Reference) -> list[str]:
    """Reasons why the container differs from the rigid block; empty if there are none."""
    mesh, static = model.container.mesh, model.static
    kind, impact = model.case.support.kind, reference.impact
    sinking = static.weight / model.base_stiffness / (mesh.width * static.slenderness_angle)
    stiffness = _first_elastic_frequency(model) / contact_frequency(mesh.mass, model.base_stiffness)
    block_slides = impact is not None and (impact.slides or impact.slip_velocity_before != 0.0)
    reasons = []
    if not static.housner_credible:
        reasons.append(
            f"squat container: Housner's restitution is {static.housner_restitution:.3f}, below 0.5"
        )
    if kind != "corners":
        what = f"support {kind!r}" if kind != "corners" else "castings"
        reasons.append(f"{what}: the container turns about a moving region, the block about its corners")
    if (moved := joints_in_words(verdict, static.to_result())) not in ("", AS_ONE):
        reasons.append(f"its boxes are loose: {moved}")
    if block_slides or _slides_at_impact(model, history, verdict):
        reasons.append("it slides at the first impact, which Housner's block does not")
    if stiffness < STIFF_CONTAINER:
        reasons.append(
            f"it deforms: first elastic over contact frequency is {stiffness:.2g}, below {STIFF_CONTAINER:g}"
        )
    # the crushing of a slab takes the energy
    if model.damping_ratio < BOUNCING_CONTACT and not model.case.floor.is_slab:
        reasons.append(
            f"the contact bounces: its damping ratio is {model.damping_ratio:g}, below {BOUNCING_CONTACT:g}"
        )
    if sinking > SOFT_FLOOR:
        reasons.append(f"soft floor: the weight alone sinks in by {sinking:.1e} of width x slenderness angle")
    if abs(mesh.centroid[0]) > OFF_CENTRE * mesh.width:
        reasons.append(f"the mass centre is {mesh.centroid[0]:.3g} m beside the middle of the base")
    if reference.left_model_at is not None:
        reasons.append(
            f"the block leaves the floor, or its impact has no solution, at {reference.left_model_at:.4g} s"
        )
    if not model.case.starts_moving and floor_motion(model.vertical.compiled(), 0.0)[1] != 0.0:
        reasons.append("the floor starts with a jerk up or down, which the block does not feel")
    if model.case.links:
        reasons.append("stops or ties hold it")
    if model.case.neighbour:
        reasons.append("it stands in a row")
    if impact is None and verdict.first_impact_s is None:
        reasons.append("no impact in the run or the block")
    return reasons


def _first_elastic_frequency(model: Model) -> float:
    """Of the container [Hz]; infinite for the rigid model."""
    if model.case.solver.model == "full":
        return float(model.container.lowest_modes(1).frequencies_Hz[0])
    return math.inf if model.case.solver.model == "rigid" else float(model.spectra[0][0])


def _slides_at_impact(model: Model, history: History, verdict: Verdict) -> bool:
    """Whether the run slides by what counts as sliding within a few samples of its first impact."""
    if verdict.first_impact_s is None:
        return False
    first = int(np.searchsorted(history["time_s"], verdict.first_impact_s))
    near = history["slip_m"][max(first - 2, 0) : first + 3]
    return bool(np.ptp(near) > SLIDING * model.container.mesh.width) if near.size else False
