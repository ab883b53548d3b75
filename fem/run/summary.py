"""The summary of a run, on screen and in `summary.txt`: results first, the static rules beside them, then numerics.

Made from the result of a run alone, in units for people (kN, kNm, mm, degrees). Only the static rule under
this run's own peak floor acceleration is compared with the run. The code's base shear answers another question
and is shown below it. A summary states what happened under this motion, and under multiples of it where there is a
margin.
"""

import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from fem.results import run_result
from fem.results.figures import BRIEF, FIGURES, SUMMARY, TURNED, Place, summary_order
from fem.results.kinds import RUN
from fem.results.outcome import SLIDING, Outcome
from fem.run.card import card_of
from fem.run.described import code_note, fall_in_row, floor_rows, governing, motion_in_words, rule_says
from fem.run.joints import box_table, joint_tables, largest_joint_slip, table_by, titled_table
from fem.run.ranges import bolt_forces, in_words, largest_slip, of_band
from fem.run.words import rows, sentence
from fem.runtime.terminal import shown
from fem.runtime.units import MILLIMETRES, visible_number

TEXT_WIDTH = 80
CRUSHED = 1e-4  #: indentation from which a floor counts as crushed [m]


def plain_summary(result: run_result.RunResult, *, folder: Path) -> str:
    """The summary as text, in lines of at most 80 characters; a path stands on a line of its own, unbroken.

    Args:
        result: of the run; blocks that it did not reach may be missing.
        folder: of the run.
    """
    return "\n".join([*_lines(_parts(result, folder)), *_files(folder)]) + "\n"


def brief_summary(result: run_result.RunResult, *, folder: Path) -> str:
    """What the terminal shows after a run: verdict, ranges, the static rule of its own motion, where the rest is."""
    lines = _lines(_brief_parts(result, folder))
    count = len(result.warnings or ())
    noted = f", with {count} warning{'s' * (count > 1)}" if count else ""
    return "\n".join([*lines, f"Whole summary{noted}: {folder / 'summary.txt'}", *_files(folder)]) + "\n"


def _lines(parts: Iterator[RenderableType]) -> list[str]:
    console = Console(file=io.StringIO(), width=TEXT_WIDTH, color_system=None, highlight=False)
    with console.capture() as capture:
        console.print(*parts, sep="\n")
    return [line.rstrip() for line in shown(capture.get()).splitlines()]


def _brief_parts(result: run_result.RunResult, folder: Path) -> Iterator[RenderableType]:
    # Text, never markup: titles, folders and warnings may hold anything.
    yield from _heading(result, folder)
    verdict, motion = result.verdict or run_result.Verdict(), result.motion or run_result.MotionResult()
    yield from _table_of_pairs(_of_whom(verdict), _rows(result, "brief_results", BRIEF))
    of_record = (*motion.notes, *(motion.vertical.notes if motion.vertical else ()))
    if of_record:  # what was read is no detail
        yield Text("".join(f"Warning: {note}\n" for note in of_record))
    if result.static is not None:
        yield _static_table(replace(result.static, code=None, code_q1=None), to_compare(result))


def _heading(result: run_result.RunResult, folder: Path) -> Iterator[RenderableType]:
    """The title and the card."""
    yield Text(result.title or result.case or folder.name)
    yield Text("\n".join(card_of(result)) + "\n")


def _parts(result: run_result.RunResult, folder: Path) -> Iterator[RenderableType]:
    verdict = result.verdict or run_result.Verdict()
    yield from _heading(result, folder)
    yield from _table_of_pairs(_of_whom(verdict), result_rows(result))
    if result.static is not None:
        yield _static_table(result.static, to_compare(result))
        yield from (Text(f"{sentence}\n") for sentence in governing(result))
        if note := code_note(result.static):
            yield Text(f"{note}\n")
    yield from box_table(result)
    if result.joints:
        yield from joint_tables(result.joints, verdict)
    if note := band_note(verdict.band):
        yield Text(f"{note}\n")
    if result.warnings:
        yield Text("".join(f"Warning: {warning}\n" for warning in result.warnings))
    yield from _table_of_pairs("Numerics", _rows(result, "computation"))


def band_note(band: run_result.Band | None) -> str:
    """What the band tried and what its ranges are; empty where nothing was varied."""
    kinds = {member.kind for member in band.members[1:]} if band is not None else set()
    return sentence("summary.txt.j2", "band_note", kinds=kinds)


def to_compare(result: run_result.RunResult) -> run_result.Verdict:
    """What may be compared with a static rule, which takes the whole motion: nothing before the run has ended."""
    return (result.status in RUN.finished and result.verdict) or run_result.Verdict()


def _static_table(static: run_result.StaticResult, verdict: run_result.Verdict) -> Table:
    """Sliding and overturning under each action, one below the other."""

    def use(utilisation: float | None, demand: float | None) -> float | None:
        """A utilisation as `run.json` has it, where a demand without any capacity has none: infinite."""
        return math.inf if utilisation is None and demand else utilisation

    return table_by(
        "summary.txt.j2",
        "static_rules",
        static=static,
        own_motion=own_motion_name(static),
        use=use,
        seen=visible_number,
        rule_says=rule_says,
        found=partial(run_found, verdict),
    )


def own_motion_name(static: run_result.StaticResult) -> str:
    """The run's own peak floor acceleration, from the uplift acceleration and its utilisation; and the slope."""
    use = static.own_motion.utilisation_overturning if static.own_motion is not None else None
    uplift = static.uplift_acceleration_m_s2
    if use is None or uplift is None:
        return "own peak"
    downhill = static.downhill_m_s2 or 0.0
    slope = f" and {downhill:.3g} m/s2 downhill" if downhill else ""
    return f"own peak, {use * (uplift + downhill) - downhill:.3g} m/s2{slope}"


def run_found(verdict: run_result.Verdict, check: str) -> str:
    """What the run found, beside what the static rule says of `sliding`, `overturning` or `lifting`."""
    return sentence(
        "found.txt.j2",
        check,
        verdict=verdict,
        slip=largest_slip(verdict),
        between=largest_joint_slip(verdict)[0],
        ratio=of_band(verdict, TURNED),
        uplift=of_band(verdict, "max_uplift_m"),
        in_row=bool(fall_in_row(verdict)),
    )


def _of_whom(verdict: run_result.Verdict) -> str:
    """The title of the figures of a run."""
    return "The run, of the container itself" if verdict.neighbours else "The run"


def _table_of_pairs(title: str, rows: Sequence[tuple[str, str]]) -> Iterator[Table]:
    if rows:
        table = titled_table(title, "", "")
        for row in rows:
            table.add_row(*map(Text, row))
        yield table


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
        figure_in_words=in_words,
        motion_in_words=motion_in_words,
        seen=visible_number,
        CRUSHED=CRUSHED,
    )


def _files(folder: Path) -> list[str]:
    """What to open; never wrapped, since people copy paths."""
    fields = folder / "fields" / "run.pvd"
    paraview = (
        [
            "ParaView: open this file, Apply, Warp By Vector displacement_m",
            "  (a smaller output.fields_s keeps more frames)",
            f"  {fields}",
        ]
        if fields.exists()
        else ["ParaView: no fields were written; output.fields_s > 0 writes them"]
    )
    return [*paraview, f"History: {folder / 'history.csv'}", f"All results: {folder / 'run.json'}"]
