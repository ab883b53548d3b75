"""The columns of `history.csv`: name, unit, what they are measured against, and which runs have them.

SI units, named in the columns; x positive to the right, z up, rotation positive toward +x, forces on the container. Of
a loose stack the columns are those of the lowest box, the forces and energies those of all. The stepper fills the
columns that it has by these names (`contact.stepping.state.row_names`); the rest is added by `fem.run.recorder`.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from fem.case.tables.links import held_above

MODE = "mode"  #: the column of the word; all others are numbers
GROUND, FLOOR, BELOW, START = "ground", "floor", "what is below", "start of the run"


@dataclass(frozen=True)
class HistoryColumn:
    """A column of a history; braces in its name stand for the number of a joint or a box."""

    name: str
    unit: str = ""
    against: str = ""  #: what a place or a motion is relative to, and since when a sum runs


@dataclass(frozen=True)
class ColumnGroup:
    """Columns that a run has together, once for each number."""

    numbers: Callable[[Any], Sequence[int]]  #: of a case, whose tables may be read in part
    columns: tuple[HistoryColumn, ...]

    def names(self, numbers: Iterable[int]) -> tuple[str, ...]:
        """The names of its columns for these numbers."""
        return tuple(column.name.format(number) for number in numbers for column in self.columns)


ALWAYS = ColumnGroup(
    lambda case: (0,),
    (
        HistoryColumn("time_s", "s", START),
        HistoryColumn("base_displacement_m", "m", GROUND),
        HistoryColumn("base_velocity_m_s", "m/s", GROUND),
        HistoryColumn("base_acceleration_m_s2", "m/s2", GROUND),
        HistoryColumn("rotation_rad", "rad", GROUND),
        HistoryColumn("angular_velocity_rad_s", "rad/s", GROUND),
        HistoryColumn("slip_m", "m", FLOOR),
        HistoryColumn("uplift_m", "m", FLOOR),
        HistoryColumn("centre_x_m", "m", FLOOR),
        HistoryColumn("centre_z_m", "m", FLOOR),
        HistoryColumn("normal_force_N", "N"),
        HistoryColumn("shear_force_N", "N"),
        HistoryColumn("kinetic_J", "J", GROUND),
        HistoryColumn("strain_J", "J"),
        HistoryColumn("potential_J", "J", GROUND),
        HistoryColumn("imbalance_J", "J", START),
        HistoryColumn(MODE),
        HistoryColumn("base_work_J", "J", START),  # of the floor on the container
        HistoryColumn("friction_J", "J", START),  # dissipated, as the following
        HistoryColumn("contact_damping_J", "J", START),
        HistoryColumn("material_damping_J", "J", START),
    ),
)
#: a floor that crushes: the work of that
CRUSHING = ColumnGroup(lambda case: range(case.floor.is_slab), (HistoryColumn("crushing_J", "J", START),))
#: a restitution that was asked for: what the impacts lost by it, < 0 where they return energy
IMPACTS = ColumnGroup(lambda case: range(case.states_restitution), (HistoryColumn("impact_J", "J", START),))

#: a floor that moves up and down, or normal to a slope; positive upward
VERTICAL = ColumnGroup(
    lambda case: range(case.has_normal),
    (
        HistoryColumn("base_vertical_displacement_m", "m", GROUND),
        HistoryColumn("base_vertical_velocity_m_s", "m/s", GROUND),
        HistoryColumn("base_vertical_acceleration_m_s2", "m/s2", GROUND),
    ),
)
#: the joints between the boxes of a bolted stack, from the floor up, from 1 (`fem.model.joints`)
JOINTS = ColumnGroup(
    # of bolted boxes whose joint forces follow from their motion
    lambda case: range(1, 1 if case.container.is_loose or held_above(case) else case.container.boxes),
    (
        HistoryColumn("joint_{}_normal_N", "N"),
        HistoryColumn("joint_{}_shear_N", "N"),
        HistoryColumn("joint_{}_moment_Nm", "Nm"),
    ),
)
#: the further boxes of a loose stack, from the floor up, from 2
BOXES = ColumnGroup(
    lambda case: range(2, case.container.boxes + 1 if case.container.is_loose else 2),
    (
        HistoryColumn("box_{}_rotation_rad", "rad", GROUND),
        HistoryColumn("box_{}_slip_m", "m", BELOW),
        HistoryColumn("box_{}_opening_m", "m", BELOW),
        HistoryColumn("box_{}_x_m", "m", FLOOR),
        HistoryColumn("box_{}_z_m", "m", FLOOR),
    ),
)
#: stops and ties, in the order of the case, from 1: the force along their line, on the container
STOPS = ColumnGroup(lambda case: range(1, 1 + len(case.stop)), (HistoryColumn("stop_{}_force_N", "N"),))
TIES = ColumnGroup(lambda case: range(1, 1 + len(case.tie)), (HistoryColumn("tie_{}_force_N", "N"),))
#: neighbours, in the order of the case, from 1: their motion, and the force across the gap before them
NEIGHBOURS = ColumnGroup(
    lambda case: range(1, 1 + len(case.neighbour)),
    (
        HistoryColumn("neighbour_{}_rotation_rad", "rad", GROUND),
        HistoryColumn("neighbour_{}_slip_m", "m", FLOOR),
        HistoryColumn("neighbour_{}_uplift_m", "m", FLOOR),
        HistoryColumn("neighbour_{}_x_m", "m", FLOOR),
        HistoryColumn("neighbour_{}_z_m", "m", FLOOR),
        HistoryColumn("neighbour_{}_force_N", "N"),
    ),
)
#: a run that was compared with the rigid block (`fem.run.rigid_check`): nan where that is not followed
ANALYTIC = ColumnGroup(lambda case: (), (HistoryColumn("analytic_rotation_rad", "rad", GROUND),))
GROUPS = (ALWAYS, CRUSHING, IMPACTS, VERTICAL, JOINTS, BOXES, STOPS, TIES, NEIGHBOURS, ANALYTIC)


def history_columns(case: Any, joints: int | None = None) -> tuple[str, ...]:
    """The columns of the history of a case, or of what could be read of it, in their order.

    `joints`: with forces; None: those between its boxes.
    """
    return tuple(
        name
        for group in GROUPS
        for name in group.names(
            range(1, joints + 1) if group is JOINTS and joints is not None else group.numbers(case)
        )
    )
