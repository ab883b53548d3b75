"""Modules that are loaded when they are first used, although a library imports them with everything else.

scipy reads every name of numpy, and so loads what a run never uses: wrappers of Fortran and tools for tests, 0.07 s.
"""

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

LATE = {"numpy.f2py", "numpy.testing"}


class LateFinder(PathFinder):
    """Finds these modules, and leaves all others to the finders behind it."""

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Where the module is, with a loader that waits for its first use."""
        spec = PathFinder.find_spec(fullname, path, target) if fullname in LATE else None
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec


def load_late() -> None:
    """From now on, load these modules at their first use."""
    sys.meta_path.insert(0, LateFinder)
