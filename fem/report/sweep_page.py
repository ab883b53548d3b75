"""The report of a sweep: the map with the values and the command of every cell, what was asked, what failed."""

import csv
import datetime as dt
from importlib import metadata
from pathlib import Path

from markupsafe import Markup

from fem.case.case import load_case
from fem.html.page import Signature, render_page, svg_element
from fem.html.units import number, short, typeset
from fem.report.comparison import EXCLUSIONS, asked_rows, assumptions
from fem.report.sweep_data import QUANTITIES, axis_label, counts, failures, map_data
from fem.results.run_folder import FolderError
from fem.sweep.table import SweepTable, open_sweep

MOST_MAP_BYTES = 400_000  #: of a drawn map, as SVG


def sweep_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Args:
        folder: of the sweep, finished or not.
        signature: author, checker, revision.

    Raises:
        FolderError: it is no folder of a sweep, it is damaged, or it holds more than one page can carry.
        CaseError: the base case in it cannot be read.
    """
    table = open_sweep(folder)
    info, case = table.info, load_case(str(folder / "base.toml"))
    data = map_data(table, folder)
    known = {column["name"] for column in data["columns"]}
    return render_page(
        "sweep.html.j2",
        scripts=["map.js", "signature.js"],
        data={"sweep": data},
        title=info.get("title") or info.get("sweep") or folder.name,
        name=str(info.get("sweep") or folder.name),
        hash=str(info.get("sweep_hash") or ""),
        info=info,
        case=case,
        signature=signature or Signature(),
        asked=asked_rows(case),
        axes=[_axis_row(axis.key, axis.unit, axis.values, axis.scale) for axis in table.axes],
        labels=[axis_label(axis.key, axis.unit) for axis in table.axes],
        longest=_longest(table),
        quantities=[(name, label) for name, label, *_ in QUANTITIES if name in known],
        has_unsure="unsure" in known,
        counts=counts(table),
        computed=int((table["status"] != "").sum()),
        failures=failures(table),
        thresholds=_thresholds(folder / "thresholds.csv"),
        maps=_maps(folder, info.get("maps") or []),
        assumptions=assumptions({}, case),
        exclusions=EXCLUSIONS,
        version=metadata.version("unanchored"),
        today=dt.date.today().isoformat(),
        number=number,
        short=short,
    )


def _axis_row(key: str, unit: str, values: tuple[object, ...], scale: str) -> tuple[str, str, str]:
    """Key, values and their number."""
    first, last = values[0], values[-1]
    if scale in ("linear", "log") and isinstance(first, int | float) and isinstance(last, int | float):
        words = f"{short(first)} to {short(last)} {unit}, {scale}".replace(" ,", ",")
    else:
        words = ", ".join(str(value) for value in values[:12]) + (" ..." if len(values) > 12 else "")
        words += f" {unit}" if unit else ""
    return key, typeset(words), str(len(values))


def _longest(table: SweepTable) -> tuple[int, int]:
    """The two axes that are first shown: across and up; the second is -1 where there is one axis."""
    order = sorted(range(len(table.axes)), key=lambda k: -len(table.axes[k].values))
    if len(order) == 1:
        return order[0], -1
    across, up = sorted(order[:2])
    return across, up


def _thresholds(path: Path) -> tuple[list[str], list[list[str]]] | None:
    """Columns and rows of the refined changes of outcome, where they were asked for."""
    if not path.is_file():
        return None
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            header, *rows = list(csv.reader(stream))
    except (OSError, ValueError) as error:
        raise FolderError(f"{path}: cannot be read ({error}); sweep again with --force") from None
    return header, rows


def _maps(folder: Path, names: list[str]) -> list[Markup]:
    """Maps that the sweep has drawn, for paper and for browsers that run no scripts."""
    drawn = []
    for k, name in enumerate(names):
        path = folder / name
        inside = path.resolve().is_relative_to(folder.resolve())
        if inside and path.is_file() and path.stat().st_size <= MOST_MAP_BYTES:
            text = path.read_text(encoding="utf-8")
            try:
                drawn.append(svg_element(text, label=f"map: {path.stem.replace('_', ' ')}", prefix=f"map{k}"))
            except ValueError as error:
                raise FolderError(f"{path}: {error}; remove it and sweep again: it is drawn anew") from None
    return drawn
