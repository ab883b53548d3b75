"""Data of a run besides its body, apart by how long they live; compiled code and Python use the same tuples.

`RunState` has four kinds of parts. The `problem` does not change. The progress - the old state, sums, records - changes
in place, and is all that a checkpoint holds. The `attempt` is scratch of one step. The `buffers` hold samples until the
caller takes them.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

from contact.arrays import FloatArray, IntArray
from contact.interface.laws import FRICTION_LAWS
from contact.interface.workspace import Contact, Workspace, make_workspace
from contact.motion.kernel import UNIFORM, FloorMotion, as_floor_motion, floor_motion
from contact.stepping.body import CENTRE_X, CENTRE_Z, ROTATION, State, make_state
from contact.stepping.ledger import ROWS as LEDGER_ROWS
from contact.stepping.ledger import spring_energy
from contact.stepping.observables import NEVER, bearing_place, make_observables
from contact.stepping.scheme import Scheme
from contact.structs import struct

UNLIMITED = 2**62
AT_REST = as_floor_motion(UNIFORM, (0.0, 0.0, 0.0))  #: a floor that does not move
STRAIN_WINDOW = 0.05  #: of each of which the most strained step is kept [s]

#: columns of `Samples.columns`, as a history names them
ROWS = (
    *("rotation_rad", "angular_velocity_rad_s", "slip_m", "uplift_m", "centre_x_m", "centre_z_m"),
    *("normal_force_N", "shear_force_N", "kinetic_J", "strain_J", "potential_J"),
    # this and the following in the order of the ledger
    *("base_work_J", "friction_J", "contact_damping_J", "material_damping_J", "crushing_J", "impact_J"),
    "imbalance_J",
)
ROW_ROTATION, ROW_ANGULAR_VELOCITY, ROW_SLIP, ROW_UPLIFT, ROW_CENTRE_X, ROW_CENTRE_Z = range(6)
ROW_NORMAL, ROW_SHEAR, ROW_KINETIC, ROW_STRAIN, ROW_POTENTIAL, ROW_BASE_WORK = range(6, 12)
ROW_COLUMNS = len(ROWS)


@struct
class Control(NamedTuple):
    """Constants of the step control and the container."""

    largest_step: float  #: [s]
    smallest_step: float  #: [s]
    event_step: float  #: largest step in which the support may start to slide [s]
    closing_step: float  #: largest step from the first touch of a point on [s]
    closing_speed: float  #: slower closings are left to the energy balance [m/s]
    reference_energy: float  #: energy to overturn the container, or the body of a row that takes least [J]
    energy_rate: float  #: imbalance allowed per second, over the reference energy [1/s]
    energy_floor: float  #: imbalance allowed in any step, over the reference energy [-]
    energy_share: float  #: imbalance allowed over the dissipation of the step but for crushing [-]
    recent_share: float  #: imbalance allowed over the recent dissipation [-]
    recent_time: float  #: decay time of the recent dissipation [s]
    closing_share: float  #: imbalance allowed as a gap closes, over the kinetic energy against the floor [-]
    mass: float  #: [kg]
    inertia: float  #: about the mass centre [kg m2]
    gravity: float  #: toward the floor [m/s2]
    downhill: float  #: along a floor that falls toward +x [m/s2]
    frequency_parameter: float  #: of rocking [1/s]
    #: averaging time of corner forces [s]: dashpots of a numerical penalty make the instantaneous force meaningless
    force_window: float
    resting_energy: float  #: gravity potential of the container at rest where it was placed [J]
    slowest_rocking: float  #: frequency parameter, of a row the least of all [1/s]
    slenderness_angle: float  #: [rad]
    width: float  #: [m]
    near: float  #: base points nearer than this close together [m]
    stop_when_overturned: bool
    contents_cutoff: float  #: of the filter of the acceleration of the contents [rad/s]
    top_monitors: int  #: number of monitored points at the top; they come first
    base_points: int  #: number of contact points of the base; they come first
    rolls: bool  #: the base is cambered from edge to edge: it has no impacts
    eager: bool  #: steps grow as soon and as far as their imbalance allows: of a rigid container, for maps


#: and behind them for each further box of a loose stack
BOX_ROWS = ("box_{}_rotation_rad", "box_{}_slip_m", "box_{}_opening_m", "box_{}_x_m", "box_{}_z_m")
BOX_ROTATION, BOX_SLIP, BOX_OPENING, BOX_CENTRE_X, BOX_CENTRE_Z = range(len(BOX_ROWS))
BOX_COLUMNS = len(BOX_ROWS)


def row_names(boxes: int) -> tuple[str, ...]:
    """The columns of the samples of a stack of loose boxes, or of one body."""
    return (*ROWS, *(name.format(box) for box in range(2, boxes + 1) for name in BOX_ROWS))


#: what changes from step to step besides the state; `RunState.clock` is one of these
STEP_RECORD = np.dtype(
    [
        ("time", "f8"),
        # step control
        ("level", "i8"),  # of the step size, see `contact.stepping.control`
        ("allowance_used", "f8"),  # recent imbalance over the allowed one
        ("recent_dissipation", "f8"),  # fading sum, without crushing [J]
        ("growth_hold", "i8"),  # accepted steps until the step may grow freely again
        ("lag_step", "f8"),  # step that the lag of the old acceleration belongs to
        ("unprepared_step", "f8"),  # step that the body was not prepared for
        ("rolling", "f8"),  # resistance of a base that rolls, see `step.rolling_share`: of the attempted step
        ("rolling_before", "f8"),  # .. and of the one before
        ("next_break", "i8"),
        ("attempt_limit", "i8"),  # of steps, accepted and rejected, at which `advance` returns
        # counts
        ("steps", "i8"),
        ("rejected", "i8"),
        ("failed", "i8"),  # of these: iterations that did not converge
        ("iterations", "i8"),
        ("contact_iterations", "i8"),
        ("smallest_step", "f8"),
        # free motion after a pulse or a record, see `outcome.is_over`
        ("rest_since", "f8"),  # at every look since then the container was at rest
        ("next_look", "f8"),
        # samples
        ("unobserved", "f8"),  # time since the contents were observed last
        ("samples", "i8"),  # of the history, so far
        ("samples_drained", "i8"),  # of these no longer in the arrays
        ("frames", "i8"),
        ("frames_drained", "i8"),
        # ledger, up to overturning
        ("least_imbalance", "f8"),
        ("most_imbalance", "f8"),
        ("dissipated", "f8"),  # when these were taken
        ("spring_energy", "f8"),  # of the contacts of a loose stack, with the stiffness of the last step
    ],
    align=True,
)


#: a joint is where a box stands on what is below it: joint 0 is the floor under the lowest box, joint j carries box j;
#: of bodies in a row each stands on the floor; a body that moves as one has joint 0 alone. `RunState.joints` has one of
#: these for each
JOINT_RECORD = np.dtype(
    [
        # constants
        ("mass", "f8"),  # of the box on the joint
        ("inertia", "f8"),  # .. about its mass centre
        ("width", "f8"),  # .. of its base
        ("begin", "i8"),  # first contact point of the joint, unless it is the only one
        ("end", "i8"),  # .. and the one behind its last
        ("below", "i8"),  # box on which the box stands; -1: the floor
        ("angle", "f8"),  # rotation beyond which the box does not come back by itself
        ("impact_share", "f8"),  # of the angular momentum that an exchange of the pivot leaves, see `impact`
        # friction
        ("sliding", "i8"),  # 1 while every loaded point slides: kinetic friction
        ("slip_since_break", "f8"),  # path since the joint broke loose
        ("slip", "f8"),  # of the base over what is below since the start, signed, see `bearing_place`
        ("stood_at", "f8"),  # `bearing_place` at the start
        ("slip_in_air", "f8"),  # the part of `slip` that was moved without a contact force
        ("slip_velocity", "f8"),  # force-weighted
        ("slip_acceleration", "f8"),
        ("utilisation", "f8"),  # tangential force over mu_s times the normal force
        ("utilisation_rate", "f8"),
        # observables
        ("max_slip", "f8"),
        ("slip_travel", "f8"),
        ("max_slip_velocity", "f8"),  # while every loaded point slides
        # .. of a loose stack only
        ("opening", "f8"),  # largest gap between the box and what is below it
        ("max_opening", "f8"),
        ("max_rotation", "f8"),  # of the box
        ("fell_at", "f8"),  # when the box fell
        # impacts, see `contact.stepping.observables.lands` and `contact.stepping.impact`
        ("left_gap", "f8"),  # largest gap of this side since it opened with the other as pivot
        ("right_gap", "f8"),
        ("landed", "i8"),  # side of an impact that may exchange the pivot: -1 left, 1 right, 0 none
        ("landing_rate", "f8"),  # angular velocity with which it landed, > 0 onto this side
        # the attempted step
        ("mu", "f8"),  # coefficient of friction at no velocity
        ("motion", "i8"),  # sliding of the loaded points, see `contact.stepping.joints`
        ("slip_step", "f8"),  # force-weighted sliding of the points in the step, as friction takes it
        ("shift", "f8"),  # change of `slip` in the step
        ("velocity", "f8"),  # slip velocity at its end
        ("slides", "i8"),  # `sliding` after it
        ("opens", "f8"),  # `opening` after it
    ],
    align=True,
)


#: the gap between two bodies in a row, a stop or a tie, see `contact.stepping.boxes` and `contact.stepping.links`;
#: `RunState.links` has one of these for each, in this order
LINK_RECORD = np.dtype(
    [
        ("max_force", "f8"),  # along its line
        ("hits", "i8"),
        ("largest_closing_velocity", "f8"),
        ("broken_at", "f8"),
        ("least_gap", "f8"),  # that was left while it was whole
        ("away", "f8"),  # largest gap since the last touch
    ],
    align=True,
)


def make_joints(
    mass: npt.ArrayLike,
    inertia: npt.ArrayLike,
    width: npt.ArrayLike,
    angle: npt.ArrayLike,
    *,
    impact_share: npt.ArrayLike = 1.0,
    in_a_row: bool = False,
) -> Any:
    """A record array (N,) of JOINT_RECORD at the start: boxes from the floor up, or `in_a_row`, each on two points."""
    boxes = np.atleast_1d(mass)
    number = np.arange(boxes.size)
    joints = np.zeros(boxes.size, JOINT_RECORD)
    joints["mass"], joints["inertia"], joints["width"], joints["angle"] = boxes, inertia, width, angle
    joints["impact_share"] = impact_share
    joints["begin"] = 2 * number if in_a_row else np.maximum(4 * number - 2, 0)
    joints["end"] = 2 * number + 2 if in_a_row else 4 * number + 2
    joints["below"] = -1 if in_a_row else number - 1
    joints["fell_at"] = NEVER
    return joints.view(np.recarray)


@struct
class Samples(NamedTuple):
    """Samples on an exact grid of times, at most as many as the arrays hold: n_s."""

    interval: float  #: [s]
    columns: FloatArray  #: (n_s, n_r or 0) of a history, see `row_names`
    mode: npt.NDArray[np.int64]  #: (n_s,)
    position: FloatArray  #: (n_s, n_d or 0) coordinates of the body
    velocity: FloatArray  #: (n_s, n_d or 0)
    force: FloatArray  #: (n_s, n, 2) contact forces [N]


def make_samples(
    interval: float,
    count: int,
    points: int,
    *,
    columns: bool = False,
    boxes: int = 1,
    position: int = 0,
    velocity: int = 0,
) -> Samples:
    """Allocate `count` samples; `position` and `velocity`: number of coordinates to keep; `boxes` of a loose stack."""
    return Samples(
        interval=float(interval),
        columns=np.zeros((count, ROW_COLUMNS + BOX_COLUMNS * (boxes - 1) if columns else 0)),
        mode=np.zeros(count, dtype=np.int64),
        position=np.zeros((count, position)),
        velocity=np.zeros((count, velocity)),
        force=np.zeros((count, points, 2)),
    )


@struct
class Stresses(NamedTuple):
    """The stress of some points of b elastic bodies, where it may be largest, from their modal amplitudes.

    The largest is followed for each of g groups of bodies: of a row one for each body. A body with fewer points than k
    has points without stress behind them.
    """

    first: IntArray  #: (b,) of the coordinates, the first amplitude of each body
    of_modes: FloatArray  #: (b, m, 3 k) xx, zz, xz of each point for amplitudes of 1 [Pa]
    group: IntArray  #: (g + 1,) first body of each group, and the one behind the last
    bound: FloatArray  #: (g,) largest square of the von Mises stress in each, over the strain energy [Pa2/J]
    sums: FloatArray  #: (3 k,) scratch of the stepping: the stress of a body


NO_STRESSES = Stresses(
    first=np.zeros(0, dtype=np.int64),
    of_modes=np.zeros((0, 0, 0)),
    group=np.zeros(1, dtype=np.int64),
    bound=np.zeros(0),
    sums=np.zeros(0),
)


@struct
class RunProblem(NamedTuple):
    """What does not change in a run, but for the stiffness in the `contact` of a loose stack."""

    scheme: Scheme
    contact: Contact
    motion: FloorMotion  #: of the floor along x
    vertical: FloorMotion  #: of the floor upward; of the kind UNIFORM the floor stays at its height
    breaks: FloatArray  #: instants at which a step must end [s], sorted, the last one infinite
    control: Control
    stress: Stresses
    along: FloatArray  #: (n,) where a point is along the undeformed base, see `observables.bearing_place` [m]


@struct
class AttemptedStep(NamedTuple):
    """What an attempted step writes anew, whatever it finds here: the next step does not need it."""

    new: State  #: at the end of the step
    slip: FloatArray  #: (n,) sliding of the points in the step [m]
    change: FloatArray  #: (7,) contribution of the step to the ledger [J]


@struct
class Buffers(NamedTuple):
    """Samples since the caller drained them last."""

    history: Samples
    frames: Samples


@struct
class RunState(NamedTuple):
    """All data of a run besides its body.

    `problem` stays as it is, `attempt` is scratch, `buffers` are emptied by the caller. All else is the progress of the
    run, from which it goes on to the same bits: a checkpoint holds every array of it.
    """

    problem: RunProblem
    attempt: AttemptedStep
    buffers: Buffers
    old: State  #: at the end of the last accepted step
    work: Workspace  #: the contact of the last attempted step: the next one begins with its factors
    floor: FloatArray  #: (2, 3) displacement, velocity, acceleration of the floor before and after the step, along x
    lift: FloatArray  #: the same upward
    ledger: FloatArray  #: (7,) [J]
    clock: Any  #: (1,) of STEP_RECORD
    joints: Any  #: (N,) of JOINT_RECORD
    links: Any  #: (k,) of LINK_RECORD; their points are the last ones
    track: Any  #: (1,) of `observables.OBSERVABLES`
    contents: FloatArray  #: (8, 2 n_m) filter of the contents, see `contact.stepping.contents`
    #: (1 + g, n_w, 1 + n_d) the most strained step of each `STRAIN_WINDOW` (of the last one in all time from there on)
    #: by strain energy [J], and by the square of the von Mises stress at the points of each group of `problem.stress`
    #: [Pa2]: that, -1 for none, and its coordinates
    strained: FloatArray

    def with_problem(self, **parts: Any) -> "RunState":
        """The same run with other parts of its problem."""
        return self._replace(problem=self.problem._replace(**parts))

    def progress(self) -> dict[str, NDArray[Any]]:
        """Every array of the progress, by name; the arrays themselves, not copies."""
        arrays: dict[str, NDArray[Any]] = {}
        for name, part in self._asdict().items():
            if isinstance(part, State | Workspace):
                arrays |= {f"{name}.{field}": array for field, array in part._asdict().items()}
            elif not isinstance(part, RunProblem | AttemptedStep | Buffers):
                arrays[name] = part
        return arrays


def make_run(
    *,
    scheme: Scheme,
    contact: Contact,
    motion: FloorMotion,
    vertical: FloorMotion = AT_REST,
    breaks: FloatArray,
    control: Control,
    old: State,
    history: Samples,
    frames: Samples,
    joints: Any = None,
    links: int = 0,
    strained: int = 0,
    stress: Stresses = NO_STRESSES,
) -> RunState:
    """Assemble a run at t = 0.

    Args:
        old: the initial state, completed.
        joints: of a loose stack or a row, see `make_joints`; links: how many of the last points are those of links.
        strained: windows of which the most strained steps are kept, by the stress at the points of `stress`, too.

    Raises:
        ValueError: an unknown law of friction; an array of the contact without one entry for each point.
    """
    if contact.friction not in FRICTION_LAWS.values():
        known = ", ".join(f"{value} ({name})" for name, value in FRICTION_LAWS.items())
        raise ValueError(f"there is no friction law of code {contact.friction}; known: {known}")
    n, monitors = old.point.shape[0], old.monitor.shape[0]
    for name, part in contact._asdict().items():
        if isinstance(part, np.ndarray) and part.shape != (n,):  # the kernels do not look
            raise ValueError(
                f"contact: {name} must have one entry for each of the {n} points, got the shape {part.shape}"
            )
    clock = np.zeros(1, STEP_RECORD)
    clock["smallest_step"] = NEVER
    clock["attempt_limit"] = UNLIMITED
    clock["rest_since"] = NEVER
    clock["spring_energy"] = spring_energy(contact, old.point, old.stick)
    if joints is None:
        joints = make_joints(control.mass, control.inertia, control.width, control.slenderness_angle)
    records = np.zeros(links, LINK_RECORD)
    records["broken_at"] = records["away"] = records["least_gap"] = NEVER
    floor, lift = floor_motion(motion, 0.0), floor_motion(vertical, 0.0)
    along = np.zeros(n)
    for j, joint in enumerate(joints):
        points = slice(joint.begin, joint.end) if len(joints) > 1 else slice(0, n - links)
        pose = old.boxes[j] if len(old.boxes) else old.pose
        along[points] = old.point[points, 0]  # on another box; on the floor from below its mass centre
        if joint.below < 0:
            x, z = (old.point[points] + (floor[0], lift[0]) - pose[[CENTRE_X, CENTRE_Z]]).T
            along[points] = x * math.cos(pose[ROTATION]) - z * math.sin(pose[ROTATION])
        along[points] -= old.stick[points]  # a base that is wound up at rest has not slipped
        joint.stood_at = bearing_place(contact, along, old, points.start, points.stop, 0.0)
    return RunState(
        problem=RunProblem(
            scheme=scheme,
            contact=contact,
            motion=motion,
            vertical=vertical,
            breaks=np.append(np.asarray(breaks, dtype=float), NEVER),
            control=control,
            stress=stress,
            along=along,
        ),
        attempt=AttemptedStep(
            new=make_state(old.position.size, n, monitors, len(old.boxes)),
            slip=np.zeros(n),
            change=np.zeros(LEDGER_ROWS),
        ),
        buffers=Buffers(history=history, frames=frames),
        old=old,
        work=make_workspace(n),
        floor=np.tile(floor, (2, 1)),
        lift=np.tile(lift, (2, 1)),
        ledger=np.zeros(LEDGER_ROWS),
        clock=clock.view(np.recarray),
        joints=joints,
        links=records.view(np.recarray),
        track=make_observables(),
        contents=np.zeros((8, 2 * (monitors - control.top_monitors))),
        strained=np.full((stress.group.size, strained, 1 + old.position.size), -1.0),
    )
