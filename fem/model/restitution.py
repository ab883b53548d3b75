"""Restitution of a rigid container on its floor: what its contact leaves, and the factor on that which a case asks for.

What a contact damping ratio amounts to follows from a shipped calibration table;
`data/contact_damping_restitution.csv` says how it was computed, for rigid homogeneous blocks. Other
distributions of mass are treated through the share of Housner's loss, (1 - e)/(1 - e_H), which varies slowly. A
container that deforms at an impact loses more.
"""

import csv
import math
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from fem.case.case import Case, CaseError
from fem.case.tables.unknown_inputs import blocks_on_joints
from fem.model.static_checks import StaticChecks
from fem.runtime.arrays import FloatArray

TABLE = "contact_damping_restitution.csv"


@dataclass(frozen=True, kw_only=True, eq=False)
class Calibration:
    """Loss of rigid blocks at an impact on one kind of support, over the loss of Housner's impact."""

    foot: FloatArray  #: (f,) length of a foot over the width, rising; one value for corners and flat [-]
    slenderness: FloatArray  #: (s,) height over width of a homogeneous block, rising [-]
    damping_ratio: FloatArray  #: (d,) of the contact, rising [-]
    loss: FloatArray  #: (f, s, d) (1 - e)/(1 - e_Housner) [-]; nan where there is no value

    def loss_at(self, foot: float, slenderness: float, damping_ratio: float) -> float | None:
        """Linear between the entries, in the logarithm of the damping ratio; None outside the table."""
        places = (
            _place(self.foot, foot),
            _place(self.slenderness, slenderness),
            _place(np.log(self.damping_ratio), float(np.log(damping_ratio))) if damping_ratio > 0.0 else None,
        )
        values = self.loss
        for place in places:
            if place is None:
                return None
            first, share = place
            if share in (0.0, 1.0):  # on an entry: its neighbour may have no value
                values = values[first + int(share)]
            else:
                values = (1.0 - share) * values[first] + share * values[first + 1]
        return None if np.isnan(values) else float(values)


def contact_restitution(case: Case, static: StaticChecks) -> float | None:
    """Restitution of a rigid container on the floor of a case; None on a slab, a cambered base, outside the table."""
    if case.floor.is_slab or case.support.camber_m > 0.0:
        return None
    own = apparent_restitution(
        support=case.support.kind,
        foot_over_width=None if case.foot is None else case.foot / static.width,
        slenderness=static.centroid / (0.5 * static.width),
        damping_ratio=case.contact.damping_ratio,
        housner=static.housner_restitution,
    )
    return None if own is None else own * (case.contact.restitution_over_housner or 1.0)


def require_loss(case: Case, static: StaticChecks) -> None:
    """Refuse, as a CaseError, impacts that would leave more than there was before them."""
    factor = case.contact.restitution_over_housner or 1.0
    left = contact_restitution(case, static) or factor * static.housner_restitution
    left = max([left, *(factor * above.housner_restitution for above in blocks_on_joints(case))])
    if factor <= 1.0 or left <= 1.0:
        return
    raise CaseError(
        f"[contact] restitution_over_housner = {factor:g}: impacts that leave {left / factor:.4g} of the angular "
        f"velocity by themselves would leave {left:.4g} of it, more than there was; take at most "
        f"{math.floor(1e4 * factor / left) / 1e4:g}"
    )


def apparent_restitution(
    *, support: str, foot_over_width: float | None, slenderness: float, damping_ratio: float, housner: float
) -> float | None:
    """Restitution of a rigid container on its support; None outside the table.

    Args:
        support: corners | feet | flat; foot_over_width: feet only.
        slenderness: height of the mass centre over half the width.
        damping_ratio: of the contact, c/(2 sqrt(k m)) with the whole mass on one corner; housner: his restitution.
    """
    calibration = read_calibrations()[support]
    foot = float(calibration.foot[0]) if support != "feet" else foot_over_width or 0.0
    loss = calibration.loss_at(foot, slenderness, damping_ratio)
    return None if loss is None else 1.0 - loss * (1.0 - housner)


@cache
def read_calibrations() -> dict[str, Calibration]:
    """The shipped table, by kind of support; a full grid for each."""
    text = resources.files("fem.model").joinpath("data", TABLE).read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    names = ("foot_over_width", "height_over_width", "contact_damping_ratio")
    found = {}
    for kind in dict.fromkeys(row["support"] for row in rows):
        own = [row for row in rows if row["support"] == kind]
        points = np.array([[float(row[name]) for name in names] for row in own])
        axes = [np.unique(points[:, k]) for k in range(3)]
        loss = np.full([axis.size for axis in axes], np.nan)
        loss[tuple(np.searchsorted(axis, points[:, k]) for k, axis in enumerate(axes))] = [
            (1.0 - float(row["rigid"])) / (1.0 - float(row["housner"])) if row["rigid"] else np.nan
            for row in own
        ]
        found[kind] = Calibration(foot=axes[0], slenderness=axes[1], damping_ratio=axes[2], loss=loss)
    return found


def _place(axis: FloatArray, value: float) -> tuple[int, float] | None:
    """Index of the entry at or below a value and the share of the way to the next; None outside."""
    near = 1e-9 * float(np.ptp(axis) or 1.0)
    if not axis[0] - near <= value <= axis[-1] + near:
        return None
    if axis.size == 1:
        return 0, 0.0
    first = min(int(np.searchsorted(axis, value, side="right")) - 1, axis.size - 2)
    first = max(first, 0)
    share = (value - axis[first]) / (axis[first + 1] - axis[first])
    return first, float(np.clip(share, 0.0, 1.0))
