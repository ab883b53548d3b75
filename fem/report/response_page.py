"""The report of a response curve: where it overturns and coexists, the curve, its points, the request."""

import shlex
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from fem.case.case import load_case
from fem.html.page import Signature
from fem.html.units import ABSENT, millimetres, number, rotation_ratio, short
from fem.report.studies import Again, PageTable, drawings, page_table, study_page, text_of
from fem.response.answer import found_at, response_answer
from fem.response.records import PointRow
from fem.results.errors import FolderError
from fem.results.kinds import RESPONSE, read_result

FIGURES = ("figures/response_curve.svg", "figures/sections.svg", "figures/portraits.svg")
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
}


def response_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of a response curve, it is damaged, or it has no points yet.
        CaseError: the case in it cannot be read.
    """
    info = read_result(folder / RESPONSE.mark, RESPONSE)
    if "points" not in info:
        raise FolderError(
            f"{folder}: the response curve is not finished; continue it with --resume, then report it"
        )
    case, name = load_case(str(folder / "case.toml")), str(info.get("case") or folder.name)
    judged = [point["stable"] for point in info["points"] if point["stable"] is not None]
    return study_page(
        "response.html.j2",
        info=info,
        case=case,
        signature=signature,
        answer=response_answer(info),
        title=info.get("title") or name,
        name=name,
        hash=str(info["asked"]),
        counts=Counter(PointRow(**point).words for point in info["points"]).most_common(),
        stable=f"{sum(judged)} of {len(judged)}",
        drawn=drawings(folder, FIGURES, "response curve"),
        branches=branch_table(info),
        drive=drive_rows(info["request"]),
        points=points_table(info),
        provenance=[
            ("response curve", f"{name}, {info['status']}, model {case.solver.model}"),
            ("hash", info["asked"]),
        ],
        again=Again(
            words="Save the file below as case.toml:",
            command=shlex.join(["python", "-m", "fem", "response", "case.toml", *_options(info["request"])]),
            files=[("case.toml", text_of(folder / "case.toml"))],
        ),
    )


def drive_rows(request: Mapping[str, Any]) -> list[tuple[str, str]]:
    """How the floor was driven, and the motion judged: name and value."""
    held = {
        "displacement": f"amplitude {short(request['held_value'], 1e3)} mm",
        "acceleration": f"peak acceleration {short(request['held_value'])} m/s²",
    }
    spacing = "equal ratios" if request["scale"] == "log" else "equal steps"
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
    ]


def branch_table(info: Mapping[str, Any]) -> PageTable:
    """Coexisting motions, jumps and drop-outs."""

    def rows() -> Iterator[list[str]]:
        for found in info["drop_outs"]:
            how = "a motion that was carried there" if found["carried"] else "from its start"
            yield ["overturns", found["direction"], found_at(found), how]
        for found in info["coexisting"]:
            words = f"{' or '.join(found['up'])} going up, {' or '.join(found['down'])} going down"
            yield ["coexist", "up and down", found_at(found), words]
        for found in info["jumps"]:
            before, after = (rotation_ratio(one) for one in found["rotation_ratio"])
            yield [
                "jump",
                found["direction"],
                found_at(found),
                f"{found['what']}, rotation ratio {before} to {after}",
            ]

    heads = ("what", "sweep", "where", "how")
    return page_table("branches", dict.fromkeys(heads, False), rows())


def points_table(info: Mapping[str, Any]) -> PageTable:
    """A row a point, in the order in which they were swept."""
    columns = {
        "sweep": False,
        "frequency [Hz]": True,
        "motion": False,
        "rotation ratio": True,
        "slip stroke [mm]": True,
        "impacts a period": True,
        "without drive": False,
        "dies out in [s]": True,
        "stable": False,
        "why failed": False,
    }

    def row(point: PointRow) -> Iterator[str]:
        yield point.direction
        yield short(point.frequency_Hz)
        yield point.words + (", from its start" if point.began == "case" else "")
        yield rotation_ratio(point.rotation_ratio)
        yield millimetres(point.slip_stroke_m)
        yield number(point.impacts_per_period, figures=3)
        yield point.undriven or ABSENT
        yield number(point.undriven_s, figures=3)
        yield ABSENT if point.stable is None else ("yes" if point.stable else "no")
        yield point.reason or ""

    return page_table(
        "points",
        columns,
        (list(row(PointRow(**point))) for point in info["points"]),
        file="response.csv",
        optional=frozenset({"why failed"}),
    )


def _options(request: Mapping[str, Any]) -> Iterator[str]:
    for option, name in OPTIONS.items():
        yield option
        yield str(request[name])
