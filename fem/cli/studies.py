"""Studies of many runs: `sweep`, `ensemble`, `batch`, `response`, `assess` and `size`."""

import importlib
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from fem.case.case import load_case
from fem.case.validation import CaseError
from fem.cli import console
from fem.results.errors import require_writable
from fem.results.kinds import ENSEMBLE, HALL, RESPONSE, SITE, SIZE, SWEEP, ResultKind
from fem.runtime.own_files import write_atomically
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say

if TYPE_CHECKING:
    from fem.response.lasting import ResponseResult
    from fem.site.result import SiteResult
    from fem.study.fragility import EnsembleResult
    from fem.study.hall_result import HallResult
    from fem.study.sweep_table import SweepResult

SiteFile = Annotated[str, console.option("A site file or the name of a shipped one: site, cologne.", "SITE")]
Motions = Annotated[tuple[str, ...], Parameter(name="--motion")]


def _of(place: str) -> Any:
    """What a module `fem.PLACE:name` has: what computes is loaded when the input was read."""
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(f"fem.{module}"), name)


def _ended(
    kind: ResultKind,
    name: str,
    flags: console.StudyFlags,
    compute: str,
    *asked: Any,
    shown: Callable[[Any, Path], Mapping[str, Any]] = lambda result, folder: {},
    **options: Any,
) -> int:
    """Compute a study into its folder and print its result; the exit code.

    Args:
        name: of the folder, where none is given.
        compute: what computes it, of what is asked.
        shown: what the template of its page for the terminal names beside the result and its folder.
    """
    folder = flags.out if flags.out is not None else Path("outputs") / name
    require_writable(folder)  # motions may take long before it is opened
    cluster: AbstractContextManager[Any] = nullcontext()
    if flags.scheduler is not None:
        try:  # the optional dask is loaded here
            cluster = _of("study.cluster:cluster")(flags.scheduler)
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] not in ("dask", "distributed"):
                raise
            words = "--scheduler needs the extra 'cluster': python -m pip install \"unanchored[cluster]\""
            raise CaseError(words) from None
    options |= {"jobs": flags.jobs, "resume": flags.resume, "force": flags.force}
    with cluster as workers_of:  # those of a cluster are released at the end
        reporter = ScreenReporter(quiet=flags.quiet)
        result = _of(compute)(*asked, folder=folder, workers_of=workers_of, reporter=reporter, **options)
    more, template = shown(result, folder), f"{Path(kind.mark).stem}.txt.j2"
    page = "" if flags.as_json else _of("html.page:text_of")(template, result=result, folder=folder, **more)
    return console.print_result(result, kind, folder, page, as_json=flags.as_json)


def _print_short(folder: Path, report: Callable[..., str]) -> str:
    """Write the short page of a folder and print it, as `console.print_to_pdf`."""
    page = folder / console.SHORT_PAGE
    write_atomically(page, report(folder, brief=True))
    return console.print_to_pdf(page)


def sweep(sweep: str, /, *, flags: console.StudyFlags = console.STUDY) -> int:
    """Compute the cases of a sweep: where does the container rest, slide, rock or overturn?

    Args:
        sweep: A sweep file or the name of a shipped sweep (see `python -m fem list`).
    """
    return _swept(sweep, flags)


def explore(sweep: str = "explorer", /, *, flags: console.StudyFlags = console.STUDY) -> int:
    """Compute a sweep, or take it as it is computed, and make one HTML file with a slider for each axis of it.

    Args:
        sweep: A sweep file or the name of a shipped sweep.
    """
    return _swept(sweep, flags, "report.explorer:explorer")


def _swept(sweep: str, flags: console.StudyFlags, page: str = "") -> int:
    plan = _of("study.file:load_sweep")(sweep)

    def shown(result: "SweepResult", folder: Path) -> dict[str, Any]:
        answer = target = None
        if result.answer:
            answer = _of("study.answers:sweep_answer")(_of("study.sweep_table:open_sweep")(folder), folder)
        if page and result.state == "finished":
            target = folder / "explorer.html"
            write_atomically(target, _of(page)(plan, folder, flags.jobs))
        return {"answers": list(answer.lines()) if answer else [], "explorer": target}

    return _ended(SWEEP, plan.name, flags, "study.sweep:run_sweep", plan, shown=shown)


def ensemble(ensemble: str, /, *, flags: console.StudyFlags = console.STUDY) -> int:
    """Sample the uncertain parameters and count how often the container overturns, with confidence intervals.

    Args:
        ensemble: An ensemble file or the name of a shipped one: fragility, boundary.
    """
    plan = _of("study.file:load_ensemble")(ensemble)

    def shown(result: "EnsembleResult", folder: Path) -> dict[str, Any]:
        answer = _of("study.answers:ensemble_answer")(result)
        return {
            "answers": list(answer.lines()) if answer else [],
            "falling": _of("study.answers:falling_in_words")(result.limit_slip_m),
            "motions": result.random.get(_of("study.axes:MOTION_FILE"), ()),
        }

    return _ended(ENSEMBLE, plan.name, flags, "study.ensemble:run_ensemble", plan, shown=shown)


def batch(
    hall: Path,
    /,
    *,
    case: str,
    motion: Annotated[Motions, Parameter(consume_multiple=True)] = (),
    margins: Literal["weakest", "all", "none"] = "weakest",
    one_side: bool = False,
    overrides: console.Overrides = (),
    allow_outside: console.AllowOutside = False,
    pdf: bool = False,
    flags: console.StudyFlags = console.STUDY,
) -> int:
    """Compute a list of containers: which rest, slide, rock or overturn, and which is the weakest?

    The header names keys of a case (width_m, mass_kg, mu_static, container.wall_m), name, count, tag; other columns are
    kept. A bad row is a row with its reason. Writes hall.csv, hall.json, report.html.

    Args:
        hall: The list, as CSV.
        case: The case that the rows change.
        motion: Records in place of the motion of the case, anywhere, or pairs H,V; each container undergoes all.
        margins: Whose run is repeated for sure and margin: the weakest tenth (at least 30), all, none.
        one_side: Leave out a narrower side across; else the worse governs.
        pdf: Print the short page to report-short.pdf, by Chromium or Chrome.
    """
    listed = _of("study.hall_file:read_hall")(hall)
    base = load_case(case, overrides, allow_outside=allow_outside)

    def shown(result: "HallResult", folder: Path) -> dict[str, Any]:
        report = _of("report.study_page:hall_report")
        if result.state == "finished" and not (folder / console.PAGE).is_file():
            write_atomically(folder / console.PAGE, report(folder))
        if pdf and result.status == "completed":
            say(_print_short(folder, report))
        return {}

    asked: dict[str, Any] = {"motions": motion, "checks": margins, "one_side": one_side, "shown": shown}
    return _ended(HALL, listed.name, flags, "study.hall:run_hall", listed, base, **asked)


def response(
    case: console.CaseName = None,
    /,
    *,
    first: Annotated[float | None, Parameter(name="--from")] = None,
    last: Annotated[float | None, Parameter(name="--to")] = None,
    count: Annotated[int, console.WHOLE] = 28,
    hold: Literal["displacement", "acceleration"] | None = None,
    starts: Annotated[int, console.WHOLE] = 8,
    shell: bool = False,
    settle: Annotated[int, console.WHOLE] = 60,
    observe: Annotated[int, console.WHOLE] = 48,
    out: Path | None = None,
    overrides: console.Overrides = (),
    resume: console.Resume = False,
    force: console.Force = False,
    as_json: Annotated[bool, console.option("Print response.json.", "--json")] = False,
    quiet: console.Quiet = False,
) -> int:
    """Sweep the frequency of the floor up and down and from random states, as a rigid body: what lasts, what falls.

    --set solver.model=reduced follows the elastic container alone, --shell beside the rigid one.

    Args:
        first: Lowest frequency of the floor [Hz]; default: 3/11 of the case's own.
        last: Highest frequency [Hz]; default: 30/11 of the case's own.
        count: Number of frequencies, both ends included.
        hold: Amplitude of the floor that is kept constant; default: the one that the case gives.
        starts: Random states from which each frequency is begun as well; 0: none.
        shell: Follow the elastic container, too, up and down.
        settle: Periods to leave out at each frequency.
        observe: Periods to observe at each frequency.
        out: Folder of the results; default: outputs/NAME-response.
    """
    loaded = load_case(case, ("solver.model=rigid", *overrides))
    more = {"count": count, "hold": hold, "starts": starts, "settle": settle, "observe": observe}
    request = _of("response.request:request_of")(loaded, first, last, shell=shell, **more)

    def shown(result: "ResponseResult", folder: Path) -> dict[str, Any]:
        return {"asked": request, "stable": _of("response.lasting:stable_in_words")(result)}

    flags = console.StudyFlags(out=out, resume=resume, force=force, as_json=as_json, quiet=quiet)
    name, compute = f"{loaded.name}-response", "response.run:run_response"
    return _ended(RESPONSE, name, flags, compute, request, shown=shown)


def assess(
    site: SiteFile,
    /,
    *,
    flags: console.StudyFlags = console.STUDY,
    motion: Motions = (),
    allow_outside: console.AllowOutside = False,
    allow_baseline: console.AllowBaseline = False,
    quick: bool = False,
    pdf: bool = False,
) -> int:
    """Verify a container at a site: overturning and slip under motions for the site, by EN 1998-1, 4.4.2.4(2).

    Motions that match the spectra of the site, the container full and empty, over the range of friction, with both
    signs of the vertical motion; the answer by a stated rule and limits, beside simplified methods. Writes
    report.html and assess.json.

    Args:
        motion: A record in place of the motions of the site, anywhere, or a pair H,V; repeat it for each.
        quick: The set of motions and its repetitions alone; its answer is never "fulfilled" if it moves.
        pdf: Print two sheets of the page to report-short.pdf, by Chromium or Chrome.
    """
    request = _of("site.request:load_site")(site, motion, allow_baseline=allow_baseline)

    def shown(result: "SiteResult", folder: Path) -> dict[str, Any]:
        if pdf and result.status == "completed":
            printed = _print_short(folder, _of("site.page:site_report"))
            ScreenReporter(quiet=flags.quiet).message(printed)
        return {}

    asked: dict[str, Any] = {"allow_outside": allow_outside or bool(motion), "quick": quick, "shown": shown}
    return _ended(SITE, request.name, flags, "site.run:run_site", request, **asked)


def size(
    site: SiteFile,
    /,
    *,
    over: str,
    low: Annotated[float | None, Parameter(name="--from")] = None,
    high: Annotated[float | None, Parameter(name="--to")] = None,
    count: Annotated[int | None, console.WHOLE] = None,
    flags: console.StudyFlags = console.STUDY,
    allow_outside: console.AllowOutside = False,
) -> int:
    """Find the least width, the tallest stack, the window of friction or the strongest action that fulfils the rule.

    Args:
        over: The key: container.width_m, container.boxes, contact.mu_static, site...
        low: Least value; default: as suits the key.
        high: Largest value.
        count: Values of the scan; default: 13.
    """
    request = _of("site.request:load_site")(site)
    axis = _of("site.size:size_axis")(request, over, low=low, high=high, count=count)
    name, compute = f"{request.name}_size", "site.size:run_size"
    return _ended(SIZE, name, flags, compute, request, axis, allow_outside=allow_outside)
