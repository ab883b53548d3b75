"""`response`: what the container does in the long run under a harmonic drive, frequency by frequency."""

import importlib
import json
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from fem.case.case import load_case
from fem.cli.console import EXIT_CODES, Force, Overrides, Quiet, flag, whole
from fem.runtime.progress import ScreenReporter


def response(
    case: str | None = None,
    /,
    *,
    first: Annotated[float, Parameter(name="--from", help="Lowest frequency of the drive [Hz].")],
    last: Annotated[float, Parameter(name="--to", help="Highest frequency [Hz].")],
    count: Annotated[int, whole("Frequencies, both ends included.")] = 41,
    scale: Annotated[Literal["linear", "log"], Parameter(help="How they are spread.")] = "linear",
    hold: Annotated[
        Literal["displacement", "acceleration"] | None,
        Parameter(
            show_default=False,
            help="Amplitude of the floor that stays the same; default: the one that the case states.",
        ),
    ] = None,
    order: Annotated[
        Literal["up-down", "down-up"], Parameter(help="Which way first; the motion is carried on.")
    ] = "up-down",
    settle: Annotated[int, whole("Periods left out at each frequency.")] = 60,
    observe: Annotated[int, whole("Periods by which the motion is judged.")] = 48,
    tolerance: Annotated[
        float, Parameter(help="Within which two sections are the same, of the slenderness angle.")
    ] = 5e-3,
    largest_period: Annotated[int, whole("Looked for, in periods of the drive.")] = 16,
    out: Annotated[
        Path | None, Parameter(help="Folder of the results; default: outputs/NAME-response.")
    ] = None,
    overrides: Overrides = (),
    resume: Annotated[bool, flag("Go on where it was interrupted.")] = False,
    force: Force = False,
    as_json: Annotated[bool, flag("Print response.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Sweep the frequency of the drive up and down with the motion carried on: branches, jumps, drop-outs.

    Parameters
    ----------
    case:
        A case file or the name of a shipped case, with a harmonic motion; default: seed_stack_plateau.
    """
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
    # The solver is loaded only now: bad input is answered before anything is compiled.
    study = importlib.import_module("fem.response.run")
    done = study.run_response(
        request, folder=folder, force=force, resume=resume, reporter=ScreenReporter(quiet=quiet)
    )
    print(json.dumps(done.result, indent=2) if as_json else study.page_of(request, done.result, folder))
    return EXIT_CODES[done.status]
