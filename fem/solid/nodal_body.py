"""The full model: every node free to move, total Lagrangian, without assembling a tangent.

The method: README.md of this folder. The contact is condensed to the base points and solved by the same compiled
functions as for the reduced container. Coordinates are the absolute positions of the nodes, x and z in turn.
`fem.solid.nodal_kernels` holds the compiled step.

Of a loose stack, whose boxes touch at their corners, each box is a `FullBody` of its own, with its own turned frame;
equal boxes share the factors of their matrices. Its coordinates are those of the boxes from the floor up.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import scipy.sparse.linalg
from scipy.sparse import csr_array

from contact.interface.equilibrium import Stance
from contact.interface.faces import CORNERS, SidePoint, make_faces
from contact.interface.workspace import Contact, make_workspace
from contact.stepping.body import State
from contact.stepping.integrator import UNPREPARED, enter_floor_frame_compiled
from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack, stand, state_of
from contact.stepping.modal_body import ModalBody
from contact.stepping.outcome import advance_compiled
from contact.stepping.scheme import Scheme
from contact.stepping.state import RunState
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid import nodal_kernels
from fem.solid.assembly import FiniteElements
from fem.solid.block_factor import block_pattern, factor_blocks
from fem.solid.elasticity import with_own_scratch
from fem.solid.nodal_kernels import (
    NodalBody,
    NodalStack,
    advance_nodal,
    complete_nodal_stack,
    enter_floor_frame_nodal,
)
from fem.solid.reduction import StaticResponse

#: residual of a step over the weight at which its iteration stops; one more iteration would about square it
RESIDUAL_TOLERANCE = 5e-6
UNIT_ROUNDOFF = 2.0**-53
FACTOR_MEMORY = 600_000_000  #: for factors of different step sizes [bytes]
FEWEST_FACTORS, MOST_FACTORS = 8, 128  #: a run with hard impacts takes 90 step sizes
BYTES_OF_A_NODE = 35e3  #: while the matrix is factored, measured on stacks of 2000 to 10,000 cells
#: arrays of the last residual, which `complete` uses
REMEMBERED = ("turn", "internal", "damping_force", "strain_energy")
#: factors of a box, the same for equal boxes
FACTORS = ("cached_step", "order", "pattern", "lower", "inverse_pivot", "to_base", "base_compliance")


def rotation_matrix(rotation: float) -> FloatArray:
    """R with x = R X for a rotation > 0 toward +x [rad]."""
    cosine, sine = math.cos(rotation), math.sin(rotation)
    return np.array([[cosine, sine], [-sine, cosine]])


class FullBody:
    """A finite-element container, stepped by `fem.solid.nodal_kernels`.

    Args:
        elements: the container, discretised.
        base: (n_c,) its supporting nodes, by rising x.
        monitor: (n_m,) nodes whose motion is observed.
        gravity: toward the floor; downhill: along a floor that falls toward +x [m/s2].
        damping: a of the stiffness-proportional damping C = a K in the turned frame [s].
        line: (k, 4) lines of the links at its last supporting nodes, see `contact.stepping.links`.
    """

    def __init__(
        self,
        elements: FiniteElements,
        base: IntArray,
        monitor: IntArray,
        *,
        gravity: float,
        downhill: float = 0.0,
        damping: float,
        line: FloatArray | None = None,
    ) -> None:
        self.elements = elements
        self.base = np.asarray(base)
        self.monitor = np.asarray(monitor)
        self.gravity, self.downhill = gravity, downhill
        self.damping = damping
        self.line = line
        stiffness, n = elements.stiffness.tobsr((2, 2)), len(elements.nodes)
        stiffness.sort_indices()
        links = csr_array(
            (np.ones(len(stiffness.indices)), stiffness.indices, stiffness.indptr), shape=(n, n)
        )
        pattern, mass = block_pattern(links), csr_array(elements.mass)
        self._block_mass = _on_blocks(elements.mass, links)
        nodal_mass = elements.nodal_mass
        self.mass = float(nodal_mass.sum())
        self.centroid = nodal_mass @ elements.nodes / self.mass
        self._arm = elements.nodes - self.centroid
        mass_arm = elements.mass @ self._arm
        self.inertia = float(np.sum(mass_arm * self._arm))
        # Of very thin walls the coordinates' rounding exceeds the tolerance: iterations would end only by chance.
        stiffest = float(abs(elements.stiffness).sum(axis=1).max())
        rounding = UNIT_ROUNDOFF * stiffest * float(np.abs(elements.nodes).max())
        self.nodal = NodalBody(
            mass=self.mass,
            inertia=self.inertia,
            gravity=float(gravity),
            downhill=float(downhill),
            damping=float(damping),
            tolerance=max(RESIDUAL_TOLERANCE * self.mass * float(gravity), rounding),
            first=elements.lame.first,
            shear=elements.lame.shear,
            node=np.ascontiguousarray(elements.nodes),
            nodal_mass=nodal_mass,
            mass_arm=np.ascontiguousarray(mass_arm),
            mass_starts=mass.indptr.astype(np.int32),
            mass_columns=mass.indices.astype(np.int32),
            mass_values=mass.data,
            stiffness_starts=stiffness.indptr.astype(np.int32),
            stiffness_columns=stiffness.indices.astype(np.int32),
            stiffness_values=stiffness.data.reshape(-1, 4),
            cells=with_own_scratch(elements.blocks),
            base=self.base.astype(np.int64),
            watched=self.monitor.astype(np.int64),
            source=np.zeros((n, 2)),
            cached_step=np.array([-1.0, 0.0]),
            order=np.add.outer(2 * pattern.place, np.arange(2)).ravel().astype(np.int32),
            pattern=pattern,
            lower=np.zeros((1, 0, 4)),
            inverse_pivot=np.zeros((1, 0, 4)),
            to_base=np.zeros((1, 0, 0)),
            base_compliance=np.zeros((1, 0, 0)),
            displacement=np.zeros((n, 2)),
            internal=np.zeros((n, 2)),
            turned=np.zeros(2 * n),
            damping_force=np.zeros((n, 2)),
            residual=np.zeros(2 * n),
            permuted=np.zeros(2 * n),
            free_change=np.zeros(2 * n),
            turn=np.array([1.0, 0.0]),
            strain_energy=np.zeros(1),
            known=np.zeros(2, dtype=np.int64),
        )

    @property
    def coordinates(self) -> int:
        """Number of coordinates."""
        return 2 * len(self.elements.nodes)

    def place(self, state: State, stance: Stance, response: StaticResponse) -> None:
        """Write the initial coordinates: the stance's rigid pose, strained by its contact forces."""
        turn = rotation_matrix(stance.rotation)
        elastic = np.tensordot((stance.force @ turn).ravel(), response.displacement, axes=1)
        arm = (self._arm + elastic) @ turn.T
        position = np.asarray(stance.centre) + arm
        speed = stance.angular_velocity * np.column_stack([arm[:, 1], -arm[:, 0]])
        velocity = np.asarray(stance.velocity) + speed
        state.position[:] = position.ravel()
        state.velocity[:] = velocity.ravel()
        self.evaluate(state)

    def evaluate(self, state: State) -> None:
        """Forces and energy at the coordinates in `state`, with the best-fit rotation for the frame."""
        self.nodal.turn[:] = nodal_kernels.fit(self.nodal, state.position)[2:]
        nodal_kernels.forces(self.nodal, state.position, state.velocity)

    def start(self, state: State, floor: float, lift: float = 0.0, lift_velocity: float = 0.0) -> None:
        """Complete a state with given coordinates and contact forces: forces, energies and acceleration."""
        nodal_kernels.complete(self.nodal, state, floor, lift, lift_velocity)
        force = (state.external - state.internal).reshape(-1, 2)
        factor = scipy.sparse.linalg.splu(self.elements.mass.tocsc())
        state.acceleration[:] = factor.solve(force).ravel()

    def prepare(self, scheme: Scheme, step: float) -> None:
        """Factor the Newmark matrix of this step size; it replaces the oldest one if memory is full."""
        nodal = self.nodal
        now = 1.0 - scheme.alpha_f
        inertial = (1.0 - scheme.alpha_m) / (scheme.newmark_beta * step * step)
        elastic = now * (1.0 + self.damping * scheme.newmark_gamma / (scheme.newmark_beta * step))
        if nodal.lower.shape[1] == 0:  # room for as many factors as `FACTOR_MEMORY` holds
            unknowns, forces, blocks = nodal.residual.size, 2 * nodal.base.size, nodal.pattern.rows.size
            size = 32 * blocks + 8 * (forces + 2) * unknowns
            slots = min(max(FEWEST_FACTORS, FACTOR_MEMORY // size), MOST_FACTORS)
            nodal = self.nodal = nodal._replace(
                cached_step=np.append(np.full(slots, -1.0), 0.0),
                lower=np.zeros((slots, blocks, 4)),
                inverse_pivot=np.zeros((slots, unknowns // 2, 4)),
                to_base=np.zeros((slots, forces, unknowns)),
                base_compliance=np.zeros((slots, forces, forces)),
            )
        slots = nodal.cached_step.size - 1
        slot = int(nodal.cached_step[slots])
        nodal.cached_step[slots] = (slot + 1) % slots
        matrix = elastic * nodal.stiffness_values
        matrix[:, 0] += inertial * self._block_mass
        matrix[:, 3] += inertial * self._block_mass
        factor_blocks(
            nodal.pattern, matrix[nodal.pattern.matrix_blocks], nodal.lower[slot], nodal.inverse_pivot[slot]
        )
        dofs = (2 * self.base[:, None] + np.arange(2)).ravel()
        answers = nodal.to_base[slot]
        for answer, dof in zip(answers, dofs, strict=True):
            nodal.permuted[:] = 0.0
            nodal.permuted[nodal.order[dof]] = 1.0
            nodal_kernels.substitute(nodal, slot)
            answer[:] = nodal.permuted[nodal.order]
        nodal.base_compliance[slot] = 0.5 * (answers[:, dofs] + answers[:, dofs].T)
        nodal.cached_step[slot] = step

    @property
    def stepped(self) -> NodalBody | LinkedBody:
        """What is stepped."""
        return self.nodal if self.line is None else LinkedBody(body=self.nodal, line=self.line)

    def memory(self) -> dict[str, FloatArray]:
        """Arrays of the last residual by name; everything else follows from the state."""
        return {name: getattr(self.nodal, name).copy() for name in REMEMBERED}

    def recall(self, memory: Mapping[str, FloatArray]) -> None:
        """Restore the arrays that `memory` gave for a body of the same container."""
        for name in REMEMBERED:
            getattr(self.nodal, name)[:] = memory[name]


def _on_blocks(mass: csr_array, links: csr_array) -> FloatArray:
    """Entries of the mass (n, n) at the blocks of the stiffness, which links the same nodes."""
    n = mass.shape[0]
    entries, row = mass.tocoo(), np.repeat(np.arange(n), np.diff(links.indptr))
    values, places = np.zeros(links.nnz), entries.row.astype(np.int64) * n + entries.col
    values[np.searchsorted(row * n + links.indices, places)] = entries.data
    return values


class FullStack:
    """A loose stack of boxes with all their nodes, from the floor up.

    Base points of a box are its corners, at full weight on the given springs [N/m]; the monitors are those of the
    uppermost box first. Boxes with the same response to forces at their corners are equal. `tolerance`: error of a
    contact point at which the iterations of a step stop [m]; `held`: points of sides, whose links are in `line`.
    """

    def __init__(
        self,
        boxes: Sequence[FullBody],
        responses: Sequence[StaticResponse],
        normal_stiffness: FloatArray,
        tangential_stiffness: FloatArray,
        tolerance: float,
        held: Sequence[SidePoint] = (),
    ) -> None:
        self.boxes, self._responses = tuple(boxes), tuple(responses)
        corner = np.concatenate([box.elements.nodes[box.base] for box in boxes])
        self._faces = make_faces(corner, normal_stiffness, tangential_stiffness, held)
        self.line: FloatArray | None = None  #: (k, 5), known once it stands
        self._corners = make_workspace(len(corner))
        self._tolerance = tolerance
        self._leader = [responses.index(response) for response in responses]
        self.stack = self._compose()

    @property
    def coordinates(self) -> int:
        """Number of coordinates."""
        return sum(box.coordinates for box in self.boxes)

    def prepare(self, scheme: Scheme, step: float) -> None:
        """Factor the Newmark matrices of this step size, once for equal boxes."""
        for number, box in enumerate(self.boxes):
            leader = self.boxes[self._leader[number]]
            if leader is box:
                box.prepare(scheme, step)
            else:
                shared = {name: getattr(leader.nodal, name) for name in FACTORS}
                box.nodal = box.nodal._replace(**shared)
        self.stack = self._compose()

    @property
    def stepped(self) -> LooseStack | LinkedBody:
        """What is stepped."""
        return self.stack if self.line is None else LinkedBody(body=self.stack, line=self.line)

    def settle(
        self,
        contact: Contact,
        state: State,
        *,
        gravity: float,
        place: tuple[float, float] = (0.0, 0.0),
        velocity: tuple[float, float] = (0.0, 0.0),
        lift_velocity: float = 0.0,
    ) -> None:
        """Write the initial state, as `contact.stepping.loose_stack.settle_stack`."""
        centre = np.array([box.centroid for box in self.boxes])
        point = np.array([box.elements.nodes[box.base] - box.centroid for box in self.boxes])
        downhill = self.boxes[0].downhill
        rest = stand(
            contact,
            state,
            faces=self._faces,
            centre=centre,
            point=point,
            compliance=np.array([response.compliance for response in self._responses]),
            load=np.array([[box.mass * downhill, -box.mass * gravity] for box in self.boxes]),
        )
        force = rest.corner_force.reshape(-1, CORNERS, 2)
        for b, (box, response) in enumerate(zip(self.boxes, self._responses, strict=True)):
            own = state_of(self.stack, state, b)
            turn = rotation_matrix(float(rest.rotation[b]))
            elastic = np.tensordot((force[b] @ turn).ravel(), response.displacement, axes=1)
            arm = (box.elements.nodes - box.centroid + elastic) @ turn.T
            own.position[:] = (rest.centre[b] + place + arm).ravel()
            own.velocity.reshape(-1, 2)[:] = velocity
            box.evaluate(own)
        complete_nodal_stack(self.stack, state, place[0], place[1], lift_velocity)
        for b, box in enumerate(self.boxes):
            own = state_of(self.stack, state, b)
            factor = scipy.sparse.linalg.splu(box.elements.mass.tocsc())
            own.acceleration[:] = factor.solve((own.external - own.internal).reshape(-1, 2)).ravel()

    def memory(self) -> dict[str, FloatArray]:
        """Arrays of the last residuals by name; everything else follows from the state."""
        return {
            f"{b}.{name}": array for b, box in enumerate(self.boxes) for name, array in box.memory().items()
        }

    def recall(self, memory: Mapping[str, FloatArray]) -> None:
        """Restore the arrays that `memory` gave for a stack of the same boxes."""
        for b, box in enumerate(self.boxes):
            box.recall({name: memory[f"{b}.{name}"] for name in REMEMBERED})

    def _compose(self) -> LooseStack:
        sizes = [box.coordinates for box in self.boxes]
        ends = np.cumsum([0, *(box.monitor.size for box in self.boxes[::-1])])
        body = NodalStack(
            boxes=tuple(box.nodal for box in self.boxes),
            starts=np.cumsum([0, *sizes]),
            monitors=np.column_stack([ends[:-1], ends[1:]])[::-1].copy(),
            energy=np.zeros((len(self.boxes), 3)),
        )
        return LooseStack(
            body=body,
            faces=self._faces,
            mass=np.array([box.mass for box in self.boxes]),
            tolerance=self._tolerance,
            in_a_row=False,
            corners=self._corners,
        )


def full_model_memory(nodes: int) -> float:
    """Memory of one run of the full model [bytes]."""
    return FACTOR_MEMORY + BYTES_OF_A_NODE * nodes


#: what is stepped: a container or a loose stack in floating frames, or with all their nodes
Body = ModalBody | LooseStack | LinkedBody | FullBody | FullStack


def advance_body(body: Body, run: RunState, until: float) -> int:
    """`contact.stepping.integrator.advance` for any body, compiled; missing factors of the full model are made."""
    if isinstance(body, ModalBody | LooseStack | LinkedBody):
        return advance_compiled(body, run, until)
    while True:
        code = int(advance_nodal(body.stepped, run, until))
        if code != UNPREPARED:
            return code
        body.prepare(run.problem.scheme, float(run.clock[0].unprepared_step))


def leave_body_alone(body: Body, run: RunState, floor_velocity: float, lift_velocity: float) -> None:
    """`contact.stepping.integrator.enter_floor_frame` for any body."""
    if isinstance(body, ModalBody | LooseStack | LinkedBody):
        enter_floor_frame_compiled(body, run, floor_velocity, lift_velocity)
    else:
        enter_floor_frame_nodal(body.stepped, run, floor_velocity, lift_velocity)
