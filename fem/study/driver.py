"""The driver of every study: from what is asked to a folder that holds the result.

A study says what it is (`Study`): its kind of folder, the hash of what is asked, what computes it. The driver leaves a
finished result alone, refuses to overwrite an unfinished one, marks the folder, has the study computed and writes the
result. What is logged on the way survives an interruption; the result then says that it is one. A log
is a table that grows by whole lines, in the order in which rows are ready; a kill leaves at most one broken line,
which is cut off when the study is resumed.
"""

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any, Generic, Self, TypedDict, TypeVar, Unpack

from fem.case.case import Case
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import FolderError, FolderLostError
from fem.results.folder import ResultFolder, open_result_folder, program_of_results
from fem.results.json_block import JsonBlock
from fem.results.kinds import ResultKind, read_result, typed_result
from fem.results.run_files import copy_data_files, require_free_names
from fem.runtime.compilation import compilation_announced
from fem.runtime.own_files import appended, write_atomically
from fem.runtime.progress import Reporter
from fem.runtime.signals import interruptible
from fem.runtime.threads import cores
from fem.study.runner import ChunkWork, ItemT, Row, Runner
from fem.study.table import Columns, fields_of, is_row, line_of, read_lines, row_of, table_of_lines
from fem.study.workers import LocalWorkers, WorkersOf

INTERRUPTED, FAILED, COMPLETED = "interrupted", "failed", "completed"


class StudyOptions(TypedDict, total=False):
    """How a study is to be computed; its result does not depend on it."""

    jobs: int | None  #: cores to use; None: all
    workers_of: WorkersOf | None  #: who computes so many cases of a model; None: the cores of this machine
    resume: bool  #: continue with what is there
    force: bool  #: overwrite earlier results
    reporter: Reporter | None


@dataclass(frozen=True, kw_only=True)
class StudyResult(JsonBlock):
    """What the marking file of every study holds."""

    written_where_given = frozenset({"missing"})
    status: str = "running"  #: running | interrupted | failed | completed
    answer: str | None = None  #: in one sentence; None until the study is finished, or where it has none
    missing: str | None = None  #: what an interrupted study has not come to, in words
    warnings: tuple[str, ...] = ()  #: about its cases, in the words of a run
    program: str = field(default_factory=lambda: str(program_of_results()["program"]))
    versions: dict[str, str] = field(default_factory=lambda: dict(program_of_results()["versions"]))

    @property
    def state(self) -> str:
        """`finished` once every stage is done, else `interrupted`."""
        return "finished" if self.status in (FAILED, COMPLETED) else "interrupted"

    def interrupted(self, missing: str) -> Self:
        """This result of a study that was interrupted before what is missing, in words."""
        return replace(self, status=INTERRUPTED, missing=missing)

    @property
    def no_answer_yet(self) -> str | None:
        """What stands in place of the answer of an unfinished study; None of a finished one."""
        if self.state == "finished":
            return None
        return f"no answer yet: {self.missing or 'the study was interrupted'}; --resume continues"

    def to_json(self) -> dict[str, Any]:
        """As JSON types, with the state."""
        return {"state": self.state} | super().to_json()


ResultT = TypeVar("ResultT", bound=StudyResult)


@dataclass(frozen=True, kw_only=True, eq=False)
class Study(Generic[ResultT]):
    """A study that is asked for."""

    kind: ResultKind
    request: str  #: hash of what is asked
    result: type[ResultT]  #: what its marking file is read as
    #: computes what is missing of it; the status of the result says how far it came
    compute: Callable[[ResultFolder, Runner], ResultT]
    texts: Mapping[str, str]  #: files that say what is asked, by name
    #: of an unfinished one in a folder, in words; "" where nothing is lost
    progress: Callable[[Path], str] = lambda place: "what was computed so far"
    size: float = 0.0  #: of its folder, besides `BYTES_BESIDE` [bytes]
    cases: Sequence[Case] = ()  #: whose mesh and motions its folder keeps
    motions: Sequence[Case] = ()  #: likewise; their motions were read
    begun: StudyResult = field(default_factory=StudyResult)  #: its marking file while it runs
    #: a finished result as it is asked for now; None: there is more to compute
    again: Callable[[ResultFolder, ResultT], ResultT | None] = lambda place, result: result


def run_study(study: Study[ResultT], folder: Path, **options: Unpack[StudyOptions]) -> ResultT:
    """Compute a study into a folder; a finished one is not computed again.

    Raises:
        CaseError: a record or mesh with the name of a result, a file that is no motion.
        FolderError: the folder holds something else, or an unfinished study (without `resume` or `force`).
        FolderLockedError: another process writes into it.
        WorkersLostError, OutputError: a worker died, the disk is full, the folder was removed; what is there is kept.
    """
    kind, force, resume = study.kind, options.get("force", False), options.get("resume", False)
    for case in (*study.cases, *study.motions):
        require_free_names(case, kind, study.texts)
    with (
        runner_of(**options) as runner,
        open_result_folder(folder, kind, study.request, force=force, resume=resume) as place,
        interruptible(runner.reporter) as stop,
        compilation_announced(runner.reporter.message),
    ):
        if place.finished and place.earlier:
            known = study.again(place, typed_result(study.result, place.earlier, folder / kind.mark))
            if known is not None:
                runner.reporter.message(f"{folder} holds this {kind.name} already; --force computes it again")
                return known
        if progress := study.progress(folder):
            place.refuse_unfinished(progress)
        place.require_same_program()
        place.require_room(study.size + BYTES_BESIDE, f"the {kind.name}", "take fewer runs")
        mark = {kind.request: study.request}
        place.begin(study.begun.to_json() | mark, study.texts, keep=place.earlier is not None)
        for case in study.cases:
            copy_data_files(case, place.path)
        for case in study.motions:
            copy_data_files(case, place.path, read=True)
        result = study.compute(place, replace(runner, stop=stop))
        place.check()
        place.write_result(result.to_json() | mark)
        if result.status in kind.finished:
            place.remove(*kind.temporary)
    return result


def read_study(folder: Path, kind: ResultKind, result: type[ResultT]) -> ResultT:
    """The result of a study in a folder, finished or interrupted; FolderError for none, or one that was killed."""
    place = folder / kind.mark
    content = read_result(place, kind)
    if content.get("status") == "running":
        raise FolderError(
            f"{folder}: the {kind.name} is not finished; continue it with --resume, then report it"
        )
    return typed_result(result, content, place)


@contextmanager
def runner_of(**options: Unpack[StudyOptions]) -> Iterator[Runner]:
    """What runs the cases of a study; nothing stops it."""
    jobs, given, reporter = options.get("jobs") or cores(), options.get("workers_of"), options.get("reporter")
    with nullcontext(given) if given else LocalWorkers(jobs) as workers_of:
        yield Runner(workers_of=workers_of, reporter=reporter or Reporter(), jobs=jobs)


def hash_of(request: Any) -> str:
    """A hash of what is asked: equal for requests that are equal as JSON."""
    return hashlib.sha256(json.dumps(request, sort_keys=True, default=repr).encode()).hexdigest()


@dataclass(frozen=True, kw_only=True)
class LoggedRuns(Generic[ItemT]):
    """Runs of one kind whose rows are kept in a log: none is computed twice, whatever interrupts the study.

    A row that is already there counts for the item that the study itself makes, if it says the same of what the item is
    made of. All other rows are left out.
    """

    what: str  #: they are, for the line of progress
    path: Path  #: of the log
    columns: Columns  #: of the log
    key: Callable[[ItemT], Iterable[Any]]  #: values of the first columns; the others are of its row
    ids: int  #: of these, how many tell the items apart
    of: str = ""  #: what the lines of these runs begin with; those of others stay as they are
    make: Callable[[ItemT], Case]  #: the case of an item; picklable
    model_of: Callable[[ItemT], str]
    work: ChunkWork | None = None  #: what is done with some items in place of their runs
    logged: Callable[[Row], Row] = lambda row: row  #: a row as the log holds it
    note: Callable[[str], None] = lambda line: None  #: called with every line of the log, old and new
    #: called with what they are and the size of every batch, before its runs
    told: Callable[[str, int], None] = lambda what, count: None
    more: Callable[[int], float] = lambda count: 0.0  #: how many are expected to follow a batch of this size
    #: of the log, by what tells apart
    lines: dict[tuple[Any, ...], str] = field(default_factory=dict, init=False)

    def missing(self, among: Iterable[ItemT]) -> list[ItemT]:
        """Those of some items that have no row yet."""
        return [item for item in among if self._id(item) not in self.lines]

    def row(self, item: ItemT) -> Row:
        """The row of an item, by column; empty where it has none."""
        line = self.lines.get(self._id(item))
        return {} if line is None else row_of(self.columns, line)

    def table(self) -> str:
        """The rows in the order of their items."""
        return table_of_lines(self.columns, (line for _, line in sorted(self.lines.items())))

    def run(self, runner: Runner, batches: Iterable[Sequence[ItemT]]) -> None:
        """Note the rows of earlier attempts, and run the items that have none.

        Each batch, of items that are not noted, is asked for when all rows before are noted. FolderLostError where the
        log was removed, OSError where it cannot be written.
        """
        there, known = read_lines(self.path, self.columns), dict[str, str]()
        for line in there:
            if not line.startswith(self.of):
                known[line] = line
            elif is_row(self.columns, line):
                known.setdefault(line_of(fields_of(line)[: self.ids]), line)
        kept = table_of_lines(self.columns, known.values()).encode()
        if damaged := len(there) - len(known):  # as after a fault of the disk
            runner.reporter.warning(f"{self.path}: damaged rows, which are computed again: {damaged}")
            write_atomically(self.path, kept)
        earlier = {name: line for name, line in known.items() if line.startswith(self.of)}
        with closing(appended(self.path, len(kept) if known else 0)) as file, ExitStack() as ended:
            ended.callback(os.fsync, file.fileno())  # what was written is to survive a power cut as well
            if not known:
                file.write(kept)
            for wanted in batches:
                items = [item for item in wanted if not self._recalled(item, earlier)]
                if runner.stop():
                    break
                self.told(self.what, len(items))
                asked = self.what, items, self.make, self.model_of, self.work
                for chunk, rows in runner.rows(
                    *asked, takes_long=self.work is not None, more=self.more(len(items))
                ):
                    keys, logged = [tuple(self.key(item)) for item in chunk], map(self.logged, rows)
                    lines = [
                        line_of((*key, *(row[name] for name in [*self.columns][len(key) :])))
                        for key, row in zip(keys, logged, strict=True)
                    ]
                    if os.fstat(file.fileno()).st_nlink == 0:
                        raise FolderLostError(self.path.parent)
                    data = "".join(f"{line}\n" for line in lines).encode()
                    while data:
                        data = data[file.write(data) :]
                    for item, line in zip(chunk, lines, strict=True):
                        self._note(item, line)
        if earlier and not runner.stop():
            runner.reporter.warning(
                f"{self.path}: rows that say otherwise than this study, which are left out: {len(earlier)}"
            )
            left_out = {*earlier.values()}
            there = [line for line in read_lines(self.path, self.columns) if line not in left_out]
            write_atomically(self.path, table_of_lines(self.columns, there))

    def _id(self, item: ItemT) -> tuple[Any, ...]:
        return tuple(islice(self.key(item), self.ids))

    def _recalled(self, item: ItemT, earlier: dict[str, str]) -> bool:
        """Whether an item has a row among earlier ones, which is noted and leaves them."""
        name = line_of(self._id(item)) if earlier else ""
        line = earlier.get(name)
        if line is None or not f"{line},".startswith(f"{line_of(self.key(item))},"):
            return False
        try:
            self._note(item, line)
        except (AttributeError, LookupError, TypeError, ValueError):
            return False
        del earlier[name]
        return True

    def _note(self, item: ItemT, line: str) -> None:
        self.note(line)
        self.lines[self._id(item)] = line
