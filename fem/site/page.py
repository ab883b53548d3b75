"""The page of a verification at a site, set by `site.html.j2`: what its template is handed, and its figures."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem.figures import style
from fem.html.page import Page, Signature, html_of
from fem.html.units import ABSENT, number, short, typeset
from fem.results.errors import FolderError
from fem.results.figures import FIGURES, TURNED, Place, declared_in, keys_of
from fem.results.kinds import SITE
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import read_text
from fem.seismic.methods import floor_factor
from fem.site.answer import ended, span_in_words, unit_of
from fem.site.result import (
    BY_RULE,
    RESULT_FILE,
    FloorResult,
    MotionSet,
    RuleRange,
    ScanPoint,
    SiteActionResult,
    SiteAnswer,
    SiteInputs,
    SiteMethod,
    SiteMotion,
    SiteResult,
    SizeResult,
)
from fem.site.rule import groups_of
from fem.site.tables import MotionsTable
from fem.study.driver import read_study

COPIES = ("site.toml", "container.toml")  #: in the folder, printed on the page
MOST_DRAWN = 30  #: motions whose curves are on the page
LEAST_RATIO = 0.9  #: of the mean spectrum over the target, EN 1998-1:2004, 3.2.3.1.2 (4) c)
TICKS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)
COLOURS = {"overturning": style.VERMILLION, "sliding": style.BLUE, "slip": style.GREEN}
MARKERS = {"overturning": "o", "sliding": "s", "slip": "D"}
FACTORS = (0.1, 10.0)  #: factors that are drawn; beyond, an arrow


def site_report(
    folder: Path,
    result: SiteResult | None = None,
    *,
    signature: Signature | None = None,
    brief: bool = False,
) -> str:
    """The page, as the text of an HTML file; there is nothing to sign before the verification is finished.

    Args:
        folder: of the verification.
        result: of it; None: as its folder holds it.
        signature: author, checker, revision.
        brief: two printed sheets: that which is signed, and what the runs found.

    Raises:
        FolderError: the folder holds no result of `assess`, or it is damaged.
    """
    result = result or read_study(folder, SITE, SiteResult)
    document = asdict(result.document or Signature())
    page = Page(
        kind=f"Verification of an unanchored container{', short' if brief else ''}",
        title=result.title or folder.name,
        name=folder.name,
        hash=result.provenance.site_hash,
        signature=(signature or Signature()).completed(document) if result.to_be_signed else None,
    )
    return html_of(page, "site.html.j2", **shown(result, folder, brief=brief))


def shown(result: SiteResult, folder: Path, *, brief: bool = False) -> dict[str, Any]:
    """What the template names beside the result: its runs in groups, methods in rows, drawings, words of numbers."""
    answer, groups = result.result, groups_of(run for run in result.runs if run.stage == "set")
    governing = next((group for group in groups if answer.governing in group.runs), None)
    every = [(group, motion, runs) for group in groups for motion, runs in group.by_motion]
    moving = [row for row in every if any(run.outcome != Outcome.REST for run in row[2])]
    mass = answer.governing.mass if answer.governing else result.bodies[0].mass
    drawn = [row for row in result.methods if row.mass == mass and not row.beyond]
    tried = [point.factor for point in answer.scan]
    return {
        "result": result,
        "brief": brief,
        "standard": "EN 1998-1:2004",
        "FIGURES": FIGURES,
        "BY_RULE": BY_RULE,
        "of_motions": declared_in(SiteMotion),
        "further_keys": [key for key in keys_of(Place.RUNS) if key != TURNED],
        "confirmed_keys": keys_of(Place.KEY),
        "groups": groups,
        "governing": governing,
        "signs": sorted({run.vertical_sign for run in result.runs}, reverse=True) or [1],
        "every": {"moving": moving, "rest": len(every) - len(moving)},
        "merged_methods": merged_methods(result.methods),
        "drawn_methods": drawn if any(row.factor is not None for row in drawn) else [],
        "drawn_motions": [motion for motion in result.set.motions if motion.number <= MOST_DRAWN],
        "ended": ended(answer.confirmed),
        "tried": f"factors {short(tried[0])} to {short(tried[-1])} tried"
        if tried
        else "other factors not computed",
        "ranged": partial(ranged, answer),
        "copies": [(name, _text(folder / name)) for name in COPIES if (folder / name).is_file()],
        "default_seed": MotionsTable().seed,
        "figures": {
            function.__name__: function for function in (draw_spectra, draw_floor, draw_scan, draw_methods)
        },
        "motion_figure": partial(motion_figure, folder, result),
    }


def ranged(answer: SiteAnswer, key: str) -> str:
    """A figure of the rule, with the range that it has over the repetitions."""
    if answer[key] is None:
        return ABSENT
    text, ends = unit_of(key).text(answer[key], figures=2, bare=True), (answer.rule_range or RuleRange())[key]
    between = span_in_words(key, ends[0], ends[-1]) if ends else ""
    return typeset(f"{text} ({between})" if " to " in between else text)


def merged_methods(methods: Sequence[SiteMethod]) -> list[SiteMethod]:
    """The methods side by side; weights of which a method says the same, to three figures, share a row."""
    merged: dict[tuple[str, ...], list[SiteMethod]] = {}
    for method in methods:
        used = number(method.utilisation, figures=3)
        key = method.name, method.quantity, method.elevation, used, method.says, method.compared
        merged.setdefault(key, []).append(method)
    rows = []
    for same in merged.values():
        findings = {method.mass: method.found for method in same}
        alike = len(set(findings.values())) == 1
        words = same[0].found if alike else "; ".join(f"{mass}: {findings[mass]}" for mass in findings)
        rows.append(replace(same[0], mass=", ".join(method.mass for method in same), found=words))
    return rows


def _curve(path: Path) -> tuple[FloatArray, FloatArray]:
    try:
        values = np.array(list(csv.reader(read_text(path).splitlines()))[1:], dtype=np.float64)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error}); compute it again") from None
    return values[:, 0], values[:, 1]


def _text(path: Path) -> str:
    try:
        return read_text(path)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} cannot be read ({error})") from None


def draw_spectra(action: SiteActionResult, motions: MotionSet, floor: FloorResult | None) -> str:
    """Target, mean and every motion, with the 90 % line in the band; horizontal and, where there is one, vertical.

    Motions of a floor that are taken as they are have neither: their mean would be the target.
    """
    fitted, given = motions.source != "floor", floor is not None and floor.z_over_h is None
    rows = [(action.target_m_s2, action.mean_m_s2, "horizontal")]
    if action.vertical_target_m_s2:
        rows.append((action.vertical_target_m_s2, action.vertical_mean_m_s2, "vertical"))
    with style.house_style():
        tall, high = 2.85, 1.7
        figure = Figure(figsize=(style.WIDTH, tall))
        low, last = motions.band_s[0], motions.band_s[-1]
        style.head(
            figure,
            f"Response spectra {'of the floor' if given else 'at the ground'}, 5 % damping",
            f"the mean must not be below 90 % of the target from {low:g} to {last:g} s"
            if fitted
            else "the motions are taken as they are: nothing is demanded of their mean",
        )
        periods, gap = np.array(action.periods_s), 0.65
        inside = (periods >= low) & (periods <= last)
        width = (style.WIDTH - style.LEFT - style.RIGHT - gap * (len(rows) - 1)) / len(rows)
        for k, (target, mean, name) in enumerate(rows):
            axes = _panel(figure, style.LEFT + k * (width + gap), 0.45, width, high)
            if fitted:
                axes.axvspan(low, last, color=style.SKY, alpha=0.12, linewidth=0, label="band")
            look: dict[str, Any] = {"color": style.GREY, "linewidth": 0.6, "alpha": 0.7}
            for n, motion in enumerate(motions.motions):
                spectrum = motion["spectrum_m_s2" if k == 0 else "vertical_spectrum_m_s2"]
                axes.plot(periods, spectrum, label=None if n else "motions", **look)
            if fitted:
                axes.plot(periods, target, color=style.BLACK, linestyle="--", label="target")
                least = LEAST_RATIO * np.array(target)[inside]
                axes.plot(periods[inside], least, color=style.VERMILLION, linestyle=":", label="90 %")
            axes.plot(periods, mean, color=style.BLUE, linewidth=1.8, label="mean")
            _period_axis(axes, list(TICKS))
            axes.set_xlabel("period [s]")
            axes.set_ylabel(f"{name} [m/s²]", labelpad=2)
            axes.set_ylim(bottom=0.0)
            if k == 0:
                style.legend_above(axes, columns=5)
        return style.svg_of(figure)


def draw_floor(action: SiteActionResult, floor: FloorResult) -> str:
    """Mean spectrum of the floor, with that of the ground and what formula (4.25) gives an element."""
    with style.house_style():
        figure, (axes,) = style.panels((2.0,), header=3)
        first = floor.building_periods_s[len(floor.building_periods_s) // 2]
        style.head(
            figure,
            f"Response spectra of the floor at z/H = {floor.z_over_h:g}, 5 % damping",
            "mean over the motions, for the period of the building with the largest peaks",
        )
        periods = np.array(action.periods_s)
        formula = action.ag_S_m_s2 * np.array(
            [floor_factor(floor.z_over_h or 0.0, period / first) for period in action.periods_s]
        )
        axes.plot(periods, floor.mean_m_s2, color=style.BLUE, linewidth=1.8, label="floor, mean")
        axes.plot(periods, action.mean_m_s2, color=style.GREY, label="ground, mean")
        axes.plot(periods, formula, color=style.ORANGE, linestyle="--", label="formula (4.25), not a target")
        _period_axis(axes, list(TICKS))
        axes.set_xlabel("period of an element [s]")
        axes.set_ylabel("horizontal [m/s²]")
        axes.set_ylim(bottom=0.0)
        style.legend_above(axes)
        return style.svg_of(figure)


def motion_figure(folder: Path, result: SiteResult, motion: SiteMotion) -> str:
    """The curves of a motion over time, from its files, and its spectra beside the targets."""
    action = result.action
    files = {name[-5:]: folder / name for name in motion.files if name.endswith(".csv")}
    if "h.csv" not in files:
        raise FolderError(f"{folder / RESULT_FILE}: motion {motion.number} has no curve; compute it again")
    times, horizontal = _curve(files["h.csv"])
    vertical = _curve(files["v.csv"])[1] if "v.csv" in files else None
    with style.house_style():
        tall, share = 2.5, 0.6
        figure = Figure(figsize=(style.WIDTH, tall))
        width = share * style.WIDTH - style.LEFT
        count = 1 if vertical is None else 2
        each = (tall - 0.75 - 0.1 * (count - 1)) / count
        style.head(figure, f"Motion {motion.number}: {motion.origin}")
        for k, (values, name) in enumerate(((horizontal, "horizontal"), (vertical, "vertical"))):
            if values is None:
                continue
            bottom = 0.45 + (count - 1 - k) * (each + 0.1)
            panel = _panel(figure, style.LEFT, bottom, width, each)
            style.curve_panel(
                panel, f"{name}\n[m/s²]", times, (values, style.BLUE if k == 0 else style.PURPLE, "-", None)
            )
            panel.yaxis.set_label_coords(-0.5 / width, 0.5)
            panel.tick_params(labelbottom=k == count - 1)
        panel.set_xlabel("time [s]")
        left = share * style.WIDTH + 0.65
        spectra = _panel(figure, left, 0.45, style.WIDTH - left - 0.15, tall - 0.95)
        periods = np.array(action.periods_s)
        spectra.plot(periods, action.target_m_s2, color=style.BLACK, linestyle="--", label="target")
        spectra.plot(periods, motion.spectrum_m_s2, color=style.BLUE, label="horizontal")
        if motion.vertical_spectrum_m_s2:
            spectra.plot(periods, action.vertical_target_m_s2, color=style.BLACK, linestyle=":")
            spectra.plot(periods, motion.vertical_spectrum_m_s2, color=style.PURPLE, label="vertical")
        _period_axis(spectra, [0.05, 0.2, 1.0, 4.0])
        spectra.set_xlabel("period [s]")
        spectra.set_ylabel("spectrum [m/s²]", labelpad=2)
        spectra.set_ylim(bottom=0.0)
        spaced = {"borderaxespad": 0.1, "handlelength": 1.2, "columnspacing": 0.9}
        spectra.legend(loc="lower right", bbox_to_anchor=(1.04, 1.0), ncols=3, **spaced)
        return style.svg_of(figure)


def draw_scan(answer: SiteAnswer, inputs: SiteInputs) -> str:
    """Rotation, slip and the runs that overturned over the factor on the motions."""
    first = answer.factor_at_first_overturning
    statement = (
        "nothing overturned up to the largest factor tried"
        if first is None
        else f"first overturned at {first:.3g}; beyond, the body may stand again"
    )
    with style.house_style():
        figure, axes = _over(
            "The set times a factor", statement, "factor on the motions [-]", "factor", answer.scan, inputs
        )
        for panel in axes:
            panel.set_xlim(0.0, 1.03 * max((point.factor for point in answer.scan), default=1.0))
            panel.axvline(1.0, color=style.GREY, linewidth=0.9, linestyle="-.")
            if first is not None:
                panel.axvline(first, color=style.VERMILLION, linewidth=0.9, linestyle=":")
        return style.svg_of(figure)


def draw_size(size: SizeResult, inputs: SiteInputs) -> str:
    """Rotation, slip and the runs that overturned over the key that was varied; what fulfils the rule is shaded."""
    answer = size.sentence.partition(";")[0].rstrip(".")  # the islands are in the figure
    with style.house_style():
        figure, axes = _over("Which values fulfil the rule", answer, size.key, "value", size.points, inputs)
        for panel in axes:
            margin = 0.02 * (size.high - size.low)
            panel.set_xlim(size.low - margin, size.high + margin)
            for low, high in size.intervals:
                panel.axvspan(low, high, color=style.GREEN, alpha=0.12, linewidth=0)
                panel.axvline(low, color=style.GREEN, linewidth=0.7)
                panel.axvline(high, color=style.GREEN, linewidth=0.7)
        return style.svg_of(figure)


def _over(
    title: str,
    statement: str,
    label: str,
    along: str,
    points: Sequence[ScanPoint | Mapping[str, Any]],
    inputs: SiteInputs,
) -> tuple[Figure, list[Axes]]:
    """Three panels over a value: rotation ratio and slip with their limits, and the share that did not stand."""
    values = [point[along] for point in points]
    figure, (tilt, slip, fell) = style.panels([1.3, 1.1, 0.9], gaps=[0.12, 0.12], header=3)
    style.head(figure, title, statement)
    _limited(tilt, values, [point["rotation_ratio"] for point in points], inputs.rotation_ratio_limit)
    tilt.set_ylabel("rotation ratio [-]")
    slips = [None if point["slip_m"] is None else 1e3 * point["slip_m"] for point in points]
    _limited(slip, values, slips, 1e3 * inputs.slip_limit_m)
    slip.set_ylabel("slip in plane [mm]")
    share = [100.0 * (point["overturned"] + point["invalid"]) / max(point["runs"], 1) for point in points]
    fell.vlines(values, 0.0, share, color=style.VERMILLION, linewidth=3.0)
    fell.plot(values, share, color=style.VERMILLION, marker="o", markersize=3.0, linestyle="none")
    fell.set_ylabel("not standing [%]" if any(point["invalid"] for point in points) else "overturned [%]")
    fell.set_ylim(-3.0, max(10.0, 1.1 * max(share, default=0.0)))
    fell.set_xlabel(label)
    for panel in (tilt, slip):
        panel.tick_params(labelbottom=False)
    style.legend_above(tilt)
    return figure, [tilt, slip, fell]


def draw_methods(methods: Sequence[SiteMethod], answer: SiteAnswer, name: str) -> str:
    """Capacity over strength by each method: the factor on the action at which it is used up."""
    drawn = sorted(
        (method for method in methods if method.factor is not None),
        key=lambda method: list(COLOURS).index(method.quantity),
    )
    with style.house_style():
        figure, (axes,) = style.panels([0.17 * len(drawn) + 0.1], header=3, width=style.WIDTH)
        box = axes.get_position()
        axes.set_position((0.47, box.y0, 0.50, box.height))
        style.head(
            figure,
            f"Capacity over strength by each method, {name}",
            "factor on the action at which it is used up",
        )
        axes.axvline(1.0, color=style.GREY, linewidth=0.9, linestyle="-.", label="action of the site")
        if (first := answer.factor_at_first_overturning) is not None:
            axes.axvline(first, color=style.VERMILLION, linestyle=":", label="runs: first overturned")
        for row, method in enumerate(drawn):
            factor = method.factor or 0.0
            x = min(max(factor, FACTORS[0]), FACTORS[1])
            marker = "<" if factor < FACTORS[0] else ">" if factor > FACTORS[1] else MARKERS[method.quantity]
            axes.plot([FACTORS[0], x], [row, row], color="#DDDDDD", linewidth=0.8, zorder=1)
            axes.plot(x, row, color=COLOURS[method.quantity], marker=marker, markersize=4.5, linestyle="none")
        for quantity, colour in COLOURS.items():
            (dot,) = axes.plot([], [], color=colour, marker=MARKERS[quantity], markersize=4.5, label=quantity)
            dot.set_linestyle("none")
        labels = [f"{method.name}, {method.quantity}" for method in drawn]
        axes.set_yticks(range(len(drawn)), labels, fontsize=7)
        axes.set_ylim(len(drawn) - 0.4, -0.6)
        axes.set_xscale("log")
        axes.set_xlim(0.95 * FACTORS[0], 1.06 * FACTORS[1])
        axes.set_xticks([0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0], ["0.1", "0.2", "0.5", "1", "2", "5", "10"])
        axes.minorticks_off()
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("capacity over strength [-]")
        axes.legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=5, borderaxespad=0.1, handlelength=1.4
        )
        return style.svg_of(figure)


def _panel(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Axes in a figure, by their place in inches."""
    wide, tall = figure.get_size_inches()
    return figure.add_axes((left / wide, bottom / tall, width / wide, height / tall))


def _period_axis(axes: Axes, ticks: list[float]) -> None:
    axes.set_xscale("log")
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()


def _limited(axes: Axes, factors: Sequence[float], values: Sequence[float | None], limit: float) -> None:
    """Values over the factor with their limit; a gap where none is known, because something overturned."""
    known = np.array([np.nan if value is None else value for value in values], dtype=float)
    axes.plot(factors, known, color=style.BLUE, marker="o", markersize=3.5, label="by the rule")
    axes.axhline(limit, color=style.ORANGE, linestyle="--", label="limit")
    finite = known[np.isfinite(known)]
    axes.set_ylim(0.0, 1.1 * max(limit, float(finite.max(initial=0.0))))
    style.zero_line(axes)
