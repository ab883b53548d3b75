"""The report of an ensemble: where half of the draws overturn, the curve or boundary, its points, the request."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from fem.case.case import load_case
from fem.html import sections as html
from fem.html.page import Signature
from fem.html.units import ABSENT, number, short, typeset
from fem.report import studies
from fem.report.comparison import case_rows
from fem.report.motion_part import motions_of_ensemble
from fem.results.figures import SLIPPED, Shown
from fem.results.kinds import ENSEMBLE
from fem.results.outcome import COUNTED
from fem.runtime import units
from fem.study.answers import (
    EnsembleAnswer,
    ensemble_answer,
    falling_in_words,
    fragility_lines,
    interval_in_words,
)
from fem.study.axes import Axis, axis_label, in_words, place_in_words
from fem.study.driver import read_study
from fem.study.fragility import EnsembleResult

STOOD = Shown("slip of those that stood", units.MILLIMETRES)
FIGURES = ("figures/fragility.svg", "figures/boundary.svg")


def ensemble_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of an ensemble, it is damaged, or nothing was counted yet.
        CaseError: the base case in it cannot be read.
    """
    info = read_study(folder, ENSEMBLE, EnsembleResult)
    case, axes = load_case(str(folder / "base.toml")), info.point_axes
    answer, name = ensemble_answer(info), info.ensemble or folder.name
    base_case = html.Pairs(case_rows(case), caption="Base case, where nothing changes it", look="asked")
    varied = html.Group("", [studies.axes_table(axes, info.derived), random_table(info)])
    return studies.study_html(
        "an ensemble",
        info=info,
        title=info.title,
        name=name,
        case=case,
        signature=signature,
        hash=info.asked,
        sections=[
            found_section(info, answer),
            html.section(
                "The answer for each value of the other axes",
                "answers",
                *([answer_table(answer, info)] if answer and answer.others else []),
            ),
            html.section(
                "Fragility curve" if len(axes) == 1 else "Boundary",
                "drawn",
                *studies.drawings(folder, FIGURES, "ensemble"),
            ),
            motions_of_ensemble(folder, info),
            html.section("The ensemble", "asked", html.columns(varied, base_case)),
            html.section("Points", "points", points_table(info)),
        ],
        provenance=[
            ("ensemble", f"{name}, {info.status}, model {info.model}"),
            ("draws", f"{info.draws} at each point, {info.sampling}, seed {info.seed}"),
            ("hash", info.asked),
        ],
        again=studies.again_from_files(folder, study="ensemble", name=name, case=case),
    )


def found_section(info: EnsembleResult, answer: EnsembleAnswer | None) -> html.PageSection:
    """The answer, how many points there are of each region, and the curve that was fitted."""
    words = region_labels(info)
    regions = ", ".join(f"{words[region]} at {count}" for region, count in info.regions.items() if count)
    motions = (
        "the motions of the set, each equally often" if info.motions else "the floor motion of the base case"
    )
    return studies.answer_section(
        info,
        answer.sentence if answer else None,
        f"{len(info.points)} points of {info.draws} draws{studies.unfinished(info)}"
        + (f"; share that {falling_in_words(info.limit_slip_m, past=True)}: {regions}." if regions else "."),
        *(typeset(f"{head}: {line}.") for head, line in fragility_lines(info)),
        *([f"Held fixed: {info.held}."] if info.held else []),
        note=f"A share of draws over the uncertain quantities listed below, under {motions}. It is not the probability "
        "of failure in an earthquake. Nothing is known between the points.",
    )


def region_labels(info: EnsembleResult) -> dict[str, str]:
    """The regions in words, as the share that overturns."""
    limit = f"{short(info.probability, 100.0)} %"
    return {"below": f"at most {limit}", "undecided": "not decided", "above": f"more than {limit}"}


def answer_table(answer: EnsembleAnswer, info: EnsembleResult) -> html.Table:
    """Where half of the draws overturn, for all values of the other axes."""

    def in_axis(value: float | None) -> str:
        return ABSENT if value is None else in_words(answer.axis, [value])

    few = f"at most {100.0 * info.probability:g} % {'up to' if answer.rising else 'from'}"
    rows = (
        [
            place_in_words(answer.others, point),
            f"{in_axis(crossing.value)}{' or before' if crossing.at_once else ''}",
            ABSENT
            if crossing.value is None
            else interval_in_words(answer.axis, crossing, rising=answer.rising),
            in_axis(crossing.few_to),
        ]
        for point, crossing, _ in answer.rows
    )
    fell = falling_in_words(info.limit_slip_m, past=True)
    heads = ("", f"half of the draws {fell} at", f"{100.0 * info.confidence:g} % interval", few)
    return html.table_of("answers", html.in_order(*heads), rows)


def random_table(info: EnsembleResult) -> html.Table:
    """What is drawn: by the file, and over the ranges of the unknown inputs."""
    rows = [[key, _drawn(spread)] for key, spread in info.random.items()]
    rows += [[key, "over its range as an unknown input"] for key in info.drawn_over_uncertainty]
    columns = html.in_order("key", "drawn")
    return html.table_of("random quantities", columns, rows, caption="Random quantities")


def points_table(info: EnsembleResult) -> html.Table:
    """A row a point: the counts, the share that overturned, its interval, the region."""
    words, share = region_labels(info), partial(number, factor=100.0, figures=3)
    columns: list[html.Column[Mapping[str, Any]]] = [
        *(html.Column(axis_label(axis), partial(_on_axis, axis), html.NUMBER) for axis in info.point_axes),
        *(html.Column(name, partial(_count, name), html.NUMBER) for name in ("draws", *COUNTED)),
        html.Column(
            "share",
            lambda point: ABSENT if point["probability"] is None else f"{share(point['probability'])} %",
            html.NUMBER,
        ),
        html.Column(
            f"{100.0 * info.confidence:g} % interval",
            lambda point: f"{share(point['low'])} to {share(point['high'])} %",
            html.NUMBER,
        ),
        html.Column("region", lambda point: words[point["region"]]),
        *html.figure_columns({SLIPPED: STOOD}, value=lambda point, key: point.get(key)),
    ]
    return html.table_of("points", columns, info.points, file="points.csv")


def _count(name: str, point: Mapping[str, Any]) -> str:
    return str(point.get(name, 0))


def _on_axis(axis: Axis, point: Mapping[str, Any]) -> str:
    value = point[axis.key]
    return str(value) if isinstance(value, bool | str) else short(value)


def _drawn(spread: Mapping[str, Any] | Sequence[Any]) -> str:
    """A distribution, or a list of values, in words."""
    if not isinstance(spread, Mapping):
        listed = (" + ".join(value) if isinstance(value, list) else str(value) for value in spread)
        return f"one of, equally often: {', '.join(listed)}"
    names = ("mean", "median", "deviation")
    parts = [f"{short(spread['from'])} to {short(spread['to'])}"] if "from" in spread else []
    parts += [f"{name} {short(spread[name])}" for name in names if name in spread]
    if "deviation" in spread:
        parts.append(f"cut at {short(spread['cut'])} deviations")
    if spread.get("relative"):
        parts.append("times the value of the key")
    return f"{spread['distribution']}, {', '.join(parts)}"
