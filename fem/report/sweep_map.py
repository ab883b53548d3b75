"""The map of a sweep's cells on its page: what the script `map.js` reads, and the choices above it.

Cells are numbered as in `table.csv`, the last axis the fastest. The map shows a number or a word for every cell:
numbers go in single precision; the values of axes and derived keys, from which the command of a cell is made, in full.
"""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.figures.paper_marks import LABEL, marks_of
from fem.figures.style import STATE_COLOURS, VERMILLION
from fem.html.units import typeset
from fem.report.animation import colour_scale, packed
from fem.results.errors import FolderError
from fem.results.figures import Place, Shown, figures_of
from fem.results.level import OF_THE_END, REGIME_UNSURE, SURE, UNSURE
from fem.runtime import units
from fem.runtime.identity import command_line
from fem.study.axes import axis_label
from fem.study.maps import SHARE_COLOURS, shares_of
from fem.study.sweep_table import RATIOS, SweepTable

#: what can be shown, by column
QUANTITIES = figures_of(Place.MAP) | RATIOS | {"wall_s": Shown("computing time", units.SECONDS)}
#: shown by a colour for every word; the last in folders of earlier versions
FLAGS = (("overturned_share", "variations that do not stand"), ("sure", "how sure"), ("unsure", "unsure"))
SURENESS = {SURE: "#e3e8ee", OF_THE_END: "#f2c879", UNSURE: "#c2410c", "not tried": "#ffffff"}
NEEDED = 3  #: of these, in the order above: without them no page is made
MOST_BYTES = 3_600_000  #: of all columns, in base64
COLOURS = 64
#: outcome, words for it, its colour, and whether there is an outcome
OUTCOMES = (
    *((name, name, colour, True) for name, colour in STATE_COLOURS.items()),
    ("failed", "no outcome: failed", VERMILLION, False),
    ("", "not computed", "#FFFFFF", False),
)


def shown_quantities(data: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Names and labels of what the map can show of these data."""
    known = {column["name"] for column in data["columns"]}
    figures = ((name, figure.on_map) for name, figure in QUANTITIES.items())
    quantities = (FLAGS[0], ("outcome", "outcome"), *FLAGS[1:], *figures)
    return [(name, label) for name, label in quantities if name in known]


def map_data(table: SweepTable, folder: Path) -> dict[str, Any]:
    """What the script `map.js` reads.

    Raises:
        FolderError: more cells than one page can carry.
    """
    outcomes = outcome_numbers(table)
    outcome: dict[str, Any] = {
        "name": "outcome",
        "label": "outcome",
        "unit": "",
        "factor": 1.0,
        "words": True,
    }
    columns: list[dict[str, Any]] = [outcome | {"values": packed(outcomes, "u1")}]
    if _has(table, "unsure"):
        columns += _sureness(table)
    room = MOST_BYTES - sum(len(column["values"]) for column in columns)
    for k, (name, figure) in enumerate(QUANTITIES.items()):
        if k >= 1 and not _has(table, name):
            continue
        values = table.columns.get(name, np.full(len(table["cell"]), np.nan)).astype("<f4")
        column = outcome | {"name": name, "label": figure.on_map, "unit": typeset(figure.unit.name)}
        column |= {"factor": figure.unit.factor, "words": False, "values": packed(values, "<f4")}
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
            {"key": axis.key, "label": axis_label(axis), "values": list(axis.values)}
            | {"marks": list(marks_of(table.info.case, axis.key))}
            for axis in table.axes
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
        "marked": LABEL,
        "command": command_line("run", str(folder / "base.toml")),
    }


def outcome_numbers(table: SweepTable) -> NDArray[Any]:
    """The place in `OUTCOMES` of each cell's, (n_cells,)."""
    names = [name for name, *_ in OUTCOMES]
    return np.array(
        [names.index(word) if word in names else len(names) - 1 for word in map(str, table.outcome)]
    )


def _sureness(table: SweepTable) -> list[dict[str, Any]]:
    """How sure each cell is and what decides, as numbers of words; of earlier versions only whether it is unsure."""
    if "sure" not in table.columns:
        return [_words("unsure", "unsure", np.where(table["unsure"] == 1.0, UNSURE, SURE), SURENESS)]
    sure = np.where(table["sure"] == "", "not tried", table["sure"])
    # keys without their tables, but for the friction of loose joints, which has the names of the floor's
    keys = [str(inputs).split() for inputs in table["decided_by"]]
    short = [[key if key.startswith("joints.") else key.rpartition(".")[2] for key in one] for one in keys]
    deciding = [" ".join(one) or "-" for one in short]
    columns = [
        _words("sure", "how sure", np.where(sure == REGIME_UNSURE, OF_THE_END, sure), SURENESS),
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


def _has(table: SweepTable, name: str) -> bool:
    return name in table.columns and bool(np.isfinite(table[name].astype(float)).any())


def _plain(values: NDArray[Any]) -> list[Any]:
    """Numbers as they are, and "auto" for what is no number."""
    return [float(value) if np.isfinite(value) else "auto" for value in values.astype(float)]
