"""The report of a response curve: its answer and figures, what lasts at each frequency, the request, the points."""

from collections import Counter
from pathlib import Path

from fem.batch.study import read_study
from fem.case.case import load_case
from fem.html import sections as html
from fem.html.page import Signature
from fem.html.units import short
from fem.report import studies
from fem.report.comparison import case_rows
from fem.response.answer import lasting_in_words, range_of, response_answer, stable_in_words
from fem.response.result import ResponseResult
from fem.results.kinds import RESPONSE
from fem.runtime.identity import command_line

FIGURES = ("figures/response_curve.svg", "figures/portraits.svg", "figures/sections.svg")
METHOD = (
    "Long-time motion under a harmonic floor whose frequency is swept up and down, the motion carried on from one "
    "frequency to the next onto a floor that is whole, and from random states at each. Only the motions that these "
    "meet are found; there may be more. Nothing is known between the frequencies."
)
#: names of the result that are options of the command, but for their underscores
OPTIONS = ("count", "scale", "order", "starts", "settle", "observe", "tolerance", "largest_period")
RENAMED = {"--from": "first_Hz", "--to": "last_Hz", "--hold": "held", "--limit-slip": "limit_slip_m"}


def response_report(folder: Path, *, signature: Signature | None = None) -> str:
    """The page, as the text of an HTML file.

    Raises:
        FolderError: it is no folder of a response curve, it is damaged, or it has no points yet.
        CaseError: the case in it cannot be read.
    """
    info = read_study(folder, RESPONSE, ResponseResult)
    case, name, asked = load_case(str(folder / "case.toml")), info.case or folder.name, info.request
    counts = Counter(point.words for point in info.points).most_common()
    counted = ", ".join(f"{words} at {count}" for words, count in counts)
    points = f"{len(info.points)} of {2 * asked['count']} points of the sweeps{studies.unfinished(info)}: {counted}."
    stable = stable_in_words(info)
    given = {f"--{name.replace('_', '-')}": name for name in OPTIONS} | RENAMED
    options = [word for option, key in given.items() if key in asked for word in (option, str(asked[key]))]
    options += ["--shell"] * bool(asked.get("shell"))
    options += [] if case.solver.model == "rigid" else ["--set", f"solver.model={case.solver.model}"]
    unit, factor = ("mm", 1e3) if asked["held"] == "displacement" else ("m/s²", 1.0)
    drive = [
        (f"held {asked['held']}, amplitude", f"{short(asked['held_value'], factor)} {unit}"),
        *(
            (option, short(asked[key]) if isinstance(asked[key], float) else str(asked[key]))
            for option, key in given.items()
            if key in asked
        ),
    ]
    parts = {
        "info": info,
        "drawings": studies.drawings(folder, FIGURES, "response curve"),
        "lasting": list(lasting_in_words(info)),
        "asked": html.columns(
            html.Pairs(drive, caption="Drive", look="asked"),
            html.Pairs(case_rows(case), caption="Case", look="asked"),
        ),
        "falls": [(fall, range_of(fall)) for fall in info.drop_outs],
        "most": html.MOST_ROWS,
    }
    return studies.study_html(
        "a response curve",
        info=info,
        title=info.title,
        name=name,
        case=case,
        signature=signature,
        hash=info.asked,
        sections=[
            studies.answer_section(
                info, response_answer(info), points, *([f"Stable: {stable}."] if stable else []), note=METHOD
            ),
            html.Written("response.html.j2", parts),
        ],
        provenance=[
            ("response curve", f"{name}, {info.status}, model {case.solver.model}"),
            ("hash", info.asked),
        ],
        again=studies.Again(
            words="Save the file below as case.toml:",
            command=command_line("response", "case.toml", *options),
            files=[("case.toml", studies.text_of(folder / "case.toml"))],
        ),
    )
