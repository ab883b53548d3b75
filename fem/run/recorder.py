"""The samples of a run: history rows, field frames; the largest stress, which is that of steps.

The stepper fills small arrays of samples. The recorder empties them between its calls and passes the rows on to files,
so that the memory of a run does not grow with its fields.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from contact.motion.kernel import floor_history, floor_motion
from contact.stepping.body import ROTATION, State
from contact.stepping.boxes import POINTS_OF_GAP
from contact.stepping.state import ROW_ROTATION, RunState, Samples, row_names
from fem.case.columns import BOXES, JOINTS, NEIGHBOURS, STOPS, TIES, VERTICAL, history_columns
from fem.case.tables.neighbours import places_of
from fem.model.joints import Joints, joints_of
from fem.model.model import Model
from fem.model.recovery import NodalFields, Recovery
from fem.results.fields import FrameFields
from fem.results.history import History, numbers_of
from fem.results.outcome import MODES
from fem.run.drawn_links import LinkCells
from fem.runtime.arrays import FloatArray

#: share of the largest strain energy from which the stress of a step is looked at
STRAINED = 0.1
#: decimals of times that people write [s]; relative error of multiplication
DECIMALS, ROUNDING = 12, 4.0 * float(np.finfo(float).eps)

#: the floor's motion along x
BASE = ("base_displacement_m", "base_velocity_m_s", "base_acceleration_m_s2")

HistorySink = Callable[[FloatArray, Sequence[str]], None]
FrameSink = Callable[[FrameFields], object]


class Recorder:
    """Takes the samples out of a run.

    Args:
        model: what is stepped.
        recovery: of its fields; None leaves fields and stresses out.
        history_sink: called with new rows, as a history has them, and their modes.
        frame_sink: called with every frame.
        joints: of its container, where they are built already.
    """

    def __init__(
        self,
        model: Model,
        recovery: Recovery | None = None,
        history_sink: HistorySink | None = None,
        frame_sink: FrameSink | None = None,
        joints: Joints | None = None,
    ) -> None:
        self._model, self._recovery, self._links = model, recovery, LinkCells(model)
        self._history_sink, self._frame_sink = history_sink, frame_sink
        self._rows: list[FloatArray] = []
        self._modes: list[str] = []
        self._area = model.contact_areas
        self._stress: float | None = None  #: of a full model over frames and most strained steps, if any [Pa]
        self._most_strain = 0.0  #: of its steps looked at [J]
        #: of the joints at the last sample (J, 8), see `fem.model.joints`; the next forces follow from its change
        self.joint_motion = np.zeros((0, 0))
        self._joint_forces = np.zeros((0, len(JOINTS.columns)))
        self.joints: Joints | None = None
        self.take_joints(joints or joints_of(model), model.run.old)

    def take_joints(self, joints: Joints | None, initial: State) -> None:
        """Follow the forces in these joints, from the initial state on."""
        self.joints = joints
        if joints is not None:
            time_scale = 1.0 / self._model.run.problem.control.frequency_parameter
            self._joint_forces = joints.initial_forces(initial, time_scale)
            rotation = initial.pose[ROTATION : ROTATION + 1]
            self.joint_motion = joints.motion(initial.position[None], initial.velocity[None], rotation)[0]
        self._numbers = numbers_of(history_columns(self._model.case, len(self._joint_forces)))

    def drain(self, run: RunState) -> None:
        """Empty the run's arrays of samples."""
        self._drain_history(run)
        clock, samples = run.clock[0], run.buffers.frames
        first, count = int(clock.frames_drained), int(clock.frames - clock.frames_drained)
        for k in range(count):
            time, here = (first + k) * samples.interval, slice(k, k + 1)
            self._write_frame(run, time, samples.position[here], samples.velocity[here], samples.force[k])
        clock.frames_drained = clock.frames
        if self._recovery is not None and self._recovery.full:
            # the stress at the most strained step of the slice, unless that is far below an earlier one
            energy, position = float(run.strained[0, 0, 0]), run.strained[0, 0, 1:]
            if energy >= STRAINED * self._most_strain:
                self._note_stress(self._recovery.frame(position, np.zeros_like(position)))
            self._most_strain = max(self._most_strain, energy)
            run.strained[0, 0, 0] = -1.0

    def history(self) -> History:
        """Everything sampled so far."""
        values = np.concatenate([np.zeros((0, len(self._numbers))), *self._rows])
        return History(numbers=self._numbers, samples=values, modes=tuple(self._modes))

    @property
    def largest_von_mises(self) -> float | None:
        """Largest von Mises stress over the most strained steps, of a full model also over its frames, if any [Pa]."""
        if self._recovery is None or self._recovery.full:
            return self._stress
        return self._recovery.largest_of_steps(self._model.run.strained)

    def memory(self) -> dict[str, FloatArray]:
        """State of the recorder on which the next samples depend, by name."""
        return {
            "largest_von_mises": np.array([] if self._stress is None else [self._stress]),
            "most_strain": np.array([self._most_strain]),
            "joint_motion": self.joint_motion,
            "joint_forces": self._joint_forces,
        }

    def recall(self, memory: Mapping[str, FloatArray]) -> None:
        """Restore the memory of an earlier recorder of the same run."""
        stress = memory["largest_von_mises"]
        self._stress = float(stress[0]) if stress.size else None
        self._most_strain = float(memory["most_strain"][0])
        self.joint_motion, self._joint_forces = memory["joint_motion"], memory["joint_forces"]

    def resume(self, history: History) -> None:
        """Begin with the samples of the run before it was interrupted."""
        self._rows, self._modes = [history.samples], list(history.modes)

    def change_frame(self, velocity: tuple[float, float]) -> None:
        """From now on the coordinates of the run are those in a frame with this velocity along x and upward [m/s]."""
        if self.joints is not None:
            self.joint_motion = self.joints.in_moving_frame(self.joint_motion, velocity)

    def _drain_history(self, run: RunState) -> None:
        clock, samples, case = run.clock[0], run.buffers.history, self._model.case
        first, count = int(clock.samples_drained), int(clock.samples - clock.samples_drained)
        if count == 0:
            return
        times: FloatArray = np.arange(first, first + count, dtype=np.float64) * samples.interval
        columns = dict(zip(row_names(case.bodies), samples.columns[:count].T, strict=True))
        columns |= self._columns_of_row(columns, samples.force[:count])
        columns["time_s"] = as_written(times)
        columns |= zip(BASE, floor_history(run.problem.motion, times), strict=True)
        columns |= zip(VERTICAL.names((0,)), floor_history(run.problem.vertical, times), strict=True)
        joints = JOINTS.names(range(1, len(self._joint_forces) + 1))
        columns |= zip(joints, self._forces_in_joints(samples, first, count).T, strict=True)
        if case.links:
            links = (*STOPS.names(STOPS.numbers(case)), *TIES.names(TIES.numbers(case)))
            columns |= zip(links, samples.force[:count, -len(links) :, 1].T, strict=True)
        rows = np.column_stack([columns[name] for name in self._numbers])
        rows += 0.0  # no minus zero
        modes = [MODES[mode] for mode in samples.mode[:count].tolist()]
        self._rows.append(rows)
        self._modes += modes
        if self._history_sink is not None:
            self._history_sink(rows, modes)
        clock.samples_drained = clock.samples

    def _columns_of_row(self, columns: Mapping[str, FloatArray], force: FloatArray) -> dict[str, FloatArray]:
        """The columns of neighbours, of which the stepper has those of further boxes in frames of their own."""
        row, case = self._model.container.row, self._model.case
        x = places_of(case, [neighbour.mesh.width for neighbour in row]).x if row else ()
        found: dict[str, FloatArray] = {}
        for number in NEIGHBOURS.numbers(case):
            begin = 2 * len(x) + POINTS_OF_GAP * (number - 1)
            values = [columns[name] for name in BOXES.names((number + 1,))]
            values[3] = values[3] + x[number]
            side = force[:, begin : begin + POINTS_OF_GAP, 1].sum(axis=1)
            found |= zip(NEIGHBOURS.names((number,)), [*values, side], strict=True)
        return found

    def _forces_in_joints(self, samples: Samples, first: int, count: int) -> FloatArray:
        """Of new samples (count, 3 J): means since the sample before; the first of a run has its own acceleration."""
        if self.joints is None:
            return np.zeros((count, 0))
        rotation = samples.columns[:count, ROW_ROTATION]
        motion = self.joints.motion(samples.position[:count], samples.velocity[:count], rotation)
        forces = self.joints.forces(np.concatenate([self.joint_motion[None], motion]), samples.interval)
        if first == 0:
            forces[0] = self._joint_forces
        self.joint_motion = motion[-1]
        return forces.reshape(count, -1)

    def _note_stress(self, frame: NodalFields) -> None:
        """Note the largest stress of a frame of a full model."""
        if frame.von_mises is not None and self._recovery is not None and self._recovery.full:
            self._stress = max(self._stress or 0.0, self._recovery.largest_in(frame.von_mises))

    def finish(self, run: RunState) -> None:
        """Write a frame of the last instant, where the run ends between two."""
        clock, samples, old = run.clock[0], run.buffers.frames, run.old
        if clock.time > (int(clock.frames) - 1) * samples.interval * (1.0 + ROUNDING):
            kept = min(samples.position.shape[1], 1)  # 0: there are no frames
            self._write_frame(
                run, float(clock.time), old.position[None][:kept], old.velocity[None][:kept], old.force
            )

    def _write_frame(
        self, run: RunState, time: float, position: FloatArray, velocity: FloatArray, force: FloatArray
    ) -> None:
        """Write a frame of coordinates and their rates (1, n_d), and contact forces (n, 2); of none without them."""
        if self._recovery is None or not position.size:
            return
        frame = self._recovery.frame(position[0], velocity[0])
        self._note_stress(frame)
        if self._frame_sink is None:
            return
        pressure, area = np.zeros(len(frame.displacement)), self._area
        pressure[self._model.container.nodes[: len(area)]] = force[: len(area), 1] / area
        fields = FrameFields(
            **vars(frame),
            time=float(as_written(np.array(time))),
            contact_pressure=pressure,
            floor_displacement=float(floor_motion(run.problem.motion, time)[0]),
            floor_lift=float(floor_motion(run.problem.vertical, time)[0]),
        )
        self._frame_sink(self._links.added_to(fields, run))


def as_written(times: FloatArray) -> FloatArray:
    """Instants of a grid as people write them: 0.15, although three times 0.05 is 0.15000000000000002.

    Only times within rounding of a short decimal are changed.
    """
    short = np.round(times, DECIMALS)
    return np.where(np.abs(short - times) <= ROUNDING * np.abs(times), short, times)
