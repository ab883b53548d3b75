"""The summary of a run, on screen and in `summary.txt`: results first, the static rules beside them, then numerics.

Made from the result of a run alone, in units for people (kN, kNm, mm, degrees). Only the static rule under
this run's own peak floor acceleration is compared with the run. The code's base shear answers another question
and is shown below it. A summary states what happened under this motion, and under multiples of it where there is a
margin.
"""

import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from rich.box import SIMPLE
from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from fem.results import run_result
from fem.results.figures import BOX_FIGURES, BRIEF, FIGURES, SLIPPED, SUMMARY, TURNED, Place, summary_order
from fem.results.kinds import RUN
from fem.results.outcome import SLIDING, Outcome
from fem.run.card import card_of
from fem.run.described import (
    box_rows,
    code_note,
    fall_in_row,
    floor_rows,
    governing,
    largest_joint_slip,
    motion_in_words,
    rule_says,
    unbolted,
    used,
)
from fem.run.words import bolt_forces, figure_in_words, impact_note, of_band, paragraphs, rows, sentence
from fem.runtime.terminal import shown
from fem.runtime.units import FEW, MILLIMETRES, in_figures, visible_number

TEXT_WIDTH = 80
CRUSHED = 1e-4  #: indentation from which a floor counts as crushed [m]
MOST_JOINTS, MOST_BOXES = 8, 12  #: in a table; of more, those with a largest value
LARGEST = ("max_shear_N", "max_moment_Nm", "bolt_tension_left_N", "bolt_tension_right_N", "bolt_shear_N")


def plain_summary(result: run_result.RunResult, *, folder: Path) -> str:
    """The summary as text, in lines of at most 80 characters; a path stands on a line of its own, unbroken.

    Args:
        result: of the run; blocks that it did not reach may be missing.
        folder: of the run.
    """
    return "\n".join([*_lines(result, folder, _whole(result)), *_files(folder)]) + "\n"


def brief_summary(result: run_result.RunResult, *, folder: Path) -> str:
    """What the terminal shows after a run: verdict, ranges, the static rule of its own motion, where the rest is."""
    count = len(result.warnings or ())
    noted = f", with {count} warning{'s' * (count > 1)}" if count else ""
    rest = (f"Whole summary{noted}: {folder / 'summary.txt'}", *_files(folder))
    motion = result.motion or run_result.MotionResult()
    read = (*motion.notes, *(motion.vertical.notes if motion.vertical else ()))  # is no detail
    shown: list[RenderableType] = [*_table_of_rows(result, "brief_results", BRIEF), *_warnings(read)]
    if result.static is not None:
        shown.append(_static_table(result, replace(result.static, code=None, code_q1=None)))
    return "\n".join([*_lines(result, folder, shown), *rest]) + "\n"


def _lines(result: run_result.RunResult, folder: Path, parts: Iterable[RenderableType]) -> list[str]:
    # Text, never markup: titles, folders and warnings may hold anything.
    title = Text(result.title or result.case or folder.name)
    console = Console(file=io.StringIO(), width=TEXT_WIDTH, color_system=None, highlight=False)
    with console.capture() as capture:
        console.print(title, Text("\n".join(card_of(result)) + "\n"), *parts, sep="\n")
    return [line.rstrip() for line in shown(capture.get()).splitlines()]


def _whole(result: run_result.RunResult) -> Iterator[RenderableType]:
    verdict = result.verdict or run_result.Verdict()
    yield from _table_of_rows(result, "results")
    if result.static is not None:
        yield _static_table(result, result.static)
        yield from (Text(f"{sentence}\n") for sentence in governing(result))
        if note := code_note(result.static):
            yield Text(f"{note}\n")
    yield from _box_table(result)
    if result.joints:
        yield from _joint_tables(result.joints, verdict)
    if note := band_note(verdict.band):
        yield Text(f"{note}\n")
    yield from _warnings(result.warnings or ())
    yield from _table_of_rows(result, "computation", title="Numerics")


def _warnings(texts: Sequence[str]) -> Iterator[Text]:
    if texts:
        yield Text("".join(f"Warning: {text}\n" for text in texts))


def band_note(band: run_result.Band | None) -> str:
    """What the band tried and what its ranges are; empty where nothing was varied."""
    kinds = {member.kind for member in band.members[1:]} if band is not None else set()
    return sentence("summary.txt.j2", "band_note", kinds=kinds)


def to_compare(result: run_result.RunResult) -> run_result.Verdict:
    """What may be compared with a static rule, which takes the whole motion: nothing before the run has ended."""
    return (result.status in RUN.finished and result.verdict) or run_result.Verdict()


def _static_table(result: run_result.RunResult, static: run_result.StaticResult) -> Table:
    """Sliding and overturning under each action, one below the other."""
    return _table_by(
        "summary.txt.j2",
        "static_rules",
        static=static,
        own_motion=own_motion_name(static, result.motion),
        use=used,
        seen=visible_number,
        rule_says=rule_says,
        found=partial(run_found, to_compare(result)),
    )


def own_motion_name(static: run_result.StaticResult, motion: run_result.MotionResult | None) -> str:
    """The peak floor acceleration of the run along its floor, and the slope."""
    peak = motion and (motion.peak_in_run_m_s2 or motion.peak_acceleration_m_s2)
    slope = f" and {static.downhill_m_s2:.3g} m/s2 downhill" if static.downhill_m_s2 else ""
    return "own peak" if not peak else f"own peak, {peak:.3g} m/s2{slope}"


def run_found(verdict: run_result.Verdict, check: str) -> str:
    """What the run found, beside what the static rule says of `sliding`, `overturning` or `lifting`."""
    return sentence(
        "found.txt.j2",
        check,
        verdict=verdict,
        slip=of_band(verdict, SLIPPED),
        between=largest_joint_slip(verdict)[0],
        ratio=of_band(verdict, TURNED),
        uplift=of_band(verdict, "max_uplift_m"),
        in_row=bool(fall_in_row(verdict)),
    )


def _titled_table(title: str, *columns: str) -> Table:
    """An empty table; the numbers of a column that begins with > are aligned at the right."""
    table = Table(
        title=title, title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0), show_header=any(columns)
    )
    for name in columns:
        table.add_column(name.removeprefix(">"), justify="right" if name.startswith(">") else "left")
    return table


def _table_by(template: str, macro: str, **shown: Any) -> Table:
    """A table by a macro of a template: `title | head | head`, then one row after the other."""
    lines = [[cell.strip() for cell in text.split("|")] for text in paragraphs(template, macro, **shown)]
    table = _titled_table(*lines[0])
    for row in lines[1:]:
        table.add_row(*row)
    return table


def _table_of_rows(
    result: run_result.RunResult, macro: str, place: Place = SUMMARY, title: str = ""
) -> Iterator[Table]:
    if pairs := _rows(result, macro, place):
        of_row = (result.verdict or run_result.Verdict()).neighbours
        own = "The run, of the container itself" if of_row else "The run"
        table = _titled_table(title or own, "", "")
        for pair in pairs:
            table.add_row(*map(Text, pair))
        yield table


def _joint_tables(
    every: Sequence[run_result.JointDemand], verdict: run_result.Verdict
) -> Iterator[RenderableType]:
    """Forces, and what bolts carry; one row a joint, from the floor up."""
    joints = every
    if len(every) > MOST_JOINTS:
        chosen = {max(range(len(every)), key=lambda j: getattr(every[j], key)) for key in LARGEST}
        joints = [every[j] for j in sorted(chosen)]
    named: dict[str, Any] = {"joints": joints, "impact_note": impact_note(verdict), "unbolted": unbolted}
    named["kilo"] = partial(in_figures, figures=FEW, factor=1e-3)
    yield from (_table_by("joints.txt.j2", macro, **named) for macro in ("forces", "bolts"))
    if any(joint.bolt_utilisation is not None for joint in joints):
        yield Text("In parentheses: the larger tension over the capacity of a bolt.\n")
    yield _note(verdict, "bolted_note", len(every) - len(joints), "joints")


def _box_table(result: run_result.RunResult) -> Iterator[RenderableType]:
    """One row a box, from the floor up; nothing of a container that moves as one body."""
    verdict = result.verdict or run_result.Verdict()
    if not (boxes := verdict.boxes or ()):
        return
    indices: Sequence[int] = range(len(boxes))
    if len(boxes) > MOST_BOXES:
        fallen = {k for k, box in enumerate(boxes) if box.fell}
        most = (max(range(len(boxes)), key=lambda k: abs(boxes[k][key] or 0.0)) for key in BOX_FIGURES)
        indices = sorted(fallen | {*most})
    heads = (f">{figure.words} {figure.unit.name}" for figure in BOX_FIGURES.values())
    table, cells = _titled_table("Boxes, from the floor up", "box", *heads, ""), box_rows(result)
    for k in indices:
        table.add_row(*(cell.replace(" (", "\n(").replace(", ", ",\n") for cell in cells[k]))
    yield table
    yield _note(verdict, "loose_note", len(boxes) - len(indices), "boxes")


def _note(verdict: run_result.Verdict, which: str, left_out: int, of: str) -> Text:
    more = f" {left_out} more {of} are in run.json." if left_out else ""
    return Text(f"{sentence('joints.txt.j2', which, verdict=verdict)}{more}\n")


def result_rows(result: run_result.RunResult) -> list[tuple[str, str]]:
    """Name and value of each result in reading order; results that were not reached are left out."""
    return _rows(result, "results")


def _rows(result: run_result.RunResult, macro: str, place: Place = SUMMARY) -> list[tuple[str, str]]:
    """Name and value of what a macro of `summary.txt.j2` says, with the figures of a place."""
    verdict, numerics = result.verdict or run_result.Verdict(), result.numerics or run_result.Numerics()
    turns = verdict.outcome not in (Outcome.REST, Outcome.SLIDE, Outcome.HOP)
    slides = not {*SLIDING}.isdisjoint({*verdict.modes, verdict.outcome})
    figures = {key: FIGURES[key] for key in summary_order() if place in FIGURES[key].places}
    return rows(
        "summary.txt.j2",
        macro,
        result=result,
        verdict=verdict,
        numerics=numerics,
        energy=result.energy or run_result.Energy(),
        motion=result.motion or run_result.MotionResult(),
        angle=(result.static or run_result.StaticResult()).slenderness_angle_rad,
        brief=place is BRIEF,
        states=[mode for mode in verdict.modes if mode != Outcome.OVERTURNED or not fall_in_row(verdict)],
        uncounted=verdict.slipped >= MILLIMETRES.least and not slides,
        figures_of={
            key: figure.words + (" of box 1" if figure.lowest and verdict.boxes else "")
            for key, figure in figures.items()
        },
        joint_slip=largest_joint_slip(verdict),
        floor=floor_rows(result.floor, lands=turns),
        bolts=bolt_forces(result),
        failed=sum(member.outcome is None for member in (verdict.band or run_result.Band()).members),
        to_overturn=run_result.to_overturn(bool(verdict.neighbours)),
        figure_in_words=figure_in_words,
        motion_in_words=motion_in_words,
        seen=visible_number,
        CRUSHED=CRUSHED,
    )


def _files(folder: Path) -> list[str]:
    """What to open; never wrapped, since people copy paths."""
    fields = folder / "fields" / "run.pvd"
    paraview = ["ParaView: no fields were written; output.fields_s > 0 writes them"]
    if fields.exists():
        paraview = ["ParaView: open this file, Apply, Warp By Vector displacement_m"]
        paraview += ["  (a smaller output.fields_s keeps more frames)", f"  {fields}"]
    return [*paraview, f"History: {folder / 'history.csv'}", f"All results: {folder / 'run.json'}"]
