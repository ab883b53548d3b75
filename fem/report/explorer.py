"""The explorer of a sweep: one page with a slider for each axis that shows what the run of the chosen cell did.

It shows computed cells alone: a slider stops at the values of its axis. Each cell is run once more, for its motion,
of which the page holds as many equidistant samples as it has room for, with 16 bits. x to the right, z up, rotation > 0
toward +x.
"""

from pathlib import Path
from typing import Any

import numpy as np

from fem.figures.paper_marks import LABEL, marks_of
from fem.html.page import Page, html_of
from fem.html.units import typeset
from fem.report.animation import packed, packed_floats
from fem.report.sweep_map import OUTCOMES, outcome_numbers
from fem.results.errors import FolderError
from fem.results.level import REGIME_UNSURE, SURE, UNSURE
from fem.results.outcome import ending_of
from fem.run.card import DOES, deciding_in_words, line
from fem.run.compute import Run
from fem.runtime.identity import command_line
from fem.study.axes import Axis, axis_name, in_words
from fem.study.design import Sweep
from fem.study.runner import compute_many
from fem.study.sweep_table import SweepTable, open_sweep

MOTION_BYTES = 3_600_000  #: of all motions, before base64 makes four thirds of it
LEAST_RATE = 10.0  #: samples a second; fewer do not show how a container rocks
AT_A_TIME = 100  #: runs in memory
#: what moves, by its column of the history; x and z of the mass centre, on the moving floor
COLUMNS = {
    "rotation": "rotation_rad",
    "x": "centre_x_m",
    "z": "centre_z_m",
    "base": "base_displacement_m",
}
#: of how many variations and what it does
SURENESS = {
    SURE: "Sure: it {does} in all {count} variations of its inputs, and in the same way.",
    REGIME_UNSURE: "Sure that it {does}, in all {count} variations of its inputs; not sure how it moves.",
    UNSURE: "Not sure: in some of {count} variations of its inputs it ends otherwise.",
}


def explorer(sweep: Sweep, folder: Path, jobs: int | None = None) -> str:
    """The page of a finished sweep, from the folder of its results, as the text of an HTML file.

    `jobs`: cores to use; default: all.

    Raises:
        FolderError: it is not finished, its containers are several bodies, or it has more cells than a page has room
            for.
    """
    table = open_sweep(folder)
    if table.info.state != "finished":
        raise FolderError(f"{folder}: the sweep is not finished; --resume continues it")
    samples = MOTION_BYTES // (2 * len(COLUMNS) * sweep.count)
    cells: list[dict[str, Any]] = []
    motion = np.zeros((len(COLUMNS), sweep.count, samples))
    for first in range(0, sweep.count, AT_A_TIME):
        chunk = range(first, min(first + AT_A_TIME, sweep.count))
        known = [cell for cell in chunk if table["status"][cell] != "failed"]
        cases = [sweep.make.case(sweep.item(cell)) for cell in known]
        if any(case.neighbour or case.container.is_loose for case in cases):
            raise FolderError(
                f"{folder}: the explorer draws one body; containers in a row and loose boxes are several"
            )
        runs = dict(zip(known, compute_many(cases, jobs, band=False, margin=False), strict=True))
        for cell in chunk:
            run, values = runs.get(cell), sweep.make.values(sweep.item(cell).point)
            changes = (word for key, value in values.items() for word in ("--set", f"{key}={value}"))
            command = command_line("run", str(folder / "base.toml"), *changes)
            cells.append({"command": command} | (_shown(run, table, cell) if run else {}))
            if run is None:
                continue
            if samples < LEAST_RATE * cells[-1]["end"]:
                raise FolderError(
                    f"{folder}: {sweep.count} cells of {cells[-1]['end']:g} s are more than one page can show; take "
                    "fewer values or a shorter solver.duration_s"
                )
            times = np.linspace(0.0, run.history["time_s"][-1], samples)
            motion[:, cell] = [
                np.interp(times, run.history["time_s"], run.history[name]) for name in COLUMNS.values()
            ]
    names = zip(COLUMNS, motion, strict=True)
    return html_of(
        Page(
            kind="Explorer",
            title=table.info.title or sweep.name,
            name=sweep.name,
            hash=table.info.sweep_hash,
            scripts=["explorer.js"],
            data={
                "explorer": {
                    "axes": [_axis(table, axis) for axis in table.axes],
                    "outcomes": [{"label": label, "colour": colour} for _, label, colour, _ in OUTCOMES],
                    "outcome": packed(outcome_numbers(table), "u1"),
                    "cells": cells,
                    "samples": samples,
                    "motion": {name: packed_floats(column.ravel()) for name, column in names},
                }
            },
        ),
        "explorer.html.j2",
        info=table.info,
        axes=[(axis_name(axis), len(axis.values) - 1) for axis in table.axes],
        marked=LABEL,
        rate=samples / max(cell.get("end", 1.0) for cell in cells),
    )


def _axis(table: SweepTable, axis: Axis) -> dict[str, Any]:
    """The values of an axis in words, and which of them are the paper's."""
    marks = marks_of(table.info.case, axis.key)
    return {
        "values": [typeset(in_words(axis, [value], 4)) for value in axis.values],
        "marks": [k for k, value in enumerate(axis.values) if any(np.isclose(value, mark) for mark in marks)],
    }


def _shown(run: Run, table: SweepTable, cell: int) -> dict[str, Any]:
    """What the page says of a cell, and the size of its container."""
    result, box = run.typed_result, run.case.container
    sure = SURENESS.get(str(table.columns["sure"][cell])) if "sure" in table.columns else None
    decided = str(table["decided_by"][cell]).split() if sure else []
    does = DOES[ending_of(str(table["status"][cell]), str(table["outcome"][cell]))]
    said = sure.format(does=does, count=int(table["perturbed"][cell])) if sure else "How sure: not tried."
    far, rule = line(result, "how_far"), line(result, "static_line")
    return {
        "first": result.verdict.first_line if result.verdict else "",
        "far": f"{far[:1].upper()}{far[1:]}.",
        "sure": f"{said} What decides: {deciding_in_words(decided)}." if decided else said,
        "rule": f"{rule[:1].upper()}{rule[1:]}.",
        "end": float(run.history["time_s"][-1]),
        "size": [box.width_m, box.height_m, box.boxes],
        "centre": [float(run.history[name][0]) for name in ("centre_x_m", "centre_z_m")],
    }
