"""Static equilibrium of a container on its floor at t = 0: contact, body, settled stance."""

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.interface.equilibrium import SettlingError, Stance, standing, tilted
from contact.interface.faces import place_points
from contact.interface.laws import FRICTION_LAWS
from contact.interface.penalty import relaxation_time
from contact.interface.workspace import Contact
from contact.stepping.body import ROTATION
from contact.stepping.links import LinkedBody
from contact.stepping.modal_body import ModalBody
from fem.case.case import Case, CaseError
from fem.model.bodies import (
    body_of_row,
    contact_of_row,
    floating_body,
    make_stack_state,
    measure_gaps,
    own_stiffness,
    require_no_jam,
    settle,
    stack_of,
    with_joints,
)
from fem.model.bounce import bounce_of
from fem.model.container import Container
from fem.model.floor import slab_of
from fem.model.links import lines_at, places_of_links, with_links
from fem.model.support import base_points, edge_factors, normal_penalty, rolling_of, steel_penalty
from fem.model.validity import require_bearing, require_stiff_contact, require_stiff_container
from fem.runtime.arrays import FloatArray
from fem.solid.edges import shapes_at
from fem.solid.elasticity import least_principal_strain
from fem.solid.nodal_body import Body, FullBody, FullStack, rotation_matrix

#: error of a base point at which the iterations of a step stop, over the static penetration
POINT_TOLERANCE = 1e-6
POINT_SHARE = 0.1  #: of the resistance to rolling that the dashpots of the points may have


@dataclass(frozen=True, kw_only=True, eq=False)
class Equilibrium:
    """A container at rest on its floor, at t = 0 with the floor at x = 0."""

    penalty: float  #: normal stiffness over width times depth [Pa/m]
    damping_ratio: float  #: of the contact
    gravity: float  #: toward the floor, with its upward acceleration at t = 0 [m/s2]
    contact: Contact  #: of a loose stack at the full weight of all its points
    body: Body
    stance: Stance | None  #: None of a loose stack, which is settled by `settle_stack`, and of a row
    row: tuple["Equilibrium", ...] = ()  #: of the containers of a row alone


def find_equilibrium(
    case: Case, container: Container, gravity: float, penalty: float | None = None
) -> Equilibrium:
    """Settle the container on the floor under this gravity: that of the case and the floor's acceleration at t = 0.

    `penalty` is that of the rigid floor of its row [Pa/m]; None: as the case chooses. Models of one equilibrium share
    the scratch arrays of its body: step one at a time. CaseError: no equilibrium at the start, or one that sinks or
    crushes the container.
    """
    if gravity <= 0.0:
        raise CaseError(
            f"[vertical] at t = 0 the floor accelerates downward by {case.gravity_toward_floor - gravity:.4g} m/s2, "
            "which leaves nothing of gravity to settle the container; begin with a ramp, a delay or another phase"
        )
    if container.row:
        return _of_row(case, container, gravity)
    penalty = penalty or normal_penalty(case, container.mesh)
    springs = container.support.normal_stiffness(penalty)
    base, mass = springs.size, container.mesh.mass
    require_stiff_contact(case, container.mesh, float(springs.sum()))
    if not container.boxes:
        corners = container.nodes.size - base - len(case.links)
        springs = np.concatenate([springs, np.full(corners, 0.5 * springs.sum())])
    contact = _contact(case, container, springs)
    stance: Stance | None = None
    body: Body
    try:
        if container.boxes:
            contact = with_joints(case, contact, mass, steel_penalty(case, container.mesh))
            contact = with_links(case, contact, [mass])
            penetration = mass * case.gravity_toward_floor / float(contact.normal_stiffness[:2].sum())
            stack = stack_of(case, container, contact, POINT_TOLERANCE * penetration)
            state = make_stack_state(stack)
            corner_forces = settle(stack, own_stiffness(contact), state, gravity=gravity)
            line = lines_at(case, state.point[len(state.point) - len(case.links) :], container.mesh.width)
            body, force = _linked(stack, line), state.force
            turns = state.boxes[:, ROTATION].tolist()
            pressed = list(zip(container.boxes, corner_forces, turns, strict=True))
        else:
            stance = _stance(case, container, contact, gravity)
            body, force = _body(case, container, contact, stance), stance.force[: contact.cap.size]
            contact = with_links(case, contact, [mass])
            pressed = [(container, stance.with_points(container.nodes.size).force, stance.rotation)]
    except SettlingError as error:
        slope = case.floor.slope_percent
        table = (
            f"[floor] slope_percent = {slope:g}: nothing stands there"
            if slope
            else "[initial] no equilibrium at the start"
        )
        raise CaseError(f"{table}: {error}") from error
    if case.initial.rotation_rad == 0.0:  # tilted, it sinks in at its edge until enough of the patch bears
        most = int(np.argmax(force[:, 1] / contact.cap[: len(force)]))
        require_bearing(case, container.mesh, (float(force[most, 1]), float(contact.cap[most])))
    else:
        require_bearing(case, container.mesh)
    if case.solver.model != "rigid":
        require_stiff_container(case, max(_strain(*each) for each in pressed))
    return Equilibrium(
        penalty=penalty,
        damping_ratio=float(contact.relaxation_time[0])
        / relaxation_time(1.0, mass, float(springs[:base].sum())),
        gravity=gravity,
        contact=contact,
        body=body,
        stance=stance,
    )


def _of_row(case: Case, container: Container, gravity: float) -> Equilibrium:
    """The containers of a row, each at rest for itself: their sides carry nothing."""
    penalty = None if case.floor.is_slab else normal_penalty(case, container.mesh)
    row = [find_equilibrium(*alone, gravity, penalty) for alone in zip(case.row, container.row, strict=True)]
    meshes = [settled.mesh for settled in container.row]
    require_no_jam(case, meshes)
    masses = [mesh.mass for mesh in meshes]
    contact = with_links(case, contact_of_row(case, [settled.contact for settled in row], masses), masses)
    bodies = [settled.body for settled in row if isinstance(settled.body, ModalBody)]
    body = body_of_row(case, bodies, container.row, contact)
    boxes = body.body.boxes
    standing = boxes.rest[:, None] + boxes.point  # corners, each in its own frame, (N, 4, 2) [m]
    for b, (alone, settled) in enumerate(zip(case.row, row, strict=True)):
        if settled.stance is not None and alone.initial.rotation_rad == 0.0:
            turn = rotation_matrix(settled.stance.rotation)
            standing[b] = np.asarray(settled.stance.centre) + boxes.point[b] @ turn.T
    measure_gaps(body, standing, own_stiffness(contact))
    place = np.zeros((contact.cap.size, 2))
    place_points(body.faces, standing.reshape(-1, 2), place)
    size = sum(mesh.width + mesh.height for mesh in meshes)
    line = lines_at(case, place[len(place) - len(case.links) :], size)
    return replace(row[0], contact=contact, body=_linked(body, line), stance=None, row=tuple(row))


def _linked(body: Body, line: FloatArray | None) -> Body:
    """A body with its links."""
    if isinstance(body, FullBody | FullStack):
        body.line = line
        return body
    return body if line is None else LinkedBody(body=body, line=line)


def same_equilibrium(case: Case, other: Case) -> bool:
    """Whether two cases of one container share an equilibrium, if their floors begin with one vertical acceleration."""
    tables = ("contact", "support", "joints", "floor", "initial", "links", "neighbour", "gravity_m_s2")
    mass = ("centroid_m", "eccentricity_m", "damping_ratio", "fill_damping_ratio")
    return (
        all(getattr(case, key) == getattr(other, key) for key in tables)
        and all(getattr(case.container, key) == getattr(other.container, key) for key in mass)
        and case.solver.model == other.solver.model
    )


def _strain(body: Container, force: FloatArray, rotation: float) -> float:
    """Largest compressive strain under forces (n, 2) [N] at the points of the response [-]."""
    own, response = (force @ rotation_matrix(rotation)).ravel(), body.response.displacement
    displacement = np.tensordot(own[: len(response)], response, axes=1)
    return -least_principal_strain(body.elements.displacement_gradient(displacement))


def _contact(case: Case, container: Container, springs: FloatArray) -> Contact:
    """The floor under so many springs, those of the base first."""
    mesh, chosen, camber = container.mesh, case.contact, container.support.camber
    corner = 0.5 * float(springs[: camber.size].sum())
    if case.floor.is_slab:
        slab = slab_of(case, mesh.mass)
        ratio, relaxation = slab.tangential_stiffness / slab.normal_stiffness, slab.relaxation_time
        cap, growth = slab.cap * springs / corner, slab.cap_growth
    else:
        ratio, cap = chosen.tangential_ratio, np.full(springs.size, math.inf)
        growth = 0.0
        relaxation = relaxation_time(chosen.damping_ratio, mesh.mass, 2.0 * corner)
    radius = lead = 0.0
    if case.rolls:  # the dashpots of the points resist slow rolling, too, but hardly a fast one
        radius, lead = rolling_of(case, mesh)
        relaxation = min(relaxation, POINT_SHARE * lead)
        lead -= relaxation
    base = camber.size
    places = container.elements.nodes[container.nodes[:base], 0]
    stiffness = np.concatenate(
        [springs[:base] * edge_factors(case, container.support, places), springs[base:]]
    )
    return Contact(
        normal_stiffness=stiffness,
        tangential_stiffness=ratio * stiffness,
        cap=cap,
        cap_growth=np.full(springs.size, growth),
        relaxation_time=np.full(springs.size, relaxation),
        mu_static=np.full(springs.size, chosen.mu_static),
        mu_kinetic=np.full(springs.size, chosen.mu_kinetic),
        weakening=np.full(springs.size, chosen.weakening_m),
        stribeck_velocity=chosen.stribeck_velocity_m_s,
        camber=np.concatenate([camber, np.zeros(springs.size - camber.size)]),
        friction=FRICTION_LAWS[chosen.friction],
        regularisation_velocity=chosen.regularisation_velocity_m_s,
        force_scale=mesh.mass * case.gravity_m_s2,
        resolution=1e-15 * (mesh.width + mesh.height),
        rolling_time=lead,
        rolling_radius=radius,
        rolling_reach=0.5 * case.effective_width * mesh.width,
    )


def _body(case: Case, container: Container, contact: Contact, stance: Stance) -> Body:
    """One body, as it is stepped."""
    elements, mesh = container.elements, container.mesh
    gravity, downhill = case.gravity_toward_floor, case.gravity_downhill
    nodes, monitors = container.nodes, container.monitors
    damping = bounce_of(case, container, contact).material_damping
    placed = base_points(case, mesh, elements.nodes[nodes], container.support.index.size)
    links = slice(len(nodes) - len(case.links), None)
    if case.links and case.solver.model != "full":  # it has points wherever they are asked for
        placed[links] = places_of_links(case)
    line = lines_at(case, _at_rest(case, container, placed, stance)[links], mesh.width)
    if case.solver.model == "full":
        body = FullBody(elements, nodes, monitors, gravity=gravity, downhill=downhill, damping=damping)
        return _linked(body, line)
    shapes = container.basis.shapes[:, nodes]
    shapes[:, links] = shapes_at(places_of_links(case), elements.nodes, container.basis.shapes)
    penetration = mesh.mass * gravity / float(contact.normal_stiffness.sum())
    floating = floating_body(
        case,
        container,
        placed=placed,
        shapes=shapes,
        watched=monitors,
        rest=mesh.centroid,
        damping=damping,
        tolerance=POINT_TOLERANCE * penetration,
    )
    return _linked(floating, line)


def _at_rest(case: Case, container: Container, placed: FloatArray, stance: Stance) -> FloatArray:
    """Contact points (n, 2) from which gaps are measured: those of the container upright at rest [m].

    Of one that starts tilted, those of the undeformed container on a hard floor.
    """
    if case.initial.rotation_rad != 0.0 or not case.links:
        return placed
    turn = rotation_matrix(stance.rotation)
    shape = placed - np.asarray(container.mesh.centroid)
    if case.solver.model != "rigid":
        own = (stance.with_points(len(placed)).force @ turn).ravel()
        response = container.response.displacement
        displacement = response[:, container.nodes]
        if case.solver.model == "reduced":
            places, nodes = places_of_links(case), container.elements.nodes
            displacement[:, -len(places) :] = shapes_at(places, nodes, response)
        shape = shape + np.tensordot(own, displacement, axes=1)
    return np.asarray(stance.centre) + shape @ turn.T


def _stance(case: Case, container: Container, contact: Contact, gravity: float) -> Stance:
    """Stance of the container at t = 0, with the floor at x = 0."""
    mesh, elements, initial = container.mesh, container.elements, case.initial
    downhill, mu = case.gravity_downhill, case.contact.mu_static
    base = container.support.index.size
    nodes = container.nodes[:base]
    placed = base_points(case, mesh, elements.nodes[nodes], base)
    point = placed - np.asarray(mesh.centroid)
    rigid = case.solver.model == "rigid"
    elastic = container.response.compliance[: 2 * base, : 2 * base]
    compliance = np.zeros((2 * base, 2 * base)) if rigid else elastic
    if initial.rotation_rad == 0.0:
        stance = standing(
            weight=mesh.mass * gravity,
            centroid=mesh.centroid,
            point=point,
            compliance=compliance,
            normal_stiffness=contact.normal_stiffness[:base],
            camber=contact.camber[:base],
            shear_ratio=min(max(downhill / gravity, -mu), mu),
        )
        if initial.angular_velocity_rad_s != 0.0:
            stance = stance.turning(initial.angular_velocity_rad_s, point)
    else:
        corner = -1 if initial.rotation_rad > 0.0 else 0
        stance = tilted(
            rotation=initial.rotation_rad,
            angular_velocity=initial.angular_velocity_rad_s,
            mass=mesh.mass,
            inertia=mesh.inertia,
            gravity=gravity,
            downhill=downhill,
            point=point,
            corner_x=float(placed[corner, 0]),
            compliance=compliance,
            normal_stiffness=contact.normal_stiffness[:base],
            camber=contact.camber[:base],
            mu_static=mu,
        )
    return stance.with_points(container.nodes.size).moving(initial.velocity_m_s)
