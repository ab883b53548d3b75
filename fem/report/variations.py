"""How the outcome changes with what nobody knows exactly: friction, contact damping, penalty, phase, start, strength.

Every line of the table is a run of its own, changed in one thing, through the same compiled stepping as a sweep. A
case of the `full` model is varied with `reduced`, which takes seconds instead of hours, and the table says so.
The rows are kept beside the run, so that a second report has them at once.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fem.band import NO_SAMPLES_S
from fem.case import Case
from fem.model import Container, build_model, discretise
from fem.recorder import Recorder
from fem.report.quantities import degrees, number, quantity, short
from fem.run import versions
from fem.run_folder import to_json, write_atomically
from fem.simulation import cores, simulate
from fem.verdict import outcome_of

FRICTION_FACTORS = (0.5, 0.75, 1.25, 1.5)
DAMPING_RATIOS = (0.5, 1.0, 2.0, 4.0)
PENALTY_FACTORS = (1.0 / 3.0, 3.0)
PHASES = (0.25, 0.5, 0.75)  #: of half a turn; a whole half turn is the mirror image
STRENGTHS = (0.8, 0.9, 1.1, 1.25, 1.5, 2.0)
ROTATIONS = (0.9, 1.1)
SHOWN = ("status", "reason", "outcome", "rotation_ratio", "max_slip_m", "residual_slip_m", "max_uplift_m")


@dataclass(frozen=True, kw_only=True)
class Variation:
    """One thing that is changed, and to what."""

    subject: str
    change: str  #: for people
    values: Mapping[str, Any]  #: dotted keys; none: the run as it is

    @property
    def command(self) -> str:
        """The options that make this run from its resolved case."""
        return " ".join(f"--set {key}={value!r}".replace("'", "") for key, value in self.values.items())


@dataclass(frozen=True, kw_only=True)
class Varied:
    """A line of the table."""

    variation: Variation
    row: Mapping[str, Any]  #: of `SHOWN`
    changed: bool  #: another outcome than the first line's


@dataclass(frozen=True, kw_only=True)
class VariationTable:
    """The table, the run as it is first."""

    model: str  #: with which it was computed
    lines: tuple[Varied, ...]

    @property
    def changed(self) -> int:
        """Lines with another outcome."""
        return sum(line.changed for line in self.lines)

    @property
    def overturned(self) -> int:
        """Lines that overturned."""
        return sum(line.row["outcome"] == "overturned" for line in self.lines[1:])

    @property
    def sentence(self) -> str:
        """What the table comes to."""
        count, overturned, ratios = len(self.lines) - 1, self.overturned, self.ratios
        words = [
            f"The outcome is the same in all {count}."
            if self.changed == 0
            else f"In {self.changed} of {count} the outcome is another."
        ]
        if overturned and self.lines[0].row["outcome"] != "overturned":
            words.append(f"It overturns in {overturned}.")
        if ratios is not None:
            low, high = (number(ratio, figures=3) for ratio in ratios)
            words.append(f"Where it stands, the rotation ratio goes from {low} to {high}.")
        return " ".join(words)

    @property
    def ratios(self) -> tuple[float, float] | None:
        """Range of the rotation ratio over lines that stand; None if none does."""
        found = [line.row["rotation_ratio"] for line in self.lines if line.row["outcome"] != "overturned"]
        known = [ratio for ratio in found if ratio is not None]
        return (min(known), max(known)) if known else None


def variation_table(
    case: Case,
    kept_in: Path,
    *,
    case_hash: str,
    container: Container | None = None,
    told: Callable[[str], None] = lambda text: None,
    stop: Callable[[], bool] = lambda: False,
) -> VariationTable | None:
    """The table of a run, computed unless it is kept from before; None if it was stopped.

    Args:
        case: resolved.
        kept_in: the file that keeps the rows; where it cannot be written, the next report computes them again.
        container: of the case with the model that is varied; None builds it.
        case_hash: of the case; kept rows of another are computed anew.
        told: a sentence for the user where it takes time.
        stop: asked now and then.
    """
    base = case.with_values({"solver.model": "reduced"}) if case.solver.model == "full" else case
    variations = [Variation(subject="as computed", change="", values={}), *variations_of(base)]
    mark = {
        "case_hash": case_hash,
        "versions": versions(),
        "model": base.solver.model,
        "values": [dict(one.values) for one in variations],
    }
    rows = _kept_rows(kept_in, mark)
    if rows is None:
        told(f"computing {len(variations)} variations of the run")
        rows = _run(base, variations, container or discretise(base), stop)
        if stop():
            return None
        try:
            write_atomically(kept_in, to_json({**mark, "rows": rows}))
        except OSError:
            told(f"{kept_in}: cannot be written; the next report computes the variations again")
    first = rows[0]["outcome"]
    lines = (
        Varied(variation=one, row=row, changed=row["outcome"] != first)
        for one, row in zip(variations, rows, strict=True)
    )
    return VariationTable(model=base.solver.model, lines=tuple(lines))


def variations_of(case: Case) -> Iterator[Variation]:
    """What is varied, in the order of the table."""
    contact, motion, initial = case.contact, case.motion, case.initial
    for factor in FRICTION_FACTORS:
        static, kinetic = (round(factor * mu, 6) for mu in (contact.mu_static, contact.mu_kinetic))
        yield Variation(
            subject="friction",
            change=f"μs {short(static)}, μk {short(kinetic)} (× {factor:g})",
            values={"contact.mu_static": static, "contact.mu_kinetic": kinetic},
        )
    for ratio in DAMPING_RATIOS:
        if ratio != contact.damping_ratio:
            yield Variation(
                subject="contact damping", change=f"ratio {ratio:g}", values={"contact.damping_ratio": ratio}
            )
    if not isinstance(contact.normal_penalty_Pa_m, str):
        for factor in PENALTY_FACTORS:
            yield Variation(
                subject="contact penalty",
                change=f"× {'1/3' if factor < 1.0 else '3'}",
                values={"contact.normal_penalty_Pa_m": factor * contact.normal_penalty_Pa_m},
            )
    if motion.kind == "harmonic":
        for share in PHASES:
            phase = math.remainder(motion.phase_rad + share * math.pi, 2.0 * math.pi)
            yield Variation(
                subject="phase of the floor", change=degrees(phase, 3), values={"motion.phase_rad": phase}
            )
    if motion.kind != "none":
        start = "rest" if motion.start == "moving" else "moving"
        words = {"rest": "the floor jerks under it", "moving": "it moves with the floor"}
        yield Variation(subject="start", change=f"{start}: {words[start]}", values={"motion.start": start})
    if initial.rotation_rad != 0.0:
        for factor in ROTATIONS:
            rotation = factor * initial.rotation_rad
            yield Variation(
                subject="start",
                change=f"from {degrees(rotation)} (× {factor:g})",
                values={"initial.rotation_rad": rotation},
            )
    yield from _strengths(case)


def _strengths(case: Case) -> Iterator[Variation]:
    """The floor's motion made stronger and weaker: the factor that it stands is the margin."""
    motion = case.motion
    key = next(
        (name for name in ("peak_acceleration_m_s2", "amplitude_m") if getattr(motion, name) is not None),
        None,
    )
    key = "scale" if motion.kind == "table" else key
    if motion.kind == "none" or key is None:
        return
    if key == "amplitude_m" and motion.angular_frequency_rad_s is None and motion.frequency_Hz is None:
        return
    given = getattr(motion, key)
    for factor in STRENGTHS:
        shown = ""
        if motion.kind != "table":
            shown = f", peak {quantity(factor * (case.nominal_peak_acceleration or 0.0), 'm/s²', figures=3)}"
        yield Variation(
            subject="strength of the motion",
            change=f"× {factor:g}{shown}",
            values={f"motion.{key}": factor * given},
        )


def _run(
    base: Case, variations: list[Variation], container: Container, stop: Callable[[], bool]
) -> list[dict[str, Any]]:
    """The rows, side by side; the compiled stepping lets go of the interpreter's lock."""
    with ThreadPoolExecutor(max_workers=cores()) as pool:
        return list(pool.map(lambda one: _row(base, one, container, stop), variations))


def _row(base: Case, one: Variation, container: Container, stop: Callable[[], bool]) -> dict[str, Any]:
    """One run without samples; whatever keeps it from an outcome is its reason, never an outcome."""
    row: dict[str, Any] = dict.fromkeys(SHOWN) | {"status": "failed"}
    try:
        changed = base.with_values({**one.values, "output.history_s": NO_SAMPLES_S, "output.fields_s": 0.0})
        model = build_model(changed, container)
        ending = simulate(model, Recorder(model), stop=stop)
    except (ValueError, ArithmeticError, RuntimeError) as problem:  # beyond a case's limits; no stance
        return row | {"reason": str(problem).partition("\n")[0]}
    row |= {"status": ending.status, "reason": ending.error}
    if ending.status in ("completed", "overturned"):
        track = model.run.track[0]
        row |= {
            "outcome": outcome_of(model),
            "rotation_ratio": float(track.max_rotation) / model.static.slenderness_angle,
            "max_slip_m": float(track.max_slip),
            "residual_slip_m": float(model.run.clock[0].slip),
            "max_uplift_m": float(track.max_uplift),
        }
    return row


def _kept_rows(path: Path, mark: Mapping[str, Any]) -> list[dict[str, Any]] | None:
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
        rows = kept["rows"]
        same = {key: kept[key] for key in mark} == json.loads(to_json(mark))
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return list(rows) if same and all(set(row) == set(SHOWN) for row in rows) else None
