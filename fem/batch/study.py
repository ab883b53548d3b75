"""The driver of every study: from what is asked to a folder that holds the result.

A study says what it is (`Study`): its kind of folder, the hash of what is asked, what computes it. The driver leaves a
finished result alone, refuses to overwrite an unfinished one, marks the folder, has the study computed and writes the
result. What is logged on the way survives an interruption; the result then says that it is one.
"""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Generic, TypedDict, TypeVar, Unpack

from fem.batch.runner import Runner
from fem.batch.workers import LocalWorkers, WorkersOf
from fem.case.case import Case
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import FolderError
from fem.results.folder import ResultFolder, open_result_folder, program_of_results
from fem.results.json_block import JsonBlock
from fem.results.kinds import ResultKind, read_result, typed_result
from fem.results.run_files import copy_data_files, require_free_names
from fem.runtime.compilation import compilation_announced
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import interruptible
from fem.runtime.threads import cores

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
    program: str = field(default_factory=lambda: str(program_of_results()["program"]))
    versions: dict[str, str] = field(default_factory=lambda: dict(program_of_results()["versions"]))

    @property
    def state(self) -> str:
        """`finished` once every stage is done, else `interrupted`."""
        return "finished" if self.status in (FAILED, COMPLETED) else "interrupted"

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


def as_it_is(place: ResultFolder, result: ResultT) -> ResultT | None:
    """A finished result is never added to."""
    return result


@dataclass(frozen=True, kw_only=True, eq=False)
class Study(Generic[ResultT]):
    """A study that is asked for."""

    kind: ResultKind
    request: str  #: hash of what is asked
    result: type[ResultT]  #: what its marking file is read as
    #: computes what is missing of it; the status of the result says how far it came
    compute: Callable[[ResultFolder, Runner], ResultT]
    texts: Mapping[str, str]  #: files that say what is asked, by name
    subject: str  #: of a refusal, such as "the ensemble"
    way_out: str  #: where the disk has too little room
    progress: Callable[[Path], str]  #: of an unfinished one in a folder, in words; "" where nothing is lost
    size: float = 0.0  #: of its folder, besides `BYTES_BESIDE` [bytes]
    cases: Sequence[Case] = ()  #: whose mesh and motions its folder keeps
    motions: Sequence[Case] = ()  #: likewise; their motions were read
    begun: StudyResult = field(default_factory=StudyResult)  #: its marking file while it runs
    #: a finished result as it is asked for now; None: there is more to compute
    again: Callable[[ResultFolder, ResultT], ResultT | None] = as_it_is


def run_study(study: Study[ResultT], folder: Path, **options: Unpack[StudyOptions]) -> ResultT:
    """Compute a study into a folder; a finished one is not computed again.

    Raises:
        CaseError: a record or mesh with the name of a result, a file that is no motion.
        FolderError: the folder holds something else, or an unfinished study (without `resume` or `force`).
        FolderLockedError: another process writes into it.
        WorkersLostError: a worker died; what was computed is kept.
        OutputError: the disk is full, the folder was removed; what was written is kept.
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
        place.require_room(study.size + BYTES_BESIDE, study.subject, study.way_out)
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
    """The result of a study in a folder, finished or interrupted.

    Raises:
        FolderError: there is none, it is damaged, or it was killed before it could say how far it came.
    """
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
    with ExitStack() as stack:
        jobs = options.get("jobs") or cores()
        given = options.get("workers_of")
        yield Runner(
            workers_of=given or stack.enter_context(LocalWorkers(jobs)),
            reporter=options.get("reporter") or SilentReporter(),
            jobs=jobs,
        )


def hash_of(request: Any) -> str:
    """A hash of what is asked: equal for requests that are equal as JSON."""
    return hashlib.sha256(json.dumps(request, sort_keys=True, default=repr).encode()).hexdigest()
