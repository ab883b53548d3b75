"""What every hall has, whatever computes it: its study, the order of its containers, the list with its results."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from fem.batch.runner import Row, Runner
from fem.batch.study import COMPLETED, FAILED, Study
from fem.batch.table import table_text
from fem.case.toml import toml_document
from fem.hall.file import LISTED
from fem.hall.page import hall_report
from fem.hall.places import PICTURE, draw_places, geojson
from fem.hall.plan import Hall
from fem.hall.result import REFUSED, RESULT_COLUMNS, HallResult
from fem.results.figures import SLIPPED, TURNED
from fem.results.folder import ResultFolder
from fem.results.kinds import HALL
from fem.results.outcome import COUNTED_AS, ending_of

TABLE, PAGE, GEOJSON = "hall.csv", "report.html", "hall.geojson"
WORST_FIRST = ("overturned", "invalid", "failed", "stood")  #: what a container counts as
ROCKS = 0.01  #: rotation ratio up to which what stands is ranked by the static rule: nothing rocks


#: the command that computes a row by itself, from the number of its container and what the row sets
CommandOf = Callable[[int, Mapping[str, Any]], str]


def ending_in(row: Row) -> str:
    """What a row counts as."""
    return REFUSED if row["status"] == REFUSED else COUNTED_AS[ending_of(row["status"], row["outcome"])]


def weakness(row: Row) -> tuple[float, ...]:
    """Smaller for the worse: by what it counts as, by margin, by rotation, by the static rule, by slip.

    Of a run alone neither margin nor static rule are known.
    """
    ending, margin = ending_in(row), row.get("margin") or row.get("margin_tried_to")
    turned, static, slip = (row.get(name) or 0.0 for name in (TURNED, "utilisation_overturning", SLIPPED))
    if ending in WORST_FIRST[:3] or (static and turned <= ROCKS):
        turned = 0.0
    return WORST_FIRST.index(ending), margin is None, margin or 0.0, -turned, -static, -slip


def study_of(
    hall: Hall, compute: Callable[[HallResult, ResultFolder, Runner], HallResult], **fields: Any
) -> Study[HallResult]:
    """The study of a checked list; `fields` are of its result before any run, in one way of computing."""
    rows, file, origin = hall.rows, hall.file, hall.base.origin_with({})
    known = {"model": hall.base.solver.model, "allow_outside": origin.allow_outside or None}
    begun = HallResult(
        hall=file.name,
        case=origin.place,
        rows=len(rows),
        containers=sum(row.count for row in rows),
        distinct=len(hall.containers),
        refused=sum(row.container is None for row in rows),
        kept=tuple(column for column, meaning in file.meanings.items() if not meaning),
        columns=tuple(file.meanings),
        **(known | fields),
    )
    return Study(
        kind=HALL,
        request=begun.asked,
        result=HallResult,
        begun=begun,
        compute=partial(compute, begun),
        texts={"list.csv": file.table.text, "base.toml": toml_document(hall.base.given())},
        subject=f"the hall ({begun.distinct} containers)",
        way_out="take fewer rows",
        progress=lambda results: "what was computed so far",
        again=lambda results, finished: finished if finished.listed == begun.listed else None,
    )


def written(
    results: ResultFolder, begun: HallResult, hall: Hall, found: Sequence[Row], command_of: CommandOf
) -> HallResult:
    """The finished result of a checked list, with the list, its plan and its page written.

    Args:
        results: folder.
        begun: what is known of the result.
        hall: the list.
        found: results of each container, by column; its rank is added.
        command_of: the command of a row.
    """
    for rank, container in enumerate(sorted(found, key=weakness), start=1):
        container["rank"] = rank
    table = tuple(_rows(hall, found, command_of))
    outcomes, tags = Counter[str](), dict[str, dict[str, Any]]()
    for row in table:
        ending = ending_in(row)
        outcomes[row["outcome"] or ending] += row["count"]
        empty = {"tag": row["tag"], "containers": 0, "counts": Counter[str](), "margin": None}
        tag = tags.setdefault(row["tag"], empty)
        tag["containers"] += row["count"]
        tag["counts"][ending] += row["count"]
        tag["margin"] = min(filter(None, (tag["margin"], row["margin"])), default=None)
    result = replace(
        begun,
        status=FAILED if {row["status"] for row in found} == {FAILED} else COMPLETED,
        outcomes=dict(sorted(outcomes.items())),
        tags=tuple(tag for _, tag in sorted(tags.items())) if {*tags} != {""} else (),
        table=table,
    )
    result = replace(result, answer=answer_of(result))
    fields = ([*row["given"].values(), *(row[name] for name in RESULT_COLUMNS)] for row in table)
    results.write_text(TABLE, table_text((*result.columns, *RESULT_COLUMNS), fields))
    results.remove(PICTURE, GEOJSON)
    for name, text in ((PICTURE, draw_places(result)), (GEOJSON, geojson(result))):
        if text:
            results.write_text(name, text)
    results.write_text(PAGE, hall_report(results.path, result=result))
    return result


def _rows(hall: Hall, found: Sequence[Row], command_of: CommandOf) -> Iterator[Row]:
    """The rows of the list with their results."""
    for number, row in enumerate(hall.rows, start=1):
        results: Row = {"status": REFUSED, "reason": row.reason}
        if (k := row.container) is not None:
            results = found[k] | {"command": command_of(k, row.values)}
        own = {"row": number} | {name: getattr(row, name) for name in LISTED}
        yield own | {name: results.get(name) for name in (*RESULT_COLUMNS, "command")}


def answer_of(result: HallResult) -> str:
    """How many containers did what, and which is the weakest, in one sentence."""
    counts = dict(result.outcomes)
    refused = counts.pop(REFUSED, 0)
    computed = result.containers - refused
    overturned, invalid, failed = (counts.get(word, 0) for word in ("overturned", "invalid", "failed"))
    under = f" under at least one of {len(result.motions)} motions" if len(result.motions) > 1 else ""
    words = f"{overturned or 'none'} of {computed} containers overturned{under if overturned else ''}"
    words += f"; {invalid} destroyed a corner, which is not valid" if invalid else ""
    words += f"; {failed} have no outcome" if failed else ""
    words += f"; {result.refused} row{'s were' if result.refused != 1 else ' was'} refused" if refused else ""
    weakest = result.ranked[0]
    words += f"; the weakest is {weakest['name']}"
    if (margin := weakest["margin"]) is not None:
        words += f", which overturns from {margin:.3g} times its motion on"
    return words
