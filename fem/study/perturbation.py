"""What a sweep file says of the copies of its cells: which cells have them, and small changes of motion and contact.

The changes over the ranges of unknown inputs come beside these, from the table [uncertainty] of the base case.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, Strict
from scipy import ndimage

from fem.case.case import Case
from fem.case.strength import scaled_motion
from fem.case.tables.input_ranges import DASHPOT, HELD
from fem.case.tables.quantities import CONTACT_DAMPING, DRAWS, Quantity
from fem.case.tables.table import CaseTable
from fem.case.tables.unknown_inputs import WORDS
from fem.case.uncertainty import InputChange
from fem.results.outcome import Ending
from fem.runtime.arrays import BoolArray, FloatArray, IntArray
from fem.study.axes import Axis, shape_of

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
        for factor in (1.0 - self.amplitude_share, 1.0 + self.amplitude_share):
            scaled = scaled_motion(case, factor)
            if scaled and factor != 1.0:
                yield _small(scaled)
        frictions = {"contact": {"mu_static": case.contact.mu_static, "mu_kinetic": case.contact.mu_kinetic}}
        if case.container.is_loose:
            frictions["joints"] = case.joint_friction
        for table, own in frictions.items():
            for step in (-self.mu, self.mu) if self.mu else ():
                moved = {key: max(0.0, own[key] + step) for key in ("mu_static", "mu_kinetic")}
                # fifteen digits: 0.4 + 0.02 is 0.42
                yield _small({f"{table}.{key}": float(f"{value:.15g}") for key, value in moved.items()})
        if case.motion.kind == "harmonic" and self.phase_rad > 0.0:
            for step in (-self.phase_rad, self.phase_rad):
                yield _small({"motion.phase_rad": math.remainder(case.motion.phase_rad + step, TURN)})
        held = (
            case.uncertainty.damping_ratio in HELD and "contact_damping_ratios" not in self.model_fields_set
        )
        own_ratio = case.contact.damping_ratio
        if not (case.floor.is_slab or own_ratio is None or held):
            for ratio in self.contact_damping_ratios:
                if ratio != own_ratio:
                    yield InputChange(kind="one", values={DASHPOT: ratio}, share=1.0)


def _small(values: dict[str, Any]) -> InputChange:
    return InputChange(kind="one", values=values, share=SMALL)


def input_in_words(key: str) -> str:
    """What a copy changes, by its key, for people: an unknown input, or the motion."""
    return WORDS.get(key) or (
        "phase of the motion" if key.endswith("phase_rad") else "strength of the motion"
    )


#: one in so many values of a numeric axis belongs to the coarse grid
COARSE = 4


def _size(axes: Sequence[Axis], reach: int = 1) -> tuple[int, ...]:
    """Size of the neighbourhood along each axis."""
    return tuple(2 * reach + 1 if axis.is_numeric else 1 for axis in axes)


def near_cells(axes: Sequence[Axis], kind: IntArray, ratio: FloatArray, close: float) -> BoolArray:
    """Cells next to one of another kind, or standing and close to overturning.

    Args:
        axes: of the sweep.
        kind: endings, in the shape of the axes.
        ratio: largest rotation over the slenderness angle, in the shape of the axes; nan where there is none.
        close: rotation ratio that counts as close.
    """
    size = _size(axes)
    highest = ndimage.maximum_filter(kind, size=size, mode="nearest")
    lowest = ndimage.minimum_filter(kind, size=size, mode="nearest")
    with np.errstate(invalid="ignore"):
        return (highest != lowest) | ((kind == Ending.STANDING) & (ratio >= close))


def around(axes: Sequence[Axis], cells: BoolArray, reach: int = 1) -> BoolArray:
    """The cells and those up to `reach` away from them, diagonally as well."""
    grown: BoolArray = ndimage.maximum_filter(cells, size=_size(axes, reach), mode="constant", cval=False)
    return grown


def coarse_cells(axes: Sequence[Axis]) -> BoolArray:
    """Every fourth cell along each numeric axis, from the second on, in the shape of the axes."""
    chosen = np.zeros(shape_of(axes), dtype=bool)
    places = (
        slice((min(len(axis.values), COARSE) - 1) // 2, None, COARSE) if axis.is_numeric else slice(None)
        for axis in axes
    )
    chosen[tuple(places)] = True
    return chosen


def band_width(axes: Sequence[Axis], unsure: BoolArray, dimension: int) -> FloatArray:
    """Length along one axis of the stretch of unsure cells around a cell, in the unit of the axis; 0 for a sure cell.

    A cell extends half way to its neighbours (by ratio on a log scale), the outermost cells to their own value.
    """
    axis = axes[dimension]
    values = np.array(axis.values, dtype=float)
    middles = np.sqrt(values[:-1] * values[1:]) if axis.scale == "log" else 0.5 * (values[:-1] + values[1:])
    edges = np.concatenate([values[:1], middles, values[-1:]])
    touching = np.zeros((3,) * unsure.ndim, dtype=bool)  # cells that belong together: along this axis
    touching[tuple(slice(None) if k == dimension else 1 for k in range(unsure.ndim))] = True
    widths = np.zeros(unsure.shape)
    for stretch in ndimage.find_objects(ndimage.label(unsure, touching)[0]):
        inside = stretch[dimension]
        widths[stretch] = edges[inside.stop] - edges[inside.start]
    return widths
