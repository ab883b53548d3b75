"""How the outcome changes with what nobody knows exactly: the table of a report, a run of its own for every line.

Each goes through the same compiled stepping as a sweep. A case of the `full` model is varied with `reduced`, which
takes seconds instead of hours, and the table says so. What the run itself and its band have found is not computed
again. A report is to be there in seconds: lines are computed beside the rest of the page, as long as they are there in
a few seconds, the more important first; what is left out is named, and `python -m fem report --all-variations`
computes it. The rows are kept beside the run, so that a second report has them at once.
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
from typing import Any

from fem.assessment.verdict import short_verdict
from fem.case.case import Case
from fem.html.units import rotation_ratio
from fem.model.container import Container, discretise
from fem.model.model import build_model
from fem.report.variations import Variation, by_importance, variations_of
from fem.results.run_folder import to_json, write_atomically
from fem.run.band import NO_SAMPLES_S
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.runtime.identity import versions
from fem.runtime.threads import cores

AFFORDED_S = 4.0  #: wall time until the last line that is not asked for should be there
#: of a verdict, kept of every line
IN_SHORT = ("outcome", "rotation_ratio", "max_slip_m", "residual_slip_m", "max_uplift_m")
SHOWN = ("status", "reason", *IN_SHORT)

Row = dict[str, Any]


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
    left_out: tuple[Variation, ...]  #: not computed
    price: float  #: of one line, about [s of processor time]

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
            low, high = (rotation_ratio(ratio) for ratio in ratios)
            reach = f"goes from {low} to {high}" if low != high else f"is {low}"
            words.append(f"Where it stands, the rotation ratio {reach}.")
        return " ".join(words)

    @property
    def ratios(self) -> tuple[float, float] | None:
        """Range of the rotation ratio over lines that stand; None if none does."""
        found = [line.row["rotation_ratio"] for line in self.lines if line.row["outcome"] != "overturned"]
        known = [ratio for ratio in found if ratio is not None]
        return (min(known), max(known)) if known else None


@contextmanager
def variations_meanwhile(
    case: Case, kept_in: Path, *, stop: Callable[[], bool] = lambda: False, **asked: Any
) -> Iterator[Callable[[], VariationTable | None]]:
    """Compute the table of a run beside other work: what is yielded waits for it, and gives it as `variation_table`.

    The compiled stepping lets go of the interpreter's lock. Who leaves before the table is there ends its runs.
    """
    left = threading.Event()
    with ThreadPoolExecutor(max_workers=1) as aside:
        table = aside.submit(variation_table, case, kept_in, stop=lambda: left.is_set() or stop(), **asked)
        try:
            yield table.result
        finally:
            left.set()


def variation_table(
    case: Case,
    kept_in: Path,
    *,
    result: Mapping[str, Any],
    container: Container | None = None,
    every: bool = False,
    told: Callable[[str], None] = lambda text: None,
    stop: Callable[[], bool] = lambda: False,
) -> VariationTable | None:
    """The table of a run, computed unless it is kept from before; None if it was stopped.

    Args:
        case: resolved.
        kept_in: the file that keeps the rows; where it cannot be written, the next report computes them again.
        result: of the finished run; its own row and those of its band need no computing.
        container: of the case with the model that is varied; None builds it.
        every: compute every line, however long it takes.
        told: a sentence for the user where it takes time.
        stop: asked now and then.
    """
    base = case.with_values({"solver.model": "reduced"}) if case.solver.model == "full" else case
    variations = [Variation(subject="as computed", change="", values={}), *variations_of(base)]
    mark = {
        "case_hash": str(result.get("case_hash")),
        "versions": versions(),
        "model": base.solver.model,
        "values": [dict(one.values) for one in variations],
    }
    kept = _kept(kept_in, mark)
    rows, price = kept or (_known_rows(case, variations, result), _price(case, result))
    missing = [index for index in by_importance(variations) if rows[index] is None]
    if missing and (kept is None or every):
        told("computing variations of the run")
        until = math.inf if every else time.monotonic() + AFFORDED_S
        computing = _Computing(base, variations, container or discretise(base), stop)
        if price is None:  # no run of this model yet
            first = missing.pop(0)
            rows[first], price = computing.row(first)
        for index, row in zip(missing, computing.rows(missing, price=price, until=until), strict=True):
            rows[index] = row
        if stop():
            return None
        left = sum(row is None for row in rows)
        if left:
            told(f"variations of the run that would take longer: {left}; --all-variations computes them too")
    if kept is None or every:
        try:
            write_atomically(kept_in, to_json({**mark, "price_s": price, "rows": rows}))
        except OSError:
            told(f"{kept_in}: cannot be written; the next report computes the variations again")
    return _table(base.solver.model, variations, rows, price or 0.0)


def _table(
    model: str, variations: Sequence[Variation], rows: Sequence[Row | None], price: float
) -> VariationTable:
    pairs = list(zip(variations, rows, strict=True))
    given = rows[0]["outcome"] if rows[0] is not None else None
    return VariationTable(
        model=model,
        lines=tuple(
            Varied(variation=one, row=row, changed=row["outcome"] != given)
            for one, row in pairs
            if row is not None
        ),
        left_out=tuple(one for one, row in pairs if row is None),
        price=price,
    )


def _price(case: Case, result: Mapping[str, Any]) -> float | None:
    """What a line costs [s of processor time], from the run itself; None where it is of another model."""
    if case.solver.model == "full":
        return None
    return float((result.get("numerics") or {}).get("stepping_cpu_s") or 0.0)


def _known_rows(case: Case, variations: Sequence[Variation], result: Mapping[str, Any]) -> list[Row | None]:
    """Rows that the run and its band have found; None where there is none."""
    if case.solver.model == "full":
        return [None] * len(variations)
    verdict = result.get("verdict") or {}
    own = {"status": result.get("status"), "reason": None} | {name: verdict[name] for name in IN_SHORT}
    members = (verdict.get("band") or {}).get("members") or []
    return [own, *(_row_of_band(case, one, members) for one in variations[1:])]


def _row_of_band(case: Case, one: Variation, members: Sequence[Mapping[str, Any]]) -> Row | None:
    """The row of the member of the band that this variation is."""
    keys = ("contact.normal_penalty_Pa_m", "contact.damping_ratio")
    if not set(one.values) <= set(keys):
        return None
    own = (case.contact.normal_penalty_Pa_m, case.contact.damping_ratio)
    wanted = [one.values.get(key, given) for key, given in zip(keys, own, strict=True)]
    for member in members:
        floor = (member["normal_penalty_Pa_m"], member["damping_ratio"])
        same = all(math.isclose(a, b, rel_tol=1e-9) for a, b in zip(floor, wanted, strict=True))
        if same and set(IN_SHORT) <= set(member):
            told = {"status": member["status"], "reason": member["error"]}
            return told | {name: member[name] for name in IN_SHORT}
    return None


class _Computing:
    """Lines of one container."""

    def __init__(
        self, base: Case, variations: Sequence[Variation], container: Container, stop: Callable[[], bool]
    ) -> None:
        self._base, self._variations = base, variations
        self._container, self._stop = container, stop

    def rows(self, indices: Sequence[int], *, price: float, until: float) -> list[Row | None]:
        """Rows, side by side; None for those that could not be there in time.

        Args:
            indices: of the lines, in the order in which they are begun.
            price: what a line takes, about [s].
            until: when the last of them should be there, as `time.monotonic()` tells it [s].
        """

        def in_time(index: int) -> Row | None:
            nonlocal price
            began = time.monotonic()
            if began + price > until:
                return None
            row, _ = self.row(index)
            price = time.monotonic() - began  # on this machine, beside everything else that it does now
            return row

        with ThreadPoolExecutor(max_workers=cores()) as pool:
            return list(pool.map(in_time, indices))

    def row(self, index: int) -> tuple[Row, float]:
        """One run without samples, and the processor time of its stepping [s].

        Whatever keeps it from an outcome is its reason, never an outcome.
        """
        values = self._variations[index].values
        row: Row = dict.fromkeys(SHOWN) | {"status": "failed"}
        try:
            changed = self._base.with_values(
                {**values, "output.history_s": NO_SAMPLES_S, "output.fields_s": 0.0}
            )
            model = build_model(changed, self._container)
            ending = simulate(model, Recorder(model), stop=self._stop)
        except (ValueError, ArithmeticError, RuntimeError) as problem:  # beyond a case's limits; no stance
            return row | {"reason": str(problem).partition("\n")[0]}, 0.0
        row |= {"status": ending.status, "reason": ending.error}
        if ending.status in ("completed", "overturned"):
            short = short_verdict(model)
            row |= {name: getattr(short, name) for name in IN_SHORT}
        return row, ending.stepping_cpu_s


def _kept(path: Path, mark: Mapping[str, Any]) -> tuple[list[Row | None], float | None] | None:
    """Rows and price of an earlier report of the same run; None if there are none."""
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
        rows, price = kept["rows"], kept["price_s"]
        same = {key: kept[key] for key in mark} == json.loads(to_json(mark))
        whole = len(rows) == len(mark["values"]) and all(
            row is None or set(row) == set(SHOWN) for row in rows
        )
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return (list(rows), price) if same and whole else None
