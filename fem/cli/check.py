"""`run`: compute a case, from the file to the verdict; `check`: what can be said of it without solving it."""

import importlib
import json
import math
import sys
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from textwrap import fill
from typing import Annotated, Any

from cyclopts import Parameter

from fem.case.case import Case, case_hash, load_case
from fem.case.files import kind_of
from fem.case.tables.duration import longest_time
from fem.case.validation import CaseError
from fem.cli import console
from fem.html.page import text_of
from fem.model.geometry import build_container, node_count
from fem.model.motion_summary import summary_from_keys
from fem.results.disk import free_disk, in_units
from fem.results.errors import OutputError
from fem.results.kinds import read_result
from fem.run.described import floor_rows, link_rows, motion_in_words, part_covered, sides_in_words, sides_of
from fem.run.preview import Preview
from fem.runtime.memory import CHECKS, RIGID, memory_of, shortage
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say
from fem.runtime.user_files import read_text

OTHER_SIDE = "other-side"  #: the folder of the side across, in that of a run
MOST_NODES = 20_000  #: up to which a container is settled on its floor, in some 2 s


def run(
    case: console.CaseName = None,
    /,
    *,
    out: console.Out = None,
    overrides: console.Overrides = (),
    motion: console.Motion = None,
    allow_outside: console.AllowOutside = False,
    allow_baseline: console.AllowBaseline = False,
    check_rigid: bool = False,
    band: Annotated[bool | None, Parameter(negative="--no-band")] = None,
    margin: Annotated[bool | None, Parameter(negative="--no-margin")] = None,
    both_sides: bool = False,
    resume: console.Resume = False,
    force: console.Force = False,
    dry_run: bool = False,
    as_json: Annotated[bool, console.option("Print run.json.", "--json")] = False,
    full: bool = False,
    quiet: console.Quiet = False,
    verbose: Annotated[bool, Parameter(name=("--verbose", "-v"))] = False,
) -> int:
    """Compute a case: does the container rest, slide, rock, slide-rock or overturn?

    Args:
        check_rigid: Compare with the analytic rigid block.
        band: Repeat it with its unknown inputs varied; default: all but a plain rest and the full model.
        margin: Find the factor on the motion at which it overturns; default: as a band, where it takes seconds.
        both_sides: Compute the side across, too, in a folder of its own behind the first.
        dry_run: Print the plan and exit.
        full: Print the whole summary.
        verbose: Print the plan before the run.
    """
    loaded = load_case(
        case, overrides, motion=motion, allow_outside=allow_outside, allow_baseline=allow_baseline
    )
    folder = out if out is not None else Path("outputs") / loaded.name
    if dry_run or verbose:
        say(_plan(loaded, folder, as_json=as_json), file=sys.stdout if dry_run else sys.stderr)
    if dry_run:
        return 0
    alone = (band, margin) == (False, False)
    needed = RIGID + CHECKS * (not alone)
    if loaded.solver.model != "rigid":
        needed = memory_of(True, 1 if alone else None)
    if short := shortage(needed):
        if band or margin or loaded.solver.model != "rigid" or shortage(RIGID):
            raise OutputError(short)
        band = margin = False
        say(f"band and margin are left out: {short}, and the same command adds them", file=sys.stderr)
    solver = importlib.import_module("fem.run.run")
    options = solver.RunOptions(check_rigid=check_rigid, band=band, margin=margin, resume=resume, force=force)
    brief = importlib.import_module("fem.run.summary").brief_summary
    other = loaded.other_side() if both_sides else None
    code = 0
    for side, place in ((loaded, folder), *([(other, folder / OTHER_SIDE)] if other is not None else [])):
        result = solver.run_case(
            side,
            case_text=text_with_overrides(side),
            folder=place,
            options=options,
            reporter=ScreenReporter(quiet=quiet),
        )
        stopped = solver.was_stopped(result, options)
        if as_json:
            console.print_json(json.dumps(read_result(place / "run.json"), indent=2))
        else:
            if other is not None:
                say(
                    f"{'Across' if side is other else 'As given'}, {side.container.width_m:g} m along the motion:"
                )
            whole = read_text(place / "summary.txt")
            say(whole if full else brief(result.typed_result, folder=place), end="")
        if stopped:
            on = " while it was repeated with other inputs; run the same command to continue"
            if result.status == "interrupted":
                on = f"; run the same command with --resume to continue from {place / 'checkpoint.npz'}"
            say(f"interrupted{on}", file=sys.stderr)
        code = max(code, console.EXIT_CODES["interrupted" if stopped else result.status])
    return code


def text_with_overrides(case: Case) -> str:
    """The case file as given, with the changes of the command line as comments at its end."""
    if not case.overrides:
        return case.text
    changes = "".join(f"#   --set {override!r}\n" for override in case.overrides)
    return f"{case.text.rstrip()}\n\n# Changed on the command line:\n{changes}"


def _plan(case: Case, folder: Path, *, as_json: bool) -> str:
    """What would be computed, and its folder."""
    preview, free = preview_of(case), free_disk(folder)
    if as_json:
        plan = {
            "case": case.name,
            "folder": str(folder),
            "free_bytes": free,
            "peak_floor_acceleration_m_s2": preview.peak,
            "peak_vertical_acceleration_m_s2": preview.vertical_peak,
            "numerics": preview.numerics,
        }
        return json.dumps(plan, indent=2)
    return _page("plan", preview, folder=folder, free=free)


def check(
    case: console.CaseName = None,
    /,
    *,
    overrides: console.Overrides = (),
    motion: console.Motion = None,
    allow_outside: console.AllowOutside = False,
    allow_baseline: console.AllowBaseline = False,
    both_sides: bool = False,
    as_json: console.AsJson = False,
) -> None:
    """Print static checks, derived numbers and numerical settings of a case; nothing is computed or written.

    Of a site file: its motions, what they move, and how many runs and how long a verification takes.

    Args:
        both_sides: Check the side across, too.
    """
    if case is not None and kind_of(case) == "site":
        if overrides or motion is not None:
            raise CaseError(f"{case}: a site file takes neither --set nor --motion; edit the file")
        files = importlib.import_module("fem.site.request")
        previews = importlib.import_module("fem.site.preview")
        request = files.load_site(case, allow_baseline=allow_baseline)
        say(previews.preview_of(request, allow_outside=allow_outside, as_json=as_json))
        return
    loaded = load_case(
        case, overrides, motion=motion, allow_outside=allow_outside, allow_baseline=allow_baseline
    )
    other = loaded.other_side() if both_sides else None
    for side in (loaded, *filter(None, (other,))):
        preview = preview_of(side)
        document = {"case": side.name, "asked_hash": case_hash(side)} | preview.to_json()
        say(json.dumps(document, indent=2) if as_json else _checks(preview, document))


def preview_of(case: Case) -> Preview:
    """What is known of a run of the case; a CaseError where a run of up to `MOST_NODES` nodes would be refused.

    A motion is evaluated, and the container settled on its floor, only where it must be: compiled functions take long
    to load.
    """
    summary, mesh, duration = summary_from_keys(case), build_container(case), longest_time(case)
    if summary is None:
        module = importlib.import_module("fem.model.motion")
        motions = module.build_motions(case)
        summary, duration = module.motion_result(case, *motions), module.longest_run(case, *motions)
    preview = Preview(case=case, mesh=mesh, motion=summary, duration=duration)
    if not preview.stands_plainly and node_count(mesh, case.solver.order) <= MOST_NODES:
        motions = importlib.import_module("fem.model.motion").build_motions(case)
        resolved = importlib.import_module("fem.run.compute").resolve(case, mesh, motions)
        importlib.import_module("fem.model.model").build_model(resolved, motions=motions)
    return preview


def _checks(preview: Preview, document: Mapping[str, Any]) -> str:
    case, static, code = preview.case, preview.static, preview.static.by_code
    named = [("own motion", static.own_motion), ("own, vertical", static.own_motion_vertical)]
    if code is not None:
        named += [(f"code, q = {code.values.behaviour_factor:g}", code.as_given), ("code, q = 1", code.q1)]
    named.append(("wind", static.wind))
    return _page(
        "checks",
        preview,
        actions={name: action for name, action in named if action is not None},
        degrees=math.degrees,
        derived=document["derived"],
        motion_in_words=motion_in_words,
        notes=document["notes"],
        part=part_covered(preview.motion),
        restitution=document["contact_restitution"],
        rows=[*floor_rows(preview.floor), *link_rows(case)],
        sides=sides_in_words(
            sides_of(case.stack[0].width, case.container.depth_m, static.to_result())
        ).removeprefix(". "),
        wrapped=partial(fill, width=console.WIDTH),
    )


def _page(macro: str, preview: Preview, **shown: Any) -> str:
    """What a macro of `check.txt.j2` says of a case."""
    named = {"case": preview.case, "preview": preview, "numerics": preview.numerics, "in_units": in_units}
    return text_of("check.txt.j2", macro, **named, **shown)
