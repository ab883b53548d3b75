"""Limits of the time stepping of a case: largest step, tolerances of a step, scheme."""

import math
from collections.abc import Sequence

import numpy as np

from contact.interface.workspace import Contact
from contact.motion.base_motion import BaseMotion, TableMotion
from contact.stepping.scheme import Scheme, generalised_alpha, newmark
from contact.stepping.state import Control
from fem.case.case import Case, CaseError
from fem.model.bounce import bounce_of
from fem.model.container import Container
from fem.model.frames import INTERVALS
from fem.model.static_checks import StaticChecks
from fem.runtime.arrays import FloatArray

#: largest step over the time scale of rocking, 1/p, and over that of the base motion
STEP_OF_ROCKING, STEP_OF_MOTION = 0.01, 0.02
#: the latter of eager steps on a record, of which they span half an interval. Of 180 records of 5, 10 and 20 ms that
#: rock a rigid container hard, 22 change between standing and overturning by it, against a tolerance of 0.1; with steps
#: of a fifth of an interval 27, with the usual tolerance 16. The mean rotation ratio differs by at most 0.025
EAGER_STEP_OF_RECORD = 0.05
#: share of the run below which a motion sets the step only while it lasts, in at most so many steps
SHORT_SHARE, MOST_PIECES = 0.5, 2000
#: largest step that may be given, over the shortest period of the motion
COARSE_STEP = 0.1
#: intervals of the history that a step may span: its samples are held in memory
MOST_SAMPLES_A_STEP = 64
#: over the width, of a row that of its narrowest container: base points nearer than this close together
NEAR = 0.25
#: over the largest step: the step in which friction may change between stick and slip
EVENT_SHARE = 0.01
SMALLEST_SHARE = 1e-7
#: over the time constant of a corner on its dashpot: the step that begins at a contact
CLOSING_SHARE_OF_TIME = 0.02
#: tolerances of the energy balance of a step: see `contact.stepping.state.Control`
ENERGY_RATE, ENERGY_FLOOR, ENERGY_SHARE = 1e-5, 2e-7, 4e-3
#: the same at a first contact: over the energy that a rigid block would lose there, of which the least is given
CLOSING_SHARE, LEAST_LOSS = 2e-3, 0.02
TRAIL_SHARE, TRAIL_TIME = 2e-2, 0.1
#: shares with the loosest tolerance: the audit judges the loss over the dissipated energy at the end
MOST_SHARE, MOST_TRAIL = 8e-3, 3e-2
#: the same of a rigid container: it does not ring, and loses energy once, at the impact itself
MOST_RIGID_SHARE, MOST_RIGID_TRAIL = 1e-1, 4e-1
EAGER_TOLERANCE = 2.0  #: above which its steps are eager, as of maps
#: the same of a loose stack of rigid boxes, which rattle
MOST_RATTLING_SHARE = 4e-2
#: energy of a contact, over the energy to overturn, below which the energy balance alone controls the step
SOFT_CLOSING = 1e-6
#: beyond both limits a Newmark run without averaging gains energy
STIFF_CONTACT, LARGE_CONTACT_STEP = 3.0, 0.7


def steps_eagerly(case: Case) -> bool:
    """Whether a run steps as those of maps do: of rigid bodies on the floor, with a loose tolerance."""
    rigid = case.solver.model == "rigid" and not case.container.is_loose
    return rigid and case.solver.energy_tolerance > EAGER_TOLERANCE


def largest_step_of(
    case: Case, rocking: float, duration: float, *motions: BaseMotion
) -> tuple[float, FloatArray]:
    """Largest step of the run [s], and the instants that a step must end on, rising [s].

    A pulse or record much shorter than the run sets small steps only while it lasts, by closely spaced instants.
    CaseError: a given step that is too long for a motion.

    Args:
        rocking: frequency parameter, of a row the largest of all [1/s].
        duration: its `longest_run` [s].
    """
    solver, output, eager = case.solver, case.output, steps_eagerly(case)
    largest, ends = STEP_OF_ROCKING / rocking, set[float]()
    if solver.step_s != "auto":
        largest = solver.step_s
    most = largest
    for motion in motions:
        share = EAGER_STEP_OF_RECORD if eager and isinstance(motion, TableMotion) else STEP_OF_MOTION
        wanted, (begin, end) = share * motion.time_scale, motion.span
        pieces = (end - begin) / wanted if math.isfinite(end) else math.inf
        short = pieces <= MOST_PIECES and end - begin < SHORT_SHARE * duration
        inside = np.asarray(motion.break_times, dtype=float)
        if short and wanted < most:
            inside = np.append(inside, np.linspace(begin, end, math.ceil(pieces) + 1))
        elif solver.step_s == "auto":
            largest = min(largest, wanted)
        elif solver.step_s > COARSE_STEP * motion.time_scale and not short:
            raise CaseError(
                f"[solver] step_s = {solver.step_s:g} s would step over the motion of the floor, whose shortest period "
                f'is {motion.time_scale:.3g} s; take at most {COARSE_STEP * motion.time_scale:.2g} s, or "auto"'
            )
        ends.update(inside[(inside > 0.0) & (inside < duration)].tolist())
    frames = INTERVALS[0] if output.fields_s == "auto" else output.fields_s
    interval = min(output.history_s, frames or math.inf)
    largest = min(largest, duration, MOST_SAMPLES_A_STEP * interval)
    # without those too close to one another: the inertia over the square of so short a step would overflow or be noise
    kept, least = [0.0], SMALLEST_SHARE * largest
    for instant in sorted(ends):
        if instant - kept[-1] >= least and duration - instant >= least:
            kept.append(instant)
    return largest, np.array([*kept[1:], duration])


def _struck_mass(case: Case, container: Container) -> float:
    """Effective mass of a corner in the first instant of an impact [kg]; of several bodies the least.

    Of a rigid container that of the whole, rotating body; of an elastic one little more than the corner's own.
    """
    if case.solver.model == "full":
        return float(container.elements.nodal_mass[container.nodes[0]])
    masses = []
    for body in container.bodies:
        for corner in body.nodes if container.boxes else body.nodes[:1]:
            arm = float(body.elements.nodes[corner, 0] - body.mesh.centroid[0])
            elastic = float(np.sum(body.basis.shapes[:, corner, 1] ** 2))
            masses.append(1.0 / (1.0 / body.mesh.mass + arm * arm / body.mesh.inertia + elastic))
    return min(masses)


def control_of(
    case: Case,
    container: Container,
    static: StaticChecks,
    largest: float,
    contact: Contact,
    row: Sequence[StaticChecks] = (),
) -> Control:
    """Limits of the stepping, from the time scales and energies of container and contact; `largest`: step [s].

    `row`: of each container of a row alone. The one that takes least to overturn sets the limits of energy, the one
    that rocks most slowly how long nothing may move at rest.
    """
    mesh, base = container.mesh, container.support.index.size
    bodies = [alone.mesh for alone in container.row] or [mesh]
    mass = sum(body.mass for body in bodies)
    energies = [checks.overturning_energy for checks in row or [static]]
    reference = min(energies)
    softest = min(SOFT_CLOSING * energy / body.mass for energy, body in zip(energies, bodies, strict=True))
    rate = static.frequency_parameter
    loose = case.solver.energy_tolerance
    share, trail = MOST_SHARE, MOST_TRAIL
    if case.solver.model == "rigid":
        share = MOST_RATTLING_SHARE
        if container.row or not container.boxes:
            share, trail = MOST_RIGID_SHARE, MOST_RIGID_TRAIL
    spring, dashpots = float(contact.normal_stiffness[0]), contact.normal_stiffness * contact.relaxation_time
    joints = dashpots[: dashpots.size - len(case.links)]
    dashpot = float(joints.max() if container.boxes else dashpots[0])
    struck = _struck_mass(case, container)
    # Time constants of a mass on the dashpot and on the spring of a corner.
    closing = CLOSING_SHARE_OF_TIME / (dashpot / struck + 0.2 * math.sqrt(2.0 * spring / mesh.mass))
    return Control(
        largest_step=largest,
        smallest_step=SMALLEST_SHARE * largest,
        event_step=EVENT_SHARE * largest,
        closing_step=float(min(closing, largest)),  # a number of numpy would make each call of a kernel slow
        closing_speed=math.sqrt(softest),
        reference_energy=reference,
        energy_rate=loose * ENERGY_RATE * rate,
        energy_floor=loose * ENERGY_FLOOR,
        energy_share=min(loose * ENERGY_SHARE, share),
        recent_share=min(loose * TRAIL_SHARE, trail),
        recent_time=TRAIL_TIME / rate,
        closing_share=loose * CLOSING_SHARE * max(1.0 - static.housner_restitution**2, LEAST_LOSS),
        mass=mass,
        inertia=mesh.inertia,
        gravity=case.gravity_toward_floor,
        downhill=case.gravity_downhill,
        frequency_parameter=rate,
        force_window=bounce_of(case, container, contact).force_window(rate),
        resting_energy=sum(body.mass * case.gravity_toward_floor * body.centroid[1] for body in bodies),
        slowest_rocking=min(checks.frequency_parameter for checks in (static, *row)),
        slenderness_angle=static.slenderness_angle,
        width=static.width,
        near=NEAR * min([static.width, *(checks.width for checks in row)]),
        stop_when_overturned=case.output.stop_when_overturned,
        contents_cutoff=2.0 * math.pi * case.output.contents_filter_Hz,
        top_monitors=2,
        base_points=base,
        rolls=case.rolls,
        eager=steps_eagerly(case),
    )


def scheme_of(case: Case, container: Container, penalty: float, control: Control, contact: Contact) -> Scheme:
    """Time-stepping scheme; `penalty`: normal stiffness of the base [Pa/m].

    CaseError: a Newmark run that would gain energy.
    """
    solver = case.solver
    if solver.scheme == "generalised-alpha":
        return generalised_alpha(solver.spectral_radius)
    stiff = penalty * solver.element_size_m / case.container.youngs_modulus_Pa
    rate = math.sqrt(float(np.max(contact.normal_stiffness / container.elements.nodal_mass[container.nodes])))
    if stiff > STIFF_CONTACT and control.largest_step * rate > LARGE_CONTACT_STEP:
        softer = "take a softer floor" if case.floor.is_slab else "lower the penalty"
        raise CaseError(
            "[solver] scheme = 'newmark' gains energy at impacts here: normal_penalty_Pa_m x element_size_m / "
            f"youngs_modulus_Pa = {stiff:.3g} > {STIFF_CONTACT:g} together with step x contact frequency = "
            f"{control.largest_step * rate:.3g} > {LARGE_CONTACT_STEP:g}; {softer}, set solver.step_s "
            f"<= {LARGE_CONTACT_STEP / rate:.2g} s, or choose scheme = 'generalised-alpha'"
        )
    return newmark(solver.newmark_beta, solver.newmark_gamma)
