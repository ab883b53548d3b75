"""The outcomes of a set of motions: of each motion, and of the whole set at each point on the other axes.

A motion that is tried with both signs counts once, with the worse of the two: the signs of one motion are not
independent. The share of motions that overturn has the interval of as many independent ones. A mean is that of the
motions under which the container stood, and stands beside the number that overturned: no mean includes a fall.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.batch.axes import MOTION_FILE, Axis, point_of, shape_of
from fem.batch.table import Columns
from fem.results.figures import SLIPPED, TURNED
from fem.results.outcome import COUNTED, NOT_STANDING, Ending, counts_of
from fem.runtime.arrays import IntArray
from fem.runtime.intervals import estimate
from fem.runtime.units import RATIO, SHORT_MILLIMETRES
from fem.sweep.cells import RunShown

CONFIDENCE = 0.95
#: keys whose values of one magnitude are the signs of a motion
SIGNS = ("motion.scale", "vertical.scale")
WORST_TURNED, MEAN_TURNED = f"worst_{TURNED}", f"mean_{TURNED}"
#: columns of `motion_set.csv` behind those of the other axes
SET_COLUMNS: Columns = dict.fromkeys(("motions", *COUNTED), int)
SET_COLUMNS |= dict.fromkeys(("overturned_share", "low", "high"), float)
SET_COLUMNS |= {"worst_motion": str, "worst_outcome": str, WORST_TURNED: float}
SET_COLUMNS |= {"worst_slip_motion": str, "worst_slip_m": float, MEAN_TURNED: float, "mean_slip_m": float}
#: columns of `motions.csv` behind the measures of a motion
OF_A_MOTION: Columns = dict.fromkeys(COUNTED, int) | dict.fromkeys((f"max_{TURNED}", SLIPPED), float)


@dataclass(frozen=True, kw_only=True)
class MotionOutcome(RunShown):
    """The outcome of one motion, with the worse of its signs."""

    motion: str


def severity(run: RunShown) -> tuple[int, float]:
    """Larger for a worse outcome."""
    order = (Ending.STANDING, Ending.FAILED, Ending.INVALID, Ending.OVERTURNED)
    return order.index(run.kind), run.turned


def sign_axes(axes: Sequence[Axis]) -> list[Axis]:
    """The axes that only reverse the sign of a motion."""
    return [axis for axis in axes if axis.key in SIGNS and len({abs(value) for value in axis.values}) == 1]


def motions_at(
    axes: Sequence[Axis], runs: Mapping[int, RunShown]
) -> Iterator[tuple[dict[str, Any], list[MotionOutcome]]]:
    """At each point on the axes that are neither motions nor signs: its values, and the outcome of each motion."""
    keys = [axis.key for axis in axes]
    inner = [MOTION_FILE, *(axis.key for axis in sign_axes(axes))]
    places = [keys.index(key) for key in inner]
    shape = shape_of(axes)
    cells: IntArray = np.moveaxis(np.arange(math.prod(shape)).reshape(shape), places, range(-len(places), 0))
    names = axes[places[0]].values
    signs = int(np.prod(cells.shape[cells.ndim - len(places) + 1 :]))
    for block in cells.reshape(-1, len(names), signs):
        point = point_of(axes, int(block[0, 0]))
        values = {key: value for key, value in point.items() if key not in inner}
        yield (
            values,
            [
                _worst(str(name), [runs[int(cell)] for cell in row])
                for name, row in zip(names, block, strict=True)
            ],
        )


def set_row(outcomes: Sequence[MotionOutcome]) -> dict[str, Any]:
    """The outcome of a set of motions at a point, by `SET_COLUMNS`."""
    kinds = np.array([outcome.kind for outcome in outcomes])
    fallen = np.isin(kinds, NOT_STANDING)
    share = estimate(fallen, kinds == Ending.FAILED, replicates=1, confidence=CONFIDENCE)
    computed = [outcome for outcome in outcomes if outcome.kind != Ending.FAILED]
    standing = [cell for cell in computed if cell.kind == Ending.STANDING]
    worst = max(computed, key=severity, default=None)
    slipped = max(computed, key=lambda outcome: outcome.slipped, default=None)
    return {
        "motions": len(outcomes),
        **counts_of(kinds),
        "overturned_share": share.value,
        "low": share.low,
        "high": share.high,
        "worst_motion": worst and worst.motion,
        "worst_outcome": worst and worst.outcome,
        WORST_TURNED: worst and worst[TURNED],
        "worst_slip_motion": slipped and slipped.motion,
        "worst_slip_m": slipped and slipped[SLIPPED],
        MEAN_TURNED: _mean([cell[TURNED] for cell in standing]),
        "mean_slip_m": _mean([cell[SLIPPED] for cell in standing]),
    }


def set_in_words(row: Mapping[str, Any]) -> str:
    """One sentence about a set of motions."""
    count, overturned, failed = row["motions"], row["overturned"], row["failed"]
    interval = (
        f"{100.0 * row['low']:.0f} to {100.0 * row['high']:.0f} % of such motions at {100.0 * CONFIDENCE:g} %"
    )
    begin = (
        f"{overturned or 'none'} of {count} motions overturn{'s' * (overturned < 2)} ({interval} confidence)"
    )
    others = {"not valid": row.get("invalid", 0), "failed": failed}
    parts = [", ".join([begin, *(f"{number} {word}" for word, number in others.items() if number)])]
    if overturned:
        parts.append(f"worst {row['worst_motion']}")
    elif row[WORST_TURNED] is not None:
        ratio = RATIO.text(row[WORST_TURNED])
        parts.append(f"worst {row['worst_motion']}, {row['worst_outcome']}, rotation ratio {ratio}")
    if (row["worst_slip_m"] or 0.0) >= SHORT_MILLIMETRES.least:
        parts.append(
            f"largest slip {SHORT_MILLIMETRES.text(row['worst_slip_m'])}, {row['worst_slip_motion']}"
        )
    if row[MEAN_TURNED] is not None:
        of = f"mean of {row['stood']}" + (f" that stood, {overturned} overturned" if overturned else "")
        ratio = RATIO.text(row[MEAN_TURNED])
        parts.append(f"{of}: rotation ratio {ratio}, slip {SHORT_MILLIMETRES.text(row['mean_slip_m'])}")
    return "; ".join(parts)


def by_motion(points: Sequence[Sequence[MotionOutcome]]) -> dict[str, dict[str, Any]]:
    """Counts and largest figures of each motion over all points, by its name; the figures where it stood."""
    rows: dict[str, dict[str, Any]] = {}
    for outcomes in zip(*points, strict=True):
        standing = [outcome for outcome in outcomes if outcome.kind == Ending.STANDING]
        rows[outcomes[0].motion] = counts_of([outcome.kind for outcome in outcomes]) | {
            f"max_{TURNED}": max((cell.turned for cell in standing), default=None),
            SLIPPED: max((cell.slipped for cell in standing), default=None),
        }
    return rows


def _worst(motion: str, signs: Sequence[RunShown]) -> MotionOutcome:
    """The outcome of a motion, with the worse of its signs; a failed run hides no fall and never counts as standing."""
    slip = max((sign[SLIPPED] for sign in signs if sign[SLIPPED] is not None), default=None)
    return MotionOutcome(**vars(max(signs, key=severity)) | {"motion": motion, SLIPPED: slip})


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None
