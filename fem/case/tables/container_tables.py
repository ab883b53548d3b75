"""The tables [container], [support], [contact], [joints]: the boxes, where their base touches, and the contact there.

A key carries its unit. The type, range and unit of one key are checked by its `Quantity`; relations between keys are
rules (here and in `fem.case.case_rules`). Keys of an option that is not chosen are checked and not used.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, GetJsonSchemaHandler, Strict, ValidationInfo, field_validator
from pydantic_core import CoreSchema

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, file_beside, refused
from fem.case.tables.table import CaseTable, case_key, optional_key

#: damping ratio of a mode in which the fill alone moved, by kind of fill. Grains in a container that is not full take
#: all of a rebound from 1.5 times the container's own mass on (Pacheco-Vazquez and Dorbolo, Sci. Rep. 3 (2013) 2158);
#: 6 % of mass as particles alone give 0.04 (Friend and Kinra, J. Sound Vib. 233 (2000) 93); a landing on a fill that
#: does not pull and rebounds with 0 to 0.3 leaves a corner as much as a ratio of 0.2 does. Packed or set: half of it.
#: A liquid follows the walls; 0.5 % is usual for what sloshes (API 650, Annex E). The sources give no more than this
#: order, so the band tries a quarter to two and a half times.
FILL_DAMPING = {"none": 0.0, "granular": 0.2, "liquid": 0.005, "solid": 0.1}


class BoxTable(CaseTable):
    """One box of a stack whose boxes differ, from the floor up, in place of boxes."""

    width_m: Annotated[float, q.LENGTH] | None = optional_key("outer width", 1.1)
    height_m: Annotated[float, q.LENGTH] | None = optional_key("outer height", 1.0)
    mass_kg: Annotated[float, q.MASS] | None = optional_key("with its fill", 2500.0)
    centroid_m: Annotated[float, q.LENGTH] | None = optional_key("height of the mass centre in the box", 0.5)
    wall_m: Annotated[float, q.WALL] | None = optional_key("wall thickness, shell only", 0.008)
    offset_m: Annotated[float, q.OFFSET] = case_key("along x, from the axis of the box below", 0.0)


def _smallest(box: Any) -> float:
    """Smallest outer dimension of a box [m]."""
    return float(min(box.width_m, box.height_m, box.depth_m))


#: keys of which one gives the mass of a box, and their quantities
MASSES = {"weight_N": q.WEIGHT, "mass_kg": q.MASS, "density_kg_m3": q.DENSITY}


def _not_one_mass(box: Any) -> str:
    masses = {key: value for key in MASSES if (value := getattr(box, key)) is not None}
    own = not masses and box.box is not None and all(each.mass_kg is not None for each in box.box)
    if own or len(masses) == 1:
        return ""
    given = [f"{key} = {value:g} {MASSES[key].unit}" for key, value in masses.items()]
    rule = ", mass_kg, density_kg_m3: exactly one of the three must be given, "
    return rule + (f"got {', '.join(given)}; keep one of them" if given else "none is given")


CONTAINER_RULES = (
    refused("container.weight_N", _not_one_mass),
    Rule(
        "container.wall_m",
        lambda box: box.section == "solid" or box.wall_m is not None or box.box is not None,
        'is missing: section = "shell" needs the wall thickness, in m',
    ),
    Rule(
        "container.wall_m",
        lambda box: box.section == "solid" or box.wall_m is None or 2.0 * box.wall_m < _smallest(box),
        lambda box: (
            f"must be less than half the smallest outer dimension, {_smallest(box):g} m, got {box.wall_m:g} m; "
            + (
                q.WALL.guess(box.wall_m, lambda meant: 2.0 * meant < _smallest(box))
                or 'for a full block take section = "solid"'
            )
        ),
    ),
    # The range that the program has been tried on: neither a needle nor a plate.
    Rule(
        "container.width_m",
        lambda box: 0.02 * (1.0 - 1e-9) <= box.width_m / box.height_m <= 20.0 * (1.0 + 1e-9),
        lambda box: (
            f"over height_m must lie between 0.02 and 20, got {box.width_m:g} m / {box.height_m:g} m = "
            f"{box.width_m / box.height_m:g}; are both in metres?"
        ),
    ),
    Rule(
        "container.centroid_m",
        lambda box: box.centroid_m < box.height_m,
        lambda box: (
            f"must be less than height_m = {box.height_m:g} m, got {box.centroid_m:g} m; "
            + (
                q.LENGTH.guess(box.centroid_m, lambda meant: 0.1 * box.height_m < meant < box.height_m)
                or "it is measured from the bottom of one box"
            )
        ),
    ),
    file_beside("container.mesh_file", below=False),
)


def _as_tuple(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


class ContainerTable(CaseTable):
    """One box of the container, and how many of them stand on one another."""

    width_m: Annotated[float, q.LENGTH] = case_key("outer width, along x", example=1.1)
    height_m: Annotated[float, q.LENGTH] = case_key("outer height of one box", example=1.0)
    depth_m: Annotated[float, q.LENGTH] = case_key(
        "outer depth, out of the plane; default: the width", follows=lambda values: values["width_m"]
    )
    shape: Literal["prism", "cylinder"] = case_key(
        '"prism" | "cylinder": upright, of the diameter width_m; on corners', "prism"
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
        follows=lambda values: (
            "shell"
            if any(
                wall is not None for wall in (values["wall_m"], *(box.wall_m for box in values["box"] or ()))
            )
            else "solid"
        ),
    )
    youngs_modulus_Pa: Annotated[float, q.STIFFNESS] = case_key("Young's modulus", 2.1e11)
    poisson_ratio: Annotated[float, q.POISSON] = case_key("Poisson's ratio", 0.3)
    damping_ratio: Annotated[float, q.MATERIAL_DAMPING] = case_key(
        "of the first elastic mode; it grows with frequency, zeta_n = zeta f_n/f_1", 0.02
    )
    fill: Literal["none", "granular", "liquid", "solid"] = case_key(
        '"granular" | "liquid" | "solid" (packed or set) | "none": what takes of elastic vibration, shell only',
        "granular",
        only=("section", "shell"),
    )
    fill_damping_ratio: Annotated[float, q.MATERIAL_DAMPING] = case_key(
        "of a mode in which the fill alone moved, at the bounce of one corner; default: by fill",
        follows=lambda values: FILL_DAMPING[values["fill"]],
        example=0.2,
        only=("section", "shell"),
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
    def is_round(self) -> bool:
        """Whether it is an upright cylinder."""
        return self.shape == "cylinder"

    @property
    def is_filled_shell(self) -> bool:
        """Whether it is a box of plates whose fill takes of elastic vibration."""
        return self.section == "shell" and self.mesh_file is None and self.fill_damping_ratio > 0.0

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
        "slip over which mu_static falls to mu_kinetic, 1e-4 of the width or more; 0: at once", 0.0
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

    rules = (
        Rule(
            "contact.mu_kinetic",
            lambda contact: contact.mu_kinetic <= contact.mu_static,
            "must be at most mu_static = {mu_static:g}, got {mu_kinetic:g}; leave it out where the two are equal",
        ),
    )

    @property
    def sticks(self) -> bool:
        """Whether a point may stick, on an elastic spring; by the regularised law it creeps under any force."""
        return self.friction == "elastic-stick"


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
