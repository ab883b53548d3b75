"""The end of a run on screen and in `summary.txt`: the static rule beside what the run found.

Made from the keys of `run.json` alone, in units for people (kN, kNm, mm, degrees). Only the static rule under
this run's own peak floor acceleration is compared with the run; the code's base shear is a second matter and
stands below it. A run says what happened under its motion and nothing beyond.
"""

import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.box import SIMPLE
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from fem.assessment.summary_joints import joint_table
from fem.results.run_result import JointDemand

Result = Mapping[str, Any]

TEXT_WIDTH = 110
INVISIBLE = 1e-9  #: in the units of people: smaller numbers are rounding
#: what is smaller is told as smaller than that: lengths [m], rotations [degrees], rotation ratios
LEAST_LENGTH, LEAST_DEGREES, LEAST_RATIO = 1e-5, 0.01, 1e-3
CODE_NOTE = "The code's rows hold a design response (EN 1998-1:2004, 4.3.3.2), not the motion of this floor."
BAND_NOTE = (
    "The band repeats the run with a third and three times the contact penalty and with contact damping "
    "ratios 0.5 and 2, for nobody knows a floor better: one outcome throughout means that it does not hang "
    "on the contact, different ones mean that this model cannot tell."
)
MARGIN_NOTE = (
    "The rotation ratio is no margin: the factor on the motion is, and only a scan of motions finds it."
)
CODE_ACTIONS = (("code", "code, q as given"), ("code_q1", "code, q = 1"))


def screen_summary(
    result: Result, *, title: str, folder: Path, warnings: Sequence[str] = ()
) -> RenderableType:
    """The table of the end of a run, for a rich console.

    Args:
        result: the keys of `run.json`; blocks that a run did not reach may be missing.
        title: of the case; shown as it is, never read as markup.
        folder: of the run.
        warnings: as `fem.assessment.warnings.warnings_for` gives them.
    """
    parts: list[RenderableType] = [
        Text(title, style="bold"),
        Text(outcome_sentence(result), style="bold"),
        Text(),
    ]
    if result.get("static"):
        parts += [_static_table(result), Text(CODE_NOTE), Text()]
    rows = run_rows(result)
    if rows:
        parts.append(_run_table(rows))
    if result.get("joints"):
        parts.append(joint_table([JointDemand.from_json(joint) for joint in result["joints"]]))
    if (result.get("verdict") or {}).get("outcome") in ("rock", "slide-rock"):
        parts += [Text(MARGIN_NOTE), Text()]
    if (result.get("verdict") or {}).get("band"):
        parts += [Text(BAND_NOTE), Text()]
    parts.append(_files(folder))
    parts += [Text(f"Warning: {warning}", style="yellow") for warning in warnings]
    return Group(*parts)


def plain_summary(result: Result, *, title: str, folder: Path, warnings: Sequence[str] = ()) -> str:
    """The same as text without colours, lines of at most 110 characters, for `summary.txt`."""
    console = Console(file=io.StringIO(), width=TEXT_WIDTH, color_system=None, highlight=False)
    with console.capture() as capture:
        console.print(screen_summary(result, title=title, folder=folder, warnings=warnings))
    return "\n".join(line.rstrip() for line in capture.get().splitlines()) + "\n"


def outcome_sentence(result: Result) -> str:
    """What happened, in one sentence."""
    verdict, status = result.get("verdict") or {}, result.get("status")
    if status == "failed":
        reason = result.get("error") or "the solution failed"
        return f"No verdict: {reason}. What was computed before is kept."
    found = _found(verdict)
    if status in ("interrupted", "running"):
        return f"Not finished ({status}); up to there: {found}."
    return f"Result: {found}."


def _found(verdict: Mapping[str, Any]) -> str:
    outcome = verdict.get("outcome")
    if outcome is None:
        return "nothing to tell yet"
    if outcome == "overturned":
        at = verdict.get("overturned_at_s")
        return "overturned" + (f" at t = {at:.3f} s" if at is not None else "")
    verbs = {"rest": "rested", "slide": "slid", "rock": "rocked", "slide-rock": "slid and rocked"}
    restored = ", was restored" if verdict.get("restored") else ""
    band = verdict.get("band") or {}
    unsure = " (unsure, see the band)" if band.get("unsure") else ""
    return f"{verbs.get(outcome, outcome)}{restored} and did not overturn under this motion{unsure}"


def _static_table(result: Result) -> Table:
    static, verdict = result["static"], result.get("verdict") or {}
    table = Table(title="Static rule and run", title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("check")
    table.add_column("action")
    for name in ("demand", "capacity", "utilisation"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("the rule says")
    table.add_column("the run found")
    for check, unit, demand, capacity in (
        ("sliding", "kN", "base_shear_N", static.get("sliding_limit_static_N")),
        ("overturning", "kNm", "tilting_moment_Nm", static.get("restoring_moment_Nm")),
    ):
        found = run_slid(verdict) if check == "sliding" else run_tilted(verdict)
        for key, name in (("own_motion", own_motion_name(static)), *CODE_ACTIONS):
            action = static.get(key)
            if action is None:
                continue
            use = action.get(f"utilisation_{check}")
            table.add_row(
                check,
                name,
                f"{_number(action.get(demand), 1e-3)} {unit}",
                f"{_number(capacity, 1e-3)} {unit}",
                _number(use, 1.0, ".3f"),
                rule_says(check, use),
                found if key == "own_motion" else "(not compared)",
            )
    return table


def own_motion_name(static: Mapping[str, Any]) -> str:
    """The run's own peak floor acceleration: the uplift acceleration times its utilisation."""
    use = (static.get("own_motion") or {}).get("utilisation_overturning")
    uplift = static.get("uplift_acceleration_m_s2")
    return "own peak" if use is None or uplift is None else f"own peak, {use * uplift:.3g} m/s2"


def rule_says(check: str, utilisation: float | None) -> str:
    """What the static rule concludes from a utilisation, for `sliding` or `overturning`."""
    if utilisation is None:
        return "-"
    if check == "sliding":
        return "slides" if utilisation > 1.0 else "holds"
    return "overturns" if utilisation > 1.0 else "stands"


def run_slid(verdict: Mapping[str, Any]) -> str:
    """Whether the run slid, and how far."""
    slip = verdict.get("max_slip_m")
    if slip is None:
        return "-"
    sliding = {"slide", "slide-rock"} & {verdict.get("outcome"), *(verdict.get("modes") or ())}
    return f"{'slides' if sliding else 'holds'}, slip {_millimetres(slip)} mm"


def run_tilted(verdict: Mapping[str, Any]) -> str:
    """Whether the run overturned, and how far it turned."""
    ratio = verdict.get("rotation_ratio")
    if verdict.get("outcome") == "overturned":
        return "overturned"
    return "-" if ratio is None else f"did not (ratio {ratio_in_words(ratio)})"


def _run_table(rows: Sequence[tuple[str, str]]) -> Table:
    table = Table(title="The run", title_justify="left", show_header=False, box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("quantity")
    table.add_column("value")
    for name, value in rows:
        table.add_row(name, value)
    return table


def run_rows(result: Result) -> list[tuple[str, str]]:
    """Name and value of what the run found, in the order of reading; nothing that it did not reach."""
    verdict, static = result.get("verdict") or {}, result.get("static") or {}
    energy, numerics = result.get("energy") or {}, result.get("numerics") or {}
    band = verdict.get("band") or {}
    rows = [
        ("states seen", ", ".join(verdict.get("modes") or ())),
        ("largest rotation", _rotation(verdict)),
        (
            "slip: largest, at the end, travelled",
            _lengths(verdict, ("max_slip_m", "residual_slip_m", "slip_travel_m")),
        ),
        ("largest uplift", _lengths(verdict, ("max_uplift_m",))),
        (
            "largest corner force",
            _mean(verdict.get("max_corner_force_N"), 1e-3, "kN", numerics.get("corner_force_window_s")),
        ),
        ("first uplift", _unit(verdict.get("first_uplift_s"), 1.0, "s")),
        ("impacts", _count(verdict.get("impacts"))),
        ("velocity ratio, first impact", _restitution(verdict, static)),
        ("top against the floor", _lengths(verdict, ("max_top_displacement_m",))),
        (
            "acceleration of the contents",
            _mean(verdict.get("max_acceleration_m_s2"), 1.0, "m/s2", numerics.get("acceleration_window_s")),
        ),
        ("von Mises stress", _unit(verdict.get("max_von_mises_Pa"), 1e-6, "MPa")),
        ("band of the contact", _band(band)),
        *_rigid_rows(result.get("rigid_check") or {}, static.get("slenderness_angle_rad")),
        ("energy closure", _closure(energy)),
        ("steps", _steps(numerics)),
        ("computed in", _times(result, numerics)),
    ]
    return [(name, value) for name, value in rows if value]


def _rotation(verdict: Mapping[str, Any]) -> str:
    angle, ratio = verdict.get("max_rotation_rad"), verdict.get("rotation_ratio")
    if angle is None or ratio is None:
        return ""
    degrees = math.degrees(angle)
    turned = f"< {LEAST_DEGREES:g}" if 0.0 < degrees < LEAST_DEGREES else f"{degrees:.3g}"
    return f"{turned} degrees, {ratio_in_words(ratio)} of the slenderness angle"


def ratio_in_words(ratio: float) -> str:
    """A rotation ratio; what is far below rocking is nobody's measure."""
    return f"< {LEAST_RATIO:g}" if 0.0 < ratio < LEAST_RATIO else f"{ratio:.3g}"


def _restitution(verdict: Mapping[str, Any], static: Mapping[str, Any]) -> str:
    found, housner = verdict.get("restitution_first"), static.get("housner_restitution")
    if found is None:
        return ""
    return f"{found:.3f}" + (f" (Housner {housner:.3f})" if housner is not None else "")


def _band(band: Mapping[str, Any]) -> str:
    if not band:
        return ""
    low, high = band["rotation_ratio"]
    members = band.get("members") or ()
    failed = sum(member["outcome"] is None for member in members)
    return (
        f"{', '.join(band['outcomes'])}; rotation ratio {ratio_in_words(low)} to {ratio_in_words(high)}"
        + (f"; {failed} of {len(members)} failed" if failed else "")
        + ("; unsure" if band.get("unsure") else "")
    )


def _rigid_rows(check: Mapping[str, Any], angle: float | None) -> list[tuple[str, str]]:
    """The run beside the analytic rigid block."""
    if not check:
        return []
    rows = []
    for key, name, form, unit in (
        ("first_impact_s", "first impact", ".4f", " s"),
        ("velocity_ratio", "velocity ratio", ".4f", ""),
    ):
        run, block = (check.get(key) or {}).get("run"), (check.get(key) or {}).get("block")
        if run is not None or block is not None:
            rows.append(
                (
                    f"rigid check, {name}",
                    f"{_number(run, 1.0, form)}{unit} (block {_number(block, 1.0, form)})",
                )
            )
    peaks = check.get("peaks") or ()
    if peaks and angle:
        found, expected = (
            ", ".join(f"{peak[key] / angle:.3f}" for peak in peaks[:4]) for key in ("run_rad", "block_rad")
        )
        rows.append(("rigid check, first peaks", f"{found} (block {expected}) of the slenderness angle"))
    verdict = "a fair comparison" if check.get("meaningful") else "no fair comparison: "
    rows.append(("rigid check", verdict + "; ".join(check.get("reasons") or ())))
    return rows


def _closure(energy: Mapping[str, Any]) -> str:
    error, reference, final = (energy.get(key) for key in ("closure_error", "reference_J", "numerical_J"))
    if error is None or reference is None:
        return ""
    side = ""
    if final and abs(final) >= INVISIBLE * reference:
        side = f"; the stepping {'lost' if final > 0.0 else 'won'} {abs(final):.3g} J"
    return f"{_number(error, 1.0, '.2g')} of the {reference:.4g} J it takes to overturn{side}"


def _steps(numerics: Mapping[str, Any]) -> str:
    steps, rejected, unknowns = (numerics.get(key) for key in ("steps", "rejected", "unknowns"))
    return "" if steps is None else f"{steps}, {rejected or 0} rejected, {unknowns} unknowns"


def _times(result: Result, numerics: Mapping[str, Any]) -> str:
    if result.get("wall_s") is None:
        return ""
    compiling, stepping = result.get("compile_s"), numerics.get("stepping_cpu_s")
    parts = [f"stepping {stepping:.3g} s"] if stepping is not None else []
    if compiling:  # zero in every run but the first ones
        parts.insert(0, f"compiling {compiling:.3g} s (once after installation)")
    return f"{result['wall_s']:.3g} s" + (f", of which {', '.join(parts)}" if parts else "")


def _files(folder: Path) -> Text:
    # Not Text.from_markup: a folder may have any name.
    lines = [
        f"ParaView: open {folder / 'fields' / 'run.pvd'}, Apply, Warp By Vector displacement_m",
        f"Tables: {folder / 'history.csv'}; all figures of this page: {folder / 'run.json'}",
    ]
    if not (folder / "fields" / "run.pvd").exists():
        lines[0] = "ParaView: no fields were written; output.fields_s > 0 writes them"
    return Text("\n".join(lines))


def _lengths(verdict: Mapping[str, Any], keys: Sequence[str]) -> str:
    values = [verdict.get(key) for key in keys]
    return "" if values[0] is None else f"{', '.join(_millimetres(value) for value in values)} mm"


def _millimetres(value: float | None) -> str:
    """A length given in metres; what is below 0.01 mm is nobody's measure."""
    if value is not None and 1e-3 * INVISIBLE <= abs(value) < LEAST_LENGTH:
        return f"< {1e3 * LEAST_LENGTH:g}"
    return _number(value, 1e3)


def _unit(value: float | None, factor: float, unit: str) -> str:
    return "" if value is None else f"{_number(value, factor)} {unit}"


def _mean(value: float | None, factor: float, unit: str, window: float | None) -> str:
    """A value that is a mean over a while, for the instantaneous one of an impact means nothing."""
    if value is None or window is None:
        return _unit(value, factor, unit)
    return f"{_number(value, factor)} {unit}, mean over {1e3 * window:.2g} ms"


def _count(value: int | None) -> str:
    return "" if value is None else str(value)


def _number(value: float | None, factor: float, form: str = ".4g") -> str:
    if value is None:
        return "-"
    shown = factor * value
    return "0" if abs(shown) < INVISIBLE else format(shown, form)
