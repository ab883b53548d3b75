"""Jobs of Slurm as the workers of a study, through dask-jobqueue (the extra `slurm`).

They are submitted when the first runs are to be computed, once their cost is told and approved. Until then, and for
work that is no run, the cores of this machine serve.
"""

import sys
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from dask_jobqueue import SLURMCluster
from pydantic import Field, Strict

from fem.batch.cluster import cluster
from fem.batch.study_file import read_as
from fem.batch.workers import LocalWorkers, Pool, WorkersOf
from fem.case.files import LARGEST_FILE
from fem.case.tables.table import CaseTable, case_key
from fem.case.validation import CaseError
from fem.runtime.threads import cores
from fem.runtime.user_files import read_regular

QUEUE_S = 24 * 3600.0  #: for which the first job may wait in the queue


class SlurmTable(CaseTable):
    """The file of `--slurm`: what a job asks for."""

    jobs: Annotated[int, Strict(), Field(ge=1, le=10_000)] = case_key("how many", 1)
    cores: Annotated[int, Strict(), Field(ge=1, le=1024)] = case_key("of each, one worker a core", example=4)
    memory: str = case_key("of each", example="8GB")
    walltime: str = case_key("of each", example="01:00:00")
    queue: str | None = case_key("partition", None, example="compute")
    account: str | None = case_key("to be charged", None)
    interface: str | None = case_key("network on which workers reach this machine", None, example="ib0")


@dataclass
class SlurmWorkers:
    """The pools of a study: jobs once they are approved, before that the cores of this machine."""

    table: SlurmTable
    place: str
    held: ExitStack
    yes: bool  #: approved beforehand
    ask: Callable[[str], str] = input
    _workers_of: WorkersOf | None = field(default=None, init=False)
    _local: WorkersOf | None = field(default=None, init=False)

    def __call__(self, model: str, count: int) -> Sequence[Pool]:
        if self._workers_of is not None:
            return self._workers_of(model, count)
        if self._local is None:
            self._local = self.held.enter_context(LocalWorkers(cores()))
        return self._local(model, count)

    def approve(self, what: str, seconds: float) -> None:
        """Tell what runs cost in CPU time [s], and submit the jobs where that is wanted.

        Raises:
            CaseError: it is not, or nobody can be asked.
        """
        if self._workers_of is not None:
            return
        jobs, each = self.table.jobs, self.table.cores
        told = (
            f"{what}: roughly {seconds / 3600.0:.2g} CPU hours, and what follows from their results; {jobs} jobs of "
            f"{each} cores for at most {self.table.walltime} each"
        )
        print(told, file=sys.stderr)
        if not self.yes:
            if not sys.stdin.isatty():
                raise CaseError(f"--slurm {self.place}: nothing was submitted; --yes submits without asking")
            if self.ask("submit? [y/N] ").strip().lower() not in ("y", "yes"):
                raise CaseError(f"--slurm {self.place}: nothing was submitted")
        options = self.table.model_dump(exclude={"jobs"}, exclude_none=True)
        queue = self.held.enter_context(SLURMCluster(processes=each, n_workers=0, **options))
        queue.scale(jobs=jobs)
        self._workers_of = self.held.enter_context(
            cluster(queue.scheduler_address, named=f"--slurm {self.place}", worker_s=QUEUE_S)
        )


@contextmanager
def slurm(path: Path, *, yes: bool) -> Iterator[SlurmWorkers]:
    """The workers that a file asks for; their jobs end with the context.

    Raises:
        CaseError: the file cannot be used.
    """
    try:
        content = tomllib.loads(read_regular(path, LARGEST_FILE).decode())
    except (ValueError, RecursionError) as error:
        raise CaseError(f"--slurm {path}: cannot be read as TOML ({error})") from None
    try:
        table = read_as("", SlurmTable, content)
    except CaseError as error:
        raise CaseError("\n".join(f"{path}: {line}" for line in str(error).splitlines())) from None
    with ExitStack() as held:
        yield SlurmWorkers(table=table, place=str(path), held=held, yes=yes)
