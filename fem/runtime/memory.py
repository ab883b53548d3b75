"""The memory that the process may have, where a limit is set: by `ulimit -v`, or by a batch scheduler."""

import ctypes
import sys
from contextlib import suppress

from fem.runtime.threads import cores

if sys.platform != "win32":
    import resource

M_ARENA_MAX = -8  #: of `mallopt` of glibc
#: address space of a command that computes, and of one that does not [MB]. Libraries take 550 and 130 of it before the
#: first step; with less, a module fails to load, or OpenBLAS asks again and again for a buffer.
COMPUTING, READING = 700, 250
OF_A_CORE = 150  #: of each thread that computes: a report takes 946 on two cores, and asks for ever with 800
RIGID, CHECKS, FIGURES = 500, 120, 100  #: of a rigid run in one thread, its band and margin, its figures


def limit() -> int | None:
    """The address space that the process may have [bytes]; None without a limit."""
    if sys.platform == "win32":
        return None
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    return None if most == resource.RLIM_INFINITY else most


def memory_of(computing: bool, jobs: int | None = None) -> int:
    """What a command needs [MB] that computes, or reads alone, on so many cores; None: all."""
    return COMPUTING + OF_A_CORE * (jobs or cores()) if computing else READING


def threads_of_rigid_runs(most: int) -> int:
    """How many of so many threads have the memory to step rigid runs side by side; at least one."""
    given = limit()
    if given is None:
        return most
    return max(1, min(most, 1 + ((given >> 20) - RIGID - CHECKS - FIGURES) // OF_A_CORE))


def share_the_heap() -> None:
    """Let threads take memory from one heap where a limit is set: glibc reserves 64 MB for one of their own each."""
    if limit() is not None:
        with suppress(OSError, AttributeError):  # another C library
            ctypes.CDLL(None).mallopt(M_ARENA_MAX, 1)


def shortage(needed: int) -> str:
    """What the limit on memory gives and is needed [MB], in words; empty where it is enough or none is set."""
    most = limit()
    if most is None or most >= needed << 20:
        return ""
    return f"memory is limited to {most >> 20} MB, and this needs {needed} MB or more; raise the limit (ulimit -v)"
