"""The variations in the report of a run: one thing changed a line.

The unknown inputs come first, one at a time over their ranges: those that the band of the run tried are taken as they
are. Then what is known or chosen: the phase of the floor, its vertical motion, the start, the strength. A case of the
`full` model is varied with `reduced`, which takes seconds instead of hours.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from fem.assessment.sureness import numerical
from fem.assessment.verdict import numerics_of
from fem.case.case import Case, case_hash
from fem.case.strength import scaled_motion
from fem.case.uncertainty import InputChange, changes_of, largest_first
from fem.html.units import degrees, quantity
from fem.model.model import build_model
from fem.results.figures import TURNED
from fem.results.files import write_atomically
from fem.results.outcome import ENDINGS, Outcome
from fem.results.reader import OpenedRun
from fem.results.run_result import ChangedRun, Numerics
from fem.run.changed_runs import changed_run, cost_of, run_changes
from fem.run.changed_runs_file import ChangedRunsFile, key_of
from fem.run.expected import LONG_S, expected_words
from fem.run.outcome import run_without_history
from fem.runtime.threads import cores
from fem.runtime.units import RATIO

PHASES = (0.25, 0.5, 0.75)  #: of half a turn; a whole half turn is the mirror image
STRENGTHS = (0.9, 1.1)  #: the margin of a run tries more
ROTATIONS = (0.9, 1.1)
BUDGET_S = 8.0  #: processor time of all lines unless every one is wanted, by the estimate of `cost_of` [s]


def further_changes(case: Case) -> Iterator[InputChange]:
    """What is tried besides the unknown inputs, in the order of the table."""
    motion, initial = case.motion, case.initial

    def change(subject: str, to: str, values: dict[str, Any]) -> InputChange:
        return InputChange(kind="further", values=values, share=1.0, subject=subject, to=to)

    if case.floor.is_slab:
        yield change("floor", "rigid, with elastic impacts", {"floor.kind": "rigid"})
    if motion.kind == "harmonic":
        for share in PHASES:
            phase = math.remainder(motion.phase_rad + share * math.pi, 2.0 * math.pi)
            yield change("phase of the motion", degrees(phase, 3), {"motion.phase_rad": phase})
    if case.has_vertical:
        key = "scale" if case.vertical.scale_to_m_s2 is None else "scale_to_m_s2"
        other = {f"vertical.{key}": -getattr(case.vertical, key)}
        yield change("vertical motion", "the other sign", other)
        yield change("vertical motion", "none", {"vertical.kind": "none"})
    if initial.rotation_rad != 0.0:
        for factor in ROTATIONS:
            rotation = factor * initial.rotation_rad
            yield change(
                "start", f"from {degrees(rotation)} (× {factor:g})", {"initial.rotation_rad": rotation}
            )
    peak, both = case.nominal_peak_acceleration, case.has_vertical and motion.kind != "none"
    for factor in STRENGTHS:
        at_peak = f", peak {quantity(factor * peak, 'm/s²', figures=3)}" if peak else ""
        if values := scaled_motion(case, factor):
            yield change("strength of the motion", f"× {factor:g}{at_peak}{', both motions' * both}", values)


@dataclass(frozen=True, kw_only=True)
class Varied:
    """A line of the table."""

    change: InputChange
    run: ChangedRun
    changed: bool  #: another outcome than the first line's; one that failed has none


@dataclass(frozen=True, kw_only=True)
class VariationTable:
    """The table, with the run as computed first."""

    model: str  #: with which it was computed
    lines: tuple[Varied, ...]
    left_out: tuple[InputChange, ...]  #: not computed
    price: float  #: of one line, about [s]

    @property
    def changed(self) -> int:
        """Lines with another outcome."""
        return sum(line.changed for line in self.lines)

    @property
    def sentence(self) -> str:
        """The table in a few words."""
        count, outcomes = len(self.lines) - 1, [line.run.outcome for line in self.lines]
        overturned, invalid, failed = (
            outcomes[1:].count(outcome) for outcome in (Outcome.OVERTURNED, Outcome.INVALID, None)
        )
        words = [
            f"In {self.changed} of {count} the outcome differs."
            if self.changed or failed
            else f"The outcome is the same in all {count}."
        ]
        if overturned and outcomes[0] != Outcome.OVERTURNED:
            words.append(f"It overturns in {overturned}.")
        if invalid:
            words.append(f"It destroys a corner in {invalid}.")
        if failed:
            words.append(f"There is no outcome in {failed}.")
        own, *others = self.lines
        chosen = _reach([line for line in others if line.change.kind == "further"])
        tried = [line for line in others if line.change.kind != "further" and not numerical(line.change)]
        unknown = _reach([own, *tried]) if tried else ""
        reaches = [
            f"{unknown} with one unknown input changed" if unknown else "",
            f"{chosen} with another floor, motion or start, which no range in the verdict covers"
            if chosen
            else "",
        ]
        if any(reaches):
            words.append(f"Where it stands, the rotation ratio is {', and '.join(filter(None, reaches))}.")
        return " ".join(words)


def _reach(lines: Sequence[Varied]) -> str:
    """The rotation ratios of those that stand, least to largest; empty for none."""
    runs = [line.run for line in lines if line.run.outcome not in ENDINGS]
    ratios = [run[TURNED] for run in runs if run[TURNED] is not None]
    if not ratios:
        return ""
    low, high = RATIO.text(min(ratios)), RATIO.text(max(ratios))
    return f"{low} to {high}" if low != high else low


def variation_table(
    run: OpenedRun,
    *,
    every: bool = False,
    message: Callable[[str], None] = lambda text: None,
    stop: Callable[[], bool] = lambda: False,
) -> VariationTable | None:
    """The table of a finished run; None if it was stopped.

    Args:
        run: its folder keeps the lines; where it cannot be written, the next report computes them again.
        every: compute every line, however long it takes.
        message: receives a sentence for the user where it takes time.
        stop: asked repeatedly; true ends the work.
    """
    case, result, verdict = run.case, run.typed_result, run.verdict
    known = verdict.band.members[1:] if verdict.band is not None else ()
    status, numerics, error = result.status, result.numerics or Numerics(), None
    if case.solver.model == "full":
        case, known = case.with_values({"solver.model": "reduced"}), ()
        model = build_model(case)
        verdict, error = run_without_history(model, None)
        numerics = numerics_of(model, 0.0)
    model = build_model(case)
    own = changed_run(None, model, status, verdict, None)
    if error is not None:
        own = ChangedRun(status="failed", error=error)
    changes = [*changes_of(case, model.penalty), *further_changes(case)]
    path = run.place.variations

    def write(text: str) -> None:
        with suppress(OSError):
            write_atomically(path, text)

    kept_in = ChangedRunsFile(path, case_hash=case_hash(case), write=write, message=message)
    there = {key_of(variation.values) for variation in (*known, *kept_in.read())}
    price = cost_of(numerics)
    missing = [change for change in largest_first(changes) if key_of(change.values) not in there]
    most = len(missing) if every else max(1, int(BUDGET_S / price))
    left_out = missing[most:]
    if missing[:most]:
        seconds = price * min(most, len(missing)) / cores()
        long = f": {expected_words(seconds)}" if seconds > LONG_S else ""
        message(f"computing {min(most, len(missing))} variations of the run{long}")
    if left_out:
        message(
            f"variations left out, because they take longer: {len(left_out)}; --all-variations computes them"
        )
    chosen = [change for change in changes if change not in left_out]
    runs = run_changes(model, chosen, numerics=numerics, stop=stop, known=known, kept_in=kept_in)
    if any(variation.status == "interrupted" for variation in runs):
        return None
    first = InputChange(kind="further", values={}, share=0.0, subject="as computed")
    return VariationTable(
        model=case.solver.model,
        lines=tuple(
            Varied(change=change, run=variation, changed=variation.outcome not in (own.outcome, None))
            for change, variation in zip((first, *chosen), (own, *runs), strict=True)
        ),
        left_out=tuple(left_out),
        price=price,
    )
