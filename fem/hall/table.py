"""The list with its results: `hall.csv`, the counts and rows of `hall.json`, its answer."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from fem.hall.file import HallFile, HallRow
from fem.hall.plan import Inventory
from fem.hall.result import REFUSED, RESULT_COLUMNS, HallResult, TagCount


@dataclass(frozen=True, kw_only=True, eq=False)
class HallTable:
    """The rows of a list with the results of their containers."""

    file: HallFile
    inventory: Inventory
    #: of each container, by column
    values: Mapping[int, Mapping[str, Any]]
    words: Mapping[int, tuple[str, str]]  #: what the outcomes count each container as, and what the tags do
    order: list[int]  #: of the containers, the weakest first
    command: Callable[[HallRow, int], str]  #: of a row, whose container this is

    def _results(self) -> Iterator[tuple[HallRow, int | None, dict[str, Any]]]:
        ranks = {number: rank for rank, number in enumerate(self.order, start=1)}
        for row, container, reason in zip(
            self.file.rows, self.inventory.of_row, self.inventory.reasons, strict=True
        ):
            if container is None:
                yield row, None, {"status": REFUSED, "reason": reason}
            else:
                yield row, container, {**self.values[container], "rank": ranks[container]}

    def rows(self) -> Iterator[tuple[Any, ...]]:
        """`hall.csv`: the fields of the list as they were given, then the results."""
        for row, _, values in self._results():
            yield *row.given, *(values.get(name) for name in RESULT_COLUMNS)

    def added_to(self, result: HallResult) -> HallResult:
        """The result with counts and rows."""
        table, outcomes, tags = [], Counter[str](), dict[str, TagCount]()
        for number, (row, container, results) in enumerate(self._results(), start=1):
            values = {name: results.get(name) for name in RESULT_COLUMNS}
            outcome, counted = (REFUSED, REFUSED) if container is None else self.words[container]
            outcomes[outcome] += row.count
            tag = tags.get(row.tag, TagCount(tag=row.tag, containers=0, counts={}))
            margins = [margin for margin in (tag.margin, values["margin"]) if margin is not None]
            tags[row.tag] = replace(
                tag,
                containers=tag.containers + row.count,
                counts={**tag.counts, counted: tag.counts.get(counted, 0) + row.count},
                margin=min(margins, default=None),
            )
            table.append(
                {"row": number, "line": row.line, "name": row.name, "count": row.count, "tag": row.tag}
                | {"place_m": row.place, "lon_lat": row.geographic}
                | {"given": dict(zip(self.file.columns, row.given, strict=True))}
                | values
                | {"command": None if container is None else self.command(row, container)}
            )
        return replace(
            result,
            outcomes=dict(sorted(outcomes.items())),
            tags=tuple(tags[tag] for tag in sorted(tags)) if {*tags} != {""} else (),
            table=tuple(table),
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
    weakest = next(row for row in result.table if row["rank"] == 1)
    words += f"; the weakest is {weakest['name']}"
    if weakest["margin"] is not None:
        does = (
            "fails the rule from {:.3g} times the motions on"
            if result.site
            else "overturns from {:.3g} times its motion on"
        )
        words += f", which {does.format(weakest['margin'])}"
    return words
