"""What the map of a sweep's report shows: a number or a word for every cell, small enough to be sent.

Cells are numbered as in `table.csv`, the last axis the fastest. Numbers go in single precision; the values of
axes and derived keys, from which the command of a cell is made, in full.
"""

import shlex
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from numpy.typing import NDArray

from fem.figures.style import STATE_COLOURS, VERMILLION
from fem.report.animation import packed
from fem.results.run_folder import FolderError
from fem.sweep.table import SweepTable

#: what can be shown: column, words for it, unit, factor
QUANTITIES = (
    ("rotation_ratio", "rotation ratio", "", 1.0),
    ("max_slip_m", "largest slip", "mm", 1e3),
    ("residual_slip_m", "slip left at the end", "mm", 1e3),
    ("max_uplift_m", "largest uplift", "mm", 1e3),
    ("impacts", "impacts", "", 1.0),
    ("first_uplift_s", "first uplift", "s", 1.0),
    ("overturned_at_s", "overturned at", "s", 1.0),
    ("max_corner_force_N", "largest corner force", "kN", 1e-3),
    ("max_acceleration_m_s2", "acceleration of the contents", "m/s²", 1.0),
    ("max_von_mises_Pa", "von Mises stress", "MPa", 1e-6),
    ("band_rotation_ratio_low", "rotation ratio, perturbed, least", "", 1.0),
    ("band_rotation_ratio_high", "rotation ratio, perturbed, most", "", 1.0),
    ("wall_s", "computing time", "s", 1.0),
)
NEEDED = 3  #: of these, in the order above, a page without which is not made
MOST_BYTES = 3_600_000  #: of all columns, in base64
COLOURS = 64
COLOUR_MAP = "viridis"
#: how an outcome is shown: its word, its colour, and whether anything was found
OUTCOMES = (
    *((name, name, colour, True) for name, colour in STATE_COLOURS.items()),
    ("failed", "no outcome: failed", VERMILLION, False),
    ("", "not computed", "#FFFFFF", False),
)


def map_data(table: SweepTable, folder: Path) -> dict[str, Any]:
    """What the script `map.js` reads.

    Raises:
        FolderError: more cells than one page can carry.
    """
    names = [name for name, *_ in OUTCOMES]
    found = np.array(
        [names.index(str(word)) if str(word) in names else len(names) - 1 for word in table.outcome]
    )
    columns: list[dict[str, Any]] = [
        {
            "name": "outcome",
            "label": "outcome",
            "unit": "",
            "factor": 1.0,
            "words": True,
            "values": packed(found, "u1"),
        }
    ]
    if _has(table, "unsure"):
        columns.append(_column(table, "unsure", "unsure", "", 1.0) | {"flag": True})
    room = MOST_BYTES - sum(len(one["values"]) for one in columns)
    for k, (name, label, unit, factor) in enumerate(QUANTITIES):
        if k >= 1 and not _has(table, name):
            continue
        column = _column(table, name, label, unit, factor)
        room -= len(column["values"])
        if room < 0 and k < NEEDED:
            raise FolderError(
                f"{folder}: {len(found)} cells are more than one page can carry; table.csv holds them, and a "
                "sweep with fewer values per axis can be reported"
            )
        if room >= 0:
            columns.append(column)
    return {
        "axes": [
            {"key": axis.key, "label": axis_label(axis.key, axis.unit), "values": list(axis.values)}
            for axis in table.axes
        ],
        "columns": columns,
        "derived": [{"key": key, "values": _plain(table[key])} for key in table.info["derived"]],
        "outcomes": [
            {"name": name, "label": label, "colour": colour, "found": found_any}
            for name, label, colour, found_any in OUTCOMES
        ],
        "colours": _colours(),
        "command": f"python -m fem run {shlex.quote(str(folder / 'base.toml'))}",
    }


def axis_label(key: str, unit: str) -> str:
    """A key as people read it: contact.mu_static as `mu static`, with its unit."""
    name = key.rpartition(".")[2]
    plain = unit.replace("/", "_").replace("^", "").replace("·", "_")
    stem = name.removesuffix(f"_{plain}") if plain else name
    words = stem.replace("_", " ")
    return f"{words} [{unit.replace('m/s2', 'm/s²')}]" if unit else words


def counts(table: SweepTable) -> list[tuple[str, str, int, float]]:
    """Outcome, its colour, number of cells and their share, those that occur."""
    words = np.asarray(table.outcome).astype(str)
    rows = []
    for name, label, colour, _ in OUTCOMES:
        count = int(np.sum(words == name))
        if count:
            rows.append((label, colour, count, count / words.size))
    return rows


def failures(table: SweepTable, most: int = 20) -> list[tuple[int, str]]:
    """Cells without an outcome and why, the first of them."""
    failed = np.flatnonzero(np.asarray(table["status"]).astype(str) == "failed")[:most]
    return [(int(cell), str(table["reason"][cell])) for cell in failed]


def _has(table: SweepTable, name: str) -> bool:
    return name in table.columns and bool(np.isfinite(table[name].astype(float)).any())


def _column(table: SweepTable, name: str, label: str, unit: str, factor: float) -> dict[str, Any]:
    values: NDArray[Any] = table.columns.get(name, np.full(len(table["cell"]), np.nan)).astype("<f4")
    return {"name": name, "label": label, "unit": unit, "factor": factor, "values": packed(values, "<f4")}


def _plain(values: NDArray[Any]) -> list[Any]:
    """Numbers as they are; what is no number as text that changes nothing."""
    return [float(value) if np.isfinite(value) else "auto" for value in values.astype(float)]


def _colours() -> list[str]:
    scale = matplotlib.colormaps[COLOUR_MAP](np.linspace(0.0, 1.0, COLOURS))
    return [str(matplotlib.colors.to_hex(colour)) for colour in scale]
