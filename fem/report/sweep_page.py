"""The report of a sweep: the map with the values and the command of every cell, the request, what failed.

Cells are numbered as in `table.csv`, the last axis the fastest. The map shows a number or a word for every cell:
numbers go in single precision; the values of axes and derived keys, from which the command of a cell is made, in full.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from fem.assessment.sureness import REGIME_UNSURE, SURE, UNSURE
from fem.case.case import load_case
from fem.figures.style import STATE_COLOURS, VERMILLION
from fem.html import sections as html
from fem.html.page import Signature
from fem.html.units import ABSENT, millimetres, number, short, typeset
from fem.report import studies
from fem.report.animation import colour_scale, packed
from fem.report.comparison import case_rows
from fem.report.motion_part import motions_of_sweep
from fem.results.errors import FolderError
from fem.results.figures import Place, Shown, figures_of
from fem.runtime import units
from fem.runtime.identity import command_line
from fem.study.answers import ends_in_words, ranges_in_words
from fem.study.axes import axis_label, unit_in_words
from fem.study.maps import SHARE_COLOURS, shares_of
from fem.study.perturbation import input_in_words
from fem.study.sure import CHANGES, change_columns
from fem.study.sweep_table import RATIOS, AnswerRow, SweepAnswer, SweepTable, open_sweep, sweep_answer
from fem.study.table import read_rows

#: what can be shown, by column
QUANTITIES = figures_of(Place.MAP) | RATIOS | {"wall_s": Shown("computing time", units.SECONDS)}
#: shown by a colour for every word; the last in folders of earlier versions
FLAGS = (("overturned_share", "variations that do not stand"), ("sure", "how sure"), ("unsure", "unsure"))
SURENESS = {SURE: "#e3e8ee", REGIME_UNSURE: "#f2c879", UNSURE: "#c2410c", "not tried": "#ffffff"}
NEEDED = 3  #: of these, in the order above: without them no page is made
MOST_BYTES = 3_600_000  #: of all columns, in base64
COLOURS = 64
MOST_OPEN = 12  #: rows of answers that are not folded
#: outcome, words for it, its colour, and whether there is an outcome
OUTCOMES = (
    *((name, name, colour, True) for name, colour in STATE_COLOURS.items()),
    ("failed", "no outcome: failed", VERMILLION, False),
    ("", "not computed", "#FFFFFF", False),
)
SWATCH = Markup('<span class="swatch" style="background:{}"></span>{}')


def sweep_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of a sweep, it is damaged, or it holds more than one page can carry.
        CaseError: the base case in it cannot be read.
    """
    table = open_sweep(folder)
    info, case = table.info, load_case(str(folder / "base.toml"))
    on_screen = (name for name in table.info.maps if not name.endswith("_print.svg"))
    data, drawn = map_data(table, folder), studies.drawings(folder, on_screen, "sweep")
    answer, name = sweep_answer(table, folder), info.sweep or folder.name
    base_case = html.Pairs(case_rows(case), caption="Base case, where no axis changes it", look="asked")
    return studies.study_html(
        "a sweep",
        info=info,
        title=info.title,
        name=name,
        case=case,
        signature=signature,
        hash=info.sweep_hash,
        scripts=["map.js"],
        data={"sweep": data},
        sections=[
            found_section(table, answer.sentence if answer else None),
            html.section("Maps", "drawn", *drawn),
            html.section("How sure", "sure", *_sure_lines(table)),
            html.section("Cell by cell", "map-title", cell_map(table, data), look="screen" if drawn else ""),
            html.section(
                "The answer for each value of the other axes",
                "answers",
                *([answer_part(answer)] if answer and answer.others else []),
            ),
            motions_of_sweep(folder, table),
            html.section(
                "Counts", "counts", counts_table(table), *_failures(table), *_thresholds(folder, table)
            ),
            html.section(
                "The sweep", "asked", html.columns(studies.axes_table(table.axes, info.derived), base_case)
            ),
        ],
        provenance=[
            ("sweep", f"{name}, {info.status}, model {info.model}"),
            ("sweep hash", info.sweep_hash),
            ("base hash", info.base_hash),
        ],
        again=studies.again_from_files(folder, study="sweep", name=name, case=case),
    )


def found_section(table: SweepTable, answer: str | None) -> html.PageSection:
    """The answer, and how many cells have which outcome."""
    info, computed = table.info, int((table["status"] != "").sum())
    counted = ", ".join(f"{count} {label}" for label, _, count, _ in counts(table))
    return studies.answer_section(
        info,
        answer,
        f"{computed} of {info.cells} cells{studies.unfinished(info)}: {counted}.",
        *([f"Held fixed: {info.held}."] if info.held else []),
        note="What happened under these motions, in a study. Nothing is known between the cells: a region of "
        "overturning that is smaller than a cell is missed.",
    )


def _sure_lines(table: SweepTable) -> Iterator[str]:
    """How many cells are how sure, what their copies change, and which inputs decide."""
    info = table.info
    if not (sure := info.sure):
        if info.unsure is not None:
            yield (
                f"{info.unsure} cells are unsure: of {info.perturbed} perturbed cells, these stand or overturn "
                "depending on small changes of friction, amplitude, phase or contact damping."
            )
        return
    yield html.joined(
        "Cells that are ",
        html.strong(SURE),
        f", {sure[SURE]}: every copy has the same outcome; ",
        html.strong(REGIME_UNSURE),
        f", {sure[REGIME_UNSURE]}: no copy overturns, or all do, but they rest, slide or rock in different ways; ",
        html.strong(UNSURE),
        f", {info.unsure}: whether they stand depends on unknown inputs or on small changes of the motion, or is not "
        "known because a corner is destroyed or a copy failed.",
    )
    left_out = f" Left out: {info.left_out}." if info.left_out else ""
    yield (
        "A copy changes one input over its range, a pair of them or all at once, or the motion, "
        f"friction or damping a little: {info.copies} copies of {info.perturbed} cells.{left_out}"
    )
    if inputs := [f"{input_in_words(key)} ({count})" for key, count in deciding(table)]:
        yield f"Unsure cells are decided by {', '.join(inputs)}."


def cell_map(table: SweepTable, data: Mapping[str, Any]) -> html.CellMap:
    """The map, first over the one or two longest axes."""
    labels, known = [axis_label(axis) for axis in table.axes], {column["name"] for column in data["columns"]}
    longest = sorted(sorted(range(len(labels)), key=lambda k: -len(table.axes[k].values))[:2])
    quantities = (
        FLAGS[0],
        ("outcome", "outcome"),
        *FLAGS[1:],
        *((name, figure.on_map) for name, figure in QUANTITIES.items()),
    )
    return html.CellMap(
        [html.Choice(name, label) for name, label in quantities if name in known],
        *([html.Choice(k, label, k == first) for k, label in enumerate(labels)] for first in longest),
    )


def counts_table(table: SweepTable) -> html.Table:
    """How many cells have which outcome."""
    columns: list[html.Column[tuple[str, str, int, float]]] = [
        html.Column("outcome", lambda row: SWATCH.format(row[1], row[0])),
        html.Column("cells", lambda row: str(row[2]), html.NUMBER),
        html.Column("share", lambda row: f"{number(row[3], 100, 3)} %", html.NUMBER),
    ]
    return html.table_of("counts", columns, counts(table))


def answer_part(answer: SweepAnswer) -> html.Block:
    """The table of answers, folded where it is longer than a person reads at once."""
    table = answer_table(answer)
    return table if len(answer.rows) <= MOST_OPEN else html.Folded(f"All {len(answer.rows)} rows", [table])


def answer_table(answer: SweepAnswer) -> html.Table:
    """The answers: where, up to where it stood, where it first overturned, the slip, what else there is to say."""
    ends = ("stood up to", "first overturned at") if answer.rising else ("stood from", "overturned up to")
    unit = unit_in_words(answer.axis)
    up_to, first, again, failed, unsure = (
        f"{head} [{unit}]" if unit else head for head in (*ends, "stood again", "no outcome", "unsure")
    )

    def where(row: AnswerRow) -> str:
        return answer.where(row) + (": every motion" if len(row.point) < len(answer.others) else "")

    def end(k: int, row: AnswerRow) -> str:
        words = ends_in_words(row.answer, answer.axis, bare=True)[k] or ABSENT
        noted = "slid too far" if row.answer.slid else "a corner destroyed" if row.answer.invalid else ""
        return f"{words} ({noted})" if k == 1 and noted else words

    def slip(value: float | None) -> str:
        return "" if value is None else millimetres(value)

    def ranges(intervals: Sequence[tuple[float, float]]) -> str:
        return ranges_in_words(intervals, answer.axis, bare=True)

    columns: list[html.Column[AnswerRow]] = [
        html.Column("", where),
        html.Column(up_to, partial(end, 0)),
        html.Column("slip up to there [mm]", lambda row: slip(row.answer.stood_slip), optional=True),
        html.Column(first, partial(end, 1)),
        html.Column("slip there [mm]", lambda row: slip(row.answer.slip), optional=True),
        html.Column(again, lambda row: ranges(row.answer.stood_again), optional=True),
        html.Column(failed, lambda row: ranges(row.answer.failed), optional=True),
        html.Column(unsure, lambda row: ranges(row.answer.unsure), optional=True),
    ]
    return html.table_of("answers", columns, answer.rows, file="answers.csv")


def _failures(table: SweepTable) -> list[html.Block]:
    """Cells without an outcome, where there are any."""
    lines = [f"cell {cell}: {reason}" for cell, reason in failures(table)]
    return [html.Heading("Without an outcome"), html.Bullets(lines, "")] if lines else []


def _thresholds(folder: Path, table: SweepTable) -> list[html.Block]:
    """The refined changes of outcome, where they were asked for."""
    info = table.info
    path, along = folder / "thresholds.csv", (info.threshold or {}).get("axis", "")
    if not path.is_file():
        return []
    columns = change_columns(table.axes, along)
    try:
        rows = read_rows(path, columns)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path}: cannot be read ({error}); repeat the sweep with --force") from None
    unit = next((axis.unit for axis in info.axes if axis.key == along), "")

    def cell(name: str, row: Mapping[str, Any]) -> str:
        return short(row[name], figures=5) if columns[name] is float else row[name] or ""

    def head(name: str) -> str:
        return f"{name} [{unit}]" if unit and CHANGES.get(name) is float else name

    held = f"They hold {info.held}; a range of an unknown input moves them." if info.held else ""
    return [
        html.Heading("Changes of outcome, refined"),
        *([html.Note(held)] if held else []),
        html.table_of(
            "changes of outcome",
            [html.Column(head(name), partial(cell, name)) for name in columns],
            rows,
            file=path.name,
        ),
    ]


def map_data(table: SweepTable, folder: Path) -> dict[str, Any]:
    """What the script `map.js` reads.

    Raises:
        FolderError: more cells than one page can carry.
    """
    names = [name for name, *_ in OUTCOMES]
    outcomes = np.array(
        [names.index(str(word)) if str(word) in names else len(names) - 1 for word in table.outcome]
    )
    outcome = {"name": "outcome", "label": "outcome", "unit": "", "factor": 1.0, "words": True}
    columns: list[dict[str, Any]] = [outcome | {"values": packed(outcomes, "u1")}]
    if _has(table, "unsure"):
        columns += _sureness(table)
    room = MOST_BYTES - sum(len(column["values"]) for column in columns)
    for k, (name, figure) in enumerate(QUANTITIES.items()):
        if k >= 1 and not _has(table, name):
            continue
        column = _column(table, name, figure)
        room -= len(column["values"])
        if room < 0 and k < NEEDED:
            raise FolderError(
                f"{folder}: {len(outcomes)} cells are more than one page can carry; table.csv holds them; report a "
                "sweep with fewer values per axis"
            )
        if room >= 0:
            columns.append(column)
    return {
        "axes": [
            {"key": axis.key, "label": axis_label(axis), "values": list(axis.values)} for axis in table.axes
        ],
        "columns": columns,
        "derived": [
            *(
                {"key": key, "values": [str(word) or None for word in table[key]]}
                for axis in table.axes
                for key in axis.following
            ),
            *({"key": key, "values": _plain(table[key])} for key in table.info.derived),
        ],
        "outcomes": [
            {"name": name, "label": label, "colour": colour, "found": found_any}
            for name, label, colour, found_any in OUTCOMES
        ],
        "colours": colour_scale("viridis", COLOURS),
        "command": command_line("run", str(folder / "base.toml")),
    }


def _short_key(key: str) -> str:
    """A key without its table, unless the friction of loose joints, which has the names of the floor's."""
    return key if key.startswith("joints.") else key.rpartition(".")[2]


def _sureness(table: SweepTable) -> list[dict[str, Any]]:
    """How sure each cell is and what decides, as numbers of words; of earlier versions only whether it is unsure."""
    if "sure" not in table.columns:
        return [_words("unsure", "unsure", np.where(table["unsure"] == 1.0, UNSURE, SURE), SURENESS)]
    sure = np.where(table["sure"] == "", "not tried", table["sure"])
    deciding = [" ".join(map(_short_key, str(inputs).split())) or "-" for inputs in table["decided_by"]]
    columns = [
        _words("sure", "how sure", sure, SURENESS),
        _words("decided_by", "decided by", np.array(deciding), dict.fromkeys(sorted(set(deciding)), "")),
    ]
    if (shares := shares_of(table)) is not None:
        words = np.array(list(SHARE_COLOURS))[shares]
        columns.append(_words(*FLAGS[0], words, SHARE_COLOURS))
    return columns


def _words(name: str, label: str, values: NDArray[Any], colours: Mapping[str, str]) -> dict[str, Any]:
    """A column of words, as their places among those that have colours."""
    names = list(colours)
    indices = np.array([names.index(str(value)) for value in values], dtype="<f4")
    column = {"name": name, "label": label, "unit": "", "factor": 1.0, "names": names}
    return column | {"colours": list(colours.values()), "values": packed(indices, "<f4")}


def counts(table: SweepTable) -> list[tuple[str, str, int, float]]:
    """Outcome, its colour, number of cells and their share, those that occur."""
    tally = Counter(map(str, table.outcome))
    return [
        (label, colour, tally[name], tally[name] / tally.total())
        for name, label, colour, _ in OUTCOMES
        if tally[name]
    ]


def deciding(table: SweepTable) -> list[tuple[str, int]]:
    """The inputs that decide unsure cells, and how many each; none for a folder of an earlier version."""
    inputs = table.info.decided_by or {}
    return sorted(inputs.items(), key=lambda pair: -pair[1])


def failures(table: SweepTable) -> list[tuple[int, str]]:
    """The first 20 cells without an outcome, and why."""
    failed = np.flatnonzero(np.asarray(table["status"]).astype(str) == "failed")[:20]
    return [(int(cell), str(table["reason"][cell])) for cell in failed]


def _has(table: SweepTable, name: str) -> bool:
    return name in table.columns and bool(np.isfinite(table[name].astype(float)).any())


def _column(table: SweepTable, name: str, figure: Shown) -> dict[str, Any]:
    values: NDArray[Any] = table.columns.get(name, np.full(len(table["cell"]), np.nan)).astype("<f4")
    unit = figure.unit
    column = {"name": name, "label": figure.on_map, "unit": typeset(unit.name), "factor": unit.factor}
    return column | {"values": packed(values, "<f4")}


def _plain(values: NDArray[Any]) -> list[Any]:
    """Numbers as they are, and "auto" for what is no number."""
    return [float(value) if np.isfinite(value) else "auto" for value in values.astype(float)]
