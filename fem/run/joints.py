"""The joints of a stack: what those of bolted boxes must carry, and what loose boxes do on one another."""

import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from rich.box import SIMPLE
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from contact.stepping.modes import ROCKING
from fem.results.figures import BOX_FIGURES, BoxResult
from fem.results.outcome import least_slide
from fem.results.run_result import BoxReach, JointDemand, RunResult, StaticResult, Verdict
from fem.run.ranges import impact_note
from fem.run.words import paragraphs, sentence
from fem.runtime.units import FEW, JOINT_MILLIMETRES, SHORT_MILLIMETRES, in_figures

MOST_JOINTS = 8  #: joints shown; of more, those with a largest value
LARGEST = ("max_shear_N", "max_moment_Nm", "bolt_tension_left_N", "bolt_tension_right_N", "bolt_shear_N")


def note(verdict: Verdict, which: str) -> str:
    """How to read the joints of a stack: `bolted_note` or `loose_note`."""
    return sentence("joints.txt.j2", which, verdict=verdict)


def titled_table(title: str, *columns: str) -> Table:
    """An empty table; the numbers of a column that begins with > are aligned at the right."""
    table = Table(
        title=title, title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0), show_header=any(columns)
    )
    for name in columns:
        table.add_column(name.removeprefix(">"), justify="right" if name.startswith(">") else "left")
    return table


def table_by(template: str, macro: str, **shown: Any) -> Table:
    """A table by a macro of a template: `title | head | head`, then one row after the other."""
    lines = [[cell.strip() for cell in text.split("|")] for text in paragraphs(template, macro, **shown)]
    table = titled_table(*lines[0])
    for row in lines[1:]:
        table.add_row(*row)
    return table


def joint_tables(every: Sequence[JointDemand], verdict: Verdict) -> Iterator[RenderableType]:
    """Forces, and what bolts carry; one row a joint, from the floor up."""
    joints = every
    if len(every) > MOST_JOINTS:
        chosen = {max(range(len(every)), key=lambda j: getattr(every[j], key)) for key in LARGEST}
        joints = [every[j] for j in sorted(chosen)]
    named = {"kilo": partial(in_figures, figures=FEW, factor=1e-3), "unbolted": unbolted}
    for macro in ("forces", "bolts"):
        yield table_by(
            "joints.txt.j2", macro, joints=joints, verdict=verdict, impact_note=impact_note(verdict), **named
        )
    if any(joint.bolt_utilisation is not None for joint in joints):
        yield Text("In parentheses: the larger tension over the capacity of a bolt.\n")
    yield _note(verdict, "bolted_note", len(every) - len(joints), "joints")


def _note(verdict: Verdict, which: str, left_out: int, of: str) -> Text:
    more = f" {left_out} more {of} are in run.json." if left_out else ""
    return Text(f"{note(verdict, which)}{more}\n")


def unbolted(joint: JointDemand) -> str:
    """What the joint would do without bolts."""
    events = (("opens", joint.opens_at_s), ("slides", joint.slides_at_s))
    instants = [f"{verb} at {instant:.3g} s" for verb, instant in events if instant is not None]
    return ", ".join(instants) or "stays closed, sticks"


AS_ONE = "the boxes moved as one"
MOST_BOXES = 12  #: boxes in a table; of more, those with a largest value


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
    rows, boxes = box_rows(result), (result.verdict or Verdict()).boxes or ()
    if not rows:
        return
    indices: Sequence[int] = range(len(boxes))
    if len(boxes) > MOST_BOXES:
        fallen = {k for k, box in enumerate(boxes) if box.fell}
        indices = sorted(fallen | {_most(boxes, key) for key in BOX_FIGURES})
    heads = (f">{figure.words} {figure.unit.name}" for figure in BOX_FIGURES.values())
    table = titled_table("Boxes, from the floor up", "box", *heads, "")
    for k in indices:
        table.add_row(*(cell.replace(" (", "\n(").replace(", ", ",\n") for cell in rows[k]))
    yield table
    yield _note(result.verdict or Verdict(), "loose_note", len(rows) - len(indices), "boxes")
