"""The stepping of a body on two corners: that of all bodies, compiled for two points.

A `BlockOnCorners` is stepped on arrays of constant shape, which are kept in registers. State, scratch and attempted
step are copied to such arrays, the run is advanced, and what others read is copied back. A run for its outcome is
advanced once or some hundred times, in thousands of steps.
"""

from contact.arrays import FloatArray
from contact.interface.workspace import Workspace
from contact.jit import inlined
from contact.layout import exchanging, parts_of, room_of
from contact.local_arrays import local_counts, local_row, local_rows
from contact.stepping.body import State, implements
from contact.stepping.integrator import FAILED, advance, advance_kernel
from contact.stepping.ledger import ROWS as LEDGER_ROWS
from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import BlockOnCorners, LocalBlock, ModalBody
from contact.stepping.state import AttemptedStep, RunState

#: sizes in its layouts: coordinates, points, boxes of a loose stack
SIZES = {"d": 3, "n": 2, "2n": 4, "N": 0, "4N": 0}
NUMBERS, _ = room_of(State, **SIZES)
NUMBERS_OF_WORK, COUNTS_OF_WORK = room_of(Workspace, **SIZES)
inlined(advance)


# In kernels these are made by value: the compiler sees their arrays.
class LocalState(State):
    """A state in registers."""


class LocalWorkspace(Workspace):
    """A workspace in registers."""


class LocalAttempt(AttemptedStep):
    """An attempted step in registers."""


class LocalRun(RunState):
    """A run whose states and workspace are in registers."""


FloatingBody = ModalBody | LooseStack | LinkedBody  #: what this module and those above it step
local_state = parts_of(LocalState, State, **SIZES)
local_work = parts_of(LocalWorkspace, Workspace, **SIZES)
local_run = exchanging(LocalRun, "attempt", "old", "work", "floor", "lift", "ledger")
local_block = exchanging(
    LocalBlock, "point", "stiffness", "damping", "cached_step", "recent", "inverse", "arm", "free_change"
)


def advance_on(body: FloatingBody, run: RunState, until: float) -> int:
    """`integrator.advance`, compiled for the class of the body."""
    return advance(body, run, until)


@implements(advance_on, LooseStack, LinkedBody, inline=True)
def advance_in_memory(body: FloatingBody, run: RunState, until: float) -> int:
    """`advance` on the arrays of the run."""
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


@inlined
def stands_on_corners(body: ModalBody, run: RunState) -> bool:
    """Whether a body has two points: from each comparison with a constant the compiler infers a size."""
    work = run.work
    if body.point.shape[0] != 2 or run.problem.control.base_points != 2 or run.joints.shape[0] != 1:
        return False
    if run.links.shape[0] != 0:
        return False
    if body.moved.shape[1] != 4 or body.across.shape[1] != 4:
        return False
    if body.elastic_compliance.shape[1] != 4 or body.elastic_compliance.shape[2] != 4:
        return False
    if work.point.shape[0] != 2 or work.slope.shape[0] != 2:
        return False
    if work.force.shape[0] != 2 or work.force.shape[1] != 2:
        return False
    return has_two_points(run.old) and has_two_points(run.attempt.new)


@implements(advance_on, ModalBody)
def advance_on_points(body: ModalBody, run: RunState, until: float) -> int:
    """`advance`, twice in the machine code: where sizes are known, loops are unrolled. numba translates it once."""
    if stands_on_corners(body, run):
        return advance(body, run, until)
    return int(advance_kernel(body, run, until))


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
    """`advance` on arrays of constant shape; of the last attempt what the residual needs is copied back."""
    if body.stiffness.size != 0 or body.point.shape[0] != 2 or run.problem.control.base_points != 2:
        return FAILED
    if run.links.shape[0] != 0:
        return FAILED
    if run.joints.shape[0] != 1 or run.old.numbers.size != NUMBERS or run.attempt.new.numbers.size != NUMBERS:
        return FAILED
    before, after, point, nothing = local_row(NUMBERS), local_row(NUMBERS), local_rows(2, 2), local_row(0)
    floor, lift, ledger, none = local_rows(2, 3), local_rows(2, 3), local_row(LEDGER_ROWS), local_counts(0)
    work = local_work(run.work, local_row(NUMBERS_OF_WORK), local_counts(COUNTS_OF_WORK))
    block = local_block(
        body,
        point=point,
        stiffness=nothing,
        damping=nothing,
        cached_step=local_row(2),
        recent=local_counts(1),
        inverse=local_rows(1, 3),
        arm=local_rows(2, 2),
        free_change=local_row(3),
    )
    attempt = LocalAttempt(
        local_state(run.attempt.new, after, none), slip=local_row(2), change=local_row(LEDGER_ROWS)
    )
    own = local_run(
        run,
        attempt=attempt,
        old=local_state(run.old, before, none),
        work=work,
        floor=floor,
        lift=lift,
        ledger=ledger,
    )
    copy_pair(point, body.point, 2)
    copy_row(before, run.old.numbers, NUMBERS)
    copy_row(after, run.attempt.new.numbers, NUMBERS)
    copy_pair(floor, run.floor, 3)
    copy_pair(lift, run.lift, 3)
    copy_row(ledger, run.ledger, LEDGER_ROWS)
    status = advance(block, own, until)
    copy_row(run.old.numbers, before, NUMBERS)
    copy_row(run.attempt.new.numbers, after, NUMBERS)
    copy_pair(run.floor, floor, 3)
    copy_pair(run.lift, lift, 3)
    copy_row(run.ledger, ledger, LEDGER_ROWS)
    copy_pair(run.work.law, work.law, 2)
    copy_pair(run.work.force, work.force, 2)
    return status
