"""Modules that are loaded when they are first used, although a library imports them with everything else.

scipy reads every name of numpy, and so loads what a run never uses: wrappers of Fortran and tools for tests, 0.07 s.
numba reads yaml, whose files nobody here writes. Optimisers of scipy that nobody here calls bring its transforms and
rotations, matplotlib brings axes in space, tables of glyphs and photographs: 0.12 s.
"""

from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

LATE = {"numpy.f2py", "numpy.testing", "yaml", "scipy.linalg._decomp_interpolative", "scipy.spatial"}
LATE |= {"scipy.sparse.csgraph", "mpl_toolkits.mplot3d.art3d", "mpl_toolkits.mplot3d.axis3d"}
LATE |= {"fontTools.agl", "PIL.ExifTags"}


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
