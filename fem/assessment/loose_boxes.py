"""A loose stack in words and as a table: what each box did over what is below it, the floor or the next box."""

import math
from collections.abc import Iterator, Sequence

from rich.console import RenderableType
from rich.text import Text

from contact.stepping.observables import ROCKING
from fem.assessment.joint_tables import titled_table
from fem.results.figures import BOX_FIGURES, BoxResult
from fem.results.outcome import least_slide
from fem.results.run_result import BoxReach, RunResult, StaticResult, Verdict
from fem.runtime.units import JOINT_MILLIMETRES, SHORT_MILLIMETRES

AS_ONE = "the boxes moved as one"
MOST_BOXES = 12  #: boxes in a table; of more, those with a largest value
BOXES_NOTE = (
    "The boxes stand on one another without bolts. Slip and opening of a box are over what is below it: the floor or "
    "the next box; less slip than 1 mm is not resolved, because the dashpot of the joints decides it. The rotation "
    "ratio is the largest rotation of any box over the slenderness angle of the whole stack."
)


def leaning_in_words(what: str, verdict: Verdict) -> str:
    """That what is at rest where it cannot stand by itself counts as overturned; `what`: empty for the container."""
    at = "" if verdict.overturned_at_s is None else f" from t = {verdict.overturned_at_s:.3f} s on"
    rests = "came to rest where only what it leans on or hangs on holds it, and counts as overturned"
    return f"{what} {rests}{at}".strip()


def fall_in_words(verdict: Verdict) -> str:
    """Which box of a loose stack fell, and when; empty if none did."""
    if verdict.fell_box is None:
        return ""
    at, above = verdict.overturned_at_s, verdict.fell_box < len(verdict.boxes or ())
    if verdict.leans:
        return leaning_in_words(f"box {verdict.fell_box}", verdict)
    when = f" at t = {at:.3f} s" if at is not None else ""
    return f"box {verdict.fell_box} fell{when}{', with what stood on it' if above else ''}"


def joints_in_words(verdict: Verdict, static: StaticResult | None) -> str:
    """How the boxes of a loose stack moved on one another: the largest slip and opening; empty of one body."""
    boxes = verdict.boxes or ()
    if len(boxes) < 2:
        return ""
    slip_limit, opening_limit = limits(static or StaticResult())
    moved = []
    for verb, preposition, key, limit, unit in (
        ("slid", "on", "max_slip_m", slip_limit, JOINT_MILLIMETRES),
        ("opened", "from", "max_opening_m", opening_limit, SHORT_MILLIMETRES),
    ):
        most = _most(boxes, key, above=1)
        if boxes[most][key] > limit:
            moved.append(f"box {most + 1} {verb} {unit.text(boxes[most][key])} {preposition} box {most}")
    return ", ".join(moved) or AS_ONE


def largest_joint_slip(verdict: Verdict) -> tuple[str, str]:
    """The largest slip of a box on another with its range, and which slid on which; empty of one body."""
    boxes = verdict.boxes or ()
    if len(boxes) < 2:
        return "", ""
    most = _most(boxes, "max_slip_m", above=1)
    reach = _reaches(verdict)[most]
    slip = JOINT_MILLIMETRES.text(boxes[most].max_slip_m, reach.max_slip_m if reach else None)
    return slip, f"box {most + 1} on box {most}"


def _most(boxes: Sequence[BoxResult], key: str, above: int = 0) -> int:
    """Index of the box with the largest figure, from a given box upward."""
    return max(range(above, len(boxes)), key=lambda k: abs(boxes[k][key] or 0.0))


def limits(static: StaticResult) -> tuple[float, float]:
    """Slip and opening from which a joint counts as sliding and rocking [m], by the limits of the whole stack."""
    centroid, angle = static.centroid_m, static.slenderness_angle_rad
    if centroid is None or angle is None:
        return SHORT_MILLIMETRES.least, SHORT_MILLIMETRES.least
    width = 2.0 * centroid * math.tan(angle)
    return least_slide(width), ROCKING * angle * width


def box_rows(result: RunResult) -> list[tuple[str, ...]]:
    """Box, largest rotation in degrees, slip, slip left and opening in mm, whether it fell; from the floor up.

    With their ranges over the band, and in how many of its runs the box fell first.
    """
    verdict = result.verdict or Verdict()
    rows: list[tuple[str, ...]] = []
    members = len(verdict.band.members) if verdict.band is not None else 0
    for number, (box, reach) in enumerate(zip(verdict.boxes or (), _reaches(verdict), strict=True), 1):
        of_band = f"in {reach.fell} of {members} runs" if reach and reach.fell else ""
        figures = (
            figure.text(box[key], reach[key] if reach else None, bare=True)
            for key, figure in BOX_FIGURES.items()
        )
        rows.append((str(number), *figures, ", ".join(filter(None, ("fell" if box.fell else "", of_band)))))
    return rows


def _reaches(verdict: Verdict) -> Sequence[BoxReach | None]:
    """The ranges of each box over the band, where there is one."""
    ranges = verdict.band.boxes if verdict.band is not None else None
    return ranges or [None] * len(verdict.boxes or ())


def box_table(result: RunResult) -> Iterator[RenderableType]:
    """One row a box, from the floor up; nothing of a container that moves as one body."""
    rows = box_rows(result)
    if not rows:
        return
    indices = _shown((result.verdict or Verdict()).boxes or ())
    heads = (f">{figure.words} {figure.unit.name}" for figure in BOX_FIGURES.values())
    table = titled_table("Boxes, from the floor up", "box", *heads, "")
    for k in indices:
        table.add_row(*(cell.replace(" (", "\n(").replace(", ", ",\n") for cell in rows[k]))
    yield table
    left_out = len(rows) - len(indices)
    yield Text(BOXES_NOTE + (f" {left_out} more boxes are in run.json." if left_out else "") + "\n")


def _shown(boxes: Sequence[BoxResult]) -> Sequence[int]:
    if len(boxes) <= MOST_BOXES:
        return range(len(boxes))
    chosen = {_most(boxes, key) for key in BOX_FIGURES}
    return sorted(chosen | {k for k, box in enumerate(boxes) if box.fell})
