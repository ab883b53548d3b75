"""`sweep`: many cases, from a sweep file to a table and maps."""

import importlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from fem.batch.answers import table_lines
from fem.cli.console import EXIT_CODES, Folder, Force, Jobs, Quiet, Resume, Scheduler, connected, flag
from fem.results.files import to_json
from fem.runtime.progress import ScreenReporter
from fem.sweep.file import load_sweep


def sweep(
    sweep: str,
    /,
    *,
    out: Folder = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    force: Force = False,
    as_json: Annotated[bool, flag("Print sweep.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Compute the cases of a sweep: where does the container rest, slide, rock or overturn?

    Parameters
    ----------
    sweep:
        A sweep file or the name of a shipped sweep (see `python -m fem list`).
    """
    asked = load_sweep(sweep)
    folder = out if out is not None else Path("outputs") / asked.name
    # Loaded late: bad input is refused before anything is compiled.
    solver = importlib.import_module("fem.sweep.run")
    with connected(scheduler) as workers_of:
        info = solver.run_sweep(
            asked,
            folder,
            jobs=jobs,
            workers_of=workers_of,
            resume=resume,
            force=force,
            reporter=ScreenReporter(quiet=quiet),
        )
    print(to_json(info).rstrip() if as_json else page_of(json.loads(to_json(info)), folder))
    return EXIT_CODES[info["status"]]


def page_of(info: dict[str, Any], folder: Path) -> str:
    """The result of a sweep, for people."""
    title = f": {info['title']}" if info["title"] else ""
    lines = [f"{info['sweep']}{title}", f"  {info['rows']} of {info['cells']} cells, {info['status']}"]
    if info.get("motion_covered"):
        lines.append(f"  under {info['motion_covered']}")
    for outcome, count in info["outcomes"].items():
        lines.append(f"  {outcome:12} {count:>8}  {100.0 * count / max(info['rows'], 1):5.1f} %")
    held = info.get("held") or ""
    if sure := info.get("sure"):
        lines.append(f"  {held}" if held else "  of the outcomes")
        for word, count in sure.items():
            lines.append(f"  {word:13} {count:>7}  {100.0 * count / max(info['rows'], 1):5.1f} %")
        lines.append(f"  by {info['copies']} copies of {info['perturbed']} cells")
        if info["decided_by"]:
            named = ", ".join(f"{key} ({count})" for key, count in list(info["decided_by"].items())[:4])
            lines.append(f"  unsure cells are decided by {named}")
        if info["left_out"]:
            lines.append(f"  left out: {info['left_out']}")
    table = "rows.csv" if info["status"] == "interrupted" else "table.csv"
    lines.append(f"  {folder}: {table}, sweep.json" + "".join(f", {name}" for name in info["maps"]))
    if info["changes"] is not None:
        lines.append(
            f"  {folder}: thresholds.csv, {info['changes']} changes of outcome refined {held}".rstrip()
        )
    if info["status"] == "interrupted":
        lines.append("  --resume continues")
    return "\n".join([*lines, *_set_lines(info), *_answer_lines(info, folder)])


def _set_lines(info: dict[str, Any]) -> Iterator[str]:
    """What a set of motions did at each point of the other axes."""
    rows = info.get("motion_set") or ()
    yield from table_lines(((one["where"], one["in_words"]) for one in rows), "motion_set.csv")


def _answer_lines(info: dict[str, Any], folder: Path) -> Iterator[str]:
    """The sentence, and a row for each combination of values of the other axes."""
    if not info.get("answer"):
        return
    tables = importlib.import_module("fem.sweep.table")
    answer = importlib.import_module("fem.sweep.answers").sweep_answer(tables.open_sweep(folder), folder)
    if answer:
        yield from table_lines(answer.lines(), "answers.csv")
    yield info["answer"]
