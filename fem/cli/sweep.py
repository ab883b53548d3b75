"""`sweep`: many cases, from a sweep file to a table and maps."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from fem.cli.console import STUDY, StudyFlags, print_result
from fem.results.kinds import SWEEP
from fem.study.answers import table_lines
from fem.study.file import load_sweep

if TYPE_CHECKING:
    from fem.study.sweep_table import SweepResult


def sweep(sweep: str, /, *, flags: StudyFlags = STUDY) -> int:
    """Compute the cases of a sweep: where does the container rest, slide, rock or overturn?

    Parameters
    ----------
    sweep:
        A sweep file or the name of a shipped sweep (see `python -m fem list`).
    """
    plan = load_sweep(sweep)
    folder = flags.folder(plan.name)
    solver = importlib.import_module("fem.study.sweep")
    with flags.options() as options:
        info = solver.run_sweep(plan, folder, **options)
    return print_result(info, SWEEP, folder, page_of(info, folder), as_json=flags.as_json)


def page_of(info: "SweepResult", folder: Path) -> Iterator[str]:
    """The lines of a sweep, for people."""
    yield f"{info.sweep}{f': {info.title}' if info.title else ''}"
    yield f"  {info.rows} of {info.cells} cells, {info.status}"
    if info.motion_covered:
        yield f"  under {info.motion_covered}"
    for outcome, count in info.outcomes.items():
        yield f"  {outcome:12} {count:>8}  {100.0 * count / max(info.rows, 1):5.1f} %"
    if info.sure:
        yield f"  {info.held or 'of the outcomes'}"
        for word, count in info.sure.items():
            yield f"  {word:13} {count:>7}  {100.0 * count / max(info.rows, 1):5.1f} %"
        yield f"  by {info.copies} copies of {info.perturbed} cells"
        if info.decided_by:
            named = ", ".join(f"{key} ({count})" for key, count in list(info.decided_by.items())[:4])
            yield f"  unsure cells are decided by {named}"
        if info.left_out:
            yield f"  left out: {info.left_out}"
    table = "table.csv" if info.state == "finished" else "rows.csv"
    yield f"  {folder}: {table}, sweep.json" + "".join(f", {name}" for name in info.maps)
    if info.changes is not None:
        yield f"  {folder}: thresholds.csv, {info.changes} changes of outcome refined {info.held}".rstrip()
    if info.answer:
        tables = importlib.import_module("fem.study.sweep_table")
        answer = importlib.import_module("fem.study.sweep_table").sweep_answer(
            tables.open_sweep(folder), folder
        )
        yield from table_lines(answer.lines() if answer else (), "answers.csv")
