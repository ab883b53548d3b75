"""Optional cache of the large arrays of a long set-up.

Each array is computed the same way whether others were restored or not, so a resumed set-up gives the same bits.
"""

from collections.abc import Callable, Iterator

from fem.runtime.arrays import FloatArray

#: Called with the name of an array, the array and a function that computes it: fills the array, with what was stored
#: under its name or with the computed values. A set-up asks for the same names in the same order every time and
#: does not change an array afterwards.
ArrayCache = Callable[[str, FloatArray, Callable[[], FloatArray]], None]


def no_cache(name: str, target: FloatArray, compute: Callable[[], FloatArray]) -> None:
    """Compute the array; nothing is stored."""
    target[...] = compute()


def blocks(count: int, largest: int) -> Iterator[slice]:
    """Slices of at most `largest` that cover `count` items; they depend on sizes alone, never on speed."""
    for first in range(0, count, largest):
        yield slice(first, min(first + largest, count))
