"""The page of a sweep, an ensemble, a response curve or a list of containers, by one template.

`study.html.j2` reads like the page; here is what it is handed: the result, the columns of tables, and filters.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from fem.case.case import Case, load_case
from fem.html.page import Page, Signature, html_of, svg_element
from fem.html.units import ABSENT, figure_cell, figure_head, millimetres, number, short, typeset
from fem.model.container import modes_of_a_body
from fem.records.units import STANDARD_GRAVITY
from fem.report.sweep_map import counts, map_data, shown_quantities
from fem.response.lasting import ResponseResult, response_answer, stable_in_words
from fem.results.errors import FolderError
from fem.results.figures import DURATION, PGA, PGD, PGV, TURNED, Place, Shown, figures_of
from fem.results.kinds import ENSEMBLE, HALL, RESPONSE
from fem.results.level import REGIME_UNSURE, STANDING, SURE, UNSURE
from fem.results.outcome import COUNTED, Outcome
from fem.run import described
from fem.run.card import deciding_in_words, times
from fem.runtime import units
from fem.runtime.identity import command_line
from fem.runtime.user_files import read_text
from fem.study.answers import (
    Answer,
    HalfPoint,
    StudyAnswer,
    ends_in_words,
    ensemble_answer,
    falling_in_words,
    interval_in_words,
    ranges_in_words,
    sweep_answer,
)
from fem.study.axes import Axis, axis_label, in_words, unit_of_people
from fem.study.driver import COMPLETED, StudyResult, read_study
from fem.study.fragility import EnsembleResult
from fem.study.hall_result import DOUBTFUL, FALLS, HallResult
from fem.study.sure import CHANGES, change_columns, input_in_words
from fem.study.sweep_table import SweepTable, open_sweep
from fem.study.table import read_rows

A_ROW = Mapping[str, Any]
#: head, cells, look, and whether it is left out where all cells are empty; the last two may be missing
Column = tuple[Any, ...]
#: how to repeat a study: in words, its command, and names and texts of the files that it needs
Again = tuple[str, str, Sequence[tuple[str, str]]]
N = "number"
MOST_DRAWING_BYTES = 400_000  #: of a drawing, as SVG
STOOD = Shown("slip of those that stood", units.MILLIMETRES)
CODE, LINK = Markup("<code>{}</code>"), Markup('<a href="#{}">{}</a>')
TARGET = Markup('<span id="row-{}">{}</span>')
SWATCH = Markup('<span class="swatch" style="background:{}"></span>{}')
PEAK = "peak_acceleration_m_s2"
#: what is shown of a motion
MEASURES = {PEAK: PGA, "peak_velocity_m_s": PGV, "peak_displacement_m": PGD, "significant_s": DURATION}
MANY_RESTS = 3  #: containers at rest that are listed apart
LOOKS = dict.fromkeys((*FALLS, *DOUBTFUL, "overturned", "invalid"), "bad")
#: names of the result of a response curve that are options of its command, but for their underscores
OPTIONS = ("count", "starts", "settle", "observe")
RENAMED = {"--from": "first_Hz", "--to": "last_Hz", "--hold": "held"}


def sweep_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page of a sweep, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of a sweep, it is damaged, or it holds more than one page can carry.
        CaseError: the base case in it cannot be read.
    """
    table = open_sweep(folder)
    info, case = table.info, load_case(str(folder / "base.toml"))
    answer, name = sweep_answer(table, folder), info.sweep or folder.name
    data, tally, labels = map_data(table, folder), counts(table), [axis_label(axis) for axis in table.axes]
    counted = ", ".join(f"{count} {label}" for label, _, count, _ in tally)
    computed = int((table["status"] != "").sum())
    failed = np.flatnonzero(np.asarray(table["status"]).astype(str) == "failed")[:20].tolist()
    return _html(
        "sweep",
        folder,
        info,
        case,
        signature,
        title=info.title or name,
        name=name,
        hash=info.sweep_hash,
        scripts=["map.js"],
        data={"sweep": data},
        sentence=answer.sentence if answer else info.answer,
        count=f"{computed} of {info.cells} cells{_unfinished(info)}: {counted}.",
        figures=_figures(folder, info.maps, "sweep"),
        deciding=sorted((info.decided_by or {}).items(), key=lambda pair: -pair[1]),
        quantities=shown_quantities(data),
        axis_labels=list(enumerate(labels)),
        longest=sorted(sorted(range(len(labels)), key=lambda k: -len(table.axes[k].values))[:2]),
        answer_rows=len(answer.rows) if answer else 0,
        answers=_answers_of_sweep(answer) if answer and answer.others else [],
        counts=[
            ("outcome", [SWATCH.format(colour, label) for label, colour, *_ in tally]),
            ("cells", [count for *_, count, _ in tally], N),
            ("share", [f"{number(share, 100, 3)} %" for *_, share in tally], N),
        ],
        failures=[(cell, table["reason"][cell]) for cell in failed],
        thresholds=_thresholds(folder, table),
        axes=_axes(table.axes, info.derived),
        provenance=[
            ("sweep", f"{name}, {info.status}, model {info.model}"),
            ("sweep hash", info.sweep_hash),
            ("base hash", info.base_hash),
        ],
        again=_again(folder, "sweep", name, case),
    )


def _answers_of_sweep(answer: StudyAnswer[Answer]) -> list[Column]:
    """Where, up to where it stood, where it first overturned, the slip, what else there is to say."""
    heads = ("stood up to", "first overturned at") if answer.rising else ("stood from", "overturned up to")
    unit, rows = unit_of_people(answer.axis)[0], answer.rows
    up_to, first, again, failed, unsure = (
        f"{head} [{unit}]" if unit else head for head in (*heads, "stood again", "no outcome", "unsure")
    )
    every = [": every motion" if len(row.point) < len(answer.others) else "" for row in rows]
    found = [row.found for row in rows]
    ends = [ends_in_words(one, answer.axis, bare=True) for one in found]
    noted = [
        " (slid too far)" if one.slid else " (a corner destroyed)" if one.invalid else "" for one in found
    ]

    def ranges(name: str) -> list[str]:
        return [ranges_in_words(getattr(one, name), answer.axis, bare=True) for one in found]

    def slips(name: str) -> list[str]:
        return ["" if (slip := getattr(one, name)) is None else millimetres(slip) for one in found]

    return [
        ("", [f"{answer.where(row)}{more}" for row, more in zip(rows, every, strict=True)]),
        (up_to, [stood or ABSENT for stood, _ in ends]),
        ("slip up to there [mm]", slips("stood_slip"), "", True),
        (first, [f"{fell or ABSENT}{more}" for (_, fell), more in zip(ends, noted, strict=True)]),
        ("slip there [mm]", slips("slip"), "", True),
        (again, ranges("stood_again"), "", True),
        (failed, ranges("failed"), "", True),
        (unsure, ranges("unsure"), "", True),
    ]


def _thresholds(folder: Path, table: SweepTable) -> list[Column]:
    """The refined changes of outcome; nothing where they were not asked for."""
    path, along = folder / "thresholds.csv", (table.info.threshold or {}).get("axis", "")
    if not path.is_file():
        return []
    columns = change_columns(table.axes, along)
    try:
        rows = read_rows(path, columns)
    except (OSError, ValueError) as error:
        raise FolderError(f"{path}: cannot be read ({error}); repeat the sweep with --force") from None
    unit = next((axis.unit for axis in table.axes if axis.key == along), "")
    return [
        (
            f"{name} [{unit}]" if unit and CHANGES.get(name) is float else name,
            [short(row[name], figures=5) if kind is float else row[name] or "" for row in rows],
        )
        for name, kind in columns.items()
    ]


def ensemble_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page of an ensemble, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of an ensemble, it is damaged, or nothing was counted yet.
        CaseError: the base case in it cannot be read.
    """
    info = read_study(folder, ENSEMBLE, EnsembleResult)
    case, answer = load_case(str(folder / "base.toml")), ensemble_answer(info)
    name = info.ensemble or folder.name
    limit, fell = f"{short(info.probability, 100.0)} %", falling_in_words(info.limit_slip_m, past=True)
    words = {"below": f"at most {limit}", "undecided": "not decided", "above": f"more than {limit}"}
    regions = ", ".join(f"{words[region]} at {count}" for region, count in info.regions.items() if count)
    counted = f"{len(info.points)} points of {info.draws} draws{_unfinished(info)}"
    drawn = dict.fromkeys(info.drawn_over_uncertainty, "over its range as an unknown input")
    random = {key: _drawn(spread) for key, spread in info.random.items()} | drawn
    motions = info.motions or ()
    return _html(
        "ensemble",
        folder,
        info,
        case,
        signature,
        title=info.title or name,
        name=name,
        hash=info.asked,
        sentence=answer.sentence if answer else None,
        count=counted + (f"; share that {fell}: {regions}." if regions else "."),
        answers=_answers_of_ensemble(answer, info) if answer and answer.others else [],
        figures=_figures(folder, ("figures/fragility.svg", "figures/boundary.svg"), "ensemble"),
        outcomes=[
            ("motion", [motion["file"] for motion in motions]),
            *((name, [motion.get(name, 0) for motion in motions], N) for name in COUNTED),
        ],
        axes=_axes(info.axes, info.derived),
        random=[("key", list(random)), ("drawn", list(random.values()))],
        counted=("draws", *COUNTED),
        stood=STOOD,
        regions=words,
        provenance=[
            ("ensemble", f"{name}, {info.status}, model {info.model}"),
            ("draws", f"{info.draws} at each point, {info.sampling}, seed {info.seed}"),
            ("hash", info.asked),
        ],
        again=_again(folder, "ensemble", name, case),
    )


def _answers_of_ensemble(answer: StudyAnswer[HalfPoint], info: EnsembleResult) -> list[Column]:
    """Where half of the draws overturn, for all values of the other axes."""

    def in_axis(value: float | None) -> str:
        return ABSENT if value is None else in_words(answer.axis, [value])

    few = f"at most {100.0 * info.probability:g} % {'up to' if answer.rising else 'from'}"
    fell, found = falling_in_words(info.limit_slip_m, past=True), [row.found for row in answer.rows]
    intervals = [
        ABSENT if one.value is None else interval_in_words(answer.axis, one, rising=answer.rising)
        for one in found
    ]
    halves = [f"{in_axis(one.value)}{' or before' if one.at_once else ''}" for one in found]
    return [
        ("", [answer.where(row) for row in answer.rows]),
        (f"half of the draws {fell} at", halves),
        (f"{100.0 * info.confidence:g} % interval", intervals),
        (few, [in_axis(one.few_to) for one in found]),
    ]


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


def response_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page of a response curve, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of a response curve, it is damaged, or it has no points yet.
        CaseError: the case in it cannot be read.
    """
    info = read_study(folder, RESPONSE, ResponseResult)
    case, name, asked = load_case(str(folder / "case.toml")), info.case or folder.name, info.request
    counts = Counter(point.words for point in info.points).most_common()
    counted = ", ".join(f"{words} at {count}" for words, count in counts)
    given = {f"--{name.replace('_', '-')}": name for name in OPTIONS} | RENAMED
    asked_for = {option: asked[key] for option, key in given.items()}
    options = [word for option, value in asked_for.items() for word in (option, str(value))]
    options += ["--shell"] * bool(asked["shell"])
    options += [] if case.solver.model == "rigid" else ["--set", f"solver.model={case.solver.model}"]
    unit, factor = ("mm", 1e3) if asked["held"] == "displacement" else ("m/s²", 1.0)
    stable = stable_in_words(info)
    return _html(
        "response curve",
        folder,
        info,
        case,
        signature,
        title=info.title or name,
        name=name,
        hash=info.asked,
        sentence=response_answer(info),
        count=f"{len(info.points)} of {2 * asked['count']} points of the sweeps{_unfinished(info)}: {counted}.",
        more=[f"Stable: {stable}."] if stable else [],
        figures=_figures(folder, ("figures/response_curve.svg", "figures/portraits.svg"), "response curve"),
        drive=[
            (f"held {asked['held']}, amplitude", f"{short(asked['held_value'], factor)} {unit}"),
            *(
                (option, short(value) if isinstance(value, float) else str(value))
                for option, value in asked_for.items()
            ),
        ],
        provenance=[
            ("response curve", f"{name}, {info.status}, model {case.solver.model}"),
            ("hash", info.asked),
        ],
        again=(
            "Save the file below as case.toml:",
            command_line("response", "case.toml", *options),
            [("case.toml", _text(folder / "case.toml"))],
        ),
    )


def hall_report(folder: Path, *, signature: Signature | None = None, brief: bool = False) -> str:
    """The page of a list of containers, as the text of an HTML file.

    `brief`: only the answer, the tags and the weakest.

    Raises:
        FolderError: it is not the folder of a list, it is damaged, or it is not finished.
        CaseError: the base case in it cannot be read.
    """
    info = read_study(folder, HALL, HallResult)
    case = load_case(str(folder / "base.toml"), allow_outside=True)
    count = f"{info.extent}{_unfinished(info)}."
    if info.checked:
        which = "all" if info.checked == info.distinct else f"the weakest {info.checked}"
        count += f" Sure, deciding inputs and margin are those of {which}, each under its governing motion."
    elif info.state == "finished":
        count += " No run was repeated, so sureness and margins are not known."
    outcomes = "; ".join(f"{word}: {number}" for word, number in info.counts.items())
    by_tag = Counter[tuple[str, str]]()
    for row in info.table:
        by_tag[row["tag"], row.get("does") or row["outcome"] or row["status"]] += row["count"]
    words = dict.fromkeys((*info.counts, *(word for _, word in by_tag)))
    asked = ["--motion", *info.motions] if info.motions else []
    asked += ["--margins", info.checks] * (info.checks != "weakest") + ["--one-side"] * bool(info.one_side)
    command = command_line(
        "batch", "list.csv", "--case", "base.toml", *asked, allow_outside=bool(info.allow_outside)
    )
    how = "With the two files of this folder, and the motions:"
    moving, resting = folded(info.ranked)
    return _html(
        "list of containers",
        folder,
        info,
        case,
        signature,
        title=info.hall,
        name=info.hall,
        hash=info.asked,
        sentence=info.answer,
        count=count,
        more=[f"{outcomes[0].upper()}{outcomes[1:]}."] if outcomes else [],
        tag_counts=[(word, [by_tag[tag["tag"], word] or "" for tag in info.tags], N) for word in words],
        key_figures=figures_of(Place.KEY),
        moving=moving,
        resting=resting,
        at_rest=sum(row["count"] for row in resting),
        looks=[LOOKS.get(row.get("does") or row["outcome"], "") for row in moving],
        brief=brief,
        provenance=[("list", f"{info.hall}, {info.status}, model {info.model}"), ("hash", info.asked)],
        again=None if brief else (how, command, [("base.toml", _text(folder / "base.toml"))]),
    )


def folded(ranked: Sequence[A_ROW]) -> tuple[list[A_ROW], list[A_ROW]]:
    """Rows of the list, those of equal containers as one; apart from them the containers at rest, where they are many.

    `ranked`: the weakest first. What rests, but whose variations do something else, is not among those at rest.
    """
    alike: dict[tuple[str, str], list[A_ROW]] = {}
    for row in ranked:
        alike.setdefault((row["command"], row["tag"]), []).append(row)
    rows = [
        {**group[0], "name": f"{group[0]['name']} and {len(group) - 1} alike"}
        | {"line": ", ".join(str(row["line"]) for row in group), "count": sum(row["count"] for row in group)}
        if len(group) > 1
        else group[0]
        for group in alike.values()
    ]
    resting = [
        row for row in rows if (row.get("does") or row["outcome"]) in (Outcome.REST, STANDING[Outcome.REST])
    ]
    if len(resting) < MANY_RESTS or len(resting) == len(rows):
        return rows, []
    return [row for row in rows if row not in resting], resting


def margin_words(row: A_ROW) -> str:
    """The margin that governs, and that with the inputs as given: "1.01 (as given 1.45)", "> 4"; empty without."""
    margin, tried, governs = (row.get(name) for name in ("margin", "margin_tried_to", "margin_governs"))
    given = times(margin) if margin is not None else "" if tried is None else f"> {times(tried)}"
    if governs is None or governs == margin:
        return given
    return f"{'none' if governs == 1.0 else times(governs)} (as given {given})"


def _html(
    kind: str,
    folder: Path,
    info: StudyResult,
    case: Case,
    signature: Signature | None,
    *,
    title: str,
    name: str,
    hash: str,
    sentence: str | None,
    provenance: Sequence[tuple[str, str]],
    again: Again | None,
    figures: Sequence[tuple[str, Markup]] = (),
    scripts: Sequence[str] = (),
    data: Mapping[str, Any] | None = None,
    **context: Any,
) -> str:
    """The page: what the template is handed, and at its end the limits of the case and how to repeat it.

    An unfinished study is not signed; without `again` it is a short page, without its end.
    """
    motions = getattr(info, "motions", None) or () if kind == "ensemble" else ()
    drawn = _figures(folder, getattr(info, "motion_figures", ()), kind, prefix="motion")
    page = Page(
        kind=f"Report of {'an' if kind == 'ensemble' else 'a'} {kind}",
        title=title,
        name=name,
        signature=None if info.no_answer_yet else (signature or Signature()).completed(case.named),
        hash=hash,
        scripts=scripts,
        data=data or {},
    )
    known = {"more": [], "answers": [], "answer_rows": 0, "brief": False} | context
    versions = ", ".join(f"{name} {version}" for name, version in info.versions.items())
    return html_of(
        page,
        "study.html.j2",
        FILTERS,
        kind=kind,
        info=info,
        case=case,
        numerics=None,
        joints_below=False,
        described=described,
        modes_of_a_body=modes_of_a_body,
        sentence=info.no_answer_yet or sentence,
        measures=_measures(motions),
        figures=figures,
        motion_figures=drawn,
        provenance=[*provenance, ("versions", versions)],
        again=again,
        **known,
    )


def _unfinished(info: StudyResult) -> str:
    """How a study ended that is not complete."""
    return "" if info.status == COMPLETED else f" ({info.status})"


def _axes(axes: Sequence[Axis], derived: Mapping[str, str]) -> list[Column]:
    """The axes of a study, and the keys that follow from them."""

    def words(axis: Axis) -> str:
        first, last = axis.values[0], axis.values[-1]
        if (
            axis.scale in ("linear", "log")
            and isinstance(first, int | float)
            and isinstance(last, int | float)
        ):
            return f"{short(first)} to {short(last)} {axis.unit}, {axis.scale}".replace(" ,", ",")
        listed = ", ".join(str(value) for value in axis.values[:12])
        return f"{listed}{' ...' * (len(axis.values) > 12)} {axis.unit}".rstrip()

    return [
        ("key", [CODE.format(key) for key in (*(axis.key for axis in axes), *derived)]),
        ("values", [*map(words, axes), *(escape(f"= {rule}") for rule in derived.values())]),
        ("count", [*(len(axis.values) for axis in axes), *("follows" for _ in derived)], N),
    ]


def _figures(
    folder: Path, names: Iterable[str], command: str, *, prefix: str = "drawn"
) -> list[tuple[str, Markup]]:
    """Drawings that a study has made, with their labels; what is missing, outside or too large is left out.

    `prefix` is that of their ids, another one for each list of drawings on a page.
    """
    drawn = []
    for k, name in enumerate(names):
        path = folder / name
        inside = path.resolve().is_relative_to(folder.resolve())
        if not inside or not path.is_file() or path.stat().st_size > MOST_DRAWING_BYTES:
            continue
        text, label = read_text(path), path.stem.replace("_", " ")
        try:
            drawn.append((label, svg_element(text, label=label, prefix=f"{prefix}{k}")))
        except ValueError as error:
            raise FolderError(
                f"{path}: {error}; remove it and repeat the {command}, which draws it again"
            ) from None
    return drawn


def _text(path: Path) -> str:
    return read_text(path) if path.is_file() else ""


def _again(folder: Path, study: str, name: str, case: Case) -> Again:
    """How to compute a study again from the files in its folder: its own, and its base case."""
    records = " and the files of its motions" if case.motion.kind == "table" else ""
    words = f'Save the two files below in one folder{records}, with case = "base.toml" in {name}.toml:'
    files = [(f"{name}.toml", _text(folder / f"{study}.toml")), ("base.toml", _text(folder / "base.toml"))]
    return words, command_line(study, f"{name}.toml"), files


def _measures(motions: Sequence[A_ROW]) -> list[Column]:
    """A row a component of a motion: peaks, significant duration, length, step."""
    parts = [part for motion in motions for part in (motion, motion["vertical"]) if part]
    return [
        ("motion", [part["file"] + ("" if "vertical" in part else " (vertical)") for part in parts]),
        ("PGA [g]", [number(part[PEAK], 1.0 / STANDARD_GRAVITY, 3) for part in parts], N),
        *(
            (figure_head(shown), [figure_cell(shown, part[key]) for part in parts], N)
            for key, shown in MEASURES.items()
        ),
        ("length [s]", [short(part["duration_s"]) for part in parts], N),
        ("step [s]", [short(part["step_s"]) for part in parts], N),
    ]


def share(value: float) -> str:
    """A probability in per cent."""
    return number(value, 100.0, 3)


def _shown(columns: Sequence[Column]) -> list[dict[str, Any]]:
    """The columns of a table that show something, their cells as they are set."""
    shown = []
    for head, cells, *more in columns:
        texts = [cell if isinstance(cell, Markup) else typeset(str(cell)) for cell in cells]
        look, optional = (*more, "", False)[:2] if len(more) < 2 else more
        if any(texts) or not optional:
            attributes = Markup(' class="{}"').format(look) if look else ""
            shown.append({"head": head, "cells": texts, "attributes": attributes})
    return shown


#: of `study.html.j2`
FILTERS: dict[str, Callable[..., Any]] = {
    "shown": _shown,
    "code": CODE.format,
    "at": lambda row, key, empty=None: "" if row[key] in (None, empty) else row[key],
    "agreement": lambda sure: {SURE: "alike", REGIME_UNSURE: "end alike", UNSURE: "not alike"}.get(
        sure, sure
    ),
    "axis_label": axis_label,
    "cell_label": lambda value: str(value) if isinstance(value, bool | str) else short(value),
    "deciding": lambda keys: keys and deciding_in_words(keys.split()),
    # how far a container fell says nothing
    "figure": lambda row, name, shown: figure_cell(
        shown, None if name == TURNED and row["outcome"] == Outcome.OVERTURNED else row[name]
    ),
    "figure_head": figure_head,
    "input_in_words": input_in_words,
    "interval": lambda point: f"{share(point['low'])} to {share(point['high'])} %",
    "linked": lambda row: LINK.format(f"row-{row['row']}", row["name"]),
    "margin": margin_words,
    "of_use": lambda value: value if value == "" else number(value, figures=3),
    "of_point": lambda point, key, default: point.get(key, default),
    "or_absent": lambda text: text or ABSENT,
    "outcome": lambda row: (row["outcome"] and row.get("does")) or row["outcome"] or f"none: {row['reason']}",
    "share": lambda value: ABSENT if value is None else f"{share(value)} %",
    "target": lambda row: TARGET.format(row["row"], row["name"]),
}
