"""From a case to what is stepped: mesh, elements, support, body, contact, control, initial state.

Everything "auto" is decided here, once, whatever the model; `full`, `reduced` and `rigid` differ in the body
alone.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact import modal_body
from contact.body import State, make_state
from contact.floor_motion import floor_motion
from contact.initial import SettlingError, Stance, standing, tilted
from contact.interface import Contact, make_workspace
from contact.laws import ELASTIC_STICK, REGULARISED
from contact.modal_body import ModalBody, make_modal_body
from contact.motion import BaseMotion, PulseMotion, TableMotion
from contact.penalty import relaxation_time
from contact.run import Control, Run, make_run, make_samples
from contact.scheme import Scheme, generalised_alpha, newmark
from contact.support import Support
from contact.tracking import begin
from fem.assembly import FiniteElements, assemble
from fem.case import Case, CaseError
from fem.case_contact import build_support, normal_penalty, require_firm_floor
from fem.case_container import build_container, node_count
from fem.case_motion import build_motion, peak_acceleration_within
from fem.firm_start import require_firm_start
from fem.full_body import FullBody
from fem.modes import elastic_modes
from fem.reduction import ReducedBasis, StaticResponse, reduced_basis, static_response
from fem.required_memory import require_memory
from fem.static_checks import StaticChecks, static_checks
from fem.threads import use_one_blas_thread
from mesh.cells import FloatArray, IntArray
from mesh.container import ContainerMesh
from mesh.region import Region

#: largest step over the time scale of rocking, 1/p, and over that of the base motion
STEP_OF_ROCKING, STEP_OF_MOTION = 0.01, 0.02
#: .. of a motion shorter than this share of the run only while it lasts, in at most so many steps
SHORT_SHARE, MOST_PIECES = 0.5, 2000
#: a given step may be at most this share of the shortest period of the motion
COARSE_STEP = 0.1
#: .. and any step so many intervals of the history: the samples of a step are held in memory
MOST_SAMPLES_A_STEP = 64
#: over the largest step: the step in which friction may change between sticking and sliding
EVENT_SHARE = 0.01
SMALLEST_SHARE = 1e-7
#: over the time constant of a corner on its dashpot: the step that begins at a touch
CLOSING_SHARE_OF_TIME = 0.02
#: imbalance of the ledger that a step may have: see `contact.run.Control`
ENERGY_RATE, ENERGY_FLOOR, ENERGY_SHARE = 1e-5, 2e-7, 4e-3
#: .. at a first touch: over the energy that a rigid block would lose there
CLOSING_SHARE, LEAST_LOSS = 2e-3, 0.02
TRAIL_SHARE, TRAIL_TIME = 2e-2, 0.1
#: .. and however loose the tolerance: what is lost of what is dissipated is judged in the end. A rigid container
#: does not ring: it loses at the impact itself, once
MOST_SHARE, MOST_RIGID_SHARE, MOST_TRAIL = 8e-3, 4e-2, 3e-2
#: closings with less energy than this, over the energy to overturn, are left to the ledger
SOFT_CLOSING = 1e-6
#: error of a base point at which the iterations of a step stop, over the static penetration
POINT_TOLERANCE = 1e-6
HISTORY_CHUNK, FRAME_CHUNK = 1024, 64
#: .. of the full model, whose coordinates are many
FULL_HISTORY_CHUNK, FULL_FRAME_CHUNK = 16, 4
#: a Newmark run without averaging gains energy beyond both
STIFF_CONTACT, LARGE_CONTACT_STEP = 3.0, 0.7


@dataclass(frozen=True, kw_only=True, eq=False)
class Container:
    """What a case's container is made of, whatever floor it stands on and however that moves."""

    mesh: ContainerMesh
    elements: FiniteElements
    support: Support
    nodes: IntArray  #: (n_c,) contact nodes, those of the base first, by rising x
    monitors: IntArray  #: (n_m,) nodes that are followed
    response: StaticResponse
    basis: ReducedBasis | None  #: elastic modes, of a reduced model
    damping: float  #: a of C = a K [s]
    first: float  #: lowest elastic angular frequency; infinite for a rigid container [rad/s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Footing:
    """How a container stands on its floor before that moves."""

    penalty: float  #: [Pa/m]
    contact: Contact
    body: ModalBody | FullBody
    stance: Stance  #: the floor being at x = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class Model:
    """One case, ready to be stepped."""

    case: Case
    container: Container
    footing: Footing
    motion: BaseMotion
    static: StaticChecks
    run: Run

    @property
    def penalty(self) -> float:
        """Normal stiffness of the base over width times depth [Pa/m]."""
        return self.footing.penalty

    @property
    def body(self) -> ModalBody | FullBody:
        """What is stepped."""
        return self.footing.body

    @property
    def base_stiffness(self) -> float:
        """Of all base points together [N/m]."""
        return float(self.run.contact.normal_stiffness[: self.container.support.index.size].sum())

    @property
    def frequencies(self) -> FloatArray:
        """Elastic frequencies of the model's modes [Hz]: all of `reduced`, the first of `full`, none of `rigid`."""
        if self.container.basis is not None:
            return self.container.basis.angular_frequencies / (2.0 * np.pi)
        first = self.container.first
        return np.array([first / (2.0 * np.pi)]) if math.isfinite(first) else np.zeros(0)


def discretise(case: Case) -> Container:
    """Mesh, elements, supporting nodes and elastic modes of a case's container.

    Raises:
        CaseError, MeshError: bad input.
    """
    use_one_blas_thread()
    mesh = build_container(case)
    support = build_support(case, mesh)
    require_memory(case, node_count(mesh, case.solver.order), support.index.size)
    elements = assemble(
        mesh,
        youngs_modulus=case.container.youngs_modulus_Pa,
        poisson_ratio=case.container.poisson_ratio,
        order=case.solver.order,
    )
    nodes = elements.base_nodes[support.index]
    if not case.output.stop_when_overturned:  # it will come to lie on its side: the upper corners touch too
        nodes = np.concatenate([nodes, _upper_corners(elements)])
    response = static_response(elements, nodes)
    basis, first, damping = None, math.inf, 0.0
    if case.solver.model == "reduced":
        basis = reduced_basis(elements, response, case.solver.elastic_modes)
        first = float(basis.angular_frequencies[0])
    elif case.solver.model == "full":
        first = float(elastic_modes(elements, 1).angular_frequencies[0])
    if math.isfinite(first):
        damping = 2.0 * case.container.damping_ratio / first
    return Container(
        mesh=mesh,
        elements=elements,
        support=support,
        nodes=nodes,
        monitors=_monitors(elements),
        response=response,
        basis=basis,
        damping=damping,
        first=first,
    )


def set_down(case: Case, container: Container) -> Footing:
    """Put the container on the floor, settled; models of it share a body's scratch: step one at a time.

    Raises:
        CaseError: no equilibrium at the start.
    """
    penalty = normal_penalty(case, container.mesh)
    springs = container.support.normal_stiffness(penalty)
    base = springs.size
    require_firm_floor(case, container.mesh, float(springs.sum()))
    springs = np.concatenate([springs, np.full(container.nodes.size - base, 0.5 * springs.sum())])
    contact = _contact(case, container.mesh, springs, base)
    try:
        stance = _stance(case, container, contact)
    except SettlingError as error:
        raise CaseError(f"[initial] no equilibrium at the start: {error}") from error
    return Footing(penalty=penalty, contact=contact, body=_body(case, container, contact), stance=stance)


def stands_like(case: Case, other: Case) -> bool:
    """Whether two cases of one container have the same footing."""
    return (
        case.contact == other.contact
        and case.initial == other.initial
        and case.gravity_m_s2 == other.gravity_m_s2
        and case.solver.model == other.solver.model
    )


def build_model(case: Case, container: Container | None = None, footing: Footing | None = None) -> Model:
    """Discretise a case and put it on its floor, unless that is given, settled, at t = 0.

    Args:
        case: what to build.
        container: its container, built before.
        footing: how that container stands, where `stands_like` says that it is the same.

    Raises:
        CaseError, MeshError: bad input, no equilibrium at the start.
    """
    motion = build_motion(case)
    if container is None:
        container = discretise(case)
    footing = footing or set_down(case, container)
    mesh, nodes, contact, body = container.mesh, container.nodes, footing.contact, footing.body
    static = checks_of(case, mesh, motion)
    largest, breaks = _largest_step(case, static, motion)
    control = _control(case, container, static, largest, contact)
    scheme = _scheme(case, container, footing.penalty, control, contact)
    full = isinstance(body, FullBody)
    coordinates = body.coordinates if isinstance(body, FullBody) else 3 + body.stiffness.size
    old, new = (make_state(coordinates, nodes.size, container.monitors.size) for _ in range(2))
    compiled_motion = motion.compiled()
    floor, floor_velocity, _ = floor_motion(compiled_motion, 0.0)
    drift = floor_velocity if case.motion.start == "moving" else 0.0
    _place(body, old, footing.stance.moved(floor), container.response, floor, drift, contact)
    require_firm_start(
        case, width=mesh.width, reference_energy=control.reference_energy, contact=contact, start=old
    )
    interval, fields = case.output.history_s, case.output.fields_s
    stacked = case.container.boxes > 1  # the forces in its joints follow from the motion
    run = make_run(
        scheme=scheme,
        contact=contact,
        motion=compiled_motion,
        breaks=breaks,
        control=control,
        old=old,
        new=new,
        work=make_workspace(nodes.size),
        history=make_samples(
            interval,
            _chunk(FULL_HISTORY_CHUNK if full else HISTORY_CHUNK, control.largest_step, interval),
            nodes.size,
            columns=True,
            position=0 if full and not stacked else coordinates,
            velocity=coordinates if stacked else 0,
        ),
        frames=make_samples(
            fields if fields > 0.0 else math.inf,
            _chunk(FULL_FRAME_CHUNK if full else FRAME_CHUNK, control.largest_step, fields or math.inf),
            nodes.size,
            position=coordinates if fields > 0.0 else 0,
            velocity=coordinates if fields > 0.0 else 0,
        ),
    )
    begin(run.track[0], control, old)
    return Model(case=case, container=container, footing=footing, motion=motion, static=static, run=run)


def checks_of(case: Case, mesh: ContainerMesh, motion: BaseMotion) -> StaticChecks:
    """Static checks of the meshed container under its own motion."""
    return static_checks(
        mass=mesh.mass,
        centroid=mesh.centroid[1],
        inertia=mesh.inertia,
        width=mesh.width,
        gravity=case.gravity_m_s2,
        mu_static=case.contact.mu_static,
        mu_kinetic=case.contact.mu_kinetic,
        peak_floor_acceleration=peak_acceleration_within(motion, case.solver.duration_s),
        ground_acceleration=case.static.ground_acceleration_m_s2,
        soil_factor=case.static.soil_factor,
        behaviour_factor=case.static.behaviour_factor,
        importance_factor=case.static.importance_factor,
        initial_rotation=case.initial.rotation_rad,
    )


def reference_energy(mesh: ContainerMesh, static: StaticChecks, gravity: float) -> float:
    """What it takes to overturn the container quasi-statically, M g R (1 - cos slenderness angle) [J]."""
    return mesh.mass * gravity * static.radius * (1.0 - math.cos(static.slenderness_angle))


def _largest_step(case: Case, static: StaticChecks, motion: BaseMotion) -> tuple[float, FloatArray]:
    """Largest step of the run [s], and the instants that a step must end on, rising [s].

    A pulse or a record that is over long before the run is makes small steps while it lasts, by instants closely
    set, and not ever after.

    Raises:
        CaseError: a step given that would step over the motion.
    """
    solver, output = case.solver, case.output
    free, wanted = STEP_OF_ROCKING / static.frequency_parameter, STEP_OF_MOTION * motion.time_scale
    ends = [time for time in motion.break_times if 0.0 < time < solver.duration_s]
    begin, end = _span(motion)
    pieces = (end - begin) / wanted if math.isfinite(end) else math.inf
    short = pieces <= MOST_PIECES and end - begin < SHORT_SHARE * solver.duration_s
    if short and wanted < (free if solver.step_s == "auto" else solver.step_s):
        inside = np.linspace(begin, end, math.ceil(pieces) + 1)
        ends = sorted({*ends, *inside[(inside > 0.0) & (inside < solver.duration_s)].tolist()})
        wanted = math.inf
    largest = min(free, wanted)
    if solver.step_s != "auto":
        if solver.step_s > COARSE_STEP * motion.time_scale and not short:
            raise CaseError(
                f"[solver] step_s = {solver.step_s:g} s would step over the motion of the floor, whose shortest period "
                f'is {motion.time_scale:.3g} s; take at most {COARSE_STEP * motion.time_scale:.2g} s, or "auto"'
            )
        largest = solver.step_s
    interval = min(output.history_s, output.fields_s or math.inf)
    largest = min(largest, solver.duration_s, MOST_SAMPLES_A_STEP * interval)
    return largest, np.array([*ends, solver.duration_s])


def _span(motion: BaseMotion) -> tuple[float, float]:
    """When a pulse or a record begins and ends; a drive is taken to go on [s]."""
    if isinstance(motion, PulseMotion):
        return motion.delay, motion.delay + motion.pulse
    if isinstance(motion, TableMotion):
        return float(motion.times[0]), float(motion.times[-1])
    return 0.0, math.inf


def _chunk(wanted: int, largest_step: float, interval: float) -> int:
    """Samples to keep at a time: never fewer than two largest steps make."""
    return max(wanted, 2 * math.ceil(largest_step / interval) + 4)


def _upper_corners(elements: FiniteElements) -> IntArray:
    x, z = elements.nodes.T
    top = np.flatnonzero(z >= z.max() - 1e-9 * np.ptp(z))
    return top[[np.argmin(x[top]), np.argmax(x[top])]]


def _monitors(elements: FiniteElements) -> IntArray:
    """Nodes to follow: the two upper corners, then the middle and the outermost nodes of the contents."""
    contents = np.isin(elements.region, (Region.FILL, Region.SOLID))
    held = np.unique(elements.cells[contents] if contents.any() else elements.cells)
    x, z = elements.nodes[held].T
    corners = [
        held[np.argmax(a * x / np.ptp(x) + b * z / np.ptp(z))] for a in (-1.0, 1.0) for b in (-1.0, 1.0)
    ]
    middle = held[np.argmin(np.hypot(x - x.mean(), z - 0.5 * (z.min() + z.max())))]
    return np.concatenate([_upper_corners(elements), [middle, *corners]])


def _contact(case: Case, mesh: ContainerMesh, springs: FloatArray, base: int) -> Contact:
    laws = {"elastic-stick": ELASTIC_STICK, "regularised": REGULARISED}
    chosen = case.contact
    return Contact(
        normal_stiffness=springs,
        tangential_stiffness=chosen.tangential_ratio * springs,
        relaxation_time=relaxation_time(chosen.damping_ratio, mesh.mass, float(springs[:base].sum())),
        mu_static=chosen.mu_static,
        mu_kinetic=chosen.mu_kinetic,
        weakening=chosen.weakening_m,
        friction=laws[chosen.friction],
        regularisation_velocity=chosen.regularisation_velocity_m_s,
        force_scale=mesh.mass * case.gravity_m_s2,
        resolution=1e-15 * (mesh.width + mesh.height),
    )


def _struck_mass(case: Case, container: Container) -> float:
    """Mass that a corner puts against the floor in the first instant of an impact [kg].

    The whole, turning container's for a rigid one; for an elastic one hardly more than the corner's own.
    """
    mesh, corner = container.mesh, container.nodes[0]
    if case.solver.model == "full":
        return float((container.elements.mass @ np.ones(len(container.elements.nodes)))[corner])
    arm = container.elements.nodes[corner, 0] - mesh.centroid[0]
    inverse = 1.0 / mesh.mass + arm * arm / mesh.inertia
    if container.basis is not None:
        inverse += float(np.sum(container.basis.shapes[:, corner, 1] ** 2))
    return 1.0 / inverse


def _control(
    case: Case, container: Container, static: StaticChecks, largest: float, contact: Contact
) -> Control:
    mesh, base = container.mesh, container.support.index.size
    reference = reference_energy(mesh, static, case.gravity_m_s2)
    rate = static.frequency_parameter
    loose, rigid = case.solver.energy_tolerance, case.solver.model == "rigid"
    spring = float(contact.normal_stiffness[0])
    struck = _struck_mass(case, container)
    # Time constants of a mass on the dashpot and on the spring of a corner.
    closing = CLOSING_SHARE_OF_TIME / (
        spring * contact.relaxation_time / struck + 0.2 * math.sqrt(2.0 * spring / mesh.mass)
    )
    return Control(
        largest_step=largest,
        smallest_step=SMALLEST_SHARE * largest,
        event_step=EVENT_SHARE * largest,
        closing_step=min(closing, largest),
        closing_speed=math.sqrt(SOFT_CLOSING * reference / mesh.mass),
        reference_energy=reference,
        energy_rate=loose * ENERGY_RATE * rate,
        energy_floor=loose * ENERGY_FLOOR,
        energy_share=min(loose * ENERGY_SHARE, MOST_RIGID_SHARE if rigid else MOST_SHARE),
        trail_share=min(loose * TRAIL_SHARE, MOST_TRAIL),
        trail_time=TRAIL_TIME / rate,
        closing_share=loose * CLOSING_SHARE * max(1.0 - static.housner_restitution**2, LEAST_LOSS),
        mass=mesh.mass,
        gravity=case.gravity_m_s2,
        frequency_parameter=rate,
        resting_energy=mesh.mass * case.gravity_m_s2 * mesh.centroid[1],
        slenderness_angle=static.slenderness_angle,
        width=mesh.width,
        stop_when_overturned=case.output.stop_when_overturned,
        top_monitors=2,
        base_points=base,
    )


def _scheme(case: Case, container: Container, penalty: float, control: Control, contact: Contact) -> Scheme:
    solver, elements = case.solver, container.elements
    if solver.scheme == "generalised-alpha":
        return generalised_alpha(solver.spectral_radius)
    nodal = elements.mass @ np.ones(len(elements.nodes))
    stiff = penalty * solver.element_size_m / case.container.youngs_modulus_Pa
    rate = math.sqrt(float(np.max(contact.normal_stiffness / nodal[container.nodes])))
    if stiff > STIFF_CONTACT and control.largest_step * rate > LARGE_CONTACT_STEP:
        raise CaseError(
            "[solver] scheme = 'newmark' gains energy at impacts here: normal_penalty_Pa_m x element_size_m / "
            f"youngs_modulus_Pa = {stiff:.3g} > {STIFF_CONTACT:g} together with step x contact frequency = "
            f"{control.largest_step * rate:.3g} > {LARGE_CONTACT_STEP:g}; lower the penalty, set solver.step_s "
            f"<= {LARGE_CONTACT_STEP / rate:.2g} s, or take scheme = 'generalised-alpha'"
        )
    return newmark(solver.newmark_beta, solver.newmark_gamma)


def _body(case: Case, container: Container, contact: Contact) -> ModalBody | FullBody:
    elements, mesh, gravity = container.elements, container.mesh, case.gravity_m_s2
    nodes, monitors = container.nodes, container.monitors
    if case.solver.model == "full":
        return FullBody(elements, nodes, monitors, gravity=gravity, damping=container.damping)
    centroid = np.asarray(mesh.centroid)
    basis = container.basis
    omega = np.zeros(0) if basis is None else basis.angular_frequencies
    shapes = np.zeros((0, *elements.nodes.shape)) if basis is None else basis.shapes
    penetration = mesh.mass * gravity / float(contact.normal_stiffness.sum())
    return make_modal_body(
        mass=mesh.mass,
        inertia=mesh.inertia,
        gravity=gravity,
        point=elements.nodes[nodes] - centroid,
        rest=mesh.centroid,
        shape=np.moveaxis(shapes[:, nodes], 0, -1),
        frequencies=omega,
        damping_ratios=0.5 * container.damping * omega,
        monitor=elements.nodes[monitors] - centroid,
        monitor_shape=np.moveaxis(shapes[:, monitors], 0, -1),
        tolerance=POINT_TOLERANCE * penetration,
    )


def _stance(case: Case, container: Container, contact: Contact) -> Stance:
    """How the container stands on its floor at t = 0, the floor being at x = 0."""
    mesh, elements, initial = container.mesh, container.elements, case.initial
    base = container.support.index.size
    nodes = container.nodes[:base]
    point = elements.nodes[nodes] - np.asarray(mesh.centroid)
    elastic = 0.0 if case.solver.model == "rigid" else 1.0
    compliance = elastic * container.response.compliance[: 2 * base, : 2 * base]
    if initial.rotation_rad == 0.0:
        stance = standing(
            weight=mesh.mass * case.gravity_m_s2,
            centroid=mesh.centroid,
            point=point,
            compliance=compliance,
            normal_stiffness=contact.normal_stiffness[:base],
        )
        if initial.angular_velocity_rad_s != 0.0:
            stance = stance.turning(initial.angular_velocity_rad_s, point)
    else:
        corner = nodes[-1] if initial.rotation_rad > 0.0 else nodes[0]
        stance = tilted(
            rotation=initial.rotation_rad,
            angular_velocity=initial.angular_velocity_rad_s,
            mass=mesh.mass,
            inertia=mesh.inertia,
            gravity=case.gravity_m_s2,
            point=point,
            corner_x=float(elements.nodes[corner, 0]),
            compliance=compliance,
            normal_stiffness=contact.normal_stiffness[:base],
            mu_static=contact.mu_static,
        )
    return stance.with_points(container.nodes.size).sliding(initial.velocity_m_s)


def _place(
    body: Any,
    state: State,
    stance: Stance,
    response: StaticResponse,
    floor: float,
    floor_velocity: float,
    contact: Contact,
) -> None:
    """Write the initial state: the stance on the floor where it is at t = 0."""
    state.force[:] = stance.force
    if contact.friction == ELASTIC_STICK:  # friction regularised in velocity has no springs
        state.stick[:] = -stance.force[:, 0] / contact.tangential_stiffness
    if isinstance(body, FullBody):
        body.place(state, stance, response, floor_velocity)
        body.start(state, floor)
    else:
        modal_body.place(body, state, stance, floor_velocity)
        modal_body.start(body, state, floor)
