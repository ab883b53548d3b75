"""The rigid-limit check of a run: its rotation beside that of the analytic rigid block under the same floor.

The block has mass centre, inertia and base of the mesh, and the case's friction; its impacts are Housner's
(angular momentum about the new corner is kept, BSSA 53 (1963) 403). It shares no code with the finite
elements or the time stepping. It is rigid, stands on two corners and does not bounce: where the container is
otherwise, the two must differ, and the check says so instead of counting that against either. Rotation > 0
toward +x.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import takewhile

import numpy as np

from contact.interface.penalty import contact_frequency
from contact.motion.base_motion import BaseMotion
from contact.motion.kernel import PIECEWISE, floor_motion
from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.planar_block import PlanarBlock, simulate_planar_block
from contact.reference.planar_motion import PlanarMode, PlanarMotion
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import RockingMotion, simulate_rocking
from contact.stepping.observables import IMPACT_GAP, ROCKING
from fem.assessment.verdict import SLIDING
from fem.case.case import Case
from fem.model.model import Model
from fem.results.history import ANALYTIC_COLUMN, History
from fem.results.run_result import PeakPair, RigidCheckResult, RunAndBlock, Verdict
from fem.runtime.arrays import FloatArray
from fem.solid.modes import elastic_modes

STIFF_CONTAINER = 7.0  #: first elastic over contact frequency, from which an impact is a rigid block's
SOFT_FLOOR = 1e-3  #: static penetration over width times slenderness angle: the gap that counts as an impact
BOUNCING_CONTACT = 1.0  #: contact damping ratio below which an impact is not plastic
OFF_CENTRE = 1e-6  #: of the mass centre, over the width
PEAKS = 6  #: turning points that are compared
COLUMNS = ("time_s", "rotation_rad", ANALYTIC_COLUMN, "analytic_angular_velocity_rad_s")


@dataclass(frozen=True, kw_only=True, eq=False)
class RigidCheck:
    """A run beside its rigid block."""

    result: RigidCheckResult
    rows: FloatArray  #: (n, 4), see COLUMNS; nan where the block is no longer followed

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
    """What the rigid block did."""

    name: str
    at: Callable[[FloatArray], tuple[FloatArray, FloatArray]]  #: times -> rotation, angular velocity
    first_impact: float | None  #: [s]
    velocity_ratio: float | None  #: at that impact [-]
    slides_at_impact: bool
    left_model_at: float | None  #: no longer followed from here on [s]


def wants_rigid_check(asked: bool, case: Case) -> bool:
    """Free rocking always has the check, everything else where asked."""
    return asked or (case.motion.kind == "none" and case.initial.rotation_rad != 0.0)


def check_against_rigid_block(model: Model, history: History, verdict: Verdict) -> RigidCheck:
    """Compare a finished run with the rigid block.

    Args:
        model: of the run, stepped or not.
        history: of the run, two samples or more.
        verdict: of the run.

    Raises:
        ValueError: a history without two samples.
        EventError: the block's motion has too many changes of state to be followed.
    """
    if len(history) < 2:
        raise ValueError(f"rigid check: two samples of the history are needed, there are {len(history)}")
    time, angle = history["time_s"], model.static.slenderness_angle
    reference = follow_block(model, float(time[-1]))
    rotation, rate = reference.at(time)
    found = first_peaks(time, history["rotation_rad"], ROCKING * angle)
    expected = first_peaks(time, rotation, ROCKING * angle)
    reasons = reasons_against(model, history, verdict, reference)
    result = RigidCheckResult(
        reference=reference.name,
        meaningful=not reasons,
        reasons=tuple(reasons),
        first_impact_s=RunAndBlock(run=verdict.first_impact_s, block=reference.first_impact),
        velocity_ratio=RunAndBlock(run=verdict.restitution_first, block=reference.velocity_ratio),
        peaks=_paired(found[:PEAKS], expected[:PEAKS]),
        largest_difference_before_impact=_difference_before_impact(
            time, history["rotation_rad"], rotation, verdict, reference, angle
        ),
    )
    rows = np.column_stack([time, history["rotation_rad"], rotation, rate])
    return RigidCheck(result=result, rows=rows)


def block_of(model: Model) -> RigidBlock:
    """The rigid block with the mesh's mass centre and inertia on the ends of its base."""
    mesh = model.container.mesh
    half, height = 0.5 * mesh.width, mesh.centroid[1]
    return RigidBlock(
        half_width=half,
        centroid_height=height,
        gravity=model.case.gravity_m_s2,
        inertia_ratio=1.0 + mesh.inertia / (mesh.mass * (half**2 + height**2)),
    )


def follow_block(model: Model, end: float) -> Reference:
    """The rigid block under the run's floor, from the run's start to `end` [s].

    A floor that starts with a velocity under a container at rest leaves it behind at once: to the block that
    is a slip velocity. Where friction never gives way, the block is the one that cannot slide.
    """
    case, block = model.case, block_of(model)
    initial, friction = case.initial, case.contact
    floor = floor_of(model.motion, driven_until=case.solver.duration_s)
    jerk = floor_motion(model.motion.compiled(), 0.0)[1] if case.motion.start == "rest" else 0.0
    least = IMPACT_GAP * model.static.slenderness_angle
    sliding = simulate_planar_block(
        PlanarBlock(body=block, mu_static=friction.mu_static, mu_kinetic=friction.mu_kinetic),
        floor,
        duration=end,
        rotation=initial.rotation_rad,
        angular_velocity=initial.angular_velocity_rad_s,
        slip_velocity=initial.velocity_m_s - jerk,
    )
    if sliding.modes & {PlanarMode.SLIDE, PlanarMode.SLIDE_ROCK}:
        return _sliding_reference(sliding, least)
    rocking = simulate_rocking(
        block,
        floor,
        duration=end,
        rotation=initial.rotation_rad,
        angular_velocity=initial.angular_velocity_rad_s,
    )
    return _rocking_reference(rocking, least)


def floor_of(motion: BaseMotion, *, driven_until: float) -> FloorAcceleration:
    """Acceleration of the floor of a run, which coasts once its duration is over."""
    data = motion.compiled()
    breaks = {*motion.break_times.tolist(), driven_until}
    if data.kind == PIECEWISE:  # it bends at every sample
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
    side = np.sign(rotation)
    bounds = np.flatnonzero(np.diff(side) != 0.0) + 1
    peaks = []
    for swing in np.split(np.arange(time.size), bounds):
        top = int(swing[np.argmax(np.abs(rotation[swing]))])
        if abs(rotation[top]) <= least or top in (0, time.size - 1):
            continue
        before, here, after = np.abs(rotation[top - 1 : top + 2])
        bend = before - 2.0 * here + after
        share = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
        peak = here - 0.25 * (before - after) * share
        peaks.append(
            (
                float(time[top] + share * (time[top + 1] - time[top])),
                float(math.copysign(peak, rotation[top])),
            )
        )
    return peaks


def reasons_against(model: Model, history: History, verdict: Verdict, reference: Reference) -> list[str]:
    """Why the container is not the rigid block it is compared with; none where it is."""
    mesh, static, contact = model.container.mesh, model.static, model.case.contact
    kind = model.case.support.kind
    bounce = contact_frequency(mesh.mass, model.base_stiffness)
    sinking = static.weight / model.base_stiffness / (mesh.width * static.slenderness_angle)
    stiffness = _first_elastic_frequency(model) / bounce
    reasons = []
    if not static.housner_credible:
        reasons.append(
            f"squat container: Housner's restitution is {static.housner_restitution:.3f}, below 0.5"
        )
    if kind != "corners":
        reasons.append(f"support {kind!r}: it turns about a region that moves, the block about its corners")
    if reference.slides_at_impact or _slides_at_impact(model, history, verdict):
        reasons.append("it slides at the first impact: Housner's impact does not")
    if stiffness < STIFF_CONTAINER:
        reasons.append(
            f"it deforms: first elastic over contact frequency is {stiffness:.2g}, below {STIFF_CONTAINER:g}"
        )
    if contact.damping_ratio < BOUNCING_CONTACT:
        reasons.append(
            f"the contact bounces: its damping ratio is {contact.damping_ratio:g}, below {BOUNCING_CONTACT:g}"
        )
    if sinking > SOFT_FLOOR:
        reasons.append(f"soft floor: the weight alone sinks in by {sinking:.1e} of width x slenderness angle")
    if abs(mesh.centroid[0]) > OFF_CENTRE * mesh.width:
        reasons.append(f"the mass centre is {mesh.centroid[0]:.3g} m beside the middle of the base")
    if reference.left_model_at is not None:
        reasons.append(
            f"the block leaves the floor, or its impact has no solution, at {reference.left_model_at:.4g} s"
        )
    if reference.first_impact is None and verdict.first_impact_s is None:
        reasons.append("no impact in either")
    return reasons


def _sliding_reference(motion: PlanarMotion, least: float) -> Reference:
    def at(times: FloatArray) -> tuple[FloatArray, FloatArray]:
        history = motion.at(times)
        return history.rotation, history.angular_velocity

    impact = next((i for i in motion.impacts if _swung(at, i.time, least)), None)
    outside = motion.outcome is PlanarMode.OUTSIDE
    return Reference(
        name="rigid block with friction",
        at=at,
        first_impact=None if impact is None else impact.time,
        velocity_ratio=None if impact is None else impact.velocity_after / impact.velocity_before,
        slides_at_impact=impact is not None and (impact.slides or impact.slip_velocity_before != 0.0),
        left_model_at=motion.end if outside else None,
    )


def _rocking_reference(motion: RockingMotion, least: float) -> Reference:
    impact = next((i for i in motion.impacts if _swung(motion.at, i.time, least)), None)
    return Reference(
        name="rigid block that does not slide",
        at=motion.at,
        first_impact=None if impact is None else impact.time,
        velocity_ratio=None if impact is None else impact.velocity_after / impact.velocity_before,
        slides_at_impact=False,
        left_model_at=None,
    )


def _swung(at: Callable[[FloatArray], tuple[FloatArray, FloatArray]], impact: float, least: float) -> bool:
    """Whether the block had tilted by more than `least` [rad] at any time before this impact."""
    return bool(np.nanmax(np.abs(at(np.linspace(0.0, impact, 512))[0])) > least)


def _paired(found: list[tuple[float, float]], expected: list[tuple[float, float]]) -> tuple[PeakPair, ...]:
    """Peaks of run and block in turn, as long as both swing to the same side."""
    pairs = takewhile(lambda pair: pair[0][1] * pair[1][1] > 0.0, zip(found, expected, strict=False))
    return tuple(
        PeakPair(run_s=run[0], run_rad=run[1], block_s=block[0], block_rad=block[1]) for run, block in pairs
    )


def _difference_before_impact(
    time: FloatArray,
    rotation: FloatArray,
    analytic: FloatArray,
    verdict: Verdict,
    reference: Reference,
    angle: float,
) -> float | None:
    """Largest |difference| of rotation until either has its first impact, over the slenderness angle [-]."""
    impacts = (verdict.first_impact_s, reference.first_impact)
    end = min((impact for impact in impacts if impact is not None), default=math.inf)
    before = (time < end) & np.isfinite(analytic)
    return float(np.abs(rotation - analytic)[before].max()) / angle if before.any() else None


def _first_elastic_frequency(model: Model) -> float:
    """Of the container [Hz]; infinite for the rigid model."""
    match model.case.solver.model:
        case "rigid":
            return math.inf
        case "reduced":
            return float(model.frequencies[0])
    return float(elastic_modes(model.container.elements, 1).frequencies_Hz[0])


def _slides_at_impact(model: Model, history: History, verdict: Verdict) -> bool:
    """Whether the run slides by what counts as sliding within a few samples of its first impact."""
    impact = verdict.first_impact_s
    if impact is None:
        return False
    first = int(np.searchsorted(history["time_s"], impact))
    near = history["slip_m"][max(first - 2, 0) : first + 3]
    return bool(np.ptp(near) > SLIDING * model.container.mesh.width) if near.size else False
