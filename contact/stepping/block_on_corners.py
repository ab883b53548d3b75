"""The stepping of a body on two corners: that of all bodies, compiled for two points.

A `BlockOnCorners` is stepped on arrays of constant shape, which are kept in registers. State, scratch and attempted
step are copied to such arrays, the run is advanced, and what others read is copied back. A run for its outcome is
advanced once or some hundred times, in thousands of steps.
"""

from contact.arrays import FloatArray
from contact.interface.workspace import Workspace
from contact.jit import inlined
from contact.local_arrays import local_counts, local_row, local_rows, part_row, part_rows
from contact.stepping.body import State, implements
from contact.stepping.integrator import FAILED, advance, advance_kernel
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import BlockOnCorners, BodyOnCorners, LocalBlock, ModalBody
from contact.stepping.state import RunState

NUMBERS = 50  #: of its state
inlined(advance)


# In kernels these are made by value: the compiler sees their arrays.
class LocalState(State):
    """A state in registers."""


class LocalWorkspace(Workspace):
    """A workspace in registers."""


class LocalRun(RunState):
    """A run whose states and workspace are in registers."""


def advance_on(body: ModalBody | LooseStack, run: RunState, until: float) -> int:
    """`integrator.advance`, compiled for the class of the body."""
    return advance(body, run, until)


@implements(advance_on, ModalBody, LooseStack, inline=True)
def advance_in_memory(body: ModalBody | LooseStack, run: RunState, until: float) -> int:
    """.. on the arrays of the run."""
    return int(advance_kernel(body, run, until))


@inlined
def has_two_points(state: State) -> bool:
    """Whether a state is of two points."""
    if state.stick.size != 2 or state.crushed.size != 2:
        return False
    if state.point.shape[0] != 2 or state.force.shape[0] != 2 or state.descent.shape[0] != 2:
        return False
    if state.drift.shape[0] != 2 or state.drift.shape[1] != 2:
        return False
    return bool(state.point.shape[1] == 2 and state.force.shape[1] == 2 and state.descent.shape[1] == 2)


@implements(advance_on, BodyOnCorners)
def advance_on_corners(body: BodyOnCorners, run: RunState, until: float) -> int:
    """.. of two points: from each comparison with a constant the compiler infers a size, and unrolls loops."""
    work = run.work
    if body.point.shape[0] != 2 or run.control.base_points != 2 or run.joints.shape[0] != 1:
        return FAILED
    if body.moved.shape[1] != 4 or body.across.shape[1] != 4:
        return FAILED
    if body.elastic_compliance.shape[1] != 4 or body.elastic_compliance.shape[2] != 4:
        return FAILED
    if work.point.shape[0] != 2 or work.slope.shape[0] != 2:
        return FAILED
    if work.force.shape[0] != 2 or work.force.shape[1] != 2:
        return FAILED
    if not has_two_points(run.old) or not has_two_points(run.new):
        return FAILED
    return advance(body, run, until)


@inlined
def state_of(numbers: FloatArray, whole: State) -> LocalState:
    """The state whose numbers these are, in the order of `make_state`; `whole` has its monitored points."""
    return LocalState(
        part_row(numbers, 0, 3),
        part_row(numbers, 3, 3),
        part_row(numbers, 6, 3),
        part_row(numbers, 9, 3),
        part_row(numbers, 12, 3),
        part_row(numbers, 15, 3),
        part_row(numbers, 18, 3),
        part_rows(numbers, 21, 2, 2),
        part_rows(numbers, 25, 2, 2),
        part_rows(numbers, 29, 2, 2),
        part_rows(numbers, 33, 2, 2),
        part_row(numbers, 37, 2),
        part_row(numbers, 39, 2),
        part_row(numbers, 41, 6),
        part_row(numbers, 47, 3),
        whole.boxes,
        whole.corner,
        whole.monitor,
        numbers,
    )


@inlined
def copy_row(target: FloatArray, source: FloatArray, size: int) -> None:
    """Copy the first numbers of a row."""
    for i in range(size):
        target[i] = source[i]


@inlined
def copy_pair(target: FloatArray, source: FloatArray, columns: int) -> None:
    """Copy two rows."""
    for i in range(2):
        for k in range(columns):
            target[i, k] = source[i, k]


@implements(advance_on, BlockOnCorners)
def advance_in_registers(body: BlockOnCorners, run: RunState, until: float) -> int:
    """.. on arrays of constant shape; the work of the last attempt is copied back as far as its residual needs."""
    if body.stiffness.size != 0 or body.point.shape[0] != 2 or run.control.base_points != 2:
        return FAILED
    if run.joints.shape[0] != 1 or run.old.numbers.size != NUMBERS or run.new.numbers.size != NUMBERS:
        return FAILED
    before, after, point, nothing = local_row(50), local_row(50), local_rows(2, 2), local_row(0)
    floor, lift, ledger = local_rows(2, 3), local_rows(2, 3), local_row(6)
    work = LocalWorkspace(
        local_rows(2, 2),
        local_rows(2, 2),
        local_rows(4, 4),
        local_rows(2, 2),
        local_rows(2, 2),
        local_rows(2, 2),
        local_rows(2, 2),
        local_rows(2, 3),
        local_rows(4, 4),
        local_row(4),
        local_row(4),
        local_rows(2, 2),
        local_row(2),
        local_counts(2),
        local_counts(2),
        local_counts(4),
        local_rows(2, 3),
        local_row(1),
        local_counts(1),
        local_rows(2, 2),
        local_counts(2),
    )
    block = LocalBlock(
        body.mass,
        body.inertia,
        body.gravity,
        body.downhill,
        point,
        body.shape,
        body.across,
        body.rest,
        body.monitor,
        body.monitor_shape,
        nothing,
        nothing,
        body.tolerance,
        local_row(2),
        local_counts(1),
        local_rows(1, 3),
        body.elastic_compliance,
        local_rows(2, 2),
        body.moved,
        local_row(3),
    )
    own = LocalRun(
        run.scheme,
        run.contact,
        run.motion,
        run.vertical,
        run.breaks,
        run.control,
        state_of(before, run.old),
        state_of(after, run.new),
        work,
        floor,
        lift,
        local_row(2),
        local_row(6),
        ledger,
        run.clock,
        run.joints,
        run.track,
        run.contents,
        run.history,
        run.frames,
    )
    copy_pair(point, body.point, 2)
    copy_row(before, run.old.numbers, NUMBERS)
    copy_row(after, run.new.numbers, NUMBERS)
    copy_pair(floor, run.floor, 3)
    copy_pair(lift, run.lift, 3)
    copy_row(ledger, run.ledger, 6)
    status = advance(block, own, until)
    copy_row(run.old.numbers, before, NUMBERS)
    copy_row(run.new.numbers, after, NUMBERS)
    copy_pair(run.floor, floor, 3)
    copy_pair(run.lift, lift, 3)
    copy_row(run.ledger, ledger, 6)
    copy_pair(run.work.law, work.law, 2)
    copy_pair(run.work.force, work.force, 2)
    return status
