"""Modules that are loaded when they are first used, although a library imports them with everything else.

scipy reads every name of numpy, and so loads what a run never uses: wrappers of Fortran and tools for tests, 0.07 s.
numba reads yaml, whose files nobody here writes.
"""

from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

LATE = {"numpy.f2py", "numpy.testing", "yaml"}


class LateFinder(PathFinder):
    """Finds these modules, with a loader that waits for their first use, and leaves all others to those behind it."""

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec = PathFinder.find_spec(fullname, path, target) if fullname in LATE else None
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec
