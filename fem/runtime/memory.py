"""The memory that the process may have, where a limit is set: by `ulimit -v`, or by a batch scheduler."""

import sys

from fem.runtime.threads import cores

if sys.platform != "win32":
    import resource

#: address space of a command that computes, and of one that does not [MB]. Libraries take 550 and 130 of it before the
#: first step; with less, a module fails to load, or OpenBLAS asks again and again for a buffer.
COMPUTING, READING = 700, 250
OF_A_CORE = 150  #: of each thread that computes: a report takes 946 on two cores, and asks for ever with 800
RIGID, FIGURES = 500, 120  #: of one rigid run, and of its figures


def limit() -> int | None:
    """The address space that the process may have [bytes]; None without a limit."""
    if sys.platform == "win32":
        return None
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    return None if most == resource.RLIM_INFINITY else most


def memory_of(computing: bool, jobs: int | None = None) -> int:
    """What a command needs [MB] that computes, or reads alone, on so many cores; None: all."""
    return COMPUTING + OF_A_CORE * (jobs or cores()) if computing else READING


def memory_of_run(*, rigid: bool, alone: bool, figures: bool) -> int:
    """What a run needs [MB] that is rigid or not, alone or with the runs of its band and margin."""
    return RIGID + FIGURES * figures if rigid and alone else memory_of(True, 1 if alone else None)


def shortage(needed: int) -> str:
    """What the limit on memory gives and is needed [MB], in words; empty where it is enough or none is set."""
    most = limit()
    if most is None or most >= needed << 20:
        return ""
    return f"memory is limited to {most >> 20} MB, and this needs {needed} MB or more; raise the limit (ulimit -v)"
