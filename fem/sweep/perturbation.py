"""What a sweep file says of the copies of its cells: which cells have them, and small changes of motion and contact.

The changes over the ranges of unknown inputs come beside these, from the table [uncertainty] of the base case.
"""

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, Strict

from fem.case.case import Case
from fem.case.strength import scaled_motion
from fem.case.tables.input_keys import DASHPOT
from fem.case.tables.input_ranges import HELD
from fem.case.tables.quantities import CONTACT_DAMPING, DRAWS, Quantity
from fem.case.tables.table import CaseTable
from fem.case.tables.unknown_inputs import WORDS
from fem.case.uncertainty import InputChange

SHARE = Quantity(least=0.0, most=0.5, advice="0.02 is two per cent")
FRICTION_STEP = Quantity(least=0.0, most=1.0, advice="0.02 is usual")
PHASE_STEP = Quantity(unit="rad", least=0.0, most=math.pi, advice="one turn is 2 pi")
CLOSE = Quantity(least=0.0, advice="rotation over the slenderness angle")
TURN = 2.0 * math.pi
SMALL = 0.0  #: of a range


class Perturbation(CaseTable):
    """Which cells are perturbed, and how much."""

    cells: Literal["auto", "near", "all", "none"] = Field(
        default="auto",
        description='"auto": a coarse grid of all cells, then around what changes, none for the full model | '
        '"near" a change of outcome only | "all" | "none"',
    )
    amplitude_share: Annotated[float, SHARE] = Field(
        default=0.02, description="of the floor's amplitude, up and down"
    )
    mu: Annotated[float, FRICTION_STEP] = Field(
        default=0.02,
        description="added to and taken from both coefficients of friction, of the floor and of loose joints",
    )
    phase_rad: Annotated[float, PHASE_STEP] = Field(
        default=0.3142, description="added to and taken from the phase; a twentieth of a turn"
    )
    contact_damping_ratios: list[Annotated[float, CONTACT_DAMPING]] = Field(
        default=[0.5, 1.0, 2.0], description="tried in place of the cell's own"
    )
    draws: Annotated[int, Strict(), DRAWS] | None = Field(
        default=None,
        description="copies in which all unknown inputs are drawn at once; default: a quarter of [uncertainty] draws",
    )
    close: Annotated[float, CLOSE] = Field(
        default=0.5, description="rotation ratio above which a standing cell counts as near"
    )

    def changes(self, case: Case) -> Iterator[InputChange]:
        """What each copy of a case changes; what is small counts as a small share of a range."""
        for values in self.members(case):
            share = 1.0 if DASHPOT in values else SMALL
            yield InputChange(kind="one", values=values, share=share)

    def members(self, case: Case) -> Iterator[dict[str, Any]]:
        """The keys that each copy of a case changes."""
        for factor in (1.0 - self.amplitude_share, 1.0 + self.amplitude_share):
            scaled = scaled_motion(case, factor)
            if scaled and factor != 1.0:
                yield scaled
        friction = case.contact
        yield from self._frictions("contact", friction.mu_static, friction.mu_kinetic)
        if case.container.is_loose:
            between = case.joint_friction
            yield from self._frictions("joints", between["mu_static"], between["mu_kinetic"])
        if case.motion.kind == "harmonic" and self.phase_rad > 0.0:
            for step in (-self.phase_rad, self.phase_rad):
                yield {"motion.phase_rad": math.remainder(case.motion.phase_rad + step, TURN)}
        if (
            case.floor.is_slab
            or friction.damping_ratio is None
            or (
                case.uncertainty.damping_ratio in HELD
                and "contact_damping_ratios" not in self.model_fields_set
            )
        ):
            return
        for ratio in self.contact_damping_ratios:
            if ratio != friction.damping_ratio:
                yield {"contact.damping_ratio": ratio}

    def _frictions(self, table: str, static: float, kinetic: float) -> Iterator[dict[str, Any]]:
        """Both coefficients of the floor, or of loose boxes, a little smaller and larger."""
        for step in (-self.mu, self.mu) if self.mu else ():
            yield {
                f"{table}.mu_static": _rounded(max(0.0, static + step)),
                f"{table}.mu_kinetic": _rounded(max(0.0, kinetic + step)),
            }


def _rounded(value: float) -> float:
    """Fifteen digits: 0.4 + 0.02 is 0.42."""
    return float(f"{value:.15g}")


def input_in_words(key: str) -> str:
    """What a copy changes, by its key, for people: an unknown input, or the motion."""
    return WORDS.get(key) or (
        "phase of the motion" if key.endswith("phase_rad") else "strength of the motion"
    )
