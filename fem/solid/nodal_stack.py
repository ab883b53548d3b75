"""The full model of a loose stack: the nodes of every box free to move, boxes touching at their corners.

Each box is a `FullBody` of its own, with its own turned frame. Boxes that are equal share the factors of their
matrices. Coordinates are the positions of the nodes, box by box from the floor up.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse.linalg

from contact.interface.contact_points import SidePoint, make_faces
from contact.interface.faces import CORNERS
from contact.interface.workspace import Contact, make_workspace
from contact.jit import compiled
from contact.stepping import body as interface
from contact.stepping import stack_body
from contact.stepping.body import State, implements
from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack
from contact.stepping.scheme import Scheme
from contact.stepping.stack_body import complete_compiled, stand, state_of
from contact.stepping.state import RunState
from contact.structs import struct
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid import nodal_kernels
from fem.solid.nodal_body import FullBody, rotation_matrix
from fem.solid.nodal_kernels import SOURCES, NodalBody, advance_nodal, enter_floor_frame_nodal
from fem.solid.reduction import StaticResponse

#: factors of a box, the same for equal boxes
FACTORS = ("cached_step", "order", "pattern", "lower", "inverse_pivot", "to_base", "base_compliance")


@struct
class NodalStack(NamedTuple):
    """The nodes of N boxes."""

    boxes: tuple[NodalBody, ...]
    starts: IntArray  #: (N + 1,) first coordinate of a box
    monitors: IntArray  #: (N, 2) first monitored point of a box, and the one behind its last
    energy: FloatArray  #: (N, 3) scratch


@implements(stack_body.box_of, NodalStack, inline=True)
def box_of(stack: NodalStack, b: int) -> NodalBody:
    """One of the boxes."""
    return stack.boxes[b]


for operation in ("predict", "release", "respond", "complete", "observe", "shift_velocity"):
    implements(getattr(interface, operation), NodalStack)(getattr(stack_body, operation))


@compiled(sources=SOURCES)
@implements(interface.prepared, NodalStack)
def prepared(stack: NodalStack, step: float) -> bool:
    """The factors of this step size are at hand for all boxes."""
    ready = True
    for b in range(len(stack.boxes)):
        ready = ready and nodal_kernels.prepared(stack.boxes[b], step)
    return ready


complete_nodal_stack = compiled(complete_compiled.py_func, sources=SOURCES)


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

    def advance(self, run: RunState, until: float) -> int:
        return int(advance_nodal(self._linked, run, until))

    def leave_alone(self, run: RunState, floor_velocity: float, lift_velocity: float) -> None:
        enter_floor_frame_nodal(self._linked, run, floor_velocity, lift_velocity)

    @property
    def _linked(self) -> LooseStack | LinkedBody:
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
        """Write the initial state, as `contact.stepping.stack_body.settle_stack`."""
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
            own = state_of(self.stack.body, state, b)
            turn = rotation_matrix(float(rest.rotation[b]))
            elastic = np.tensordot((force[b] @ turn).ravel(), response.displacement, axes=1)
            arm = (box.elements.nodes - box.centroid + elastic) @ turn.T
            own.position[:] = (rest.centre[b] + place + arm).ravel()
            own.velocity.reshape(-1, 2)[:] = velocity
            box.evaluate(own)
        complete_nodal_stack(self.stack, state, place[0], place[1], lift_velocity)
        for b, box in enumerate(self.boxes):
            own = state_of(self.stack.body, state, b)
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
            box.recall(
                {
                    name.removeprefix(f"{b}."): array
                    for name, array in memory.items()
                    if name.startswith(f"{b}.")
                }
            )

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
