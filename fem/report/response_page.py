"""The report of a response curve: where it overturns and coexists, the curve, its points, the request."""

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from fem.case.case import load_case
from fem.html import sections as html
from fem.html.page import Signature
from fem.html.units import ABSENT, short
from fem.report import studies
from fem.report.comparison import case_rows
from fem.response.answer import branches_in_words, response_answer
from fem.response.records import POINT_FIGURES, PointRow
from fem.response.result import ResponseResult
from fem.results.kinds import RESPONSE
from fem.runtime.identity import command_line
from fem.study.driver import read_study

FIGURES = ("figures/response_curve.svg", "figures/sections.svg", "figures/portraits.svg")
STABLE = ": amplitudes do not diverge, and without drive the motion dies out."
METHOD = (
    "Long-time motion under a harmonic floor whose frequency is swept up and down, the motion carried on from one "
    "frequency to the next. Only the motions that the sweep meets are found; there may be more. Nothing is known "
    "between the frequencies."
)
#: options of the command, by the names that the result has for them
OPTIONS = {
    "--from": "first_Hz",
    "--to": "last_Hz",
    "--count": "count",
    "--scale": "scale",
    "--hold": "held",
    "--order": "order",
    "--settle": "settle",
    "--observe": "observe",
    "--tolerance": "tolerance",
    "--largest-period": "largest_period",
    "--limit-slip": "limit_slip_m",
}


def response_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of a response curve, it is damaged, or it has no points yet.
        CaseError: the case in it cannot be read.
    """
    info = read_study(folder, RESPONSE, ResponseResult)
    case, name = load_case(str(folder / "case.toml")), info.case or folder.name
    return studies.study_html(
        "a response curve",
        info=info,
        title=info.title,
        name=name,
        case=case,
        signature=signature,
        hash=info.asked,
        sections=[
            found_section(info),
            html.section("Response", "drawn", *studies.drawings(folder, FIGURES, "response curve")),
            html.section("Where the curve changes", "branches", *branch_tables(info)),
            html.section(
                "The drive and the case",
                "asked",
                html.columns(
                    html.Pairs(drive_rows(info.request), caption="Drive", look="asked"),
                    html.Pairs(case_rows(case), caption="Case", look="asked"),
                ),
            ),
            html.section("Points", "points", points_table(info)),
        ],
        provenance=[
            ("response curve", f"{name}, {info.status}, model {case.solver.model}"),
            ("hash", info.asked),
        ],
        again=studies.Again(
            words="Save the file below as case.toml:",
            command=command_line("response", "case.toml", *_options(info.request)),
            files=[("case.toml", studies.text_of(folder / "case.toml"))],
        ),
    )


def found_section(info: ResponseResult) -> html.PageSection:
    """The answer, and how many points were computed, of which kinds."""
    counts = Counter(point.words for point in info.points).most_common()
    counted = ", ".join(f"{words} at {count}" for words, count in counts)
    judged = [point.stable for point in info.points if point.stable is not None]
    return studies.answer_section(
        info,
        response_answer(info),
        f"{len(info.points)} of {2 * info.request['count']} points{studies.unfinished(info)}: {counted}.",
        *(
            [html.joined(f"{sum(judged)} of {len(judged)} points are ", html.strong("stable"), STABLE)]
            if judged
            else []
        ),
        note=METHOD,
    )


def drive_rows(request: Mapping[str, Any]) -> list[tuple[str, str]]:
    """How the floor was driven, and the motion judged: name and value."""
    held = {
        "displacement": f"amplitude {short(request['held_value'], 1e3)} mm",
        "acceleration": f"peak acceleration {short(request['held_value'])} m/s²",
    }
    spacing = "equal ratios" if request["scale"] == "log" else "equal steps"
    limit = request.get("limit_slip_m")
    return [
        ("held", held[request["held"]]),
        (
            "frequencies",
            f"{request['count']} from {short(request['first_Hz'])} to {short(request['last_Hz'])} Hz, {spacing}",
        ),
        ("order", request["order"].replace("-", ", then ")),
        ("judged by", f"{request['observe']} periods, after {request['settle']} that are left out"),
        (
            "repeats",
            f"within {short(request['tolerance'])}, after at most {request['largest_period']} periods",
        ),
        *(
            [("slip allowed", f"{short(limit, 1e3)} mm within the periods observed")]
            if limit is not None
            else []
        ),
    ]


def branch_tables(info: ResponseResult) -> list[html.Block]:
    """Coexisting motions, jumps and drop-outs, where there are any."""
    rows = list(branches_in_words(info))
    return [html.table_of("branches", html.in_order("what", "sweep", "where", "how"), rows)] if rows else []


def points_table(info: ResponseResult) -> html.Table:
    """A row a point, in the order in which they were swept."""
    *amplitudes, dies_out = html.figure_columns(POINT_FIGURES)
    columns: list[html.Column[PointRow]] = [
        html.Column("sweep", lambda point: point.direction),
        html.Column("frequency [Hz]", lambda point: short(point.frequency_Hz), html.NUMBER),
        html.Column(
            "motion", lambda point: point.words + (", from its start" if point.began == "case" else "")
        ),
        *amplitudes,
        html.Column("without drive", lambda point: point.undriven or ABSENT),
        dies_out,
        html.Column("stable", lambda point: {None: ABSENT, True: "yes", False: "no"}[point.stable]),
        html.Column("why failed", lambda point: point.reason or "", optional=True),
    ]
    return html.table_of("points", columns, info.points, file="response.csv")


def _options(request: Mapping[str, Any]) -> Iterator[str]:
    for option, name in OPTIONS.items():
        if name in request:
            yield option
            yield str(request[name])
