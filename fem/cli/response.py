"""`response`: long-time motion under a harmonic floor, frequency by frequency."""

import importlib
import json
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from fem.case.case import load_case
from fem.cli.console import EXIT_CODES, CaseName, Force, Overrides, Quiet, Resume, flag, whole
from fem.runtime.progress import ScreenReporter


def response(
    case: CaseName = None,
    /,
    *,
    first: Annotated[float, Parameter(name="--from", help="Lowest frequency of the floor [Hz].")],
    last: Annotated[float, Parameter(name="--to", help="Highest frequency [Hz].")],
    count: Annotated[int, whole("Number of frequencies, both ends included.")] = 41,
    scale: Annotated[Literal["linear", "log"], Parameter(help="Their spacing.")] = "linear",
    hold: Annotated[
        Literal["displacement", "acceleration"] | None,
        Parameter(
            show_default=False,
            help="Amplitude of the floor that is kept constant; default: the one that the case gives.",
        ),
    ] = None,
    order: Annotated[
        Literal["up-down", "down-up"], Parameter(help="Which way first; the motion continues at the turn.")
    ] = "up-down",
    settle: Annotated[int, whole("Periods to leave out at each frequency.")] = 60,
    observe: Annotated[int, whole("Periods to observe at each frequency.")] = 48,
    tolerance: Annotated[
        float, Parameter(help="Distance below which two sections are equal, over the slenderness angle.")
    ] = 5e-3,
    largest_period: Annotated[int, whole("Longest period to look for, in periods of the floor.")] = 16,
    out: Annotated[
        Path | None, Parameter(help="Folder of the results; default: outputs/NAME-response.")
    ] = None,
    overrides: Overrides = (),
    resume: Resume = False,
    force: Force = False,
    as_json: Annotated[bool, flag("Print response.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Sweep the frequency of the floor up and down without restarting the motion: branches, jumps, drop-outs."""
    loaded = load_case(case, overrides)
    requests = importlib.import_module("fem.response.request")
    request = requests.ResponseRequest(
        case=loaded,
        first_Hz=first,
        last_Hz=last,
        count=count,
        scale=scale,
        hold=hold,
        order=order,
        settle=settle,
        observe=observe,
        tolerance=tolerance,
        largest_period=largest_period,
    )
    folder = out if out is not None else Path("outputs") / f"{loaded.name}-response"
    # Loaded late: bad input is refused before anything is compiled.
    study = importlib.import_module("fem.response.run")
    result = study.run_response(
        request, folder=folder, force=force, resume=resume, reporter=ScreenReporter(quiet=quiet)
    )
    print(json.dumps(result, indent=2) if as_json else study.page_of(request, result, folder))
    return EXIT_CODES[result["status"]]
