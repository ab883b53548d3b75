"""The tables [contact] and [joints]: friction and contact of the base with the floor, and between the boxes."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import GetJsonSchemaHandler
from pydantic_core import CoreSchema

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule
from fem.case.tables.table import CaseTable, case_key, optional_key

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
