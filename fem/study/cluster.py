"""The cases of a sweep on a running dask.distributed cluster (the extra `cluster`).

Chunks of cases go to the scheduler in place of this machine's cores; only this process writes files. The workers read
mesh and motion files from the same paths, on a shared file system. Whoever reaches a scheduler runs code on it and its
workers: dask offers TLS against that, configured by `distributed.comm.tls` for an address `tls://..`.
"""

import asyncio
import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from distributed import CancelledError, Client, KilledWorker, Security, rpc

from fem.runtime.identity import program_identity
from fem.study.workers import Pool, WorkersLostError, WorkersOf

ANSWER_S = 5.0  #: within which a scheduler answers
WORKER_S = 10.0  #: within which it has a worker


class SchedulerError(ValueError):
    """The scheduler or its workers cannot be used; the message names the way out."""


@contextmanager
def cluster(address: str) -> Iterator[WorkersOf]:
    """Connect to a scheduler; yields the pools that compute the cases of a model.

    Args:
        address: of the scheduler.

    Raises:
        SchedulerError: it does not answer, has no workers, or they run another version of this program.
        WorkersLostError: the workers died.
    """
    named = f"--scheduler {address}"
    for name in ("distributed", "distributed.client"):  # what matters is raised here
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        # A client waits for ever for a peer that accepts the connection and does not answer.
        asyncio.run(asyncio.wait_for(_identity(address), ANSWER_S))
        client = Client(address, timeout=ANSWER_S)
    except (OSError, TimeoutError, TypeError, ValueError) as error:  # TypeError: TLS without certificates
        reason = str(error).partition("\n")[0] or type(error).__name__
        raise SchedulerError(
            f"{named}: no answer within {ANSWER_S:g} s ({reason}); start one with 'dask scheduler' "
            "and give the address it prints, or leave --scheduler out to compute on this machine"
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKER_S)
        except TimeoutError:
            raise SchedulerError(
                f"{named}: it has no workers; start some with 'dask worker {address}'"
            ) from None
        mine = program_identity()
        for worker, theirs in client.run(program_identity).items():
            other = [name for name, value in mine.items() if theirs.get(name) != value]
            if other:
                raise SchedulerError(
                    f"{named}: the worker {worker} has another {other[0]} "
                    f"({theirs.get(other[0])}, here {mine[other[0]]}); install the same program there"
                )
        with client.get_executor(pure=False) as executor:

            def workers_of(model: str, count: int) -> Sequence[Pool]:
                return [Pool(executor, max(sum(client.nthreads().values()), 1))]

            try:
                yield workers_of
            except (KilledWorker, CancelledError):
                raise WorkersLostError(
                    f"the scheduler {address} or its workers died; --resume continues"
                ) from None


async def _identity(address: str) -> object:
    secured = Security().get_connection_args("client") if address.startswith("tls:") else {}
    async with rpc(address, connection_args=secured) as scheduler:
        return await scheduler.identity()
