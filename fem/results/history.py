"""The history of a run: one row a sample on an exact time grid, as a table in memory and as CSV.

SI units, named in the columns; x positive to the right, z up, rotation positive toward +x, forces on the container.
Numbers are written so that reading them gives the same bits (shortest exact decimal form).

A floor that crushes has one further column, the work of that since the start. A floor that moves up and down has three,
positive upward. A bolted stack has three for every joint
between its boxes (`fem.model.joints`), counted from the floor up. Of a loose stack the columns are those of the lowest
box, the forces and energies those of all; every further box has five of its own, counted from the floor up, from 2.
A run that was compared with the rigid block (`fem.assessment.rigid_check`) has the block's rotation as its last
column, nan where it is not followed. A kill during a write may leave the last line without its end.
"""

import contextlib
import hashlib
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np

from fem.results.files import write_atomically
from fem.runtime.arrays import FloatArray

#: Columns of `history.csv`, followed by those of `history_columns`; `mode` is a word, all others are numbers.
#: The last four are sums since the start: work of the floor on the container, and energy dissipated.
HISTORY_COLUMNS = (
    "time_s",
    "base_displacement_m",
    "base_velocity_m_s",
    "base_acceleration_m_s2",
    "rotation_rad",
    "angular_velocity_rad_s",
    "slip_m",
    "uplift_m",
    "centre_x_m",
    "centre_z_m",
    "normal_force_N",
    "shear_force_N",
    "kinetic_J",
    "strain_J",
    "potential_J",
    "imbalance_J",
    "mode",
    "base_work_J",
    "friction_J",
    "contact_damping_J",
    "material_damping_J",
)
MODE = HISTORY_COLUMNS.index("mode")  #: column of the word
NUMBERS = len(HISTORY_COLUMNS) - 1
#: Column of a floor that crushes.
CRUSHING_COLUMN = "crushing_J"
#: Columns of a floor that moves up and down.
VERTICAL_COLUMNS = (
    "base_vertical_displacement_m",
    "base_vertical_velocity_m_s",
    "base_vertical_acceleration_m_s2",
)
#: Columns of one joint.
JOINT_COLUMNS = ("joint_{}_normal_N", "joint_{}_shear_N", "joint_{}_moment_Nm")
#: Columns of a further box of a loose stack: slip and opening over the box below, mass centre relative to the floor.
BOX_COLUMNS = ("box_{}_rotation_rad", "box_{}_slip_m", "box_{}_opening_m", "box_{}_x_m", "box_{}_z_m")
#: Rotation of the analytic rigid block under the same floor motion.
ANALYTIC_COLUMN = "analytic_rotation_rad"


def history_columns(
    joints: int = 0,
    *,
    boxes: int = 1,
    crushing: bool = False,
    vertical: bool = False,
    analytic: bool = False,
) -> tuple[str, ...]:
    """Columns of a history.

    Args:
        joints: with forces, between bolted boxes.
        boxes: that move each for itself.
        crushing: the floor crushes.
        vertical: the floor moves up and down.
        analytic: compared with the rigid block.
    """
    of_joints = (name.format(joint) for joint in range(1, joints + 1) for name in JOINT_COLUMNS)
    of_boxes = (name.format(box) for box in range(2, boxes + 1) for name in BOX_COLUMNS)
    upward = VERTICAL_COLUMNS if vertical else ()
    crushed, block = (CRUSHING_COLUMN,) * crushing, (ANALYTIC_COLUMN,) * analytic
    return (*HISTORY_COLUMNS, *crushed, *upward, *of_joints, *of_boxes, *block)


@dataclass(frozen=True, kw_only=True, eq=False)
class History:
    """Samples of a run, in the order of `history_columns` without `mode`."""

    values: FloatArray  #: (n_samples, 20 (+ 1) (+ 3) + 3 joints + 5 (boxes - 1) (+ 1)), units as in the columns' names
    modes: tuple[str, ...]  #: state of motion at each sample, length n_samples
    vertical: bool = False  #: the floor moves up and down, and three columns say how
    boxes: int = 1  #: that move each for itself: of a loose stack
    crushing: bool = False  #: the floor crushes, and a column has its work

    @classmethod
    def empty(cls) -> Self:
        """No samples."""
        return cls(values=np.zeros((0, NUMBERS)), modes=())

    @property
    def joints(self) -> int:
        """Joints between boxes."""
        return _joints(self.values.shape[1] - NUMBERS, self.boxes, vertical=self.vertical)

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of the columns of numbers, in the order of `values`."""
        kinds = {"crushing": self.crushing, "vertical": self.vertical}
        columns = history_columns(self.joints, boxes=self.boxes, **kinds)
        columns += (ANALYTIC_COLUMN,) if self.values.shape[1] == len(columns) else ()
        return tuple(name for name in columns if name != "mode")

    def with_analytic(self, rotation: FloatArray) -> Self:
        """These samples with the rotation of the rigid block as last column, shape (n_samples,) [rad]."""
        return replace(self, values=np.column_stack([self.values, rotation]))

    def __len__(self) -> int:
        return len(self.modes)

    def __repr__(self) -> str:
        """One line, for a notebook."""
        return f"<history: {len(self)} samples of {', '.join(self.numbers)}>"

    def __getitem__(self, column: str) -> FloatArray:
        """A column of numbers by its name, shape (n_samples,); KeyError names the columns there are."""
        try:
            return self.values[:, self.numbers.index(column)]
        except ValueError:
            raise KeyError(f"no column {column!r}; known: {', '.join(self.numbers)}") from None


class HistoryWriter:
    """Appends samples to a history file; a context manager.

    The lines of one `append` are written at once. When the disk is full, those that were written are cut off again
    before the error is raised.

    Args:
        path: the file; replaced unless `position` is given.
        position: length of the file to resume from (`position` of its writer); what follows is cut off.
        joints, boxes, crushing, vertical: of the history, for the header.

    Raises:
        ValueError: a position beyond the end of the file.
        OSError: the file cannot be made or written.
    """

    def __init__(
        self,
        path: Path,
        *,
        position: int | None = None,
        joints: int = 0,
        boxes: int = 1,
        crushing: bool = False,
        vertical: bool = False,
    ) -> None:
        self.path = path
        self._digest = hashlib.sha256()
        if position is None:
            columns = history_columns(joints, boxes=boxes, crushing=crushing, vertical=vertical)
            header = ",".join(columns) + "\n"
            write_atomically(path, header)
            position = len(header)
        if not path.is_file() or path.stat().st_size < position:
            raise ValueError(f"{path}: the history ends before byte {position}, where the run is to resume")
        self._file = open(path, "r+b", buffering=0)  # noqa: SIM115
        self._position = position
        self._file.truncate(position)
        while self._file.tell() < position:
            self._digest.update(self._file.read(min(position - self._file.tell(), 1 << 20)))

    @property
    def position(self) -> int:
        """Bytes of the whole lines written so far, for a checkpoint."""
        return self._position

    @property
    def digest(self) -> str:
        """SHA-256 of these bytes."""
        return self._digest.hexdigest()

    def sync(self) -> None:
        """Bring the file to the disk."""
        os.fsync(self._file.fileno())

    def append(self, rows: FloatArray, modes: Sequence[str]) -> None:
        """Write samples: rows of numbers, in the columns of the header without `mode`, and their modes, length n."""
        for row, mode in zip(rows.tolist(), modes, strict=True):
            words = [repr(number) for number in row]
            self._write(",".join([*words[:MODE], mode, *words[MODE:]]) + "\n")

    def close(self) -> None:
        """Close the file; closing twice does no harm."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _write(self, text: str) -> None:
        data = text.encode()
        try:
            done = 0
            while done < len(data):
                done += self._file.write(data[done:])
        except OSError as error:
            with contextlib.suppress(OSError):  # the first error is the one to report
                os.ftruncate(self._file.fileno(), self._position)
                self._file.seek(self._position)
            raise OSError(error.errno, error.strerror, str(self.path)) from None
        self._position += len(data)
        self._digest.update(data)


def read_history(path: Path) -> History:
    """Read a history file, also of a running or killed run: a last line without its end is left out.

    Raises:
        ValueError: other columns than `history_columns`, or a line that does not hold them (named).
        OSError: the file cannot be read.
    """
    lines = _whole_lines(path)
    columns = tuple(lines[0].split(",")) if lines else ()
    crushing, vertical = CRUSHING_COLUMN in columns, VERTICAL_COLUMNS[0] in columns
    boxes = 1 + sum(name.startswith("box_") for name in columns) // len(BOX_COLUMNS)
    joints = _joints(len(columns) - len(HISTORY_COLUMNS), boxes, vertical=vertical)
    analytic = columns[-1:] == (ANALYTIC_COLUMN,)
    if columns != history_columns(
        joints, boxes=boxes, crushing=crushing, vertical=vertical, analytic=analytic
    ):
        raise ValueError(f"{path}: not a history; its first line must be {','.join(HISTORY_COLUMNS)} ..")
    numbers = len(columns) - 1
    values, modes = np.empty((len(lines) - 1, numbers)), []
    for number, line in enumerate(lines[1:]):
        fields = line.split(",")
        mode = "".join(fields[MODE : MODE + 1])
        try:
            values[number] = [float(field) for field in fields[:MODE] + fields[MODE + 1 :]]
        except ValueError:
            raise ValueError(f"{path}, line {number + 2}: {numbers} numbers and a mode are needed") from None
        modes.append(mode)
    return History(values=values, modes=tuple(modes), vertical=vertical, boxes=boxes, crushing=crushing)


def add_analytic_rotation(path: Path, rotation: FloatArray) -> None:
    """Add the rigid block's rotation to a finished history, as its last column.

    Args:
        path: the file; a column of that name is replaced.
        rotation: at each sample, shape (n_samples,) [rad]; nan where the block is not followed.

    Raises:
        ValueError: not as many rotations as samples.
        OSError: the file cannot be read or written.
    """
    header, *rows = _whole_lines(path)
    if len(rows) != len(rotation):
        raise ValueError(f"{path}: {len(rotation)} rotations for {len(rows)} samples")
    if header.endswith("," + ANALYTIC_COLUMN):
        header, *rows = (line.rpartition(",")[0] for line in (header, *rows))
    lines = [f"{header},{ANALYTIC_COLUMN}"]
    lines += [f"{row},{value!r}" for row, value in zip(rows, rotation.tolist(), strict=True)]
    write_atomically(path, "\n".join(lines) + "\n")


def _joints(further: int, boxes: int, *, vertical: bool) -> int:
    """Joints of so many columns behind those of every history; two columns more or fewer are no joint."""
    return (further - len(BOX_COLUMNS) * (boxes - 1)) // len(JOINT_COLUMNS) - vertical


def _whole_lines(path: Path) -> list[str]:
    text = path.read_text(encoding="utf-8")
    return text[: text.rfind("\n") + 1].splitlines()
