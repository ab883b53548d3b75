"""Studies of many runs: `sweep`, `ensemble`, `batch`, `response`, `assess` and `size`."""

import importlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from fem.case.case import load_case
from fem.cli.console import (
    PAGE,
    STUDY,
    AllowBaseline,
    AllowOutside,
    CaseName,
    Force,
    Overrides,
    Quiet,
    Resume,
    StudyFlags,
    flag,
    print_result,
    print_short,
    whole,
)
from fem.results.figures import TURNED, Place, figures_of
from fem.results.kinds import ENSEMBLE, HALL, RESPONSE, SITE, SIZE, SWEEP, ResultKind
from fem.results.outcome import Outcome
from fem.runtime.own_files import write_atomically
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say

if TYPE_CHECKING:
    from fem.response.lasting import ResponseResult
    from fem.response.request import ResponseRequest
    from fem.site.result import SiteResult
    from fem.site.size import SizeResult
    from fem.study.fragility import EnsembleResult
    from fem.study.list_file import HallResult
    from fem.study.sweep_table import SweepResult

SiteFile = Annotated[
    str, Parameter(name="SITE", help="A site file or the name of a shipped one: site, cologne.")
]
Pdf = Annotated[bool, flag("Print the short page to report-short.pdf, by Chromium or Chrome.", "--pdf")]


def _of(place: str) -> Any:
    """What a module `fem.PLACE:name` has: what computes is loaded when the input was read."""
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(f"fem.{module}"), name)


def _ended(
    kind: ResultKind,
    name: str,
    flags: StudyFlags,
    compute: str,
    *asked: Any,
    lines: Callable[..., Iterable[str]],
    then: Callable[[Any, Path], None] = lambda result, folder: None,
    **options: Any,
) -> int:
    """Compute a study into its folder and print its result; the exit code.

    Args:
        name: of the folder, where none is given.
        compute: what computes it, of what is asked.
        lines: of the result and its folder, for people.
        then: is called before these are printed.
    """
    folder = flags.folder(name)
    with flags.options() as given:
        result = _of(compute)(*asked, folder=folder, **given, **options)
    then(result, folder)
    return print_result(result, kind, folder, lines(result, folder), as_json=flags.as_json)


def sweep(sweep: str, /, *, flags: StudyFlags = STUDY) -> int:
    """Compute the cases of a sweep: where does the container rest, slide, rock or overturn?

    Parameters
    ----------
    sweep:
        A sweep file or the name of a shipped sweep (see `python -m fem list`).
    """
    plan = _of("study.file:load_sweep")(sweep)
    return _ended(SWEEP, plan.name, flags, "study.sweep:run_sweep", plan, lines=_of_sweep)


def explore(sweep: str = "explorer", /, *, flags: StudyFlags = STUDY) -> int:
    """Compute a sweep, or take it as it is computed, and make one HTML file with a slider for each axis of it.

    Parameters
    ----------
    sweep:
        A sweep file or the name of a shipped sweep.
    """
    plan = _of("study.file:load_sweep")(sweep)

    def page(info: "SweepResult", folder: Path) -> None:
        if info.state == "finished":
            target = folder / "explorer.html"
            write_atomically(target, _of("report.explorer:explorer")(plan, folder, flags.jobs))
            say(target)

    return _ended(SWEEP, plan.name, flags, "study.sweep:run_sweep", plan, lines=_of_sweep, then=page)


def _of_sweep(info: "SweepResult", folder: Path) -> Iterator[str]:
    yield f"{info.sweep}{f': {info.title}' if info.title else ''}"
    yield f"  {info.rows} of {info.cells} cells, {info.status}"
    if info.motion_covered:
        yield f"  under {info.motion_covered}"
    for outcome, count in info.outcomes.items():
        yield f"  {outcome:12} {count:>8}  {100.0 * count / max(info.rows, 1):5.1f} %"
    if info.sure:
        yield f"  {info.held or 'of the outcomes'}"
        for word, count in info.sure.items():
            yield f"  {word:13} {count:>7}  {100.0 * count / max(info.rows, 1):5.1f} %"
        yield f"  by {info.copies} copies of {info.perturbed} cells"
        if info.decided_by:
            named = ", ".join(f"{key} ({count})" for key, count in list(info.decided_by.items())[:4])
            yield f"  unsure cells are decided by {named}"
        if info.left_out:
            yield f"  left out: {info.left_out}"
    table = "table.csv" if info.state == "finished" else "rows.csv"
    yield f"  {folder}: {table}, sweep.json" + "".join(f", {name}" for name in info.maps)
    if info.changes is not None:
        yield f"  {folder}: thresholds.csv, {info.changes} changes of outcome refined {info.held}".rstrip()
    if info.answer:
        answer = _of("study.sweep_table:sweep_answer")(_of("study.sweep_table:open_sweep")(folder), folder)
        yield from _of("study.answers:table_lines")(answer.lines() if answer else (), "answers.csv")


def ensemble(ensemble: str, /, *, flags: StudyFlags = STUDY) -> int:
    """Sample the uncertain parameters and count how often the container overturns, with confidence intervals.

    Parameters
    ----------
    ensemble:
        An ensemble file or the name of a shipped one: fragility, boundary.
    """
    plan = _of("study.file:load_ensemble")(ensemble)
    return _ended(ENSEMBLE, plan.name, flags, "study.ensemble:run_ensemble", plan, lines=_of_ensemble)


def _of_ensemble(result: "EnsembleResult", folder: Path) -> Iterator[str]:
    yield f"{result.ensemble}: {result.title}" if result.title else result.ensemble
    each = "to rest" if isinstance(result.duration_s, str) else f"{result.duration_s:g} s"
    yield (
        f"  {len(result.points)} points x {result.draws} draws ({result.sampling}, seed {result.seed}), "
        f"model {result.model}, {each} each, {result.status}"
    )
    if result.motion_covered:
        yield f"  under {result.motion_covered}"
    count = len(result.random.get(_of("study.axes:MOTION_FILE"), ()))
    motions = f"the intervals are those of a sample of {count} motions"
    motions = motions if count else "the floor's motion is not random"
    yield f"  random: {', '.join(result.random)}; {motions}"
    if result.drawn_over_uncertainty:
        yield f"  drawn as unknown inputs: {', '.join(result.drawn_over_uncertainty)}"
    if result.held:
        yield f"  held: {result.held}"
    limit, falling = f"{result.probability:g}", _of("study.answers:falling_in_words")(result.limit_slip_m)
    regions = {
        "below": f"probability of {falling} at most {limit}",
        "undecided": f"the {100.0 * result.confidence:g} % interval holds {limit}",
        "above": f"more than {limit}",
    }
    for name, count in result.regions.items():
        yield f"  {name:10} {count:>6} points  {regions[name]}"
    if result.failed:
        yield f"  failed     {result.failed:>6} draws; the intervals allow for either outcome of these"
    for name, line in _of("study.answers:fragility_lines")(result):
        yield f"  {name:10} {line}"
    yield f"  files      {folder}"
    if answer := _of("study.answers:ensemble_answer")(result):
        yield from _of("study.answers:table_lines")(answer.lines())


def batch(
    hall: Path,
    /,
    *,
    case: Annotated[str, Parameter(show_default=False, help="The case that the rows change.")],
    motion: Annotated[
        tuple[str, ...],
        Parameter(
            name="--motion",
            consume_multiple=True,
            negative=(),
            show_default=False,
            help="Records in place of the motion of the case, anywhere, or pairs H,V; each container undergoes all.",
        ),
    ] = (),
    margins: Annotated[
        Literal["weakest", "all", "none"],
        Parameter(
            help="Whose run is repeated for sure and margin: the weakest tenth (at least 30), all, none."
        ),
    ] = "weakest",
    one_side: Annotated[bool, flag("Leave out a narrower side across; else the worse governs.")] = False,
    overrides: Overrides = (),
    allow_outside: AllowOutside = False,
    pdf: Pdf = False,
    flags: StudyFlags = STUDY,
) -> int:
    """Compute a list of containers: which rest, slide, rock or overturn, and which is the weakest?

    The header names keys of a case (width_m, mass_kg, mu_static, container.wall_m), name, count, tag; other columns are
    kept. A bad row is a row with its reason. Writes hall.csv, hall.json, report.html.

    Parameters
    ----------
    hall:
        The list, as CSV.
    """
    listed = _of("study.list_file:read_hall")(hall)
    base = load_case(case, overrides, allow_outside=allow_outside)

    def with_page(result: "HallResult", folder: Path) -> None:
        report = _of("report.study_page:hall_report")
        if result.state == "finished" and not (folder / PAGE).is_file():
            write_atomically(folder / PAGE, report(folder))
        if pdf and result.status == "completed":
            say(print_short(folder, report))

    asked: dict[str, Any] = {"motions": motion, "checks": margins, "one_side": one_side, "then": with_page}
    return _ended(HALL, listed.name, flags, "study.hall:run_hall", listed, base, lines=_of_hall, **asked)


def _of_hall(result: "HallResult", folder: Path) -> Iterator[str]:
    yield result.hall
    yield f"  {result.extent}, model {result.model}, {result.status}"
    if result.kept:
        yield f"  kept       {', '.join(result.kept)}"
    for outcome, count in result.outcomes.items():
        yield f"  {outcome:13} {count:>7}"
    if bad := [(f"row {row['row']} {row['name']}", row["reason"]) for row in result.not_computed]:
        yield f"  refused    {len(bad)} of {result.rows} rows"
        yield from _of("study.answers:table_lines")(bad, "hall.csv")
    if result.checked and result.state == "finished":
        yield f"  sure and margin of the weakest {result.checked}"
    yield from _of("study.answers:table_lines")(
        [(row["name"], _row_in_words(row)) for row in result.ranked[:10]]
    )
    written = ": hall.csv, hall.json, report.html" if result.state == "finished" else ""
    yield f"  files      {folder}{written}"


def _row_in_words(row: dict[str, object]) -> str:
    """A container in a line."""
    words = [str(row["outcome"] or row["reason"]) + " across its depth" * (row["side"] == "depth")]
    if isinstance(row["margin"], float):
        words.append(f"overturns from {row['margin']:.3g} times the motion on")
    elif isinstance(row["margin_tried_to"], float):
        words.append(f"does not overturn up to {row['margin_tried_to']:.3g} times the motion")
    for key, figure in figures_of(Place.KEY).items():
        if isinstance(value := row[key], float) and (key, row["outcome"]) != (TURNED, Outcome.OVERTURNED):
            words.append(f"{figure.head or figure.words} {figure.text(value)}")
    return ", ".join(words)


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
    loaded = load_case(case, ("solver.model=rigid", *overrides))
    request = _of("response.request:request_of")(
        loaded,
        first,
        last,
        count=count,
        hold=hold,
        starts=starts,
        shell=shell,
        settle=settle,
        observe=observe,
    )

    def lines(result: "ResponseResult", folder: Path) -> Iterator[str]:
        return _of_response(request, result, folder)

    flags = StudyFlags(out=out, resume=resume, force=force, as_json=as_json, quiet=quiet)
    return _ended(
        RESPONSE, f"{loaded.name}-response", flags, "response.run:run_response", request, lines=lines
    )


def _of_response(request: "ResponseRequest", result: "ResponseResult", folder: Path) -> Iterator[str]:
    yield f"{result.case}: {result.title}" if result.title else result.case
    yield f"  drive       {request.held_in_words}; {request.observe} periods judged, after {request.settle}"
    for at, lasting in _of("response.answer:lasting_in_words")(result):
        yield f"  {at.frequency_Hz:<8.4g} Hz {lasting}"
    yield f"  stable      {_of('response.answer:stable_in_words')(result) or 'nothing was judged'}"
    for point in result.points:
        if point.status == "failed":
            yield f"  failed      {point.direction}, {point.frequency_Hz:.4g} Hz: {point.reason}"
    yield f"  files       {folder}"


def assess(
    site: SiteFile,
    /,
    *,
    flags: StudyFlags = STUDY,
    motion: Annotated[
        tuple[str, ...],
        flag(
            "A record in place of the motions of the site, anywhere, or a pair H,V; repeat it for each.",
            "--motion",
        ),
    ] = (),
    allow_outside: AllowOutside = False,
    allow_baseline: AllowBaseline = False,
    quick: Annotated[
        bool,
        flag('The set of motions and its repetitions alone; its answer is never "fulfilled" if it moves.'),
    ] = False,
    pdf: Annotated[
        bool, flag("Print two sheets of the page to report-short.pdf, by Chromium or Chrome.")
    ] = False,
) -> int:
    """Verify a container at a site: overturning and slip under motions for the site, by EN 1998-1, 4.4.2.4(2).

    Motions that match the spectra of the site, the container full and empty, over the range of friction, with both
    signs of the vertical motion; the answer by a stated rule and limits, beside simplified methods. Writes
    report.html and assess.json.
    """
    request = _of("site.request:load_site")(site, motion, allow_baseline=allow_baseline)

    def with_pdf(result: "SiteResult", folder: Path) -> None:
        if pdf and result.status == "completed":
            printed = print_short(folder, _of("site.page:site_report"))
            ScreenReporter(quiet=flags.quiet).message(printed)

    asked: dict[str, Any] = {"allow_outside": allow_outside or bool(motion), "quick": quick, "then": with_pdf}
    return _ended(SITE, request.name, flags, "site.run:run_site", request, lines=site_lines, **asked)


def site_lines(result: "SiteResult", folder: Path) -> Iterator[str]:
    """The lines of a verification, for people."""
    action, motions, answer = result.action, result.set, result.result
    yield f"{folder.name}: {result.title}" if result.title else folder.name
    yield (
        f"  action     {action.source}; a_g S = {action.ag_S_m_s2:.3g} m/s2, a_vg = {action.avg_m_s2:.3g} m/s2"
    )
    if result.floor and result.floor.z_over_h is None:
        yield f"  floor      given by {result.floor.building}; taken as it is, without any factor"
    least = f"least mean over target {motions.least_ratio:.2f} at {motions.least_ratio_period_s:.2g} s, "
    yield (
        f"  motions    {motions.count}, {motions.source}: mean peak {motions.mean_pga_m_s2:.3g} m/s2, "
        f"{'' if motions.source == 'floor' else least}largest correlation "
        f"{motions.largest_correlation:.2f}: {'valid' if motions.valid else 'not valid'}"
    )
    yield from (f"  note       {note}" for note in motions.notes)

    def destroyed(count: int) -> str:
        return f", {count} destroyed a corner" if count else ""

    still = f"; {answer.still} not computed: no rigid body moves in them" if answer.still else ""
    yield f"  runs       {answer.runs}, {answer.overturned} overturned{destroyed(answer.invalid)}{still}"
    for single in answer.actions:
        used = "" if single.utilisation is None else f", utilisation {single.utilisation:.3g}"
        yield f"  {single.name:<10} {single.answer or 'no answer'}{used}"
    if answer.scan:
        fails, first = (
            "none" if factor is None else f"{'at most ' * answer.is_least_tried(factor)}{factor:.3g}"
            for factor in (answer.margin_factor, answer.factor_at_first_overturning)
        )
        yield (
            f"  factor     on the motions at which the rule first fails: {fails}, first overturning: {first}; tried "
            f"up to {max(point.factor for point in answer.scan):g}"
        )
    for further in answer.further:
        yield (
            f"  further    {further.overturned} of {further.motions} motions overturn it{destroyed(further.invalid)}, "
            f"{further.beyond_limits} go beyond a limit of one motion ({further.mass}, friction "
            f"{further.mu_static:.3g}/{further.mu_kinetic:.3g})"
        )
    yield f"  rule       {answer.rule}"
    if result.inputs.unstated:
        yield f"  sources    not to be signed: nobody stands for {', '.join(result.inputs.unstated)}"
    yield f"  files      {folder}"


def size(
    site: SiteFile,
    /,
    *,
    over: Annotated[
        str, Parameter(help="The key: container.width_m, container.boxes, contact.mu_static, site...")
    ],
    low: Annotated[
        float | None,
        Parameter(name="--from", show_default=False, help="Least value; default: as suits the key."),
    ] = None,
    high: Annotated[float | None, Parameter(name="--to", show_default=False, help="Largest value.")] = None,
    count: Annotated[int | None, whole("Values of the scan; default: 13.")] = None,
    flags: StudyFlags = STUDY,
    allow_outside: AllowOutside = False,
) -> int:
    """Find the least width, the tallest stack, the window of friction or the strongest action that fulfils the rule."""
    request = _of("site.request:load_site")(site)
    axis = _of("site.size:size_axis")(request, over, low=low, high=high, count=count)
    name, compute = f"{request.name}_size", "site.size_run:run_size"
    return _ended(SIZE, name, flags, compute, request, axis, lines=_of_size, allow_outside=allow_outside)


def _of_size(result: "SizeResult", folder: Path) -> Iterator[str]:
    keys = " and ".join([result.key, *result.followers])
    tried = f"{len(result.points)} values from {result.low:g} to {result.high:g} {result.unit}"
    yield f"{keys}: {tried}".rstrip()
    fulfilled = sum(bool(point.fulfilled) for point in result.points)
    yield f"  fulfilled  at {fulfilled} of them, {sum(point.runs for point in result.points)} runs of their sets"
    yield f"  files      {folder}"
