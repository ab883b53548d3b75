"""The list with its results: the rows, counts and answer of `hall.json`."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from fem.batch.study import COMPLETED, FAILED
from fem.hall.file import HallRow
from fem.hall.plan import Inventory
from fem.hall.result import REFUSED, RESULT_COLUMNS, HallResult, TagCount
from fem.results.outcome import COUNTED, ending_of

NO_ANSWER = "no answer"  #: of a container at a site
WORDS = {ending: word for word, ending in COUNTED.items()}


def with_table(
    begun: HallResult,
    inventory: Inventory,
    by_container: Mapping[int, Mapping[str, Any]],
    order: Sequence[int],
    command: Callable[[HallRow, int], str],
) -> HallResult:
    """The finished result: rows, counts by outcome and tag, the answer.

    Args:
        begun: without these.
        inventory: the rows, checked.
        by_container: results of each container, by column.
        order: of the containers, the weakest first.
        command: of a row, whose container this is.
    """
    table = tuple(_rows(inventory, by_container, order, command))
    outcomes, tags = Counter[str](), defaultdict[str, list[dict[str, Any]]](list)
    for row in table:
        outcomes[_counted(row, begun)[0]] += row["count"]
        tags[row["tag"]].append(row)
    result = replace(
        begun,
        status=FAILED if {result["status"] for result in by_container.values()} == {FAILED} else COMPLETED,
        outcomes=dict(sorted(outcomes.items())),
        tags=tuple(_tag(tag, rows, begun) for tag, rows in sorted(tags.items())) if {*tags} != {""} else (),
        table=table,
    )
    return replace(result, answer=answer_of(result))


def _rows(
    inventory: Inventory,
    by_container: Mapping[int, Mapping[str, Any]],
    order: Sequence[int],
    command: Callable[[HallRow, int], str],
) -> Iterator[dict[str, Any]]:
    ranks = {number: rank for rank, number in enumerate(order, start=1)}
    for number, row in enumerate(inventory.rows, start=1):
        results: Mapping[str, Any] = {"status": REFUSED, "reason": row.reason}
        if row.container is not None:
            results = {**by_container[row.container], "rank": ranks[row.container]}
        yield {
            "row": number,
            "line": row.line,
            "name": row.name,
            "count": row.count,
            "tag": row.tag,
            "place_m": row.place,
            "lon_lat": row.geographic,
            "given": dict(zip(inventory.file.columns, row.given, strict=True)),
            **{name: results.get(name) for name in RESULT_COLUMNS},
            "command": None if row.container is None else command(row, row.container),
        }


def _counted(row: Mapping[str, Any], result: HallResult) -> tuple[str, str]:
    """What the outcomes count a row as, and what its tag does."""
    if row["status"] == REFUSED:
        return REFUSED, REFUSED
    if result.site:
        return row["answer"] or NO_ANSWER, row["answer"] or NO_ANSWER
    ending = WORDS[ending_of(row["status"], row["outcome"])]
    return row["outcome"] or ending, ending


def _tag(tag: str, rows: Sequence[Mapping[str, Any]], result: HallResult) -> TagCount:
    counts = Counter[str]()
    for row in rows:
        counts[_counted(row, result)[1]] += row["count"]
    margins = [row["margin"] for row in rows if row["margin"] is not None]
    return TagCount(
        tag=tag, containers=counts.total(), counts=dict(counts), margin=min(margins, default=None)
    )


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
        does = "fails the rule" if result.site else "overturns"
        what = "the motions" if result.site else "its motion"
        words += f", which {does} from {margin:.3g} times {what} on"
    return words
