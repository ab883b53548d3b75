"""Figures of the two checks of a run: the analytic rigid block, and the sensitivity to uncertain inputs (the band)."""

import math
import textwrap

import numpy as np
from matplotlib.figure import Figure

from fem.case.tables.unknown_inputs import WORDS
from fem.figures import style
from fem.results.figures import TURNED
from fem.results.level import sure_in_words
from fem.results.outcome import ENDINGS
from fem.results.reader import RunData
from fem.results.run_result import ChangedRun, RunAndBlock, Verdict
from fem.runtime.units import RATIO

FALLEN_ROW = 1.18  #: rotation ratio at which overturned members are drawn
LABELS = 2.1  #: height of the longest words for an input, upright, and the label below them [inch]
LINE_LENGTH = 105  #: characters of a line of text in a figure


def rigid_check_figure(run: RunData) -> Figure | None:
    """Rotation of run and analytic block with peaks, first impacts and difference; None without a check."""
    check, table = run.typed_result.rigid_check, run.rigid_check
    if table is None or check is None:
        return None
    time = table["time_s"]
    rotation, block = np.degrees(table["rotation_rad"]), np.degrees(table["analytic_rotation_rad"])
    reasons = "; ".join(check.reasons)
    fair = "A fair comparison" if check.meaningful else f"No fair comparison: {reasons}"
    ratio = check.velocity_ratio or RunAndBlock()
    if ratio.run is not None and ratio.block is not None:
        fair += f". Velocity ratio at the first impact: {ratio.run:.4f}, block {ratio.block:.4f}"
    lines = textwrap.wrap(f"{fair}.", LINE_LENGTH)
    figure, (above, below) = style.time_panels((2.4, 1.35), header=3 + len(lines))
    style.curve_panel(
        above,
        "rotation [degrees]",
        time,
        (rotation, style.BLUE, "-", f"container, {run.case.solver.model} model"),
        (block, style.VERMILLION, "--", f"analytic {check.reference or 'rigid block'}"),
        zero=False,
    )
    for key, colour, marker in (("run", style.BLUE, "o"), ("block", style.VERMILLION, "x")):
        above.plot(
            [getattr(peak, f"{key}_s") for peak in check.peaks],
            [math.degrees(getattr(peak, f"{key}_rad")) for peak in check.peaks],
            marker,
            color=colour,
            fillstyle="none",
            markersize=6,
        )
    for key, colour, dashes in (("run", style.BLUE, (0, (1, 2))), ("block", style.VERMILLION, (0, (4, 3)))):
        impact = getattr(check.first_impact_s, key, None)
        if impact is not None:
            label = f"first impact, {'container' if key == 'run' else 'block'}: {impact:.4f} s"
            for axes in (above, below):
                axes.axvline(impact, color=colour, linestyle=dashes, linewidth=1.0, label=label)
                label = ""
    style.curve_panel(below, "difference [degrees]", time, (rotation - block, style.BLACK, "-", None))
    style.legend_above(above, columns=2)
    style.head(figure, "Comparison with the analytic rigid block", "\n".join(lines))
    return figure


def band_figure(run: RunData) -> Figure | None:
    """Largest rotation and slip of each run of the band, by what it changes; None without a band."""
    verdict = run.typed_result.verdict or Verdict()
    band = verdict.band
    if band is None or not band.members:
        return None
    groups: dict[str, list[ChangedRun]] = {}
    for member in band.members:
        key = next(iter(member.values or {}), "")
        what = f"{member.kind}s" if member.kind in ("pair", "draw") else WORDS.get(key, key) or "as given"
        groups.setdefault(what, []).append(member)
    figure, (above, below) = style.panels((2.2, 1.5), header=3, below=LABELS)
    # drawn at once: one by one takes 0.1 s
    alike: dict[tuple[bool, str], list[tuple[float, ChangedRun]]] = {}
    for position, members in enumerate(groups.values()):
        spread = np.linspace(-0.3, 0.3, len(members)) if len(members) > 1 else np.zeros(1)
        for offset, member in zip(spread, members, strict=True):
            look = member is band.members[0], member.outcome or ""
            alike.setdefault(look, []).append((position + offset, member))
    for (own, outcome), marks in alike.items():
        places = [place for place, _ in marks]
        for axes, heights in (
            (above, [_height(member) for _, member in marks]),
            (below, [1e3 * member.slipped_most for _, member in marks]),
        ):
            axes.plot(
                places,
                heights,
                marker="o" if outcome else "x",
                color=style.STATE_COLOURS.get(outcome, style.VERMILLION),
                markeredgecolor=style.BLACK if outcome else style.VERMILLION,
                markersize=9 if own else 5,
                linestyle="none",
            )
    for outcome in band.outcomes:
        above.plot([], [], "o", color=style.STATE_COLOURS[outcome], markersize=8, label=outcome)
    if any(member.outcome is None for member in band.members):
        above.plot([], [], "x", color=style.VERMILLION, label="the solution failed")
    above.axhline(1.0, color=style.BLACK, linestyle="-.", linewidth=1.0, label="slenderness angle")
    above.set_ylim(0.0, 1.3)
    above.set_ylabel("rotation ratio [-]")
    below.set_ylim(bottom=0.0)
    below.set_ylabel("largest slip of a box [mm]" if run.verdict.boxes else "largest slip [mm]")
    above.set_xticks(range(len(groups)), [])
    below.set_xticks(range(len(groups)), list(groups), fontsize=7.0, rotation=90.0)
    below.set_xlabel("changed input, or several at once [-]")
    for axes in (above, below):
        axes.set_xlim(-0.6, len(groups) - 0.4)
    style.legend_above(above, columns=4)
    sure = sure_in_words(run.typed_result) or ("unsure" if band.unsure else "the same outcome throughout")
    low, high = band[TURNED] or (0.0, 0.0)
    ratios = " to ".join(map(RATIO.text, (low, high)))
    statement = f"rotation ratio {ratios}; the large mark is the run itself"
    style.head(figure, f"Variations of the inputs, {sure}: {' or '.join(band.outcomes)}", statement)
    return figure


def _height(member: ChangedRun) -> float:
    if member.outcome is None:
        return 0.0
    return FALLEN_ROW if member.outcome in ENDINGS else min(member.turned, FALLEN_ROW)
