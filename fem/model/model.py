"""From a case to the model that is stepped: container, equilibrium on the floor, base motion, limits, initial state.

The models `full`, `reduced` and `rigid` differ in the body alone.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.motion.base_motion import BaseMotion
from contact.motion.kernel import floor_motion
from contact.stepping import modal_body
from contact.stepping.body import State, make_state
from contact.stepping.control import step_level
from contact.stepping.ledger import spring_energy
from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import ModalBody
from contact.stepping.observables import record_start
from contact.stepping.state import (
    NO_STRESSES,
    STRAIN_WINDOW,
    RunState,
    Stresses,
    make_joints,
    make_run,
    make_samples,
)
from fem.case.case import Case
from fem.case.tables.duration import ends_at_rest
from fem.model.bodies import begin_row, make_stack_state, own_stiffness, settle
from fem.model.container import Container, discretise, modes_of_a_body
from fem.model.equilibrium import Equilibrium, find_equilibrium
from fem.model.floor import slab_of
from fem.model.frames import frame_interval
from fem.model.links import begin_links
from fem.model.motion import build_motions, longest_run, motions_end, peaks_in_run
from fem.model.peaks import watched_stress
from fem.model.resting import still_from
from fem.model.restitution import require_loss
from fem.model.static_checks import StaticChecks, static_checks_of
from fem.model.step_size import control_of, largest_step_of, scheme_of
from fem.model.validity import require_stiff_corner
from fem.runtime.arrays import FloatArray
from fem.solid.nodal_body import Body, FullBody, FullStack

HISTORY_CHUNK, FRAME_CHUNK = 1024, 64
#: the same of the full model, whose coordinates are many
FULL_HISTORY_CHUNK, FULL_FRAME_CHUNK = 16, 4
MOST_STRAINED = 8192  #: steps kept of a reduced run, each the most strained one of a window of time


@dataclass(frozen=True, kw_only=True, eq=False)
class Model:
    """One case, ready to be stepped."""

    case: Case
    container: Container
    equilibrium: Equilibrium
    motion: BaseMotion  #: of the floor along x
    vertical: BaseMotion  #: of the floor upward
    static: StaticChecks
    run: RunState
    duration: float  #: simulated time, at most [s]
    #: from here on the run ends when the container is at rest or has fallen [s]; or infinite
    rest_from: float

    @property
    def penalty(self) -> float:
        """Normal stiffness of the base over width times depth [Pa/m]."""
        return self.equilibrium.penalty

    @property
    def damping_ratio(self) -> float:
        """Of the contact: c/(2 sqrt(k m)), the whole mass on the spring of one corner."""
        return self.equilibrium.damping_ratio

    @property
    def body(self) -> Body:
        """What is stepped."""
        return self.equilibrium.body

    @property
    def base_stiffness(self) -> float:
        """Of all base points together [N/m]."""
        return float(self.run.problem.contact.normal_stiffness[: self.container.support.index.size].sum())

    @property
    def contact_areas(self) -> FloatArray:
        """What contact points bear on, shape (n_c,) [m2]: on a slab shares of a patch, else of the face."""
        if self.equilibrium.row:  # the sides carry forces, but no pressure that is shown
            row = zip(self.case.row, self.container.row, self.equilibrium.row, strict=True)
            return np.concatenate([_areas(*alone) for alone in row])
        return _areas(self.case, self.container, self.equilibrium)

    @property
    def spectra(self) -> list[FloatArray]:
        """Elastic frequencies of each body, rising [Hz]: all of `reduced`, the first of `full`, none of `rigid`."""
        container = self.container
        if self.case.solver.model == "full":
            return [np.array([container.first]) / (2.0 * np.pi)]
        return [body.basis.angular_frequencies / (2.0 * np.pi) for body in container.bodies]

    @property
    def elastic_modes(self) -> int:
        """Modes of each free body of a reduced model, before its attachment modes."""
        return modes_of_a_body(self.case)


def build_model(
    case: Case,
    container: Container | None = None,
    equilibrium: Equilibrium | None = None,
    motions: tuple[BaseMotion, BaseMotion] | None = None,
) -> Model:
    """Discretise a case, settle it on its floor and write its initial state.

    Args:
        container, motions: of the case, where they are built already.
        equilibrium: of that container, where `same_equilibrium` allows its reuse; computed again where the
            vertical motion begins otherwise.

    Raises:
        CaseError, MeshError: bad input, no equilibrium at the start.
    """
    motion, vertical = motions or build_motions(case)
    compiled_motion, compiled_vertical = motion.compiled(), vertical.compiled()
    z, velocity_z, acceleration_z = floor_motion(compiled_vertical, 0.0)
    container, gravity = container or discretise(case), case.gravity_toward_floor + acceleration_z
    known = equilibrium if equilibrium and equilibrium.gravity == gravity else None
    equilibrium = known or find_equilibrium(case, container, gravity)
    mesh, nodes = container.mesh, container.nodes
    contact, body = equilibrium.contact, equilibrium.body
    own = body.body if isinstance(body, LinkedBody) else body
    duration = longest_run(case, motion, vertical)
    static = static_checks_of(case, mesh, *peaks_in_run(case, motion, vertical, duration))
    meshes = [alone.mesh for alone in container.row]
    row = [static_checks_of(alone, own, 0.0) for alone, own in zip(case.row, meshes, strict=True)]
    if known is None:  # else the same impacts
        for case_alone, checks in zip(case.row or [case], row or [static], strict=True):
            require_loss(case_alone, checks)
    fastest = max(checks.frequency_parameter for checks in (static, *row))
    largest, breaks = largest_step_of(case, fastest, duration, motion, vertical)
    control = control_of(case, container, static, largest, contact, row)
    scheme = scheme_of(case, container, equilibrium.penalty, control, contact)
    full = case.solver.model == "full"
    x, velocity_x, _ = floor_motion(compiled_motion, 0.0)
    velocity = (velocity_x, velocity_z) if case.starts_moving else (0.0, 0.0)
    tilted = None
    if container.row:
        assert isinstance(own, LooseStack)
        contact = own_stiffness(contact)
        alone = [
            _begun(*standing, (x, z, velocity_z), velocity)
            for standing in zip(case.row, container.row, equilibrium.row, strict=True)
        ]
        tilted = equilibrium.row[0].contact, alone[0]
        old = begin_row(case, own, contact, alone, place=(x, z), lift_velocity=velocity_z)
    elif isinstance(own, LooseStack | FullStack):
        contact = own_stiffness(contact)
        old = make_stack_state(own)
        velocity = velocity[0] + case.initial.velocity_m_s, velocity[1]
        settle(own, contact, old, gravity=gravity, place=(x, z), velocity=velocity, lift_velocity=velocity_z)
    else:
        old = _begun(case, container, equilibrium, (x, z, velocity_z), velocity)
        old.point[:, 1] += contact.camber
    begin_links(case, body, old)
    coordinates = old.position.size
    stiffness, first = tilted or (contact, old)
    require_stiff_corner(
        case,
        width=mesh.width,
        depth=float(-first.point[:, 1].min()),
        stored=float(spring_energy(stiffness, first.point, first.stick)) / static.overturning_energy,
    )
    rest_from = motions_end(motion, vertical) if ends_at_rest(case) else math.inf
    if case.output.stop_when_still and rest_from < math.inf:
        rest_from = min(rest_from, still_from(case, mesh, static, motion, vertical))
    interval = case.output.history_s
    fields = frame_interval(case, len(container.elements.nodes), duration)
    stacked = case.container.bolted_joints > 0  # the forces in its joints follow from the motion
    # of a full model one, of which the stress is looked at soon
    windows = min(math.ceil(duration / STRAIN_WINDOW) + 1, MOST_STRAINED)
    strained = {"full": 1, "reduced": windows, "rigid": 0}[case.solver.model]
    run = make_run(
        scheme=scheme,
        contact=contact,
        motion=compiled_motion,
        vertical=compiled_vertical,
        breaks=breaks,
        control=control,
        old=old,
        history=make_samples(
            interval,
            _chunk(FULL_HISTORY_CHUNK if full else HISTORY_CHUNK, control.largest_step, interval),
            nodes.size,
            columns=True,
            boxes=case.bodies,
            position=coordinates if stacked else 0,
            velocity=coordinates if stacked else 0,
        ),
        frames=make_samples(
            fields if fields > 0.0 else math.inf,
            _chunk(FULL_FRAME_CHUNK if full else FRAME_CHUNK, control.largest_step, fields or math.inf),
            nodes.size,
            position=coordinates if fields > 0.0 else 0,
            velocity=coordinates if fields > 0.0 else 0,
        ),
        joints=make_joints(
            [body.mesh.mass for body in container.bodies],
            [body.mesh.inertia for body in container.bodies],
            [body.mesh.width for body in container.bodies] if container.boxes else static.width,
            [checks.slenderness_angle for checks in row or [static]],
            impact_share=[each.contact.restitution_over_housner or 1.0 for each in case.row or [case]],
            in_a_row=bool(container.row),
        ),
        links=len(case.links) + len(case.neighbour),
        strained=strained,
        stress=_watched_stresses(case, container),
    )
    if full:  # its first steps settle vibrations of the mesh, which a large step would turn into a jump off the floor
        run.clock.level = step_level(control.largest_step, control.event_step)
    record_start(run.track[0], control, contact.camber, old)
    return Model(
        case=case,
        container=container,
        equilibrium=equilibrium,
        motion=motion,
        vertical=vertical,
        static=static,
        run=run,
        duration=duration,
        rest_from=rest_from,
    )


def _areas(case: Case, container: Container, equilibrium: Equilibrium) -> FloatArray:
    """`Model.contact_areas` of one container; links have none."""
    contact, base = equilibrium.contact, container.support.index.size
    points = contact.cap.size - len(case.links)
    if not case.floor.is_slab:
        return contact.normal_stiffness[:points] / equilibrium.penalty
    slab = slab_of(case, container.mesh.mass)
    areas = np.full(points, slab.area)  # of loose boxes on one another as on the floor
    areas[:base] *= contact.cap[:base] / slab.cap
    return areas


def _watched_stresses(case: Case, container: Container) -> Stresses:
    """The stress of a reduced model beside its contacts: impacts strain it there, where the energy shows it least."""
    if case.solver.model != "reduced":
        return NO_STRESSES
    watched = [watched_stress(case, body.elements, body.basis, body.nodes) for body in container.bodies]
    modes, points = (max(stress.shape[axis] for stress, _ in watched) for axis in range(2))
    of_modes = np.zeros((len(watched), modes, points, 3))
    for own, (stress, _) in zip(of_modes, watched, strict=True):
        own[: len(stress), : stress.shape[1]] = stress
    return Stresses(
        first=3 + (3 + modes) * np.arange(len(watched)),
        of_modes=of_modes.reshape(len(watched), modes, 3 * points),
        group=np.array([0, len(watched)]),
        bound=np.array([max(bound for _, bound in watched)]),
        sums=np.zeros(3 * points),
    )


def _chunk(wanted: int, largest_step: float, interval: float) -> int:
    """Samples to keep at a time: never fewer than two largest steps make."""
    return max(wanted, 2 * math.ceil(largest_step / interval) + 4)


def _begun(
    case: Case,
    container: Container,
    equilibrium: Equilibrium,
    floor: tuple[float, float, float],
    velocity: tuple[float, float],
) -> State:
    """The initial state of one body at its stance, on a floor of these places and upward velocity [m], [m/s]."""
    assert equilibrium.stance is not None
    body: Any = equilibrium.body
    own = body.body if isinstance(body, LinkedBody) else body
    coordinates = 3 + own.stiffness.size if isinstance(own, ModalBody) else own.coordinates
    state = make_state(coordinates, container.nodes.size, container.monitors.size)
    stance = equilibrium.stance.moved(floor[0], floor[1])
    if case.starts_moving:
        stance = stance.moving(*velocity)
    state.force[:] = stance.force
    if case.contact.sticks:  # friction regularised in velocity has no springs
        state.stick[:] = -stance.force[:, 0] / equilibrium.contact.tangential_stiffness
    if isinstance(own, FullBody):
        own.place(state, stance, container.response)
        own.start(state, *floor)
    else:
        modal_body.place(own, state, stance)
        modal_body.start(own, state, *floor)
    return state
