"""`batch`: a list of containers, from a CSV file to the same list with results."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from fem.case.case import load_case
from fem.cli.console import PAGE, STUDY, AllowOutside, Overrides, StudyFlags, flag, print_result, print_short
from fem.results.figures import TURNED, Place, figures_of
from fem.results.kinds import HALL
from fem.results.outcome import Outcome
from fem.runtime.own_files import write_atomically
from fem.runtime.terminal import say
from fem.study.answers import table_lines

if TYPE_CHECKING:
    from fem.study.list_file import HallResult


def batch(
    hall: Path,
    /,
    *,
    case: Annotated[str, Parameter(show_default=False, help="The case that the rows change.")],
    motion: Annotated[
        tuple[str, ...],
        Parameter(
            name="--motion",
            consume_multiple=True,
            negative=(),
            show_default=False,
            help="Records in place of the motion of the case, anywhere, or pairs H,V; each container undergoes all.",
        ),
    ] = (),
    margins: Annotated[
        Literal["weakest", "all", "none"],
        Parameter(
            help="Whose run is repeated for sure and margin: the weakest tenth (at least 30), all, none."
        ),
    ] = "weakest",
    one_side: Annotated[bool, flag("Leave out a narrower side across; else the worse governs.")] = False,
    overrides: Overrides = (),
    allow_outside: AllowOutside = False,
    pdf: Annotated[bool, flag("Print the short page to report-short.pdf, by Chromium or Chrome.")] = False,
    flags: StudyFlags = STUDY,
) -> int:
    """Compute a list of containers: which rest, slide, rock or overturn, and which is the weakest?

    The header names keys of a case (width_m, mass_kg, mu_static, container.wall_m), name, count, tag; other columns are
    kept. A bad row is a row with its reason. Writes hall.csv, hall.json, report.html.

    Parameters
    ----------
    hall:
        The list, as CSV.
    """
    listed = importlib.import_module("fem.study.list_file").read_hall(hall)
    base = load_case(case, overrides, allow_outside=allow_outside)
    folder = flags.folder(listed.name)
    with flags.options() as options:
        result = importlib.import_module("fem.study.hall").run_hall(
            listed, base, folder, motions=motion, checks=margins, one_side=one_side, **options
        )
    page, pages = folder / PAGE, importlib.import_module("fem.report.study_page")
    if result.state == "finished" and not page.is_file():
        write_atomically(page, pages.hall_report(folder))
    if pdf and result.status == "completed":
        say(print_short(folder, pages.hall_report))
    return print_result(result, HALL, folder, page_of(result, folder), as_json=flags.as_json)


def page_of(result: "HallResult", folder: Path) -> Iterator[str]:
    """The lines of a hall, for people."""
    yield result.hall
    yield f"  {result.extent}, model {result.model}, {result.status}"
    if result.kept:
        yield f"  kept       {', '.join(result.kept)}"
    for outcome, count in result.outcomes.items():
        yield f"  {outcome:13} {count:>7}"
    if bad := [(f"row {row['row']} {row['name']}", row["reason"]) for row in result.not_computed]:
        yield f"  refused    {len(bad)} of {result.rows} rows"
        yield from table_lines(bad, "hall.csv")
    if result.checked and result.state == "finished":
        yield f"  sure and margin of the weakest {result.checked}"
    yield from table_lines([(row["name"], _row_in_words(row)) for row in result.ranked[:10]])
    written = ": hall.csv, hall.json, report.html" if result.state == "finished" else ""
    yield f"  files      {folder}{written}"


def _row_in_words(row: dict[str, object]) -> str:
    """A container in a line."""
    words = [str(row["outcome"] or row["reason"]) + " across its depth" * (row["side"] == "depth")]
    if isinstance(row["margin"], float):
        words.append(f"overturns from {row['margin']:.3g} times the motion on")
    elif isinstance(row["margin_tried_to"], float):
        words.append(f"does not overturn up to {row['margin_tried_to']:.3g} times the motion")
    for key, figure in figures_of(Place.KEY).items():
        if isinstance(value := row[key], float) and (key, row["outcome"]) != (TURNED, Outcome.OVERTURNED):
            words.append(f"{figure.head or figure.words} {figure.text(value)}")
    return ", ".join(words)
