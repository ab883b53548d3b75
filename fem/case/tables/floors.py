"""The floor as a material: table [floor], presets of common floors with their ranges and sources, and their rules.

A rigid floor is the numerical penalty of [contact]. A slab is an elastic half-space under a patch at each corner of the
elevation, which crushes where the pressure reaches its bearing strength (`fem.model.floor` makes springs of it). A
preset gives what the case leaves out; no preset is fitted to an experiment.
"""

import math
from functools import partial
from operator import attrgetter
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, left_out, refused
from fem.case.tables.table import CaseTable, case_key, optional_key


class FloorPreset(NamedTuple):
    """A common floor: the values taken; `../keys.md` has the range in which such floors lie."""

    youngs_modulus: float  #: for loads of some milliseconds [Pa]
    poisson_ratio: float
    bearing_strength: float  #: mean pressure on a small patch at which it gives way [Pa]
    density: float | None  #: for radiation damping [kg/m3]; None where no half-space lies below


PRESETS: dict[str, FloorPreset] = {
    # EN 1992-1-1:2004, Table 3.1 (E_cm, f_ck = 25 MPa, f_cm = 33 MPa) and 3.1.3 (aggregates: 0.7 to 1.2 E_cm);
    # strength from f_ck without spread to 3 f_cm with it (6.7, Eq. 6.63), 1.5 f_cm taken
    "concrete C25/30": FloorPreset(31e9, 0.2, 50e6, 2400.0),
    # typical values for pavement materials: 2.1 to 3.4 GPa at 21 C, 14 GPa and more at 0 C, 0.14 to 0.34 GPa at 60 C,
    # Poisson's ratio 0.30 to 0.35; strength: estimate, unconfined to three times that
    "asphalt": FloorPreset(3e9, 0.35, 5e6, 2400.0),
    # typical values for pavement materials, base of crushed stone: 140 to 550 MPa, Poisson's ratio 0.35; strength by
    # EN 1997-1:2004, D.4, of a patch 0.2 m wide with 42 to 50 degrees of friction (more if wider)
    "compacted gravel": FloorPreset(280e6, 0.35, 0.5e6, 2100.0),
    # EN 1993-1-1:2005, 3.2.6 and Table 3.1 (S235); strength from yield to 2.97 times yield, a punch on a plate thick
    # against the patch (Johnson, Contact Mechanics, 1985, 6.2); a thin one is as strong as what is below
    "steel plate": FloorPreset(210e9, 0.3, 600e6, 7850.0),
    # Gent, Rubber Chem. Technol. 31 (1958) 896: hardness 60 Shore A (45 to 75), thick against the patch (a thinner mat
    # is stiffer); strength: estimate, the tensile strength, since rubber recovers below it
    "rubber mat": FloorPreset(3.6e6, 0.49, 10e6, None),
}

#: short names of presets
SHORT_NAMES = {"concrete": "concrete C25/30", "C25/30": "concrete C25/30", "steel": "steel plate"}
PresetName = Literal[
    "concrete C25/30",
    "asphalt",
    "compacted gravel",
    "steel plate",
    "rubber mat",
    "concrete",
    "C25/30",
    "steel",
]

#: keys of [floor] that a slab alone has
SLAB_KEYS = ("preset", "youngs_modulus_Pa", "poisson_ratio", "bearing_strength_Pa", "corner_patch_m")
#: keys of [floor] that a preset gives
PRESET_KEYS = ("youngs_modulus_Pa", "poisson_ratio", "bearing_strength_Pa")
#: keys of [contact] that belong to the numerical penalty of a rigid floor
PENALTY_KEYS = ("normal_penalty_Pa_m", "tangential_ratio")


def _of_preset(name: str) -> Any:
    """The default of a key of a slab: that of its preset."""

    def value(values: dict[str, Any]) -> float | None:
        preset = PRESETS.get(values["preset"])
        return None if preset is None or values["kind"] != "slab" else getattr(preset, name)

    return value


def _of_a_slab(floor: Any, key: str) -> str:
    """Ignored on a rigid floor, such a key would be an answer for another floor; of a slab some must be there."""
    given = getattr(floor, key) is not None
    if floor.kind != "slab":
        return given * 'belongs to kind = "slab", this floor is "rigid"; set kind = "slab", or leave it out'
    if given or key not in PRESET_KEYS:
        return ""
    presets = ", ".join(f'"{name}"' for name in PRESETS)
    return f'is missing: kind = "slab" needs it, or a preset ({presets})'


FLOOR_RULES = tuple(refused(f"floor.{key}", partial(_of_a_slab, key=key)) for key in SLAB_KEYS)


class FloorTable(CaseTable):
    """The floor: rigid (the numerical penalty of [contact]), or a slab that gives way and crushes; its slope."""

    kind: Literal["rigid", "slab"] = case_key('"rigid" | "slab"', "rigid")
    preset: PresetName | None = optional_key(
        f"of a slab, which it implies: {' | '.join(PRESETS)}", "concrete C25/30", only=("kind", "slab")
    )
    youngs_modulus_Pa: Annotated[float, q.FLOOR_STIFFNESS] | None = case_key(
        "of a slab; default: that of the preset",
        follows=_of_preset("youngs_modulus"),
        example=31e9,
        only=("kind", "slab"),
    )
    poisson_ratio: Annotated[float, q.FLOOR_POISSON] | None = case_key(
        "of a slab; default: that of the preset",
        follows=_of_preset("poisson_ratio"),
        example=0.2,
        only=("kind", "slab"),
    )
    bearing_strength_Pa: Annotated[float, q.BEARING_STRENGTH] | None = case_key(
        "of a slab: pressure at which it crushes; default: that of the preset",
        follows=_of_preset("bearing_strength"),
        example=50e6,
        only=("kind", "slab"),
    )
    corner_patch_m: Annotated[list[Annotated[float, q.PATCH]], Field(min_length=2, max_length=2)] | None = (
        optional_key(
            "of a slab: [along x, out of plane], all that bears under one corner of the elevation; default: "
            "wall x depth, of feet and flat their own",
            [0.1, 0.2],
            only=("kind", "slab"),
        )
    )
    slope_percent: Annotated[float, q.SLOPE] = case_key("of the floor, > 0: it falls toward +x", 0.0)
    motion_along: Literal["horizontal", "floor"] | None = case_key(
        'of a floor that slopes: [motion] is "horizontal" and [vertical] vertical, or they are along the "floor" and '
        "normal to it",
        follows=lambda values: "horizontal" if values.get("slope_percent") else None,
        example="horizontal",
    )

    rules = FLOOR_RULES

    @classmethod
    def as_meant(cls, given: dict[str, Any]) -> dict[str, Any]:
        """A preset by its short name, and the slab that it implies."""
        preset = given.get("preset")
        if not isinstance(preset, str):
            return given
        return {"kind": "slab"} | given | {"preset": SHORT_NAMES.get(preset, preset)}

    @property
    def is_slab(self) -> bool:
        """Whether it gives way and crushes."""
        return self.kind == "slab"

    @property
    def slope(self) -> float:
        """Angle of the floor with the horizontal, > 0: it falls toward +x [rad]."""
        return math.atan(0.01 * self.slope_percent)

    @property
    def turn(self) -> float:
        """Angle by which its motions are turned to those along it and normal to it [rad]."""
        return 0.0 if self.motion_along == "floor" else self.slope

    @property
    def density(self) -> float | None:
        """For radiation damping [kg/m3]; None where it is not known."""
        return None if self.preset is None else PRESETS[self.preset].density


def _patch_does_not_fit(case: Any) -> str:
    """Why the patches do not fit below the base; empty where they do."""
    patch, depth = case.floor.corner_patch_m, case.container.depth_m
    if not case.floor.is_slab or patch is None:
        return ""
    half = 0.5 * case.stack[0].width
    limits = (("along x", "half of width_m", half), ("out of plane", "depth_m", depth))
    for value, (name, of, most) in zip(patch, limits, strict=True):
        if value > most * (1.0 + 1e-9):
            guess = q.PATCH.guess(value) if value > 10.0 * most else ""
            return (
                f"= {patch} does not fit under the base: {name} at most {of} = {most:g} m, got {value:g} m"
                + f"; {guess}" * bool(guess)
            )
    return ""


FLOOR_CASE_RULES = (
    Rule(
        "floor.corner_patch_m",
        lambda case: (
            not case.floor.is_slab
            or case.floor.corner_patch_m is not None
            or case.support.casting_m is not None
            or case.support.kind != "corners"
            or case.container.section == "shell"
        ),
        "is missing: a solid block has no wall that would say how much of a corner bears; give [along x, out of plane]",
    ),
    refused("floor.corner_patch_m", _patch_does_not_fit),
    *left_out(
        attrgetter("floor.is_slab"),
        {
            "contact.normal_penalty_Pa_m": 'belongs to floor.kind = "rigid": the stiffness of a slab follows its '
            "youngs_modulus_Pa; leave it out",
            "contact.tangential_ratio": 'belongs to floor.kind = "rigid": a slab has its own tangential stiffness; '
            "leave it out",
        },
    ),
)
