"""The memory that the process may have, where a limit is set: by `ulimit -v`, or by a batch scheduler."""

import sys

from fem.runtime.threads import cores

if sys.platform != "win32":
    import resource

#: address space of a command that computes, and of one that does not [MB]. Libraries take 550 and 130 of it before the
#: first step; with less, a module fails to load, or OpenBLAS asks again and again for a buffer.
COMPUTING, READING = 700, 250
OF_A_CORE = 150  #: of each thread that computes: a report takes 946 on two cores, and asks for ever with 800
RIGID, FIGURES = 500, 120  #: of one rigid run, which takes 450, and of its figures


def is_limited() -> bool:
    """Whether a limit is set."""
    return sys.platform != "win32" and resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY


def memory_of(computing: bool, jobs: int | None = None) -> int:
    """What a command needs [MB] that computes, or reads alone, on so many cores; None: all."""
    return COMPUTING + OF_A_CORE * (jobs or cores()) if computing else READING


def memory_of_run(*, rigid: bool, alone: bool, figures: bool) -> int:
    """What a run needs [MB] that is rigid or not, alone or with the runs of its band and margin."""
    return RIGID + FIGURES * figures if rigid and alone else memory_of(True, 1 if alone else None)


def shortage(needed: int) -> str:
    """What the limit on memory gives and is needed [MB], in words; empty where it is enough or none is set."""
    if sys.platform == "win32":
        return ""
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY or limit >= needed << 20:
        return ""
    return f"memory is limited to {limit >> 20} MB, and this needs {needed} MB or more; raise the limit (ulimit -v)"
