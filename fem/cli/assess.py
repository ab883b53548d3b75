"""`assess`: verify a container at a site, by time histories for the action of EN 1998-1."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from fem.cli.console import STUDY, AllowBaseline, AllowOutside, StudyFlags, flag, print_result, print_short
from fem.results.kinds import SITE
from fem.runtime.progress import ScreenReporter

if TYPE_CHECKING:
    from fem.site.result import SiteResult


def assess(
    site: str,
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

    Parameters
    ----------
    site:
        A site file or the name of a shipped one: site, cologne.
    """
    request = importlib.import_module("fem.site.request").load_site(
        site, motion, allow_baseline=allow_baseline
    )
    folder = flags.folder(request.name)
    study = importlib.import_module("fem.site.run")
    with flags.options() as options:
        result = study.run_site(
            request, folder, allow_outside=allow_outside or bool(motion), quick=quick, **options
        )
    if pdf and result.status == "completed":
        report = importlib.import_module("fem.site.page").site_report
        ScreenReporter(quiet=flags.quiet).message(print_short(folder, report))
    return print_result(result, SITE, folder, page_of(result, folder), as_json=flags.as_json)


def page_of(result: "SiteResult", folder: Path) -> Iterator[str]:
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
