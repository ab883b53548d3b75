"""Compilation of the stepping kernels, cached per version of their source.

numba's own cache checks only the file of the outermost function, so a change of a law in another file would go
unnoticed and outdated machine code would run. Here the name of the cache folder contains a digest of every source of
this package and of the sources named for a kernel from elsewhere.
"""

import hashlib
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
from numba.core import config
from numba.core.caching import IndexDataCacheFile
from numba.core.cpu import CPUTargetOptions
from numba.core.registry import CPUDispatcher
from numba.core.types import unliteral
from numba.core.typing.typeof import typeof
from numba.extending import register_jitable

from contact.compiler import PLAIN, KernelCompiler, PieceCompiler
from contact.folders import open_to_others

#: machine code that a wheel may bring (`.ci/package`), compiled for any CPU of its kind, by Python and numba
SHIPPED = Path(__file__).parent / "machine_code"
FITTING = f"python{sys.version_info.major}.{sys.version_info.minor}-numba{numba.__version__}"
if SHIPPED.is_dir():  # numba looks for code of the CPU that it compiles for
    setattr(config, "CPU_NAME", "generic")  # noqa: B010
    setattr(config, "CPU_FEATURES", "")  # noqa: B010


class CacheFolderError(RuntimeError):
    """Compiled kernels would come from a folder that is not safe."""


@cache
def source_digest(sources: tuple[Path, ...] = ()) -> str:
    """Digest of this package's sources, of `sources`, of numba's version and the compiler, 16 hexadecimal digits."""
    digest = hashlib.sha256((numba.__version__ + " plain" * PLAIN).encode())
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
        _require_own(folder, folder.parent, root)
        _take_shipped(folder)
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="unanchored-kernels-"))
    return folder


def _take_shipped(folder: Path) -> None:
    """Fill an empty cache folder with the machine code of the wheel, where that fits; else kernels are compiled."""
    shipped = SHIPPED / FITTING / folder.name
    if not shipped.is_dir() or any(folder.iterdir()):
        return
    _require_own(shipped, SHIPPED)
    half = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        shutil.copytree(shipped, half, dirs_exist_ok=True)
        half.rename(folder)  # at once, for other processes
    except OSError:  # another process was first
        shutil.rmtree(half, ignore_errors=True)


def _require_own(*folders: Path) -> None:
    """Refuse folders in which others may put code that would be loaded as kernels.

    Raises:
        CacheFolderError: one is neither the user's nor root's, or others may write it.
    """
    if (folder := open_to_others(*folders)) is not None:
        raise CacheFolderError(
            f"others may write {folder}, from which compiled kernels are loaded and run: name a folder of your own as "
            "NUMBA_CACHE_DIR, or take the right to write from them"
        )


#: of all kernels: they own no memory, so numba's runtime, which would count references at every call, is left out, and
#: no kernel may allocate an array; they run without the interpreter's lock; division by zero follows IEEE (as in
#: numpy); there is no fast-math, so that repeated runs give identical bytes
OPTIONS: Any = {"error_model": "numpy", "nogil": True, "_nrt": False}
if not hasattr(CPUTargetOptions, "_nrt"):  # numba does not promise it: all is slower then
    del OPTIONS["_nrt"]


def options_of_piece(inline: bool) -> Any:
    """numba's options for a function as kernels call it, see `contact.pieces`."""
    unused = {"nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    hint = {"forceinline": inline} if hasattr(CPUTargetOptions, "forceinline") else {}
    return OPTIONS | unused | hint | {"pipeline_class": PieceCompiler}


class Kernel(CPUDispatcher):
    """A function that is a piece of the kernels that call it, and a kernel of its own where Python calls it."""

    entry: Any  #: for Python

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._code_by_class: dict[tuple[type, ...], Callable[..., Any]] = {}

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call the entry."""
        return self.entry(*arguments, **named)

    def call_by_class(self, *arguments: Any) -> Any:
        """Call the compiled entry, reusing the argument types of the first call with these classes.

        numba determines the types of all fields of structs at each call, which takes 12 of 14 us for the data of a run.
        The caller guarantees that instances of a class have fields of one type, but for a field `body`, whose class may
        differ: other fields would be misread.
        """
        classes = (*map(type, arguments), *(type(getattr(argument, "body", None)) for argument in arguments))
        code = self._code_by_class.get(classes)
        if code is not None:
            return code(*arguments)
        result = self.entry(*arguments)
        self._code_by_class[classes] = self.entry.overloads[tuple(map(typeof, arguments))].entry_point
        return result

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Signature for arguments of these types; numba would compile a function again for each constant given."""
        named = {name: unliteral(kind) for name, kind in kws.items()}
        return super().get_call_template([unliteral(kind) for kind in args], named)


@cache
def _content_digest(source: str) -> str:
    return hashlib.sha256(Path(source).read_bytes()).hexdigest()


def _name_by_module(code: Any, folder: Path, function: Callable[..., Any]) -> None:
    """Keep cached machine code under the module's name: numba takes its path, so that each clone would compile again.

    Sources outside the digest of `folder`, as those of tests, are told apart by their own content.
    """
    if not hasattr(code, "_cache_file") or not hasattr(code, "_impl"):  # numba does not promise them
        return
    code._cache_path = code._impl.locator._cache_path = str(folder / function.__module__)
    code._cache_file = IndexDataCacheFile(
        cache_path=code._cache_path,
        filename_base=code._impl.filename_base,
        source_stamp=_content_digest(function.__code__.co_filename),
    )


def compiled(
    function: Callable[..., Any] | None = None, *, inline: bool = False, sources: tuple[Path, ...] = ()
) -> Any:
    """Decorator: compile a function of numbers, arrays and named tuples on first call, and cache the machine code.

    The plain function stays available as `.py_func`. `inline` asks LLVM to put the function into its callers whatever
    its size, because passing the tuples of arrays is expensive. `sources` are files outside this package whose
    functions it calls.
    """
    if function is None:
        return partial(compiled, inline=inline, sources=sources)
    options = options_of_piece(inline)
    compiler = options.pop("pipeline_class")
    kernel = Kernel(function, targetoptions=options, pipeline_class=compiler)
    before = getattr(config, "CACHE_DIR")  # noqa: B009 - numba sets its options at run time
    setattr(config, "CACHE_DIR", str(cache_folder(sources)))  # noqa: B010
    try:
        entry: Any = numba.njit(
            **OPTIONS | {"cache": True, "no_cfunc_wrapper": True, "pipeline_class": KernelCompiler}
        )(function)
    finally:
        setattr(config, "CACHE_DIR", before)  # noqa: B010
    # numba would first load all that its compiler knows (0.1 s, 27 MB); a compilation does so itself.
    if hasattr(entry._cache, "_load_overload"):
        entry._cache.load_overload = entry._cache._load_overload
    _name_by_module(entry._cache, cache_folder(sources), function)
    kernel.entry = entry
    return kernel


#: decorator: a function that is put into the kernels that call it, and is plain Python elsewhere
inlined = register_jitable(**options_of_piece(True))
