"""`run`: compute a case, from the file to the verdict."""

import importlib
import json
import sys
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fem.case.case import Case, CaseError, load_case
from fem.cli import console
from fem.cli.check import numerics_lines, preview_of
from fem.results.disk import free_disk, in_units
from fem.results.errors import OutputError
from fem.results.folder import read_result
from fem.runtime.memory import CHECKS, RIGID, memory_of, shortage
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say
from fem.runtime.user_files import read_text

OTHER_SIDE = "other-side"  #: the folder of the side across, in that of a run


def run(
    case: console.CaseName = None,
    /,
    *,
    out: console.Folder = None,
    overrides: console.Overrides = (),
    motion: console.Motion = None,
    allow_outside: console.AllowOutside = False,
    allow_baseline: console.AllowBaseline = False,
    check_rigid: Annotated[bool, console.flag("Compare with the analytic rigid block.")] = False,
    band: Annotated[
        bool | None,
        Parameter(
            show_default=False,
            help="Repeat it with its unknown inputs varied; default: all but a plain rest and the full model.",
        ),
    ] = None,
    margin: Annotated[
        bool | None,
        Parameter(
            show_default=False,
            help="Find the factor on the motion at which it overturns; default: as a band, where it takes seconds.",
        ),
    ] = None,
    both_sides: Annotated[
        bool, console.flag("Compute the side across, too, in a folder of its own behind the first.")
    ] = False,
    resume: console.Resume = False,
    force: console.Force = False,
    dry_run: Annotated[bool, console.flag("Print the plan and exit.")] = False,
    as_json: Annotated[bool, console.flag("Print run.json.", "--json")] = False,
    full: Annotated[bool, console.flag("Print the whole summary.")] = False,
    quiet: console.Quiet = False,
    verbose: Annotated[bool, console.flag("Print the plan before the run.", "--verbose", "-v")] = False,
) -> int:
    """Compute a case: does the container rest, slide, rock, slide-rock or overturn?"""
    if quiet and verbose:
        raise CaseError("-q and -v contradict each other; give one of them")
    loaded = load_case(
        case, overrides, motion=motion, allow_outside=allow_outside, allow_baseline=allow_baseline
    )
    folder = out if out is not None else Path("outputs") / loaded.name
    if dry_run or verbose:
        plan = plan_of(loaded, folder)
        text = json.dumps(plan, indent=2) if as_json else _page_of_plan(loaded, plan)
        say(text, file=sys.stdout if dry_run else sys.stderr)
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
        code = max(code, _ended(result, stopped, place))
    return code


def _ended(result: Any, stopped: bool, folder: Path) -> int:
    """The exit code of a run; says how an interrupted one goes on."""
    if result.status == "interrupted":
        say(
            f"interrupted; run the same command with --resume to continue from {folder / 'checkpoint.npz'}",
            file=sys.stderr,
        )
    elif stopped:
        say(
            "interrupted while it was repeated with other inputs; run the same command to continue",
            file=sys.stderr,
        )
    return console.EXIT_CODES["interrupted" if stopped else result.status]


def text_with_overrides(case: Case) -> str:
    """The case file as given, with the changes of the command line as comments at its end."""
    if not case.overrides:
        return case.text
    changes = "".join(f"#   --set {override!r}\n" for override in case.overrides)
    return f"{case.text.rstrip()}\n\n# Changed on the command line:\n{changes}"


def plan_of(case: Case, folder: Path) -> dict[str, Any]:
    """What would be computed, and its folder."""
    preview = preview_of(case)
    return {
        "case": case.name,
        "folder": str(folder),
        "free_bytes": free_disk(folder),
        "peak_floor_acceleration_m_s2": preview.peak,
        "peak_vertical_acceleration_m_s2": preview.vertical_peak,
        "numerics": preview.numerics,
    }


def _page_of_plan(case: Case, plan: dict[str, Any]) -> str:
    """The same for people."""
    there = " (exists)" if Path(plan["folder"]).exists() else ""
    if plan["free_bytes"] is not None:
        there += f", room for {in_units(plan['free_bytes'])}"
    lines = [
        f"{case.name}: {case.title}" if case.title else case.name,
        f"  folder      {plan['folder']}{there}",
        f"  floor       {case.motion.kind}, peak {plan['peak_floor_acceleration_m_s2']:.4g} m/s2",
    ]
    if (upward := plan["peak_vertical_acceleration_m_s2"]) is not None:
        lines.append(f"  vertical    {case.vertical.kind}, peak {upward:.4g} m/s2")
    return "\n".join(lines + numerics_lines(plan["numerics"]))
