"""One BLAS thread: the bits of a run must not depend on the number of free cores.

A BLAS that splits a sum among threads adds in an order that depends on their number; elastic modes then differ in their
last bits, and so does everything after an impact. The matrices are small, so that threads would not pay; many runs use
all cores (`sweep -j`).
"""

import contextlib
import ctypes
import os
from functools import cache
from pathlib import Path

VARIABLES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
#: of OpenBLAS, whose builds rename it: for numpy, for scipy, with 32 and 64 bit integers
SETTERS = tuple(
    f"{prefix}openblas_set_num_threads{suffix}" for prefix in ("scipy_", "") for suffix in ("64_", "")
)
MAPS = Path("/proc/self/maps")


@cache
def use_one_blas_thread() -> None:
    """Keep BLAS to one thread from now on, in this process and in those that it starts.

    Libraries that are not loaded yet, and those of child processes, read the environment; a loaded OpenBLAS is called
    directly, on Linux.
    """
    os.environ |= dict.fromkeys(VARIABLES, "1")
    lines: list[str] = []
    with contextlib.suppress(OSError):
        lines = MAPS.read_text(encoding="utf-8", errors="replace").splitlines()
    loaded = {line.split(maxsplit=5)[5] for line in lines if "openblas" in line and "/" in line}
    for path in (path for path in loaded if Path(path).name.startswith("lib")):
        with contextlib.suppress(OSError):
            library = ctypes.CDLL(path)
            for setter in SETTERS:
                if hasattr(library, setter):
                    getattr(library, setter)(1)


def cores() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
