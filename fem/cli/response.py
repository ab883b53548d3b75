"""`response`: long-time motion under a harmonic floor, frequency by frequency."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from fem.case.case import load_case
from fem.cli.console import CaseName, Force, Overrides, Quiet, Resume, flag, print_result, whole
from fem.results.kinds import RESPONSE
from fem.runtime.progress import ScreenReporter

if TYPE_CHECKING:
    from fem.response.lasting import ResponseResult
    from fem.response.request import ResponseRequest


def response(
    case: CaseName = None,
    /,
    *,
    first: Annotated[
        float | None,
        Parameter(name="--from", help="Lowest frequency of the floor [Hz]; default: 3/11 of the case's own."),
    ] = None,
    last: Annotated[
        float | None, Parameter(name="--to", help="Highest frequency [Hz]; default: 30/11 of the case's own.")
    ] = None,
    count: Annotated[int, whole("Number of frequencies, both ends included.")] = 28,
    hold: Annotated[
        Literal["displacement", "acceleration"] | None,
        Parameter(
            show_default=False,
            help="Amplitude of the floor that is kept constant; default: the one that the case gives.",
        ),
    ] = None,
    starts: Annotated[int, whole("Random states from which each frequency is begun as well; 0: none.")] = 8,
    shell: Annotated[bool, flag("Follow the elastic container, too, up and down.")] = False,
    settle: Annotated[int, whole("Periods to leave out at each frequency.")] = 60,
    observe: Annotated[int, whole("Periods to observe at each frequency.")] = 48,
    out: Annotated[
        Path | None, Parameter(help="Folder of the results; default: outputs/NAME-response.")
    ] = None,
    overrides: Overrides = (),
    resume: Resume = False,
    force: Force = False,
    as_json: Annotated[bool, flag("Print response.json.", "--json")] = False,
    quiet: Quiet = False,
) -> int:
    """Sweep the frequency of the floor up and down and from random states, as a rigid body: what lasts, what falls.

    --set solver.model=reduced follows the elastic container alone, --shell beside the rigid one.
    """
    requests = importlib.import_module("fem.response.request")
    loaded = load_case(case, ("solver.model=rigid", *overrides))
    own = loaded.angular_frequency / requests.TURN if loaded.motion.kind == "harmonic" else 1.0
    request = requests.ResponseRequest(
        case=loaded,
        first_Hz=requests.FROM * own if first is None else first,
        last_Hz=requests.TO * own if last is None else last,
        count=count,
        hold=hold,
        starts=starts,
        shell=shell,
        settle=settle,
        observe=observe,
    )
    folder = out if out is not None else Path("outputs") / f"{loaded.name}-response"
    study = importlib.import_module("fem.response.run")
    result = study.run_response(
        request, folder=folder, force=force, resume=resume, reporter=ScreenReporter(quiet=quiet)
    )
    return print_result(result, RESPONSE, folder, page_of(request, result, folder), as_json=as_json)


def page_of(request: "ResponseRequest", result: "ResponseResult", folder: Path) -> Iterator[str]:
    """The lines of a response curve, for people."""
    words = importlib.import_module("fem.response.answer")
    yield f"{result.case}: {result.title}" if result.title else result.case
    yield f"  drive       {request.held_in_words}; {request.observe} periods judged, after {request.settle}"
    for at, lasting in words.lasting_in_words(result):
        yield f"  {at.frequency_Hz:<8.4g} Hz {lasting}"
    yield f"  stable      {words.stable_in_words(result) or 'nothing was judged'}"
    for point in result.points:
        if point.status == "failed":
            yield f"  failed      {point.direction}, {point.frequency_Hz:.4g} Hz: {point.reason}"
    yield f"  files       {folder}"
