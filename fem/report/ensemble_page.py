"""The report of an ensemble: where half of the draws overturn, the curve or boundary, its points, the request."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from fem.batch.axes import Axis
from fem.batch.labels import axis_label, in_words, place_in_words
from fem.case.case import load_case
from fem.ensemble.answers import EnsembleAnswer, axes_of, ensemble_answer, interval_in_words
from fem.ensemble.run import fragility_lines
from fem.html.page import Signature
from fem.html.units import ABSENT, number, short, typeset
from fem.report.motion_part import motions_of_ensemble
from fem.report.studies import PageTable, again_from_files, axis_row, drawings, page_table, study_page
from fem.results.errors import FolderError
from fem.results.kinds import ENSEMBLE, read_result
from fem.results.outcome import COUNTED

FIGURES = ("figures/fragility.svg", "figures/boundary.svg")


def ensemble_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of an ensemble, it is damaged, or nothing was counted yet.
        CaseError: the base case in it cannot be read.
    """
    info = read_result(folder / ENSEMBLE.mark, ENSEMBLE)
    if "points" not in info:
        raise FolderError(
            f"{folder}: the ensemble is not finished; continue it with --resume, then report it"
        )
    case = load_case(str(folder / "base.toml"))
    answer, name = ensemble_answer(info), str(info.get("ensemble") or folder.name)
    words = region_labels(info)
    return study_page(
        "ensemble.html.j2",
        info=info,
        case=case,
        signature=signature,
        answer=answer.sentence if answer else None,
        title=info.get("title") or name,
        name=name,
        hash=str(info["asked"]),
        answers=answer_table(answer, info) if answer and answer.others else None,
        regions=[(words[region], count) for region, count in info["regions"].items() if count],
        fitted=[typeset(f"{head}: {line}.") for head, line in fragility_lines(info)],
        drawn=drawings(folder, FIGURES, "ensemble"),
        motions=motions_of_ensemble(folder, info),
        axes=[axis_row(axis) for axis in axes_of(info)],
        random=random_table(info),
        points=points_table(info),
        provenance=[
            ("ensemble", f"{name}, {info['status']}, model {info['model']}"),
            ("draws", f"{info['draws']} at each point, {info['sampling']}, seed {info['seed']}"),
            ("hash", info["asked"]),
        ],
        again=again_from_files(folder, study="ensemble", name=name, case=case),
    )


def region_labels(info: Mapping[str, Any]) -> dict[str, str]:
    """The regions in words, as the share that overturns."""
    limit = f"{short(info['probability'], 100.0)} %"
    return {"below": f"at most {limit}", "undecided": "not decided", "above": f"more than {limit}"}


def answer_table(answer: EnsembleAnswer, info: Mapping[str, Any]) -> PageTable:
    """Where half of the draws overturn, for each combination of values of the other axes."""

    def in_axis(value: float | None) -> str:
        return ABSENT if value is None else in_words(answer.axis, [value])

    few = f"at most {100.0 * info['probability']:g} % {'up to' if answer.rising else 'from'}"
    rows = (
        [
            place_in_words(answer.others, point),
            f"{in_axis(found.value)}{' or before' if found.at_once else ''}",
            ABSENT if found.value is None else interval_in_words(answer.axis, found, rising=answer.rising),
            in_axis(found.few_to),
        ]
        for point, found, _ in answer.rows
    )
    heads = ("", "half of the draws overturned at", f"{100.0 * info['confidence']:g} % interval", few)
    return page_table("answers", dict.fromkeys(heads, False), rows)


def random_table(info: Mapping[str, Any]) -> PageTable:
    """What is drawn: by the file, and over the ranges of the unknown inputs."""
    rows = [[key, _drawn(spread)] for key, spread in info["random"].items()]
    rows += [[key, "over its range in [uncertainty]"] for key in info.get("drawn_over_uncertainty") or ()]
    return page_table("random quantities", {"key": False, "drawn": False}, rows, caption="Random quantities")


def points_table(info: Mapping[str, Any]) -> PageTable:
    """A row a point: the counts, the share that overturned, its interval, the region."""
    axes, words = axes_of(info), region_labels(info)
    counted = ("draws", *COUNTED)
    numbers = (*counted, "share", f"{100.0 * info['confidence']:g} % interval")
    columns = dict.fromkeys((axis_label(axis) for axis in axes), True)
    columns |= dict.fromkeys(numbers, True) | {"region": False}

    def row(point: Mapping[str, Any]) -> Iterator[str]:
        yield from (_on_axis(axis, point[axis.key]) for axis in axes)
        yield from (str(point[name]) for name in counted)
        yield number(point["probability"], 100.0, 3) + " %" if point["probability"] is not None else ABSENT
        yield f"{number(point['low'], 100.0, 3)} to {number(point['high'], 100.0, 3)} %"
        yield words[point["region"]]

    return page_table("points", columns, (list(row(point)) for point in info["points"]), file="points.csv")


def _on_axis(axis: Axis, value: Any) -> str:
    return str(value) if isinstance(value, bool | str) else short(value)


def _drawn(spread: Mapping[str, Any] | Sequence[Any]) -> str:
    """A distribution, or a list of values, in words."""
    if not isinstance(spread, Mapping):
        listed = (" + ".join(one) if isinstance(one, list) else str(one) for one in spread)
        return f"one of, equally often: {', '.join(listed)}"
    names = ("mean", "median", "deviation")
    parts = [f"{short(spread['from'])} to {short(spread['to'])}"] if "from" in spread else []
    parts += [f"{name} {short(spread[name])}" for name in names if name in spread]
    if "deviation" in spread:
        parts.append(f"cut at {short(spread['cut'])} deviations")
    if spread.get("relative"):
        parts.append("times the value of the key")
    return f"{spread['distribution']}, {', '.join(parts)}"
