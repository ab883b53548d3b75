"""The list with its results: the rows, counts and answer of `hall.json`."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from fem.batch.runner import Row
from fem.batch.study import COMPLETED, FAILED
from fem.hall.file import LISTED, HallRow
from fem.hall.plan import Hall
from fem.hall.result import REFUSED, RESULT_COLUMNS, HallResult
from fem.results.figures import SLIPPED
from fem.results.outcome import COUNTED_AS, ending_of

NO_ANSWER = "no answer"  #: of a container at a site


def weakness(order: int, row: Row, turned: float) -> tuple[float, ...]:
    """Smaller for the worse: by the order of what happened, by margin, by rotation, by the static rule, by slip.

    Args:
        order: less for the worse.
        row: of the container; one with a margin comes before one without.
        turned: the rotation that counts.
    """
    margin = row.get("margin") or row.get("margin_tried_to")
    static, slip = row.get("utilisation_overturning"), row.get(SLIPPED)
    return order, margin is None, margin or 0.0, -turned, -(static or 0.0), -(slip or 0.0)


def with_table(
    begun: HallResult,
    hall: Hall,
    by_container: Mapping[int, Row],
    order: Sequence[int],
    command: Callable[[HallRow, int], str],
) -> HallResult:
    """The finished result: rows, counts by outcome and tag, the answer.

    Args:
        begun: without these.
        hall: the list, checked.
        by_container: results of each container, by column.
        order: of the containers, the weakest first.
        command: of a row, whose container this is.
    """
    ranks = {number: rank for rank, number in enumerate(order, start=1)}
    table, outcomes, tags = [], Counter[str](), dict[str, dict[str, Any]]()
    for number, row in enumerate(hall.rows, start=1):
        k = row.container
        results: Row = {"status": REFUSED, "reason": row.reason}
        if k is not None:
            results = {**by_container[k], "rank": ranks[k]}
        given = {"row": number} | {name: getattr(row, name) for name in LISTED}
        values = {name: results.get(name) for name in RESULT_COLUMNS}
        table.append(given | values | {"command": None if k is None else command(row, k)})
        outcome, ending = _counted(values, begun)
        outcomes[outcome] += row.count
        empty = {"tag": row.tag, "containers": 0, "counts": Counter[str](), "margin": None}
        tag = tags.setdefault(row.tag, empty)
        tag["containers"] += row.count
        tag["counts"][ending] += row.count
        tag["margin"] = min(filter(None, (tag["margin"], values["margin"])), default=None)
    failed = {result["status"] for result in by_container.values()} == {FAILED}
    result = replace(
        begun,
        status=FAILED if failed else COMPLETED,
        outcomes=dict(sorted(outcomes.items())),
        tags=tuple(tag for _, tag in sorted(tags.items())) if {*tags} != {""} else (),
        table=tuple(table),
    )
    return replace(result, answer=answer_of(result))


def _counted(row: Row, result: HallResult) -> tuple[str, str]:
    """What the outcomes count a row as, and what its tag does."""
    if row["status"] == REFUSED:
        return REFUSED, REFUSED
    if result.site:
        return row["answer"] or NO_ANSWER, row["answer"] or NO_ANSWER
    ending = COUNTED_AS[ending_of(row["status"], row["outcome"])]
    return row["outcome"] or ending, ending


def answer_of(result: HallResult) -> str:
    """How many containers did what, and which is the weakest, in one sentence."""
    counts = dict(result.outcomes)
    refused = counts.pop(REFUSED, 0)
    computed = result.containers - refused
    if result.site:
        words = f"of {computed} containers: " + ", ".join(f"{count} {word}" for word, count in counts.items())
    else:
        overturned, invalid, failed = (counts.get(word, 0) for word in ("overturned", "invalid", "failed"))
        under = f" under at least one of {len(result.motions)} motions" if len(result.motions) > 1 else ""
        words = f"{overturned or 'none'} of {computed} containers overturned{under if overturned else ''}"
        words += f"; {invalid} destroyed a corner, which is not valid" if invalid else ""
        words += f"; {failed} have no outcome" if failed else ""
    words += f"; {result.refused} row{'s were' if result.refused != 1 else ' was'} refused" if refused else ""
    weakest = result.ranked[0]
    words += f"; the weakest is {weakest['name']}"
    if (margin := weakest["margin"]) is not None:
        does, what = ("fails the rule", "the motions") if result.site else ("overturns", "its motion")
        words += f", which {does} from {margin:.3g} times {what} on"
    return words
