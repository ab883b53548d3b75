"""What a case file holds: every table by its name, the keys before the first, and what follows from several of them."""

import math
from functools import cached_property
from typing import Annotated, Any

from pydantic import Field, Strict

from fem.case.tables import quantities as q
from fem.case.tables.boxes import Box, centroid_at, plan_share
from fem.case.tables.container_tables import ContactTable, ContainerTable, JointsTable, SupportTable
from fem.case.tables.floors import FloorTable
from fem.case.tables.links import StopTable, TieTable
from fem.case.tables.motion_tables import MotionTable, VerticalTable
from fem.case.tables.neighbours import NeighbourTable
from fem.case.tables.run_tables import (
    DocumentTable,
    InitialTable,
    OutputTable,
    RunLimitsTable,
    SolverTable,
    StaticTable,
    WindTable,
)
from fem.case.tables.table import CaseTable, OneLine, case_key
from fem.case.tables.unknown_inputs import UncertaintyTable

TABLES: dict[str, type[CaseTable]] = {
    "container": ContainerTable,
    "support": SupportTable,
    "contact": ContactTable,
    "floor": FloorTable,
    "joints": JointsTable,
    "motion": MotionTable,
    "vertical": VerticalTable,
    "initial": InitialTable,
    "static": StaticTable,
    "wind": WindTable,
    "limits": RunLimitsTable,
    "solver": SolverTable,
    "output": OutputTable,
    "uncertainty": UncertaintyTable,
    "document": DocumentTable,
}

#: tables that mean something by standing in a case file; the others have their defaults where they do not
OPTIONAL = frozenset({"static", "wind", "limits", "document"})


class CaseHeading(CaseTable):
    """The keys of a case file that stand before its first table."""

    schema_version: Annotated[int, Strict(), q.SCHEMA] = Field(
        default=1, alias="schema", description="of this file's keys"
    )
    title: Annotated[str, Field(max_length=500), OneLine] = case_key("for people", "")
    gravity_m_s2: Annotated[float, q.GRAVITY] = case_key(
        "g; the paper (Knoedel and Hrabowski) takes 10", 9.81
    )


class CaseContent(CaseHeading):
    """The tables of a case, and what follows from several of their keys."""

    container: ContainerTable
    support: SupportTable = Field(default_factory=SupportTable)
    contact: ContactTable
    floor: FloorTable = Field(default_factory=FloorTable)
    joints: JointsTable = Field(default_factory=JointsTable)
    motion: MotionTable
    vertical: VerticalTable = Field(default_factory=VerticalTable)
    initial: InitialTable = Field(default_factory=InitialTable)
    static: StaticTable | None = None  #: None: no rows of the code
    wind: WindTable | None = None  #: None: no rows of the wind
    solver: SolverTable = Field(default_factory=SolverTable)
    output: OutputTable = Field(default_factory=OutputTable)
    uncertainty: UncertaintyTable = Field(default_factory=UncertaintyTable)
    limits: RunLimitsTable | None = None  #: None: the width, or the gap beside it
    document: DocumentTable | None = None  #: None: the pages bear no names
    stop: tuple[StopTable, ...] = ()
    tie: tuple[TieTable, ...] = ()
    neighbour: tuple[NeighbourTable, ...] = ()

    @property
    def named(self) -> dict[str, str | None]:
        """What stands on its pages, by key of [document]."""
        return {} if self.document is None else self.document.model_dump()

    @cached_property
    def stack(self) -> tuple[Box, ...]:
        """All boxes, from the floor up; raises KeyError where a box has no mass."""
        container, gravity, boxes = self.container, self.gravity_m_s2, list[Box]()
        axis = bottom = 0.0
        for number, table in enumerate(container.box or (None,) * container.boxes):
            own = vars(table) if table is not None else {}
            given = vars(container) | {key: value for key, value in own.items() if value is not None}
            width, height, mass = given["width_m"], given["height_m"], given["mass_kg"]
            if own.get("mass_kg") is None and container.weight_N is not None:
                mass = container.weight_N / gravity
            elif mass is None and container.density_kg_m3 is not None:
                mass = container.density_kg_m3 * (width * height * container.depth_m * plan_share(container))
            if mass is None:
                raise KeyError("mass_kg")
            axis += own.get("offset_m", 0.0)
            centroid = own.get("centroid_m")
            boxes.append(
                Box(
                    width=width,
                    height=height,
                    mass=mass,
                    centroid=centroid_at(container, height) if centroid is None else centroid,
                    wall=given["wall_m"] if container.section == "shell" else None,
                    axis=axis,
                    bottom=number * height if table is None else bottom,
                )
            )
            bottom += height
        return tuple(boxes)

    @property
    def links(self) -> tuple[StopTable | TieTable, ...]:
        """Stops and ties, the stops first."""
        return (*self.stop, *self.tie)

    @property
    def bodies(self) -> int:
        """How many bodies move each for itself."""
        return self.container.bodies + len(self.neighbour)

    @property
    def effective_width(self) -> float:
        """Width between the points about which it rocks, over that of the base: castings may stand inside its sides."""
        return self.support.effective_width * (1.0 - 2.0 * self.support.inset / self.stack[0].width)

    @property
    def foot(self) -> float | None:
        """Length along x of the feet at the ends of the base [m]."""
        return self.support.foot_m if self.support.kind == "feet" else None

    @property
    def casting_length(self) -> float | None:
        """Length along x with which a casting presses the floor [m]; None of a base without castings.

        Where a post stands on it, the length of the post: beyond it the plate bends. EN 1993-1-8, 6.2.5 adds one to
        two plate thicknesses, but the thickness is not an input.
        """
        support, post = self.support, self.container.post_section
        if support.kind != "corners" or support.casting_m is None:
            return None
        return support.casting_m[0] if post is None else min(support.casting_m[0], post[0])

    @property
    def rolls(self) -> bool:
        """Whether the base is cambered from edge to edge: it touches wherever it has rolled to."""
        return self.support.camber_m > 0.0 and self.foot is None

    @property
    def joint_friction(self) -> dict[str, float]:
        """mu_static, mu_kinetic and weakening_m between loose boxes: those of [contact] where [joints] leaves them out.

        A mu_static below mu_kinetic of the floor takes that with it.
        """
        joints, floor = self.joints, self.contact
        static = floor.mu_static if joints.mu_static is None else joints.mu_static
        kinetic = min(floor.mu_kinetic, static) if joints.mu_kinetic is None else joints.mu_kinetic
        weakening = floor.weakening_m if joints.weakening_m is None else joints.weakening_m
        return {"mu_static": static, "mu_kinetic": kinetic, "weakening_m": weakening}

    @property
    def box_mass(self) -> float:
        """Mass of one box with its fill, the mean where boxes differ [kg]."""
        return self.stack[0].mass if self.container.box is None else self.mass / self.container.boxes

    @property
    def mass(self) -> float:
        """Mass of all boxes with their fill [kg]."""
        if self.container.box is not None:
            return sum(box.mass for box in self.stack)
        return self.container.boxes * self.box_mass

    @property
    def weight(self) -> float:
        """Weight of all boxes with their fill [N]."""
        return self.mass * self.gravity_m_s2

    @property
    def gravity_toward_floor(self) -> float:
        """g cos(slope) [m/s2]."""
        return self.gravity_m_s2 * math.cos(self.floor.slope)

    @property
    def gravity_downhill(self) -> float:
        """g sin(slope), > 0 toward +x [m/s2]."""
        return self.gravity_m_s2 * math.sin(self.floor.slope)

    @property
    def kinds(self) -> dict[str, object]:
        """The kinds of its motions, by table."""
        return {"motion": self.motion.kind, "vertical": self.vertical.kind}

    @property
    def has_vertical(self) -> bool:
        """Whether the floor moves up and down."""
        return self.vertical.kind != "none"

    @property
    def has_normal(self) -> bool:
        """Whether the floor moves normal to itself: up and down, or on a slope with a horizontal motion."""
        return self.has_vertical or (self.floor.turn != 0.0 and self.motion.kind != "none")

    @property
    def contact_damping_ratio(self) -> float | None:
        """c/(2 sqrt(k m)), the whole mass m on the spring k of one corner; None: the slab's own damping."""
        own = self.floor.is_slab and "damping_ratio" not in self.contact.model_fields_set
        return None if own else self.contact.damping_ratio

    @property
    def states_restitution(self) -> bool:
        """Whether a factor is stated on what its impacts leave."""
        return self.contact.restitution_over_housner is not None

    @property
    def starts_moving(self) -> bool:
        """Whether the container has the velocity of the floor at t = 0, along x and vertically."""
        return self.motion.kind == "none" or self.motion.start == "moving"

    def given(self) -> dict[str, Any]:
        """The keys that were set, by table, as a case file would hold them."""
        keys = self.model_dump(by_alias=True, exclude_unset=True, exclude=set(TABLES))
        tables = {name: getattr(self, name) for name in TABLES}
        content = {name: table.model_dump(exclude_unset=True) for name, table in tables.items() if table}
        return keys | {name: given for name, given in content.items() if given or name in OPTIONAL}
