"""Compilation of the stepping kernels, cached per version of their source.

numba's own cache checks only the file of the outermost function, so a change of a law in another file would go
unnoticed and outdated machine code would run. Here the name of the cache folder contains a digest of every source of
this package and of the sources named for a kernel from elsewhere.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
from numba.core import config


@cache
def source_digest(sources: tuple[Path, ...] = ()) -> str:
    """Digest of this package's sources, of `sources`, and of numba's version, 16 hexadecimal digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    root = Path(__file__).parent
    for source in (*sorted(root.rglob("*.py")), *sources):
        digest.update(
            (source.relative_to(root) if root in source.parents else Path(source.name)).as_posix().encode()
        )
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder(sources: tuple[Path, ...] = ()) -> Path:
    """Folder of the compiled kernels: NUMBA_CACHE_DIR, else the user's cache, else a temporary one."""
    named = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    root = Path(named) if named else Path.home() / ".cache"
    folder = root / "unanchored" / f"kernels-{source_digest(sources)}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(folder)
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="unanchored-kernels-"))
    return folder


def compiled(
    function: Callable[..., Any] | None = None, *, inline: bool = False, sources: tuple[Path, ...] = ()
) -> Any:
    """Decorator: compile a function of numbers, arrays and named tuples on first call, and cache the machine code.

    The plain function stays available as `.py_func`. `inline` asks LLVM to put the function into its caller whatever
    its size, because passing the tuples of arrays that the kernels use is expensive. `sources` are files outside this
    package whose functions it calls.

    The kernels own no memory: numba's runtime, which would count references at every call, is left out, so no kernel
    may allocate an array. They run without the interpreter's lock. Division by zero follows IEEE (as in numpy). There
    is no fast-math, so that repeated runs give identical bytes.
    """
    if function is None:
        return partial(compiled, inline=inline, sources=sources)
    options: dict[str, Any] = {"cache": True, "error_model": "numpy", "nogil": True, "_nrt": False}
    before = getattr(config, "CACHE_DIR")  # noqa: B009 - numba sets its options at run time
    setattr(config, "CACHE_DIR", str(cache_folder(sources)))  # noqa: B010
    try:
        kernel = numba.njit(forceinline=inline, **options)(function)
    finally:
        setattr(config, "CACHE_DIR", before)  # noqa: B010
    # numba would first load all that its compiler knows (0.1 s, 27 MB); a compilation does so itself.
    kernel._cache.load_overload = kernel._cache._load_overload
    return kernel


def is_compiled(name: str, sources: tuple[Path, ...] = ()) -> bool:
    """True if the cache has machine code of the function of that name, so that it need not be compiled."""
    return any(
        f".{name}-" in entry.name or entry.name.startswith(f"{name}-")
        for entry in cache_folder(sources).rglob("*.nbc")
    )
