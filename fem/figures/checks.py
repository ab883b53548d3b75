"""Figures of the two checks of a run: the analytic rigid block, and the sensitivity to the contact (the band)."""

import math
import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fem.assessment.summary import ratio_in_words
from fem.figures.style import (
    BLACK,
    BLUE,
    STATE_COLOURS,
    VERMILLION,
    curve_panel,
    head,
    legend_above,
    panels,
    time_panels,
)
from fem.results.reader import OpenedRun

FALLEN_ROW = 1.18  #: rotation ratio at which overturned members are drawn
LINE_LENGTH = 105  #: characters of a line of text in a figure
MARKERS = "osD^vP"


def rigid_check_figure(run: OpenedRun) -> Figure | None:
    """Rotation of run and analytic block with peaks, first impacts and difference; None without a check."""
    check, table = run.result.get("rigid_check") or {}, run.rigid_check
    if table is None or not check:
        return None
    time = table["time_s"]
    found, block = np.degrees(table["rotation_rad"]), np.degrees(table["analytic_rotation_rad"])
    reasons = "; ".join(check.get("reasons") or ())
    fair = "A fair comparison" if check.get("meaningful") else f"No fair comparison: {reasons}"
    lines = textwrap.wrap(f"{fair}.{_ratios(check)}", LINE_LENGTH)
    figure, (above, below) = time_panels((2.4, 1.35), header=3 + len(lines))
    curve_panel(
        above,
        "rotation [degrees]",
        time,
        (found, BLUE, "-", f"container, {run.case.solver.model} model"),
        (block, VERMILLION, "--", f"analytic {check.get('reference') or 'rigid block'}"),
        zero=False,
    )
    peaks = check.get("peaks") or ()
    for key, colour, marker in (("run", BLUE, "o"), ("block", VERMILLION, "x")):
        above.plot(
            [peak[f"{key}_s"] for peak in peaks],
            [math.degrees(peak[f"{key}_rad"]) for peak in peaks],
            marker,
            color=colour,
            fillstyle="none",
            markersize=6,
        )
    for key, colour, style in (("run", BLUE, (0, (1, 2))), ("block", VERMILLION, (0, (4, 3)))):
        impact = (check.get("first_impact_s") or {}).get(key)
        if impact is not None:
            label = f"first impact, {'container' if key == 'run' else 'block'}: {impact:.4f} s"
            for axes in (above, below):
                axes.axvline(impact, color=colour, linestyle=style, linewidth=1.0, label=label)
                label = ""
    curve_panel(below, "difference [degrees]", time, (found - block, BLACK, "-", None))
    legend_above(above, columns=2)
    head(figure, "Comparison with the analytic rigid block", "\n".join(lines))
    return figure


def band_figure(run: OpenedRun) -> Figure | None:
    """Largest rotation of each run of the band over its contact penalty; None without a band."""
    band = (run.result.get("verdict") or {}).get("band") or {}
    members = band.get("members") or ()
    if not members:
        return None
    own = float(members[0]["normal_penalty_Pa_m"])  # the first member is the run itself
    dampings = sorted({float(member["damping_ratio"]) for member in members})
    figure, (axes,) = panels((2.7,), right=2.0, header=2)
    for member in members:
        column = dampings.index(float(member["damping_ratio"]))
        # Side by side, so that equal results do not hide each other.
        place = float(member["normal_penalty_Pa_m"]) / own * 1.08 ** (column - 0.5 * (len(dampings) - 1))
        axes.plot(
            place,
            _height(member),
            marker=MARKERS[column % len(MARKERS)] if member["outcome"] else "x",
            color=STATE_COLOURS.get(member["outcome"], VERMILLION),
            markeredgecolor=BLACK,
            markersize=11 if member is members[0] else 7,
            linestyle="none",
        )
    for column, damping in enumerate(dampings):
        axes.plot(
            [], [], MARKERS[column % len(MARKERS)], color="white", markeredgecolor=BLACK,
            label=f"contact damping ratio {damping:g}",
        )  # fmt: skip
    for outcome in band.get("outcomes") or ():
        axes.plot([], [], "s", color=STATE_COLOURS[outcome], markersize=8, label=outcome)
    if any(member["outcome"] is None for member in members):
        axes.plot([], [], "x", color=VERMILLION, label="the solution failed")
    axes.axhline(1.0, color=BLACK, linestyle="-.", linewidth=1.0, label="slenderness angle")
    axes.set_xscale("log", base=3)
    axes.set_xticks([1.0 / 3.0, 1.0, 3.0], ["1/3", "1", "3"])
    axes.set_xticks([], minor=True)
    axes.set_xlim(0.25, 4.0)
    axes.set_ylim(0.0, 1.3)
    axes.set_xlabel(f"contact penalty over that of the run, {1e-9 * own:.3g} GN/m³ [-]")
    axes.set_ylabel("rotation ratio [-]")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    low, high = band["rotation_ratio"]
    outcomes = " or ".join(band.get("outcomes") or ())
    sure = "unsure" if band.get("unsure") else "the same outcome throughout"
    ratios = " to ".join(map(ratio_in_words, (low, high)))
    statement = f"rotation ratio {ratios}; the large mark is the run itself"
    head(figure, f"Band over the contact, {sure}: {outcomes}", statement)
    return figure


def _ratios(check: Mapping[str, Any]) -> str:
    ratio = check.get("velocity_ratio") or {}
    run, block = ratio.get("run"), ratio.get("block")
    if run is None or block is None:
        return ""
    return f" Velocity ratio at the first impact: {run:.4f}, block {block:.4f}."


def _height(member: Mapping[str, Any]) -> float:
    if member["outcome"] is None:
        return 0.0
    ratio = float(member["rotation_ratio"] or 0.0)
    return FALLEN_ROW if member["outcome"] == "overturned" else min(ratio, FALLEN_ROW)
