"""The tables of a case file, one frozen model each: keys, units, defaults and what they mean.

A key carries its unit. The type, range and unit of one key are checked by its `Quantity`; relations between keys are
rules of `fem.case.rules` and `fem.case.motion_rules`. Keys of an option that is not chosen are checked and not used.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, assert_never

from pydantic import BeforeValidator, Field, GetJsonSchemaHandler, Strict, ValidationInfo, field_validator
from pydantic_core import CoreSchema

from fem.case import quantities as q
from fem.case.floors import FloorTable
from fem.case.motion_tables import MotionTable, VerticalTable
from fem.case.rules import CONTACT_RULES, CONTAINER_RULES, SOLVER_RULES
from fem.case.table import CaseTable, case_key, optional_key
from fem.case.unknown_inputs import UNCERTAINTY_RULES

USUAL_DASHPOT = 2.0  #: damping ratio of a stiff contact that does not bounce


@dataclass(frozen=True)
class OrRange:
    """Metadata of a number in whose place a file may give [low, high]; reading makes it the middle and a range."""

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Both, for the JSON schema of the case file."""
        number = handler(schema)
        return {"anyOf": [number, {"type": "array", "items": number, "minItems": 2, "maxItems": 2}]}


class BoxTable(CaseTable):
    """One box of a stack whose boxes differ, from the floor up, in place of boxes."""

    width_m: Annotated[float, q.LENGTH] | None = optional_key("outer width", 1.1)
    height_m: Annotated[float, q.LENGTH] | None = optional_key("outer height", 1.0)
    mass_kg: Annotated[float, q.MASS] | None = optional_key("with its fill", 2500.0)
    centroid_m: Annotated[float, q.LENGTH] | None = optional_key("height of the mass centre in the box", 0.5)
    wall_m: Annotated[float, q.WALL] | None = optional_key("wall thickness, shell only", 0.008)
    offset_m: Annotated[float, q.OFFSET] = case_key("along x, from the axis of the box below", 0.0)


def _as_tuple(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


class ContainerTable(CaseTable):
    """One box of the container, and how many of them stand on one another."""

    width_m: Annotated[float, q.LENGTH] = case_key("outer width, along x", example=1.1)
    height_m: Annotated[float, q.LENGTH] = case_key("outer height of one box", example=1.0)
    depth_m: Annotated[float, q.LENGTH] = case_key(
        "outer depth, out of the plane; default: the width", follows=lambda values: values["width_m"]
    )
    box: Annotated[tuple[BoxTable, ...] | None, BeforeValidator(_as_tuple)] = Field(
        default=None,
        description="boxes that differ, [[container.box]] from the floor up; what one leaves out is as [container]",
    )
    boxes: Annotated[int, Strict(), q.BOXES] = case_key(
        "number of equal boxes, one on the other; default: 1",
        follows=lambda values: len(values["box"] or (None,)),
        example=4,
    )
    joints: Literal["bolted", "loose"] = case_key(
        '"bolted" | "loose": boxes that stand on one another without bolts', "bolted"
    )
    weight_N: Annotated[float, q.WEIGHT] | None = optional_key(
        "of one box with its fill; or mass_kg, or density_kg_m3", 24525.0
    )
    mass_kg: Annotated[float, q.MASS] | None = optional_key(
        "of one box with its fill, in place of weight_N", 2500.0
    )
    density_kg_m3: Annotated[float, q.DENSITY] | None = optional_key(
        "mean density of one box with its fill, in place of weight_N", 2066.0
    )
    centroid_m: Annotated[float, q.LENGTH] = case_key(
        "height of the mass centre in the box; default: half the height",
        follows=lambda values: 0.5 * values["height_m"],
    )
    eccentricity_m: Annotated[float, q.OFFSET] = case_key(
        "of the mass centre of every box from its axis, > 0: toward +x", 0.0
    )
    wall_m: Annotated[float, q.WALL] | None = optional_key(
        "wall thickness, shell only", 0.008, only=("section", "shell")
    )
    wall_density_kg_m3: Annotated[float, q.WALL_DENSITY] = case_key(
        "density of the walls, shell only", 7850.0, only=("section", "shell")
    )
    section: Literal["shell", "solid"] = case_key(
        '"shell" | "solid"; default: shell where wall_m is given',
        follows=lambda values: "shell" if _has_walls(values) else "solid",
    )
    youngs_modulus_Pa: Annotated[float, q.STIFFNESS] = case_key("Young's modulus", 2.1e11)
    poisson_ratio: Annotated[float, q.POISSON] = case_key("Poisson's ratio", 0.3)
    damping_ratio: Annotated[float, q.MATERIAL_DAMPING] = case_key(
        "of the first elastic mode; it grows with frequency, zeta_n = zeta f_n/f_1", 0.02
    )
    post_m: Annotated[
        tuple[Annotated[float, q.POST], Annotated[float, q.POST]] | None, BeforeValidator(_as_tuple)
    ] = optional_key(
        "[width, wall] of the square hollow section at each of the four edges of a box, shell only",
        [0.12, 0.008],
        only=("section", "shell"),
    )
    corner_post_N: Annotated[float, q.CORNER_FORCE] | None = optional_key(
        "strength of the post above each bottom corner, of which two stand behind each other; default: on "
        "castings that of post_m, S355; else the wall yields",
        848e3,
    )
    mesh_file: str | None = optional_key("a mesh to use in place of the structured one", "container.msh")

    rules = CONTAINER_RULES

    @field_validator("boxes")
    @classmethod
    def _one_kind_of_stack(cls, value: int, info: ValidationInfo) -> int:
        """Refuse a number of boxes beside [[container.box]]; it sees only a number that is given."""
        if info.data.get("box") is not None:
            raise ValueError(
                f"cannot stand beside [[container.box]], of which each is one box (there are "
                f"{len(info.data['box'])}); keep one of them"
            )
        return value

    @property
    def post_section(self) -> tuple[float, float] | None:
        """Width and wall of the posts of a shell [m]; None without."""
        return self.post_m if self.section == "shell" else None

    @property
    def is_loose(self) -> bool:
        """Whether its boxes stand on one another without bolts."""
        return self.joints == "loose"

    @property
    def bodies(self) -> int:
        """How many bodies move each for itself: the boxes of a loose stack, else one."""
        return self.boxes if self.is_loose else 1

    @property
    def bolted_joints(self) -> int:
        """Joints whose bolts carry forces: those between the boxes of a bolted stack."""
        return self.boxes - self.bodies

    @property
    def total_height(self) -> float:
        """Height of all boxes together [m]."""
        if self.box is None:
            return self.boxes * self.height_m
        return sum(self.height_m if box.height_m is None else box.height_m for box in self.box)


def _has_walls(values: dict[str, Any]) -> bool:
    """Whether [container] or one of its boxes has a wall."""
    return values["wall_m"] is not None or any(value.wall_m is not None for value in values["box"] or ())


class SupportTable(CaseTable):
    """Where the base may touch the floor."""

    kind: Literal["corners", "feet", "flat"] = case_key('"corners" | "feet" | "flat"', "corners")
    foot_m: Annotated[float, q.FOOT] = case_key(
        "length of each foot from its corner, feet only", 0.15, only=("kind", "feet")
    )

    effective_width: Annotated[float, q.EFFECTIVE_WIDTH] = case_key(
        "width between the points about which it rocks, over width_m: rounded or worn edges; rigid, reduced",
        1.0,
    )

    casting_m: Annotated[list[Annotated[float, q.CASTING]], Field(min_length=3, max_length=3)] | None = (
        optional_key(
            "[width, depth, inset from the side] of a corner casting, two behind each other; corners only",
            [0.162, 0.178, 0.0],
            only=("kind", "corners"),
        )
    )
    casting_bears: Literal["plate", "edge"] | None = optional_key(
        '"plate" | "edge": over all its length, or at its outer edge; default: edge, plate where it is tilted',
        "plate",
        only=("kind", "corners"),
    )
    casting_tilt_m: Annotated[float, q.TILT] = case_key(
        "how far the outer edge of a casting stands higher than its inner one; < 0: lower",
        0.0,
        only=("kind", "corners"),
    )
    camber_m: Annotated[float, q.CAMBER] = case_key(
        "how far the edges of the base stand higher than its middle, along a parabola; 0: sharp corners", 0.0
    )
    rocking_damping_ratio: Annotated[float, q.ROCKING_DAMPING] = case_key(
        "of small rocking on a cambered base; not of feet, whose inner ends strike", 0.05
    )

    @property
    def inset(self) -> float:
        """Distance of the outer edge of the castings from the side of the box [m]."""
        return self.casting_m[2] if self.casting_m is not None and self.kind == "corners" else 0.0


class ContactTable(CaseTable):
    """Friction and the penalty contact of the base with the floor."""

    mu_static: Annotated[float, q.FRICTION, OrRange()] = case_key(
        "coefficient of static friction", example=0.4
    )
    mu_kinetic: Annotated[float, q.FRICTION] = case_key(
        "of kinetic friction; default: mu_static", follows=lambda values: values["mu_static"]
    )
    friction: Literal["elastic-stick", "regularised"] = case_key(
        '"elastic-stick" (regularised in displacement) | "regularised" (in velocity; it creeps)',
        "elastic-stick",
    )
    regularisation_velocity_m_s: Annotated[float, q.SLIP_VELOCITY] = case_key(
        "of regularised friction", 1e-3, only=("friction", "regularised")
    )
    normal_penalty_Pa_m: Annotated[float, q.PENALTY] | Literal["auto"] = case_key(
        'normal stiffness of the whole base over width x depth, or "auto"', "auto"
    )
    tangential_ratio: Annotated[float, q.RATIO] = case_key("tangential over normal penalty", 1.0)
    weakening_m: Annotated[float, q.WEAKENING] = case_key(
        "slip over which mu_static falls to mu_kinetic; 0: at once", 0.0
    )
    stribeck_velocity_m_s: Annotated[float, q.STRIBECK_VELOCITY] = case_key(
        "slip velocity over which mu_static falls to mu_kinetic, like exp(-(v/v_s)^2); 0: not with velocity",
        0.0,
        only=("friction", "elastic-stick"),
    )
    restitution_over_housner: Annotated[float, q.RESTITUTION] | None = optional_key(
        "factor on the angular velocity that an impact leaves, which on corners is Housner's", 0.95
    )
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] = case_key(
        "c/(2 sqrt(k m)), the whole mass m on the spring k of one corner", USUAL_DASHPOT
    )

    rules = CONTACT_RULES

    @property
    def sticks(self) -> bool:
        """Whether a point may stick, on an elastic spring; by the regularised law it creeps under any force."""
        match self.friction:
            case "elastic-stick":
                return True
            case "regularised":
                return False
        assert_never(self.friction)

    @property
    def drops_at_once(self) -> bool:
        """Whether mu_static falls to mu_kinetic at once when the support breaks loose."""
        gradual = self.weakening_m > 0.0 or self.stribeck_velocity_m_s > 0.0
        return self.mu_kinetic < self.mu_static and self.sticks and not gradual


class JointsTable(CaseTable):
    """Contact between boxes that stand on one another without bolts; friction left out is as on the floor."""

    mu_static: Annotated[float, q.FRICTION] | None = optional_key(
        "loose joints: of static friction; default: that of the floor", 0.4
    )
    mu_kinetic: Annotated[float, q.FRICTION] | None = optional_key(
        "loose joints: of kinetic friction; default: that of the floor, at most mu_static", 0.4
    )
    weakening_m: Annotated[float, q.WEAKENING] | None = optional_key(
        "loose joints: slip over which mu_static falls; default: that of the floor", 0.0
    )
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] | None = optional_key(
        "loose joints: c/(2 sqrt(k m)), all boxes' mass m on the spring k of a corner on a rigid floor; default: 2",
        0.5,
    )

    bolt_capacity_N: Annotated[float, q.CORNER_FORCE] | None = optional_key(
        "bolted joints: tension that all bolts along one edge carry, as two twistlocks", 500e3
    )

    @property
    def dashpot(self) -> float:
        """The damping ratio of loose joints: steel on steel, whatever the floor is."""
        return USUAL_DASHPOT if self.damping_ratio is None else self.damping_ratio


class InitialTable(CaseTable):
    """Where the container starts, beside the motion of the floor."""

    rotation_rad: Annotated[float, q.ROTATION] = case_key(
        "> 0 about the right corner, < 0 about the left", 0.0
    )
    angular_velocity_rad_s: Annotated[float, q.ANGULAR_VELOCITY] = case_key(
        "rigid, about that corner; at rotation 0 its sign chooses the corner", 0.0
    )
    velocity_m_s: Annotated[float, q.VELOCITY] = case_key("relative to the floor, added", 0.0)

    @property
    def is_pushed(self) -> bool:
        """Whether the container starts tilted or in motion."""
        return any((self.rotation_rad, self.angular_velocity_rad_s, self.velocity_m_s))


class StaticTable(CaseTable):
    """The lateral force method, EN 1998-1:2004, 4.3.3.2, beside the run; without this table it is left out."""

    ground_acceleration_m_s2: Annotated[float, q.GROUND_ACCELERATION] = case_key(
        "reference peak ground acceleration a_gR", 1.6
    )
    soil_factor: Annotated[float, q.SOIL_FACTOR] = case_key("S", 1.5)
    corner_period_s: Annotated[float, q.CORNER_PERIOD] = case_key(
        "T_C, up to which the spectrum is level; 0.8 s: ground type D, as the paper has it", 0.8
    )
    behaviour_factor: Annotated[float, q.BEHAVIOUR_FACTOR] = case_key("q", 1.5)
    importance_factor: Annotated[float, q.IMPORTANCE_FACTOR] = case_key("gamma_I", 1.0)


class SolverTable(CaseTable):
    """Model of the container, mesh, time steps and duration."""

    model: Literal["full", "reduced", "rigid"] = case_key(
        '"full" (every node) | "reduced" (elastic modes) | "rigid"', "reduced"
    )
    elastic_modes: Annotated[int, Strict(), q.MODE_COUNT] = case_key("kept by the reduced model", 20)
    scheme: Literal["generalised-alpha", "newmark"] = case_key(
        '"generalised-alpha" | "newmark"', "generalised-alpha"
    )
    spectral_radius: Annotated[float, q.SPECTRAL_RADIUS] = case_key(
        "generalised-alpha: damping of what the step does not resolve",
        0.5,
        only=("scheme", "generalised-alpha"),
    )
    newmark_beta: Annotated[float, q.NEWMARK_BETA] = case_key("newmark", 0.25, only=("scheme", "newmark"))
    newmark_gamma: Annotated[float, q.NEWMARK_GAMMA] = case_key("newmark", 0.5, only=("scheme", "newmark"))
    step_s: Annotated[float, q.STEP] | Literal["auto"] = case_key('largest step, or "auto"', "auto")
    energy_tolerance: Annotated[float, q.ENERGY_TOLERANCE] = case_key(
        "factor on the energy that a step may lose; 10: coarser and faster, for maps", 1.0
    )
    duration_s: Annotated[float, q.DURATION] | Literal["auto"] = case_key(
        'simulated time, or "auto": pulse and table: their end and free motion until rest or a fall, '
        "at most 60 s more; else 20 s",
        "auto",
    )
    element_size_m: Annotated[float, q.ELEMENT_SIZE] = case_key(
        "of the structured mesh; mesh lines also at wall_m and foot_m", 0.1
    )
    order: Annotated[int, Strict(), q.ORDER] = case_key("of the elements: 1 bilinear, 2 quadratic", 2)

    rules = SOLVER_RULES


class OutputTable(CaseTable):
    """Files to write, and their intervals."""

    history_s: Annotated[float, q.SAMPLING] = case_key("interval of the history", 0.005)
    fields_s: Annotated[float, q.FRAME_INTERVAL] | Literal["auto"] = case_key(
        'interval of the fields for ParaView and films; 0: none; "auto": 0.05 or longer, so that they take 16 MB',
        "auto",
    )
    contents_filter_Hz: Annotated[float, q.CONTENTS_FILTER] = case_key(
        "acceleration of the contents: cut-off of its low-pass filter, Butterworth of two poles", 33.0
    )
    figures: bool = case_key("draw the figures of a run, as SVG", True)
    stop_when_overturned: bool = case_key("end the run when the container lies on its side", True)
    stop_when_still: bool = case_key(
        "rigid, under records: end the run when the container is at rest and what is left of them is below 0.9 of what "
        "moves it; acceleration and sway of the contents are then not followed",
        False,
    )


#: a range [low, high], or that the value of the case is known
Unknown = Annotated[list[float], Field(min_length=2, max_length=2)] | Literal["held", "known"] | None


class UncertaintyTable(CaseTable):
    """What is not known of the inputs: [low, high], or "held" as given. The band of a run covers it."""

    mu_static: Unknown = optional_key(
        "of static friction; default: 0.9 to 1.1 times; mu_kinetic keeps its share", [0.3, 0.4]
    )
    mu_kinetic: Unknown = optional_key(
        "of kinetic friction; default: half of mu_static to all of it", [0.2, 0.4]
    )
    joints_mu_static: Unknown = optional_key(
        "loose joints: of static friction; default: half to twice where [joints] leaves it out", [0.2, 0.8]
    )
    joints_mu_kinetic: Unknown = optional_key(
        "loose joints: of kinetic friction; default: half of mu_static to all of it", [0.2, 0.4]
    )
    joints_weakening_m: Unknown = optional_key("loose joints: default: 0 to 5 mm", [0.0, 0.005])
    joints_damping_ratio: Unknown = optional_key("loose joints: default: 0.1 to 2, and as given", [0.1, 2.0])
    casting_tilt_m: Unknown = optional_key(
        "of castings that bear as plates; default: 0.5 mm less to 0.5 mm more", [-0.001, 0.001]
    )
    camber_m: Unknown = optional_key(
        "of the support; default: half to twice, of a level base flat or on feet 0 to 2 mm", [0.0, 0.002]
    )
    rocking_damping_ratio: Unknown = optional_key(
        "of the support, where it is cambered; default: 0.02 to 0.1, and as given", [0.02, 0.1]
    )
    weakening_m: Unknown = optional_key("of the contact; default: 0 to 5 mm", [0.0, 0.005])
    stribeck_velocity_m_s: Unknown = optional_key("of the contact; default: 0 to 0.3 m/s", [0.0, 0.3])
    normal_penalty_Pa_m: Unknown = optional_key(
        "of the contact; default: a ninth to three times", [1e9, 3e10]
    )
    bearing_strength_Pa: Unknown = optional_key(
        "of the floor, slab only; default: half to twice", [25e6, 1e8]
    )
    floor_youngs_modulus_Pa: Unknown = optional_key(
        "of the floor, slab only; default: half to twice", [1.5e10, 6e10]
    )
    damping_ratio: Unknown = optional_key("of the contact; default: half to twice", [1.0, 4.0])
    restitution_over_housner: Unknown = optional_key(
        "of the contact, where it is given; default: a loss 1 - e of 0.8 to 1.5 times", [0.9, 1.0]
    )
    material_damping_ratio: Unknown = optional_key("of the container; default: half to twice", [0.01, 0.04])
    stop_gap_m: Unknown = optional_key(
        "of the stops, where they differ the largest, and all in proportion; default: 0.8 to 1.2 times",
        [0.04, 0.06],
    )
    stop_stiffness_N_m: Unknown = optional_key("of the stops, likewise; default: half to twice", [5e7, 2e8])
    stop_mu: Unknown = optional_key("friction on the stops, likewise; default: half to twice", [0.1, 0.4])
    tie_slack_m: Unknown = optional_key("of the ties, likewise; default: 0.8 to 1.2 times", [0.0, 0.01])
    tie_stiffness_N_m: Unknown = optional_key("of the ties, likewise; default: half to twice", [5e5, 2e6])
    neighbour_gap_m: Unknown = optional_key(
        "between the neighbours, likewise; default: 0.8 to 1.2 times", [0.08, 0.12]
    )
    neighbour_stiffness_N_m: Unknown = optional_key(
        "of the sides, likewise; default: half to twice", [5e7, 2e8]
    )
    neighbour_mu: Unknown = optional_key(
        "friction between the sides, likewise; default: half to twice", [0.1, 0.4]
    )
    centroid_m: Unknown = optional_key(
        "height of the mass centre in a box; default: 0.98 to 1.02 times", [0.45, 0.55]
    )
    eccentricity_m: Unknown = optional_key(
        "of the mass centre; default: a hundredth of the width to both sides", [-0.01, 0.01]
    )
    effective_width: Unknown = optional_key("of the base; default: 0.97 to 1 times", [0.97, 1.0])
    slope_percent: Unknown = optional_key(
        "of the floor; default: half a per cent less to half a per cent more", [-0.5, 0.5]
    )
    vertical_phase_rad: Unknown = optional_key(
        "of a vertical harmonic beside a horizontal one; default: the whole turn", [0.0, 3.14]
    )
    support: bool | Literal["held", "known"] | None = optional_key(
        "corners and flat: whether the base may touch as the other does; default: true", True
    )
    start: bool | Literal["held", "known"] | None = optional_key(
        "harmonic: true tries the other motion.start, a jump of the floor's velocity; default: false", True
    )
    ramp: bool | Literal["held", "known"] | None = optional_key(
        "harmonic: whether a ramp of two cycles may begin it, or none; default: true", True
    )
    draws: Annotated[int, Strict(), q.DRAWS] = case_key("runs in which all of these are drawn at once", 32)

    rules = UNCERTAINTY_RULES


def _as_text(value: object) -> object:
    """A number as text: a document may have the number 2417."""
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


Text = Annotated[str | None, Field(max_length=200)]
Mark = Annotated[Text, BeforeValidator(_as_text)]


class DocumentTable(CaseTable):
    """What identifies the pages of a case; it is no part of the hash."""

    project: Text = optional_key("for every page", "Store of chemicals, hall 3")
    company: Text = optional_key("for every page", "Example Ltd")
    number: Mark = optional_key("of the document", "2417-ST-03")
    revision: Mark = optional_key("of the document", "A")
    author: Text = optional_key("who made it", "A. Author")
    checker: Text = optional_key("who checked it", "C. Checker")


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
    "solver": SolverTable,
    "output": OutputTable,
    "uncertainty": UncertaintyTable,
    "document": DocumentTable,
}


#: tables that mean something by standing in a case file; the others have their defaults where they do not
OPTIONAL = frozenset({"static", "document"})


class CaseHeading(CaseTable):
    """The keys of a case file that stand before its first table."""

    schema_version: Annotated[int, Strict(), q.SCHEMA] = Field(
        default=1, alias="schema", description="of this file's keys"
    )
    title: Annotated[str, Field(max_length=500)] = case_key("for people", "")
    gravity_m_s2: Annotated[float, q.GRAVITY] = case_key(
        "g; the paper (Knoedel and Hrabowski) takes 10", 9.81
    )
