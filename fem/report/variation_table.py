"""The table of variations: the outcome under changed assumptions, one run a line.

A case of the `full` model is varied with `reduced`, which takes seconds instead of hours. A report must be there in
seconds: lines are computed beside the rest of the page, the more important first, as long as there is time.
"""

import json
import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from fem.batch.runner import run_cases
from fem.case.case import Case
from fem.report.variations import Variation, by_importance, variations_of
from fem.results.figures import Place, RunFigures, keys_beside, keys_of
from fem.results.files import to_json, write_atomically
from fem.results.outcome import Outcome
from fem.results.run_result import RunResult
from fem.runtime.identity import versions
from fem.runtime.units import RATIO

NO_SAMPLES_S = 1e4  #: interval of a history of which only the first row is taken
AFFORDED_S = 4.0  #: wall time for lines that are not asked for


@dataclass(frozen=True, kw_only=True)
class VariationRow(RunFigures):
    """What one line found."""

    status: str
    reason: str | None = None  #: why there is no outcome
    max_joint_slip_m: float | None = None  #: largest between loose boxes

    written_where_given = keys_beside(Place.RUNS) - {"max_joint_slip_m"} | {"boxes"}

    @classmethod
    def of(cls, status: str, found: RunFigures | Mapping[str, Any], reason: str | None = None) -> Self:
        """The row of a run with these figures."""
        row = {key: getattr(found, key) for key in SHOWN} if isinstance(found, RunFigures) else found
        return cls(status=status, reason=reason, **{key: row[key] for key in SHOWN})


SHOWN = ("outcome", *keys_of(Place.RUNS), "max_joint_slip_m")


@dataclass(frozen=True, kw_only=True)
class Varied:
    """A line of the table."""

    variation: Variation
    row: VariationRow
    changed: bool  #: another outcome than the first line's


@dataclass(frozen=True, kw_only=True)
class VariationTable:
    """The table, with the run as computed first."""

    model: str  #: with which it was computed
    lines: tuple[Varied, ...]
    left_out: tuple[Variation, ...]  #: not computed
    price: float  #: of one line, about [s]

    @property
    def changed(self) -> int:
        """Lines with another outcome."""
        return sum(line.changed for line in self.lines)

    @property
    def sentence(self) -> str:
        """The table in a few words."""
        count, outcomes = len(self.lines) - 1, [line.row.outcome for line in self.lines]
        overturned = outcomes[1:].count(Outcome.OVERTURNED)
        words = [
            f"The outcome is the same in all {count}."
            if self.changed == 0
            else f"In {self.changed} of {count} the outcome differs."
        ]
        if overturned and outcomes[0] != Outcome.OVERTURNED:
            words.append(f"It overturns in {overturned}.")
        rows = [line.row for line in self.lines if line.row.outcome != Outcome.OVERTURNED]
        ratios = [row.rotation_ratio for row in rows if row.rotation_ratio is not None]
        if ratios:
            low, high = RATIO.text(min(ratios)), RATIO.text(max(ratios))
            reach = f"ranges from {low} to {high}" if low != high else f"is {low}"
            words.append(f"Where it does not overturn, the rotation ratio {reach}.")
        return " ".join(words)


@contextmanager
def variations_meanwhile(
    case: Case, kept_in: Path, *, stop: Callable[[], bool] = lambda: False, **options: Any
) -> Iterator[Callable[[], VariationTable | None]]:
    """Compute the table of a run beside other work; the function yielded waits for it and returns it.

    The compiled stepping releases the interpreter's lock. Leaving the context before the table is there stops its
    runs. Options are those of `variation_table`.
    """
    left = threading.Event()
    with ThreadPoolExecutor(max_workers=1) as beside:
        table = beside.submit(variation_table, case, kept_in, stop=lambda: left.is_set() or stop(), **options)
        try:
            yield table.result
        finally:
            left.set()


def variation_table(
    case: Case,
    kept_in: Path,
    *,
    result: RunResult,
    every: bool = False,
    message: Callable[[str], None] = lambda text: None,
    stop: Callable[[], bool] = lambda: False,
) -> VariationTable | None:
    """The table of a run, computed unless it is kept from before; None if it was stopped.

    Args:
        case: resolved.
        kept_in: the file that keeps the rows; where it cannot be written, the next report computes them again.
        result: of the finished run; its own row and those of its band need no computing.
        every: compute every line, however long it takes.
        message: receives a sentence for the user where it takes time.
        stop: asked repeatedly; true ends the work.
    """
    base = case.with_values({"solver.model": "reduced"}) if case.solver.model == "full" else case
    variations = [Variation(subject="as computed", change="", values={}), *variations_of(base)]
    mark = {
        "case_hash": str(result.case_hash),
        "versions": versions(),
        "model": base.solver.model,
        "values": [dict(one.values) for one in variations],
    }
    kept = _kept(kept_in, mark)
    rows, price = kept or (_known_rows(case, variations, result), _price(case, result))
    missing = [index for index in by_importance(variations) if rows[index] is None]
    if missing and (kept is None or every):
        message("computing variations of the run")
        if price is None:  # no run of this model yet
            first, began = missing.pop(0), time.monotonic()
            (rows[first],) = _computed(base, [variations[first]], stop)
            price = time.monotonic() - began
        limit = None if every else max(AFFORDED_S - price, 0.0)
        found = _computed(base, [variations[index] for index in missing], stop, limit)
        for index, row in zip(missing, found, strict=True):
            rows[index] = row
        if stop():
            return None
        left_out = sum(row is None for row in rows)
        if left_out:
            message(
                f"variations left out, because they take longer: {left_out}; --all-variations computes them"
            )
    if kept is None or every:
        try:
            lines = [None if row is None else row.to_json() for row in rows]
            write_atomically(kept_in, to_json({**mark, "price_s": price, "rows": lines}))
        except OSError:
            message(f"{kept_in}: cannot be written; the next report computes the variations again")
    pairs = list(zip(variations, rows, strict=True))
    given = rows[0].outcome if rows[0] is not None else None
    return VariationTable(
        model=base.solver.model,
        lines=tuple(
            Varied(variation=one, row=row, changed=row.outcome != given)
            for one, row in pairs
            if row is not None
        ),
        left_out=tuple(one for one, row in pairs if row is None),
        price=price or 0.0,
    )


def _price(case: Case, result: RunResult) -> float | None:
    """What a line costs, from the stepping of the run itself [s]; None where that is of another model."""
    if case.solver.model == "full":
        return None
    return (result.numerics.stepping_cpu_s if result.numerics is not None else None) or 0.0


def _known_rows(case: Case, variations: Sequence[Variation], result: RunResult) -> list[VariationRow | None]:
    """Rows that the run and its band have found; None where there is none."""
    rows: list[VariationRow | None] = [None] * len(variations)
    verdict = result.verdict
    if case.solver.model == "full" or verdict is None:
        return rows
    rows[0] = VariationRow.of(result.status, verdict)
    members = verdict.band.members if verdict.band is not None else ()
    for index, one in enumerate(variations[1:], start=1):
        for member in members:
            if member.kind == "one" and _same_values(member.values or {}, one.values):
                rows[index] = VariationRow.of(member.status, member, member.error)
    return rows


def _same_values(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether the same keys have the same values, within rounding."""
    return one.keys() == other.keys() and all(
        one[key] == value
        or (
            isinstance(value, float)
            and isinstance(one[key], float)
            and math.isclose(one[key], value, rel_tol=1e-9)
        )
        for key, value in other.items()
    )


def _computed(
    base: Case, variations: Sequence[Variation], stop: Callable[[], bool], time_limit_s: float | None = None
) -> list[VariationRow | None]:
    """Rows of variations, without samples; None for those that were not started in time."""
    rows: list[VariationRow | None] = [None] * len(variations)
    cases: dict[int, Case] = {}
    for index, one in enumerate(variations):
        try:
            values = {**one.values, "output.history_s": NO_SAMPLES_S, "output.fields_s": 0.0}
            cases[index] = base.with_values(values)
        except ValueError as problem:  # beyond the limits of a case
            rows[index] = VariationRow(status="failed", reason=str(problem).partition("\n")[0])
    found = run_cases(list(cases.values()), stop=stop, time_limit_s=time_limit_s)
    for index, row in zip(cases, found, strict=True):
        if row["status"] in ("completed", "overturned"):
            rows[index] = VariationRow.of(row["status"], row)
        elif row["status"] == "failed":
            rows[index] = VariationRow(status="failed", reason=str(row["reason"]).partition("\n")[0])
    return rows


def _kept(path: Path, mark: Mapping[str, Any]) -> tuple[list[VariationRow | None], float | None] | None:
    """Rows and price of an earlier report of the same run; None if there are none."""
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
        if {key: kept[key] for key in mark} != json.loads(to_json(mark)):
            return None
        rows = [None if row is None else VariationRow.from_json(row) for row in kept["rows"]]
        return (rows, kept["price_s"]) if len(rows) == len(mark["values"]) else None
    except (OSError, ValueError, KeyError, TypeError):
        return None
